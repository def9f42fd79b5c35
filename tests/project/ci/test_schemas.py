"""The files for CI have the keys and the shapes that their readers take: by the schemas that check-jsonschema brings along."""

import subprocess
import sys

import pytest

from tests.support.checkout import ROOT

FILES = {
    "github-actions": "action.yml",
    "github-workflows": "docs/ci/github-workflow.yml",
    "gitlab-ci": "docs/ci/gitlab-ci.yml",
}


@pytest.mark.parametrize("schema", FILES)
def test_the_schema_holds(schema):
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", f"vendor.{schema}", ROOT / FILES[schema]]
    told = subprocess.run(command, capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stdout + told.stderr
