"""The files for CI have the keys and the shapes that their readers take: by the schemas that check-jsonschema
brings along.
"""

import check_jsonschema
import pytest
from click.testing import CliRunner

from tests.support.checkout import ROOT

FILES = {
    "github-actions": "action.yml",
    "github-workflows": "docs/ci/github-workflow.yml",
    "gitlab-ci": "docs/ci/gitlab-ci.yml",
}


@pytest.mark.parametrize("schema", FILES)
def test_the_schema_holds(schema):
    arguments = ["--builtin-schema", f"vendor.{schema}", str(ROOT / FILES[schema])]
    told = CliRunner().invoke(check_jsonschema.main, arguments)
    assert told.exit_code == 0, told.output


def test_what_does_not_fit_a_schema_is_refused(tmp_path):
    (tmp_path / "action.yml").write_text((ROOT / "action.yml").read_text().replace("runs:", "run:"))
    told = CliRunner().invoke(
        check_jsonschema.main, ["--builtin-schema", "vendor.github-actions", str(tmp_path / "action.yml")]
    )
    assert told.exit_code == 1 and "'runs' is a required property" in told.output
