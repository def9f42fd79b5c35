"""The points of an exercise, divided among its checks."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

from exercises.authoring.publishing.publish import Section
from exercises.authoring.questions.question import Question
from polhode.kinds import exercise as expand_exercise


def allotted(points: int, checks: Sequence[Sequence[str]], shares: Sequence[float]) -> dict[str, int]:
    """Return the points of each check by its id, ``points`` in all.

    ``checks`` are those of each question and ``shares`` the questions' shares. Checks of one question are
    worth the same up to rounding; what is left goes to its last ones, which have new inputs.
    """
    found = dict[str, int]()
    for ids, of_question in zip(checks, _parts(points, shares), strict=True):
        each, left = divmod(of_question, len(ids))
        found |= {id: each + (k >= len(ids) - left) for k, id in enumerate(ids)}
    return found


def _parts(points: int, shares: Sequence[float]) -> list[int]:
    """Return whole numbers in the ratio of ``shares``; what is left goes to the largest remainders, of equal
    ones to the last.
    """
    exact = [points * share / sum(shares) for share in shares]
    found = [int(value + 1e-9) for value in exact]
    by_remainder = sorted(range(len(found)), key=lambda k: (round(found[k] - exact[k], 9), -k))
    for k in by_remainder[: points - sum(found)]:
        found[k] += 1
    return found


def with_points(section: Section, points: int, shares: list[float]) -> Section:
    """Return an exercise whose checks are worth ``points`` together."""
    checks = [_last_new(question.id, _check_ids(section, question)) for question in section.questions]
    given = allotted(points, checks, shares)
    return section._replace(
        questions=tuple(
            replace(question, data={**question.data, "points": {id: given[id] for id in ids}})
            for question, ids in zip(section.questions, checks, strict=True)
        )
    )


def _check_ids(section: Section, question: Question) -> list[str]:
    found = expand_exercise(section.number, "", [question.document], True).checks
    return [check.id for check in found]


def _last_new(question: str, checks: list[str]) -> list[str]:
    """Return the ids of a question's checks, those first that are made again with new inputs."""
    return sorted(checks, key=lambda id: not _is_repeated(question, id, checks))


def _is_repeated(question: str, check: str, checks: Collection[str]) -> bool:
    """Return whether a question's check is made again with new inputs, under the id that the kit gives it."""
    return f"{question}-new{check.removeprefix(question)}" in checks


def without_points(section: Section, points: int) -> Iterator[str]:
    """Yield an error for each question with too few points for what it checks."""
    for question in section.questions:
        given = question.data["points"]
        checked = [id for id in given if not _is_repeated(question.id, id, given)]
        if not all(given[id] for id in checked):
            yield (
                f"points={points} leaves {sum(given.values())} for {question.function}, of which"
                f" {len(checked)} things are checked: a wrong one would cost nothing; give more points, or"
                " this question a larger share="
            )
