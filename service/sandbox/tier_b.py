"""Tier B: no namespaces (an ordinary container forbids them): the child's own layers are all there is.

What stays visible is the existence, size and times of files the guest's user may look up. A server that is root gives its guest
another user, to whom the data folder is closed, unless that user could not even read the libraries.
"""

import os
from collections.abc import Collection
from pathlib import Path

from service.sandbox.guest.lockdown import GUEST_UID
from service.sandbox.needs import DEVICES, GUEST, interpreter, kit, packages, runtime, site_packages, standard_library
from service.sandbox.walls import ENVIRONMENT, LAYERS, Guest, Walls


def tier_b(layers: Collection[str] = LAYERS, more: Collection[str] = ()) -> Walls:
    """Walls without namespaces, with ``more`` packages to import. Fewer ``layers`` are for tests of what each of them stops."""
    import matplotlib

    path = [str(GUEST.parent), str(kit().parent), str(site_packages())]
    readable = [*map(str, runtime()), *(str(site_packages() / name) for name in packages(more)), str(GUEST), str(kit()), *DEVICES]
    standing = [x for x in LAYERS if x in layers]
    user = GUEST_UID if os.geteuid() == 0 and all(map(_open_to_all, [*readable, *path])) else None
    environment = ENVIRONMENT | {"MPLCONFIGDIR": matplotlib.get_cachedir(), "HOME": "/"}
    return Walls(
        "B",
        tuple(standing),
        (),
        Guest(path, user, standing, readable, [*path, str(standard_library())]).command(interpreter()),
        environment,
    )


def _open_to_all(path: str) -> bool:
    """Whether any user can get there and read."""
    folders = all(parent.stat().st_mode & 0o001 for parent in Path(path).parents)
    return folders and bool(Path(path).stat().st_mode & 0o004)
