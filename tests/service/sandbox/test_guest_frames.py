"""The host's reading of a stranger's bytes: whatever does not answer the question breaks the protocol."""

import json
import struct

import numpy as np
import pytest

from exercises.authoring.assignments.assignment import ArraySpec
from polhode.judging.outcome import Ended
from polhode.judging.remarks import MOST_REMARKS
from polhode.report.dataclass_json import document
from service.sandbox.guest.cells.claim_recorder import MOST_CLAIMS
from service.sandbox.guest.wire import pack
from service.sandbox.guest_frames import ProtocolError, Reader
from service.sandbox.job import Cell, Job, SceneRequest
from service.sandbox.result import PlayResult
from service.sandbox.untrusted_text import text

SCENE = SceneRequest(
    "s",
    "play",
    "f",
    {},
    {"w": ArraySpec((3, 2)), "film": ArraySpec((4, 2, 2, 3), "uint8", up_to=True)},
    1.0,
    None,
)
JOB = Job("", "", (Cell("cell 1", ""),), ("f", "g"), (SCENE,))


def event(**fields):
    payload = json.dumps(fields).encode()
    return struct.pack("<cI", b"J", len(payload)) + payload


def headed(header, raw, kind=b"A"):
    head = json.dumps(header).encode()
    payload = struct.pack("<H", len(head)) + head + raw
    return struct.pack("<cI", kind, len(payload)) + payload


def arrays(size=48 + 12, **shapes):
    return headed({"w": [3, 2], "film": [1, 2, 2, 3]} | shapes, np.arange(6.0).tobytes() + bytes(size - 48))


ARRAYS = arrays()
START, FINISHED = (
    event(event="start", scene="s"),
    event(event="scene", scene="s", ended="finished", sentence=""),
)


def ended(**fields):
    return event(event="scene", scene="s", ended="finished", sentence="", **fields)


def read(*frames, at_once=True):
    seen = PlayResult()
    reader = Reader(JOB, seen)
    data = b"".join(frames)
    for piece in [data] if at_once else [data[i : i + 1] for i in range(len(data))]:
        reader.feed(piece)
    return reader, seen


@pytest.mark.parametrize("at_once", [True, False])
def test_a_whole_play(at_once):
    defined = event(event="defined", names=["f", "print", 3], missing=[])
    reader, seen = read(defined, START, ARRAYS, FINISHED, event(event="done"), at_once=at_once)
    assert reader.done and seen.defined == {"f"} and seen.finished("s")
    assert seen.arrays["s"]["w"].tolist() == [[0, 1], [2, 3], [4, 5]]
    assert seen.arrays["s"]["film"].shape == (1, 2, 2, 3)


@pytest.mark.parametrize(
    "frames",
    [
        [b"\x00" * 8],
        [struct.pack("<cI", b"J", 1 << 30)],
        [struct.pack("<cI", b"J", 3) + b"{]}"],
        [struct.pack("<cI", b"J", 2) + b"[]"],
        [event(event="defined", names=None)],
        [START, FINISHED],
        [START, arrays(48, film=[0, 2, 2, 3])],
        [START, arrays(48 + 8, film=[1, 2, 2, 2])],
        [struct.pack("<cI", b"J", 40000) + b"[" * 40000],
        [event(event="verdict", passed=True)],
        [event(event="start", scene="other")],
        [event(event="start", scene=["s"])],
        [event(event="scene", scene="s", ended="perfect")],
        [event(event="cell", scene="cell 9", ended="raised")],
        [event(event="scene", scene="s", ended="not-played", sentence="")],
        [ARRAYS],
        [START, ARRAYS, ARRAYS],
        [START, ARRAYS, FINISHED, ARRAYS],
        [START, arrays(48 + 12 + 48, R=[3, 2])],
        [START, arrays(w=[2, 3])],
        [START, arrays(48 + 4)],
        [START, arrays(48 + 20)],
        [START, arrays(w=[3, -2])],
        [START, arrays(w=[3, True])],
        [START, arrays(w=[10**12, 10**12])],
        [START, arrays(48 + 60, film=[5, 2, 2, 3])],
        [START, struct.pack("<cI", b"A", 1) + b"\x00"],
        [START, headed({"w": [3, 2]}, bytes(48)), FINISHED],
        [event(event="done"), START],
        [START, ARRAYS, ended(remarks="one")],
        [START, ARRAYS, ended(remarks=["one"] * (MOST_REMARKS + 1))],
        [START, ARRAYS, ended(absent={"other": ["why", None]})],
        [START, ARRAYS, ended(absent={"w": "why"})],
        [START, ARRAYS, ended(absent={"w": [1, None]})],
        [START, ARRAYS, ended(absent=["w"])],
    ],
)
def test_anything_else_breaks_the_protocol(frames):
    with pytest.raises(ProtocolError):
        read(*frames)


def test_notes_are_taken_as_plain_lines_with_known_codes():
    why = {"w": ["one\n\x1b[31mtwo", "wrong-shape"], "film": ["three", "made-up"]}
    _, seen = read(START, ARRAYS, ended(remarks=["a\nb", "x" * 9999, 3], absent=why))
    noted = seen.noted("s")
    assert noted.remarks[0] == "a b" and len(noted.remarks[1]) <= 600 and noted.remarks[2:] == ["3"]
    assert noted.absent["film"] == ("three", None) and noted.absent["w"].code == "wrong-shape"
    assert "\n" not in noted.absent["w"].sentence and "\x1b" not in noted.absent["w"].sentence
    assert noted.unread(None) == noted.absent["w"] and noted.unread(["film"]) == noted.absent["film"]
    assert seen.noted("other").unread(None) is None


def test_arrays_of_a_scene_that_did_not_finish_are_dropped():
    _, seen = read(START, ARRAYS, event(event="scene", scene="s", ended="timed-out", sentence="late"))
    assert "s" not in seen.arrays and seen.scene_ends["s"].ended is Ended.TIMED_OUT


def answer(**arrays):
    payload = pack(arrays)
    return struct.pack("<cI", b"A", len(payload)) + payload


ANSWER = answer(x=np.array([1.0, 2.0, 3.0]), n=np.array(4.0))
ANSWERS = {"x": ArraySpec((3,)), "n": ArraySpec(())}


def asked(frame, returns=ANSWERS):
    """Return a reader that has read the answer of a scene, and the arrays."""
    scene = SceneRequest("s", "play", "f", {}, returns, 1.0, None)
    reader = Reader(Job("", "", (), ("f",), (scene,)), PlayResult())
    reader.feed(START + frame)
    return reader, reader.result.arrays["s"]


def test_an_answer_is_taken_once_for_each_scene():
    reader, arrays = asked(ANSWER)
    assert {name: array.tolist() for name, array in arrays.items()} == {"x": [1.0, 2.0, 3.0], "n": 4.0}
    with pytest.raises(ProtocolError, match="an answer without a question"):
        reader.feed(ANSWER)


def test_a_length_may_be_shorter_where_the_specification_allows_it():
    film = {"film": ArraySpec((4, 2, 2, 3), "uint8", up_to=True)}
    for length in (1, 4):
        _, arrays = asked(answer(film=np.ones((length, 2, 2, 3), np.uint8)), returns=film)
        assert arrays["film"].dtype == "u1" and len(arrays["film"]) == length


@pytest.mark.parametrize(
    "frame",
    [
        struct.pack("<cI", b"A", len(ANSWER) - 13) + ANSWER[5:-8],
        answer(x=np.ones(3)),
        answer(x=np.ones(3), n=np.ones(()), more=np.ones(1)),
        answer(x=np.ones(4), n=np.ones(())),
        answer(x=np.ones((3, 1)), n=np.ones(())),
        answer(x=np.ones(3), n=np.ones(1)),
        answer(x=np.ones(3, np.uint8), n=np.ones(())),
        struct.pack("<cI", b"A", 0),
        struct.pack("<cI", b"A", 1) + b"\x00",
        struct.pack("<cIH", b"A", 34, 1000) + bytes(32),
        struct.pack("<cI", b"A", 1 << 20),
        headed({"scene": "s", "name": "x", "shape": [3]}, bytes(24)),
    ],
)
def test_an_answer_has_the_arrays_asked_for(frame):
    with pytest.raises(ProtocolError):
        asked(frame)


CLAIM_HEAD = {
    "kind": "check",
    "label": "a",
    "detail": "",
    "unjudged": "",
    "left_out": "",
    "cell": "cell 1",
    "numbers": {},
}
CLAIM = headed(CLAIM_HEAD | {"arrays": {"passed": []}}, struct.pack("<d", 1.0), b"C")
DEFINED = event(event="defined", names=[], missing=[], claims_left_out=7)


def test_claims_are_taken_while_the_cells_run_up_to_a_number():
    _, seen = read(*[CLAIM] * MOST_CLAIMS, DEFINED, at_once=False)
    assert [check.line for check in seen.claims] == ["✓  a"] * MOST_CLAIMS and seen.claims_left_out == 7
    left_out = [
        event(event="defined", names=[], missing=[], claims_left_out=many)
        for many in (-1, 1.5, True, "7", 1 << 60)
    ]
    for frames in (
        [DEFINED, CLAIM],
        [CLAIM] * (MOST_CLAIMS + 1),
        [CLAIM[:-1], DEFINED],
        *([one] for one in left_out),
    ):
        with pytest.raises(ProtocolError):
            read(*frames)


def test_each_child_claims_the_same_again():
    first, other = (read(*[CLAIM] * many, DEFINED)[1] for many in (2, 3))
    first.add(other)
    assert len(first.claims) == 2


def test_a_diagnosis_code_is_one_that_a_guest_may_name():
    for code, kept in (("raises", "raises"), ("sign-flipped", None), ("<b>", None), (7, None)):
        _, seen = read(START, event(event="scene", scene="s", ended="raised", sentence="no", code=code))
        assert seen.scene_ends["s"].code == kept


def test_texts_are_bounded_and_harmless():
    wild = "a\x1b[31m\u202eb\ud800\u2066c\n\td\x00"
    shown = text(wild)
    assert shown == "a\ufffd[31m\ufffdb\ufffd\ufffdc\n\td\ufffd"
    assert shown.encode()
    assert len(text("x" * 10**6)) == 8192
    _, seen = read(
        START, event(event="scene", scene="s", ended="raised", sentence=wild, traceback=[wild], code=7)
    )
    json.dumps(document(seen.scene_ends["s"])).encode()
