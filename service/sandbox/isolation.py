"""Isolation of a guest: the command that starts it and the layers that its children apply, at one of two isolation levels."""

import json
import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

from service.sandbox.guest.lockdown import GUEST_UID
from service.sandbox.guest_files import DEVICES, GUEST, interpreter, kit, packages, runtime, site_packages, standard_library

BOOT = """
import json, sys
settings = json.loads(sys.argv[1])
sys.path += settings.pop("path")
from guest.zygote import main
main(int(sys.argv[2]), **settings)
"""
Level = Literal["namespaces", "process"]
LAYERS = ("landlock", "seccomp", "limits")  # applied by each child; bubblewrap adds namespaces around the zygote
ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MALLOC_ARENA_MAX": "1",
    "MPLBACKEND": "Agg",
    "LC_ALL": "C.UTF-8",
    "PYTHONHASHSEED": "0",
    "PATH": "/usr/bin:/bin",
} | {name: os.environ[name] for name in ("OPENBLAS_CORETYPE",) if name in os.environ}
"""Environment of a guest. Results depend in the last digits on OpenBLAS's kernel, so a pinned OPENBLAS_CORETYPE is passed on."""


@dataclass(frozen=True)
class Isolation:
    """The isolation of a guest: its ``level``, its ``layers``, and the command and environment that start it.

    The command is ``around`` followed by ``inside``, the interpreter's own command. The host appends the number of the zygote's
    control socket.
    """

    level: Level
    layers: tuple[str, ...]
    around: tuple[str, ...]
    inside: tuple[str, ...]
    environment: Mapping[str, str]

    @property
    def name(self) -> str:
        """Return the level and its layers as reports show them."""
        return f"{self.level}: {', '.join(self.layers) or 'no layers'}"

    @property
    def command(self) -> tuple[str, ...]:
        """Return the command without the number of the control socket."""
        return self.around + self.inside


@dataclass(frozen=True)
class Guest:
    """Settings of a zygote.

    ``path`` is its import path and ``user`` the user id that it changes to (None: unchanged). Its children apply ``layers``,
    which let them read below ``readable`` and list below ``listable``.
    """

    path: Sequence[str]
    user: int | None
    layers: Sequence[str]
    readable: Sequence[str]
    listable: Sequence[str]

    def command(self, interpreter: Path) -> tuple[str, ...]:
        """Return the command that starts the zygote with ``interpreter``."""
        return (str(interpreter), "-I", "-S", "-B", "-c", BOOT, json.dumps(asdict(self)))


def process_isolation(layers: Collection[str] = LAYERS, more: Collection[str] = ()) -> Isolation:
    """Return isolation without namespaces. The guest can also import the distributions ``more``.

    Tests leave out ``layers`` to show what each one stops.
    """
    import matplotlib

    path = [str(GUEST.parent), str(kit().parent), str(site_packages())]
    readable = [*map(str, runtime()), *(str(site_packages() / name) for name in packages(more)), str(GUEST), str(kit()), *DEVICES]
    applied = [x for x in LAYERS if x in layers]
    user = GUEST_UID if os.geteuid() == 0 and all(map(_open_to_all, [*readable, *path])) else None
    environment = ENVIRONMENT | {"MPLCONFIGDIR": matplotlib.get_cachedir(), "HOME": "/"}
    return Isolation(
        "process",
        tuple(applied),
        (),
        Guest(path, user, applied, readable, [*path, str(standard_library())]).command(interpreter()),
        environment,
    )


def _open_to_all(path: str) -> bool:
    """Return whether every user of this machine may read ``path``."""
    folders = all(parent.stat().st_mode & 0o001 for parent in Path(path).parents)
    return folders and bool(Path(path).stat().st_mode & 0o004)
