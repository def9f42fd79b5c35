"""gradescope-utils: unittest in the submission's process, by the script that a Gradescope autograder runs for
each student.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from bench.peers.conservation import COMMON, ENERGY, INTEGRATE, MOMENTUM
from bench.peers.peer import Command, Marks, Peer, reading
from bench.peers.submissions import Submission, write

TESTS = f'''{COMMON}
import sys
import unittest

from gradescope_utils.autograder_utils.decorators import weight
from gradescope_utils.autograder_utils.json_test_runner import JSONTestRunner

sys.path.insert(0, sys.argv[1])
from submission import L_body, T_rot, euler_eqs, integrate_body


class Exercise2(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        {INTEGRATE}
        cls.w = w

    @weight(1)
    def test_energy(self):
        """energy conserved"""
        w = self.w
        self.assertTrue({ENERGY})

    @weight(1)
    def test_momentum(self):
        """angular momentum conserved"""
        w = self.w
        self.assertTrue({MOMENTUM})


with open(sys.argv[2], "w") as stream:
    tests = unittest.defaultTestLoader.loadTestsFromTestCase(Exercise2)
    JSONTestRunner(stream=stream, visibility="visible").run(tests)
'''


class Gradescope(Peer):
    """The workspace holds the script, a folder per submission, and its results.json."""

    name, package, batch = "gradescope-utils", "gradescope", "the script ten times"

    def prepare(self, submissions: Mapping[str, Submission]) -> Sequence[Command]:
        """Write the script and the submissions; no command is needed."""
        write(self.workspace.folder / "run_tests.py", TESTS)
        for name, submission in submissions.items():
            write(self.workspace.folder / name / "submission.py", submission.script)
        return []

    def one(self, name: str) -> Command:
        """Return one Python process per submission, as in Gradescope's containers, without the container's
        start.
        """
        return Command(
            [self.workspace.python, "run_tests.py", name, f"{name}/results.json"], self.workspace.folder
        )

    def marks(self, name: str) -> Marks:
        """Return the points."""
        return read(self.workspace.folder / name / "results.json")


def read(file: Path) -> Marks:
    """Return the points of all tests with points in a results.json."""
    with reading("results.json"):
        tests = [t for t in json.loads(file.read_text())["tests"] if t.get("max_score")]
        return Marks(sum(t["score"] for t in tests), sum(t["max_score"] for t in tests))
