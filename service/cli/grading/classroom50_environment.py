"""The submission's identity in Classroom 50, read from the runner's environment variables and the checked-out
commit.

The variables are those of foundation50/classroom50, runner.py. The time of submission is the commit date,
which a regrade does not change; without git, it is the time in the submission's tag.
"""

import os
import re
import subprocess
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path

from service.cli.errors import CommandError
from service.formats.classroom50 import SubmissionInfo

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
"""The environment variables of each field; the first one set is used."""
_NO_HELPERS = {"GIT_ALLOW_PROTOCOL": "none", "GIT_NO_LAZY_FETCH": "1"}
"""Forbid fetching: files of the submission could name a command to run for it."""
_COMMITTER = re.compile(rb"^committer .*> (\d{1,11}) [+-]\d+$", re.MULTILINE)


class MissingEnvironment(CommandError):
    """Classroom 50's runner did not start this process, or a value is missing; the message names it."""


def read_environment(environment: Mapping[str, str], folder: Path, graded_at: datetime) -> SubmissionInfo:
    """Return the identity of the submission checked out in ``folder``.

    Raises MissingEnvironment if a variable is not set or no time of submission is found.
    """
    values = {
        field: next((value for name in names if (value := environment.get(name))), "")
        for field, names in NAMES.items()
    }
    values["assignment_type"] = values["assignment_type"] or "individual"
    if missing := [" or ".join(NAMES[field]) for field, value in values.items() if not value]:
        unset = f"{', '.join(missing)} {'are' if len(missing) > 1 else 'is'} not set"
        raise MissingEnvironment(f"{unset} in the environment: run this in Classroom 50's runner")
    submitted_at = _commit_time(environment.get("GITHUB_SHA", ""), folder) or _tag_time(values["submission"])
    if submitted_at is None:
        cause = f"git has no commit date and the tag {values['submission']} has no time"
        raise MissingEnvironment(
            f"cannot determine when this was submitted: {cause}; check out the repository with its history"
        )
    return SubmissionInfo(**values, submitted_at=submitted_at, graded_at=graded_at)


def _commit_time(commit: str, folder: Path) -> datetime | None:
    """Return the commit date, or None.

    The folder may belong to another user, as in a container, and its content is the student's. Git must not
    take it for a bare repository, because it would run commands from the repository's configuration.
    """
    if not re.fullmatch("[0-9a-f]{7,64}", commit):
        return None
    safe = ("-c", "safe.directory=*", "-c", "safe.bareRepository=explicit")
    asked = ["git", *safe, "-C", str(folder), "cat-file", "commit", commit]
    try:
        content = subprocess.run(
            asked, capture_output=True, timeout=60, check=True, env=os.environ | _NO_HELPERS
        ).stdout
    except (OSError, subprocess.SubprocessError):
        return None
    match = _COMMITTER.search(content)  # the first match is in the header; the message follows
    return datetime.fromtimestamp(int(match[1]), UTC) if match else None


def _tag_time(tag: str) -> datetime | None:
    try:
        return datetime.strptime(
            tag[: len("submit/2026-12-31T23-59-59Z")], "submit/%Y-%m-%dT%H-%M-%SZ"
        ).replace(tzinfo=UTC)
    except ValueError:
        return None
