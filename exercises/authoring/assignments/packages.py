"""Packages that submissions can import: those in every sandbox, and those an assignment declares
(``packages``).
"""

import platform
import re
from collections.abc import Collection, Iterable
from importlib import metadata

FOR_STUDENTS = ("numpy", "scipy", "matplotlib")
"""Distributions that every submission can use."""
SANDBOX = (*FOR_STUDENTS, "ipython")
"""Distributions in every sandbox: IPython runs the cells of notebooks."""


def missing(names: Iterable[str]) -> list[str]:
    """Return the distributions that are not installed on this server."""
    return [name for name in names if not _installed(name)]


def versions(names: Collection[str] = ()) -> dict[str, str]:
    """Return the versions of Python, of the distributions that every submission can use, and of those of
    ``names`` that are installed.
    """
    found = {name: version(name) for name in [*FOR_STUDENTS, *names] if _installed(name)}
    return {"python": platform.python_version()} | found


def listing(names: Collection[str] = ()) -> str:
    """Return what a submission can import as a phrase: "numpy 2.1.3, scipy 1.14.1, matplotlib 3.9.2 and the
    standard library of Python 3.11".
    """
    found = versions(names)
    python = ".".join(found.pop("python").split(".")[:2])
    return (
        f"{', '.join(f'{name} {version}' for name, version in found.items())} and the standard library of"
        f" Python {python}"
    )


def version(name: str) -> str:
    """Return the version of a distribution. Raises PackageNotFoundError if it is not installed.

    ``metadata.version`` parses the whole README of the distribution too, ten times as long.
    """
    header = metadata.distribution(name).read_text("METADATA") or ""
    return (
        found[1]
        if (found := re.search(r"^Version: *(.+)$", header, re.MULTILINE))
        else metadata.version(name)
    )


def with_requirements(names: Iterable[str]) -> dict[str, metadata.Distribution]:
    """Return these distributions and their requirements by name, as far as they are installed."""
    todo, found, done = set(names), dict[str, metadata.Distribution](), set[str]()
    while todo:
        name = todo.pop()
        done.add(name)
        try:
            found[name] = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            continue
        # parsing all of the header, as ``requires`` does, takes 20 ms
        header = (found[name].read_text("METADATA") or "").partition("\n\n")[0]
        lines = re.findall(r"^Requires-Dist: (.+)$", header, re.MULTILINE)
        required = [line for line in lines if "extra ==" not in line]
        todo |= {re.split(r"[ <>=!~;\[(]", line, maxsplit=1)[0].lower() for line in required} - done
    return found


def _installed(name: str) -> bool:
    return bool(name) and any(metadata.distributions(name=name))
