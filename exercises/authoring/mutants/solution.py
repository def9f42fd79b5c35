"""The syntax tree of a right solution: where its nodes stand in the source, what they are part of, and how
they read.
"""

import ast
import functools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

SUM, PRODUCT = (ast.Add, ast.Sub), (ast.Mult, ast.Div)
TERMS = (ast.BinOp, ast.Name, ast.Call, ast.Attribute, ast.Subscript)
SKIPPED = (ast.Import, ast.ImportFrom, ast.JoinedStr, ast.Raise, ast.Assert)
COMPOUND = (ast.For, ast.While, ast.If, ast.With, ast.Try, ast.FunctionDef, ast.ClassDef)
UNUSED = ("annotation", "returns", "decorator_list", "defaults", "kw_defaults", "bases")
LONG = 70


@dataclass(frozen=True)
class Variant:
    """A version of a right solution: its whole ``source``, and the diagnosis of a submission that returns the
    same numbers.

    ``code`` is a diagnosis code, "" for no diagnosis; ``sentence`` says what a student with this version did.
    ``line`` is the changed line. ``declared`` variants are the author's mistakes; the others change one
    place, or two: then ``both`` are the two changes.
    """

    code: str
    sentence: str
    source: str
    line: int = 0
    declared: bool = False
    both: tuple["Variant", ...] = ()


class Solution:
    """The syntax tree of a right solution and the places of its nodes in the source."""

    def __init__(self, source: str) -> None:
        self.source, self.bytes, self.tree = source, source.encode(), ast.parse(source)
        self.starts = [0, *(k + 1 for k, byte in enumerate(self.bytes) if byte == ord("\n"))]
        self.parents: dict[Any, Any] = {
            child: node for node in ast.walk(self.tree) for child in ast.iter_child_nodes(node)
        }
        assigned = [n for n in self.parents if isinstance(n, ast.Assign) and is_operation(n.value, *PRODUCT)]
        self.products = {target.id for n in assigned for target in n.targets if isinstance(target, ast.Name)}
        self.nodes = [node for top in self.tree.body if not isinstance(top, ast.Expr) for node in _walk(top)]

    def replaced(self, code: str, sentence: str, span: tuple[int, int], new: str) -> Variant:
        """Return the variant with ``new`` in place of the bytes ``span`` of the source."""
        before, after = self.bytes[: span[0]].decode(), self.bytes[span[1] :].decode()
        return Variant(code, sentence, before + new + after, before.count("\n") + 1)

    def change(
        self, code: str, what: str, node: Any, new: str, *, at: Any = None, last: Any = None
    ) -> Variant:
        """Return the change of ``node``, or of ``node`` to ``last``; its sentence adds the place ``at`` to
        ``what``.
        """
        inner, place = f" in {self.named(at or node)}", self.place(at or node)
        sentence = what.replace(inner, place) if place and inner in what else what + place
        whole = last is None and isinstance(node, ast.expr)
        return self.replaced(code, sentence, self.span(node, last), f"({new})" if whole else new)

    def stands(self, code: str, node: Any, new: str, whole: Any = None) -> Variant:
        """Return the change of ``node`` to ``new``; its sentence quotes the ``whole`` of which it is a
        part.
        """
        what = f"{self.quote(whole or node, node, new)} stands in place of {self.quote(whole or node)}"
        return self.change(code, what, node, new, at=whole, last=node)

    def span(self, node: Any, last: Any = None) -> tuple[int, int]:
        """Return the first byte of ``node`` and the one after the end of ``last`` or of ``node``."""
        last = last or node
        return (
            self.starts[node.lineno - 1] + node.col_offset,
            self.starts[last.end_lineno - 1] + last.end_col_offset,
        )

    def text(self, node: Any) -> str:
        """Return the source of a node."""
        return self.bytes[slice(*self.span(node))].decode()

    def quote(self, node: Any, part: Any = None, new: str = "") -> str:
        """Return the source of a node in backticks and one line,
        with ``new`` in place of a ``part`` of it.
        """
        (start, end), (first, last) = self.span(node), self.span(part or node)
        text = (
            (self.bytes[start:first] + new.encode() + self.bytes[last:end]).decode()
            if part
            else self.text(node)
        )
        text = " ".join(line.split("#")[0].strip() for line in text.splitlines()) if "\n" in text else text
        return f"`{text if len(text) <= LONG else text[: LONG - 1] + '…'}`"

    def forms(self, name: str, node: Any) -> dict[str, str]:
        """Return the source of a node in brackets as ``name``, as it is (``name_r``), quoted (``_q``), and as
        a term (``_t``).
        """
        added = is_operation(self.parents[node], *SUM) or isinstance(self.parents[node], ast.AugAssign)
        quoted = self.named(node)
        term = ("the term " if added else "") + quoted.replace("`-", "`")
        return {
            name: f"({self.text(node)})",
            f"{name}_r": self.text(node),
            f"{name}_q": quoted,
            f"{name}_t": term,
        }

    def named(self, node: Any) -> str:
        """Return the quoted source of a node, or "the returned value", so that no sentence contains a whole
        solution.
        """
        return "the returned value" if isinstance(self.parents.get(node), ast.Return) else self.quote(node)

    def place(self, node: Any) -> str:
        """Return " in `…`": the smallest expression around ``node`` that occurs once in the source, "" if
        ``node`` does.
        """
        inner = node
        while self.source.count(self.text(node)) > 1:
            node = self.outer(self.parents[node], ast.expr, ast.stmt)
            if isinstance(node, COMPOUND):
                return ""
        return "" if node is inner else f" in {self.named(node)}"

    def outer(self, node: Any, *kinds: type) -> Any:
        """Return the innermost node of the ``kinds`` around ``node``, or the module."""
        while not isinstance(node, (*kinds, ast.Module)):
            node = self.parents[node]
        return node

    @functools.lru_cache(8)  # noqa: B019
    def variables(self, outer: Any, kind: Any) -> dict[str, tuple[int, set[str]]]:
        """Return the variables (``kind`` ast.Name) or the attributes (ast.Attribute) that ``outer`` sets:
        their lines and uses.
        """
        parameters = outer.args.args if isinstance(outer, ast.FunctionDef) else []
        known: dict[str, tuple[int, set[str]]] = {a.arg: (0, set()) for a in parameters if a.arg != "self"}
        found: list[Any] = [n for n in ast.walk(outer) if isinstance(n, kind)]
        for n in sorted(found, key=lambda n: not isinstance(n.ctx, ast.Store)):
            parent, name = self.parents[n], n.id if isinstance(n, ast.Name) else n.attr
            if isinstance(n.ctx, ast.Store) and not isinstance(parent, ast.comprehension):
                known.setdefault(name, (n.lineno, set()))
            use = (
                "called"
                if getattr(parent, "func", None) is n
                else "indexed"
                if isinstance(parent, ast.Subscript)
                else "plain"
            )
            known.get(name, (0, set()))[1].add(use)
        return known

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
        if not isinstance(node, TERMS) or is_operation(node, *SUM):
            return False
        whole = is_operation(node, *PRODUCT) and self.product(node) is node
        changed_before = isinstance(node, ast.Name) and node.id in self.products
        return (
            whole or is_operation(self.parents[node], *SUM) or (self.is_returned(node) and not changed_before)
        )


def is_operation(node: Any, *operators: type) -> bool:
    """Whether ``node`` is an operation of two operands with one of the ``operators``."""
    return isinstance(node, ast.BinOp) and isinstance(node.op, operators)


def called(call: Any) -> str:
    """Return the last name of the called function, "" if ``call`` is no call."""
    return getattr(call.func, "attr", getattr(call.func, "id", "")) if isinstance(call, ast.Call) else ""


def _walk(node: ast.AST) -> Iterator[ast.AST]:
    """Yield a node and its parts, without docstrings, messages, type hints, defaults and decorators."""
    if isinstance(node, ast.Expr) and (isinstance(node.value, ast.Constant) or called(node.value) == "print"):
        return
    if not isinstance(node, SKIPPED):
        yield node
        parts = [value for field, value in ast.iter_fields(node) if field not in UNUSED]
        for child in (child for part in parts for child in (part if isinstance(part, list) else [part])):
            yield from _walk(child) if isinstance(child, ast.AST) else ()
