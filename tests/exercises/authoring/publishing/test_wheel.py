"""The students' kit as a wheel, and the notebook that installs it."""

import io
import subprocess
import sys
import zipfile
from importlib import metadata

from exercises.authoring.publishing.wheel import notebook, wheel
from polhode.client.kit_hash import WHEEL
from tests.support.assignments import TEMPLATE, known


def test_it_holds_the_kit_and_nothing_else():
    with zipfile.ZipFile(io.BytesIO(wheel())) as archive:
        names = archive.namelist()
        about = archive.read("polhode_kit-1.dist-info/METADATA").decode()
    assert {"polhode/__init__.py", "polhode/client/course.py"} <= set(names)
    assert {name.partition("/")[0] for name in names} == {"polhode", "polhode_kit-1.dist-info"}
    assert about == metadata.distribution("polhode-kit").read_text("METADATA")
    required = {
        line.removeprefix("Requires-Dist: ") for line in about.splitlines() if "Requires-Dist" in line
    }
    assert required == {"numpy", "scipy", "matplotlib"}


def test_it_is_the_same_each_time_and_pip_installs_it(tmp_path):
    made = wheel()
    wheel.cache_clear()
    assert made == wheel()
    (tmp_path / WHEEL).write_bytes(made)
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target"]
    done = subprocess.run([*command, tmp_path / "to", tmp_path / WHEEL], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    text = "".join(p.read_text() for p in (tmp_path / "to").rglob("*.py"))
    assert "def check(" in text and "def euler_eqs" not in text


def test_the_notebook_installs_the_packages_of_its_assignment():
    with known(TEMPLATE.parent / "symbolic") as found:
        text = notebook(found.valid["symbolic"], "https://x.org", f"https://x.org/kit/{WHEEL}").decode()
    assert f"%pip install -q https://x.org/kit/{WHEEL} sympy" in text
