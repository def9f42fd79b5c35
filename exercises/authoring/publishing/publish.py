"""The students' notebook: the author's with every solution emptied, and the cells that install the kit, check
and submit.

It is a pure function of the assignment's folder. The server fills in ``{{SERVER}}``, ``{{KIT_URL}}`` and
``{{PACKAGES}}``.
"""

import ast
import builtins
import json
import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from exercises.authoring.importing.reported_lines import Line
from exercises.authoring.questions.author_notebook import SOLUTION, Cell, with_ids
from exercises.authoring.questions.question import Question
from polhode.notebook.cell_to_python import DEFINITION, python_of, statements_of
from polhode.notebook.names import names_in

KERNEL = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}
NOTE = """\
**Install the course kit.** The next cell installs it from the course server; it is imported as `polhode`.
`polhode.connect` then brings the checks of this assignment and its files.
On the server your code can import only {{PACKAGES}}."""
INSTALL = """%pip install -q {{{{KIT_URL}}}}
import polhode

SERVER = "{{{{SERVER}}}}"
polhode.connect(SERVER, assignment="{slug}")
polhode.login()"""
SUBMIT_NOTE = """\
# Run All does not submit. Run the cells above first; then remove the "# " before polhode.submit.
import polhode  # again: a cell above may have used this name for something else"""
EMPTY, TO_DEFINE = "# your code here", "# {} = ..."
BROUGHT = "  # polhode.connect, in a cell above, brings {package}"
"""A comment behind the first import of a course's package: the traceback shows it to a student who runs that
cell first.
"""
IS_BROUGHT = re.compile(re.escape(BROUGHT).replace(re.escape("{package}"), r"\w+") + "$", re.MULTILINE)


class Section(NamedTuple):
    """An exercise of the declaration: its questions and lines of validation cells."""

    number: str
    title: str
    questions: tuple[Question, ...] = ()
    lines: tuple[Line, ...] = ()

    @property
    def names(self) -> list[str]:
        """The names that its questions ask for."""
        return list(dict.fromkeys(name for question in self.questions for name in question.names))


def published(
    slug: str, cells: Sequence[Cell], sections: Sequence[Section], packages: Collection[str] = ()
) -> str:
    """Return the students' notebook as JSON text (nbformat 4.5), from the author's ``cells``. ``packages``
    are the course's own.
    """
    names = [name for section in sections for name in section.names]
    kept = [cell for cell in cells if cell.kind == "code" or SOLUTION not in cell.tags]
    kept = _with_comment(kept, packages)
    read = {name for cell in kept if not cell.is_solution(names) for name in _read_in(cell)} | set(names)
    checked = dict(_checks(kept, sections))
    wanted = _wanted(kept, names) if any(section.lines for section in sections) else {}
    made = []
    for at, cell in enumerate(kept):
        here = wanted.get(at, [])
        source = (
            _emptied_cell(cell, names, read, here)
            if cell.is_solution(names)
            else "\n".join([cell.source, *map(TO_DEFINE.format, here)])
        )
        made.append(replace(cell, source=source))
        made += [
            _code(f'polhode.check("{number}")', _id("check", number), "check")
            for number, after in checked.items()
            if after == at
        ]
    if not any("{{KIT_URL}}" in cell.source for cell in kept):
        start = int(kept[0].kind == "markdown")
        made[start:start] = [
            Cell("markdown", NOTE, "install-note"),
            _code(INSTALL.format(slug=slug), "install", "install"),
        ]
    if not any(_calls(cell, "submit") or "submit" in cell.tags for cell in kept):
        made.append(_code("polhode.submit()", "submit", "submit"))
    made = [replace(cell, source=_commented(cell.source)) if _only_submits(cell) else cell for cell in made]
    written = {
        "cells": [_json(id, cell) for id, cell in with_ids(made)],
        "metadata": KERNEL,
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(written, indent=1, ensure_ascii=False) + "\n"


def _with_comment(cells: Sequence[Cell], packages: Collection[str]) -> list[Cell]:
    """Return the cells with the comment BROUGHT, if one imports a package of the course."""
    for at, cell in enumerate(cells):
        imports = [node for node in cell.nodes if isinstance(node, ast.Import | ast.ImportFrom)]
        for node in sorted(imports, key=lambda node: node.lineno):
            found = (
                [alias.name for alias in node.names] if isinstance(node, ast.Import) else [node.module or ""]
            )
            if own := [top for name in found if (top := name.partition(".")[0]) in packages]:
                lines, text = cell.source.split("\n"), python_of(cell.source) or ""
                line = len(lines) - len(text.split("\n")) + node.lineno - 1
                lines[line] += "" if lines[line].endswith("\\") else BROUGHT.format(package=own[0])
                return [*cells[:at], replace(cell, source="\n".join(lines)), *cells[at + 1 :]]
    return list(cells)


def _checks(cells: Sequence[Cell], sections: Sequence[Section]) -> Iterator[tuple[str, int]]:
    """Yield the number of each exercise without a check cell, and the index of its last solution."""
    for section in sections:
        is_checked = any(section.number in arguments for cell in cells for arguments in _calls(cell, "check"))
        if not is_checked and (
            solutions := [at for at, cell in enumerate(cells) if cell.bound() & set(section.names)]
        ):
            yield section.number, solutions[-1]


def _wanted(cells: Sequence[Cell], names: Collection[str]) -> dict[int, list[str]]:
    """Return the names that given cells read and no other cell binds, by the index of the last cell above the
    first of them that students fill in.
    """
    bound, last, found = {name for cell in cells for name in cell.bound()}, None, dict[int, list[str]]()
    for at, cell in enumerate(cells):
        if cell.is_solution(names) or _is_comment(cell):
            last = at
        elif last is not None and cell.kind == "code":
            new = [name for name in _read_in(cell) if name not in bound and not hasattr(builtins, name)]
            found.setdefault(last, []).extend(sorted(set(new)))
            bound.update(new)
    return found


def _is_comment(cell: Cell) -> bool:
    return cell.kind == "code" and python_of(cell.source) is not None and not statements_of(cell.source)


def _emptied_cell(
    cell: Cell, names: Collection[str], read: Collection[str], wanted: Collection[str] = ()
) -> str:
    """Return the text of a solution's cell without the solution.

    A cell with the tag, or one that binds a solution by another statement than a definition, keeps only the
    emptied definitions and the names that the rest of the notebook reads, those ``wanted`` among them.
    """
    if (text := python_of(cell.source)) is None:
        return EMPTY
    lines = cell.source.split("\n")
    head = len(lines) - len(text.split("\n"))  # lines of a cell magic above the Python
    nodes = [s.node for s in statements_of(cell.source)]
    solved = [node for node in nodes if isinstance(node, DEFINITION) and node.name in names]
    others = {
        name: None
        for s in statements_of(cell.source)
        if s.node not in solved
        for name in sorted(s.names.bound)
    }
    if SOLUTION not in cell.tags and not set(others) & set(names):
        for node in reversed(solved):
            lines[head + _first(node) - 1 : head + (node.end_lineno or 0)] = [_emptied(text, node)]
        return "\n".join(lines)
    asked = [name for name in others if name in read and not name.startswith("_")] + [*wanted]
    parts = [_emptied(text, node) for node in solved]
    if asked or not parts:
        parts.append("\n".join([EMPTY, *map(TO_DEFINE.format, asked)]))
    return "\n\n\n".join(parts)


def _emptied(text: str, node: ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) -> str:
    """Return a definition in ``text`` with signature, docstring and decorators. A class keeps its fields and
    emptied methods.
    """
    lines, first = text.split("\n"), node.body[0]
    # ast counts columns in bytes
    before, outer = (lines[n.lineno - 1].encode()[: n.col_offset].decode() for n in (first, node))
    own_line = not before.strip()
    indent = before if own_line else outer + "    "
    head = [*lines[_first(node) - 1 : _first(first) - 1], *([] if own_line else [before.rstrip()])]
    kept = [re.sub(r"(\n[ \t]*(#.*)?)+$", "", "\n".join(head))]
    if ast.get_docstring(node, clean=False) is not None:
        kept.append(f"{indent}{ast.get_source_segment(text, first)}")
    members: list[str] = []
    for member in node.body if isinstance(node, ast.ClassDef) and own_line else []:
        if isinstance(member, DEFINITION):
            members += ([""] if members or len(kept) > 1 else []) + [_emptied(text, member)]
        elif isinstance(member, ast.AnnAssign):  # a field of a dataclass belongs to the signature
            members.append(f"{indent}{ast.get_source_segment(text, member)}")
    return "\n".join(kept + (members or [f"{indent}..."]))


def _first(node: ast.stmt) -> int:
    """Return the first line of a statement, with its decorators."""
    return min([node.lineno, *(decorator.lineno for decorator in getattr(node, "decorator_list", []))])


def _read_in(cell: Cell) -> Iterator[str]:
    if cell.kind == "code" and (text := python_of(cell.source)) is not None:
        names = names_in(text)
        yield from names.now | names.later


def _calls(cell: Cell, function: str) -> list[list[str]]:
    """Return the arguments of each call of ``polhode.function`` in a code cell, as text."""
    calls = [
        node
        for node in cell.nodes
        if isinstance(node, ast.Call) and ast.unparse(node.func) == f"polhode.{function}"
    ]
    return [[str(getattr(argument, "value", None)) for argument in call.args] for call in calls]


def _only_submits(cell: Cell) -> bool:
    """Return whether a code cell consists of calls of ``polhode.submit``."""
    statements = [s.node for s in statements_of(cell.source)] if cell.kind == "code" else []
    calls = [
        node.value for node in statements if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)
    ]
    return (
        bool(calls)
        and len(calls) == len(statements)
        and all(ast.unparse(call.func) == "polhode.submit" for call in calls)
    )


def _commented(source: str) -> str:
    """Return calls of ``polhode.submit`` as comments, so that *Run All* does not submit."""
    return "\n".join([SUBMIT_NOTE, *(f"# {line}" for line in source.split("\n"))])


def _code(source: str, id: str, tag: str) -> Cell:
    return Cell("code", source, id, (tag,))


def _id(what: str, number: str) -> str:
    return re.sub(r"[^a-zA-Z0-9_-]", "-", f"{what}-{number}")[:64]


def _json(id: str, cell: Cell) -> dict[str, Any]:
    written: dict[str, Any] = {
        "cell_type": cell.kind,
        "id": id,
        "metadata": {"tags": list(cell.tags)} if cell.tags else {},
    }
    written |= {"attachments": cell.attachments} if cell.attachments else {}
    written |= {"execution_count": None, "outputs": []} if cell.kind == "code" else {}
    return dict(sorted((written | {"source": cell.source.splitlines(keepends=True)}).items()))
