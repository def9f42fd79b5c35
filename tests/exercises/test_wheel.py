"""What the students' kit holds of an assignment: its public side, and nothing that is drawn for an attempt or
solves it.
"""

import io
import json
import zipfile

from exercises.wheel import wheel
from tests.support.assignments import TEMPLATE, copied, known


def test_a_kit_holds_one_assignment(tmp_path):
    copied(tmp_path)
    with known(tmp_path):
        folders = {slug: _folders(wheel(slug)) for slug in ("rigid-body", "damped-oscillator")}
    assert folders == {"rigid-body": {"rigid_body"}, "damped-oscillator": {"damped_oscillator"}}


def _folders(content):
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return {
            name.split("/")[2]
            for name in archive.namelist()
            if name.startswith("polhode/assignments/") and name.count("/") > 2
        }


def test_the_kit_requires_the_packages_of_its_assignment():
    with known(TEMPLATE.parent / "symbolic"):
        required = {slug: _required(wheel(slug)) for slug in ("rigid-body", "symbolic")}
    common = ["numpy", "scipy", "matplotlib"]
    assert required == {"rigid-body": common, "symbolic": [*common, "sympy"]}


def _required(content):
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        (metadata,) = (name for name in archive.namelist() if name.endswith("/METADATA"))
        lines = archive.read(metadata).decode().splitlines()
    return [line.removeprefix("Requires-Dist: ") for line in lines if line.startswith("Requires-Dist: ")]


def test_the_name_by_which_a_client_calls_the_server_makes_no_work(monkeypatch):
    wheel("rigid-body", "http://a.example")
    written = []
    monkeypatch.setattr(
        zipfile.ZipFile,
        "writestr",
        lambda archive, about, *rest, write=zipfile.ZipFile.writestr: (
            written.append(about.filename) or write(archive, about, *rest)
        ),
    )
    made = wheel("rigid-body", "http://b.example")
    assert [name.split("/")[-1] for name in written] == ["made.json", "RECORD"]
    with zipfile.ZipFile(io.BytesIO(made)) as archive:
        assert archive.testzip() is None and len(archive.namelist()) == len({*archive.namelist()})
        (record,) = (name for name in archive.namelist() if name.endswith("/RECORD"))
        listed = [line.split(",")[0] for line in archive.read(record).decode().splitlines()]
    assert sorted(listed) == sorted(archive.namelist())


def test_of_an_assignment_only_its_public_side_is_in_the_kit(rigid_body):
    with zipfile.ZipFile(io.BytesIO(wheel("rigid-body"))) as archive:
        home = "polhode/assignments/rigid_body/"
        held = {
            name.removeprefix(home): archive.read(name)
            for name in archive.namelist()
            if name.startswith(home)
        }
        names = archive.namelist()
    public = {path.name for path in (rigid_body.folder / "public").glob("*.py")}
    assert held.keys() == public | {"made.json", "plays.py", "public.json", "truth.npz"}
    assert not any(
        "samples" in name or name.endswith(("hidden_checks.py", "truth.py", "scenes.py")) for name in names
    )


def test_no_scene_that_is_drawn_for_an_attempt_is_in_the_kit(rigid_body):
    with zipfile.ZipFile(io.BytesIO(wheel("rigid-body"))) as archive:
        declared = json.loads(archive.read("polhode/assignments/rigid_body/public.json"))
        with zipfile.ZipFile(io.BytesIO(archive.read("polhode/assignments/rigid_body/truth.npz"))) as exact:
            solved = {name.partition("/")[0] for name in exact.namelist()}
    fixed = {scene.name for scene in rigid_body.scenes if not callable(scene.inputs)}
    before = {scene.after for scene in rigid_body.scenes if scene.name in fixed} - {None}
    told = {scene["name"] for scene in declared["scenes"]}
    assert solved and solved <= fixed | before, "only what everybody is asked has its exact answer"
    assert told <= fixed | before and "drawn-long" not in told
