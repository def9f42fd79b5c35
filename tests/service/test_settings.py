"""What a server does with no setting, and values that are refused."""

import pytest
from pydantic import ValidationError

from service.settings import Settings


def test_a_run_is_lost_after_two_seconds_and_a_database_waited_for_five(monkeypatch):
    for name in ("POLHODE_LEASE", "POLHODE_DATABASE_WAIT", "POLHODE_DRAIN"):
        monkeypatch.delenv(name, raising=False)
    settings = Settings()
    assert (settings.lease, settings.database_wait, settings.drain) == (2.0, 5.0, 3.0)


def test_a_grading_has_sixty_seconds_of_CPU_time_and_twice_as_many_in_all(monkeypatch):
    for name in ("POLHODE_GRADING_CPU", "POLHODE_GRADING_WALL"):
        monkeypatch.delenv(name, raising=False)
    assert (Settings().grading_cpu, Settings().grading_wall) == (60.0, 120.0)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("LEASE", "0.3"),
        ("LEASE", "61"),
        ("DATABASE_WAIT", "0"),
        ("DRAIN", "-1"),
        ("GRADING_CPU", "0"),
        ("GRADING_WALL", "inf"),
    ],
)
def test_times_out_of_range_are_refused(name, value, monkeypatch):
    monkeypatch.setenv(f"POLHODE_{name}", value)
    with pytest.raises(ValidationError):
        Settings()


def test_an_upload_holds_a_submission_in_its_longest_form(monkeypatch):
    assert (Settings().submission_kib, Settings().upload_mib) == (256, 20)
    monkeypatch.setenv("POLHODE_SUBMISSION_KIB", "4096")
    with pytest.raises(
        ValidationError, match="POLHODE_UPLOAD_MIB must hold at least 6 times POLHODE_SUBMISSION_KIB"
    ):
        Settings()
    monkeypatch.setenv("POLHODE_UPLOAD_MIB", "24")
    assert Settings().submission_kib == 4096


@pytest.mark.parametrize("level", ["namespaces", "process"])
def test_the_weakest_isolation_level_is_a_setting(level, monkeypatch):
    assert Settings().min_isolation == "process"
    monkeypatch.setenv("POLHODE_MIN_ISOLATION", level)
    assert Settings().min_isolation == level


def test_an_unknown_isolation_level_is_refused(monkeypatch):
    monkeypatch.setenv("POLHODE_MIN_ISOLATION", "C")
    with pytest.raises(ValidationError):
        Settings()
