"""polhode publish: the students' notebook in a file."""

import json

import pytest

from exercises.authoring.publishing import wheel
from polhode.client.kit_hash import WHEEL
from service.cli.__main__ import main
from tests.support.assignments import known
from tests.support.author_notebooks import write
from tests.support.toolbox import FOLDER


def test_the_file_is_the_notebook_that_a_server_of_that_address_serves(tmp_path, capsys, monkeypatch):
    file = tmp_path / "new" / "toolbox.ipynb"
    with known(FOLDER) as found:
        assert main(["publish", "toolbox", "--into", str(file.parent), "--server", "https://x.org/"]) == 0
        assert capsys.readouterr().out == f"written to {file}\n"
        served = wheel.notebook(found.valid["toolbox"], "https://x.org", f"https://x.org/kit/{WHEEL}")
        assert file.read_bytes() == served and "{{" not in file.read_text()
        monkeypatch.setenv("POLHODE_PUBLIC_URL", "https://y.org")
        assert main(["publish", "toolbox", "--into", str(file.parent)]) == 0
        assert "https://y.org" in file.read_text() and json.loads(file.read_text())["cells"]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["falling"], "give --server URL or set POLHODE_PUBLIC_URL"),
        (["rising", "--server", "https://x.org"], "there is no assignment rising"),
        (
            ["falling", "--server", "https://x.org", "--into", "falling"],
            "would lie beside the author's notebook",
        ),
        (["falling", "--server", "https://x.org", "--into", "falling/assignment.py"], "File exists"),
    ],
)
def test_what_cannot_be_published_is_an_error_and_writes_nothing(
    tmp_path, capsys, monkeypatch, arguments, sentence
):
    folder = write(tmp_path)
    monkeypatch.chdir(tmp_path)
    before = {file: file.read_bytes() for file in folder.iterdir()}
    with known(folder):
        assert main(["publish", *arguments]) == 2
    assert sentence in capsys.readouterr().err
    assert {file: file.read_bytes() for file in folder.iterdir() if file.is_file()} == before


def test_an_error_of_the_declaration_is_named_with_its_file(tmp_path, capsys):
    folder = write(tmp_path)
    (folder / "fall.ipynb").unlink()
    with known(folder):
        assert main(["publish", "falling", "--server", "https://x.org"]) == 2
    assert "fall.ipynb is missing" in capsys.readouterr().err
