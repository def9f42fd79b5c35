"""How often a worker gives a sign of life, and looks for work that others lost."""

import asyncio

import pytest

from service.settings import Settings
from service.workers import slot


@pytest.mark.parametrize(
    ("lease", "beat", "look"), [(2.0, 0.5, 1.0), (0.4, 0.1, 0.2), (60.0, 15.0, 1.0)], ids=["default", "shortest", "longest"]
)
def test_a_lease_is_several_signs_of_life_and_is_looked_after_within_it(lease, beat, look):
    async def times():
        worker = slot.Slot(Settings(database_url="postgresql://nobody@127.0.0.1:1/none", lease=lease), "w")
        try:
            return worker._beat_s, worker._look_s
        finally:
            await worker._database.close()

    assert asyncio.run(times()) == pytest.approx((beat, look))


def test_what_no_setting_changes():
    assert (slot.ENROL_S, slot.SWEEP_S, slot.RETRY_WALLS_S) == (3.0, 30.0, 5.0)
    assert (slot.PATIENCE_S, slot.MOST_S) == (3600.0, 900.0), "a result in hand outlives an hour without database"
