import pytest

from service.cli.grading_settings import Defaults, read_settings
from service.settings import Settings


def test_the_defaults_are_those_of_the_settings(monkeypatch):
    for name in ("POLHODE_WORKERS", "polhode_grading_cpu"):
        monkeypatch.delenv(name, raising=False)
    settings = Settings()
    assert Defaults()._asdict() == {name: getattr(settings, name) for name in Defaults._fields}


@pytest.mark.parametrize(
    ("name", "value", "read"), [("POLHODE_GRADING_CPU", "7", 7.0), ("POLHODE_COURSE", "waves", 60.0)]
)
def test_a_setting_in_the_environment_applies(monkeypatch, name, value, read):
    monkeypatch.setenv(name, value)
    assert read_settings().grading_cpu == read
