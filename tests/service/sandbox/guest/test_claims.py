import json
import os
import struct

import numpy as np
import pytest

from polhode.judging import validate
from service.sandbox.guest.claims import MOST_AXES, MOST_CLAIMS, MOST_IN_ALL, MOST_NUMBERS, Recorder
from service.sandbox.guest.wire import Writer


class Kept(Writer):
    """A writer that keeps the frames."""

    def __init__(self):
        self.frames = []

    def _frame(self, kind, payload):
        (length,) = struct.unpack_from("<H", payload)
        self.frames.append((kind, json.loads(payload[2 : 2 + length]), payload[2 + length :]))


def recorded(action):
    recorder, write = Recorder(), Kept()
    recorder.cell = "cell 3"
    with recorder.recording():
        action()
    validate.check(True, "after the cells")
    recorder.send(write)
    recorder.send(write)
    return recorder, write.frames


def test_a_claim_is_sent_with_its_numbers_as_they_were(capsys):
    got = np.array([1.0, 2.0])

    def action():
        validate.close(got, 1, "a", atol=1)
        got[:] = 7.0
        validate.check(np.bool_(True), "b", "detail")
        validate.conserved(None, "c")

    recorder, frames = recorded(action)
    assert [kind for kind, _, _ in frames] == [b"C"] * 3 and recorder.left_out == 0
    (_, first, raw), (_, second, truth), (_, third, nothing) = frames
    assert first == {
        **{"kind": "close", "label": "a", "detail": "", "unfit": "", "cell": "cell 3", "left_out": ""},
        **{"numbers": {"rtol": 1e-6, "atol": 1.0}, "arrays": {"got": [2], "expected": []}, "complex": []},
    }
    assert np.frombuffer(raw).tolist() == [1.0, 2.0, 1.0]
    assert (second["kind"], second["detail"], np.frombuffer(truth).tolist()) == ("check", "detail", [1.0])
    assert third["unfit"].startswith("series is None") and third["arrays"] == {} and nothing == b""


@pytest.mark.parametrize(
    ("series", "reason"),
    [
        (
            np.zeros(MOST_NUMBERS + 1),
            f"{MOST_NUMBERS + 1} numbers; one check may have at most {MOST_NUMBERS}",
        ),
        (np.zeros((1,) * (MOST_AXES + 1)), f"an array has more than {MOST_AXES} axes"),
    ],
)
def test_what_is_too_large_is_left_out_with_the_reason(series, reason, capsys):
    _, ((_, header, raw),) = recorded(lambda: validate.conserved(series, "a"))
    assert header["left_out"] == reason and header["arrays"] == {} and raw == b""


def test_all_claims_together_are_bounded(capsys):
    many = MOST_IN_ALL // MOST_NUMBERS + 1
    _, frames = recorded(lambda: [validate.conserved(np.ones(MOST_NUMBERS), "a") for _ in range(many)])
    assert [bool(header["left_out"]) for _, header, _ in frames] == [False] * (many - 1) + [True]
    recorder, frames = recorded(lambda: [validate.check(True, "a") for _ in range(MOST_CLAIMS + 3)])
    assert len(frames) == MOST_CLAIMS and recorder.left_out == 3


def test_a_frame_is_a_head_and_its_payload():
    read, written = os.pipe()
    Writer(written).claim({"kind": "check"}, {"condition": np.array(1.0)})
    kind, length = struct.unpack("<cI", os.read(read, 5))
    assert kind == b"C" and len(os.read(read, 1000)) == length
    os.close(read)
    os.close(written)
