"""Mutants: every small change of a right submission's source, one at a time."""

import ast
import copy
from collections.abc import Iterator
from dataclasses import dataclass

OPERATORS: dict[type[ast.operator], tuple[type[ast.operator], ...]] = {
    ast.Add: (ast.Sub,),
    ast.Sub: (ast.Add,),
    ast.Mult: (ast.Div, ast.Add),
    ast.Div: (ast.Mult,),
    ast.MatMult: (ast.Mult,),
    ast.Mod: (ast.FloorDiv,),
}


@dataclass(frozen=True)
class Mutant:
    """A changed submission. ``kind`` groups mutants in a table; ``name`` identifies the mutant."""

    kind: str
    name: str
    source: str


def mutants_of(source: str, function: str, name: str) -> Iterator[Mutant]:
    """Yield each change of one node in the source's top-level statements other than imports, if ``function``
    is still defined.
    """
    tree = ast.parse(source)
    inside = [node for top in tree.body if not isinstance(top, ast.Import | ast.ImportFrom) for node in ast.walk(top)]
    for number, node in enumerate(inside):
        for what, change in _changes(node):
            mutated = copy.deepcopy(tree)
            again = [n for top in mutated.body if not isinstance(top, ast.Import | ast.ImportFrom) for n in ast.walk(top)]
            change(again[number])
            text = ast.unparse(ast.fix_missing_locations(mutated))
            if function in text and text != ast.unparse(tree):
                yield Mutant("one change of the source", f"{name} line {getattr(node, 'lineno', 0)}: {what}", text)


def _changes(node: ast.AST) -> Iterator[tuple[str, "Change"]]:
    if isinstance(node, ast.BinOp):
        for other in OPERATORS.get(type(node.op), ()):
            yield f"{type(node.op).__name__} → {other.__name__}", Change("op", other())
        if isinstance(node.op, ast.Sub | ast.Div):
            yield f"{type(node.op).__name__}, operands swapped", Change("swap", None)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield "minus dropped", Change("op", ast.UAdd())
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
        for value in (node.value + 1, -node.value) if node.value else (1,):
            yield f"{node.value} → {value}", Change("value", value)
    elif isinstance(node, ast.Call) and len(node.args) > 1:
        yield "first two arguments exchanged", Change("arguments", None)
    elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in ("w", "I"):
        yield f"{node.id} → {'I' if node.id == 'w' else 'w'}", Change("id", "I" if node.id == "w" else "w")


@dataclass(frozen=True)
class Change:
    """A change that sets a node's field or swaps two of its parts."""

    field: str
    value: object

    def __call__(self, node: ast.AST) -> None:
        """Apply the change to ``node``."""
        if self.field == "swap":
            node.left, node.right = node.right, node.left  # type: ignore[attr-defined]
        elif self.field == "arguments":
            node.args[:2] = node.args[1::-1]  # type: ignore[attr-defined]
        else:
            setattr(node, self.field, self.value)
