"""The files that a guest may read: interpreter, standard library, packages with their dependencies, the kit, the guest's code."""

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
# manylinux wheels contain their own libraries; of the system's they use only the C library and the C++ runtime (PEP 600).
C_LIBRARY = ("libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "libutil.so.1")
OTHERS = (
    "site-packages",
    "dist-packages",
)  # folders that some installations have below the standard library; a guest must not read them
CPP_USER = "matplotlib/ft2font*.so"
DEVICES = ("/dev/null", "/dev/urandom")


def interpreter() -> Path:
    """Return the interpreter that a virtual environment links to, at the path from which it finds its libraries."""
    return Path(os.path.realpath(sys._base_executable))  # type: ignore[attr-defined]


def base_prefix() -> Path:
    """Return the folder of the interpreter's installation."""
    return Path(os.path.realpath(sys.base_prefix))


def site_packages() -> Path:
    """Return the folder of installed packages."""
    return Path(sysconfig.get_path("purelib"))


def standard_library() -> Path:
    """Return the folder of the standard library."""
    return Path(sysconfig.get_path("stdlib"))


def kit() -> Path:
    """Return the folder of ``ecp``."""
    import ecp

    return Path(ecp.__path__[0])


def packages(more: Collection[str] = ()) -> list[str]:
    """Return the top-level names in site-packages of numpy, scipy, matplotlib, the distributions ``more`` and their requirements.

    A requirement that is not installed is left out: many are for another system or another version of Python.
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
    """Return the interpreter, the standard library and the shared libraries they are linked with, at the paths the loader uses."""
    stdlib = standard_library()
    linked = [interpreter(), *sorted((stdlib / "lib-dynload").glob("*.so"))]
    linked += sorted(site_packages().glob(CPP_USER))
    files = [str(f) for f in linked if f.exists() and not LEFT_OUT.search(f.name)]
    libraries = set(re.findall(r"^\s+(?:\S+ => )?(/\S+) \(0x", _linked_libraries(files), re.MULTILINE)) - set(files)
    libraries |= {f"{os.path.dirname(p)}/{name}" for p in set(libraries) if p.endswith("/libc.so.6") for name in C_LIBRARY}
    outside = [Path(p) for p in sorted(libraries) if os.path.exists(p) and not _within(p, stdlib, site_packages())]
    own = sorted(p for p in stdlib.iterdir() if p.name not in OTHERS)
    return (interpreter(), *own, *outside, *(p for p in [Path("/etc/ld.so.cache")] if p.exists()))


def _linked_libraries(files: list[str]) -> str:
    """Return ldd's output for all ``files``. Runs the loader once where their names allow it, which is 60 times as fast as ldd."""
    if any(separator in file for file in files for separator in " :"):
        return subprocess.run(["ldd", *files], capture_output=True, text=True, check=False).stdout
    trace = {"LD_TRACE_LOADED_OBJECTS": "1", "LD_PRELOAD": ":".join(files[1:])}
    return subprocess.run(files[:1], env=trace, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False).stdout


def font_list() -> list[Path]:
    """Return the files of matplotlib's font list, which the host builds so that no guest has to search for fonts."""
    import matplotlib.font_manager

    return sorted(Path(matplotlib.get_cachedir()).glob("fontlist-*.json"))


def _within(path: str, *folders: Path) -> bool:
    return any(Path(path).is_relative_to(folder) for folder in folders)
