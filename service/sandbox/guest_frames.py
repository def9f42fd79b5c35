"""Reading and validating the frames of a guest, which are untrusted bytes.

A frame is ``kind`` (1 byte), payload length (4 bytes, little endian) and payload. Kind ``J`` is a JSON event.
Kind ``A`` are all arrays of the scene in progress: header length (2 bytes), JSON header of shapes by name,
then raw little-endian numbers. Kind ``C`` is a claim of the notebook's own checks (claim_frames.py), which
blocks of numbers, kind ``D``, may follow. The host knows which arrays a scene returns, their element type and
largest shape; anything else violates the protocol.
"""

import functools
import json
import math
import struct
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from exercises.authoring.assignments.assignment import ArraySpec
from polhode.judging.claims import Claim
from polhode.judging.outcome import Ended, SceneEnd
from polhode.judging.remarks import MOST_REMARKS, Absent, Notes
from service.sandbox import claim_frames
from service.sandbox.guest.cells.claim_recorder import MOST_CLAIMS, MOST_CUT, MOST_IN_ALL, MOST_REPORTED
from service.sandbox.guest.cells.place import Place
from service.sandbox.guest.wire import HEADER
from service.sandbox.job import Job
from service.sandbox.result import GUEST_CODES, CellCost, OnScene, PlayResult, ignore
from service.sandbox.untrusted_text import text

MOST_JSON = 64 * 1024
MOST_CELL_ENDS = 20
DTYPES: Mapping[str, np.dtype[Any]] = {"float64": np.dtype("<f8"), "uint8": np.dtype("u1")}
HEAD = struct.Struct("<cI")
ArrayPlace = tuple[str, np.dtype[Any], tuple[int, ...], int, int]
"""An array in an answer: name, dtype, shape, number of elements, offset in bytes."""


class ProtocolError(Exception):
    """The guest sent bytes that are no valid answer to the job."""


class Reader:
    """Reader of one play's byte stream, which it turns into ``result``. Calls ``on_scene`` with the name of
    each scene that begins.

    ``started`` is the scene in progress. ``prepared`` is True once the child has applied its layers and
    loaded the assignment's code; only then does it run the submission. ``not_prepared`` says why that code
    failed. ``loaded`` is True once the cells have run; until then ``statement`` is the one that runs, or if
    ``out_of_time`` says that the time is spent, the one that took most of it. ``done`` is True after the last
    frame. ``streamed`` counts the bytes of blocks.
    """

    def __init__(self, job: Job, result: PlayResult, on_scene: OnScene = ignore) -> None:
        self._on_scene = on_scene
        self.result, self.prepared, self.done = result, False, False
        self.started: str | None = None
        self.not_prepared = ""
        self.statement: Place | None = None
        self.out_of_time = ""
        self._scenes = {s.name: s for s in job.scenes}
        self._functions, self._cells = set(job.functions), {c.name for c in job.cells}
        sizes = [
            sum(math.prod(a.shape) * DTYPES[a.dtype].itemsize for a in s.returns.values()) for s in job.scenes
        ]
        self._most = {b"J": MOST_JSON, b"A": MOST_JSON + max(sizes, default=0)}
        self._most |= {b"C": claim_frames.MOST_BYTES, b"D": claim_frames.MOST_BLOCK}
        self._buffer = bytearray()
        self.loaded = False
        self._lines, self.streamed = job.lines, 0
        self._field: claim_frames.Field | None = None
        self._claims, self._numbers = (
            {False: 0, True: 0},
            0,
        )  # of the submission's own cells and of published ones

    def feed(self, data: bytes) -> None:
        """Read more bytes. Raises ProtocolError as soon as they are invalid."""
        self._buffer += data
        for kind, payload in self._frames():
            if (self._field is not None) is not (kind == b"D"):
                raise ProtocolError("not the blocks of a claim")
            if self.done:
                raise ProtocolError("bytes after the end")
            if kind == b"J":
                self._event(_json(payload))
            elif kind == b"C":
                self._claim(payload)
            elif kind == b"D":
                self._block(payload)
            else:
                self._arrays(payload)

    def _frames(self) -> Iterator[tuple[bytes, bytes]]:
        while len(self._buffer) >= HEAD.size:
            kind, length = HEAD.unpack_from(self._buffer)
            if length > self._most.get(kind, -1):
                raise ProtocolError("not a frame")
            if len(self._buffer) < HEAD.size + length:
                return
            payload = bytes(self._buffer[HEAD.size : HEAD.size + length])
            del self._buffer[: HEAD.size + length]
            yield kind, payload

    def _event(self, event: Mapping[str, Any]) -> None:
        match event.get("event"):
            case "prepared" if not self.prepared:
                self.prepared = True
            case "not-prepared" if not self.prepared:
                self.not_prepared = text(event.get("author"))
            case "statement" if not self.loaded:
                self.statement = self._place(event)
            case "stopped" if not self.loaded:
                self.statement, self.out_of_time = self._place(event), text(event.get("sentence"), 600)
            case "defined" if not self.loaded:
                self.loaded = self.result.loaded = True
                self.result.defined = self._listed(event, "names")
                self.result.missing = self._listed(event, "missing")
                self.result.claims_left_out = _count(event.get("claims_left_out", 0))
                self.result.costs = dict(_costs(event, self._cells))
            case "left-out" if not self.loaded:
                self._leave_out(self._known(event, "cell", self._cells), _line(event.get("sentence")))
            case "start":
                self.started = self._next(event)
                self._on_scene(self.started)
            case "scene":
                self._end(event)
            case "cell":
                name = self._known(event, "cell", self._cells)
                if len(self.result.cells) < MOST_CELL_ENDS:
                    self.result.cells.setdefault(name, _scene_end(name, event))
            case "done":
                self.done = True
            case _:
                raise ProtocolError("unknown event")

    def _end(self, event: Mapping[str, Any]) -> None:
        """Record the end of the scene in progress."""
        name = self.started
        if name is None or event.get("scene") != name:
            raise ProtocolError("another scene ended than was started")
        scene_end = _scene_end(name, event)
        if scene_end.ended is not Ended.FINISHED:
            self.result.arrays.pop(name, None)
        elif name not in self.result.arrays:
            raise ProtocolError("a scene ended without its arrays")
        if scene_end.ended is Ended.RAISED and isinstance(author := event.get("author"), str):
            self.result.author_errors[name] = _line(author)
        if scene_end.ended is Ended.FINISHED:
            self.result.notes[name] = _notes(event, self._scenes[name].returns)
        self.result.scene_ends[name], self.started = scene_end, None

    def _next(self, event: Mapping[str, Any]) -> str:
        """Return the scene that a "start" event names. Raises ProtocolError if it may not start now."""
        name = self._known(event, "scene", self._scenes)
        after = self._scenes[name].after
        early = after in self._scenes and not self.result.finished(str(after))
        if self.started is not None or name in self.result.scene_ends or early:
            raise ProtocolError("a scene out of turn")
        return name

    def _known(self, event: Mapping[str, Any], kind: str, names: Any) -> str:
        name = event.get(kind)
        if not isinstance(name, str) or name not in names:
            raise ProtocolError(f"unknown {kind}")
        return name

    def _place(self, event: Mapping[str, Any]) -> Place:
        """Return the place of a statement that an event names."""
        line, column = _count(event.get("line")), _count(event.get("column"))
        return Place(self._known(event, "cell", self._cells), line, column)

    def _listed(self, event: Mapping[str, Any], kind: str) -> set[str]:
        """Return the requested functions that an event lists."""
        if not isinstance(names := event.get(kind), list):
            raise ProtocolError("not a list of names")
        return {name for name in names if isinstance(name, str)} & self._functions

    def _arrays(self, payload: bytes) -> None:
        if self.started is None or self.started in self.result.arrays or len(payload) < HEADER.size:
            raise ProtocolError("an answer without a question")
        scene, header = self._scenes[self.started], payload[: HEADER.size + HEADER.unpack_from(payload)[0]]
        places, size = _layout(header, tuple(scene.returns.items()))
        if len(payload) != size:
            raise ProtocolError("an answer of another length than its shapes")
        self.result.arrays[scene.name] = {
            name: np.frombuffer(payload, dtype, count, at).reshape(shape)
            for name, dtype, shape, count, at in places
        }

    def _claim(self, payload: bytes) -> None:
        if self.loaded:
            raise ProtocolError("a claim after the cells")
        (length,) = HEADER.unpack_from(payload) if len(payload) >= HEADER.size else (0,)
        header, numbers = _json(payload[HEADER.size : HEADER.size + length]), payload[HEADER.size + length :]
        try:
            cell, place, claim, long = claim_frames.read(header, numbers, self._cells, text)
            shape = claim_frames.shape_of(header, long) if long else ()
        except ValueError:
            raise ProtocolError("not a claim") from None
        self._claims[place is not None] += 1
        self._numbers += sum(array.nbytes // 8 for array in claim.arrays.values())
        self._numbers += sum(shape.row * shape.shape[0] // 8 for shape in long.values())
        if (
            self._claims[False] > MOST_CLAIMS
            or self._claims[True] > MOST_REPORTED + MOST_CUT
            or self._numbers > 2 * MOST_IN_ALL
        ):
            raise ProtocolError("too many claims")
        if long:
            fixed, truth = self._lines.get((cell, place), ((), None)) if place else ((), None)
            claim = replace(claim, numbers={**claim.numbers, **dict(fixed)})
            self._field = claim_frames.Field(
                cell, place, claim, long, shape=shape, truth=truth() if truth else None
            )
        else:
            self._keep(cell, place, claim)

    def _block(self, payload: bytes) -> None:
        """Judge one more block of the claim in progress."""
        assert self._field is not None
        try:
            self._field.add(payload)
        except ValueError:
            raise ProtocolError("not a block of a claim") from None
        self.streamed += HEAD.size + len(payload)
        if self._field.complete:
            self._keep(self._field.cell, self._field.place, replace(self._field.claim, arrays={}))
            self._field = None

    def _keep(self, cell: str, place: claim_frames.Place, claim: Claim) -> None:
        if place is None:
            self.result.claims.append(claim.outcome(cell))
        else:
            self.result.reported.setdefault((cell, place), []).append(claim)

    def _leave_out(self, cell: str, reason: str) -> None:
        """Let the claims of a published cell count for nothing."""
        for place, made in self.result.reported.items():
            if place[0] == cell:
                made[:] = [replace(claim, arrays={}, left_out=reason) for claim in made]


@functools.lru_cache(maxsize=64)  # most answers of a scene have the same header
def _layout(header: bytes, returns: tuple[tuple[str, ArraySpec], ...]) -> tuple[list[ArrayPlace], int]:
    """Return the places of an answer's arrays and the length of the answer."""
    shapes, specs, places, at = _json(header[HEADER.size :]), dict(returns), list[ArrayPlace](), len(header)
    if set(shapes) != set(specs):
        raise ProtocolError("an answer with other arrays than asked for")
    for name, listed in shapes.items():
        dtype, shape = DTYPES[specs[name].dtype], _shape(listed, specs[name])
        places.append((name, dtype, shape, math.prod(shape), at))
        at += math.prod(shape) * dtype.itemsize
    return places, at


def _count(value: Any) -> int:
    if type(value) is not int or not 0 <= value < 1 << 53:
        raise ProtocolError("not a count")
    return value


def _costs(event: Mapping[str, Any], cells: Collection[str]) -> Iterator[tuple[str, CellCost]]:
    for listed in event.get("costs", ()):
        match listed:
            case [str(cell), float(cpu_s), float(peak_mb)] if cell in cells and cpu_s >= 0 and peak_mb >= 0:
                yield cell, CellCost(cpu_s, peak_mb)
            case _:
                raise ProtocolError("not the costs of a cell")


def _notes(event: Mapping[str, Any], returns: Mapping[str, ArraySpec]) -> Notes:
    """Return what the end of a scene says about its arrays."""
    remarks, absent = event.get("remarks", []), event.get("absent", {})
    if not isinstance(remarks, list) or len(remarks) > MOST_REMARKS:
        raise ProtocolError("not remarks")
    if not isinstance(absent, dict) or not absent.keys() <= returns.keys():
        raise ProtocolError("other arrays are absent than were asked for")
    return Notes([_line(one) for one in remarks], {name: _absent(why) for name, why in absent.items()})


def _absent(why: Any) -> Absent:
    match why:
        case [str(sentence), code]:
            return Absent(_line(sentence), _code(code))
    raise ProtocolError("not a reason")


def _code(code: Any) -> str | None:
    return code if isinstance(code, str) and code in GUEST_CODES else None


def _line(value: Any) -> str:
    """Return a sentence of the guest on one line."""
    return " ".join(text(value, 600).split())


def _scene_end(name: str, event: Mapping[str, Any]) -> SceneEnd:
    try:
        scene_end = Ended(str(event.get("ended")))
    except ValueError:
        raise ProtocolError("unknown scene end") from None
    trace, because = event.get("traceback"), event.get("because")
    return SceneEnd(
        scene=name,
        ended=scene_end,
        sentence=_line(event.get("sentence", "")),
        code=_code(event.get("code")),
        traceback=text(trace) if trace else None,
        because=_line(because) if because else None,
    )


def _shape(shape: Any, spec: ArraySpec) -> tuple[int, ...]:
    if (
        not isinstance(shape, list)
        or len(shape) != len(spec.shape)
        or not all(type(n) is int and n >= 0 for n in shape)
    ):
        raise ProtocolError("not a shape")
    within = (
        spec.up_to
        and shape[-1] == spec.shape[-1]
        and all(1 <= n <= most for n, most in zip(shape, spec.shape, strict=True))
    )
    if not within and tuple(shape) != spec.shape:
        raise ProtocolError("an array of another shape than asked for")
    return tuple(shape)


def _json(data: bytes) -> Mapping[str, Any]:
    try:
        document = json.loads(data)
    except (ValueError, RecursionError):
        raise ProtocolError("not JSON") from None
    if not isinstance(document, dict):
        raise ProtocolError("not an object")
    return document
