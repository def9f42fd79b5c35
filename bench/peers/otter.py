"""Otter-Grader: ``otter run`` executes the notebook in a kernel on this machine (its containers are for ``otter grade``)."""

from collections.abc import Mapping, Sequence

from bench.peers.conservation import COMMON, ENERGY, INTEGRATE, MOMENTUM
from bench.peers.gradescope import read
from bench.peers.peer import Command, Marks, Peer
from bench.peers.submissions import Submission, write

TESTS = f"""{COMMON}
from otter.test_files import test_case

OK_FORMAT = False
name = "exercise2"
played = {{}}


@test_case(points=1)
def energy(euler_eqs, integrate_body, T_rot):
    {INTEGRATE}
    played["w"] = w
    assert {ENERGY}


@test_case(points=1)
def momentum(L_body):
    w = played["w"]
    assert {MOMENTUM}
"""
# The names of the notebooks, then where each one's marks go: what `otter run` leaves, cut down to what is read here.
LOOP = """import json, pathlib, sys

from otter.api import grade_submission

if __name__ == "__main__":
    for name in sys.argv[1:]:
        graded = grade_submission(f"{name}.ipynb", "autograder.zip", quiet=True)
        tests = [{"score": r.score, "max_score": r.possible} for r in graded.results.values()]
        pathlib.Path(name).mkdir(exist_ok=True)
        pathlib.Path(name, "results.json").write_text(json.dumps({"tests": tests}))
"""


class Otter(Peer):
    """In ``place``: the autograder's zip, the notebooks, a folder with the results of each."""

    name, package, batch = "otter run", "otter", "otter.api.grade_submission, one process"

    def prepare(self, submissions: Mapping[str, Submission]) -> Sequence[Command]:
        """The zip is made by Otter."""
        write(self.place.folder / "tests/exercise2.py", TESTS)
        write(self.place.folder / "loop.py", LOOP)
        for name, submission in submissions.items():
            write(self.place.folder / f"{name}.ipynb", submission.notebook)
            (self.place.folder / name).mkdir(exist_ok=True)
        what = ["-t", "tests", "-o", "autograder.zip", "--no-config", "--no-requirements", "--no-environment"]
        return [Command([self.place.tool("otter"), "generate", *what], self.place.folder)]

    def one(self, name: str) -> Command:
        """The documented command."""
        words = [self.place.tool("otter"), "run", "-a", "autograder.zip", "-o", name, "--no-logo", f"{name}.ipynb"]
        return Command(words, self.place.folder)

    def many(self, names: Sequence[str]) -> Sequence[Command]:
        """By Otter's interface for Python, which starts Otter once; each notebook still has a kernel of its own."""
        return [Command([self.place.python, "loop.py", *names], self.place.folder)]

    def marks(self, name: str) -> Marks:
        """Points; Otter writes Gradescope's format, with an entry about public tests as a whole that has none."""
        return read(self.place.folder / name / "results.json")
