"""What a student's cells can influence: the expected values that they cannot are truths.

A name can be influenced if a student's cell binds it, if a statement that reads such a name binds it, or,
below the first student's cell, if it holds something to be filled in or used up: an empty list, an array of
zeros, a random generator.
"""

import ast
import builtins
import functools
from collections.abc import Collection, Iterator, Sequence

from exercises.authoring.assignments.assignment import PublishedCell
from exercises.authoring.importing.self_reported_checks import Placed
from polhode.notebook.cell_to_python import Statement, statements_of
from polhode.notebook.names import names_in, own_nodes

TO_BE_CHANGED = {
    "zeros", "zeros_like", "empty", "empty_like", "list", "dict", "set", "deque", "defaultdict",
    "default_rng", "RandomState", "Random", "SeedSequence", "Generator", "iter",
}  # fmt: skip
"""Functions that make a value for others to change."""


@functools.lru_cache(maxsize=8)
def influenced(cells: tuple[PublishedCell, ...]) -> frozenset[str]:
    """Return the names of a published notebook whose values the student's cells can influence."""
    first = next((k for k, cell in enumerate(cells) if not cell.is_given), len(cells))
    before = [s for cell in cells[:first] for s in statements_of(cell.source)]
    after = [s for cell in cells[first:] if cell.is_given for s in statements_of(cell.source)]
    own = [s for cell in cells if not cell.is_given for s in statements_of(cell.source)]
    given = [*before, *after]
    bound = {name for statement in given for name in statement.names.bound}
    read = {name for statement in given for name in _read(statement)}
    found = {name for name in read - bound if not hasattr(builtins, name)}
    found |= {name for statement in own for name in statement.names.bound}
    to_be_changed = {n for s in given if _is_to_be_changed(s.node) for n in s.names.bound}
    changed = {s: s.names.bound | {n for n in bound if n in s.text and s.changes(n)} for s in given}
    while True:
        late = found | to_be_changed
        reading = [s for s in before if s.names.now & found or s.names.later & late]
        reading += [s for s in after if _read(s) & late]
        more = frozenset[str]().union(*(changed[s] for s in reading))
        if more <= found:
            return frozenset(late)
        found |= more


def is_independent(placed: Placed, names: Collection[str]) -> bool:
    """Return whether the expected value of a line can be a truth: it reads none of the ``names`` that the
    student's cells can influence.
    """
    call = placed.call
    expected = names_in(call.arguments[1])
    fixed = not (call.computed or call.repeated or call.in_function)
    return call.kind == "close" and fixed and not (expected.now | expected.later) & set(names)


def computing_cells(
    cells: Sequence[PublishedCell], lines: Sequence[Placed], names: Collection[str]
) -> Iterator[tuple[str, str]]:
    """Yield cells, by name, that compute the expected values of ``lines`` without the student: the statements
    of given cells that read none of the ``names``, and for each line a cell, named as ``computing`` says,
    that compares its expected value with itself.
    """
    places = {(placed.cell.name, placed.call.place): placed for placed in lines}
    for cell in (cell for cell in cells if cell.is_given):
        kept = list[str]()
        for statement in statements_of(cell.source):
            here = [
                placed
                for node in ast.walk(statement.node)
                if isinstance(node, ast.Call)
                and (placed := places.get((cell.name, (node.lineno, node.col_offset))))
            ]
            if here:
                yield cell.name, "\n".join(kept)
                kept.clear()
            for placed in here:
                expected, function = placed.call.arguments[1], placed.call.function
                yield computing(placed), f'{function}({expected}, {expected}, "expected")'
            if not here and not _read(statement) & set(names):
                kept.append(statement.text)
        yield cell.name, "\n".join(kept)


def computing(placed: Placed) -> str:
    """Return the name of the cell that computes the expected value of a line."""
    return f"expected value of {placed.cell.name}, line {placed.call.place[0]}"


def is_shown(placed: Placed, cells: Sequence[PublishedCell]) -> bool:
    """Return whether the expected value of a line stands in the notebook.

    It does if it is a literal, an expression of numbers and a module's constants, or a name that is given
    such a value; and wherever the line compares it with a mere name, to which a student can assign it.
    """
    got, expected = placed.call.arguments
    names = names_in(expected)
    return got.isidentifier() or not (names.now | names.later) - _constants(cells)


def _constants(cells: Sequence[PublishedCell]) -> set[str]:
    """Return the modules that given cells import, the builtins, and the names of values made of these."""
    found = set(dir(builtins))
    for statement in (s for cell in cells if cell.is_given for s in statements_of(cell.source)):
        is_import = isinstance(statement.node, ast.Import | ast.ImportFrom)
        is_value = isinstance(statement.node, ast.Assign | ast.AnnAssign)
        if is_import or (is_value and not statement.names.now - found):
            found |= statement.names.bound
    return found


def _read(statement: Statement) -> frozenset[str]:
    return statement.names.now | statement.names.later


def _is_to_be_changed(node: ast.stmt) -> bool:
    value = getattr(node, "value", None) if isinstance(node, ast.Assign | ast.AnnAssign) else None
    if isinstance(value, ast.List | ast.Dict | ast.Set):
        return not getattr(value, "elts", None) and not getattr(value, "keys", None)
    calls = [n for n in own_nodes(value) if isinstance(n, ast.Call)] if value is not None else []
    return any(ast.unparse(call.func).rpartition(".")[2] in TO_BE_CHANGED for call in calls)
