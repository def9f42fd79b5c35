"""Walls by bubblewrap: no network, own process ids, a cleared environment, and a read-only file system of just what is needed."""

import functools
import os
import re
import subprocess
import sys
import sysconfig
from importlib import metadata
from pathlib import Path

from service.sandbox.walls import BOOT, ENVIRONMENT

ROOTS = ("numpy", "scipy", "matplotlib")
GUEST_HOME = "/polhode"
# Extension modules whose libraries (X11, TLS, databases, terminals) no submission needs.
LEFT_OUT = re.compile(r"_(tkinter|ssl|curses|curses_panel|sqlite3|dbm|gdbm)\b|readline|nis|ossaudiodev|test")
# manylinux wheels bring their own libraries and use of the system's only the C library's family and the C++ runtime (PEP 600).
C_LIBRARY = ("libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "libutil.so.1")
CPP_USER = "matplotlib/ft2font*.so"


class BubblewrapWalls:
    """``program`` is the bwrap to use. As root its guest keeps just enough to step down to an unprivileged user id by itself."""

    name = "bubblewrap"

    def __init__(self, program: str) -> None:
        self._program = program

    def command(self) -> list[str]:
        """bwrap with every namespace, the read-only binds and the guest's interpreter."""
        here, site = Path(__file__).parent, _site_packages()
        interpreter = _interpreter()
        binds = [*_runtime(), *(site / name for name in _packages())]
        args = [self._program, "--die-with-parent", "--new-session", "--clearenv", "--unshare-pid", "--unshare-net"]
        args += ["--unshare-ipc", "--unshare-uts", "--unshare-cgroup-try"]
        if os.geteuid() == 0:
            for capability in ("CAP_SETUID", "CAP_SETGID", "CAP_SYS_ADMIN"):
                args += ["--cap-add", capability]
        else:
            args += ["--unshare-user"]
        for folder in sorted({parent for path in binds for parent in path.parents[:-1]}):
            args += ["--perms", "0755", "--dir", str(folder)]  # without this root's bwrap makes them unreadable for others
        for path in binds:
            args += ["--ro-bind", os.path.realpath(path), str(path)]
        args += ["--ro-bind", str(here / "guest"), f"{GUEST_HOME}/guest"]
        args += ["--ro-bind", str(_kit()), f"{GUEST_HOME}/ecp"]
        args += ["--dev-bind", "/dev/null", "/dev/null", "--dev-bind", "/dev/urandom", "/dev/urandom"]
        args += ["--size", str(4 << 20), "--tmpfs", "/tmp", "--dir", "/tmp/mpl"]
        for cached in _font_list():
            args += ["--ro-bind", str(cached), f"/tmp/mpl/{cached.name}"]
        for key, value in (ENVIRONMENT | {"MPLCONFIGDIR": "/tmp/mpl", "HOME": "/tmp"}).items():
            args += ["--setenv", key, value]
        args += ["--remount-ro", "/", "--chdir", "/tmp", "--"]
        return [*args, str(interpreter), "-I", "-S", "-B", "-c", BOOT, GUEST_HOME, str(site), GUEST_HOME, self.name]

    def environment(self) -> dict[str, str]:
        """bwrap's own; the guest's is set inside."""
        return {"PATH": "/usr/bin:/bin"}


def _interpreter() -> Path:
    """The real interpreter behind a virtual environment's link, at the path its own library search expects."""
    return Path(os.path.realpath(sys._base_executable))  # type: ignore[attr-defined]


def _site_packages() -> Path:
    return Path(sysconfig.get_path("purelib"))


def _kit() -> Path:
    import ecp

    return Path(next(iter(ecp.__path__)))


@functools.cache
def _packages() -> list[str]:
    """Top-level names in site-packages of numpy, scipy, matplotlib and all they require."""
    names: set[str] = set()
    todo, done = list(ROOTS), set()
    while todo:
        name = todo.pop()
        if name in done:
            continue
        done.add(name)
        distribution = metadata.distribution(name)
        for requirement in distribution.requires or []:
            if "extra ==" not in requirement:
                todo.append(re.split(r"[ <>=!~;\[(]", requirement, maxsplit=1)[0].lower())
        tops = {file.parts[0] for file in distribution.files or [] if len(file.parts) > 1 or file.suffix == ".py"}
        names |= {top for top in tops if top not in ("..", "__pycache__") and not top.endswith(".dist-info")}
    return sorted(name for name in names if (_site_packages() / name).exists())


@functools.cache
def _runtime() -> list[Path]:
    """Interpreter, standard library and the shared libraries they are linked with, at the paths the loader looks for them."""
    stdlib = Path(sysconfig.get_path("stdlib"))
    linked = [_interpreter(), *sorted((stdlib / "lib-dynload").glob("*.so"))]
    linked += sorted(_site_packages().glob(CPP_USER))
    files = [str(f) for f in linked if f.exists() and not LEFT_OUT.search(f.name)]
    told = subprocess.run(["ldd", *files], capture_output=True, text=True, check=False).stdout
    libraries = set(re.findall(r"^\s+(?:\S+ => )?(/\S+) \(0x", told, re.MULTILINE))
    libraries |= {f"{os.path.dirname(p)}/{name}" for p in set(libraries) if p.endswith("/libc.so.6") for name in C_LIBRARY}
    outside = [Path(p) for p in sorted(libraries) if os.path.exists(p) and not _within(p, stdlib, _site_packages())]
    return [_interpreter(), stdlib, *outside, *(p for p in [Path("/etc/ld.so.cache")] if p.exists())]


def _font_list() -> list[Path]:
    """matplotlib's font list, made once on the host so that no guest has to search for fonts."""
    import matplotlib.font_manager

    return sorted(Path(matplotlib.get_cachedir()).glob("fontlist-*.json"))


def _within(path: str, *folders: Path) -> bool:
    return any(Path(path).is_relative_to(folder) for folder in folders)
