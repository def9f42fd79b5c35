"""polhode as a command: ``polhode grade``."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from bench.peers.peer import Command, Marks, Peer, reading
from bench.peers.submissions import Submission, write


class Polhode(Peer):
    """The workspace holds the submissions and the output of ``--json`` for each and for the batch."""

    name, package, batch = "polhode grade", "", "one command for ten files"

    def prepare(self, submissions: Mapping[str, Submission]) -> Sequence[Command]:
        """Write the submissions; no command is needed."""
        for name, submission in submissions.items():
            write(self.workspace.folder / f"{name}.py", submission.script)
        return []

    def one(self, name: str) -> Command:
        """Return the command, whose time includes starting the sandbox."""
        return self._grade([name], f"{name}.json")

    def many(self, names: Sequence[str]) -> Sequence[Command]:
        """Return a single command for all files."""
        return [self._grade(names, "batch.json")]

    def marks(self, name: str) -> Marks:
        """Return the number of ✓ and of all checks of the exercise."""
        return read(
            self.workspace.folder / ("batch.json" if name.startswith("copy") else f"{name}.json"), name
        )

    def _grade(self, names: Sequence[str], out: str) -> Command:
        words = [
            self.workspace.python,
            "-m",
            "service.cli",
            "grade",
            "--exercise",
            "2",
            "--json",
            *(f"{n}.py" for n in names),
        ]
        return Command(words, self.workspace.folder, self.workspace.folder / out)


def read(file: Path, name: str) -> Marks:
    """Return the marks in the output of ``polhode grade --json`` for the file with stem ``name``."""
    with reading("polhode"):
        found = next(r for r in json.loads(file.read_text())["reports"] if Path(r["file"]).stem == name)
        return passed(found["report"])


def passed(report: dict) -> Marks:
    """Return the number of ✓ and of all checks."""
    verdicts = [o["verdict"] for e in report["exercises"] for o in e["outcomes"]]
    return Marks(verdicts.count("pass"), len(verdicts))
