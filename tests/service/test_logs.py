"""A line of code that warns again and again, as one does whose caller is outside, cannot fill the log."""

import io
import json
import logging

import pytest

from service import logs


@pytest.fixture
def log():
    """A logger, and a function that returns what it has written."""
    stream = io.StringIO()
    logger, handler = logging.Logger("test"), logs.handler(stream)
    logger.addHandler(handler)
    return logger, lambda: [json.loads(line) for line in stream.getvalue().splitlines()]


def warn(logger, times):
    for k in range(times):
        logger.warning("no descriptor for connection %s", k)


def test_a_repeated_warning_is_limited_and_the_next_period_says_how_many_were_left_out(log, monkeypatch):
    (logger, lines), now = log, 1000.0
    monkeypatch.setattr(logs.time, "monotonic", lambda: now)
    warn(logger, 1000)
    assert len(lines()) == logs.MOST_LINES
    logger.error("another line of code")
    assert lines()[-1]["message"] == "another line of code"
    now += logs.PERIOD_S
    warn(logger, 1000)
    assert len(lines()) == 2 * logs.MOST_LINES + 1
    assert [line.get("left_out") for line in lines()].count(1000 - logs.MOST_LINES) == 1


def test_every_line_below_a_warning_is_logged(log):
    logger, lines = log
    for _ in range(5 * logs.MOST_LINES):
        logger.info("request")
    assert len(lines()) == 5 * logs.MOST_LINES
