"""``ecp.submit``: what a notebook sends, the wait for its report, and the report itself."""

import contextlib
import json
import uuid
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ecp import course
from ecp.document import NotADocument, read
from ecp.errors import NotebookError
from ecp.gather import Bundle, CannotSend, gather, whole_notebook
from ecp.http import CONTACT_S, Event, RequestError, call, events
from ecp.identity import JSON, authorization
from ecp.progress import Line
from ecp.report import Report
from ecp.return_value import is_empty

PATIENCE_S = 300.0  # with a server that has taken it: it may be started again meanwhile


class NotGraded(NotebookError):
    """What was submitted has no report: the message says why, and where it will be."""


def submit(
    *functions: Any,
    file: str | Path | None = None,
    exercises: str | int | Sequence[str | int] | None = None,
    server: str | None = None,
    assignment: str | None = None,
) -> Report | None:
    """Submit functions with all they need, or a ``.py`` or ``.ipynb`` file, or without either all of this notebook's code.

    Waits for the report and returns it. ``exercises`` says which are to be graded; else those attempted. Functions that are still
    empty are not sent; None where all are. Raises CannotSend, Unreachable or HTTPError where nothing was submitted, NotGraded where
    it was and there is no report.
    """
    where, slug = course.server(server), course.assignment(assignment)
    empty = [f.__name__ for f in functions if is_empty(f)]
    if functions and len(empty) == len(functions):
        print(f"Nothing is submitted: {', '.join(empty)} {'are' if len(empty) > 1 else 'is'} still empty.")
        return None
    sent = _sent([f for f in functions if not is_empty(f)], file, slug)
    asked: dict[str, Any] = {"source": sent.source, "filename": sent.filename}
    if exercises is not None:
        asked["exercises"] = [str(number) for number in ([exercises] if isinstance(exercises, str | int) else exercises)]
    line, who = Line(), authorization(where)
    accepted = _post(f"{where}/v1/assignments/{slug}/submissions", asked, who, line)
    page = f"{where}/submissions/{accepted['id']}"
    with _ended(line, f"submitted, see {page}"):
        url = f"{where}/v1/submissions/{accepted['id']}"
        report = _report(_wait(url, who, line, page), page)
    report.sent, report.address, report.drawn = sent, page, _pictures(report, url, who, line).get
    remarks = [f"Not sent, still empty: {', '.join(empty)}." if empty else "", "Late." if accepted["late"] else ""]
    remarks.append("" if accepted.get("sha256") == sent.sha256 else "The server has graded another text than was sent.")
    report.remark = " ".join(filter(None, [*remarks, _outdated(where, slug)]))
    line.end(f"submitted and graded: {report.summary()}")
    return report


def _sent(functions: list[Any], file: str | Path | None, slug: str) -> Bundle:
    if file is None:
        wanted = course.functions(slug)
        sent = gather(*functions) if functions else whole_notebook()
        if wanted and not wanted & set(sent.names):
            handed = ", ".join(sent.names) if functions else "this notebook"
            raise CannotSend(
                f"{slug} asks for {', '.join(sorted(wanted))}; {handed} has none of them written: nothing was submitted."
            )
        return sent
    if functions:
        raise CannotSend("Hand in either functions or a file: nothing was submitted.")
    path = Path(file)
    try:
        text = path.read_bytes().decode("utf-8-sig").lstrip("\ufeff")
    except (OSError, UnicodeDecodeError) as error:
        raise CannotSend(f"{path} cannot be read ({error}): nothing was submitted.") from None
    return Bundle(_without_outputs(text) if path.suffix == ".ipynb" else text, filename=path.name)


def _post(url: str, asked: dict[str, Any], who: Mapping[str, str], line: Line) -> dict[str, Any]:
    """What the server says of the submission once it is stored; however often it has to be asked, it is one."""
    line.tell("submitting …")
    with _ended(line, "not submitted"):
        headers = {**JSON, **who, "Idempotency-Key": str(uuid.uuid4())}
        accepted: dict[str, Any] = call("POST", url, body=json.dumps(asked).encode(), headers=headers, patience=CONTACT_S).json()
    return accepted


def _report(document: dict[str, Any], page: str) -> Report:
    try:
        return read(Report, document["report"])
    except NotADocument as error:
        raise NotGraded(f"This kit cannot read the report ({error}): install it again. The report is at {page}") from None


def _without_outputs(text: str) -> str:
    """The notebook without what its cells printed and drew: pictures would make it too large, and nobody reads them."""
    try:
        notebook = json.loads(text)
        cells = [{**cell, "outputs": []} if cell["cell_type"] == "code" else cell for cell in notebook["cells"]]
    except (ValueError, LookupError, TypeError):
        return text  # the server tells what is wrong with it
    return json.dumps({**notebook, "cells": cells}, ensure_ascii=False)


def _wait(url: str, who: Mapping[str, str], line: Line, page: str) -> dict[str, Any]:
    try:
        for event in events(f"{url}/events", headers=who, patience=PATIENCE_S):
            line.tell(_told(event))
        document: dict[str, Any] = call("GET", url, headers=who, patience=PATIENCE_S).json()
    except RequestError as trouble:
        raise NotGraded(f"{trouble} What you sent is stored; its report will be at {page}") from None
    except KeyboardInterrupt:
        raise NotGraded(f"You stopped waiting. What you sent is stored; its report will be at {page}") from None
    if document["report"] is None:
        if who_stopped := document.get("cancelled_by"):
            raise NotGraded(f"Grading was stopped by {who_stopped}, of the course's staff. That costs you nothing; see {page}")
        failed = document.get("fault", "it gave no reason")
        raise NotGraded(f"The server failed while grading: {failed}. That is not your mistake and costs you nothing; see {page}")
    return document


def _told(event: Event) -> str:
    match event.data:
        case {"status": "queued", "position": int(position)}:
            return f"queued at position {position}"
        case {"status": "running", "scene": int(scene), "scenes": int(scenes)} if scenes:
            return f"running scene {scene} of {scenes}"
    return event.name


def _pictures(report: Report, url: str, who: Mapping[str, str], line: Line) -> dict[str, bytes]:
    """Every figure and contact sheet that can be had; the server draws them when they are asked for."""
    names = [f"animations/{p.name}" for p in report.animations] + [f"figures/{p.name}" for p in report.figures]
    found: dict[str, bytes] = {}
    for number, name in enumerate(names, start=1):
        line.tell(f"graded, fetching picture {number} of {len(names)}")
        with contextlib.suppress(RequestError):  # a report without a picture is better than none
            found[name.partition("/")[2]] = call("GET", f"{url}/{name}.png", headers=who, patience=5.0).body
    return found


def _outdated(server: str, slug: str | None) -> str:
    """Whether this kit is another one than the server gives out now; its public checks may then be others too."""
    if (own := course.build()) is None:
        return ""
    try:
        told = call("GET", f"{server}/v1/assignments/{slug}", patience=5.0).json()
    except RequestError:
        return ""
    if told.get("kit_build") == own:
        return ""
    return (
        f"The server has another kit than yours: %pip install --force-reinstall --no-deps {server}{told.get('kit')}, then restart."
    )


@contextlib.contextmanager
def _ended(line: Line, text: str) -> Iterator[None]:
    """Leave ``text`` as the last word of the line where it goes wrong."""
    try:
        yield
    except BaseException:
        line.end(text)
        raise
