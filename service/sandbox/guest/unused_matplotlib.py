"""Names of matplotlib without matplotlib, whose import is 40 % of the start of a guest that grades one file.

A submission may import these names and store them. Every use of one, and every import that may fail, ends the child with the exit
code MATPLOTLIB_NEEDED: the zygote then imports matplotlib, and the host plays the job again. So a submission gets the same results.
"""

import importlib
import os
import re
import sys
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType, WrapperDescriptorType
from typing import Any, NoReturn

import ecp.style

from .wire import FILES
from .zygote import MATPLOTLIB_NEEDED

PACKAGES = ("matplotlib", "mpl_toolkits")
KINDS = (complex, int, list, set, type)
OPERATIONS = {name for kind in KINDS for name, value in vars(kind).items() if isinstance(value, WrapperDescriptorType)}
OPERATIONS |= {"__getitem__", "__instancecheck__", "__subclasscheck__"}


def install() -> None:
    """Let the children of this process import the names of PACKAGES instead of the packages."""
    sys.meta_path.insert(0, _Finder())


def remove() -> None:
    """Let this process import PACKAGES again."""
    sys.meta_path[:] = [finder for finder in sys.meta_path if not isinstance(finder, _Finder)]


def installed() -> bool:
    """Return whether they import the names."""
    return isinstance(sys.meta_path[0], _Finder)


def _needed(*args: object, **kwargs: object) -> NoReturn:
    os._exit(MATPLOTLIB_NEEDED)


_Name = type("_Name", (), dict.fromkeys(OPERATIONS - {"__init__"}, _needed))


class _Settings:
    """``rcParams``. Ignores what the assignment's Setup and the kit's style set, which is valid: nothing is drawn."""

    def __setitem__(self, name: str, value: object) -> None:
        self._ignore()

    def update(self, *values: object) -> None:
        self._ignore()

    def _ignore(self) -> None:
        if sys._getframe(2).f_code.co_filename not in (FILES["setup"], ecp.style.__file__):
            _needed()

    def __getattr__(self, name: str) -> Any:
        _needed()


class _Module(ModuleType):
    def __getattr__(self, name: str) -> Any:
        if name in ("__path__", "__file__", "__cached__"):
            raise AttributeError(name)
        if name == "rcParams":
            return _Settings()
        assert self.__spec__ is not None and self.__spec__.origin is not None
        if PathFinder.find_spec(f"{self.__name__}.{name}", self.__spec__.submodule_search_locations or []):
            return importlib.import_module(f"{self.__name__}.{name}")  # a zygote with matplotlib has imported most of them
        source = Path(self.__spec__.origin).read_text()
        if passed := re.search(rf"^from (\.\w+) import .*\b{re.escape(name)}\b", source, re.MULTILINE):
            return getattr(importlib.import_module(passed[1], self.__package__), name)
        if not re.search(rf"^(class|def) {re.escape(name)}\b", source, re.MULTILINE):
            _needed()
        return _Name()


class _Loader(Loader):
    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return _Module(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Do nothing: the names are made when a submission imports them."""


class _Finder(MetaPathFinder):
    def find_spec(self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        if fullname.partition(".")[0] not in PACKAGES:
            return None
        spec = PathFinder.find_spec(fullname, path, target)
        if spec is None:
            _needed()
        if spec.origin is not None:  # None: a namespace package
            if not spec.origin.endswith(".py"):
                _needed()
            spec.loader = _Loader()
        return spec
