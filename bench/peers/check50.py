"""check50: checks import the student's module, each in a process of check50's pool; one command per
submission.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from bench.peers.conservation import COMMON, ENERGY, INTEGRATE, MOMENTUM
from bench.peers.peer import Command, Marks, Peer, reading
from bench.peers.submissions import Submission, write

# One check for both lines: two checks would each import the submission and integrate, which takes a third
# longer. A plain import, because ``check50.py.import_`` does not enter the module in ``sys.modules``, where a
# dataclass with postponed annotations looks for it.
CHECKS = f'''{COMMON}
import check50
import sys


@check50.check()
def conserved():
    """energy and angular momentum conserved"""
    check50.exists("submission.py")
    sys.path.insert(0, "")
    import submission as student
    euler_eqs, integrate_body = student.euler_eqs, student.integrate_body
    T_rot, L_body = student.T_rot, student.L_body
    {INTEGRATE}
    if not ({ENERGY}):
        raise check50.Failure("energy drifts")
    if not ({MOMENTUM}):
        raise check50.Failure("angular momentum drifts")
'''
SETTINGS = 'check50:\n  checks: __init__.py\n  files:\n    - !include "submission.py"\n'


class Check50(Peer):
    """The workspace holds the checks, a folder per submission, and the output of ``-o json``."""

    name, package, batch = "check50 --dev", "check50", "the command ten times"

    def prepare(self, submissions: Mapping[str, Submission]) -> Sequence[Command]:
        """Write the checks and submissions; no command is needed."""
        write(self.workspace.folder / "checks/__init__.py", CHECKS)
        write(self.workspace.folder / "checks/.cs50.yaml", SETTINGS)
        for name, submission in submissions.items():
            write(self.workspace.folder / name / "submission.py", submission.script)
        return []

    def one(self, name: str) -> Command:
        """Return ``check50 --dev``, run in the submission's folder."""
        output = ["-o", "json", "--output-file", "../" + name + ".json"]
        return Command(
            [self.workspace.tool("check50"), "--dev", *output, "../checks"], self.workspace.folder / name
        )

    def marks(self, name: str) -> Marks:
        """Return the checks passed."""
        return read(self.workspace.folder / f"{name}.json")


def read(file: Path) -> Marks:
    """Return the passed checks in the file of ``--output-file``."""
    with reading("check50"):
        results = json.loads(file.read_text())["results"]
        return Marks(sum(r["passed"] is True for r in results), len(results))
