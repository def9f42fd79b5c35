"""Stubs of a notebook front end, so that cells that display something run in the sandbox and display nothing."""

import types
from collections.abc import Iterator
from typing import Any

import ecp

# Functions of the kit that do nothing here: a notebook that checks and submits itself must not do so while it is graded.
NOTEBOOK_ONLY = ("attempts", "check", "connect", "login", "logout", "submissions", "submit")


def stand_ins() -> dict[str, types.ModuleType]:
    """Return stubs of IPython's modules, whose every name is a function that does nothing."""
    names = ("IPython", "IPython.core", "IPython.core.display", "IPython.display")
    modules = {name: _Silent(name) for name in names}
    for name, module in modules.items():
        module.__dict__.update(__path__=[], version_info=(9, 0))  # matplotlib asks for the version
        parent, _, own = name.rpartition(".")
        if parent:
            setattr(modules[parent], own, module)
    return dict(modules)


def install_stubs(names: dict[str, Any]) -> None:
    """Add IPython's names to a notebook's namespace, and disable the functions NOTEBOOK_ONLY of the kit."""
    names |= {"display": _nothing, "get_ipython": _nothing}
    for name in NOTEBOOK_ONLY:
        setattr(ecp, name, _nothing)


class _Silent(types.ModuleType):
    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return _nothing


class _Nothing(int):
    """The result of every stub: true, a number, and its every attribute, call and item is itself."""

    def __getattr__(self, name: str) -> "_Nothing":
        if name.startswith("__"):
            raise AttributeError(name)
        return self

    def __call__(self, *args: Any, **kwargs: Any) -> "_Nothing":
        return self

    def __getitem__(self, key: Any) -> "_Nothing":
        return self

    def __iter__(self) -> Iterator[Any]:
        return iter(())

    def __len__(self) -> int:
        return 1

    def __repr__(self) -> str:
        return ""


def _nothing(*args: Any, **kwargs: Any) -> _Nothing:
    return _Nothing(1)
