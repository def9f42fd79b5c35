"""The global names that a text reads, binds and changes. Local names and attributes do not count."""

import ast
import symtable
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

_FUNCTION = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
_COMPREHENSIONS = ("listcomp", "setcomp", "dictcomp", "genexpr")


@dataclass(frozen=True)
class Names:
    """Global names of a text: ``now`` are read while it runs, ``later`` by its functions, ``bound`` are
    assigned.
    """

    now: frozenset[str] = frozenset()
    later: frozenset[str] = frozenset()
    bound: frozenset[str] = frozenset()


@lru_cache(maxsize=4096)
def names_in(text: str) -> Names:
    """Return the global names of a text; none if it is not Python."""
    try:
        table = symtable.symtable(text, "cell", "exec")
    except SyntaxError:
        return Names()
    now: set[str] = set()
    later: set[str] = set()
    _collect(table, now, later, running=True)
    bound = frozenset(s.get_name() for s in table.get_symbols() if s.is_assigned() or s.is_imported())
    return Names(frozenset(now), frozenset(later), bound)


def own_nodes(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the node and the nodes that run with it, without nested functions."""
    if isinstance(node, _FUNCTION):
        return
    yield node
    for child in ast.iter_child_nodes(node):
        yield from own_nodes(child)


def increments(node: ast.AST, name: str) -> bool:
    """Return whether the node contains ``name += …``."""
    own = [n.target for n in own_nodes(node) if isinstance(n, ast.AugAssign)]
    return any(isinstance(target, ast.Name) and target.id == name for target in own)


def stores_into(node: ast.AST, name: str) -> bool:
    """Return whether the node contains ``name.x = …`` or ``name[k] = …``."""
    own = [
        n
        for n in own_nodes(node)
        if isinstance(n, ast.Attribute | ast.Subscript) and isinstance(n.ctx, ast.Store)
    ]
    return any(_root(target) == name for target in own)


def calls_on(node: ast.AST, name: str) -> bool:
    """Return whether the node contains ``name.method(…)`` as a statement."""
    calls = [n.value for n in own_nodes(node) if isinstance(n, ast.Expr) and isinstance(n.value, ast.Call)]
    return any(isinstance(call.func, ast.Attribute) and _root(call.func) == name for call in calls)


def _collect(table: symtable.SymbolTable, now: set[str], later: set[str], running: bool) -> None:
    for symbol in table.get_symbols():
        if symbol.is_global() and (symbol.is_referenced() or symbol.is_declared_global()):
            (now if running else later).add(symbol.get_name())
    for child in table.get_children():
        comprehension = child.get_name().strip("<>") in _COMPREHENSIONS
        _collect(child, now, later, running and (comprehension or child.get_type() == "class"))


def _root(node: ast.expr) -> str | None:
    while isinstance(node, ast.Attribute | ast.Subscript):
        node = node.value
    return node.id if isinstance(node, ast.Name) else None
