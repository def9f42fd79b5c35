"""The syntax tree of a right solution: where its nodes stand in the source, what they are part of, and how they read."""

import ast
import functools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

SUM, PRODUCT = (ast.Add, ast.Sub), (ast.Mult, ast.Div)
SIMPLE = (ast.Name, ast.Constant, ast.Call, ast.Attribute, ast.Subscript, ast.List)
SKIPPED = (ast.Import, ast.ImportFrom, ast.JoinedStr, ast.Raise, ast.Assert)
COMPOUND = (ast.For, ast.While, ast.If, ast.With, ast.Try, ast.FunctionDef, ast.ClassDef)
LONG = 70


@dataclass(frozen=True)
class Change:
    """``new`` in place of the bytes ``span`` of the source; the nodes ``parts`` fill its ``{}``, in brackets where
    needed, unless ``exact``.
    """

    code: str
    sentence: str
    span: tuple[int, int]
    new: str
    parts: tuple[ast.AST, ...]
    exact: bool


class Solution:
    """The syntax tree of a right solution and the places of its nodes in the source."""

    def __init__(self, source: str, function: str) -> None:
        self.source, self.bytes, self.tree = source, source.encode(), ast.parse(source)
        self.starts = [0, *(k + 1 for k, byte in enumerate(self.bytes) if byte == ord("\n"))]
        self.parents: dict[Any, Any] = {child: node for node in ast.walk(self.tree) for child in ast.iter_child_nodes(node)}
        self.statements = [self.span(n) for n in self.parents if isinstance(n, ast.stmt) and not isinstance(n, COMPOUND)]
        assigned = [n for n in self.parents if isinstance(n, ast.Assign) and is_operation(n.value, *PRODUCT)]
        self.products = {target.id for n in assigned for target in n.targets if isinstance(target, ast.Name)}
        self.nodes = [node for top in _needed(self.tree, function) for node in _walk(top)]

    def change(
        self, code: str, what: str, node: Any, new: str, *parts: Any, at: Any = None, last: Any = None, exact: bool = False
    ) -> Change:
        """Return the change of ``node``, or of ``node`` to ``last``; its sentence adds the place ``at`` to ``what``."""
        inner, place = f" in {self.quote(at or node)}", self.place(at or node)
        sentence = what.replace(inner, place) if place and inner in what else what + place
        return Change(code, sentence, self.span(node, last), new, parts, exact)

    def stands(self, code: str, node: Any, new: str, whole: Any = None) -> Change:
        """Return the change of ``node`` to ``new``; its sentence quotes the ``whole`` of which it is a part."""
        what = f"{self.quote(whole or node, node, new)} stands in place of {self.quote(whole or node)}"
        return self.change(code, what, node, new, at=whole, exact=True)

    def changed(self, change: Change) -> str | None:
        """Return the changed source, with as few brackets as keep its meaning; None if it is not valid Python."""
        (start, end), texts = change.span, [self.text(part) for part in change.parts]
        needed = [text if isinstance(part, SIMPLE) else f"({text})" for part, text in zip(change.parts, texts, strict=True)]
        news = [change.new.format(*texts)]
        if not change.exact:
            news += [change.new.format(*needed), f"({change.new.format(*needed)})"]
        whole = [(a, b) for a, b in self.statements if a <= start and end <= b]
        first, last = min(whole, key=lambda span: span[1] - span[0], default=(0, len(self.bytes)))
        changed = [(self.bytes[first:start] + new.encode() + self.bytes[end:last]).decode() for new in news]
        meaning = _meaning(changed[-1])
        if meaning is None:
            return None
        text = next(text for text in changed if text is changed[-1] or _meaning(text) == meaning)
        return self.bytes[:first].decode() + text + self.bytes[last:].decode()

    def span(self, node: Any, last: Any = None) -> tuple[int, int]:
        """Return the first byte of ``node`` and the one after the end of ``last`` or of ``node``."""
        last = last or node
        return self.starts[node.lineno - 1] + node.col_offset, self.starts[last.end_lineno - 1] + last.end_col_offset

    def text(self, node: Any) -> str:
        """Return the source of a node."""
        return self.bytes[slice(*self.span(node))].decode()

    def quote(self, node: Any, part: Any = None, new: str = "") -> str:
        """Return the source of a node in backticks and one line, with ``new`` in place of a ``part`` of it."""
        (start, end), (first, last) = self.span(node), self.span(part or node)
        text = (self.bytes[start:first] + new.encode() + self.bytes[last:end]).decode() if part else self.text(node)
        text = " ".join(line.split("#")[0].strip() for line in text.splitlines()) if "\n" in text else text
        return f"`{text if len(text) <= LONG else text[: LONG - 1] + '…'}`"

    def term(self, node: Any) -> str:
        """Return the quoted source of a term without its sign."""
        added = is_operation(self.parents[node], *SUM) or isinstance(self.parents[node], ast.AugAssign)
        return ("the term " if added else "") + self.quote(node).replace("`-", "`")

    def place(self, node: Any) -> str:
        """Return " in `…`": the smallest expression around ``node`` that occurs once in the source, "" if ``node`` does."""
        inner = node
        while self.source.count(self.text(node)) > 1:
            node = self.parents[node]
            while not isinstance(node, ast.expr | ast.stmt):
                node = self.parents[node]
            if isinstance(node, COMPOUND):
                return ""
        return "" if node is inner else f" in {self.quote(node)}"

    def outer(self, node: Any, *kinds: type) -> Any:
        """Return the innermost node of the ``kinds`` around ``node``, or the module."""
        while not isinstance(node, (*kinds, ast.Module)):
            node = self.parents[node]
        return node

    @functools.lru_cache(8)  # noqa: B019
    def variables(self, outer: Any, attributes: bool) -> dict[str, tuple[int, set[str]]]:
        """Return the variables of a function, or the ``attributes`` of a class: the line that defines each, and its uses."""
        key = "attr" if attributes else "id"
        found: list[Any] = [n for n in ast.walk(outer) if isinstance(n, ast.Attribute if attributes else ast.Name)]
        lines = {a.arg: 0 for a in outer.args.args if a.arg != "self"} if isinstance(outer, ast.FunctionDef) else {}
        for n in found:
            if isinstance(n.ctx, ast.Store) and not isinstance(self.parents[n], ast.comprehension):
                lines.setdefault(getattr(n, key), n.lineno)
        uses: dict[str, set[str]] = {name: set() for name in lines}
        for n in found:
            parent = self.parents[n]
            use = "called" if getattr(parent, "func", None) is n else "indexed" if isinstance(parent, ast.Subscript) else "plain"
            uses.get(getattr(n, key), set()).add(use)
        return {name: (lines[name], uses[name]) for name in lines}

    def product(self, node: Any) -> Any:
        """Return the largest product that ``node`` is a factor of."""
        while is_operation(self.parents[node], *PRODUCT, ast.MatMult):
            node = self.parents[node]
        return node

    def is_returned(self, node: Any) -> bool:
        """Whether ``node`` is a returned value, or an element of a returned tuple, list or array."""
        parent = self.parents[node]
        while isinstance(parent, ast.List | ast.Tuple) or "array" in called(parent):
            node, parent = parent, self.parents[parent]
        return isinstance(parent, ast.Return) and "array" not in called(node)

    def is_term(self, node: Any) -> bool:
        """Whether ``node`` is a term of a sum, a whole product, or a returned value."""
        if not isinstance(node, (ast.BinOp, *SIMPLE)) or isinstance(node, ast.Constant | ast.List) or is_operation(node, *SUM):
            return False
        whole = is_operation(node, *PRODUCT) and self.product(node) is node
        changed_before = isinstance(node, ast.Name) and node.id in self.products
        return whole or is_operation(self.parents[node], *SUM) or (self.is_returned(node) and not changed_before)


def is_operation(node: Any, *operators: type) -> bool:
    """Whether ``node`` is an operation of two operands with one of the ``operators``."""
    return isinstance(node, ast.BinOp) and isinstance(node.op, operators)


def integer(node: Any) -> int | None:
    """Return the value of an integer literal, also a negative one, None if ``node`` is no such literal."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return None if (value := integer(node.operand)) is None else -value
    return node.value if isinstance(node, ast.Constant) and type(node.value) is int else None


def called(call: Any) -> str:
    """Return the last name of the called function, "" if ``call`` is no call."""
    return getattr(call.func, "attr", getattr(call.func, "id", "")) if isinstance(call, ast.Call) else ""


def _meaning(source: str) -> str | None:
    try:
        return ast.dump(ast.parse(source))
    except SyntaxError:
        return None


def _needed(tree: ast.Module, function: str) -> list[ast.stmt]:
    """Return the top-level statements that define or change ``function`` and what it uses."""
    names = {
        t: {n.id for n in ast.walk(t) if isinstance(n, ast.Name)} for t in tree.body if not isinstance(t, (ast.Expr, *SKIPPED))
    }
    needed, found = {function}, set[ast.stmt]()
    while new := [t for t in names if t not in found and ({t.name} if isinstance(t, COMPOUND[-2:]) else names[t]) & needed]:
        found.update(new)
        needed |= {name for t in new for name in names[t]}
    return [t for t in names if t in found]


def _walk(node: ast.AST) -> Iterator[ast.AST]:
    """Yield a node and its parts, without docstrings, messages, type hints, defaults and decorators."""
    yield node
    for field, value in ast.iter_fields(node):
        if field not in ("annotation", "returns", "decorator_list", "defaults", "kw_defaults", "bases"):
            for child in value if isinstance(value, list) else [value]:
                silent = isinstance(child, ast.Expr) and (isinstance(child.value, ast.Constant) or called(child.value) == "print")
                if isinstance(child, ast.AST) and not isinstance(child, SKIPPED) and not silent:
                    yield from _walk(child)
