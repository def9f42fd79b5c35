"""Dataclasses as JSON documents and back: what the server stores and sends, and the kit reads."""

import functools
import math
import types
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from typing import Any, NamedTuple, TypeVar, get_args, get_origin, get_type_hints

T = TypeVar("T")
Reader = Callable[[Any], Any]


class NotADocument(ValueError):
    """A member of the document is missing or has another type than expected."""


class Member(NamedTuple):
    """A field of a dataclass in a document: its name and type, and whether it must be there."""

    name: str
    kind: Any
    required: bool


@functools.cache
def _members(kind: type) -> tuple[Member, ...]:
    hints = get_type_hints(kind)
    return tuple(
        Member(
            field.name,
            hints[field.name],
            field.default is MISSING and field.default_factory is MISSING,
        )
        for field in fields(kind)
        if not field.metadata.get("local_only")
    )


_PLAIN = {str, int, bool, type(None)}


def document(value: Any) -> Any:
    """Return ``value`` as JSON values: a dataclass becomes an object with its fields and the properties in
    ``COMPUTED_FIELDS``.

    A number that is not finite becomes null. A field with ``metadata={"local_only": True}`` is left out.
    """
    kind = type(value)
    if kind in _PLAIN:  # most values
        return value
    if is_dataclass(kind):
        return _written(value, kind)
    if isinstance(value, Mapping):
        return {str(key): document(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [document(item) for item in value]
    if isinstance(value, Enum):
        return value.value
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _written(value: Any, kind: Any) -> dict[str, Any]:
    names = [*(member.name for member in _members(kind)), *getattr(kind, "COMPUTED_FIELDS", ())]
    return {name: document(getattr(value, name)) for name in names}


def read(kind: type[T], written: Any) -> T:
    """Return the dataclass ``kind`` that ``document`` wrote, ignoring unknown members.

    Raises NotADocument if a member is missing or of another type.
    """
    try:
        found = _reader(kind)(written)  # type: ignore[arg-type]
    except _Unreadable as error:
        raise NotADocument(f"{kind.__name__}{error.where} {error}") from None
    assert isinstance(found, kind)
    return found


class _Unreadable(ValueError):
    """Part of a document cannot be read, which the message says; ``where`` it is."""

    where = ""


@functools.cache
def _reader(kind: Any) -> Reader:
    """Return the function that reads values of a type."""
    origin = get_origin(kind)
    if origin is types.UnionType:
        inner = _reader(get_args(kind)[0])
        return lambda written: None if written is None else inner(written)
    if origin in (list, tuple):  # of any length
        each = _reader(get_args(kind)[0])
        return lambda written: origin(
            _part(each, item, "[{}]", k) for k, item in enumerate(_of(list, written))
        )
    if origin is dict:
        value = _reader(get_args(kind)[1])
        return lambda written: {
            key: _part(value, item, ".{}", key) for key, item in _of(dict, written).items()
        }
    if is_dataclass(kind):
        members = [(member, _reader(member.kind)) for member in _members(kind)]  # type: ignore[arg-type]
        return lambda written: _object(kind, members, _of(dict, written))
    if issubclass(kind, Enum):
        return lambda written: _enum(kind, written)
    return _float if kind is float else functools.partial(_of, kind)


def _part(reader: Reader, written: Any, where: str, key: object) -> Any:
    try:
        return reader(written)
    except _Unreadable as error:
        error.where = where.format(key) + error.where
        raise


def _object(kind: Any, members: list[tuple[Member, Reader]], written: dict[str, Any]) -> Any:
    given = {
        member.name: _part(reader, written[member.name], ".{}", member.name)
        for member, reader in members
        if member.name in written
    }
    if missing := [member.name for member, _ in members if member.required and member.name not in given]:
        raise _Unreadable(f"lacks {', '.join(missing)}")
    return kind(**given)


def _enum(kind: type[Enum], written: Any) -> Enum:
    try:
        return kind(written)
    except ValueError:
        raise _Unreadable(f"cannot be {str(written)[:40]!r}") from None


def _float(written: Any) -> float:
    return float(written) if type(written) is int else _of(float, written)


def _of(kind: type[T], written: Any) -> T:
    if not isinstance(written, kind):
        raise _Unreadable(f"is {type(written).__name__}, not {kind.__name__}")
    return written
