"""What students get of an assignment from the server: its checks with the exact arrays of its public scenes,
its data files, and the course's own packages.
"""

import functools
import io
import json
import logging
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from exercises.authoring.assignments import course_packages
from exercises.authoring.assignments.assignment import Assignment, Scene
from exercises.authoring.assignments.catalogue import find
from exercises.authoring.importing.validation_words import COURSE_FOLDER
from exercises.authoring.publishing import zipfiles
from polhode.client.cache import MADE
from polhode.client.kit_hash import digest

log = logging.getLogger(__name__)


@functools.cache
def build(slug: str) -> str:
    """Return a hash of what students get of an assignment."""
    return digest(_content(slug))


@functools.cache
def archive(slug: str) -> bytes:
    """Return it as a zip for the kit's cache, byte for byte the same for the same content."""
    return zipfiles.zipped({**_content(slug), MADE: json.dumps({"build": build(slug)}).encode()})


@functools.cache
def _content(slug: str) -> dict[str, bytes]:
    assignment = find(slug)
    found = {f"data/{name}": (assignment.folder / name).read_bytes() for name in assignment.data}
    found |= {f"{COURSE_FOLDER}/{name}": content for name, content in course_packages.files().items()}
    if assignment.questions:
        try:
            found |= dict(_public_side(assignment))
        except Exception:  # its scenes or truth failed; students can still submit
            log.exception("students get no local checks of the assignment %s", slug)
    return found


def _public_side(assignment: Assignment) -> Iterator[tuple[str, bytes]]:
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
