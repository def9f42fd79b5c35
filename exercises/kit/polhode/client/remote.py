"""``polhode.submit``: collect the code, send it, wait for the report and return it."""

import contextlib
import json
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from polhode.client import course, public_assignment
from polhode.client.errors import NotebookError
from polhode.client.login import JSON
from polhode.client.progress import Line
from polhode.client.server_status import local_time, outdated
from polhode.client.tokens import authorization
from polhode.client.transport.http import CONTACT_S, Event, RequestError, call, events
from polhode.judging.return_value import is_empty
from polhode.notebook.gather import Bundle, CannotSend, gather, whole_notebook
from polhode.notebook.strip_outputs import is_notebook, strip_outputs
from polhode.report.dataclass_json import NotADocument, read
from polhode.report.report import Report

PATIENCE_S = 300.0  # with a server that stored the submission: it may restart meanwhile
REPEATED = (
    "Not submitted again: your submission of {} has the same code, and this is its report. again=True"
    " submits it."
)
PICTURE_S = 5.0  # patience with a server that fails to send a picture


class NotGraded(NotebookError):
    """The submission has no report. The message gives the reason and the address where the report will be."""


def submit(
    *functions: Any,
    file: str | Path | None = None,
    exercises: str | int | Sequence[str | int] | None = None,
    server: str | None = None,
    assignment: str | None = None,
    again: bool = False,
) -> Report | None:
    """Submit functions with everything they need, or a ``.py`` or ``.ipynb`` file, or by default all code of
    this notebook.

    Waits for the report and returns it; its pictures are fetched when it is displayed. ``exercises`` are the
    numbers to grade (default: those the submission attempts). ``server`` and ``assignment`` default to those
    of ``polhode.connect``. Functions that are still empty are not sent; returns None if all are empty. If
    your last submission was the same, its report is returned and nothing is submitted, unless ``again`` is
    true. Raises CannotSend, UnknownCourse, Unreachable or HTTPError if nothing was submitted, and NotGraded
    if the submission has no report.
    """
    slug = course.assignment(assignment)
    where = course.server(server, slug)
    empty = [f.__name__ for f in functions if is_empty(f)]
    if functions and len(empty) == len(functions):
        one, several = (
            "has no code yet. Write it, run its cell,",
            "have no code yet. Write them, run their cells,",
        )
        names = ", ".join(f"`{name}`" for name in empty)
        print(f"Nothing was submitted: {names} {several if len(empty) > 1 else one} and submit again.")
        return None
    sent = _bundle([f for f in functions if not is_empty(f)], file, slug)
    body: dict[str, Any] = {"source": sent.source, "filename": sent.filename}
    if exercises is not None:
        body["exercises"] = [
            str(number) for number in ([exercises] if isinstance(exercises, str | int) else exercises)
        ]
    line, headers = Line(), authorization(where)
    accepted = _post(f"{where}/v1/assignments/{slug}/submissions", body, headers, line, again)
    repeated = bool(accepted.get("repeated"))
    page = f"{where}/submissions/{accepted['id']}"
    with _final_text_on_error(line, f"submitted, see {page}"):
        url, remark = f"{where}/v1/submissions/{accepted['id']}", outdated(where, slug)
        report = _report(_wait(url, headers, line, page), page)
    report.sent, report.address, report.drawn = sent, page, cache(_fetcher(report, url, headers))
    remarks = [REPEATED.format(local_time(accepted["submitted_at"]))] if repeated else []
    remarks += [
        f"Not sent, still empty: {', '.join(empty)}." if empty else "",
        "Late." if accepted["late"] else "",
    ]
    remarks.append(
        ""
        if accepted.get("sha256") == sent.sha256
        else "The server graded a different text than the one sent."
    )
    report.remark = " ".join(filter(None, [*remarks, remark]))
    late = " late" if accepted["late"] else ""
    line.end(f"{'not submitted again' if repeated else f'submitted{late} and graded'}: {report.summary()}")
    return report


def _bundle(functions: list[Any], file: str | Path | None, slug: str) -> Bundle:
    if file is None:
        wanted = public_assignment.functions(slug)
        sent = gather(*functions) if functions else whole_notebook()
        if wanted and not wanted & set(sent.names):
            known = f"the functions of {slug} ({', '.join(sorted(wanted))})"
            if not functions:
                raise CannotSend(
                    f"Nothing was submitted: this notebook defines none of {known}. Run the cells that define"
                    " them."
                )
            given = ", ".join(f"`{name}`" for name in sent.names) + (" are" if len(sent.names) > 1 else " is")
            raise CannotSend(
                f"Nothing was submitted: {given} not among {known}. Submit one or more of those."
            )
        return sent
    if functions:
        raise CannotSend("Submit either functions or a file, not both: nothing was submitted.")
    path = Path(file)
    try:
        text = path.read_bytes().decode("utf-8-sig").lstrip("\ufeff")
    except (OSError, UnicodeDecodeError) as error:
        raise CannotSend(f"{path} cannot be read ({error}): nothing was submitted.") from None
    if is_notebook(text, path.name):
        with contextlib.suppress(ValueError):  # the server reports what is wrong with it
            text = strip_outputs(text)
    return Bundle(text, filename=path.name)


def _post(
    url: str, body: dict[str, Any], headers: Mapping[str, str], line: Line, again: bool
) -> dict[str, Any]:
    """Send the submission and return the server's answer once it is stored. Retries do not submit twice."""
    line.show("submitting …")
    with _final_text_on_error(line, "not submitted"):
        once = {**JSON, **headers, "Idempotency-Key": str(uuid.uuid4())} | (
            {} if again else {"Prefer": "no-repeat"}
        )
        accepted: dict[str, Any] = call(
            "POST", url, body=json.dumps(body).encode(), headers=once, patience=CONTACT_S
        ).json()
    return accepted


def _report(document: dict[str, Any], page: str) -> Report:
    try:
        return read(Report, document["report"])
    except NotADocument as error:
        raise NotGraded(
            f"This kit cannot read the report ({error}): reinstall the kit. The report is at {page}"
        ) from None


def _wait(url: str, headers: Mapping[str, str], line: Line, page: str) -> dict[str, Any]:
    try:
        for event in events(f"{url}/events", headers=headers, patience=PATIENCE_S):
            line.show(_progress(event))
        document: dict[str, Any] = call("GET", url, headers=headers, patience=PATIENCE_S).json()
    except RequestError as error:
        raise NotGraded(f"{error} Your submission is stored; its report will be at {page}") from None
    except KeyboardInterrupt:
        raise NotGraded(
            f"You stopped waiting. Your submission is stored; its report will be at {page}"
        ) from None
    if document["report"] is None:
        if canceller := document.get("cancelled_by"):
            raise NotGraded(
                f"Grading was cancelled by {canceller} (course staff). It does not count against you; see"
                f" {page}"
            )
        if not document.get("scores_released", True):
            raise NotGraded(
                f"Graded. The scores of this assignment have not been released yet; they will be at {page}"
            )
        fault = document.get("system_fault", "no reason given")
        raise NotGraded(
            f"Grading failed on the server: {fault}. It is not your mistake and does not count against you;"
            f" see {page}"
        )
    return document


def _progress(event: Event) -> str:
    match event.data:
        case {"status": "queued", "position": int(position)}:
            return f"queued, position {position}"
        case {"status": "running", "scene": int(scene), "scenes": int(scenes)} if scenes:
            return f"running scene {scene} of {scenes}"
    return event.name


def _fetcher(report: Report, url: str, headers: Mapping[str, str]) -> Callable[[str], bytes]:
    """Return the function that fetches a figure or contact sheet as PNG by its name; the server draws it on
    request.
    """
    folders = {p.name: folder for folder in ("figures", "animations") for p in getattr(report, folder)}

    def fetch(name: str) -> bytes:
        return call("GET", f"{url}/{folders[name]}/{name}.png", headers=headers, patience=PICTURE_S).body

    return fetch


@contextlib.contextmanager
def _final_text_on_error(line: Line, text: str) -> Iterator[None]:
    """End the line with ``text`` if an exception passes."""
    try:
        yield
    except BaseException:
        line.end(text)
        raise
