"""Errors of the questions in an author's declaration: all of them, each with its line in the file."""

import ast
import builtins
import inspect
import keyword
from collections.abc import Iterator
from types import FunctionType

from exercises.authoring.portable_source import WrittenMistake
from exercises.authoring.questions.author_arguments import Family, Mistake
from exercises.authoring.questions.question import Question
from polhode.kinds.student_calls import KNOWN, is_source

RESERVED = {*dir(builtins), *keyword.kwlist, *keyword.softkwlist, "polhode", "np", "plt"}


def question_errors(question: Question) -> Iterator[str]:
    """Yield the errors of one question as sentences with their lines."""
    wrong = [error for errors in question.wrong.values() for error in errors]
    yield from (f"line {question.line}: {question.function}: {error}" for error in wrong)
    try:
        found = list(_of_question(question)) if question.inputs or question.values else []
    except Exception as error:  # if arguments of a wrong type are the cause, they are reported already
        found = [] if wrong else [f"{question.function}: {type(error).__name__}: {error}"]
    yield from (f"line {question.line}: {error}" for error in found)
    yield from (
        f"line {mistake.line}: {error}"
        for mistake in question.mistakes
        for error in _of_mistake(question, mistake)
    )


def _of_question(question: Question) -> Iterator[str]:
    name = question.function
    if bad := [n for n in question.names if n in RESERVED]:
        yield f"the solution is named {bad[0]}, which Python or the kit already uses: choose another name"
        return
    expected = list(inspect.signature(question.solution).parameters)
    if question.call is None and not question.variables and list(question.inputs) != expected:
        yield f"{name} takes ({', '.join(expected)}), but its inputs are ({', '.join(question.inputs)})"
    for argument, family in question.inputs.items():
        if isinstance(family, Family) and not question.wrong:
            yield from (f"the function {argument}: {error}" for error in family_errors(family))
    yield from (
        f"the draw of {given} takes {', '.join(others)}: it is called with a random generator only"
        for given, draw in question.inputs.items()
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
    if question.partial and not question.drawn:
        yield f"{name}: partial credit needs drawn arguments: a single input is right or wrong"


def _unknown_parameters(draw: FunctionType) -> list[str]:
    """Return the parameters of a draw that it does not get: all but the first."""
    needed = [p for p in inspect.signature(draw).parameters.values() if p.default is p.empty]
    return [p.name for p in needed[1:] if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)]


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
    truth, compared = question.truth, question.data.get("compared", ())
    missing = [name for name in compared if name not in question.known]
    yield from (f"{name} has no truth: give a number or a function that computes it" for name in missing)
    if truth is None and not question.known and not question.variables:
        yield (
            f"{question.function} has no truth: give a closed form, a second method, or call"
            " is_its_own_truth(because=…)"
        )
    elif callable(truth):
        known = {*question.inputs, *question.drawn, *question.withheld}
        missing = [name for name in inspect.signature(truth).parameters if name not in known]
        yield from (
            f"the truth of {question.function} takes {name}, which is neither asked nor drawn"
            for name in missing
        )


def _of_mistake(question: Question, mistake: Mistake | WrittenMistake) -> Iterator[str]:
    if isinstance(mistake, WrittenMistake):
        yield from mistake.errors(question.source)
    else:
        yield from _of_replacement(mistake, question.source)
    if mistake.code is not None and not mistake.sentence.strip():
        yield f"the mistake {mistake.code} has no sentence for the student"


def _of_replacement(mistake: Mistake, right: str) -> Iterator[str]:
    try:
        changed = ast.dump(ast.parse(mistake.source(right)))
    except SyntaxError as error:
        yield f"the mistake {mistake.new!r} is not valid Python ({error.msg})"
        return
    if changed == ast.dump(ast.parse(right)):
        yield f"the mistake {mistake.old!r} → {mistake.new!r} changes nothing"
