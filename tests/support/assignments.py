"""A small assignment of several files in a folder of its own, known to this process for a while."""

import contextlib
import os
import shutil
import sys
from pathlib import Path

from exercises.authoring.assignments import catalogue, course_packages
from exercises.authoring.assignments.catalogue import load_catalogue
from exercises.authoring.publishing import public_assignment

TEMPLATE = Path(__file__).parents[1] / "assignments" / "damped_oscillator"


def copied(to, name="damped_oscillator"):
    """The folder tests/assignments/damped_oscillator in ``to``, perhaps under another name."""
    return shutil.copytree(TEMPLATE, to / name, ignore=shutil.ignore_patterns("__pycache__"))


def change(file, old, new):
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))


@contextlib.contextmanager
def known(*paths):
    """These are what POLHODE_ASSIGNMENTS names, beside rigid-body and whatever else lies in exercises/ of
    this tree not.
    """
    before, modules, here = os.environ.get(catalogue.SETTING), set(sys.modules), catalogue._here
    catalogue._here = lambda: [folder for folder in here() if folder.name == "rigid_body"]
    os.environ[catalogue.SETTING] = os.pathsep.join(map(str, paths))
    _forget_what_depends_on_it()
    try:
        yield load_catalogue()
    finally:
        os.environ.pop(catalogue.SETTING)
        if before is not None:
            os.environ[catalogue.SETTING] = before
        catalogue._here = here
        for name in set(sys.modules) - modules:
            if name.startswith("exercises."):
                del sys.modules[name]
        _forget_what_depends_on_it()


def _forget_what_depends_on_it():
    for cached in (
        load_catalogue,
        catalogue._load,
        course_packages._errors,
        public_assignment.build,
        public_assignment.archive,
        public_assignment._content,
    ):
        cached.cache_clear()
