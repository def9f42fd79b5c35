"""Dataclasses as JSON documents and back: what the server stores and sends, and the kit reads."""

import functools
import math
import types
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from typing import Any, NamedTuple, TypeVar, get_args, get_origin, get_type_hints

T = TypeVar("T")


class NotADocument(ValueError):
    """A member of the document is missing or has another type than expected."""


class Member(NamedTuple):
    """A field of a dataclass in a document: the ``names`` it is written under, its type, and whether it must be there."""

    field: str
    names: tuple[str, ...]
    kind: Any
    required: bool


@functools.cache
def _members(kind: type) -> tuple[Member, ...]:
    hints = get_type_hints(kind)
    return tuple(
        Member(
            field.name,
            tuple(dict.fromkeys((field.name, field.metadata.get("formerly", field.name)))),
            hints[field.name],
            field.default is MISSING and field.default_factory is MISSING,
        )
        for field in fields(kind)
        if not field.metadata.get("local_only")
    )


def document(value: Any) -> Any:
    """Return ``value`` as JSON values: a dataclass becomes an object with its fields and the properties in
    ``COMPUTED_FIELDS``.

    A number that is not finite becomes null. A field with ``metadata={"local_only": True}`` is left out. A
    renamed field has ``metadata={"formerly": OLD_NAME}``: it is written under both names, so that older
    readers still find it.
    """
    if is_dataclass(value):
        written: dict[str, Any] = {}
        for member in _members(value.__class__):
            written |= dict.fromkeys(member.names, document(getattr(value, member.field)))
        return written | {name: document(getattr(value, name)) for name in getattr(value, "COMPUTED_FIELDS", ())}
    if isinstance(value, Mapping):
        return {str(key): document(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [document(item) for item in value]
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def read(kind: type[T], written: Any) -> T:
    """Return the dataclass ``kind`` that ``document`` wrote, ignoring unknown members.

    A renamed field is also found under its former name. Raises NotADocument if a member is missing or of another type.
    """
    found = _read(kind, written, kind.__name__)
    assert isinstance(found, kind)
    return found


def _read(kind: Any, written: Any, where: str) -> Any:
    origin = get_origin(kind)
    if origin is types.UnionType:
        return None if written is None else _read(get_args(kind)[0], written, where)
    if origin is list:
        return [_read(get_args(kind)[0], item, f"{where}[{k}]") for k, item in enumerate(_of(list, written, where))]
    if origin is dict:
        return {key: _read(get_args(kind)[1], item, f"{where}.{key}") for key, item in _of(dict, written, where).items()}
    if is_dataclass(kind):
        return _object(kind, written, where)
    if issubclass(kind, Enum):
        return _member(kind, written, where)
    return float(written) if kind is float and type(written) is int else _of(kind, written, where)


def _object(kind: Any, written: Any, where: str) -> Any:
    values = _of(dict, written, where)
    given = {}
    for member in _members(kind):
        if name := next((name for name in member.names if name in values), ""):
            given[member.field] = _read(member.kind, values[name], f"{where}.{name}")
    if missing := [member.field for member in _members(kind) if member.required and member.field not in given]:
        raise NotADocument(f"{where} lacks {', '.join(missing)}")
    return kind(**given)


def _member(kind: type[Enum], written: Any, where: str) -> Enum:
    try:
        return kind(written)
    except ValueError:
        raise NotADocument(f"{where} cannot be {str(written)[:40]!r}") from None


def _of(kind: type[T], written: Any, where: str) -> T:
    if not isinstance(written, kind):
        raise NotADocument(f"{where} is {type(written).__name__}, not {kind.__name__}")
    return written
