"""Otter-Grader: ``otter run`` executes the notebook in a kernel on this machine (only ``otter grade`` uses
containers).
"""

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
# Grade the named notebooks and write their marks: the part of `otter run`'s output that is read here.
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
    """The workspace holds the autograder zip, the notebooks, and a folder with the results of each."""

    name, package, batch = "otter run", "otter", "otter.api.grade_submission, one process"

    def prepare(self, submissions: Mapping[str, Submission]) -> Sequence[Command]:
        """Write tests and notebooks. The returned command creates the autograder zip."""
        write(self.workspace.folder / "tests/exercise2.py", TESTS)
        write(self.workspace.folder / "loop.py", LOOP)
        for name, submission in submissions.items():
            write(self.workspace.folder / f"{name}.ipynb", submission.notebook)
            (self.workspace.folder / name).mkdir(exist_ok=True)
        what = ["-t", "tests", "-o", "autograder.zip", "--no-config", "--no-requirements", "--no-environment"]
        return [Command([self.workspace.tool("otter"), "generate", *what], self.workspace.folder)]

    def one(self, name: str) -> Command:
        """Return the documented command."""
        words = [
            self.workspace.tool("otter"),
            "run",
            "-a",
            "autograder.zip",
            "-o",
            name,
            "--no-logo",
            f"{name}.ipynb",
        ]
        return Command(words, self.workspace.folder)

    def many(self, names: Sequence[str]) -> Sequence[Command]:
        """Return a script that starts Otter once and calls its Python API; each notebook still has its own
        kernel.
        """
        return [Command([self.workspace.python, "loop.py", *names], self.workspace.folder)]

    def marks(self, name: str) -> Marks:
        """Return the points. Otter writes Gradescope's format, with one entry for all public tests that has
        no points.
        """
        return read(self.workspace.folder / name / "results.json")
