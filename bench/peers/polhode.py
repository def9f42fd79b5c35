"""polhode itself as a command: ``polhode grade``."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from bench.peers.peer import Command, Marks, Peer, reading
from bench.peers.submissions import Submission, write


class Polhode(Peer):
    """In ``place``: the submissions, and what ``--json`` printed about each or about the batch."""

    name, package, batch = "polhode grade", "", "one command for ten files"

    def prepare(self, submissions: Mapping[str, Submission]) -> Sequence[Command]:
        """No command is needed."""
        for name, submission in submissions.items():
            write(self.place.folder / f"{name}.py", submission.script)
        return []

    def one(self, name: str) -> Command:
        """Run polhode from a cold start: sandbox, its interpreter, grading, exit."""
        return self._grade([name], f"{name}.json")

    def many(self, names: Sequence[str]) -> Sequence[Command]:
        """A single command."""
        return [self._grade(names, "batch.json")]

    def marks(self, name: str) -> Marks:
        """Checks that are ✓, of all of the exercise."""
        return read(self.place.folder / ("batch.json" if name.startswith("copy") else f"{name}.json"), name)

    def _grade(self, names: Sequence[str], out: str) -> Command:
        words = [self.place.python, "-m", "service.cli", "grade", "--exercise", "2", "--json", *(f"{n}.py" for n in names)]
        return Command(words, self.place.folder, self.place.folder / out)


def read(file: Path, name: str) -> Marks:
    """What ``polhode grade --json`` printed about the file of that stem."""
    with reading("polhode"):
        found = next(r for r in json.loads(file.read_text())["reports"] if Path(r["file"]).stem == name)
        return passed(found["report"])


def passed(report: dict) -> Marks:
    """Checks that are ✓."""
    verdicts = [o["verdict"] for e in report["exercises"] for o in e["outcomes"]]
    return Marks(verdicts.count("pass"), len(verdicts))
