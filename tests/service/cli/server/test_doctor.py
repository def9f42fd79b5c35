"""``polhode doctor``: which isolation this machine gives, why not a better one, and whether it is enough."""

import os

import pytest

from service.cli.__main__ import main
from service.sandbox.guest.confinement.lockdown import GUEST_UID
from service.sandbox.isolation import levels, select


@pytest.mark.slow
def test_the_isolation_level_and_what_was_tried_against_it(capsys):
    assert main(["doctor"]) == 0
    printed = capsys.readouterr().out
    assert (
        "isolation     namespaces: bubblewrap" in printed
        and "all 16 forbidden operations were blocked" in printed
    )
    user = GUEST_UID if os.geteuid() == 0 else os.getuid()
    assert f"guest         user {user}, groups " in printed and "capabilities none" in printed


def test_a_guest_that_is_root_is_reported_and_refused(capsys, monkeypatch):
    if os.geteuid() != 0:
        pytest.skip("needs root")
    monkeypatch.setattr(select, "find_bubblewrap", lambda: None)
    monkeypatch.setattr(
        levels, "_refused_to_change_user", lambda: "root may not change to user 64001 here (EPERM)"
    )
    assert main(["doctor"]) == 2
    printed = capsys.readouterr().out
    assert (
        "guest         user 0 (root), groups 0" in printed
        and "because root may not change to user 64001 here" in printed
    )


def test_why_it_is_not_a_better_one(capsys, monkeypatch):
    monkeypatch.setattr(select, "find_bubblewrap", lambda: None)
    assert main(["doctor"]) == 0
    printed = capsys.readouterr().out
    assert (
        "namespaces    no: bubblewrap is not installed" in printed
        and "isolation     process: landlock" in printed
    )


def test_less_than_the_operator_asked_for_is_exit_2(capsys, monkeypatch):
    monkeypatch.setattr(select, "find_bubblewrap", lambda: None)
    monkeypatch.setenv("POLHODE_MIN_ISOLATION", "namespaces")
    assert main(["doctor"]) == 2
    assert "isolation     none" in capsys.readouterr().out
