"""The seam: what shuts a guest in is a command that starts it and the layers its children put up. Two tiers are real, A and B."""

import json
import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from service.sandbox.guest.lockdown import GUEST_UID
from service.sandbox.guest_files import DEVICES, GUEST, interpreter, kit, packages, runtime, site_packages, standard_library

BOOT = """
import json, sys
settings = json.loads(sys.argv[1])
sys.path += settings.pop("path")
from guest.zygote import main
main(int(sys.argv[2]), **settings)
"""
LAYERS = ("landlock", "seccomp", "limits")  # of the child; bubblewrap's namespaces are the fourth, of the zygote
ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MALLOC_ARENA_MAX": "1",
    "MPLBACKEND": "Agg",
    "LC_ALL": "C.UTF-8",
    "PYTHONHASHSEED": "0",
    "PATH": "/usr/bin:/bin",
} | {name: os.environ[name] for name in ("OPENBLAS_CORETYPE",) if name in os.environ}
"""What a guest has around it. The last digits depend on the processor that OpenBLAS sees: who pins it does so for guests too."""


@dataclass(frozen=True)
class Isolation:
    """How a guest is shut in: its ``tier``, what stands (``layers``), and the command and environment that start it.

    ``around`` comes before the interpreter's own command; the guest's control socket number is appended to both.
    """

    tier: str
    layers: tuple[str, ...]
    around: tuple[str, ...]
    inside: tuple[str, ...]
    environment: Mapping[str, str]

    @property
    def name(self) -> str:
        """For reports: the tier and its layers."""
        return f"tier {self.tier}: {', '.join(self.layers) or 'nothing'}"

    @property
    def command(self) -> tuple[str, ...]:
        """All but the control socket."""
        return self.around + self.inside


@dataclass(frozen=True)
class Guest:
    """What a zygote is told: where it imports from, whom it becomes (None: it stays who it is), and what its children's layers are
    and leave to read and to list."""

    path: Sequence[str]
    user: int | None
    layers: Sequence[str]
    readable: Sequence[str]
    listable: Sequence[str]

    def command(self, interpreter: Path) -> tuple[str, ...]:
        """The interpreter's command."""
        return (str(interpreter), "-I", "-S", "-B", "-c", BOOT, json.dumps(asdict(self)))


def process_isolation(layers: Collection[str] = LAYERS, more: Collection[str] = ()) -> Isolation:
    """Walls without namespaces, with ``more`` packages to import. Fewer ``layers`` are for tests of what each of them stops."""
    import matplotlib

    path = [str(GUEST.parent), str(kit().parent), str(site_packages())]
    readable = [*map(str, runtime()), *(str(site_packages() / name) for name in packages(more)), str(GUEST), str(kit()), *DEVICES]
    standing = [x for x in LAYERS if x in layers]
    user = GUEST_UID if os.geteuid() == 0 and all(map(_open_to_all, [*readable, *path])) else None
    environment = ENVIRONMENT | {"MPLCONFIGDIR": matplotlib.get_cachedir(), "HOME": "/"}
    return Isolation(
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
