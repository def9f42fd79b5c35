"""Start a server on a free port, submit samples over HTTP, and print their reports."""

import argparse
import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

from exercises.catalogue import assignments
from exercises.samples import samples
from service.cli.demo_class import STUDENTS, add_class
from service.settings import Settings

START_S, ANSWER_S = 60.0, 5.0
SLUGS = ("rigid-body", "integrators", "random-walks")  # exercises of its own, steppers, random numbers
MADE = 3  # samples shown of an assignment whose samples follow from its declaration


class Shown(NamedTuple):
    """A sample: its file, the exercises to grade (None: those it attempts), and a function that returns the differences of a
    report, as JSON, from the expected one.
    """

    slug: str
    name: str
    content: bytes
    ask: Sequence[str] | None
    unexpected: Callable[[Mapping[str, Any]], list[str]]


def main() -> int:
    """Run the demonstration. Return 0 if every report is as expected, 1 if not, 2 if the server did not start."""
    parser = argparse.ArgumentParser(prog="polhode demo", description=__doc__)
    parser.add_argument("--once", action="store_true", help="stop the server after the last sample")
    once = parser.parse_args().once
    for stop in (signal.SIGINT, signal.SIGTERM):  # a shell may start background jobs with SIGINT ignored
        signal.signal(stop, signal.default_int_handler)
    began, address = time.monotonic(), f"http://127.0.0.1:{(port := free_port())}"
    os.environ.setdefault("POLHODE_DATA", ".demo")
    server = subprocess.Popen([sys.executable, "-m", "service.cli", "serve", "--port", str(port)])
    try:
        if not _wait_ready(server, address):
            return 2
        print(f"({time.monotonic() - began:.1f} s)")
        count = add_class(Settings(), SLUGS)
        wrong = _grade_all(address)
        print(f"\n{_summary(wrong)} ({time.monotonic() - began:.1f} s)")
        if not once:
            print("Students' notebooks:", *(f"{address}/v1/assignments/{slug}/notebook.ipynb" for slug in SLUGS), sep="\n  ")
            if count:
                print(f"A synthetic class of {STUDENTS} students sent {count} submissions; the server is grading them.")
            print("Dashboard:", *(f"{address}/assignments/{slug}/class" for slug in SLUGS), f"{address}/queue", sep="\n  ")
            print(f"The server is running: open {address}/ in a browser. Press Ctrl-C to stop.", flush=True)
            server.wait()
        return 1 if wrong else 0
    except KeyboardInterrupt:
        return 0
    finally:
        server.send_signal(signal.SIGTERM)
        server.wait(30)


def _grade_all(address: str) -> list[str]:
    """Submit the samples, four at a time, and print the reports in order. Return the names of unexpected reports."""
    known, wrong = [sample for slug in SLUGS for sample in _shown(slug)], []
    with ThreadPoolExecutor(4) as pool:
        answers = [pool.submit(_submit, address, sample) for sample in known]
        for number, (sample, future) in enumerate(zip(known, answers, strict=True), start=1):
            document = future.result()
            print(f"\n[{number}/{len(known)}] {sample.slug}: {sample.name}   {address}/submissions/{document['id']}")
            report = document["report"]
            if report is None:
                print(f"not graded: {document['status']} {document.get('fault', '')}")
            else:
                _print_lines(address, document["id"])
            if report is None or sample.unexpected(report):
                wrong.append(sample.name)
    return wrong


def _shown(slug: str) -> Iterator[Shown]:
    """Yield the samples to show: those marked for it, or the right one and a wrong one of each of the first exercises."""
    assignment = assignments()[slug]
    for sample in samples(assignment):
        if sample.demo:
            yield Shown(slug, sample.file.name, sample.file.read_bytes(), sample.ask, sample.unexpected)
    made = {one.ask: one for one in assignment.made_samples() if not one.is_notebook}
    for one in list(made.values())[:MADE]:
        yield Shown(slug, one.name, one.source.encode(), one.ask, one.unexpected)


def _print_lines(address: str, id: str) -> None:
    with urllib.request.urlopen(f"{address}/v1/submissions/{id}/report.txt", timeout=30) as answer:
        print(answer.read().decode().rstrip(), flush=True)


def _summary(wrong: list[str]) -> str:
    return f"unexpected reports: {', '.join(wrong)}" if wrong else "every sample got its expected report"


def _submit(address: str, sample: Shown) -> dict[str, Any]:
    """Post the file as a form, wait for the report and return the submission's document."""
    boundary = "polhode-demo-boundary"
    fields = [f'name="exercises"\r\n\r\n{number}'.encode() for number in sample.ask or ()]
    fields.append(f'name="file"; filename="{sample.name}"\r\n\r\n'.encode() + sample.content)
    parts = [f"--{boundary}\r\nContent-Disposition: form-data; ".encode() + field + b"\r\n" for field in fields]
    body = b"".join(parts) + f"--{boundary}--\r\n".encode()
    headers = {"Content-Type": f"multipart/form-data; boundary={boundary}", "Prefer": "wait=60"}
    request = urllib.request.Request(f"{address}/v1/assignments/{sample.slug}/submissions", body, headers)
    with urllib.request.urlopen(request, timeout=90) as answer:
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


def free_port() -> int:
    """Return an unused port on the loopback interface."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
    return port


if __name__ == "__main__":
    sys.exit(main())
