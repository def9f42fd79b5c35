"""A notebook is sent and stored without what grading does not read."""

import json

import pytest

from polhode.notebook.gather import whole_notebook
from polhode.notebook.strip_outputs import strip_outputs
from tests.support.big_notebook import with_outputs


def document(*cells, **fields):
    return {"cells": [*cells], "metadata": {}, "nbformat": 4, "nbformat_minor": 5} | fields


def code(source, **fields):
    return {
        "cell_type": "code",
        "execution_count": 1,
        "id": "a",
        "metadata": {},
        "outputs": [],
        "source": source,
    } | fields


def test_outputs_attachments_and_metadata_go_and_the_rest_stays(rigid_body):
    content = (rigid_body.folder / "samples" / "right_notebook.ipynb").read_bytes()
    before, after = json.loads(content), json.loads(strip_outputs(with_outputs(content).decode()))
    assert [cell["source"] for cell in after["cells"]] == [cell["source"] for cell in before["cells"]]
    assert {cell["cell_type"]: sorted(cell) for cell in after["cells"]}["code"] == sorted(
        code("").keys() & before["cells"][-1].keys()
    )
    assert not any(
        cell.get("outputs") or cell.get("attachments") or cell["metadata"] for cell in after["cells"]
    )
    assert list(after["metadata"]) == ["kernelspec"] and after["nbformat"] == 4


@pytest.mark.parametrize("source", ["ω̇ = 1\n", ["a\n", "b"], "'\ud800'", "\x00\u2028"])
def test_what_is_stripped_stays_the_same_when_stripped_again(source):
    full = json.dumps(document(code(source, outputs=[{"output_type": "stream"}])))
    once = strip_outputs(full)
    assert once != full and strip_outputs(once) == once and once.encode()
    assert json.loads(once)["cells"][0]["source"] == source


def test_a_notebook_without_outputs_is_left_as_it_is():
    for indent in (None, 1, 4):
        text = json.dumps(document(code("x = 1")), indent=indent)
        assert strip_outputs(text) == text
    sent = whole_notebook(["", "a = 1", "def f(): return a"]).source
    assert strip_outputs(sent) == sent


@pytest.mark.parametrize(
    "text",
    [
        "",
        "x = 1",
        "[]",
        "{}",
        '{"cells": 3}',
        '{"cells": [3]}',
        "[" * 100_000,
        '{"cells": [], "metadata": 3}',
    ],
)
def test_what_is_no_notebook_is_an_error(text):
    with pytest.raises(ValueError, match="not a Jupyter notebook"):
        strip_outputs(text)
