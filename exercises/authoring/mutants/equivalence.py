"""Algebraic equivalence of two sources: arithmetic with random numbers in place of the names.

Each name and each expression that is not arithmetic becomes a random 2×2 matrix, equal for equal
expressions. So ``a * b`` and ``b * a`` have one value, but ``A @ B`` and ``B @ A`` have two.
"""

import ast
import hashlib
import operator
from collections import Counter
from typing import Any

import numpy as np

OPERATORS = (
    ("Add", "add"),
    ("Sub", "sub"),
    ("Mult", "mul"),
    ("Div", "truediv"),
    ("Pow", "pow"),
    ("MatMult", "matmul"),
)
ARITHMETIC = {getattr(ast, node): getattr(operator, name) for node, name in OPERATORS}
FUNCTIONS = {name: getattr(np, name) for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "abs")}


def fingerprint(source: str) -> str:
    """Return a text that is equal for two sources that differ only by rules of arithmetic. Raises
    SyntaxError.
    """
    with np.errstate(all="ignore"):
        return ast.dump(_Values().visit(ast.parse(source)))


class _Values(ast.NodeTransformer):
    """Puts its value in place of each expression."""

    def __init__(self) -> None:
        self.calls: Counter[str] = Counter()

    def visit(self, node: ast.AST) -> Any:
        stored = isinstance(getattr(node, "ctx", None), ast.Store | ast.Del)
        return (
            ast.Constant(_text(self.of(node)))
            if isinstance(node, ast.expr) and not stored
            else self.generic_visit(node)
        )

    def of(self, node: Any) -> Any:  # noqa: PLR0911
        """Return the value of an expression, complex (2, 2)."""
        match node:
            case ast.Constant(value=int() | float() | complex() as value) if not isinstance(value, bool):
                return np.full((2, 2), complex(value))
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.of(operand)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in ARITHMETIC:
                return ARITHMETIC[type(op)](self.of(left), self.of(right))
            case ast.Call(
                func=ast.Name(id=name) | ast.Attribute(attr=name), args=[argument], keywords=[]
            ) if name in FUNCTIONS:
                return FUNCTIONS[name](self.of(argument)) + 0j
            case ast.Attribute(value=value, attr="T"):
                return self.of(value).T
            case ast.Compare(
                left=left, ops=[ast.Lt() | ast.LtE() | ast.Gt() | ast.GtE() as op], comparators=[right]
            ):
                less = (self.of(right) - self.of(left)) * (1 if isinstance(op, ast.Lt | ast.LtE) else -1)
                return _random(isinstance(op, ast.LtE | ast.GtE), _text(less / np.abs(less).max()))
        text = ast.dump(self.generic_visit(node))
        # two equal calls may return two values, as of a random generator
        self.calls[text] += isinstance(node, ast.Call)
        return _random(text, self.calls[text])


def _text(value: Any) -> str:
    """Return a text that is equal for equal values, to nine digits."""
    return " ".join(f"{x:.9e}" for x in value.ravel())


def _random(*parts: Any) -> Any:
    """Return a random complex matrix (2, 2), equal for equal ``parts``."""
    digest = np.frombuffer(hashlib.blake2b(repr(parts).encode()).digest(), dtype="u8") / 2**64
    return (0.5 + digest).view(complex).reshape(2, 2)
