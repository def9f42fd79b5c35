"""The wheel that goes into the zip for Gradescope holds no solution."""

import io
import zipfile

from service.gradescope.own_wheel import own_wheel


def test_the_specimens_stay_out(rigid_body, tmp_path):
    outside = tmp_path / "pendulum"
    (outside / "specimens").mkdir(parents=True)
    (outside / "specimens/right_one.py").write_text("def solved(): pass")
    (outside / "__init__.py").touch()
    name, content = own_wheel(outside)
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        held = {path: archive.read(path) for path in archive.namelist()}
    assert (
        name.endswith(".whl")
        and {"service/cli.py", "exercises/rigid_body/secret.py", "exercises/pendulum/__init__.py"} <= held.keys()
    )
    solutions = {path.read_bytes() for path in (rigid_body.folder / "specimens").iterdir() if path.is_file()} | {
        b"def solved(): pass"
    }
    assert not [path for path in held if "/specimens/" in path] and not solutions & set(held.values())
