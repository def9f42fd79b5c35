"""Reading a claim of a notebook's own checks. Until this module has checked it, it is bytes from a stranger.

A claim's payload is header length (2 bytes), JSON header (cell, kind, label, detail, unfit, left_out, numbers, arrays: pairs of
name and shape) and the arrays' raw little-endian numbers one after the other.
"""

import math
from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np

from ecp.claims import KINDS, MOST_DETAIL, MOST_LABEL, Claim, NotebookCheck, one_line
from service.sandbox.guest.claims import MOST_AXES, MOST_NUMBERS

MOST_BYTES = 8 * MOST_NUMBERS + (1 << 16)
_FLOAT = np.dtype("<f8")


def read(header: Mapping[str, Any], raw: bytes, cells: Collection[str], harmless: Callable[[Any], str]) -> NotebookCheck:
    """The claim judged; ValueError where header and bytes do not make one. ``harmless`` makes a text fit to be shown."""
    kind, numbers, shapes = KINDS[_one_of(header.get("kind"), KINDS)], header.get("numbers"), header.get("arrays")
    said = {key: one_line(harmless(header.get(key, "")), MOST_DETAIL) for key in ("label", "detail", "unfit", "left_out")}
    if not isinstance(numbers, dict) or set(numbers) != set(kind.numbers) or not all(type(n) is float for n in numbers.values()):
        raise ValueError("not the numbers of this kind of claim")
    wanted = () if said["unfit"] or said["left_out"] else kind.arrays
    arrays = _arrays(shapes, wanted, raw)
    made = Claim(str(header["kind"]), said["label"][:MOST_LABEL], arrays, numbers, said["detail"], said["unfit"], said["left_out"])
    return made.outcome(_one_of(header.get("cell"), cells))


def _arrays(shapes: Any, wanted: Collection[str], raw: bytes) -> dict[str, Any]:
    if not isinstance(shapes, dict) or set(shapes) != set(wanted):
        raise ValueError("not the arrays of this kind of claim")
    found, at = {}, 0
    for name, shape in shapes.items():
        if not isinstance(shape, list) or len(shape) > MOST_AXES or not all(type(n) is int and n >= 0 for n in shape):
            raise ValueError("not a shape")
        if math.prod(max(n, 1) for n in shape) > MOST_NUMBERS:
            raise ValueError("too large")
        size = _FLOAT.itemsize * math.prod(shape)
        found[name] = np.frombuffer(raw[at : at + size], _FLOAT).reshape(shape)
        at += size
    if at != len(raw):
        raise ValueError("more bytes than the shapes")
    return found


def _one_of(name: Any, names: Collection[str]) -> str:
    if not isinstance(name, str) or name not in names:
        raise ValueError("unknown kind or cell")
    return name
