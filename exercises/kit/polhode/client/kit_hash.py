"""The build of the kit: a hash of its files, which tells whether two computers have the same kit."""

import functools
import hashlib
from collections.abc import Mapping
from pathlib import Path

from polhode import KIT

KIT_FOLDER = Path(__file__).parents[1]
WHEEL = f"polhode_kit-{KIT}-py3-none-any.whl"
"""File name of the kit's wheel. A notebook may contain its address for years, so it changes only with KIT."""


@functools.cache
def files() -> Mapping[str, bytes]:
    """Return the kit's modules, by their path in its wheel."""
    found = sorted(KIT_FOLDER.rglob("*.py"))
    return {f"polhode/{path.relative_to(KIT_FOLDER).as_posix()}": path.read_bytes() for path in found}


@functools.cache
def build() -> str:
    """Return the build of this computer's kit."""
    return digest(files())


def digest(content: Mapping[str, bytes]) -> str:
    """Return a hash of files by their paths."""
    found = hashlib.sha256()
    for name, data in sorted(content.items()):
        found.update(f"{name}\0{len(data)}\0".encode() + data)
    return found.hexdigest()[:16]
