"""Sentences about changes of the author's solution, for students who wrote another one.

A sentence quotes only what the student's function contains. Otherwise it says what the numbers show, without
the terms and names of the solution.
"""

import ast
import re
from collections.abc import Collection, Iterable

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
    """The expressions and names of a student's ``function``, or of all sources if none defines it."""

    def __init__(self, sources: Iterable[str], function: str) -> None:
        trees = [tree for source in sources if (tree := _parsed(source)) is not None]
        own = [
            node
            for tree in trees
            for node in ast.walk(tree)
            if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name == function
        ]
        nodes = [node for root in (own[-1:] or trees) for node in ast.walk(root)]
        self._expressions = {ast.dump(node) for node in nodes if isinstance(node, ast.expr)}
        self._names = {node.id for node in nodes if isinstance(node, ast.Name)}
        self._names |= {node.arg for node in nodes if isinstance(node, ast.arg)}

    def has(self, fragment: str) -> bool:
        """Return whether the function contains an expression, or a fragment without any name."""
        tree = _parsed(fragment)
        if tree is None:
            return not re.search(r"[^\W\d_]", fragment)
        match tree.body:
            case [ast.Expr(value=ast.Name(id=name))]:
                return name in self._names
            case [ast.Expr(value=ast.Constant())]:
                return True
            case [ast.Expr(value=value)]:
                return ast.dump(value) in self._expressions
        return False

    def sentence(self, code: str, sentences: Collection[str]) -> str | None:
        """Return the sentence of causes of one code if the function contains all that it quotes.

        Otherwise return what the code means in general, None if it has no such meaning.
        """
        for sentence in sentences if len(sentences) == 1 else ():
            if all(map(self.has, QUOTED.findall(sentence))):
                return sentence
        return IN_GENERAL.get(code)


def _parsed(text: str) -> ast.Module | None:
    try:
        return ast.parse(text)
    except (SyntaxError, ValueError):
        return None
