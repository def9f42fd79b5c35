"""Reading claims of a notebook's own checks from untrusted bytes.

The payload of a claim is header length (2 bytes), JSON header (cell, kind, label, detail, unfit, left_out,
numbers, arrays: pairs of name and shape, complex: names of complex arrays) and the arrays' raw little-endian
numbers, one array after another.
"""

import math
from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np

from polhode.judging.claims import KINDS, MOST_DETAIL, MOST_LABEL, Claim, one_line
from service.sandbox.guest.claims import MOST_AXES, MOST_NUMBERS

MOST_BYTES = 8 * MOST_NUMBERS + (1 << 16)
_FLOAT, _COMPLEX = np.dtype("<f8"), np.dtype("<c16")


def read(
    header: Mapping[str, Any], raw: bytes, cells: Collection[str], harmless: Callable[[Any], str]
) -> tuple[str, tuple[int, int] | None, Claim]:
    """Return the cell, the place in it, if it is a published one, and the claim. ``harmless`` makes a text
    safe to display.

    Raises ValueError if ``header`` and ``raw`` are not a claim made in one of ``cells``.
    """
    numbers, shapes = header.get("numbers"), header.get("arrays")
    for key, known in (("kind", KINDS), ("cell", cells)):
        if not isinstance(header.get(key), str) or header[key] not in known:
            raise ValueError(f"unknown {key}")
    kind = KINDS[header["kind"]]
    texts = {
        key: one_line(harmless(header.get(key, "")), MOST_DETAIL)
        for key in ("label", "detail", "unfit", "left_out")
    }
    if (
        not isinstance(numbers, dict)
        or set(numbers) != set(kind.numbers)
        or not all(type(n) is float for n in numbers.values())
    ):
        raise ValueError("not the numbers of this kind of claim")
    expected = () if texts["unfit"] or texts["left_out"] else kind.arrays
    arrays = _arrays(shapes, expected, header.get("complex") if header["kind"] == "close" else (), raw)
    claim = Claim(
        str(header["kind"]),
        texts["label"][:MOST_LABEL],
        arrays,
        numbers,
        texts["detail"],
        texts["unfit"],
        texts["left_out"],
    )
    return str(header["cell"]), _place(header.get("place")), claim


def _place(place: Any) -> tuple[int, int] | None:
    if place is None:
        return None
    if (
        not isinstance(place, list)
        or len(place) != 2
        or not all(type(n) is int and 0 <= n < 1 << 31 for n in place)
    ):
        raise ValueError("not a place")
    return place[0], place[1]


def _arrays(shapes: Any, expected: Collection[str], of_complex: Any, raw: bytes) -> dict[str, Any]:
    if not isinstance(shapes, dict) or set(shapes) != set(expected):
        raise ValueError("not the arrays of this kind of claim")
    arrays, at = {}, 0
    for name, shape in shapes.items():
        if (
            not isinstance(shape, list)
            or len(shape) > MOST_AXES
            or not all(type(n) is int and n >= 0 for n in shape)
        ):
            raise ValueError("not a shape")
        if math.prod(max(n, 1) for n in shape) > MOST_NUMBERS:
            raise ValueError("too large")
        element = _COMPLEX if isinstance(of_complex, list) and name in of_complex else _FLOAT
        size = element.itemsize * math.prod(shape)
        arrays[name] = np.frombuffer(raw[at : at + size], element).reshape(shape)
        at += size
    if at != len(raw):
        raise ValueError("more bytes than the shapes need")
    return arrays
