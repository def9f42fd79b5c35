"""``polhode doctor``: which isolation this machine gives, why not a better one, and whether it is enough."""

from service.cli.__main__ import main
from service.sandbox import select


def test_the_isolation_level_and_what_was_tried_against_it(capsys):
    assert main(["doctor"]) == 0
    printed = capsys.readouterr().out
    assert "isolation     namespaces: bubblewrap" in printed and "all 14 forbidden operations were blocked" in printed


def test_why_it_is_not_a_better_one(capsys, monkeypatch):
    monkeypatch.setattr(select, "find_bubblewrap", lambda: None)
    assert main(["doctor"]) == 0
    printed = capsys.readouterr().out
    assert "namespaces    no: bubblewrap is not installed" in printed and "isolation     process: landlock" in printed


def test_less_than_the_operator_asked_for_is_exit_2(capsys, monkeypatch):
    monkeypatch.setattr(select, "find_bubblewrap", lambda: None)
    monkeypatch.setenv("POLHODE_MIN_ISOLATION", "namespaces")
    assert main(["doctor"]) == 2
    assert "isolation     none" in capsys.readouterr().out
