"""The reference of what a course author writes with, from the docstrings of its public names."""

import inspect
from collections.abc import Callable, Iterator
from typing import Any

import exercises.authoring
from exercises.authoring.asked_cell import AskedCell
from exercises.authoring.asked_motions import AskedDynamics, AskedMotion, Motions
from exercises.authoring.asked_solution import Asked
from exercises.authoring.draws import Drawing

ABOUT = (
    "What `assignment.py` imports from `exercises.authoring`, and the methods of what it gets."
    " [For course authors](../authors.md) explains them with examples."
)
IMPORTED = [name for name in exercises.authoring.__all__ if name != "Ask"]  # which an exercise is called with
INTERNAL = {"questions", "errors", "assignment", "portable"}
"""Methods that polhode calls."""
OBJECTS: dict[str, tuple[str, type]] = {
    "notebook": ("an assignment", exercises.authoring.Notebook),
    "draw": ("in a function that `@notebook.draw` decorates", Drawing),
    "ask": ("in an exercise", exercises.authoring.Ask),
    "question": ("what most methods of `ask` return", Asked),
    "cell": ("what `ask.cell` returns", AskedCell),
    "dynamics": ("what `ask.dynamics` returns: a question, and more", AskedDynamics),
    "motions": ("what `ask.dynamics` and `ask.again` return", Motions),
    "motion": ("what `motions.drives` and `motions.of` return", AskedMotion),
}


def lines(text: Callable[[str], str]) -> Iterator[str]:
    """Yield the lines of the page below its title; ``text`` makes Markdown of a docstring."""
    yield from [ABOUT, "", "## What `assignment.py` imports", ""]
    for name in IMPORTED:
        yield from _documented(name, getattr(exercises.authoring, name), text)
    for name, (about, owner) in OBJECTS.items():
        yield from [f"## `{name}`, {about}", ""]
        for method, function in methods(owner).items():
            yield from _documented(f"{name}.{method}", function, text)


def methods(owner: type) -> dict[str, Any]:
    """Return the public methods of an object; one that is a question has those of its own only."""
    left_out = set() if owner is Asked else {*Asked.__mro__, Motions} - {owner}
    bases = [base for base in owner.__mro__ if base not in left_out]
    return {
        name: value
        for base in reversed(bases)
        for name, value in vars(base).items()
        if inspect.isfunction(value) and name[0] != "_" and name not in INTERNAL
    }


def _documented(name: str, value: Any, text: Callable[[str], str]) -> Iterator[str]:
    called = f"{name}{_call(value)}" if inspect.isfunction(value) or inspect.isclass(value) else name
    yield from [f"### {name}", "", "```python", called, "```", "", text(inspect.getdoc(value) or ""), ""]


def _call(value: Any) -> str:
    """Return the parameters of a function, without the types of its arguments."""
    found = inspect.signature(value)
    taken = [one.replace(annotation=one.empty) for one in found.parameters.values() if one.name != "self"]
    return str(found.replace(parameters=taken, return_annotation=found.empty))
