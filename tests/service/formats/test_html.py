from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest

from polhode.judging.outcome import SweepResult
from service.cli.grading.report_folder import ReportFolder
from service.formats import html
from service.grading.grade_file import GradeOptions, GradeRequest
from service.grading.grade_files import grade_files
from service.grading.graded_file import GradedFile
from service.sandbox.isolation.select import choose
from tests.support.guests import lend
from tests.support.reports import report_of_verdicts

EVIL = "<img src=x onerror=alert(1)>&amp;\"'`.py"
VOID = {"meta", "img", "br", "hr"}


class Elements(HTMLParser):
    """Names and attributes of all elements; fails where one is not closed."""

    def __init__(self, text):
        super().__init__()
        self.found, self._open = [], []
        self.feed(text)
        assert not self._open

    def handle_starttag(self, name, attributes):
        self.found.append((name, dict(attributes)))
        if name not in VOID:
            self._open.append(name)

    def handle_endtag(self, name):
        assert self._open.pop() == name


@pytest.fixture(scope="module")
def written(rigid_body, sandbox, tmp_path_factory):
    """The folder of a batch: a right file, one whose name and prints are HTML, one that is no submission, one
    that we failed.
    """
    folder = tmp_path_factory.mktemp("batch")
    zeros = (rigid_body.folder / "samples" / "wrong_zeros.py").read_text()
    (folder / EVIL).write_text(
        zeros + "\nprint('</pre><script>alert(2)</script>')\nraise ValueError('<i>slanted</i>')\n"
    )
    (folder / "binary.py").write_bytes(b"\0")
    files = [rigid_body.folder / "samples" / "right_terms.py", folder / EVIL, folder / "binary.py"]
    with pytest.MonkeyPatch.context() as patch:
        lend(sandbox, patch)
        graded = list(
            grade_files(
                [GradeRequest(f, ("2",)) for f in files],
                GradeOptions(rigid_body, 1, ("svg",)),
                choose(),
                jobs=1,
            )
        )
    graded.append(GradedFile(file=Path("lost.py"), fault="the guest went away"))
    out = ReportFolder(folder / "out", [g.file for g in graded])
    for one in graded:
        out.add(one)
    out.write_index(graded, rigid_body)
    return folder / "out"


def test_the_table_links_every_page_and_tells_every_verdict(written):
    text = (written / "index.html").read_text()
    links = [about["href"] for name, about in Elements(text).found if name == "a"]
    assert len(links) == len(set(links)) == 4 and all((written / unquote(link)).is_file() for link in links)
    assert "4 files: 1 all ✓, 1 not all ✓, 1 no submission, 1 not graded" in text
    assert text.count(">✓</td>") == 5 + 2 and text.count(">✗</td>") == 3
    assert "<td>5 of 5</td>" in text and "<td>2 of 5</td>" in text
    assert '<td></td><td class="none" colspan="5">not graded: the guest went away</td>' in text


def test_nothing_of_a_submission_becomes_an_element(written):
    for page in written.rglob("index.html"):
        elements = Elements(page.read_text()).found
        assert not [name for name, about in elements if name in ("script", "i") or "onerror" in about]


def test_pages_need_nothing_from_elsewhere(written):
    for page in written.rglob("index.html"):
        about = [about for _, about in Elements(page.read_text()).found]
        sources = [a["src"] for a in about if "src" in a] + [a["href"] for a in about if "href" in a]
        assert all(s.startswith("data:image/") or (page.parent / unquote(s)).is_file() for s in sources)
    assert any("data:image/svg" in page.read_text() for page in written.rglob("index.html"))


def test_a_page_has_the_card_of_speed_against_accuracy_if_it_was_measured():
    swept = SweepResult("s", [], "a call takes <1 µs; DOP853 would do")
    measured = GradedFile(
        file=Path("a.py"), report=report_of_verdicts("+", sweep=swept), pictures={"sweep.svg": b"<svg/>"}
    )
    text = html.page(measured)
    assert "<li>a call takes &lt;1 µs</li><li>DOP853 would do</li>" in text
    ((name, attributes),) = [one for one in Elements(text).found if one[1].get("class") == "sweep"]
    assert name == "img" and attributes["src"].startswith("data:image/svg+xml;base64,")
    assert "Speed vs" not in html.page(GradedFile(file=Path("a.py"), report=report_of_verdicts("+")))
