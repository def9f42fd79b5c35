"""Verification of the course's own packages: each is imported in the sandbox, as a submission imports it."""

from collections.abc import Iterator
from contextlib import closing

from exercises.authoring.assignments import course_packages
from service.sandbox.isolation.levels import Isolation
from service.sandbox.job import Cell, Job
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox


def import_errors(isolation: Isolation) -> Iterator[str]:
    """Yield a sentence for each of the course's modules that cannot be imported, with file and line."""
    modules = sorted(course_packages.modules())
    with closing(Sandbox(isolation)) as sandbox:
        for name in modules:
            try:
                played = sandbox.play(Job("", "", (Cell("course", f"import {name}"),), (), ()))
            except SystemFault as error:
                yield f"the course's module {name} cannot be imported in the sandbox: {error}"
                continue
            for end in played.cells.values():
                yield f"the course's module {name} cannot be imported in the sandbox: {end.sentence}"
