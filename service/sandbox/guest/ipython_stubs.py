"""Stubs of a notebook front end, so that cells that display something run in the sandbox and display
nothing.
"""

import sys
from collections.abc import Iterator
from typing import Any

import ecp

MODULES = ("IPython", "IPython.core", "IPython.core.display", "IPython.display")
# Functions of the kit that do nothing here: a notebook that checks and submits itself must not do so while it
# is graded.
NOTEBOOK_ONLY = ("attempts", "check", "connect", "login", "logout", "submissions", "submit")


def install_stubs(names: dict[str, Any]) -> None:
    """Add IPython's modules and a notebook's names of it, and disable the functions NOTEBOOK_ONLY of the
    kit.
    """
    sys.modules |= dict.fromkeys(MODULES, NOTHING)
    names |= {"display": NOTHING, "get_ipython": NOTHING}
    for name in NOTEBOOK_ONLY:
        setattr(ecp, name, NOTHING)


class _Nothing(int):
    """The stub of every module and function: true, a number, and its every attribute, call and item is
    itself.
    """

    __path__ = ()
    version_info = (9, 0)  # matplotlib asks IPython for it

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


NOTHING: Any = _Nothing(1)
