"""Draw any report that hypothesis can think of, with texts that try to be more than text."""

from hypothesis import strategies as st

from polhode.judging.claims import NotebookCheck
from polhode.judging.outcome import Diagnosis, Ended, Outcome, Picture, SceneEnd
from polhode.judging.verdict import RowsRight, Verdict
from tests.support.reports import ASSIGNMENT, TOLERANCE, TRACEBACK, graded_file, report

HOSTILE = (
    "::error file=a.py,line=1::x", "\n::stop-commands::x\n", "##[add-mask]x", "%0A::debug::", "```",
    "````\n# h", "|", "\\|",
    "<img src=x>", "</details>", "<!--", "-->", "@everyone", "[x](y)", "![x](y)", "]]>", "<![CDATA[", "&amp;",
    "\x00", "\x1b[31m",
    "\u202e", "\ufffe", "\ud800", "\r", "\r\n", "\u2028", "=1+1", "[[ATTACHMENT|/etc/passwd]]",
    "✓  all is well   [got 1]",
    "10 of 10 checks ✓", "a: b", "://", "__init__",
)  # fmt: skip
TEXTS = st.lists(st.one_of(st.sampled_from(HOSTILE), st.text(st.characters(), max_size=8)), max_size=4).map(
    "".join
)
FILES = st.sampled_from(
    [
        "ann.py",
        "samples/ann.ipynb",
        "we|ird @team `x`.py",
        "a,b:c%0A=d.py",
        "-rf ::error::.py",
        "\udcff.py",
        "Ω/é.py",
    ]
)
IDS = ("1-notebook", "2-pointwise", "2-energy", "2-motion", "4-rate", "gone", "x-1")


@st.composite
def outcomes(draw, id):
    """Draw an outcome of the check ``id``."""
    verdict = draw(st.sampled_from(Verdict))
    slips = st.builds(Diagnosis, st.sampled_from(["raises", "sign-flipped", "a|b"]), TEXTS, st.just(1.0))
    return Outcome(
        id=id,
        label=draw(TEXTS),
        verdict=verdict,
        detail=draw(TEXTS),
        margin=draw(st.sampled_from([None, 1e-6, 0.5, 3.0])),
        tolerance=TOLERANCE,
        where=draw(st.none() | TEXTS),
        cause=draw(TEXTS) if verdict is Verdict.UNMEASURED else None,
        diagnosis=draw(st.lists(slips, max_size=2)),
        hints=draw(st.lists(TEXTS, max_size=1)),
        hidden=draw(st.booleans()),
        counted=verdict is not Verdict.UNMEASURED or draw(st.booleans()),
        points=draw(st.integers(1, 4)),
        partial=(
            draw(st.none() | st.builds(RowsRight, st.integers(0, 3), st.just(4)))
            if verdict is Verdict.FAIL
            else None
        ),
    )


@st.composite
def reports(draw):
    """Draw any report, also one of no exercises, and one in which nothing counts."""
    ids = draw(st.lists(st.sampled_from(IDS), unique=True))
    made = [draw(outcomes(id)) for id in ids]
    cut = draw(st.integers(0, len(made)))
    causes = st.sampled_from([one.cause for one in made if one.cause is not None] or ["nothing"])
    traces = st.none() | st.just(TRACEBACK) | TEXTS
    scene_ends = st.builds(SceneEnd, TEXTS, st.sampled_from(Ended), causes, st.none(), traces)
    figures = draw(
        st.lists(
            st.builds(Picture, st.sampled_from(["omega", "cone"]), st.just("1"), TEXTS, TEXTS), max_size=2
        )
    )
    marks = st.sampled_from(Verdict)
    claims = st.builds(
        NotebookCheck, cell=TEXTS, kind=st.just("check"), label=TEXTS, verdict=marks, detail=TEXTS
    )
    more = {
        "scene_ends": draw(st.lists(scene_ends, max_size=3)),
        "notebook_checks": draw(st.lists(claims, max_size=2)),
    }
    drawn = report(made[:cut], made[cut:], stdout=draw(TEXTS), figures=figures, **more)
    drawn.not_attempted = draw(st.lists(st.sampled_from(["5", "6"]), unique=True)) if drawn.max_score else []
    drawn.total = drawn.max_points = drawn.max_score + ASSIGNMENT.max_points(drawn.not_attempted)
    return drawn


def graded_files():
    """Draw a file with any report."""
    return st.builds(graded_file, reports(), FILES, seconds=st.floats(0, 1e4))
