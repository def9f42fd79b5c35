"""What the author's code raises while it declares an exercise, as sentences with their lines."""

import inspect
import re
import traceback
from collections.abc import Callable
from types import FunctionType
from typing import Any

from exercises.authoring.ask import Ask
from exercises.authoring.asked_cell import AskedCell
from exercises.authoring.asked_solution import Asked, AskedSolution, DeclarationError


def raised(run: Callable[[], object], declare: FunctionType) -> list[str]:
    """Return what ``run`` raises, with the line of the file in which the author's function ``declare`` is,
    nothing if it raises nothing.
    """
    try:
        run()
    except DeclarationError as error:
        return [f"line {error.line}: {error}"]
    except Exception as error:
        code = declare.__code__
        frames = traceback.extract_tb(error.__traceback__)
        own = [frame.lineno for frame in frames if frame.filename == code.co_filename]
        line = own[-1] if own else code.co_firstlineno
        return [f"line {line}: {_in_words(error)}"]
    return []


def _in_words(error: Exception) -> str:
    """Return the sentence about an exception: what a question has, if the author used another name."""
    text = str(error)
    if isinstance(error, TypeError) and (found := NO_ARGUMENT.fullmatch(text)) and found[1] in ASKING:
        method, name = getattr(ASKING[found[1]], found[2]), found[3]
        has = [p for p in inspect.signature(method).parameters if p not in ("self", "family")]
        where = ELSEWHERE.get(name, f"it has {', '.join(has)}")
        return f"{found[2]} has no argument {name}: {where}"
    if isinstance(error, AttributeError) and type(error.obj) in ASKING.values():
        has = [name for name, value in vars(type(error.obj)).items() if inspect.isfunction(value)]
        has = [name for name in [*has, "mistake"] if not name.startswith("_") and name != "questions"]
        return f"a question of this kind has no {error.name}: it has {', '.join(dict.fromkeys(has))}"
    return f"{type(error).__name__}: {error}"


ASKING: dict[str, Any] = {"Ask": Ask, "Asked": Asked, "AskedSolution": AskedSolution, "AskedCell": AskedCell}
NO_ARGUMENT = re.compile(r"(\w+)\.(\w+)\(\) got an unexpected keyword argument '(\w+)'")
ELSEWHERE = {
    "partial": "it is an argument of @notebook.exercise",
    "points": "it is an argument of @notebook.exercise; share= is the question's part of them",
    "uses": "leave it out, earlier solutions are found by their names in the solution",
    "truth": "decorate the exact answer with @question.truth",
    "agree": "give it to the truth, or call question.agree(…)",
}
