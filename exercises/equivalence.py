"""Algebraic equivalence of two sources: value numbering with random numbers in place of the names.

Each name and each expression that is not arithmetic becomes a random 2×2 matrix, equal for equal
expressions. So ``a * b`` and ``b * a`` have one value, but ``A @ B`` and ``B @ A`` have two, and a
value may pass through local variables.
"""

import ast
import hashlib
import operator
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

ARITHMETIC: dict[type, Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.MatMult: operator.matmul,
}
FUNCTIONS = {name: getattr(np, name) for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "abs")}


def fingerprint(tree: ast.Module) -> str:
    """Return a text that is equal for two modules that differ only by rules of arithmetic."""
    values = Values()
    with np.errstate(all="ignore"):
        return values.text([values.block(tree.body), *values.variables()])


class Values:
    """The values of the names at one place of the source."""

    def __init__(self) -> None:
        self.names: dict[str, Any] = {}
        self.calls: Counter[str] = Counter()

    def variables(self) -> list[Any]:
        """Return the names and values of all variables, sorted by name."""
        return [part for item in sorted(self.names.items()) for part in item]

    def text(self, parts: Iterable[Any]) -> str:
        """Return a text that is equal for equal ``parts``, numbers to nine digits."""
        return " ".join("".join(f"{x:.9e}" for x in (p.ravel() + 0j)) if isinstance(p, np.ndarray) else repr(p) for p in parts)

    def opaque(self, *parts: Any) -> Any:
        """Return a random matrix (2, 2), equal for equal ``parts``."""
        digest = hashlib.blake2b(self.text(parts).encode()).digest()
        return (0.5 + np.frombuffer(digest[:32], dtype="u8") / 2**64).astype(complex).reshape(2, 2)

    def of(self, node: Any) -> Any:  # noqa: PLR0911
        """Return the value of an expression, complex (2, 2), or of a field of the syntax tree."""
        match node:
            case ast.Constant(value=int() | float() | complex() as value) if not isinstance(value, bool):
                return np.full((2, 2), complex(value))
            case ast.Name(id=name):
                return self.names[name] if name in self.names else self.opaque("name", name)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.of(operand)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in ARITHMETIC:
                return ARITHMETIC[type(op)](self.of(left), self.of(right))
            case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name), args=[argument], keywords=[]) if name in FUNCTIONS:
                return np.asarray(FUNCTIONS[name](self.of(argument)), dtype=complex)
            case ast.Attribute(value=value, attr="T"):
                return self.of(value).T
            case ast.Compare(left=left, ops=[ast.Lt() | ast.LtE() | ast.Gt() | ast.GtE() as op], comparators=[right]):
                less = self.of(right) - self.of(left) if isinstance(op, ast.Lt | ast.LtE) else self.of(left) - self.of(right)
                return self.opaque("positive", isinstance(op, ast.LtE | ast.GtE), less / np.abs(less).max())
            case ast.stmt():
                return self.statement(node)
            case list():
                return self.block(node) if any(isinstance(n, ast.stmt) for n in node) else self.opaque(*map(self.of, node))
            case ast.AST():
                fields = [type(node).__name__, *[self.of(v) for _, v in ast.iter_fields(node)]]
                if isinstance(node, ast.Call):  # two equal calls may return two values, as of a random generator
                    self.calls[self.text(fields)] += 1
                    fields.append(self.calls[self.text(fields)])
                return self.opaque(*fields)
        return repr(node)

    def block(self, statements: list[ast.stmt]) -> Any:
        """Return the value of what the statements do other than to set variables, which it sets."""
        return self.opaque(*[e for e in map(self.statement, statements) if e is not None])

    def statement(self, node: ast.stmt) -> Any:
        """Return what one statement does other than to set variables, None if nothing."""
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                self.names[name] = self.of(value)
            case ast.AugAssign(target=ast.Name(id=name), op=op, value=value):
                self.names[name] = self.of(ast.BinOp(ast.Name(name), op, value))
            case ast.Assign(targets=[ast.Tuple(elts=targets)], value=value) if all(isinstance(t, ast.Name) for t in targets):
                each = value.elts if isinstance(value, ast.Tuple) and len(value.elts) == len(targets) else ()
                found = [self.of(v) for v in each] or [self.opaque("item", k, self.of(value)) for k in range(len(targets))]
                self.names |= {t.id: v for t, v in zip(targets, found, strict=True)}  # type: ignore[attr-defined]
            case ast.If() | ast.For() | ast.While() | ast.With() | ast.Try() | ast.Assign() | ast.AugAssign():
                return self._changing(node)
            case ast.FunctionDef() | ast.ClassDef():
                before, own = self.names, _stored(node) if self.names else set()
                self.names = {name: value for name, value in before.items() if name not in own}
                effect = self.opaque(type(node).__name__, *[self.of(v) for _, v in ast.iter_fields(node)])
                if isinstance(node, ast.ClassDef):
                    effect = self.opaque(effect, *self.variables())
                self.names = before
                return effect
            case _:
                return self.opaque(type(node).__name__, *[self.of(v) for _, v in ast.iter_fields(node)])
        return None

    def _changing(self, node: ast.stmt) -> Any:
        """Return what a compound statement does; each variable that it sets has an own value after it."""
        changed = sorted(_stored(node))
        if isinstance(node, ast.For | ast.While):
            self.names |= {name: self.opaque("loop", name, self.names.get(name)) for name in changed}
        effects: list[Any] = [type(node).__name__]
        for _, value in ast.iter_fields(node):
            effects += [self.of(value), *map(self.names.get, changed)]
        effect = self.opaque(*effects)
        self.names |= {name: self.opaque("after", name, effect) for name in changed}
        return effect


def _stored(node: ast.AST) -> set[str]:
    """Return the names that ``node`` sets, changes parts of, or takes as parameters."""
    nodes = list(ast.walk(node))
    stored = [
        n.value if isinstance(n, ast.Subscript | ast.Attribute) else n
        for n in nodes
        if isinstance(getattr(n, "ctx", None), ast.Store)
    ]
    return {n.id for n in stored if isinstance(n, ast.Name)} | {n.arg for n in nodes if isinstance(n, ast.arg)}
