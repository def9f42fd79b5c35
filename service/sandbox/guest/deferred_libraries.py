"""Names of SciPy and matplotlib without these libraries, whose imports are most of the start of a guest that
grades one file.

A submission may import these names and store them. Every use of one, and every import that may fail, ends the
child with the exit code of its library (NEEDED): the zygote then imports the library, and the host plays the
job again. So a submission gets the same results.
"""

import importlib
import os
import re
import sys
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType, WrapperDescriptorType
from typing import Any, NoReturn

from .cells.claim_recorder import course
from .wire import FILES
from .zygote import NEEDED

LIBRARIES = {"scipy": "scipy", "matplotlib": "matplotlib", "mpl_toolkits": "matplotlib"}
"""The library to which each package belongs."""
USUAL = {
    "matplotlib.animation": ("FuncAnimation",),
    "matplotlib.pyplot": (),
    "mpl_toolkits.mplot3d.art3d": ("Poly3DCollection",),
    "scipy.integrate": ("solve_ivp",),
    "scipy.spatial.transform": ("Rotation",),
}
"""Names that notebooks often import, by module."""
BACKEND_CHOICES = {("matplotlib", "use"), ("matplotlib.pyplot", "switch_backend")}
"""Functions, by module, that change nothing here: every backend draws with Agg."""
KINDS = (complex, int, list, set, type)
OPERATIONS = {
    name for kind in KINDS for name, value in vars(kind).items() if isinstance(value, WrapperDescriptorType)
}
OPERATIONS |= {"__getitem__", "__instancecheck__", "__subclasscheck__"}


def install() -> None:
    """Let the children of this process import the names of LIBRARIES instead of these. It makes those in
    USUAL now.
    """
    sys.meta_path.insert(0, _finder)
    for name, values in USUAL.items():
        module = importlib.import_module(name)
        for value in values:
            getattr(module, value)


def remove(library: str) -> None:
    """Let this process import ``library`` again."""
    _finder.libraries.discard(library)
    for name in [name for name in sys.modules if LIBRARIES.get(name.partition(".")[0]) == library]:
        del sys.modules[name]


def lacks(library: str) -> bool:
    """Return whether they import the names of ``library``."""
    return _finder in sys.meta_path and library in _finder.libraries


def _needs(library: str) -> Callable[..., NoReturn]:
    return lambda *args, **kwargs: os._exit(NEEDED[library])


_NAMES = {
    library: type("_Name", (), dict.fromkeys(OPERATIONS - {"__init__"}, _needs(library)))
    for library in NEEDED
}


class _Settings:
    """``rcParams``. Ignores the choice of a backend, and what the assignment's Setup and the course's package
    set, which is valid: nothing is drawn.
    """

    def __setitem__(self, name: str, value: object) -> None:
        if name != "backend":
            self._ignore()

    def update(self, *values: object) -> None:
        self._ignore()

    def _ignore(self) -> None:
        file = sys._getframe(2).f_code.co_filename
        if file != FILES["setup"] and not file.startswith(tuple(f"{folder}/" for folder in course)):
            _needs("matplotlib")()

    def __getattr__(self, name: str) -> Any:
        _needs("matplotlib")()


def _ignore(*args: object, **kwargs: object) -> None:
    """Do nothing."""


class _Module(ModuleType):
    def __getattr__(self, name: str) -> Any:
        if name in ("__path__", "__file__", "__cached__"):
            raise AttributeError(name)
        library = LIBRARIES[self.__name__.partition(".")[0]]
        if name == "rcParams" and library == "matplotlib":
            return _Settings()
        value = _ignore if (self.__name__, name) in BACKEND_CHOICES else self._value(name, library)
        setattr(self, name, value)
        return value

    def _value(self, name: str, library: str) -> Any:
        source = _source(self)
        # submodules last: a function may have the name of the submodule from which the package imports it
        if passed := re.search(rf"^from (\.\w+) import .*\b{re.escape(name)}\b", source, re.MULTILINE):
            return getattr(self._neighbour(passed[1]), name)
        for star in re.findall(r"^from (\.\w+) import \*", source, re.MULTILINE):
            module = self._neighbour(star)
            if re.search(rf"^__all__ = [^]]*['\"]{re.escape(name)}['\"]", _source(module), re.MULTILINE):
                return getattr(module, name)
        submodule = f"{self.__name__}.{name}"
        if PathFinder.find_spec(submodule, getattr(self.__spec__, "submodule_search_locations", None) or []):
            if re.search(rf"^from \.{re.escape(name)} import", source, re.MULTILINE):
                _needs(library)()  # the name may be a function of that submodule
            return importlib.import_module(submodule)  # a zygote with matplotlib has imported most of them
        if not re.search(rf"^(class|def) {re.escape(name)}\b", source, re.MULTILINE):
            _needs(library)()
        return _NAMES[library]()

    def _neighbour(self, relative: str) -> ModuleType:
        """Return the module that this one imports as ``relative``, and leave the package without an
        attribute of its name, which may be that of a function.
        """
        module = importlib.import_module(relative, self.__package__)
        vars(sys.modules[str(self.__package__)]).pop(relative.removeprefix("."), None)
        return module


def _source(module: ModuleType) -> str:
    assert module.__spec__ is not None and module.__spec__.origin is not None
    return Path(module.__spec__.origin).read_text(encoding="utf-8")


class _Loader:
    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return _Module(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Do nothing: the names are made when a submission imports them."""


class _Finder:
    def __init__(self) -> None:
        self.libraries = set(NEEDED)

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        library = LIBRARIES.get(fullname.partition(".")[0])
        if library not in self.libraries:
            return None
        spec = PathFinder.find_spec(fullname, path, target)
        if spec is None or (spec.origin is not None and not spec.origin.endswith(".py")):
            _needs(str(library))()
        if spec.origin is not None:  # None: a namespace package
            spec.loader = _Loader()  # type: ignore[assignment]  # importlib.abc.Loader would also import importlib.resources
        return spec


_finder = _Finder()
