"""What Classroom 50's runner tells an autograder of the submission: by its environment, and by the commit it has checked out.

The names are its own (foundation50/classroom50, runner.py). When a submission was made is the commit's date of committing, which
is the same whenever it is graded; without git, the time in the submission's tag.
"""

import os
import re
import subprocess
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path

from service.formats.classroom50 import About

NAMES = {
    "classroom": ("CLASSROOM",),
    "assignment": ("ASSIGNMENT",),
    "assignment_type": ("ASSIGNMENT_TYPE",),
    "owner": ("OWNER", "USERNAME"),
    "submission": ("SUBMISSION_TAG",),
    "commit": ("COMMIT_URL",),
    "release": ("RELEASE_URL",),
    "review": ("REVIEW_URL", "COMMIT_URL"),
}
"""The variables that each field is read from: the first that is set."""
_NO_HELPERS = {"GIT_ALLOW_PROTOCOL": "none", "GIT_NO_LAZY_FETCH": "1"}
"""Git fetches from nowhere: what to run for a fetch can stand in files of the submission."""
_COMMITTER = re.compile(rb"^committer .*> (\d{1,11}) [+-]\d+$", re.MULTILINE)
_TAG = re.compile(r"submit/(\d{4}-\d\d-\d\dT\d\d-\d\d-\d\dZ)")


class MissingEnvironment(Exception):
    """We are not run by Classroom 50, or not told enough: the message names what is missing."""


def read_environment(environment: Mapping[str, str], folder: Path, graded_at: datetime) -> About:
    """The submission checked out in that folder; NotTold if a variable is missing or no time of submission can be found."""
    told = {field: next((value for name in names if (value := environment.get(name))), "") for field, names in NAMES.items()}
    told["assignment_type"] = told["assignment_type"] or "individual"
    if missing := [" or ".join(NAMES[field]) for field, value in told.items() if not value]:
        raise MissingEnvironment(f"Classroom 50 sets {', '.join(missing)}: not set here")
    submitted_at = _committed(environment.get("GITHUB_SHA", ""), folder) or _tagged(told["submission"])
    if submitted_at is None:
        raise MissingEnvironment(f"neither git nor the tag {told['submission']} tells when the submission was made")
    return About(**told, submitted_at=submitted_at, graded_at=graded_at)


def _committed(commit: str, folder: Path) -> datetime | None:
    """When the commit was made; the folder may be another user's, as it is where the runner works in a container.

    It is the student's: a folder that is made like a bare repository is not taken for one, since git runs what its config says.
    """
    if not re.fullmatch("[0-9a-f]{7,64}", commit):
        return None
    ours = ("-c", "safe.directory=*", "-c", "safe.bareRepository=explicit")
    asked = ["git", *ours, "-C", str(folder), "cat-file", "commit", commit]
    try:
        told = subprocess.run(asked, capture_output=True, timeout=60, check=True, env=os.environ | _NO_HELPERS).stdout
    except (OSError, subprocess.SubprocessError):
        return None
    match = _COMMITTER.search(told)  # the first is the header's: a message comes after it
    return datetime.fromtimestamp(int(match[1]), UTC) if match else None


def _tagged(tag: str) -> datetime | None:
    match = _TAG.match(tag)
    try:
        return datetime.strptime(match[1], "%Y-%m-%dT%H-%M-%SZ").replace(tzinfo=UTC) if match else None
    except ValueError:
        return None
