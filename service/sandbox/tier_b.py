"""Tier B: no namespaces (an ordinary container forbids them): the child's own layers are all there is.

What stays visible is the existence, size and times of files the guest's user may look up; as root that is another user than the
server's, and the data folder is closed to it.
"""

from collections.abc import Collection

from service.sandbox.needs import DEVICES, GUEST, interpreter, kit, packages, runtime, site_packages
from service.sandbox.walls import ENVIRONMENT, LAYERS, Walls, boot


def tier_b(layers: Collection[str] = LAYERS) -> Walls:
    """Walls without namespaces. Fewer ``layers`` are for tests of what each of them stops."""
    import matplotlib

    path = [str(GUEST.parent), str(kit().parent), str(site_packages())]
    readable = [*map(str, runtime()), *(str(site_packages() / name) for name in packages()), str(GUEST), str(kit()), *DEVICES]
    inside = boot(interpreter(), path, layers, readable, path)
    return Walls(
        "B",
        tuple(x for x in LAYERS if x in layers),
        (),
        inside,
        ENVIRONMENT | {"MPLCONFIGDIR": matplotlib.get_cachedir(), "HOME": "/"},
    )
