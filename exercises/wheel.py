"""The students' kit of an assignment as a wheel: ``polhode``, and the assignment's public side with the exact
arrays of its public scenes.

Each kit is a distribution of its own, ``polhode-kit-SLUG``, that contains all of ``polhode``. Several of them
can be installed in one environment: each has its own folder below polhode/assignments.
"""

import functools
import hashlib
import io
import json
import logging
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import polhode
from exercises import packages, zipfiles
from exercises.assignment import Assignment, Scene
from exercises.catalogue import find

log = logging.getLogger(__name__)
METADATA = f"""Metadata-Version: 2.1
Name: {{name}}
Version: {polhode.KIT}
Summary: The students' kit of a polhode course server: local checks, and submitting. Imported as polhode.
License: MIT
Requires-Python: >=3.11
Requires-Dist: numpy
Requires-Dist: scipy
Requires-Dist: matplotlib
"""


def filename(slug: str) -> str:
    """Return the wheel's file name. A notebook may contain its address for years, so it changes only with
    ``polhode.KIT``.
    """
    return f"{_distribution(slug)}-{polhode.KIT}-py3-none-any.whl"


@functools.cache
def build(slug: str) -> str:
    """Return a hash of the content of an assignment's kit."""
    digest = hashlib.sha256()
    for name, content in sorted(_content(slug).items()):
        digest.update(f"{name}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()[:16]


def wheel(slug: str, server: str | None = None) -> bytes:
    """Return the kit's wheel, byte for byte the same for the same content, with the address of the ``server``
    that distributes it.
    """
    made = {"build": build(slug)} | ({"server": server} if server else {})
    return _wheel(slug).content({f"{_home(find(slug))}/made.json": json.dumps(made).encode()})


@functools.cache
def _wheel(slug: str) -> zipfiles.Wheel:
    """Return what does not depend on the server's address, as any client can choose that in a request."""
    assignment, info = find(slug), f"{_distribution(slug)}-{polhode.KIT}.dist-info"
    metadata = METADATA.format(name=_distribution(slug).replace("_", "-"))
    metadata += "".join(f"Requires-Dist: {name}\n" for name in sorted(set(assignment.packages)))
    return zipfiles.Wheel(info, metadata, _content(slug))


def notebook(assignment: Assignment, server: str, kit: str) -> bytes:
    """Return the notebook for students with the addresses of ``server`` and ``kit`` and the list of
    importable packages.
    """
    text, listing = assignment.notebook(), packages.listing(assignment.packages)
    for mark, value in {"{{SERVER}}": server, "{{KIT_URL}}": kit, "{{PACKAGES}}": listing}.items():
        text = text.replace(mark, json.dumps(value)[1:-1])
    return text.encode()


def _distribution(slug: str) -> str:
    return f"polhode_kit_{slug.replace('-', '_')}"


def _home(assignment: Assignment) -> str:
    return f"polhode/assignments/{assignment.folder.name}"


@functools.cache
def _content(slug: str) -> dict[str, bytes]:
    kit, assignment = Path(polhode.__path__[0]), find(slug)
    found = {
        f"polhode/{path.relative_to(kit).as_posix()}": path.read_bytes() for path in sorted(kit.rglob("*.py"))
    }
    home = _home(assignment)
    found |= {f"{home}/data/{name}": (assignment.folder / name).read_bytes() for name in assignment.data}
    if assignment.questions or (assignment.folder / "public").is_dir():
        try:
            found |= {f"{home}/{name}": content for name, content in list(_public_side(assignment))}
        except Exception:  # its scenes or truth failed; students can still submit
            log.exception("the kit is built without the local checks of the assignment %s", slug)
    return found | {"polhode/assignments/__init__.py": b""}


def _public_side(assignment: Assignment) -> Iterator[tuple[str, bytes]]:
    for path in sorted((assignment.folder / "public").glob("*.py")):
        yield path.name, path.read_bytes()
    yield "plays.py", assignment.plays.encode()
    used = {name for e in assignment.exercises for name in e.scenes()}
    scenes = [s for s in assignment.scenes if s.name in used and not callable(s.inputs)]
    precursors = {
        after: _drawn_once(assignment.scene(after)) for s in scenes if (after := s.after) is not None
    }
    sent = list(dict.fromkeys([*precursors.values(), *scenes]))
    hidden = {e.number: sum(map(assignment.hidden, e.checks)) for e in assignment.exercises}
    declared = {"version": assignment.version, "hidden": hidden, "scenes": [_declared(s) for s in sent]}
    titles = {e.number: e.title for e in assignment.exercises}
    asked = assignment.questions.items()
    declared["exercises"] = [
        {"number": n, "title": titles[n], "questions": list(questions)} for n, questions in asked
    ]
    yield (
        "public.json",
        json.dumps(declared, default=lambda x: dict(x) if isinstance(x, Mapping) else x.tolist()).encode(),
    )
    yield "truth.npz", _packed({f"{s.name}/{key}": array for s in sent for key, array in _truth(s).items()})


def _declared(scene: Scene) -> dict[str, Any]:
    declared = {name: getattr(scene, name) for name in ("name", "play", "function", "budget_s", "after")}
    assert not callable(scene.inputs)
    declared["inputs"] = {name: value for name, value in scene.inputs.items() if name not in scene.withheld}
    declared["returns"] = {name: vars(spec) for name, spec in scene.returns.items()}
    declared |= {"known": list(scene.known), "needs": list(scene.needs)}
    return declared | ({} if scene.question is None else {"question": scene.question})


def _drawn_once(scene: Scene) -> Scene:
    """Return a scene that others come after, with one fixed draw of its inputs: its answers only serve the
    diagnosis.
    """
    return (
        replace(scene, inputs=scene.inputs(np.random.default_rng(0)), known=())
        if callable(scene.inputs)
        else scene
    )


def _truth(scene: Scene) -> Mapping[str, Any]:
    assert not callable(scene.inputs)
    return scene.truth(scene.inputs)


def _packed(arrays: Mapping[str, Any]) -> bytes:
    """Return arrays as an .npz whose bytes do not depend on the time."""
    files = {}
    for name, array in arrays.items():
        member = io.BytesIO()
        np.save(member, np.asarray(array), allow_pickle=False)
        files[f"{name}.npy"] = member.getvalue()
    return zipfiles.zipped(files)
