"""Sentences about changes of the author's solution, for students who wrote another one.

A sentence quotes only what the student's function contains. Otherwise it says what the numbers show, without
the terms and names of the solution.
"""

import io
import re
import tokenize
from collections.abc import Collection, Iterable

from polhode.report.student_line import tokens_of

QUOTED = re.compile(r"`([^`]*)`")
IN_GENERAL = {
    "sign-flipped": "one term has the opposite sign",
    "missing-term": "a term or a factor is missing",
    "wrong-index": "another index, bound of a slice or axis is used",
    "missing-brackets": "brackets are missing",
    "constant-factor": "a constant factor is wrong",
    "missing-division": "a division is missing",
    "wrong-divisor": "a fraction is upside down, or divided by another quantity",
    "wrong-power": "a power or a root is wrong",
    "wrong-function": "a related function stands in place of the right one, or one is missing",
    "swapped-arguments": "two arguments of a call are exchanged",
    "missing-argument": "a call lacks an argument",
    "off-by-one": "a loop starts or ends one step too early or too late",
    "wrong-option": "an option of a call is set the wrong way",
    "wrong-operator": "another operator is used",
    "wrong-comparison": "a comparison is reversed, or has equality on the other side",
    "component-order": "the right values are returned in another order",
    "transposed": "a matrix stands in place of its transpose, or the reverse",
    "wrong-constant": "a constant is wrong",
    "wrong-variable": "another variable stands in place of the right one",
}
"""What each code of a changed solution says without quoting it."""


class StudentCode:
    """The tokens of a student's ``function`` in ``sources``, which may be hostile and are not parsed."""

    def __init__(self, sources: Iterable[str], function: str) -> None:
        self._tokens = tokens_of(sources, function)

    def has(self, fragment: str) -> bool:
        """Return whether the function contains a fragment of source, or the fragment has no name in it."""
        tokens = _tokens(fragment)
        if not any(token.isidentifier() for token in tokens):
            return True
        starts = range(len(self._tokens) - len(tokens) + 1)
        return any(self._tokens[k : k + len(tokens)] == tokens for k in starts)

    def sentence(self, code: str, sentences: Collection[str]) -> str | None:
        """Return the sentence of causes of one code if the function contains all that it quotes.

        Otherwise return what the code means in general, None if it has no such meaning.
        """
        for sentence in sentences if len(sentences) == 1 else ():
            if all(map(self.has, QUOTED.findall(sentence))):
                return sentence
        called = {quoted[-1] for quoted in map(QUOTED.findall, sentences) if quoted}
        if code == "swapped-arguments" and len(called) == 1 and self.has(*called):
            return f"two arguments of `{called.pop()}` are exchanged"
        return IN_GENERAL.get(code)


def _tokens(fragment: str) -> list[str]:
    try:
        found = list(tokenize.generate_tokens(io.StringIO(fragment).readline))
    except (tokenize.TokenError, SyntaxError):
        return fragment.split()
    return [token.string for token in found if token.string.strip()]
