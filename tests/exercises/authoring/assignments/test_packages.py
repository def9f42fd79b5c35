"""Packages of the sandbox: which are installed, in words, and how an assignment declares more."""

import re
from dataclasses import replace
from importlib import metadata

import numpy as np
import pytest

from exercises.authoring.assignments import packages, validation
from exercises.authoring.assignments.catalogue import assignments
from tests.support.checkout import ROOT


def test_every_sandbox_has_numpy_scipy_and_matplotlib():
    assert packages.versions()["numpy"] == np.__version__ and not packages.missing(packages.SANDBOX)
    assert re.fullmatch(
        r"numpy [\d.]+, scipy [\d.]+, matplotlib [\d.]+ and the standard library of Python 3\.\d+",
        packages.listing(),
    )


def test_what_is_installed_is_listed_and_what_is_not_is_missing():
    assert packages.missing(["iniconfig", "no-such-package", ""]) == ["no-such-package", ""]
    assert ", iniconfig " in packages.listing(["iniconfig"]) and "no-such" not in packages.listing(
        ["no-such-package"]
    )


def test_versions_are_those_of_importlib_metadata(tmp_path, monkeypatch):
    (tmp_path / "old.egg-info").write_text("Metadata-Version: 1.0\nName: old\nVersion: 3\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    known = {found.metadata["Name"]: found.version for found in metadata.distributions()}
    assert (
        {name: packages.version(name) for name in known} == known and known["old"] == "3" and len(known) > 20
    )


@pytest.mark.parametrize("declared", [("",), (1,), "sympy"])
def test_an_assignment_declares_names(rigid_body, declared):
    (error,) = validation.errors(replace(rigid_body, packages=declared))
    assert error == f"packages is {declared!r}, not a tuple of names"


def test_an_installation_of_polhode_has_the_packages_of_the_courses_assignments():
    lock = (ROOT / "requirements/runtime.lock").read_text()
    declared = {
        name
        for one in assignments().values()
        if one.folder.parent == ROOT / "exercises"
        for name in one.packages
    }
    assert "sympy" in declared
    assert not [name for name in declared if not re.search(rf"^{name}==", lock, re.MULTILINE)], (
        "see make lock"
    )
