"""A root of its own as a container has one: the machine's programs read-only, no network, no right to make
namespaces.

Of our checkout and its virtual environment nothing is in there but the libraries, at the places ``virtual``
has for them.
"""

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

from service.sandbox.isolation.bubblewrap import find_bubblewrap

OURS = ("polhode", "_polhode", "__pycache__")
# a virtual environment gets its own
OF_PIP = (
    "pip",
    "setuptools",
    "pkg_resources",
    "_distutils_hack",
    "distutils-precedence",
)
# such as Docker leaves; SYS_ADMIN is not among them
ROOTS_RIGHTS = (
    "CHOWN",
    "DAC_OVERRIDE",
    "FOWNER",
    "KILL",
    "SETGID",
    "SETUID",
)


class Container:
    """Programs run in there find ``home`` at /autograder, and the libraries installed in the virtual
    environment ``virtual``.
    """

    def __init__(self, home: Path, virtual: str):
        self._around = [
            find_bubblewrap(),
            *_rights(),
            *_machine(),
            "--bind",
            str(home),
            "/autograder",
            *_libraries(virtual),
        ]
        self._around += ["--chdir", "/autograder", "--clearenv"]

    def run(self, *command, **environment):
        variables = {
            "PATH": f"{sys.base_prefix}/bin:/usr/bin:/bin",
            "HOME": "/tmp",
            "LC_ALL": "C.UTF-8",
        } | environment
        told = [part for pair in variables.items() for part in ("--setenv", *pair)]
        return subprocess.run(
            [*self._around, *told, "--", *command], capture_output=True, text=True, check=False, timeout=120
        )


def _rights():
    apart = ["--die-with-parent", "--unshare-pid", "--unshare-net", "--unshare-ipc"]
    if os.geteuid() != 0:
        return [*apart, "--unshare-user", "--disable-userns"]
    return [
        *apart,
        "--cap-drop",
        "ALL",
        *(part for right in ROOTS_RIGHTS for part in ("--cap-add", f"CAP_{right}")),
    ]


def _machine():
    args = ["--proc", "/proc", "--dev", "/dev", "--perms", "1777", "--tmpfs", "/tmp"]
    for folder in map(Path, ("/usr", "/etc", "/bin", "/sbin", "/lib", "/lib64")):
        if folder.is_symlink():
            args += ["--symlink", os.readlink(folder), str(folder)]
        elif folder.exists():
            args += ["--ro-bind", str(folder), str(folder)]
    return [
        *args,
        *_open_folders(Path(sys.base_prefix).parents[:-1]),
        "--ro-bind",
        sys.base_prefix,
        sys.base_prefix,
    ]


def _libraries(virtual):
    here = Path(sysconfig.get_path("purelib"))
    there = Path(virtual, "lib", here.parent.name, here.name)
    args = _open_folders([there, *there.parents[:3]])
    for path in sorted(here.iterdir()):
        if not path.name.startswith(OURS + OF_PIP):
            args += ["--ro-bind", str(path), f"{there}/{path.name}"]
    return args


def _open_folders(inside_out):
    """Make the folders that bwrap would make itself, which are closed to the guest's user where root starts
    it.
    """
    return [part for folder in reversed(inside_out) for part in ("--perms", "0755", "--dir", str(folder))]
