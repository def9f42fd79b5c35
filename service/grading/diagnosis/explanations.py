"""What a scene's numbers show: which causes predict them, for the whole answer and for each component alone.

A cause is a declared mistake, a reading of the numbers themselves (zeros, degrees, too few digits …), or a
change of the right solution at one place. Two slips in two components are two causes.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from exercises.authoring.mutants.solution import Variant
from polhode.judging.checks import Arrays
from polhode.judging.outcome import Diagnosis
from polhode.judging.verdict import Verdict
from polhode.kinds import reproduces
from polhode.kinds.values import agreement, finite_alike, own_scale, to_rounding
from service.grading.diagnosis.number_patterns import (
    constant_factor,
    extra_term,
    factor_in_words,
    numbers_at,
    order_of,
    too_few_digits,
)
from service.grading.diagnosis.quoting import StudentCode

MOST_COMPONENTS = 6  # of a returned array that are explained one by one


class Rank(IntEnum):
    """Which causes come first if several predict the numbers."""

    DECLARED = 0
    READ = 1
    CHANGED = 2
    MULTIPLE = 3
    MAGNITUDE = 4
    DECLARED_MULTIPLE = 5
    CHANGED_TWICE = 6


CHANGES = (Rank.CHANGED, Rank.CHANGED_TWICE)
READINGS = (Rank.READ, Rank.MULTIPLE, Rank.MAGNITUDE)
BY_AUTHOR = (Rank.DECLARED, Rank.DECLARED_MULTIPLE)
VAGUE = (Rank.CHANGED, Rank.DECLARED_MULTIPLE, Rank.CHANGED_TWICE)


@dataclass(frozen=True)
class Cause:
    """A possible cause: codes and sentences of its diagnoses, two for a solution that is changed twice, and
    for a version of the solution its ``variant``.
    """

    rank: Rank
    codes: tuple[str, ...]
    sentences: tuple[str, ...]
    variant: Variant | None = None


@dataclass(frozen=True)
class Component:
    """A part of an answer: a value by ``name``, or one of ``of_several`` numbers of it, ``at``. ``label``
    names it for students, "" if it is the whole answer.
    """

    name: str
    at: int | None
    label: str
    of_several: int = 1

    def of(self, array: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return this component of all rows."""
        return array if self.at is None else array[:, self.at]


WHOLE = Component("", None, "")
"""Stands for all values together."""


def wrong_components(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> list[Component]:
    """Return the components of an answer that are not exact, none if it is not compared with exact values of
    the same shapes.
    """
    if not _has_exact_values(question, seen, truth):
        return []
    values = {value["name"]: value for value in question["returns"]}
    return [c for c in components(question, seen) if not _agree(values[c.name], c, seen, truth, truth)]


def _has_exact_values(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> bool:
    names = [value["name"] for value in question["returns"]]
    return all(name in seen and name in truth and seen[name].shape == truth[name].shape for name in names)


def causes(
    question: Mapping[str, Any],
    seen: Arrays,
    truth: Arrays,
    predicted: Mapping[Variant, Arrays],
    wrong: Sequence[Component],
) -> dict[Component, set[Cause]]:
    """Return the causes that predict all values together, under WHOLE, and those of each ``wrong`` component.

    ``predicted`` are the arrays of wrong versions of the right solution. A version that also calls its
    functions as often as the submission comes before one that does not.
    """
    exact = {v for v, arrays in predicted.items() if reproduces(question, seen, arrays, truth)}
    if wrong and not exact:
        exact = {
            v for v, arrays in predicted.items() if reproduces(question, seen, _without_calls(arrays), truth)
        }
    is_right = not wrong and _has_exact_values(question, seen, truth)  # only its calls are too many
    found = {WHOLE: {_of(variant) for variant in exact if variant.declared or not is_right}}
    values = {value["name"]: value for value in question["returns"]}
    for component in wrong:
        value = values[component.name]
        same = [
            variant
            for variant, arrays in predicted.items()
            if component.name in arrays
            and _agree(to_rounding(value), component, seen, arrays, truth)
            and not _agree(value, component, arrays, truth, truth)
        ]
        local = [v for v in same if v.declared and _is_local(question, component, predicted[v], truth)]
        # a component that is zero is so in many a version that changes the others
        is_zero = _is_zero(value, component, seen, truth)
        alike = {_of(v) for v in local or ([] if is_zero else same)}
        found[component] = alike or set(_multiples(value, component, seen, truth, predicted))
        if not question.get("call"):  # an author's expression is no value that the student knows
            found[component] |= set(_readings(question, component, seen, truth))
    if wrong and len(values) == 1 and not question.get("call"):
        (name,) = values
        whole = Component(name, None, "")
        found[WHOLE] |= set(_readings(question, whole, seen, truth))
        found[WHOLE] = found[WHOLE] or set(_multiples(values[name], whole, seen, truth, predicted))
    if wrong and not question.get("call"):
        found[WHOLE] |= set(_orders(question, seen, truth))
    return found


def _is_local(question: Mapping[str, Any], component: Component, arrays: Arrays, truth: Arrays) -> bool:
    """Return whether a wrong version is right in all other components: it is the simpler explanation."""
    values = {value["name"]: value for value in question["returns"]}
    others = (one for one in components(question, truth) if one != component)
    return all(
        other.name in arrays and _agree(values[other.name], other, arrays, truth, truth) for other in others
    )


def _multiples(
    value: Mapping[str, Any],
    component: Component,
    seen: Arrays,
    truth: Arrays,
    predicted: Mapping[Variant, Arrays],
) -> Iterator[Cause]:
    """Yield the declared mistakes that predict the numbers of a component up to a constant factor."""
    got = component.of(seen[component.name])
    for variant, arrays in predicted.items():
        if not (variant.declared and variant.code and component.name in arrays):
            continue
        want = component.of(arrays[component.name])
        if want.shape != got.shape:
            continue
        scale = own_scale(value, arrays[component.name], truth)
        unit = np.ones_like(want) if scale is None else component.of(scale)
        one, other = finite_alike(got, want)
        if factor := constant_factor(one / unit, other / unit, precisely=scale is not None):
            code, sentence = factor_in_words(factor, "the result", whole=not component.label)
            yield Cause(Rank.DECLARED_MULTIPLE, (variant.code, code), (variant.sentence, sentence), variant)


def diagnoses(
    left: Mapping[Component, Collection[Cause]], student: StudentCode, right: int = 0
) -> list[Diagnosis]:
    """Return the diagnoses of all values together, else those of their components, in words that fit the
    student's code. Components with the same cause are named together.

    ``right`` is the number of components that are right. A change in general words names the others, and
    gives way to what the numbers of each of them show.
    A declared mistake of each wrong component comes before a change of the solution that explains them
    together.
    """
    wrong = [part for part in left if part != WHOLE]
    whole = _common(left.get(WHOLE, ()), student)
    is_vague = any(one.rank in VAGUE for one in whole)
    if whole and not (
        is_vague and wrong and all(_is_known(left[part]) and _common(left[part], student) for part in wrong)
    ):
        if not all(one.is_general for one in whole):
            (at,) = (part.at for part in wrong) if len(wrong) == 1 else (None,)
            return [Diagnosis(one.code, one.sentence, 1.0, component=at) for one in whole]
        if read := _read(left, wrong, student):
            return read
        return [_diagnosis(one, wrong if right else [WHOLE]) for one in whole]
    found: dict[Found, list[Component]] = {}
    for part in wrong:
        several = _common(_of_most(left, part, wrong), student)
        if any(one.is_general for one in several):
            several = _common(_readings_among(left[part]), student) or several
        for one in several:
            found.setdefault(one, []).append(part)
    return [_diagnosis(one, parts, is_all=parts == wrong) for one, parts in found.items()]


def _of_most(
    left: Mapping[Component, Collection[Cause]], part: Component, wrong: Sequence[Component]
) -> list[Cause]:
    """Return the causes of a component, of declared mistakes only those that explain most other components
    too: one order of all components comes before another that explains this one alone.
    """
    shared = {cause: sum(cause in left[other] for other in wrong) for cause in left[part]}
    most = max((n for cause, n in shared.items() if cause.rank is Rank.DECLARED), default=0)
    return [cause for cause, n in shared.items() if cause.rank is not Rank.DECLARED or n == most]


def _is_known(found: Collection[Cause]) -> bool:
    return min((cause.rank for cause in found), default=None) in (Rank.DECLARED, Rank.READ)


def _read(
    left: Mapping[Component, Collection[Cause]], wrong: Sequence[Component], student: StudentCode
) -> list[Diagnosis]:
    """Return what the numbers of each wrong component show, nothing if those of one show nothing."""
    found = {part: _common(_readings_among(left[part]), student) for part in wrong}
    if not wrong or not all(found.values()):
        return []
    return [_diagnosis(one, [part]) for part, several in found.items() for one in several]


def _readings_among(found: Collection[Cause]) -> list[Cause]:
    return [cause for cause in found if cause.rank in READINGS]


def _diagnosis(found: "Found", parts: Sequence[Component], *, is_all: bool = True) -> Diagnosis:
    """Return the diagnosis of these components, of all wrong ones if ``is_all``."""
    labels = [part.label for part in parts]
    if len(parts) == parts[0].of_several > 1 and " of " in labels[0] and len({p.name for p in parts}) == 1:
        labels = [f"the value {parts[0].name}"]
    named = found.rank in CHANGES or (found.rank in BY_AUTHOR and not is_all)
    is_quoted = len(labels) == 1 and labels[0] in found.sentence
    text = f"{_joined(labels)}: {found.sentence}" if named and labels[0] and not is_quoted else found.sentence
    is_one_of_one_value = len(parts) == 1 and " of " not in parts[0].label
    return Diagnosis(found.code, text, 1.0, component=parts[0].at if is_one_of_one_value else None)


@dataclass(frozen=True)
class Found:
    """A diagnosis in words for the student, with ``is_general`` those of its code in general."""

    code: str
    sentence: str
    rank: Rank
    is_general: bool


def _common(found: Collection[Cause], student: StudentCode) -> list[Found]:
    """Return what the first causes of a component have in common, nothing if they disagree.

    Two changes count only if the student's function contains what both quote: in another form they may be
    one slip.
    """
    first = [cause for cause in found if cause.rank is min(other.rank for other in found)]
    if len({cause.codes for cause in first}) != 1:
        return []
    rank = first[0].rank
    made = list[Found]()
    for k, code in enumerate(first[0].codes):
        sentences = {cause.sentences[k] for cause in first}
        sentence = student.sentence(code, sentences) if rank in CHANGES else _single(sentences)
        is_general = rank in CHANGES and sentence not in sentences
        if not code or sentence is None or (is_general and rank is Rank.CHANGED_TWICE):
            return []
        made.append(Found(code, sentence, rank, is_general))
    return made


def _single(sentences: Collection[str]) -> str | None:
    return next(iter(sentences)) if len(sentences) == 1 else None


def _joined(labels: Sequence[str]) -> str:
    """Return "component 1 of v and component 2 of v" in short: "components 1 and 2 of v"."""
    first, *others = labels
    if not others:
        return first
    numbers = [label.removeprefix("component ").split(" ")[0] for label in labels]
    behind = {
        label.removeprefix("component ").removeprefix(number)
        for label, number in zip(labels, numbers, strict=True)
    }
    if len(behind) == 1 and all(label.startswith("component ") for label in labels):
        return f"components {', '.join(numbers[:-1])} and {numbers[-1]}{behind.pop()}"
    return f"{', '.join(labels[:-1])} and {labels[-1]}"


def components(question: Mapping[str, Any], seen: Arrays) -> list[Component]:
    """Return the parts of an answer that are explained one by one: each value, each number of a short array.

    What leaves something open, such as signs of columns, is one part.
    """
    found, several = [], len(question["returns"]) > 1
    for value in question["returns"]:
        name, shape = value["name"], np.shape(seen[value["name"]])[1:]
        whole = f"the value {name}" if several else ""
        if (
            value.get("up_to")
            or len(shape) != 1
            or not 1 < shape[0] <= MOST_COMPONENTS
            or value.get("complex")
        ):
            found.append(Component(name, None, whole))
        else:
            of = f" of {name}" if several else ""
            own = value.get("components") or [f"component {k + 1}{of}" for k in range(shape[0])]
            found += [Component(name, k, label, of_several=shape[0]) for k, label in enumerate(own)]
    return found


def _of(variant: Variant) -> Cause:
    rank = Rank.DECLARED if variant.declared else Rank.CHANGED_TWICE if variant.both else Rank.CHANGED
    changes = variant.both or (variant,)
    return Cause(rank, tuple(c.code for c in changes), tuple(c.sentence for c in changes), variant)


def _without_calls(arrays: Arrays) -> Arrays:
    return {name: array for name, array in arrays.items() if name != "calls"}


def _agree(value: Mapping[str, Any], component: Component, got: Arrays, want: Arrays, truth: Arrays) -> bool:
    one, other = component.of(got[component.name]), component.of(want[component.name])
    if one.shape != other.shape:
        return False
    scale = own_scale(value, want[component.name], truth)
    unit = (np.abs(want[component.name]).max() or 1.0) if scale is None else component.of(scale)
    return agreement(value, *finite_alike(one, other), unit).verdict is Verdict.PASS


def _is_zero(value: Mapping[str, Any], component: Component, seen: Arrays, truth: Arrays) -> bool:
    """Return whether a component is zero for every input, to rounding if its value has a scale of its own."""
    got, scale = component.of(seen[component.name]), own_scale(value, truth[component.name], truth)
    if scale is None or not np.any(got):
        return not np.any(got)
    return agreement(value, got, np.zeros_like(got), component.of(scale)).verdict is Verdict.PASS


def _readings(
    question: Mapping[str, Any], component: Component, seen: Arrays, truth: Arrays
) -> Iterator[Cause]:
    """Yield what the numbers of a component are, other than the exact ones."""
    got, want = component.of(seen[component.name]), component.of(truth[component.name])
    is_whole = not component.label
    what = question["function"] if is_whole else f"{component.label} of {question['function']}"

    def cause(code: str, sentence: str, rank: Rank = Rank.READ) -> Cause:
        return Cause(rank, (code,), (sentence,))

    value = {**next(v for v in question["returns"] if v["name"] == component.name), "up_to": None}
    own = own_scale(value, truth[component.name], truth)
    unit = np.ones_like(want) if own is None else component.of(own)
    scale = (np.abs(truth[component.name]).max() or 1.0) if own is None else unit

    def is_(numbers: Any) -> bool:
        if np.shape(numbers) != got.shape:
            return False
        numbers = np.asarray(numbers, float)
        within = scale if own is None else np.maximum(scale, np.abs(numbers))
        return agreement(value, got, numbers, within).verdict is Verdict.PASS

    if _is_zero(value, component, seen, truth):
        yield cause("returns-zero" if is_whole else "missing-component", f"{what} is zero for every input")
        return
    if is_(-want):
        rank = Rank.MULTIPLE if is_whole else Rank.READ
        yield cause(*factor_in_words(-1.0, what, whole=is_whole), rank)
    elif factor := constant_factor(got / unit, want / unit, precisely=own is not None):
        yield cause(*factor_in_words(factor, what, whole=is_whole), Rank.MULTIPLE)
    if np.any(want < 0) and is_(np.abs(want)):
        yield cause("absolute-value", f"{what} is the absolute value of the right one", Rank.MAGNITUDE)
    for name in (name for name in truth if name.startswith("term ") and not is_whole):
        codes = extra_term(got, want, component.of(truth[name]), unit)
        sentences = [
            f"{what} has an extra term {name.removeprefix('term ')}",
            f"{what} has the opposite sign",
        ]
        if codes:
            yield Cause(Rank.READ, codes, tuple(sentences[: len(codes)]))
    if is_(np.degrees(want)):
        yield cause("units", f"{what} is in degrees: the exercise asks for radians")
    if is_(np.radians(want)):
        yield cause("units", f"{what} is converted from degrees to radians, which it was already")
    for name in question["drawn"]:
        given = numbers_at(seen.get(f"at_{name}"), component.at)
        if given is not None and is_(given):
            yield cause("returns-input", f"{what} is the argument {name} itself")
    if too_few := too_few_digits(got, want):
        yield cause("precision-loss", f"{what} {too_few}")


def _orders(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> Iterator[Cause]:
    """Yield that the right values, or the right components of a single one, are returned in another order."""
    returned = question["returns"]
    if any(value.get("up_to") for value in returned):
        return
    name, several = returned[0]["name"], len(returned) > 1
    if several:
        got, want = ([arrays[value["name"]] for value in returned] for arrays in (seen, truth))
    elif seen[name].ndim == 2:
        got, want = (list(np.moveaxis(arrays[name], 1, 0)) for arrays in (seen, truth))
    else:
        return
    order = order_of(got, want)
    if order and several:
        asked, found = (", ".join(returned[k]["name"] for k in ks) for ks in (range(len(order)), order))
        where = f"as {found}: the exercise asks for {asked}"
    elif order:
        where = f"in the order {', '.join(str(k + 1) for k in order)}"
    else:
        return
    what = "values" if several else "components"
    sentence = f"{question['function']} returns the right {what} {where}"
    yield Cause(Rank.READ, ("component-order",), (sentence,))
