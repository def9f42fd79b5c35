"""Stand-ins for what only a notebook front end has, so that cells which show things run here too and show nothing."""

import types
from collections.abc import Iterator
from typing import Any

import ecp

# What the kit does in a notebook only: a whole notebook that checks and submits itself is graded without doing so again.
NOTEBOOK_ONLY = ("attempts", "check", "connect", "login", "logout", "submit")


def stand_ins() -> dict[str, types.ModuleType]:
    """Modules of IPython in which every name takes anything and gives nothing."""
    names = ("IPython", "IPython.core", "IPython.core.display", "IPython.display")
    modules = {name: _Silent(name) for name in names}
    for name, module in modules.items():
        module.__dict__.update(__path__=[], version_info=(9, 0))  # matplotlib asks for the version
        parent, _, own = name.rpartition(".")
        if parent:
            setattr(modules[parent], own, module)
    return dict(modules)


def install_stubs(names: dict[str, Any]) -> None:
    """Give a notebook's namespace what IPython would; what the kit does in a notebook only, it does not do here."""
    names |= {"display": _nothing, "get_ipython": _nothing}
    for name in NOTEBOOK_ONLY:
        setattr(ecp, name, _nothing)


class _Silent(types.ModuleType):
    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return _nothing


class _Nothing(int):
    """A report nobody made, a shell that is not there: true, a number to compute with; what is asked of it is the same again."""

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
