"""The program that Gradescope's run_autograder starts: it grades the submitted file and writes results.json.

After a system fault it writes no results.json. Gradescope then reports that the autograder failed, which is
no grade, and staff can run it again. Exit codes: 0 with results, 2 without.

The process that grades is another one. This one imports no library before it has reported how that one ended:
where memory is short, an import fails.
"""

import argparse
import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from service.cli.grading.find_files import NoSubmissionFound, find_files

HOME = Path("/autograder")
ANSWERS = (0, 1)  # exit codes of polhode grade


def main(arguments: Sequence[str]) -> int:
    """Grade the one file in /autograder/submission. ``arguments`` are further options of ``polhode
    grade``.
    """
    results, submission = HOME / "results" / "results.json", HOME / "submission"
    results.unlink(missing_ok=True)
    if not submission.is_dir():
        print(f"polhode: system fault: Gradescope provided no folder {submission}; run the autograder again")
        return 2
    try:
        found = find_files([str(submission)])
    except NoSubmissionFound:
        found = []
    if len(found) != 1:
        names = ", ".join(str(file.relative_to(submission)) for file in found)
        several = f"This submission contains {len(found)} .py or .ipynb files: {names}. Submit exactly one."
        _write_refusal(
            several if found else "This submission contains no .py or .ipynb file. Submit exactly one.",
            arguments,
            results,
        )
        return 0
    grade = [
        sys.executable,
        "-I",
        "-m",
        "service.cli",
        "grade",
        str(found[0]),
        *arguments,
        "--gradescope",
        str(results),
    ]
    code = subprocess.run(grade, check=False).returncode
    if code in ANSWERS and results.is_file():
        return 0
    results.unlink(missing_ok=True)
    print(
        f"polhode: system fault (exit code {code}): this submission was not graded; run the autograder again"
    )
    return 2


def _write_refusal(reason: str, arguments: Sequence[str], results: Path) -> None:
    """Write results with no points and the instruction to submit one file."""
    from exercises.authoring.assignments.catalogue import assignments
    from service.cli.output_file import write
    from service.formats import gradescope
    from service.grading.grade import select
    from service.grading.graded_file import GradedFile

    parser = argparse.ArgumentParser(allow_abbrev=False)
    parser.add_argument("--assignment", choices=sorted(assignments()), required=True)
    parser.add_argument("--exercise", action="append")
    asked, _ = parser.parse_known_args(arguments)
    assignment = assignments()[asked.assignment]
    assignment = replace(assignment, exercises=tuple(select(assignment, asked.exercise)))
    refused = GradedFile(file=HOME / "submission", refused=reason)
    write(results, json.dumps(gradescope.document(refused, assignment), ensure_ascii=False))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
