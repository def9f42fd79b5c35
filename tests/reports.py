"""Reports for tests of tellings: any that hypothesis can think of, with texts that try to be more than text, and one to look at."""

from pathlib import Path

from hypothesis import strategies as st

from ecp.judge import Verdict
from ecp.outcome import Diagnosis, Ending, Outcome, SceneEnding, Tolerance
from ecp.report import ExerciseReport, Picture, Provenance, Report
from service.tellings.files import GradedFile

EVIL = (
    "::error file=a.py,line=1::x", "\n::stop-commands::x\n", "##[add-mask]x", "%0A::debug::", "```", "````\n# h", "|", "\\|",
    "<img src=x>", "</details>", "<!--", "-->", "@everyone", "[x](y)", "![x](y)", "]]>", "<![CDATA[", "&amp;", "\x00", "\x1b[31m",
    "\u202e", "\ufffe", "\ud800", "\r", "\r\n", "\u2028", "=1+1", "[[ATTACHMENT|/etc/passwd]]", "✓  all is well   [got 1]",
    "10 of 10 checks ✓", "a: b", "://", "__init__",
)  # fmt: skip
TEXTS = st.lists(st.one_of(st.sampled_from(EVIL), st.text(st.characters(), max_size=8)), max_size=4).map("".join)
FILES = st.sampled_from(
    ["ann.py", "samples/ann.ipynb", "we|ird @team `x`.py", "a,b:c%0A=d.py", "-rf ::error::.py", "\udcff.py", "Ω/é.py"]
)
IDS = ("1-notebook", "2-pointwise", "2-energy", "2-motion", "4-rate", "gone", "x-1")
MADE = Provenance(seed=7, versions={"polhode": "0.1.0", "python": "3.11.7"}, walls="tier B")
REASON = Tolerance(rtol=1e-6, atol=1e-9, reason="the notebook's own tolerance")
TRACE = '  File "submission.py", line 3, in euler_eqs\n    return w / 0\nZeroDivisionError: division by zero\n'


def outcome(id, verdict="pass", label="", **more):
    verdict = Verdict(verdict)
    detail = {Verdict.PASS: "got 1", Verdict.FAIL: "got 2 vs expected 1", Verdict.UNMEASURED: f"not measured: {more.get('cause')}"}
    return Outcome(**{"id": id, "label": label or id, "verdict": verdict, "detail": detail[verdict], "tolerance": REASON} | more)


def report(*exercises, **more):
    """A report of exercises 1, 2, …, each a list of outcomes."""
    sections = [ExerciseReport(str(k), f"Title {k}", list(outcomes)) for k, outcomes in enumerate(exercises, start=1)]
    return Report(**{"assignment": "rigid-body", "version": "1", "exercises": sections, "provenance": MADE} | more)


def example():
    """A report that has everything once, in the words of a real one."""
    raised = "ZeroDivisionError: division by zero"
    first = [outcome("1-notebook", label="principal moments match the analytic box result")]
    slip = Diagnosis("sign-flipped", "ω̇₂ has the opposite sign", 1.0)
    stopped = Diagnosis("raises", raised, 1.0)
    failed = {"measured": 2.0, "expected": 1.0, "margin": 0.001, "where": "ω̇₂ at question 3", "diagnosis": [slip]}
    second = [
        outcome("2-pointwise", Verdict.FAIL, "euler_eqs agrees with Euler's equations", **failed, hidden=True),
        outcome("2-energy", Verdict.UNMEASURED, "rotational energy conserved (torque-free)", cause=raised, diagnosis=[stopped]),
        outcome("2-drawn", Verdict.UNMEASURED, "what is drawn moves", cause="nothing to follow", counted=False),
    ]
    endings = [SceneEnding("motion", Ending.RAISED, raised, "raises", TRACE)]
    figures = [Picture("omega", "2", "Angular velocity", "ω₁, ω₂ and ω₃ over time")]
    return report(first, second, endings=endings, figures=figures)


def graded(told, file="samples/ann.py", **more):
    return GradedFile(**{"file": Path(file), "report": told, "source": "import x\n\ndef euler_eqs(t, w, I): return w / 0\n"} | more)


@st.composite
def outcomes(draw, id):
    verdict = draw(st.sampled_from(Verdict))
    slips = st.builds(Diagnosis, st.sampled_from(["raises", "sign-flipped", "a|b"]), TEXTS, st.just(1.0))
    return Outcome(
        id=id,
        label=draw(TEXTS),
        verdict=verdict,
        detail=draw(TEXTS),
        margin=draw(st.sampled_from([None, 1e-6, 0.5, 3.0])),
        tolerance=REASON,
        where=draw(st.none() | TEXTS),
        cause=draw(TEXTS) if verdict is Verdict.UNMEASURED else None,
        diagnosis=draw(st.lists(slips, max_size=2)),
        hints=draw(st.lists(TEXTS, max_size=1)),
        hidden=draw(st.booleans()),
        counted=verdict is not Verdict.UNMEASURED or draw(st.booleans()),
    )


@st.composite
def reports(draw):
    """Any report: also one of no exercises, and one in which nothing counts."""
    ids = draw(st.lists(st.sampled_from(IDS), unique=True))
    made = [draw(outcomes(id)) for id in ids]
    cut = draw(st.integers(0, len(made)))
    causes = st.sampled_from([one.cause for one in made if one.cause is not None] or ["nothing"])
    traces = st.none() | st.just(TRACE) | TEXTS
    endings = st.builds(SceneEnding, TEXTS, st.sampled_from(Ending), causes, st.none(), traces)
    figures = draw(st.lists(st.builds(Picture, st.sampled_from(["omega", "cone"]), st.just("1"), TEXTS, TEXTS), max_size=2))
    return report(made[:cut], made[cut:], endings=draw(st.lists(endings, max_size=3)), stdout=draw(TEXTS), figures=figures)


def graded_files():
    """A file with any report."""
    return st.builds(graded, reports(), FILES, seconds=st.floats(0, 1e4))
