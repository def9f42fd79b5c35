"""A stand-in for objects that do nothing here, such as a window or the kit's functions of a notebook."""

from collections.abc import Iterator
from typing import Any


class _Nothing(int):
    """True, a number, and its every attribute, call and item is itself."""

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
