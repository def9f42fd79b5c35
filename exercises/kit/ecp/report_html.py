"""A report as HTML in a notebook: causes, lines, figures and the graded source. Colours follow JupyterLab's
and VS Code's themes.
"""

import base64
import json
from collections.abc import Mapping
from html import escape

from ecp import grouped
from ecp.grouped import Cause
from ecp.outcome import ExerciseReport, Outcome, Picture
from ecp.report import OWN_CHECKS, Report

# Light by default; dark if the front end says so, or if it says nothing and the system is dark.
# ":not(#_)" raises the specificity above JupyterLab's own rules for outputs.
_DARK = "{--p:#4fd1a5;--f:#ff9d5c;--q:#a8a8a8}"
_STYLE = (
    """
.polhode:not(#_){--p:#00674c;--f:#a33c00;--q:#5a5a5a;font:14px/1.5 var(--jp-ui-font-family,system-ui,sans-serif);
color:var(--jp-ui-font-color1,var(--vscode-editor-foreground,inherit));
ul{list-style:none;padding:0;margin:.2em 0}
ol{padding:0 0 0 1.6em;margin:.2em 0}
li{margin:0 0 .15em}
h4{margin:.6em 0 .2em;font-size:1em;font-weight:600}
code{font:.93em/1.5 var(--jp-code-font-family,ui-monospace,monospace);white-space:pre-wrap;background:none;padding:0;color:inherit}
li>code{display:block;padding-left:3ch;text-indent:-3ch}
.pass>code{color:var(--p)}
.fail>code{color:var(--f)}
.unmeasured>code,small,figcaption{color:var(--q)}
p{margin:0 0 0 2em}
figure{margin:.6em 0}
img{max-width:100%;background:#fff}
pre{overflow-x:auto;color:inherit}
td,th{text-align:left;vertical-align:top}}
"""
    + f"""
:is([data-jp-theme-light="false"],.vscode-dark,.vscode-high-contrast) .polhode:not(#_){_DARK}
@media (prefers-color-scheme:dark){{:root:not(:has([data-jp-theme-light],.vscode-light)) .polhode:not(#_){_DARK}}}
"""
)


def html(report: Report) -> str:
    """Return the report as one self-contained HTML fragment."""
    causes = report.causes()
    parts = [_causes(causes)] if causes else []
    parts += [_exercise(report, e, grouped.numbers(causes)) for e in report.exercises if e.outcomes]
    if report.notebook_checks:
        lines = [f'<li class="{c.verdict.value}"><code>{escape(c.line)}</code></li>' for c in report.notebook_checks]
        parts.append(f"<h4>{escape(OWN_CHECKS)}</h4><ul>{''.join(lines)}</ul>")
    parts += [
        f"<details open><summary>{escape(e.scene)}: {escape(e.sentence)}</summary><pre>{escape(e.traceback)}</pre></details>"
        for e in report.scene_ends
        if e.traceback
    ]
    parts.append(f"<small>{escape(report.summary())}. {escape(report.remark)}{_link(report)}</small>")
    if report.sent is not None:
        parts.append(_sent(report))
    return fragment("".join(parts))


def fragment(inner: str) -> str:
    """Return HTML in the kit's style."""
    return f'<div class="polhode"><style>{_STYLE}</style>{inner}</div>'


def _causes(causes: list[Cause]) -> str:
    items = [
        f"<li>{cause.likely}<b>{escape(cause.diagnosis.code)}</b>: {escape(cause.diagnosis.sentence)}"
        f"{''.join(f'<p><small>{escape(where)}</small></p>' for where in cause.where())}</li>"
        for cause in causes
    ]
    head = grouped.header(causes)
    return f"{f'<h4>{escape(head)}</h4>' if head else ''}<ol>{''.join(items)}</ol>"


def _exercise(report: Report, exercise: ExerciseReport, numbers: Mapping[str, int]) -> str:
    items = [_outcome(outcome, numbers) for outcome in exercise.outcomes]
    pictures = [p for p in [*report.animations, *report.figures] if p.exercise == exercise.number]
    shown = "".join(_picture(report, picture) for picture in pictures)
    return f"<h4>Exercise {escape(exercise.number)}. {escape(exercise.title)}</h4><ul>{''.join(items)}</ul>{shown}"


def _outcome(outcome: Outcome, numbers: Mapping[str, int]) -> str:
    notes = outcome.notes() + [f"hint: {hint}" for hint in outcome.hints]
    below = [f"<p>{escape(note)}</p>" for note in notes]
    below += [
        f"<p>cause {numbers[d.sentence]}: <b>{escape(d.code)}</b></p>"
        if d.sentence in numbers
        else f"<p>likely <b>{escape(d.code)}</b>: {escape(d.sentence)}</p>"
        for d in outcome.causes()
    ]
    worth = f"<small>{outcome.earned} of {outcome.points} points</small>" if outcome.points > 1 else ""
    return f'<li class="{outcome.verdict.value}"><code>{escape(outcome.line)}</code>{worth}{"".join(below)}</li>'


def _picture(report: Report, picture: Picture) -> str:
    content = report.drawn(picture.name)
    if content is None:
        return ""
    kind = "png" if content.startswith(b"\x89PNG") else "svg+xml"
    data = f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
    caption = escape(picture.title)
    return f'<figure><img src="{data}" alt="{escape(picture.alt, quote=True)}"><figcaption>{caption}</figcaption></figure>'


def _link(report: Report) -> str:
    if report.address is None:
        return ""
    return f' <a href="{escape(report.address, quote=True)}" target="_blank" rel="noopener">View on the server</a>'


def _sent(report: Report) -> str:
    bundle = report.sent
    left = "".join(f"<p>{escape(item.name)}: {escape(item.sentence)}</p>" for item in bundle.left_out)
    title = f"Graded source (SHA-256 {bundle.sha256[:16]}…)"
    code = escape(_code(bundle.source, bundle.filename))
    return f"{left}<details><summary>{title}</summary><pre><code>{code}</code></pre></details>"


def _code(source: str, filename: str) -> str:
    """Return the source for display: of a notebook its code cells."""
    if not filename.endswith(".ipynb"):
        return source
    try:
        cells = [cell["source"] for cell in json.loads(source)["cells"] if cell["cell_type"] == "code"]
    except (ValueError, LookupError, TypeError):
        return source
    return "\n\n".join(f"# cell {number}\n{''.join(cell)}" for number, cell in enumerate(cells, start=1))
