"""Isolation of a guest: the command that starts it and the layers that its children apply, at one of two
isolation levels.
"""

import functools
import json
import os
import subprocess
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from exercises.authoring.assignments.catalogue import course_folders
from exercises.authoring.assignments.course_imports import libraries
from service.sandbox.guest.confinement.lockdown import GUEST_UID
from service.sandbox.isolation.guest_files import (
    BASE_PREFIX,
    DEVICES,
    GUEST,
    INTERPRETER,
    KIT,
    SITE_PACKAGES,
    STANDARD_LIBRARY,
    packages,
    runtime,
)

BOOT = """
import json, sys
settings = json.loads(sys.argv[1])
sys.path += settings.pop("path")
from guest.zygote import main
main(int(sys.argv[2]), *sys.argv[3:], **settings)
"""
# Opens folders as root and runs the command with /proc/self/fd/N in place of their paths: see
# `process_isolation`.
OPEN_FOLDERS = """
import fcntl, json, os, re, sys
folders, command = json.loads(sys.argv[1]), sys.argv[2:]
for folder in sorted(folders, key=len, reverse=True):
    number = fcntl.fcntl(os.open(folder, os.O_PATH | os.O_DIRECTORY), fcntl.F_DUPFD, 100)
    whole = re.compile(r'(?<![^"])' + re.escape(folder) + r'(?=["/]|$)')
    command = [whole.sub(f"/proc/self/fd/{number}", argument) for argument in command]
os.execv(command[0], command)
"""
CHANGE_USER = (
    f"import os; os.setgroups([]); os.setresgid(*[{GUEST_UID}] * 3); os.setresuid(*[{GUEST_UID}] * 3)"
)
OWN_FOLDERS = Path("/proc/self/fd")
TRY_S = 20.0
DATA, SCRATCH = ".", "../scratch"
"""Folders of a guest process: its working folder, which it and its children may read and in which its host
process puts data files, and that of the scratch folders, which namespaces have inside.
"""
Level = Literal["namespaces", "process"]
# applied by each child; bubblewrap adds namespaces around the zygote
LAYERS = ("landlock", "seccomp", "limits")
ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MALLOC_ARENA_MAX": "1",
    "MPLBACKEND": "Agg",
    "LC_ALL": "C.UTF-8",
    "PYTHONHASHSEED": "0",
    "PATH": "/usr/bin:/bin",
} | {name: os.environ[name] for name in ("OPENBLAS_CORETYPE",) if name in os.environ}
"""Environment of a guest. Results depend in the last digits on OpenBLAS's kernel, so a pinned
OPENBLAS_CORETYPE is passed on.
"""


@dataclass(frozen=True)
class Isolation:
    """The isolation of a guest: its ``level``, its ``layers``, and the command and environment that start it.

    The command is ``around`` followed by ``inside``, the interpreter's own command. The host appends the
    arguments of the zygote's ``main`` that are not in ``inside``. ``stays_root`` says why the guest of a
    server that runs as root cannot change to an unprivileged user; such a guest fails the self-test unless
    ``allow_root`` is set.
    """

    level: Level
    layers: tuple[str, ...]
    around: tuple[str, ...]
    inside: tuple[str, ...]
    environment: Mapping[str, str]
    stays_root: str = ""
    allow_root: bool = False

    @property
    def name(self) -> str:
        """Return the level and its layers as reports show them."""
        user = " (the guest runs as root)" if self.stays_root else ""
        return f"{self.level}: {', '.join(self.layers) or 'no layers'}{user}"

    @property
    def command(self) -> tuple[str, ...]:
        """Return the command without the number of the control socket."""
        return self.around + self.inside


def zygote_command(**settings: Any) -> tuple[str, ...]:
    """Return the command that starts a zygote with these ``settings``: its import ``path``, and the arguments
    of its ``main``.
    """
    return (
        str(INTERPRETER),
        "-I",
        "-S",
        "-B",
        "-c",
        BOOT,
        json.dumps(settings, default=str, ensure_ascii=False),
    )


def process_isolation(
    layers: Collection[str] = LAYERS, more: Collection[str] = (), allow_root: bool = False
) -> Isolation:
    """Return isolation without namespaces. The guest can also import the distributions ``more``.

    A guest started as root changes to an unprivileged user. If the interpreter or the packages lie below a
    folder closed to that user, such as /root, root opens their own folders first and the guest finds its
    files through these descriptors: a child imports most modules only when a submission needs them. Tests
    leave out ``layers`` to show what each one stops.
    """
    import matplotlib

    course = course_folders()
    path = [GUEST.parent, KIT.parent, SITE_PACKAGES, *course]
    readable = [
        *runtime(),
        *(SITE_PACKAGES / name for name in packages(more)),
        GUEST,
        KIT,
        *course,
        *map(Path, DEVICES),
    ]
    folders = [folder for folder in dict.fromkeys((*path, BASE_PREFIX)) if not _reachable(folder)]
    stays_root = reason_to_stay_root([*readable, *path]) or _reason_unreachable([*readable, *path], folders)
    user = GUEST_UID if os.geteuid() == 0 and not stays_root else None
    opened = folders if user is not None else []
    applied = [x for x in LAYERS if x in layers]
    inside = zygote_command(
        path=path,
        course=course,
        libraries=libraries(course),
        user=user,
        layers=applied,
        readable=[*readable, DATA],
        listable=[*path, STANDARD_LIBRARY],
        folders=opened,
        scratch=SCRATCH,
    )
    around = (
        (str(INTERPRETER), "-I", "-S", "-c", OPEN_FOLDERS, json.dumps(opened, default=str)) if opened else ()
    )
    environment = ENVIRONMENT | {"MPLCONFIGDIR": matplotlib.get_cachedir(), "HOME": "/"}
    return Isolation("process", tuple(applied), around, inside, environment, stays_root, allow_root)


def reason_to_stay_root(paths: Sequence[Path]) -> str:
    """Return why a guest that root starts cannot be another user who reads ``paths``, apart from the folders
    above them.

    Return an empty string if it can, and if this process does not run as root.
    """
    if os.geteuid() != 0:
        return ""
    if refused := _refused_to_change_user():
        return refused
    return next(
        (
            f"{path} is closed to other users"
            for path in paths
            if path.name != "__pycache__" and not _open(path)
        ),
        "",
    )


@functools.cache
def _refused_to_change_user() -> str:
    """Return why this machine does not let root become the guest's user, or an empty string if it does."""
    try:
        subprocess.run(
            ["/bin/true"], user=GUEST_UID, group=GUEST_UID, extra_groups=[], timeout=TRY_S, check=True
        )
    except (OSError, subprocess.SubprocessError) as reason:
        return f"root may not change to user {GUEST_UID} here ({reason})"
    return ""


def _reason_unreachable(paths: Sequence[Path], folders: Sequence[Path]) -> str:
    """Return why another user cannot reach one of ``paths`` if root opens ``folders`` for it, or an empty
    string.
    """
    if os.geteuid() != 0:
        return ""
    if folders and not OWN_FOLDERS.is_dir():
        return f"{folders[0]} lies below a folder closed to other users, and {OWN_FOLDERS} is missing"
    return next(
        (
            f"{path} lies below a folder closed to other users"
            for path in paths
            if not _reachable(path, folders)
        ),
        "",
    )


def _open(path: Path) -> bool:
    """Return whether every user of this machine may read ``path`` once they have reached it."""
    needed = 0o005 if path.is_dir() else 0o004
    return path.stat().st_mode & needed == needed


def _reachable(path: Path, opened: Sequence[Path] = ()) -> bool:
    """Return whether every user of this machine may reach ``path`` from the root folder or from one of the
    ``opened`` folders.
    """
    ways = [
        path.parents,
        *(list(path.parents)[: len(path.relative_to(f).parts)] for f in opened if path.is_relative_to(f)),
    ]
    return any(all(folder.stat().st_mode & 0o001 for folder in way) for way in ways)
