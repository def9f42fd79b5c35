"""How long a browser is known for the person who has logged in with it."""

import time

import pytest
from fastapi import Request

from service.auth.cookies import KNOWN, KNOWN_S, Cookies


@pytest.mark.parametrize(
    ("seconds", "known"), [(3600, True), (-3600, True), (KNOWN_S - 60, True), (KNOWN_S + 60, False)]
)
def test_a_browser_stays_known_when_the_clock_jumps_and_not_for_ever(monkeypatch, seconds, known):
    def cookies(**given):
        header = [(b"cookie", f"{name}={value}".encode()) for name, value in given.items()]
        return Cookies(Request({"type": "http", "headers": header}), b"secret", None, secure=False)

    clock = time.time
    monkeypatch.setattr(time, "time", lambda: clock() - seconds)
    signed = cookies().serializer("known").dumps(["lea", "1234"])
    monkeypatch.undo()
    browser = cookies(**{KNOWN: signed})
    assert browser.known_browser("lea") == ("1234" if known else None)
    assert browser.known_browser("moe") is None
