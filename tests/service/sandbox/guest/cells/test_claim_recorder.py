import importlib
import json
import os
import struct
import sys

import numpy as np
import pytest

from polhode.judging.author_errors import AuthorError
from service.sandbox.guest.cells import claim_recorder
from service.sandbox.guest.cells.claim_recorder import (
    MOST_AXES,
    MOST_CLAIMS,
    MOST_IN_ALL,
    MOST_IN_FIELD,
    MOST_NUMBERS,
    Recorder,
)
from service.sandbox.guest.wire import Writer

PACKAGE = {
    "__init__.py": "from .validate import close as near\n",
    "validate.py": """
import numpy as np

def check(passed, label, detail="", *, strict=True):
    print("✓" if passed else "✗", f" {label}", f"  [{detail}]" if detail else "")
    if strict and not passed:
        raise AssertionError(label)
    return bool(passed)

def close(a, b, label, *, rtol=1e-6, atol=1e-9, strict=True):
    return check(np.allclose(a, b, rtol=rtol, atol=atol), label, "their own text", strict=strict)

def below(value, threshold, label):
    return check(value < threshold, label)

def conserved(series, label, *, rel_drift=1e-4):
    return check(np.ptp(series) < rel_drift, label)
""",
    "order.py": "def converges(errors, label):\n    return errors[-1] < errors[0]\n",
    "broken.py": "x = 1\n1 / 0\n",
    "invalid.py": "x = 1\ny = = 2\n",
}


class Kept(Writer):
    """A writer that keeps the frames."""

    def __init__(self):
        super().__init__(-1)
        self.frames, self.blocks = [], []

    def _frame(self, kind, payload):
        if kind == b"D":
            self.blocks.append(payload)
            return
        (length,) = struct.unpack_from("<H", payload)
        self.frames.append((kind, json.loads(payload[2 : 2 + length]), payload[2 + length :]))


@pytest.fixture
def lab(tmp_path, monkeypatch):
    for name, source in PACKAGE.items():
        (tmp_path / "lab").mkdir(exist_ok=True)
        (tmp_path / "lab" / name).write_text(source, encoding="utf-8")
    (tmp_path / "words.txt").write_text("lab.order: converges\n")
    monkeypatch.setattr(claim_recorder, "course", [str(tmp_path)])
    monkeypatch.setattr(sys, "path", [*sys.path, str(tmp_path)])
    importlib.invalidate_caches()
    yield "import lab.order\nfrom lab import validate\n"
    for name in [name for name in sys.modules if name.partition(".")[0] == "lab"]:
        del sys.modules[name]


def recorded(source, action):
    write = Kept()
    recorder = Recorder(write)
    recorder.wrap([source])
    recorder.cell = "cell 3"
    validate = sys.modules["lab.validate"]
    with recorder.recording():
        action(validate)
    validate.check(True, "after the cells")
    return recorder, write


def test_a_claim_is_sent_with_its_numbers_as_they_were(lab, capsys):
    got = np.array([1.0, 2.0])

    def action(validate):
        assert validate.close(got, 1, "a", atol=1) is True
        got[:] = 7.0
        validate.check(np.bool_(True), "b", "detail")
        validate.check(5, "c")

    recorder, write = recorded(lab, action)
    assert [kind for kind, _, _ in write.frames] == [b"C"] * 3 and recorder.left_out == 0
    (_, first, raw), (_, second, truth), (_, third, _) = write.frames
    assert first == {
        **{"kind": "close", "label": "a", "detail": "their own text", "mark": "✓", "own": ""},
        **{"cell": "cell 3", "said": True, "raised": False, "unjudged": "", "left_out": ""},
        **{"numbers": {"rtol": 1e-6, "atol": 1.0}, "arrays": {"got": [2], "expected": []}},
        **{"complex": [], "blocks": []},
    }
    assert np.frombuffer(raw).tolist() == [1.0, 2.0, 1.0]
    assert (second["kind"], second["own"], np.frombuffer(truth).tolist()) == ("check", "detail", [1.0])
    assert (third["detail"], third["mark"]) == ("", "✓")
    printed = capsys.readouterr().out.splitlines()
    assert printed[0] == "✓  a   [their own text]" and len(printed) == 4


def test_a_strict_cross_is_recorded_and_raised(lab):
    def action(validate):
        with pytest.raises(AssertionError, match="a") as caught:
            validate.close(1, 2, "a")
        errors.append(caught.value)
        validate.close(1, 2, "b", strict=False)

    errors = []
    recorder, write = recorded(lab, action)
    assert [(h["said"], h["raised"], h["mark"]) for _, h, _ in write.frames] == [
        (False, True, "✗"),
        (False, False, "✗"),
    ]
    assert recorder.has_raised(errors[0]) and not recorder.has_raised(AssertionError("a"))


def test_other_names_of_a_word_and_other_words_are_recorded(lab):
    def action(validate):
        sys.modules["lab"].near(1, 1, "by another name")
        sys.modules["lab.order"].converges([1.0, 0.1], "it converges")
        validate.below(0.1, 0.2, label="small")

    _, write = recorded(lab, action)
    assert [(h["kind"], h["label"], h["said"]) for _, h, _ in write.frames] == [
        ("close", "by another name", True),
        ("converges", "it converges", True),
        ("below", "small", True),
    ]
    assert write.frames[2][1]["numbers"] == {"limit": 0.2}


@pytest.mark.parametrize(
    "call",
    [
        lambda validate: validate.close([1, 2], [1, 2, 3], "a"),
        lambda validate: validate.close(None, 1.0, "a"),
        lambda validate: validate.close(1.0),
        lambda validate: validate.check(np.array([True, True]), "a"),
    ],
)
def test_a_call_that_fails_makes_no_claim(lab, call):
    def action(validate):
        with pytest.raises((ValueError, TypeError)):
            call(validate)

    assert recorded(lab, action)[1].frames == []


@pytest.mark.parametrize(("module", "line"), [("broken", 2), ("invalid", 2)])
def test_a_broken_module_is_the_authors_error_with_its_line(lab, module, line):
    with pytest.raises(AuthorError, match=rf"course/lab/{module}.py, line {line}: "):
        Recorder(Kept()).wrap([f"from lab import {module}\n"])
    Recorder(Kept()).wrap([lab, "import lab.nothing\nfrom lab import nothing\n", "lab = = 1"])


@pytest.mark.parametrize(
    ("series", "reason"),
    [
        (
            np.broadcast_to(1.0, MOST_IN_FIELD + 1),
            f"{MOST_IN_FIELD + 1} numbers; one check may have at most {MOST_IN_FIELD}",
        ),
        (np.zeros((1,) * (MOST_AXES + 1)), f"an array has more than {MOST_AXES} axes"),
    ],
)
def test_what_is_too_large_is_said_with_the_reason(lab, series, reason):
    _, write = recorded(lab, lambda validate: validate.conserved(series, "a"))
    ((_, header, raw),) = write.frames
    assert (header["unjudged"], header["said"]) == (reason, True)
    assert header["arrays"] == {} and raw == b"" == b"".join(write.blocks)


def test_a_large_field_is_sent_in_blocks(lab):
    field = np.arange(3.0 * MOST_NUMBERS).reshape(3, -1)
    _, write = recorded(lab, lambda validate: validate.close(field, field[:1], "a", strict=False))
    ((_, header, raw),) = write.frames
    assert header["blocks"] == ["got", "expected"] and raw == b"" and header["shape"] == [3, MOST_NUMBERS]
    blocks = [np.frombuffer(block) for block in write.blocks]
    assert [len(block) for block in blocks] == [2 * MOST_NUMBERS] * 3
    assert np.array_equal(blocks[2][:MOST_NUMBERS], field[2])
    assert np.array_equal(blocks[2][MOST_NUMBERS:], field[0])
    _, write = recorded(lab, lambda validate: validate.close(field, 0.0, "a", strict=False))
    ((_, header, raw),) = write.frames
    assert header["blocks"] == ["got"] and len(raw) == 8 and len(write.blocks) == 3


def test_all_claims_together_are_bounded(lab, monkeypatch):
    monkeypatch.setattr(claim_recorder, "MOST_IN_ALL", 5000)
    _, write = recorded(lab, lambda validate: [validate.conserved(np.ones(1000), "a") for _ in range(6)])
    assert [bool(header["unjudged"]) for _, header, _ in write.frames] == [False] * 5 + [True]
    recorder, write = recorded(
        lab, lambda validate: [validate.check(True, "a") for _ in range(MOST_CLAIMS + 3)]
    )
    assert len(write.frames) == MOST_CLAIMS and recorder.left_out == 3 and MOST_IN_ALL >= 1e8


def test_a_frame_is_a_head_and_its_payload():
    read, written = os.pipe()
    Writer(written).claim({"kind": "check"}, {"passed": np.array(1.0)}, MOST_NUMBERS)
    kind, length = struct.unpack("<cI", os.read(read, 5))
    assert kind == b"C" and len(os.read(read, 1000)) == length
    os.close(read)
    os.close(written)
