"""What Classroom 50's runner tells: its variables, and the commit's own date in a real repository."""

import os
import subprocess
from datetime import UTC, datetime

import pytest

from service.cli.grading.classroom50_environment import MissingEnvironment, read_environment

NOW = datetime(2026, 3, 2, 8, tzinfo=UTC)
VARIABLES = {
    "CLASSROOM": "physics-26", "ASSIGNMENT": "rigid-body", "ASSIGNMENT_TYPE": "group", "USERNAME": "ann",
    "OWNER": "ann",
    "SUBMISSION_TAG": "submit/2026-02-28T23-59-58Z-a1b2c3d", "COMMIT_URL": "https://git.example/c",
    "RELEASE_URL": "https://git.example/r",
    "REVIEW_URL": "https://git.example/d",
}  # fmt: skip


@pytest.fixture
def commit(tmp_path):
    """A commit written on one day and committed on another, in another zone."""
    dates = {"GIT_AUTHOR_DATE": "2026-01-01T00:00:00+0000", "GIT_COMMITTER_DATE": "2026-03-01T01:02:03+0100"}
    who = {
        f"GIT_{role}_{what}": "Ann > <a@b> 7 +0000"
        for role in ("AUTHOR", "COMMITTER")
        for what in ("NAME", "EMAIL")
    }
    environment = {"PATH": os.environ["PATH"], "HOME": str(tmp_path)} | dates | who
    for words in (
        ["init", "--quiet"],
        ["commit", "--quiet", "--allow-empty", "--message", "m\n\ncommitter x <y> 1 +0000"],
    ):
        subprocess.run(["git", "-C", str(tmp_path), *words], env=environment, check=True)
    asked = ["git", "-C", str(tmp_path), "rev-parse", "HEAD"]
    return subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip()


def test_a_submission_was_made_when_it_was_committed(tmp_path, commit):
    told = read_environment(VARIABLES | {"GITHUB_SHA": commit}, tmp_path, NOW)
    assert told.submitted_at == datetime(2026, 3, 1, 0, 2, 3, tzinfo=UTC) and told.graded_at == NOW
    assert (told.classroom, told.assignment_type, told.owner, told.review) == (
        "physics-26",
        "group",
        "ann",
        "https://git.example/d",
    )


@pytest.mark.parametrize("commit_told", ["", "0" * 40, "--help", "HEAD"])
def test_without_the_commit_the_tag_tells(tmp_path, commit_told):
    assert read_environment(VARIABLES | {"GITHUB_SHA": commit_told}, tmp_path, NOW).submitted_at == datetime(
        2026, 2, 28, 23, 59, 58, tzinfo=UTC
    )


def test_a_submission_that_is_made_like_a_repository_runs_nothing(tmp_path, commit):
    """Git finds a bare repository in any folder, and a fetch from a promisor runs what the repository's
    config names.
    """
    inside = tmp_path / "mine"
    subprocess.run(["git", "init", "--quiet", "--bare", str(inside)], check=True)
    (inside / "config").write_text(
        "[core]\nrepositoryformatversion = 1\nbare = true\n[extensions]\npartialClone = x\n"
        f'[remote "x"]\nurl = .\npromisor = true\nuploadpack = "touch {tmp_path}/ran; false"\n'
    )
    read_environment(VARIABLES | {"GITHUB_SHA": commit}, inside, NOW)
    assert not (tmp_path / "ran").exists()


def test_without_either_there_is_no_time_and_none_is_made_up(tmp_path):
    for tag in ("submit/first", "submit/2026-02-31T23-59-58Z-a"):
        with pytest.raises(MissingEnvironment, match="no commit date and the tag submit/"):
            read_environment(VARIABLES | {"SUBMISSION_TAG": tag}, tmp_path, NOW)


def test_what_older_runners_leave_out(tmp_path):
    told = read_environment(
        {key: VARIABLES[key] for key in VARIABLES if key not in ("OWNER", "ASSIGNMENT_TYPE", "REVIEW_URL")},
        tmp_path,
        NOW,
    )
    assert (told.owner, told.assignment_type, told.review) == ("ann", "individual", VARIABLES["COMMIT_URL"])


def test_everything_that_is_missing_is_named(tmp_path):
    with pytest.raises(
        MissingEnvironment, match=r"^CLASSROOM, OWNER or USERNAME, RELEASE_URL are not set in the environment"
    ):
        read_environment(
            {
                key: VARIABLES[key]
                for key in VARIABLES
                if key not in ("CLASSROOM", "OWNER", "USERNAME", "RELEASE_URL")
            },
            tmp_path,
            NOW,
        )
