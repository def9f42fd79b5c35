"""nbgrader: ``nbgrader autograde`` executes the notebook, checks and all, in a kernel; a batch is a course of ten students."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

from bench.peers.conservation import COMMON, ENERGY, INTEGRATE, MOMENTUM
from bench.peers.peer import Command, Marks, Peer, reading
from bench.peers.submissions import Submission, code_cell, notebook, write

ENERGY_CELL = f"{COMMON}\n{INTEGRATE}\nassert {ENERGY}"
MOMENTUM_CELL = f"assert {MOMENTUM}"


class Nbgrader(Peer):
    """In ``place``: two courses of one assignment each, ``each`` for submissions one by one and ``batch`` for the copies."""

    name, package, batch = "nbgrader autograde", "nbgrader", "one command for the assignment"

    def prepare(self, submissions: Mapping[str, Submission]) -> Sequence[Command]:
        """The release version, which the checks of a submission are overwritten from, is made by nbgrader."""
        for name, submission in submissions.items():
            write(self._course(name) / "submitted" / name / "exercise2/exercise2.ipynb", graded_notebook(submission))
        found = []
        for course in ("each", "batch"):
            folder = self.place.folder / course
            write(folder / "source/exercise2/exercise2.ipynb", graded_notebook(submissions["right"]))
            found.append(Command([self.place.tool("nbgrader"), "generate_assignment", "exercise2", "--force"], folder))
        return found

    def one(self, name: str) -> Command:
        """One student of the course."""
        words = [self.place.tool("nbgrader"), "autograde", "exercise2", "--student", name, "--force"]
        return Command(words, self._course(name))

    def many(self, names: Sequence[str]) -> Sequence[Command]:
        """The whole course ``batch``, which has these."""
        return [Command([self.place.tool("nbgrader"), "autograde", "exercise2", "--force"], self.place.folder / "batch")]

    def marks(self, name: str) -> Marks:
        """Points, after ``export``."""
        return read(self._course(name) / "grades.csv", name)

    def export(self) -> Sequence[Command]:
        """What has to run before marks are read: nbgrader keeps them in a database."""
        return [
            Command([self.place.tool("nbgrader"), "export", "--to", "grades.csv"], self.place.folder / c) for c in ("each", "batch")
        ]

    def _course(self, name: str) -> Path:
        return self.place.folder / ("batch" if name.startswith("copy") else "each")


def graded_notebook(submission: Submission) -> str:
    """The submission with the checks as nbgrader's tests: cells that are locked and give a point each."""
    graded = {"schema_version": 3, "grade": True, "solution": False, "locked": True, "points": 1, "task": False}
    answer = {"schema_version": 3, "grade": False, "solution": True, "locked": False, "task": False, "grade_id": "euler"}
    return notebook([
        code_cell("setup", submission.setup),
        code_cell("euler", submission.answer, nbgrader=answer),
        code_cell("energy", ENERGY_CELL, nbgrader=graded | {"grade_id": "energy"}),
        code_cell("momentum", MOMENTUM_CELL, nbgrader=graded | {"grade_id": "momentum"}),
    ])  # fmt: skip


def read(file: Path, student: str) -> Marks:
    """A student's points in a file of ``nbgrader export``."""
    with reading("nbgrader"):
        with file.open(newline="") as stream:
            row = next(r for r in csv.DictReader(stream) if r["student_id"] == student)
        return Marks(float(row["score"]), float(row["max_score"]))
