"""Every message that polhode can show, collected from its source: ``python -m tests.support.messages`` writes
docs/messages.md.
"""

import ast
import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

from tests.support.checkout import ROOT

FILE = ROOT / "docs" / "messages.md"
SECTIONS = {
    "Command line": ("service/cli/",),
    "Server and pages": (
        "service/pages/",
        "service/api/",
        "service/auth/",
        "service/http/",
        "service/app.py",
        "service/settings.py",
    ),
    "Database and workers": ("service/store/", "service/workers/"),
    "Sandbox, grading and formats": ("service/sandbox/", "service/grading/", "service/formats/"),
    "The students' kit": ("exercises/kit/",),
    "Assignments: declaration": ("exercises/",),
    "Assignments of the course": tuple(
        f"exercises/{p.parent.name}/" for p in sorted(ROOT.glob("exercises/*/assignment.py"))
    ),
    "Physics": ("reference/",),
}
HEAD = """# Every message

polhode shows these texts: errors, help, reasons of –, diagnoses, labels, page text. `…` stands for a value. The list is collected
from the source by `python -m tests.support.messages`, and a test compares it, so that each new message is seen in review.
A message says what failed, then what to do.
"""
# Calls whose arguments are shown, besides those that raise; the class or function by its last name.
SHOWN = {
    "Problem", "Diagnosis", "SceneEnd", "WrongAnswer", "Mistake", "print", "unmeasured", "Outcome",
    "SweepResult", "_cause",
    "cause", "error", "warning", "log", "close", "within", "conserved", "below", "holds", "shows",
    "Judgement", "Case",
    "Figure", "Animation", "Motion",
}  # fmt: skip
KEYWORDS = {
    "help",
    "description",
    "sentence",
    "detail",
    "reason",
    "label",
    "hint",
    "hints",
    "title",
    "alt",
    "cause",
    "remark",
    "fault",
    "why",
    "system_fault",
}
IGNORED = {
    "get",
    "getattr",
    "open",
    "encode",
    "decode",
    "replace",
    "split",
    "startswith",
    "endswith",
    "execute",
    "text",
    "strftime",
    "compile",
}


def messages(path: Path) -> list[str]:
    """Return the messages of a file in order, each once; of a template its visible text."""
    if path.suffix == ".html":
        return list(dict.fromkeys(_template(path.read_text())))
    tree = ast.parse(path.read_text())
    found = [
        (node.lineno, node.col_offset, " ".join(text.split()))
        for node, text in _in_code(tree)
        if _is_sentence(text)
    ]
    return list(dict.fromkeys(text for *_, text in sorted(found)))


def document() -> str:
    """Return docs/messages.md as it should be."""
    parts = [HEAD]
    files = [
        p
        for top in ("service", "exercises", "reference")
        for p in sorted((ROOT / top).rglob("*"))
        if p.suffix in (".py", ".html")
    ]
    names = {p: str(p.relative_to(ROOT)) for p in files if "samples" not in p.parts}
    for section, folders in SECTIONS.items():
        deeper = [
            f
            for other in SECTIONS.values()
            for f in other
            if f not in folders and any(f.startswith(g) for g in folders)
        ]
        mine = [
            p for p, name in names.items() if name.startswith(folders) and not name.startswith(tuple(deeper))
        ]
        blocks = [
            f"`{names[p]}`\n\n```text\n" + "\n".join(found) + "\n```\n"
            for p in mine
            if (found := messages(p))
        ]
        parts.append(f"## {section}\n\n" + "\n".join(blocks))
    return "\n".join(parts)


def _in_code(tree: ast.AST) -> Iterator[tuple[ast.expr, str]]:
    for node in ast.walk(tree):
        match node:
            case ast.Raise(exc=ast.Call() as call):
                yield from _strings(call)
            case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)) if name in SHOWN:
                yield from _strings(node)
            case ast.keyword(arg=name, value=value) if name in KEYWORDS:
                yield from _strings(value)
            case ast.Call(func=function, args=args) if _name(function) not in IGNORED:
                yield from ((v, t) for a in args for v, t in _direct(a) if _reads_as_prose(t))
            case ast.GeneratorExp(elt=value) | ast.ListComp(elt=value):
                yield from ((v, t) for v, t in _direct(value) if _reads_as_prose(t))
            case ast.Dict(values=values) | ast.Tuple(elts=values) | ast.List(elts=values):
                yield from (
                    (v, t) for v in values if v is not None for v, t in _direct(v) if _reads_as_prose(t)
                )
            case ast.Yield(value=ast.expr() as value) | ast.Return(value=ast.expr() as value):
                yield from ((v, t) for v, t in _direct(value) if _reads_as_prose(t))
            case (
                ast.Assign(value=value)
                | ast.AugAssign(value=value)
                | ast.AnnAssign(value=ast.expr() as value)
            ):
                yield from ((v, t) for v, t in _direct(value) if _reads_as_prose(t))


def _strings(node: ast.AST) -> Iterator[tuple[ast.expr, str]]:
    """Every string in an expression, without those inside of an f-string's values."""
    if isinstance(node, ast.Constant | ast.JoinedStr):
        yield from _direct(node)
    elif not (isinstance(node, ast.Call) and _name(node.func) in IGNORED):
        for child in ast.iter_child_nodes(node):
            yield from _strings(child)


def _direct(node: ast.expr) -> Iterator[tuple[ast.expr, str]]:
    match node:
        case ast.Constant(value=str(text)):
            yield (
                node,
                re.sub(r"\{[\w%]+_[qrt](:\.0)?\}", "…", text),
            )  # the parts in the sentences of exercises/mutation.py
        case ast.JoinedStr(values=values):
            yield node, "".join(str(v.value) if isinstance(v, ast.Constant) else "…" for v in values)
        case ast.IfExp(body=one, orelse=other) | ast.BinOp(left=one, op=ast.Add(), right=other):
            yield from _direct(one)
            yield from _direct(other)


def _name(function: ast.expr) -> str:
    return getattr(function, "id", getattr(function, "attr", ""))


def _is_sentence(text: str) -> bool:
    words = re.search(r"[a-z]{2,}[^a-z]* [^a-z]*[a-z]{2,}", text, re.IGNORECASE)
    return bool(words or _WORD.fullmatch(text)) and not _is_code(text)


def _reads_as_prose(text: str) -> bool:
    """Return whether a string outside a known call is a sentence: three words, or or one with a full stop; no
    code.
    """
    return (len(re.findall(r"\b[a-z]+\b", text)) >= 3 or bool(_WORD.fullmatch(text))) and not _is_code(text)


def _is_code(text: str) -> bool:
    return bool(
        re.search(
            r"\b(SELECT|UPDATE|INSERT|DELETE|WHERE|FROM|CREATE|ALTER|CASE WHEN|EXISTS)\b|\bimport"
            r" \w|^\s*<|def \w+\(|::\w+ |-c \w+="
            r"|\b\w+-src '|^[a-z]+/[a-z.-]+;|^attachment; |\bno-cache\b|\{-?-?[a-z-]+:",
            text,
        )
    )


_WORD = re.compile(r"[A-Z][a-z]+\.")
"""A sentence of one word, such as "Late."."""


class _Text(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_data(self, data: str) -> None:
        self.found.append(data)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found += [
            f"({name}) {value}"
            for name, value in attrs
            if name in ("aria-label", "title", "placeholder", "alt") and value
        ]


def _template(text: str) -> Iterator[str]:
    """The visible text of a Jinja template, a line for each piece between tags; text inside expressions
    counts too.
    """
    quoted = [
        t
        for block in re.findall(r"\{[{%](.*?)[%}]\}", text, re.DOTALL)
        for t in re.findall(r'"([^"]+)"', block)
    ]
    parser = _Text()
    parser.feed(
        re.sub(
            r"\{\{.*?\}\}", "…", re.sub(r"\{%.*?%\}|\{#.*?#\}", " ", text, flags=re.DOTALL), flags=re.DOTALL
        )
    )
    for piece in [*parser.found, *quoted]:
        line = " ".join(piece.split())
        if re.search(r"[A-Za-z]{3,}", line) and not re.search(
            r"^[a-z-]+(\.html)?$|^[a-z_/-]+/|[{};]|^~|~$", line
        ):
            yield line


if __name__ == "__main__":
    FILE.write_text(document(), encoding="utf-8")
