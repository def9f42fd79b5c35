"""What stands between a roster and its import: errors of the file, and questions to whoever imports it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from hashlib import sha256

MOST_SHOWN = 20


class BadRoster(ValueError):
    """The file is not a roster; the message says why and what to do."""


@dataclass(frozen=True)
class Question:
    """What must be confirmed before an import: a sentence, and the lines or people that it is about."""

    sentence: str
    details: Sequence[str] = ()

    @property
    def key(self) -> str:
        """What a form sends to confirm the question: it changes with every word of it."""
        return sha256("\n".join((self.sentence, *self.details)).encode()).hexdigest()[:16]


def shortened(items: Sequence[str]) -> list[str]:
    """Return the first items, and how many more there are."""
    more = [f"and {len(items) - MOST_SHOWN} more"] if len(items) > MOST_SHOWN else []
    return [*items[:MOST_SHOWN], *more]


def count(number: int, one: str, many: str) -> str:
    """Return the number with its noun and verb: "1 line is", "3 lines are"."""
    return f"{number} {one if number == 1 else many}"


def lines(numbers: Iterable[int]) -> str:
    """Return "line 3" or "lines 3, 4 and 9"."""
    texts = [str(number) for number in numbers]
    if len(texts) == 1:
        return f"line {texts[0]}"
    return f"lines {', '.join(texts[:-1])} and {texts[-1]}"
