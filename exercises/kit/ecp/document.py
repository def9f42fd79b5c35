"""Dataclasses as JSON documents and back: what the server stores and tells, and the kit reads."""

import math
import types
from collections.abc import Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from enum import Enum
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

T = TypeVar("T")


class NotADocument(ValueError):
    """A document lacks something, or holds something else than it should."""


def document(value: Any) -> Any:
    """``value`` as what JSON can say: a dataclass as an object with its fields and its properties named in ``TOLD``.

    A number that is not finite is told as null. Fields marked ``metadata={"here": True}`` stay out.
    """
    if is_dataclass(value):
        told = {f.name: document(getattr(value, f.name)) for f in fields(value) if not f.metadata.get("here")}
        return told | {name: document(getattr(value, name)) for name in getattr(value, "TOLD", ())}
    if isinstance(value, Mapping):
        return {str(key): document(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [document(item) for item in value]
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def read(kind: type[T], told: Any) -> T:
    """The dataclass ``kind`` from its document; NotADocument if it is none. What the document holds beyond it is left aside."""
    found = _read(kind, told, kind.__name__)
    assert isinstance(found, kind)
    return found


def _read(kind: Any, told: Any, where: str) -> Any:
    origin = get_origin(kind)
    if origin is types.UnionType:
        return None if told is None else _read(get_args(kind)[0], told, where)
    if origin is list:
        return [_read(get_args(kind)[0], item, f"{where}[{k}]") for k, item in enumerate(_of(list, told, where))]
    if origin is dict:
        return {key: _read(get_args(kind)[1], item, f"{where}.{key}") for key, item in _of(dict, told, where).items()}
    if is_dataclass(kind):
        return _object(kind, told, where)
    if issubclass(kind, Enum):
        return _member(kind, told, where)
    return float(told) if kind is float and type(told) is int else _of(kind, told, where)


def _object(kind: Any, told: Any, where: str) -> Any:
    hints, told = get_type_hints(kind), _of(dict, told, where)
    if missing := [f.name for f in fields(kind) if f.name not in told and _needed(f)]:
        raise NotADocument(f"{where} lacks {', '.join(missing)}")
    given = [f.name for f in fields(kind) if f.name in told and not f.metadata.get("here")]
    return kind(**{name: _read(hints[name], told[name], f"{where}.{name}") for name in given})


def _member(kind: type[Enum], told: Any, where: str) -> Enum:
    try:
        return kind(told)
    except ValueError:
        raise NotADocument(f"{where} cannot be {str(told)[:40]!r}") from None


def _needed(field: Field[Any]) -> bool:
    return field.default is MISSING and field.default_factory is MISSING


def _of(kind: type[T], told: Any, where: str) -> T:
    if not isinstance(told, kind):
        raise NotADocument(f"{where} is {type(told).__name__}, not {kind.__name__}")
    return told
