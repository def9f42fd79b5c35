"""The hooks: valid for pre-commit itself, and run as it runs them, entry,
arguments and file names in a row.
"""

import os
import shlex
import shutil
import subprocess
import sys

import pytest
import yaml

from tests.support.checkout import ROOT

MANIFEST = ROOT / ".pre-commit-hooks.yaml"
HOOKS = {hook["id"]: hook for hook in yaml.safe_load(MANIFEST.read_text())}


def run(id, folder, args=(), names=()):
    """As in the environment that pre-commit makes of our wheel: its programs come first on the PATH."""
    environment = os.environ | {"PATH": f"{sys.prefix}/bin:{os.environ['PATH']}", "PRE_COMMIT": "1"}
    command = [*shlex.split(HOOKS[id]["entry"]), *args, *names]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_pre_commit_takes_the_manifest():
    command = [sys.executable, "-m", "pre_commit", "validate-manifest", MANIFEST]
    told = subprocess.run(command, capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stdout + told.stderr
    assert set(HOOKS) == {"polhode-grade", "polhode-verify"}


@pytest.mark.slow
def test_polhode_grade_is_given_file_names(tmp_path, rigid_body):
    names = ["right_terms.py", "wrong_zeros.py"]
    for name in names:
        (tmp_path / name).write_bytes((rigid_body.folder / "samples" / name).read_bytes())
    told = run("polhode-grade", tmp_path, ["--exercise", "2"], names)
    assert told.returncode == 1 and all(f"== {name}" in told.stdout for name in names), told.stderr


def test_polhode_verify_takes_the_modules_of_the_clone_it_is_in(tmp_path):
    (tmp_path / "service").mkdir()
    (tmp_path / "service" / "__init__.py").touch()
    (tmp_path / "service" / "cli").mkdir()
    (tmp_path / "service" / "cli" / "__init__.py").touch()
    (tmp_path / "service" / "cli" / "__main__.py").write_text(
        "import sys\n\n\ndef main():\n    print(sys.argv[1:])\n"
    )
    told = run("polhode-verify", tmp_path, ["--only", "right_terms.py"])
    assert (told.returncode, told.stdout) == (0, "['verify', '--only', 'right_terms.py']\n"), told.stderr


@pytest.mark.slow
def test_polhode_verify_judges_by_the_clone_it_is_in(tmp_path):
    for room in ("exercises", "reference", "service"):
        shutil.copytree(ROOT / room, tmp_path / room, ignore=shutil.ignore_patterns("__pycache__"))
    expected, only = (
        tmp_path / "exercises/rigid_body/samples/expected.toml",
        ["--only", "right_terms.py", "rigid-body"],
    )
    told = run("polhode-verify", tmp_path, only)
    assert told.returncode == 0, told.stdout + told.stderr
    entry = '["right_terms.py"]\n'
    expected.write_text(expected.read_text().replace(entry, f'{entry}fail = ["2-energy"]\n'))
    told = run("polhode-verify", tmp_path, only)
    assert told.returncode == 1 and "2-energy" in told.stdout, told.stdout + told.stderr
