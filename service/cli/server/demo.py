"""Start a server, submit samples over HTTP, and print a table of their reports and how to log in."""

import argparse
import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from exercises.authoring.assignments.catalogue import assignments
from exercises.authoring.assignments.samples import Sample, samples
from exercises.authoring.mutants.variants import MadeSample
from polhode.judging.verdict import MARKS, Verdict
from polhode.report.dataclass_json import read
from polhode.report.report import Report
from service.cli.server.demo_class import STUDENTS, add_class, logins
from service.settings import Settings

START_S, ANSWER_S, WAIT_S, PATIENCE_S = 240.0, 5.0, 60, 1800.0
SLUGS = ("rigid-body", "integrators", "random-walks")  # exercises of its own, steppers, random numbers
ROW = "{:1}  {:40}  {:>8}  {:>7}  {}"
MOST_CAUSE = 80  # characters
MADE = 3  # samples shown of an assignment whose samples follow from its declaration


def main() -> int:
    """Run the demonstration. Return 0 if every report is as expected, 1 if not, 2 if the server did not
    start.
    """
    parser = argparse.ArgumentParser(prog="polhode demo", description=__doc__)
    parser.add_argument("--once", action="store_true", help="stop the server after the last sample")
    parser.add_argument("--port", type=int, help="port to listen on; default: a free one")
    arguments = parser.parse_args()
    once, port = arguments.once, arguments.port or free_port()
    if not _is_free(port):
        print(
            f"polhode: port {port} cannot be used: choose another one, such as make demo PORT=8123",
            file=sys.stderr,
        )
        return 2
    for stop in (signal.SIGINT, signal.SIGTERM):  # a shell may start background jobs with SIGINT ignored
        signal.signal(stop, signal.default_int_handler)
    began, address = time.monotonic(), f"http://127.0.0.1:{port}"
    os.environ.setdefault("POLHODE_DATA", ".demo")
    server = subprocess.Popen([sys.executable, "-m", "service.cli", "serve", "--port", str(port)])
    try:
        if not _wait_ready(server, address):
            return 2
        print(f"({time.monotonic() - began:.1f} s)")
        count = add_class(Settings(), SLUGS)
        wrong = _grade_all(address)
        summary = (
            f"unexpected reports: {', '.join(wrong)}" if wrong else "every sample got its expected report"
        )
        print(f"\n{summary} ({time.monotonic() - began:.1f} s)")
        if not once:
            print(_how_to_come_in(address, logins(Settings()), count), flush=True)
            server.wait()
        return 1 if wrong else 0
    except KeyboardInterrupt:
        return 0
    finally:
        server.send_signal(signal.SIGTERM)
        server.wait(30)


def _grade_all(address: str) -> list[str]:
    """Submit the samples, four at a time; print a table of their reports, and one report as a whole. Return
    the names of unexpected reports.
    """
    known, wrong = [(slug, *shown) for slug in SLUGS for shown in _shown(slug)], []
    whole: tuple[str, dict[str, Any]] | None = None
    with ThreadPoolExecutor(4) as pool:
        answers = [pool.submit(_graded, address, *one) for one in known]
        before = ""
        for (slug, name, _, sample), future in zip(known, answers, strict=True):
            if slug != before:
                print(f"\n{ROW.format('', slug, 'points', 'seconds', 'first cause')}")
            before = slug
            document, fault = future.result()
            if fault:
                print(f"graded once more, because grading failed: {name} ({fault})")
            print(_row(name, document), flush=True)
            if document["report"] is None or sample.unexpected(document["report"]):
                wrong.append(name)
            elif whole is None and document["report"]["suspect_lines"]:
                whole = name, document
    if whole is not None:
        name, document = whole
        with urllib.request.urlopen(
            f"{address}/v1/submissions/{document['id']}/report.txt", timeout=30
        ) as answer:
            print(f"\nThe report of {name}, {address}/submissions/{document['id']}:\n")
            print(answer.read().decode().rstrip(), flush=True)
    return wrong


def _row(name: str, document: dict[str, Any]) -> str:
    """Return the row of the table for a submission's document, with the seconds that grading took."""
    if document["report"] is None:
        why = f"not graded: {document.get('system_fault') or document['status']}"
        return ROW.format("!", name, "", "", why)
    report = read(Report, document["report"])
    seconds = sum(report.provenance.phases_ms.values()) / 1000
    causes = report.overview().causes
    mark = MARKS[Verdict.PASS if report.passed else Verdict.FAIL]
    points = f"{report.score} of {report.max_score}"
    cause = causes[0].diagnosis.sentence if causes else ""
    shown = cause if len(cause) <= MOST_CAUSE else f"{cause[: MOST_CAUSE - 1]}…"
    return ROW.format(mark, name, points, f"{seconds:.1f}", shown).rstrip()


def _how_to_come_in(address: str, tokens: Mapping[str, str], count: int) -> str:
    """Return what to open: logins of both roles, the class, the notebooks."""
    lines = [f"Log in as {who}:\n  {address}/login#token={token}" for who, token in tokens.items()]
    if count:
        lines.append(
            f"A synthetic class of {STUDENTS} students sent {count} submissions; the server is grading them:"
            f"\n  {address}/assignments/{SLUGS[0]}/class"
        )
    notebooks = "\n  ".join(f"{address}/v1/assignments/{slug}/notebook.ipynb" for slug in SLUGS)
    lines.append(f"Students' notebooks:\n  {notebooks}")
    lines.append(f"The server is running: open {address}/ in a browser. Press Ctrl-C to stop.")
    return "\n".join(lines)


def _shown(slug: str) -> Iterator[tuple[str, str, Sample | MadeSample]]:
    """Yield the samples to show with their names and sources: those marked for it, or the right one and a
    wrong one of each of the first exercises.
    """
    assignment = assignments()[slug]
    if marked := [sample for sample in samples(assignment) if sample.demo]:
        yield from ((one.file.name, one.file.read_text(encoding="utf-8"), one) for one in marked)
        return
    made = {one.ask: one for one in assignment.made_samples() if not one.is_notebook}
    yield from ((one.name, one.source, one) for one in list(made.values())[:MADE])


def _graded(
    address: str, slug: str, name: str, source: str, sample: Sample | MadeSample
) -> tuple[dict[str, Any], str]:
    """Submit the sample, once more if grading fails; return the submission's document, and why it was graded
    once more.
    """
    document = _submit(address, slug, name, source, sample)
    fault = str(document.get("system_fault") or "")
    return (_submit(address, slug, name, source, sample) if fault else document), fault


def _submit(address: str, slug: str, name: str, source: str, sample: Sample | MadeSample) -> dict[str, Any]:
    """Post the sample, wait until it is graded, and return the submission's document."""
    body = {"filename": name, "source": source} | ({"exercises": list(sample.ask)} if sample.ask else {})
    path = f"{address}/v1/assignments/{slug}/submissions"
    document = _ask(path, json.dumps(body).encode())
    deadline = time.monotonic() + PATIENCE_S
    while document["status"] in ("queued", "running") and time.monotonic() < deadline:
        time.sleep(1)
        document = _ask(f"{address}/v1/submissions/{document['id']}")
    return document


def _ask(url: str, body: bytes | None = None) -> dict[str, Any]:
    headers = {"Content-Type": "application/json", "Prefer": f"wait={WAIT_S}"}
    with urllib.request.urlopen(urllib.request.Request(url, body, headers), timeout=WAIT_S + 30) as answer:
        document: dict[str, Any] = json.load(answer)
    return document


def _wait_ready(server: subprocess.Popen[bytes], address: str) -> bool:
    deadline = time.monotonic() + START_S
    print(f"starting the server at {address} ", end="", flush=True)
    while server.poll() is None and time.monotonic() < deadline:
        try:
            with urllib.request.urlopen(f"{address}/readyz", timeout=ANSWER_S) as answer:
                print(f"ready: {json.load(answer)['checks']}", flush=True)
                return True
        except OSError:  # includes timeouts of a busy server
            print(".", end="", flush=True)
            time.sleep(0.25)
    print("\npolhode: the server did not start; see the log above", file=sys.stderr)
    return False


def _is_free(port: int) -> bool:
    """Return whether a server can listen on the port. If not, another server may answer there and receive the
    samples.
    """
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except (OSError, OverflowError):
            return False
    return True


def free_port() -> int:
    """Return an unused port on the loopback interface."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
    return port


if __name__ == "__main__":
    sys.exit(main())
