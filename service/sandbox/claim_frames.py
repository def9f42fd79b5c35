"""Reading claims of a notebook's own checks from untrusted bytes.

The payload of a claim is header length (2 bytes), JSON header (cell, kind, label, detail, mark, own, said,
raised, unjudged, left_out, numbers, arrays: pairs of name and shape, complex: names of complex arrays) and
the arrays' raw little-endian numbers, one array after another. Arrays of more than MOST_NUMBERS numbers
follow in blocks of their first axis, which are judged as they come.
"""

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from polhode.judging.claims import MOST_DETAIL, MOST_LABEL, Claim, kind_of, one_line
from polhode.judging.verdict import Judgement, Verdict
from service.sandbox.guest.cells.claim_recorder import MOST_AXES, MOST_IN_FIELD, MOST_NUMBERS

MOST_BYTES = 8 * MOST_NUMBERS + (1 << 16)
MOST_BLOCK = 2 * 16 * MOST_NUMBERS  # bytes: of two arrays of complex numbers
MOST_WORD = 60  # characters
TEXTS = ("label", "detail", "mark", "own", "unjudged", "left_out")
Place = tuple[int, int] | None
_FLOAT, _COMPLEX = np.dtype("<f8"), np.dtype("<c16")


def read(
    header: Mapping[str, Any], raw: bytes, cells: Collection[str], harmless: Callable[[Any], str]
) -> tuple[str, Place, Claim, dict[str, "Shape"]]:
    """Return the cell, the place in it, if it is a published one, the claim, and the shapes of its arrays
    that follow in blocks. ``harmless`` makes a text safe to display.

    Raises ValueError if ``header`` and ``raw`` are not a claim made in one of ``cells``.
    """
    numbers = header.get("numbers")
    word, cell = header.get("kind"), header.get("cell")
    if not isinstance(word, str) or not word.isidentifier() or len(word) > MOST_WORD:
        raise ValueError("not a word")
    if not isinstance(cell, str) or cell not in cells:
        raise ValueError("unknown cell")
    kind = kind_of(word)
    texts = {key: one_line(harmless(header.get(key, "")), MOST_DETAIL) for key in TEXTS}
    if not all(type(header.get(key, False)) is bool for key in ("said", "raised")):
        raise ValueError("not what the package said")
    if (
        not isinstance(numbers, dict)
        or set(numbers) != set(kind.numbers)
        or not all(type(n) is float for n in numbers.values())
    ):
        raise ValueError("not the numbers of this kind of claim")
    expected = () if texts["unjudged"] or texts["left_out"] else kind.arrays
    arrays, long = _arrays(header, expected, raw)
    claim = Claim(
        word,
        texts["label"][:MOST_LABEL],
        arrays=arrays,
        numbers=numbers,
        detail=texts["detail"],
        mark=texts["mark"],
        own=texts["own"],
        said=bool(header.get("said")),
        raised=bool(header.get("raised")),
        unjudged=texts["unjudged"],
        left_out=texts["left_out"],
    )
    return cell, _place(header.get("place")), claim, long


def shape_of(header: Mapping[str, Any], long: Mapping[str, "Shape"]) -> tuple[int, ...]:
    """Return the shape that an array in blocks has in the notebook. Raises ValueError if it has none."""
    found = next(iter(long.values())).shape
    shape = header.get("shape", list(found))
    if (
        not isinstance(shape, list)
        or len(shape) > MOST_AXES
        or not all(type(n) is int and n > 0 for n in shape)
    ):
        raise ValueError("not a shape")
    if math.prod(shape) != math.prod(found):
        raise ValueError("not the shape of the blocks")
    return tuple(shape)


def _place(place: Any) -> Place:
    if place is None:
        return None
    if (
        not isinstance(place, list)
        or len(place) != 2
        or not all(type(n) is int and 0 <= n < 1 << 31 for n in place)
    ):
        raise ValueError("not a place")
    return place[0], place[1]


def _arrays(
    header: Mapping[str, Any], expected: Collection[str], raw: bytes
) -> tuple[dict[str, Any], dict[str, "Shape"]]:
    """Return the arrays of a claim, and the shapes of those that follow in blocks."""
    shapes, blocks = header.get("arrays"), header.get("blocks", [])
    of_complex = header.get("complex") if header["kind"] == "close" else ()
    if not isinstance(shapes, dict) or set(shapes) != set(expected):
        raise ValueError("not the arrays of this kind of claim")
    if not isinstance(blocks, list) or not all(isinstance(name, str) and name in shapes for name in blocks):
        raise ValueError("not the names of arrays")
    arrays, long, at = {}, {}, 0
    for name, shape in shapes.items():
        if (
            not isinstance(shape, list)
            or len(shape) > MOST_AXES
            or not all(type(n) is int and n >= 0 for n in shape)
        ):
            raise ValueError("not a shape")
        element = _COMPLEX if isinstance(of_complex, list) and name in of_complex else _FLOAT
        if name in blocks:
            if not shape or not MOST_NUMBERS < math.prod(shape) <= MOST_IN_FIELD:
                raise ValueError("not an array in blocks")
            long[name] = Shape(element, tuple(shape))
            continue
        if math.prod(max(n, 1) for n in shape) > MOST_NUMBERS:
            raise ValueError("too large")
        size = element.itemsize * math.prod(shape)
        arrays[name] = np.frombuffer(raw[at : at + size], element).reshape(shape)
        at += size
    if at != len(raw):
        raise ValueError("more bytes than the shapes need")
    if len({shape.shape[0] for shape in long.values()}) > 1:
        raise ValueError("blocks of several lengths")
    return arrays, long


class Shape(NamedTuple):
    """The element type and the shape of an array that comes in blocks of its first axis."""

    element: "np.dtype[Any]"
    shape: tuple[int, ...]

    @property
    def row(self) -> int:
        """The bytes of one row."""
        return self.element.itemsize * math.prod(self.shape[1:])


class Field:
    """A claim whose large arrays, of this ``shape``, come in blocks. ``truth`` stands for the expected
    numbers.
    """

    def __init__(
        self,
        cell: str,
        place: Place,
        claim: Claim,
        long: Mapping[str, Shape],
        *,
        shape: tuple[int, ...] = (),
        truth: Any = None,
    ) -> None:
        self.cell, self.place, self.claim = cell, place, claim
        self._long, self._row = long, 0
        self._length = next(iter(long.values())).shape[0]
        self._first: NDArray[Any] | None = None
        self._truth: NDArray[Any] | None = None
        if truth is not None:
            self.claim = replace(claim, mark="")
            try:
                self._truth = np.broadcast_to(truth, shape)
            except ValueError:
                shapes = f"shape {shape} vs expected shape {np.shape(truth)}"
                self.claim = replace(self.claim, found=Judgement(Verdict.FAIL, shapes, misshapen=True))

    @property
    def complete(self) -> bool:
        """Whether all blocks have come."""
        return self._row == self._length

    def add(self, payload: bytes) -> None:
        """Judge one more block. Raises ValueError if it is none."""
        rows, rest = divmod(len(payload), sum(shape.row for shape in self._long.values()))
        if rest or not 0 < rows <= self._length - self._row:
            raise ValueError("not a block")
        arrays, at = dict[str, NDArray[Any]](), 0
        for name, (element, shape) in self._long.items():
            size = rows * self._long[name].row
            arrays[name] = np.frombuffer(payload[at : at + size], element).reshape(rows, *shape[1:])
            at += size
        if "series" in arrays:
            self._first = arrays["series"][:1].copy() if self._first is None else self._first
            arrays["series"] = np.concatenate([self._first, arrays["series"]])
        if self._truth is not None:
            arrays["expected"] = self._truth.flat[self._row : self._row + rows]
        self.claim = self.claim.with_block(arrays)
        self._row += rows
