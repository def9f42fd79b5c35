"""A batch as self-contained HTML pages: a table of files by checks, and a page for each report."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import replace
from html import escape
from pathlib import Path

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.verdict import MARKS
from polhode.report import report_html
from service.grading.graded_file import GradedFile, summary

_STYLE = """
:root{color-scheme:light dark;font:15px/1.5 system-ui,sans-serif;--p:#00674c;--f:#a33c00;--q:#5a5a5a}
@media (prefers-color-scheme:dark){:root{--p:#4fd1a5;--f:#ff9d5c;--q:#a8a8a8}}
body{margin:1.5rem auto;max-width:75rem;padding:0 1rem}
h1{font-size:1.3rem}
.wide{overflow-x:auto}
table{border-collapse:collapse}
th,td{padding:.1rem .45rem;text-align:center;
border-bottom:1px solid color-mix(in srgb,currentColor 20%,transparent)}
th:first-child{text-align:left;white-space:nowrap}
thead th:nth-child(n+3){writing-mode:vertical-rl;font-weight:normal}
td.pass{color:var(--p)}
td.fail{color:var(--f)}
td.unmeasured{color:var(--q)}
td.none{text-align:left}
img.sweep{filter:none;width:100%;max-width:36rem}
pre{overflow-x:auto}
"""


def index(files: Sequence[GradedFile], assignment: Assignment, pages: Mapping[Path, str]) -> str:
    """Return the overview page: a table of files by checks, with a link to each file's page."""
    made = {outcome.id for file in files if file.report for outcome in file.report.outcomes()}
    checks = [check for check in assignment.checks() if check.id in made]
    heads = "".join(
        f'<th scope="col" title="{escape(check.label)}">{escape(check.id)}</th>' for check in checks
    )
    rows = "\n".join(_row(file, [check.id for check in checks], pages[file.file]) for file in files)
    head = f'<thead><tr><th scope="col">file</th><th scope="col">points</th>{heads}</tr></thead>'
    table = f"<table>{head}\n<tbody>{rows}</tbody></table>"
    legend = "✓ pass · ✗ fail · – unmeasured (the report gives the reason) · blank: not attempted"
    return _page(
        assignment.title,
        f'<p>{escape(summary(files))}</p><div class="wide">{table}</div><p><small>{legend}</small></p>',
    )


def page(file: GradedFile) -> str:
    """Return the page of one file's report with its pictures."""
    if file.report is None:
        return _page(str(file.file), f"<p>{escape(file.why)}</p>")
    report = replace(
        file.report, drawn=lambda name: file.pictures.get(f"{name}.svg") or file.pictures.get(f"{name}.png")
    )
    printed = (
        f"<details><summary>Printed output</summary><pre>{escape(report.stdout)}</pre></details>"
        if report.stdout
        else ""
    )
    provenance = (
        f"<p><small>seed {report.provenance.seed}, isolation"
        f" {escape(report.provenance.isolation)}</small></p>"
    )
    return _page(
        str(file.file),
        report_html.html(report)
        + _speed(file)
        + printed
        + provenance
        + '<p><a href="../index.html">All files</a></p>',
    )


def _speed(file: GradedFile) -> str:
    """Return the card of speed against accuracy, if it was measured."""
    swept = file.report.sweep if file.report else None
    if swept is None:
        return ""
    drawn = file.pictures.get("sweep.svg")
    image = (
        f'<img class="sweep" src="data:image/svg+xml;base64,{base64.b64encode(drawn).decode()}"'
        ' alt="Error against milliseconds on this machine: the function and, dashed, the solution.">'
        if drawn
        else ""
    )
    told = "".join(f"<li>{escape(sentence)}</li>" for sentence in swept.line.split("; "))
    return f"<h2>Speed vs accuracy</h2>{image}<ul>{told}</ul>"


def _row(file: GradedFile, checks: Sequence[str], address: str) -> str:
    name = f'<th scope="row"><a href="{escape(address)}">{escape(str(file.file))}</a></th>'
    if file.report is None:
        points = "" if file.points is None else file.points
        return (
            f'<tr>{name}<td>{points}</td><td class="none"'
            f' colspan="{len(checks)}">{escape(file.why)}</td></tr>'
        )
    verdicts = {outcome.id: outcome.verdict for outcome in file.report.outcomes()}
    cells = [
        f'<td class="{v.value}">{MARKS[v]}</td>' if (v := verdicts.get(id)) else "<td></td>" for id in checks
    ]
    return f"<tr>{name}<td>{file.report.score} of {file.report.out_of}</td>{''.join(cells)}</tr>"


def _page(title: str, body: str) -> str:
    head = '<meta charset="utf-8"><meta name="viewport" content="width=device-width">'
    head += f"<title>{escape(title)}</title><style>{_STYLE}</style>"
    body = f"<h1>{escape(title)}</h1>{body}"
    return f'<!doctype html>\n<html lang="en"><head>{head}</head><body>{body}</body></html>\n'
