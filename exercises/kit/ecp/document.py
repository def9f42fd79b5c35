"""Dataclasses as JSON documents and back: what the server stores and sends, and the kit reads."""

import math
import types
from collections.abc import Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from enum import Enum
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

T = TypeVar("T")


class NotADocument(ValueError):
    """A member of the document is missing or has another type than expected."""


def document(value: Any) -> Any:
    """Return ``value`` as JSON values: a dataclass becomes an object with its fields and the properties in
    ``COMPUTED_FIELDS``.

    A number that is not finite becomes null. A field with ``metadata={"local_only": True}`` is left out. A
    renamed field has ``metadata={"formerly": OLD_NAME}``: it is written under both names, so that older
    readers still find it.
    """
    if is_dataclass(value):
        written: dict[str, Any] = {}
        for field in fields(value):
            if not field.metadata.get("local_only"):
                names = [name for name in (field.name, field.metadata.get("formerly")) if name is not None]
                written |= dict.fromkeys(names, document(getattr(value, field.name)))
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
    hints, members = get_type_hints(kind), _of(dict, written, where)
    given = {}
    for field in fields(kind):
        name = next((n for n in (field.name, field.metadata.get("formerly")) if n in members), None)
        if name is not None and not field.metadata.get("local_only"):
            given[field.name] = _read(hints[field.name], members[name], f"{where}.{name}")
    if missing := [f.name for f in fields(kind) if f.name not in given and _needed(f)]:
        raise NotADocument(f"{where} lacks {', '.join(missing)}")
    return kind(**given)


def _member(kind: type[Enum], written: Any, where: str) -> Enum:
    try:
        return kind(written)
    except ValueError:
        raise NotADocument(f"{where} cannot be {str(written)[:40]!r}") from None


def _needed(field: Field[Any]) -> bool:
    return field.default is MISSING and field.default_factory is MISSING


def _of(kind: type[T], written: Any, where: str) -> T:
    if not isinstance(written, kind):
        raise NotADocument(f"{where} is {type(written).__name__}, not {kind.__name__}")
    return written
