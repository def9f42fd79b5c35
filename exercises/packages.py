"""Packages that submissions can import: those in every sandbox, and those an assignment declares (``packages``)."""

import functools
import os
import re
import sys
import sysconfig
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path

SANDBOX = ("numpy", "scipy", "matplotlib")
"""Distributions in every sandbox."""
SITE_PACKAGES = Path(sysconfig.get_path("purelib"))


def missing(names: Iterable[str]) -> list[str]:
    """Return the distributions that are not installed on this server."""
    return [name for name in names if version(name) is None]


def versions(names: Collection[str] = ()) -> dict[str, str]:
    """Return the versions of Python, of the distributions in every sandbox, and of those of ``names`` that
    are installed.
    """
    found = {name: version(name) for name in [*SANDBOX, *names]}
    return {"python": sys.version.split()[0]} | {name: known for name, known in found.items() if known is not None}


def listing(names: Collection[str] = ()) -> str:
    """Return the versions as a phrase: "numpy 2.1.3, scipy 1.14.1, matplotlib 3.9.2 and the standard library
    of Python 3.11".
    """
    found = versions(names)
    python = ".".join(found.pop("python").split(".")[:2])
    return f"{', '.join(f'{name} {version}' for name, version in found.items())} and the standard library of Python {python}"


def version(name: str) -> str | None:
    """Return the version of a distribution, or None if it is not installed."""
    if folder := metadata_folder(name):
        return folder.stem.partition("-")[2]
    from importlib.metadata import PackageNotFoundError, version  # elsewhere, or of an older format

    try:
        return version(name)
    except (PackageNotFoundError, ValueError):  # ValueError: an empty name
        return None


def metadata_folder(name: str) -> Path | None:
    """Return the folder NAME-VERSION.dist-info of a distribution in site-packages, or None.

    Importing importlib.metadata, which reads the metadata as an email, and asking it takes 20 ms: a tenth of ``polhode grade``.
    """
    return _metadata_folders(SITE_PACKAGES.stat().st_mtime_ns).get(_normalized(name))


@functools.lru_cache(maxsize=1)
def _metadata_folders(changed: int) -> Mapping[str, Path]:
    names = [name for name in os.listdir(SITE_PACKAGES) if name.endswith(".dist-info")]
    return {_normalized(name.partition("-")[0]): SITE_PACKAGES / name for name in names}


def _normalized(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()
