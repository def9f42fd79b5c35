"""The files that a guest may read: interpreter, standard library, packages with their dependencies, the kit,
the guest's code.
"""

import functools
import os
import re
import subprocess
import sys
import sysconfig
from collections.abc import Collection
from importlib.util import find_spec
from pathlib import Path

from exercises.authoring.assignments.packages import SANDBOX, with_requirements

_kit = find_spec("polhode")
assert _kit is not None and _kit.origin is not None
GUEST, KIT = Path(__file__).parents[1] / "guest", Path(_kit.origin).parent
# the one that a virtual environment links to, at the path from which it finds its libraries
INTERPRETER = Path(os.path.realpath(sys._base_executable))  # type: ignore[attr-defined]
BASE_PREFIX = Path(os.path.realpath(sys.base_prefix))
SITE_PACKAGES, STANDARD_LIBRARY = (Path(sysconfig.get_path(name)) for name in ("purelib", "stdlib"))
# Extension modules whose libraries (X11, TLS, databases, terminals) no submission needs.
LEFT_OUT = re.compile(r"_(tkinter|ssl|curses|curses_panel|sqlite3|dbm|gdbm)\b|readline|nis|ossaudiodev|test")
# manylinux wheels contain their own libraries; of the system's they use only the C library and the C++
# runtime (PEP 600).
C_LIBRARY = ("libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "libutil.so.1")
OTHERS = (
    "site-packages",
    "dist-packages",
)  # folders that some installations have below the standard library; a guest must not read them
CPP_USER = "matplotlib/ft2font*.so"
DEVICES = ("/dev/null", "/dev/urandom")


def packages(more: Collection[str] = ()) -> list[str]:
    """Return the top-level names in site-packages of numpy, scipy, matplotlib, the distributions ``more`` and
    their requirements.

    A requirement that is not installed is left out: many are for another system or another version of Python.
    """
    names: set[str] = set()
    for distribution in with_requirements({*SANDBOX, *more}).values():
        record = (
            distribution.read_text("RECORD") or ""
        ).splitlines()  # parsing it, as ``files`` does, takes 20 ms
        paths = [line.split(",")[0] for line in record] or list(map(str, distribution.files or []))
        tops = {path.partition("/")[0] for path in paths if "/" in path or path.endswith(".py")}
        names |= {top for top in tops if top not in ("..", "__pycache__") and not top.endswith(".dist-info")}
    return sorted(name for name in names if (SITE_PACKAGES / name).exists())


@functools.cache
def runtime() -> tuple[Path, ...]:
    """Return the interpreter, the standard library and the shared libraries they are linked with, at the
    paths the loader uses.
    """
    linked = [
        INTERPRETER,
        *sorted((STANDARD_LIBRARY / "lib-dynload").glob("*.so")),
        *sorted(SITE_PACKAGES.glob(CPP_USER)),
    ]
    files = [str(f) for f in linked if f.exists() and not LEFT_OUT.search(f.name)]
    libraries = set(re.findall(r"^\s+(?:\S+ => )?(/\S+) \(0x", _linked_libraries(files), re.MULTILINE)) - set(
        files
    )
    libraries |= {
        f"{os.path.dirname(p)}/{name}"
        for p in set(libraries)
        if p.endswith("/libc.so.6")
        for name in C_LIBRARY
    }
    inside = (STANDARD_LIBRARY, SITE_PACKAGES)
    outside = [
        p for p in map(Path, sorted(libraries)) if p.exists() and not any(map(p.is_relative_to, inside))
    ]
    own = sorted(p for p in STANDARD_LIBRARY.iterdir() if p.name not in OTHERS)
    return (INTERPRETER, *own, *outside, *(p for p in [Path("/etc/ld.so.cache")] if p.exists()))


def _linked_libraries(files: list[str]) -> str:
    """Return ldd's output for all ``files``. Runs the loader once where their names allow it, which is 60
    times as fast as ldd.
    """
    if any(separator in file for file in files for separator in " :"):
        return subprocess.run(["ldd", *files], capture_output=True, text=True, check=False).stdout
    trace = {"LD_TRACE_LOADED_OBJECTS": "1", "LD_PRELOAD": ":".join(files[1:])}
    return subprocess.run(
        files[:1], env=trace, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False
    ).stdout


def font_list() -> list[Path]:
    """Return matplotlib's font list, so that no guest has to search for fonts. If there is none, matplotlib
    writes it.
    """
    folder = os.environ.get("MPLCONFIGDIR") or Path(
        os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "matplotlib"
    )
    module = (SITE_PACKAGES / "matplotlib/font_manager.py").read_text(encoding="utf-8")
    name = "fontlist-v{}.json".format(
        *re.findall(r"^    __version__ = '(.*)'$", module, re.MULTILINE) or [""]
    )
    if (Path(folder) / name).is_file():
        return [Path(folder) / name]
    import matplotlib.font_manager

    return sorted(Path(matplotlib.get_cachedir()).glob("fontlist-*.json"))
