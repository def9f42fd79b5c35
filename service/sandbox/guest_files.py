"""What a guest needs to read and nothing else: interpreter, standard library, packages with theirs, the kit, our code."""

import functools
import os
import re
import subprocess
import sys
import sysconfig
from collections.abc import Collection
from importlib import metadata
from pathlib import Path

from exercises.packages import SANDBOX

GUEST = Path(__file__).parent / "guest"
# Extension modules whose libraries (X11, TLS, databases, terminals) no submission needs.
LEFT_OUT = re.compile(r"_(tkinter|ssl|curses|curses_panel|sqlite3|dbm|gdbm)\b|readline|nis|ossaudiodev|test")
# manylinux wheels bring their own libraries and use of the system's only the C library's family and the C++ runtime (PEP 600).
C_LIBRARY = ("libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "libutil.so.1")
OTHERS = ("site-packages", "dist-packages")  # below the standard library of some installations, with whatever is there
CPP_USER = "matplotlib/ft2font*.so"
DEVICES = ("/dev/null", "/dev/urandom")


def interpreter() -> Path:
    """The real interpreter behind a virtual environment's link, at the path its own library search expects."""
    return Path(os.path.realpath(sys._base_executable))  # type: ignore[attr-defined]


def site_packages() -> Path:
    """Where the libraries are installed."""
    return Path(sysconfig.get_path("purelib"))


def standard_library() -> Path:
    """The folder of the standard library."""
    return Path(sysconfig.get_path("stdlib"))


def kit() -> Path:
    """The folder of ``ecp``."""
    import ecp

    return Path(ecp.__path__[0])


def packages(more: Collection[str] = ()) -> list[str]:
    """Top-level names in site-packages of numpy, scipy, matplotlib, of ``more`` distributions, and of all they require.

    What is not installed is left out: many requirements are for another system, or another version of Python.
    """
    names: set[str] = set()
    todo, done = [*SANDBOX, *more], set()
    while todo:
        name = todo.pop()
        if name in done:
            continue
        done.add(name)
        try:
            distribution = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            continue
        for requirement in distribution.requires or []:
            if "extra ==" not in requirement:
                todo.append(re.split(r"[ <>=!~;\[(]", requirement, maxsplit=1)[0].lower())
        tops = {file.parts[0] for file in distribution.files or [] if len(file.parts) > 1 or file.suffix == ".py"}
        names |= {top for top in tops if top not in ("..", "__pycache__") and not top.endswith(".dist-info")}
    return sorted(name for name in names if (site_packages() / name).exists())


@functools.cache
def runtime() -> tuple[Path, ...]:
    """Interpreter, standard library and the shared libraries they are linked with, at the paths the loader looks for them."""
    stdlib = standard_library()
    linked = [interpreter(), *sorted((stdlib / "lib-dynload").glob("*.so"))]
    linked += sorted(site_packages().glob(CPP_USER))
    files = [str(f) for f in linked if f.exists() and not LEFT_OUT.search(f.name)]
    libraries = set(re.findall(r"^\s+(?:\S+ => )?(/\S+) \(0x", _traced(files), re.MULTILINE)) - set(files)
    libraries |= {f"{os.path.dirname(p)}/{name}" for p in set(libraries) if p.endswith("/libc.so.6") for name in C_LIBRARY}
    outside = [Path(p) for p in sorted(libraries) if os.path.exists(p) and not _within(p, stdlib, site_packages())]
    own = sorted(p for p in stdlib.iterdir() if p.name not in OTHERS)
    return (interpreter(), *own, *outside, *(p for p in [Path("/etc/ld.so.cache")] if p.exists()))


def _traced(files: list[str]) -> str:
    """What ldd tells of all of them, asked of the loader in one go, which is sixty times as fast where their names allow it."""
    if any(separator in file for file in files for separator in " :"):
        return subprocess.run(["ldd", *files], capture_output=True, text=True, check=False).stdout
    trace = {"LD_TRACE_LOADED_OBJECTS": "1", "LD_PRELOAD": ":".join(files[1:])}
    return subprocess.run(files[:1], env=trace, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False).stdout


def font_list() -> list[Path]:
    """matplotlib's font list, made once on the host so that no guest has to search for fonts."""
    import matplotlib.font_manager

    return sorted(Path(matplotlib.get_cachedir()).glob("fontlist-*.json"))


def _within(path: str, *folders: Path) -> bool:
    return any(Path(path).is_relative_to(folder) for folder in folders)
