"""What students get of an assignment: its public side, nothing that is drawn for an attempt or solves it."""

import io
import json
import zipfile

from exercises.authoring.publishing.public_assignment import archive, build
from tests.support.assignments import copied, known


def _held(slug):
    with zipfile.ZipFile(io.BytesIO(archive(slug))) as opened:
        return {name: opened.read(name) for name in opened.namelist()}


def test_it_is_of_one_assignment_and_the_same_each_time(tmp_path):
    copied(tmp_path)
    with known(tmp_path):
        made = {slug: archive(slug) for slug in ("rigid-body", "damped-oscillator")}
        archive.cache_clear()
        assert made == {slug: archive(slug) for slug in made}
        builds = {slug: build(slug) for slug in made}
        assert builds == {slug: json.loads(_held(slug)["made.json"])["build"] for slug in made}
    assert len(set(builds.values())) == 2


def test_of_an_assignment_only_its_public_side_is_sent(rigid_body):
    names = set(_held("rigid-body"))
    course = {f"course/ecp/{path.name}" for path in (rigid_body.folder / "course/ecp").glob("*.py")}
    assert names == course | {"made.json", "plays.py", "public.json", "truth.npz"}


def test_no_scene_that_is_drawn_for_an_attempt_is_sent(rigid_body):
    held = _held("rigid-body")
    declared = json.loads(held["public.json"])
    with zipfile.ZipFile(io.BytesIO(held["truth.npz"])) as exact:
        solved = {name.partition("/")[0] for name in exact.namelist()}
    fixed = {scene.name for scene in rigid_body.scenes if not callable(scene.inputs)}
    before = {scene.after for scene in rigid_body.scenes if scene.name in fixed} - {None}
    told = {scene["name"] for scene in declared["scenes"]}
    assert solved and solved <= fixed | before, "only what everybody is asked has its exact answer"
    assert told <= fixed | before and "drawn-long" not in told
