"""The students' kit ``polhode-kit`` as a wheel, made of the one that is installed here, and the students'
notebook with its address.
"""

import functools
import json
from importlib import metadata

from exercises.authoring.assignments import packages
from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.publishing import zipfiles
from polhode import KIT
from polhode.client import kit_hash

DISTRIBUTION = "polhode-kit"


@functools.cache
def wheel() -> bytes:
    """Return the kit's wheel, byte for byte the same for the same content."""
    about = metadata.distribution(DISTRIBUTION).read_text("METADATA") or ""
    return zipfiles.wheel(f"polhode_kit-{KIT}.dist-info", about, kit_hash.files())


def notebook(assignment: Assignment, server: str, kit: str) -> bytes:
    """Return the notebook for students with the addresses of ``server`` and ``kit`` and the list of
    importable packages.
    """
    text, listing = assignment.notebook(), packages.listing(assignment.packages)
    installed = " ".join([kit, *sorted(set(assignment.packages))])
    for mark, value in {"{{SERVER}}": server, "{{KIT_URL}}": installed, "{{PACKAGES}}": listing}.items():
        text = text.replace(mark, json.dumps(value)[1:-1])
    return text.encode()
