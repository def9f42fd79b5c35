"""What run_autograder runs: finds what was handed in, has it graded, and leaves results.json; or none where we could not grade.

Without one Gradescope tells that the autograder failed, which is no verdict, and can run it again. Exit codes: 0 where there are
results, 2 where there are none.
"""

import argparse
import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from service.cli.files import NoSubmissionFound, find_files
from service.cli.output_dir import write

HOME = Path("/autograder")
ANSWERS = (0, 1)  # exit codes of polhode grade


def main(arguments: Sequence[str]) -> int:
    """Grade the one file in /autograder/submission; ``arguments`` are more of ``polhode grade``'s."""
    results, submission = HOME / "results" / "results.json", HOME / "submission"
    results.unlink(missing_ok=True)
    if not submission.is_dir():
        print(f"polhode: there is no folder {submission}, which is nobody's empty submission")
        return 2
    found = _found(submission)
    if len(found) != 1:
        _refuse([str(file.relative_to(submission)) for file in found], arguments, results)
        return 0
    grade = [sys.executable, "-I", "-m", "service.cli", "grade", str(found[0]), *arguments, "--gradescope", str(results)]
    code = subprocess.run(grade, check=False).returncode
    if code in ANSWERS and results.is_file():
        return 0
    results.unlink(missing_ok=True)
    print(f"polhode: this submission was not graded (exit code {code}), which says nothing about it: run the autograder again")
    return 2


def _found(submission: Path) -> list[Path]:
    """Every .py and .ipynb that was handed in."""
    try:
        return find_files([str(submission)])
    except NoSubmissionFound:
        return []


def _refuse(names: Sequence[str], arguments: Sequence[str], results: Path) -> None:
    """No points, and what to hand in instead."""
    from exercises.catalogue import assignments
    from service.formats import gradescope
    from service.grading.grade import select
    from service.grading.result import GradedFile

    parser = argparse.ArgumentParser(allow_abbrev=False)
    parser.add_argument("--assignment", choices=sorted(assignments()), required=True)
    parser.add_argument("--exercise", action="append")
    asked, _ = parser.parse_known_args(arguments)
    assignment = assignments()[asked.assignment]
    assignment = replace(assignment, exercises=tuple(select(assignment, asked.exercise)))
    refused = GradedFile(file=HOME / "submission", refused=_sentence(names))
    write(results, json.dumps(gradescope.document(refused, assignment), ensure_ascii=False))


def _sentence(names: Sequence[str]) -> str:
    if not names:
        return "There is no .py or .ipynb file in this submission. Hand in one of either."
    return f"Hand in one file: this submission has {len(names)} that could be graded, {', '.join(names)}."


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
