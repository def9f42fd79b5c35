"""The documentation site: ``python -m docs.site`` writes the reference from the code and builds all pages in
.site/html.
"""

import argparse
import ast
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from docs import authored
from exercises.authoring.assignments.catalogue import load_catalogue
from service.app import create_app
from service.cli.__main__ import COMMANDS, add_arguments
from service.settings import Settings

ROOT = Path(__file__).parents[1]
STAGE, BUILT = ROOT / ".site" / "docs", ROOT / ".site" / "html"
BESIDE = {"CHANGELOG.md": "changes.md", "CONTRIBUTING.md": "contributing.md", "SECURITY.md": "security.md"}
BESIDE |= {"CODE_OF_CONDUCT.md": "conduct.md"}
"""Pages of the repository's top folder, with their names on the site."""


def main() -> int:
    """Stage all pages, build the site, and return zensical's exit code."""
    stage(STAGE)
    return subprocess.run(
        [Path(sys.executable).with_name("zensical"), "build", "--clean", "--strict"], cwd=ROOT, check=False
    ).returncode


def stage(folder: Path) -> None:
    """Write every page of the site as Markdown into ``folder``, in place of what is there."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(ROOT / "docs", folder, ignore=shutil.ignore_patterns("pictures.json", "__pycache__"))
    for program in folder.glob("*.py"):
        program.unlink()
    for name, page in BESIDE.items():
        text = (ROOT / name).read_text(encoding="utf-8")
        (folder / page).write_text(re.sub(r"\]\(docs/", "](", text), encoding="utf-8")
    for page in folder.rglob("*.md"):
        page.write_text(_for_the_site(page.read_text(encoding="utf-8")), encoding="utf-8")
    for name, text in reference_pages().items():
        page = folder / "reference" / f"{name}.md"
        page.parent.mkdir(exist_ok=True)
        page.write_text(text, encoding="utf-8")


def _for_the_site(text: str) -> str:
    """Return a page with links to files of the top folder made those of the site, or plain text if they are
    no page.

    In the code of a table's cell, a bar needs a backslash on GitHub and none here.
    """
    for name, page in BESIDE.items():
        text = re.sub(rf"\]\((?:\.\./)*{re.escape(name)}", f"]({page}", text)
    text = re.sub(
        r"(?m)^\|.*$", lambda row: re.sub(r"`[^`]*`", lambda code: code[0].replace("\\|", "|"), row[0]), text
    )
    return re.sub(r"\[([^\]]*)\]\(\.\./(?!(?:\w+/)?[\w-]+\.(?:md|png|svg))[^)]*\)", r"\1", text)


def reference_pages() -> dict[str, str]:
    """Return the text of each generated page by its name."""
    return {
        "cli": cli(),
        "settings": settings(),
        "api": api(),
        "checks": checks(),
        "diagnoses": diagnoses(),
        "physics": modules("The package `reference`", PHYSICS, ROOT / "reference"),
        "kit": modules("The students' kit `polhode`", KIT, ROOT / "exercises/kit/polhode", KIT_MODULES),
        "author": "\n".join(
            ["# The package `exercises.authoring`", "", GENERATED, *authored.lines(text), ""]
        ),
    }


GENERATED = "This page is generated from the code by `make docs`.\n"
PHYSICS = (
    "The physics that polhode compares with: equations, the exact motion, methods and charts, with formulas"
    " and sources."
)
KIT = (
    "What a notebook imports. [For students](../students.md) explains the calls; this page has every"
    " function."
)
KIT_MODULES = (
    *(f"client/{name}" for name in ("local", "remote", "past_submissions", "login", "course")),
    *(f"judging/{name}" for name in ("checks", "claims")),
    "report/figure_parts",
    "animation/animate",
)


def cli() -> str:
    """Return the help of every command and of its subcommands."""
    sections = []
    for name, (_, help) in COMMANDS.items():
        parser = argparse.ArgumentParser(prog=f"polhode {name}", description=help)
        add_arguments(name, parser)
        sections += [
            f"## polhode {name}\n",
            *(f"```text\n{p.format_help()}```\n" for p in _with_subcommands(parser)),
        ]
    return "\n".join(["# Command line", "", GENERATED, *sections])


def _with_subcommands(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for one in action.choices.values():
                yield from _with_subcommands(one)


def settings() -> str:
    """Return the table of all settings."""
    rows = []
    for name, field in Settings.model_fields.items():
        kind = (
            getattr(field.annotation, "__name__", str(field.annotation))
            .replace("typing.", "")
            .replace("pathlib._local.", "")
        )
        default = (
            "number of processors"
            if name == "workers"
            else f"`{field.default}`"
            if field.default != ""
            else ""
        )
        rows.append((f"`POLHODE_{name.upper()}`", f"`{kind}`", default, text(field.description or "")))
    head = "# All settings\n\n" + GENERATED + "\n[Settings](../settings.md) explains each one.\n"
    return f"{head}\n{table(('variable', 'type', 'default', 'meaning'), rows)}"


def api() -> str:
    """Return every route of the JSON API, and the fields of every body."""
    document = create_app(Settings(database_url="postgresql://unused")).openapi()
    parts = ["# JSON API", "", GENERATED, "[HTTP API](../http.md) explains it with examples.", ""]
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            parts += [f"## {method.upper()} {path}", "", text(operation.get("description", "")), ""]
            given = [
                (f"`{p['name']}`", p["in"], _kind(p.get("schema", {})), text(p.get("description", "")))
                for p in operation.get("parameters", ())
            ]
            if given:
                parts += [table(("parameter", "in", "type", "meaning"), given), ""]
            answers = [
                (status, text(answer.get("description", "")), ", ".join(_bodies(answer)))
                for status, answer in operation["responses"].items()
            ]
            parts += [table(("status", "meaning", "body"), answers), ""]
    parts += ["## Bodies", ""]
    for name, schema in document["components"]["schemas"].items():
        required = schema.get("required", ())
        rows = [
            (
                f"`{field}`" + ("" if field in required else "?"),
                _kind(kind),
                text(kind.get("description", "")),
            )
            for field, kind in schema.get("properties", {}).items()
        ]
        parts += [f"### {name}", "", text(schema.get("description", "")), ""]
        parts += [table(("field", "type", "meaning"), rows) if rows else f"One of {_kind(schema)}.", ""]
    return "\n".join(parts)


def _bodies(answer: Mapping[str, Any]) -> Iterator[str]:
    for media, content in answer.get("content", {}).items():
        kind = _kind(content.get("schema", {})) if media.endswith("json") else ""
        yield f"`{media}` {kind}".strip()


def _kind(schema: Mapping[str, Any]) -> str:
    """Return the type of a JSON schema, short, with links to the bodies on this page."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    if options := schema.get("anyOf") or schema.get("oneOf"):
        return " or ".join(_kind(option) for option in options)
    if "enum" in schema or "const" in schema:
        return ", ".join(f"`{json.dumps(value)}`" for value in schema.get("enum", [schema.get("const")]))
    if schema.get("type") == "array":
        return f"list of {_kind(schema.get('items', {}))}"
    return str(schema.get("type", "any"))


def checks() -> str:
    """Return every check of the bundled assignments with its tolerance and the reason."""
    parts = ["# Checks of the bundled assignments", "", GENERATED]
    parts += [
        (
            "A hidden check draws its inputs for each grading. [Checks](../checks.md) explains how they are"
            " computed."
        ),
        "",
    ]
    for assignment in load_catalogue()[0].values():
        parts += [f"## {assignment.slug}: {text(assignment.title)}", ""]
        for exercise in assignment.exercises:
            rows = [
                (
                    f"`{c.id}`",
                    text(c.label),
                    "hidden" if assignment.hidden(c) else "public",
                    _tolerance(c.tolerance),
                    c.points,
                )
                for c in exercise.checks
            ]
            parts += [f"### {assignment.slug} {exercise.number}: {text(exercise.title)}", ""]
            parts += [table(("check", "claim", "inputs", "tolerance and reason", "points"), rows), ""]
    return "\n".join(parts)


def _tolerance(tolerance: Any) -> str:
    numbers = [
        f"{name} {getattr(tolerance, name):g}"
        for name in ("rtol", "atol", "limit")
        if getattr(tolerance, name, None)
    ]
    return text("; ".join([", ".join(numbers), tolerance.reason] if numbers else [tolerance.reason]))


def diagnoses() -> str:
    """Return for each diagnosis code of a declared mistake the sentences that students read,
    by assignment.
    """
    section = (ROOT / "docs/checks.md").read_text(encoding="utf-8").split("\n## Diagnosis codes\n")[1]
    meanings = re.findall(r"^\| `([a-z-]+)` \| (.*) \|$", section, re.MULTILINE)
    sentences: dict[str, list[str]] = {}
    for slug, assignment in load_catalogue()[0].items():
        for question in (q for asked in assignment.questions.values() for q in asked):
            for variant in assignment.variants(question["id"]):
                if variant.declared and variant.code:
                    sentences.setdefault(variant.code, []).append(
                        f"* {slug} {question['id']}: {text(variant.sentence)}"
                    )
    parts = ["# Diagnosis codes by assignment", "", GENERATED]
    parts += ["Below each code are the sentences of the mistakes that an assignment declares.", ""]
    for code, meaning in dict(meanings).items():
        parts += [f"## {code}", "", meaning, "", *sentences.get(code, []), ""]
    return "\n".join(parts)


def author() -> str:
    """Return the public names of authoring, and the methods of what they give."""
    return "\n".join(["# The package `exercises.authoring`", "", GENERATED, *authored.lines(text), ""])


def modules(title: str, about: str, package: Path, names: Sequence[str] | None = None) -> str:
    """Return the public classes and functions of the modules of a package with their docstrings, read without
    importing them.
    """
    every = sorted(path for path in package.rglob("*.py") if not path.stem.startswith("_"))
    files = every if names is None else [package / f"{name}.py" for name in names]
    parts = [f"# {title}", "", GENERATED, about, ""]
    for file in files:
        tree = ast.parse(file.read_text(encoding="utf-8"))
        module = ".".join(file.relative_to(package.parent).with_suffix("").parts)
        parts += [f"## {module}", "", text(ast.get_docstring(tree) or ""), ""]
        for node in tree.body:
            if isinstance(
                node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef
            ) and not node.name.startswith("_"):
                parts += [
                    f"### {node.name}",
                    "",
                    "```python",
                    _signature(node),
                    "```",
                    "",
                    text(ast.get_docstring(node) or ""),
                    "",
                ]
    return "\n".join(parts)


def _signature(node: ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) -> str:
    if not isinstance(node, ast.ClassDef):
        returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
        return f"{node.name}({ast.unparse(node.args)}){returns}"
    fields = [ast.unparse(one) for one in node.body if isinstance(one, ast.AnnAssign)]
    methods = [
        _signature(one) for one in node.body if isinstance(one, ast.FunctionDef) and one.name[0] != "_"
    ]
    return "\n".join([f"class {node.name}", *(f"    {one}" for one in [*fields, *methods])])


def text(plain: str) -> str:
    """Return a docstring or a label as Markdown: its ``code`` as code,
    and no other character with a meaning.
    """
    pieces = re.split(r"(?s)``?(.+?)``?", plain)
    escaped = (re.sub(r"([\\`*_<\[\]|#])", r"\\\1", piece) for piece in pieces[::2])
    code = (f"`{piece}`" for piece in pieces[1::2])
    return "".join(one for pair in zip(escaped, [*code, ""], strict=True) for one in pair)


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return (
        "\n".join("| " + " | ".join(str(cell).replace("\n", " ") for cell in line) + " |" for line in lines)
        + "\n"
    )


if __name__ == "__main__":
    sys.exit(main())
