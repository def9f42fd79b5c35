"""nbgrader: ``nbgrader autograde`` executes the notebook with its checks in a kernel; a batch is a course of
ten students.
"""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

from bench.peers.conservation import COMMON, ENERGY, INTEGRATE, MOMENTUM
from bench.peers.peer import Command, Marks, Peer, reading
from bench.peers.submissions import Submission, code_cell, notebook, write

ENERGY_CELL = f"{COMMON}\n{INTEGRATE}\nassert {ENERGY}"
MOMENTUM_CELL = f"assert {MOMENTUM}"


class Nbgrader(Peer):
    """The workspace holds two courses of one assignment: ``each`` for single submissions and ``batch`` for
    the copies.
    """

    name, package, batch = "nbgrader autograde", "nbgrader", "one command for the assignment"

    def prepare(self, submissions: Mapping[str, Submission]) -> Sequence[Command]:
        """Write the courses. The returned commands create the release version, from which nbgrader restores
        the checks.
        """
        for name, submission in submissions.items():
            write(
                self._course(name) / "submitted" / name / "exercise2/exercise2.ipynb",
                graded_notebook(submission),
            )
        found = []
        for course in ("each", "batch"):
            folder = self.workspace.folder / course
            write(folder / "source/exercise2/exercise2.ipynb", graded_notebook(submissions["right"]))
            found.append(
                Command(
                    [self.workspace.tool("nbgrader"), "generate_assignment", "exercise2", "--force"], folder
                )
            )
        return found

    def one(self, name: str) -> Command:
        """Return the command for one student."""
        words = [self.workspace.tool("nbgrader"), "autograde", "exercise2", "--student", name, "--force"]
        return Command(words, self._course(name))

    def many(self, names: Sequence[str]) -> Sequence[Command]:
        """Return the command for the whole course ``batch``."""
        return [
            Command(
                [self.workspace.tool("nbgrader"), "autograde", "exercise2", "--force"],
                self.workspace.folder / "batch",
            )
        ]

    def marks(self, name: str) -> Marks:
        """Return the points, after ``export``."""
        return read(self._course(name) / "grades.csv", name)

    def export(self) -> Sequence[Command]:
        """Return the commands that export the marks from nbgrader's database."""
        return [
            Command(
                [self.workspace.tool("nbgrader"), "export", "--to", "grades.csv"], self.workspace.folder / c
            )
            for c in ("each", "batch")
        ]

    def _course(self, name: str) -> Path:
        return self.workspace.folder / ("batch" if name.startswith("copy") else "each")


def graded_notebook(submission: Submission) -> str:
    """Return the submission with the checks as nbgrader's tests: locked cells worth one point each."""
    graded = {
        "schema_version": 3,
        "grade": True,
        "solution": False,
        "locked": True,
        "points": 1,
        "task": False,
    }
    answer = {
        "schema_version": 3,
        "grade": False,
        "solution": True,
        "locked": False,
        "task": False,
        "grade_id": "euler",
    }
    return notebook([
        code_cell("setup", submission.setup),
        code_cell("euler", submission.answer, nbgrader=answer),
        code_cell("energy", ENERGY_CELL, nbgrader=graded | {"grade_id": "energy"}),
        code_cell("momentum", MOMENTUM_CELL, nbgrader=graded | {"grade_id": "momentum"}),
    ])  # fmt: skip


def read(file: Path, student: str) -> Marks:
    """Return a student's points in a file of ``nbgrader export``."""
    with reading("nbgrader"):
        with file.open(newline="") as stream:
            row = next(r for r in csv.DictReader(stream) if r["student_id"] == student)
        return Marks(float(row["score"]), float(row["max_score"]))
