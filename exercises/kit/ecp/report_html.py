"""A report as HTML: causes and lines, which the web page shows too, and for a notebook figures and the graded
source. Colours there follow the themes of JupyterLab, VS Code and Colab.
"""

import base64
import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from html import escape

from ecp import grouped
from ecp.errors import RequestError
from ecp.grouped import Cause
from ecp.judge import Verdict
from ecp.outcome import Diagnosis, ExerciseReport, Outcome, Picture
from ecp.report import OWN_CHECKS, Report, no_picture

MOST_LINKS = 3  # of the checks of an exercise that are listed with a cause
# Light by default; dark if the front end (JupyterLab, VS Code, Colab) says so, or if it says nothing and the
# system is dark. VS Code's light theme of high contrast has the class of the dark one too.
# ":not(#_)" raises the specificity above JupyterLab's own rules for outputs.
_DARK = "{--p:#4fd1a5;--f:#ff9d5c;--q:#a8a8a8;--chart:invert(.9) hue-rotate(180deg)}"
_STYLE = (
    """
.polhode:not(#_){--p:#00674c;--f:#a33c00;--q:#5a5a5a;
font:14px/1.5 var(--jp-ui-font-family,system-ui,sans-serif);
color:var(--jp-ui-font-color1,var(--vscode-editor-foreground,inherit));
ul{list-style:none;padding:0;margin:.2em 0}
ol{padding:0 0 0 1.6em;margin:.2em 0}
li{margin:0 0 .15em}
h4{margin:.6em 0 .2em;font-size:1em;font-weight:600}
code{font:.93em/1.5 var(--jp-code-font-family,ui-monospace,monospace);white-space:pre-wrap;
background:none;padding:0;color:inherit}
.line{display:block;padding-left:3ch;text-indent:-3ch;white-space:pre-wrap}
.line{font:.93em/1.5 var(--jp-code-font-family,ui-monospace,monospace)}
.pass>.line{color:var(--p)}
.fail>.line{color:var(--f)}
.unmeasured>.line,.quiet,.badge,small,figcaption{color:var(--q)}
.badge{margin-left:2em;font-size:.85em}
p{margin:0 0 0 2em}
figure{margin:.6em 0}
img{max-width:100%;background:#fff}
img[src^="data:image/svg"]{filter:var(--chart,none)}
pre{overflow-x:auto;color:inherit}
td,th{text-align:left;vertical-align:top}}
"""
    + f"""
:is([data-jp-theme-light="false"],.vscode-dark,.vscode-high-contrast:not(.vscode-high-contrast-light),
html[theme="dark"]) .polhode:not(#_){_DARK}
@media (prefers-color-scheme:dark){{
:root:not([theme],:has([data-jp-theme-light],body[class*="vscode-"])) .polhode:not(#_){_DARK}}}
"""
)


def show(report: Report) -> None:
    """Display the report's lines in IPython, then one picture after the other, each as soon as it is drawn or
    fetched.

    Raises NotImplementedError in a terminal, where IPython then shows the ``repr``. If the server sends no
    pictures, one line stands for all that are missing.
    """
    from IPython import get_ipython
    from IPython.display import display

    def put(text: str, markup: str) -> None:
        display({"text/plain": text, "text/html": markup}, raw=True)

    if "text/html" not in get_ipython().display_formatter.active_types:
        raise NotImplementedError
    put(report.lines(), html(replace(report, drawn=no_picture)))
    pictures = [picture for exercise in report.exercises for picture in _pictures(report, exercise)]
    for number, picture in enumerate(pictures):
        content = _drawn(report, picture)
        if isinstance(content, RequestError) and getattr(content, "status", None) != 404:
            missing = f"{len(pictures) - number} of {len(pictures)} pictures are missing: {content}"
            put(missing, fragment(f"<p>{escape(missing)}</p>"))
            return
        if content is not None:
            placed = replace(picture, title=f"Exercise {picture.exercise}. {picture.title}")
            put(_text(placed, content), fragment(_picture(placed, content)))


def html(report: Report) -> str:
    """Return the report with its pictures as one self-contained HTML fragment."""
    causes = report.causes()
    parts = []
    if causes:
        head = grouped.header(causes)
        parts.append(f"{f'<h4>{escape(head)}</h4>' if head else ''}{cause_list(causes)}")
    parts += [_exercise(report, e, grouped.numbers(causes)) for e in report.exercises if e.outcomes]
    if report.notebook_checks:
        lines = [item(check.verdict, check.line, [check.cell]) for check in report.notebook_checks]
        parts.append(f"<h4>{escape(OWN_CHECKS)}</h4><ul>{''.join(lines)}</ul>")
    parts += [
        f"<details open><summary>{escape(e.scene)}:"
        f" {escape(e.sentence)}</summary><pre>{escape(e.traceback or '')}</pre></details>"
        for e in report.stops()
    ]
    parts.append(f"<small>{escape(report.summary())}. {escape(report.remark)}{_page(report)}</small>")
    if report.sent is not None:
        parts.append(_sent(report))
    return fragment("".join(parts))


def fragment(inner: str) -> str:
    """Return HTML in the kit's style."""
    return f'<div class="polhode"><style>{_STYLE}</style>{inner}</div>'


def cause_list(causes: Iterable[Cause], *, links: bool = False) -> str:
    """Return the causes as a list. With ``links`` each is an anchor, and its checks are links, folded if
    there are many.
    """
    items = []
    for cause in causes:
        below = ""
        for number, outcomes in cause.explains.items():
            labels = [_link(f"#check-{o.id}", o.label, links) for o in outcomes]
            where, listed = f"exercise {escape(number)}", "; ".join(labels)
            if links and len(labels) > MOST_LINKS:
                below += (
                    f'<details class="more"><summary>{where}: {len(labels)}'
                    f" checks</summary><p>{listed}</p></details> "
                )
            else:
                below += f'<p class="quiet">{where}: {listed}</p>'
        anchor = f' id="cause-{cause.number}"' if links else ""
        raised = f"<p><code>{escape(cause.raised_at)}</code></p>" if cause.raised_at else ""
        items.append(f"<li{anchor}>{cause.likely}{_diagnosis(cause.diagnosis)}{raised}{below}</li>")
    return f"<ol>{''.join(items)}</ol>"


def outcome_item(
    outcome: Outcome, numbers: Mapping[str, int], *, links: bool = False, staff: str = ""
) -> str:
    """Return the outcome as a list item: line, badges, notes, likely causes and hints.

    ``numbers`` maps sentences of causes at the top of the report to their numbers, which then stand for them.
    With ``links`` it is an anchor, has links to those causes, and its notes are folded. ``staff`` is a remark
    for the staff, who also see whether the check is hidden.
    """
    badges = (
        [f"{outcome.earned} of {outcome.points} points"] if outcome.counted and outcome.points > 1 else []
    )
    badges += ["hidden"] if staff and outcome.hidden else []
    badges += (
        ["self-reported, no points"] if outcome.self_reported else [] if outcome.counted else ["not counted"]
    )
    notes = [escape(note) for note in [*outcome.notes(), *([staff] if staff else [])]]
    below = [] if links else notes
    for d in outcome.causes():
        number = numbers.get(d.sentence)
        above = _link(f"#cause-{number}", f"cause {number}", links)
        below.append(f"likely {_diagnosis(d)}" if number is None else f"{above}: <b>{escape(d.code)}</b>")
    below += [f"hint: {escape(hint)}" for hint in outcome.hints]
    text = _folded(notes) if links else ""
    text += "".join(f"<p>{one}</p>" for one in below)
    return item(
        outcome.verdict, outcome.line_below(numbers), badges, text, f"check-{outcome.id}" if links else ""
    )


def item(verdict: Verdict, line: str, badges: Iterable[str], below: str = "", anchor: str = "") -> str:
    """Return a ✓/✗ line as a list item with its badges, and HTML ``below`` it."""
    id = f' id="{escape(anchor)}"' if anchor else ""
    shown = "".join(f' <span class="badge">{escape(badge)}</span>' for badge in badges)
    return f'<li class="{verdict.value}"{id}><span class="line">{escape(line)}</span>{shown}{below}</li>'


def _folded(notes: Iterable[str]) -> str:
    shown = "".join(f"<p>{note}</p>" for note in notes)
    return f' <details class="more"><summary>details</summary>{shown}</details>' if shown else ""


def _diagnosis(diagnosis: Diagnosis) -> str:
    return f"<b>{escape(diagnosis.code)}</b>: {escape(diagnosis.sentence)}"


def _link(address: str, text: str, links: bool) -> str:
    return f'<a href="{escape(address)}">{escape(text)}</a>' if links else escape(text)


def _exercise(report: Report, exercise: ExerciseReport, numbers: Mapping[str, int]) -> str:
    items = [outcome_item(outcome, numbers) for outcome in exercise.outcomes]
    shown = "".join(_picture(picture, _drawn(report, picture)) for picture in _pictures(report, exercise))
    return (
        f"<h4>Exercise {escape(exercise.number)}."
        f" {escape(exercise.title)}</h4><ul>{''.join(items)}</ul>{shown}"
    )


def _pictures(report: Report, exercise: ExerciseReport) -> list[Picture]:
    return [p for p in [*report.animations, *report.figures] if p.exercise == exercise.number]


def _drawn(report: Report, picture: Picture) -> bytes | Exception | None:
    """Return the picture, None if there is none, or why it could not be drawn or fetched."""
    try:
        return report.drawn(picture.name)
    except Exception as error:
        return error


def _picture(picture: Picture, content: bytes | Exception | None) -> str:
    if content is None:
        return ""
    if isinstance(content, Exception):
        return f"<p>{escape(_text(picture, content))}</p>"
    kind = "png" if content.startswith(b"\x89PNG") else "svg+xml"
    data = f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
    caption = escape(picture.title)
    return (
        f'<figure><img src="{data}"'
        f' alt="{escape(picture.alt, quote=True)}"><figcaption>{caption}</figcaption></figure>'
    )


def _text(picture: Picture, content: bytes | Exception) -> str:
    """Return what stands for the picture in text: its description, or why it is missing."""
    return (
        f"{picture.title} is missing: {content}"
        if isinstance(content, Exception)
        else f"{picture.title}: {picture.alt}"
    )


def _page(report: Report) -> str:
    if report.address is None:
        return ""
    return (
        f' <a href="{escape(report.address, quote=True)}" target="_blank" rel="noopener">View on the'
        " server</a>"
    )


def _sent(report: Report) -> str:
    bundle = report.sent
    left = "".join(f"<p>{escape(item.name)}: {escape(item.sentence)}</p>" for item in bundle.left_out)
    title = f"Graded source (SHA-256 {bundle.sha256[:16]}…)"
    code = escape(_code(bundle.source))
    return f"{left}<details><summary>{title}</summary><pre><code>{code}</code></pre></details>"


def _code(source: str) -> str:
    """Return the source for display: of a notebook its code cells."""
    try:
        cells = [cell["source"] for cell in json.loads(source)["cells"] if cell["cell_type"] == "code"]
    except (ValueError, LookupError, TypeError):
        return source
    return "\n\n".join(f"# cell {number}\n{''.join(cell)}" for number, cell in enumerate(cells, start=1))
