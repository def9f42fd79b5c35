"""A short chaos: what ``make chaos`` does for long."""

import pytest

from service.cli.server.demo import free_port
from tests.support.chaos import Chaos, lost


@pytest.mark.slow  # single deaths, freezes and outages are in test_workers.py and test_outage.py
def test_nothing_is_lost_in_a_short_chaos(tmp_path):
    chaos = Chaos(tmp_path / "data", free_port(), seed=3)
    try:
        told = chaos.run(20)
    finally:
        chaos.stop()
    told["processes left"] = chaos.left
    assert not lost(told), told
    assert told["harm"] >= 20 and told["accepted"] >= 10, told
