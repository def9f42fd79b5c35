"""Ticks of a time axis for ranges from minutes to years."""

from datetime import UTC, datetime, timedelta
from zoneinfo import ZoneInfo

import pytest

from service.http.templating import ZONE
from service.pages.class_view.time_axis import STEPS, ticks

START = datetime(2026, 10, 24, 21, 58, 30, tzinfo=UTC)


@pytest.mark.parametrize(
    ("length", "labels"),
    [
        (timedelta(minutes=2), ["24 Oct 21:59", "22:00"]),
        (timedelta(minutes=5), ["24 Oct 22:00", "22:02"]),
        (timedelta(hours=5), ["24 Oct 22:00", "25 Oct 00:00", "02:00"]),
        (timedelta(days=3), ["25 Oct", "26 Oct", "27 Oct"]),
        (timedelta(days=30), ["25 Oct", "08 Nov", "22 Nov"]),
        (timedelta(days=120), ["25 Oct", "20 Dec", "14 Feb"]),
    ],
)
def test_ticks_are_at_whole_minutes_hours_or_days(length, labels):
    assert [label for _, label in ticks(START, START + length)] == labels


@pytest.mark.parametrize("zone", ["UTC", "Europe/Berlin", "Asia/Kolkata", "Pacific/Auckland"])
def test_every_range_has_a_few_ticks_inside_it(zone):
    token = ZONE.set(ZoneInfo(zone))
    try:
        for seconds in (120, 299, *STEPS[1:], *(3 * step + 7 for step in STEPS), 3 * 365 * 86400):
            until = START + timedelta(seconds=seconds)
            found = [at for at, _ in ticks(START, until)]
            assert all(START <= at <= until for at in found) and len(found) <= 9, seconds
            assert len(found) >= 1, seconds
    finally:
        ZONE.reset(token)
