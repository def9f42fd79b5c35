"""Errors of the questions in an author's declaration: all of them, each with its line in the file."""

import ast
import builtins
import inspect
import keyword
import re
from collections.abc import Iterator, Sequence
from types import FunctionType

from exercises.authoring.questions.declared import Family, Itself, Mistake
from exercises.authoring.questions.question import Question
from exercises.authoring.written_mistakes import WrittenMistake
from polhode.kinds.asking import KNOWN, is_source

CODE = re.compile(r"[a-z]+(-[a-z0-9]+)*")
RESERVED = {*dir(builtins), *keyword.kwlist, *keyword.softkwlist, "polhode", "np", "plt"}


def question_errors(question: Question) -> Iterator[str]:
    """Yield the errors of one question as sentences with their lines."""
    wrong = [error for errors in question.wrong.values() for error in errors]
    yield from (f"line {question.line}: {question.function}: {error}" for error in wrong)
    try:
        found = (
            list(_of_question(question))
            if (question.ask or question.values) and "solution" not in question.wrong
            else []
        )
    except Exception as error:  # if arguments of a wrong type are the cause, they are reported already
        found = [] if wrong else [f"{question.function}: {type(error).__name__}: {error}"]
    yield from (f"line {question.line}: {error}" for error in found)
    yield from (
        f"line {mistake.line}: {error}"
        for mistake in question.mistakes
        for error in _of_mistake(question, mistake)
    )


def uses_errors(question: Question, earlier: Sequence[Question]) -> Iterator[str]:
    """Yield the errors of the functions that a question uses, which must be solutions of ``earlier`` ones."""
    for used in question.uses:
        name, found = (
            getattr(used, "__name__", repr(used)),
            [other for other in earlier if other.solution is used],
        )
        if not found or used is question.solution:
            yield (
                f"line {question.line}: {question.function} uses {name}, which is not the solution of an"
                " earlier question"
            )
        elif isinstance(used, type) or found[0].variables:
            yield (
                f"line {question.line}: {question.function} uses {name}, a class or a cell; only a function"
                " can be replaced"
            )


def _of_question(question: Question) -> Iterator[str]:
    name = question.function
    if bad := [n for n in question.variables or [name] if not n.isidentifier() or n in RESERVED]:
        yield f"the solution is named {bad[0]}, which Python or the kit already uses: choose another name"
        return
    try:
        ast.parse(question.source)
    except (OSError, TypeError, SyntaxError) as error:
        yield f"the source of {name} cannot be read ({error}): define it with def or class in this file"
        return
    expected = list(inspect.signature(question.solution).parameters)
    if question.call is None and not question.variables and list(question.ask) != expected:
        yield f"{name} takes ({', '.join(expected)}), but ask names ({', '.join(question.ask)})"
    for argument, family in question.ask.items():
        if isinstance(family, Family) and not question.wrong:
            yield from (f"the function {argument}: {error}" for error in family_errors(family))
    yield from (
        f"the draw of {given} takes {', '.join(others)}: it is called with a random generator, and with row="
        " if it has that parameter"
        for given, draw in question.ask.items()
        if inspect.isfunction(draw) and (others := _unknown_parameters(draw))
    )
    if question.variables:
        nodes = ast.walk(ast.parse(question.source))
        assigned = {
            node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
        }
        yield from (
            f"the cell does not assign {variable}"
            for variable in question.variables
            if variable not in assigned
        )
    yield from () if "truth" in question.wrong else _of_truth(question)
    yield from question.errors()
    for label in (label for label, value in question.values.items() if value.partial):
        if question.values[label].points == 1 and "points" not in question.data:
            yield f"{name} ({label}): partial credit needs points of at least 2"
        if not question.drawn:
            yield f"{name} ({label}): partial credit needs drawn arguments: a single input is right or wrong"


def _unknown_parameters(draw: FunctionType) -> list[str]:
    """Return the parameters of a draw that it does not get: all but the first and ``row``."""
    needed = [p for p in inspect.signature(draw).parameters.values() if p.default is p.empty]
    return [p.name for p in needed[1:] if p.name != "row" and p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)]


def family_errors(family: Family) -> Iterator[str]:
    """Yield the errors of an expression; a source was made from functions without errors."""
    if is_source(family.text):
        return
    tree = ast.parse(family.text, mode="eval")
    unknown = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)} - {
        *family.over,
        *family.given,
        *KNOWN,
    }
    yield from (
        f"{family.text!r} uses {name}, which is neither a variable nor a parameter"
        for name in sorted(unknown)
    )


def _of_truth(question: Question) -> Iterator[str]:
    truth, compared = question.truth, question.data.get("compared")
    if compared is not None:
        missing = [name for name in compared if name not in question.known]
        yield from (f"{name} has no truth: give a number or a function that computes it" for name in missing)
    elif isinstance(truth, Itself) or (truth is None and question.known):
        return
    elif truth is None:
        yield f"{question.function} has no truth: give a closed form, a second method, or itself(reason)"
    elif truth is question.solution:
        yield f"the truth of {question.function} is its own solution: give a second method, or itself(reason)"
    else:
        known = {*question.ask, *question.drawn, *question.withheld}
        missing = [name for name in inspect.signature(truth).parameters if name not in known]
        yield from (
            f"the truth of {question.function} takes {name}, which is neither asked nor drawn"
            for name in missing
        )


def _of_mistake(question: Question, mistake: Mistake | WrittenMistake) -> Iterator[str]:
    try:
        right = question.source
    except (OSError, TypeError):
        return  # reported for the question
    if isinstance(mistake, WrittenMistake):
        yield from mistake.errors(right)
    else:
        yield from _of_replacement(question, mistake, right)
    if mistake.code is not None and not CODE.fullmatch(mistake.code):
        yield f"the diagnosis code {mistake.code!r} must be lower-case words joined by hyphens"
    if mistake.code is not None and not mistake.sentence.strip():
        yield f"the mistake {mistake.code} has no sentence for the student"


def _of_replacement(question: Question, mistake: Mistake, right: str) -> Iterator[str]:
    if mistake.old not in right:
        yield f"the mistake replaces {mistake.old!r}, which is not in {question.function}"
        return
    try:
        changed = ast.dump(ast.parse(mistake.source(right)))
    except SyntaxError as error:
        yield f"the mistake {mistake.new!r} is not valid Python ({error.msg})"
        return
    if changed == ast.dump(ast.parse(right)):
        yield f"the mistake {mistake.old!r} → {mistake.new!r} changes nothing"
