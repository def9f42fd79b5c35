"""A worker's sandbox: probed before it plays anything."""

import pytest

from service.sandbox.sandbox import Sandbox
from service.sandbox.seen import Fault
from service.sandbox.tier_b import tier_b
from service.workers import hand


def test_a_sandbox_with_a_hole_is_not_ready(monkeypatch):
    holed = Sandbox(tier_b(["landlock", "limits"]))
    monkeypatch.setattr(hand, "_sandbox", holed)
    try:
        with pytest.raises(Fault, match=r"a submission could .*open a socket"):
            hand.ready()
    finally:
        holed.close()


def test_a_worker_that_was_not_started_has_none(monkeypatch):
    monkeypatch.setattr(hand, "_sandbox", None)
    with pytest.raises(Fault, match="not started"):
        hand.ready()
