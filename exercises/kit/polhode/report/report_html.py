"""A report as HTML: causes and checks, which the web page shows too, and for a notebook figures and the
graded source.
"""

import base64
import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from html import escape

from polhode.client.errors import RequestError
from polhode.judging.outcome import SELF_REPORTED, Diagnosis, ExerciseReport, Outcome, Picture
from polhode.judging.verdict import MARKS, Verdict
from polhode.report.failure_causes import FIRST, LOOK, NEXT, Cause
from polhode.report.report import OWN_CHECKS, Report, no_picture
from polhode.report.report_overview import Overview, Section
from polhode.report.report_style import fragment
from polhode.report.student_line import StudentLine


def show(report: Report) -> None:
    """Display the report in IPython at once, and again with its pictures when they are drawn or fetched.

    Raises NotImplementedError in a terminal, where IPython then shows the ``repr``. If the server sends no
    pictures, one line stands for all that are missing.
    """
    from IPython import get_ipython
    from IPython.display import display

    if "text/html" not in get_ipython().display_formatter.active_types:
        raise NotImplementedError
    bare = replace(report, drawn=no_picture)
    shown = display({"text/plain": report.lines(), "text/html": html(bare)}, raw=True, display_id=True)
    pictures = [picture for exercise in report.exercises for picture in _pictures(report, exercise)]
    found: dict[str, bytes | Exception | None] = {}
    missing = ""
    for number, picture in enumerate(pictures):
        content = _drawn(report, picture)
        if isinstance(content, RequestError) and getattr(content, "status", None) != 404:
            missing = f"{len(pictures) - number} of {len(pictures)} pictures are missing: {content}"
            break
        found[picture.name] = content
    texts = [_text(picture, content) for picture in pictures if (content := found.get(picture.name))]
    if texts or missing:
        plain = "\n".join(filter(None, [report.lines(), *texts, missing]))
        shown.update({"text/plain": plain, "text/html": _html(report, found, missing)}, raw=True)


def html(report: Report) -> str:
    """Return the report with its pictures as one self-contained HTML fragment."""
    pictures = [picture for exercise in report.exercises for picture in _pictures(report, exercise)]
    return _html(report, {picture.name: _drawn(report, picture) for picture in pictures})


def _html(report: Report, drawn: Mapping[str, bytes | Exception | None], missing: str = "") -> str:
    seen = report.overview()
    first, *others = [cause_block(cause) for cause in seen.causes] or [""]
    parts = [f"<h4>{FIRST}</h4>{first}" if first else ""]
    if seen.unexplained is not None:
        parts.append(f"<h4>{LOOK}</h4>{failure_block(seen.unexplained)}")
    if others:
        items = "".join(f"<li>{one}</li>" for one in others)
        parts.append(f'<h4>{NEXT}</h4><ol start="2">{items}</ol>')
    parts += [_section(report, section, seen, drawn) for section in seen.sections]
    if report.notebook_checks:
        checks = report.notebook_checks
        lines = "".join(item(one.verdict, one.label, one.detail, [one.cell]) for one in checks)
        parts.append(f'<h4>{escape(OWN_CHECKS)}</h4><ul class="outcomes">{lines}</ul>')
    parts += [
        f"<details open><summary>{escape(e.scene)}:"
        f" {escape(e.sentence)}</summary><pre>{escape(e.traceback or '')}</pre></details>"
        for e in report.stops()
    ]
    parts.append(f"<p>{escape(missing)}</p>" if missing else "")
    parts.append(f"<small>{escape(report.summary())}. {escape(report.remark)}{_page(report)}</small>")
    if report.sent is not None:
        parts.append(_sent(report))
    return fragment("".join(parts))


def cause_block(cause: Cause, *, source: str = "", links: bool = False) -> str:
    """Return a cause: its sentence, the student's line, and small its code, what it explains and the numbers.

    ``source`` is the address of the line. With ``links`` the checks that it explains are links, folded.
    """
    worst = f". Worst at {escape(cause.worst)}" if cause.worst else ""
    code, extent = f"<code>{escape(cause.code)}</code>", escape(cause.extent)
    said = f"{code}{worst}" if links else f"{code}: {extent}{worst}"
    parts = [f'<p class="sentence">{escape(cause.diagnosis.sentence)}</p>']
    parts += [_quote(cause.line, source)] if cause.line else []
    parts.append(f'<p class="quiet">{said}</p>')
    parts += [_folded(extent, _checks(cause))] if links else []
    parts += [_folded("traceback", f"<pre>{escape(frames)}</pre>")] if (frames := cause.frames()) else []
    return "".join(parts)


def failure_block(outcome: Outcome) -> str:
    """Return an outcome that no known cause explains: its label, and small what was measured, and where."""
    measured, allowed = outcome.measured_and_allowed()
    numbers = f"{measured}, allowed: {allowed}" if allowed else measured
    said = f". Worst at {outcome.where}" if outcome.where else ""
    said += ". No known mistake gives these numbers." if outcome.verdict is Verdict.FAIL else ""
    label = f'<p class="sentence">{MARKS[outcome.verdict]} {escape(outcome.label)}</p>'
    return f'{label}<p class="quiet"><code>{escape(numbers)}</code>{escape(said)}</p>'


def _quote(line: StudentLine, source: str) -> str:
    """Return a line of the student's source with its place, a link if ``source`` is an address."""
    place = _link(source, line.place) if source else escape(line.place)
    before, about, after = map(escape, line.parts())
    code = f"\n<code>{before}<mark>{about}</mark>{after}</code>" if line.text else ""
    return f'<p class="quote"><span class="quiet">{place}</span>{code}</p>'


def _checks(cause: Cause) -> str:
    """Return links to the checks that a cause explains, a paragraph for each exercise."""
    paragraphs = []
    for number, outcomes in cause.explains.items():
        listed = "; ".join(_link(f"#check-{o.id}", o.label) for o in outcomes)
        paragraphs.append(f"<p>exercise {escape(number)}: {listed}</p>")
    return "".join(paragraphs)


def _folded(title: str, inner: str) -> str:
    return f'<details class="more"><summary>{title}</summary>{inner}</details>'


def outcome_item(outcome: Outcome, seen: Overview, *, links: bool = False, staff: str = "") -> str:
    """Return the outcome as a list item: mark, label with badges, what was measured and is allowed, folded
    notes, other likely causes and hints.

    With ``links`` it is an anchor and has links to its causes. ``staff`` is a remark for the staff, who also
    see whether the check is hidden.
    """
    shown = [escape(badge) for badge in _badges(outcome, for_staff=bool(staff))]
    for cause in seen.references(outcome):
        name = f"cause {cause.number}"
        shown.append(_link(f"#cause-{cause.number}", name) if links else name)
    notes = "".join(f"<p>{escape(note)}</p>" for note in [*seen.notes(outcome), *([staff] if staff else [])])
    more = _folded("details", notes) if notes else ""
    stated = {cause.diagnosis.sentence for cause in seen.causes}
    below = [f"likely {_diagnosis(d)}" for d in outcome.causes() if d.sentence not in stated]
    below += [f"hint: {escape(hint)}" for hint in outcome.hints]
    more += "".join(f'<p class="below">{one}</p>' for one in below)
    row = _row(outcome.verdict, outcome.label, seen.measured_and_allowed(outcome), shown)
    anchor = f' id="check-{escape(outcome.id)}"' if links else ""
    return f'<li class="{outcome.verdict.value}"{anchor}>{row}{more}</li>'


def item(verdict: Verdict, label: str, detail: str, badges: Iterable[str]) -> str:
    """Return a line of the notebook's own checks as a list item with its badges."""
    row = _row(verdict, label, (detail, ""), map(escape, badges))
    return f'<li class="{verdict.value}">{row}</li>'


def _badges(outcome: Outcome, *, for_staff: bool) -> list[str]:
    """Return what is special about an outcome, each in a few words."""
    worth = outcome.counted and outcome.points > 1
    found = [f"{outcome.earned} of {outcome.points} points"] if worth else []
    found += ["hidden"] if for_staff and outcome.hidden else []
    found += ["bonus"] if outcome.bonus else []
    if outcome.self_reported:
        return [*found, SELF_REPORTED]
    return found if outcome.counted else [*found, "no points"]


def _row(verdict: Verdict, label: str, found: tuple[str, str], badges: Iterable[str]) -> str:
    """Return mark, label with badges, and what was ``found`` and is allowed."""
    shown = "".join(f' <span class="badge">{badge}</span>' for badge in badges)
    measured, allowed = map(escape, found)
    words = "" if allowed else " words"
    parts = [
        f'<span class="mark">{MARKS[verdict]}</span>',
        f'<span class="name">{escape(label)}{shown}</span>',
        f'<span class="got{words}">{measured}</span>',
        f'<span class="allowed">{allowed}</span>' if allowed else "",
    ]
    return " ".join(parts)


def _diagnosis(diagnosis: Diagnosis) -> str:
    return f"{escape(diagnosis.sentence)} <code>{escape(diagnosis.code)}</code>"


def _link(address: str, text: str) -> str:
    return f'<a href="{escape(address)}">{escape(text)}</a>'


def _section(
    report: Report, section: Section, seen: Overview, drawn: Mapping[str, bytes | Exception | None]
) -> str:
    """Return a section, folded if every check is ✓ or an exercise before shows the cause."""
    several, inner = len(section.exercises) > 1, ""
    for exercise in section.exercises:
        inner += f"<h5>{escape(exercise.heading)}</h5>" if several else ""
        inner += f'<ul class="outcomes">{"".join(outcome_item(o, seen) for o in exercise.outcomes)}</ul>'
        inner += "".join(
            _picture(picture, drawn.get(picture.name)) for picture in _pictures(report, exercise)
        )
    verdict = Verdict.PASS if section.passed else Verdict.FAIL
    opened = "" if section.passed or section.causes else " open"
    mark = f'<span class="mark">{MARKS[verdict]}</span>'
    title = f"{mark} <b>{escape(section.heading)}</b> <small>{escape(section.points)}</small>"
    return f'<details{opened}><summary class="{verdict.value}">{title}</summary>{inner}</details>'


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
