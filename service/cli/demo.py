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
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from exercises.catalogue import assignments
from exercises.samples import Sample, samples
from service.cli.demo_class import STUDENTS, enter_class
from service.settings import Settings

START_S, ANSWER_S = 60.0, 5.0
SLUG = "rigid-body"


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
        count = enter_class(Settings(), SLUG)
        wrong = _grade_all(address)
        print(f"\n{_summary(wrong)} ({time.monotonic() - began:.1f} s)")
        if not once:
            print(f"Student notebook: {address}/v1/assignments/{SLUG}/notebook.ipynb")
            if count:
                print(f"A synthetic class of {STUDENTS} students sent {count} submissions; the server is grading them.")
            print(f"Dashboard: {address}/assignments/{SLUG}/class and {address}/queue")
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
    known, wrong = [s for s in samples(assignments()[SLUG]) if s.demo], []
    with ThreadPoolExecutor(4) as pool:
        answers = [pool.submit(_submit, address, sample) for sample in known]
        for number, (sample, future) in enumerate(zip(known, answers, strict=True), start=1):
            document = future.result()
            print(f"\n[{number}/{len(known)}] {sample.file.name}   {address}/submissions/{document['id']}")
            report = document["report"]
            if report is None:
                print(f"not graded: {document['status']} {document.get('fault', '')}")
            else:
                _print_lines(address, document["id"])
            if report is None or sample.unexpected(report):
                wrong.append(sample.file.name)
    return wrong


def _print_lines(address: str, id: str) -> None:
    with urllib.request.urlopen(f"{address}/v1/submissions/{id}/report.txt", timeout=30) as answer:
        print(answer.read().decode().rstrip(), flush=True)


def _summary(wrong: list[str]) -> str:
    return f"unexpected reports: {', '.join(wrong)}" if wrong else "every sample got its expected report"


def _submit(address: str, sample: Sample) -> dict[str, Any]:
    """Post the file as a form, wait for the report and return the submission's document."""
    boundary, file = "polhode-demo-boundary", sample.file
    fields = [f'name="exercises"\r\n\r\n{number}'.encode() for number in sample.ask or ()]
    fields.append(f'name="file"; filename="{file.name}"\r\n\r\n'.encode() + file.read_bytes())
    parts = [f"--{boundary}\r\nContent-Disposition: form-data; ".encode() + field + b"\r\n" for field in fields]
    body = b"".join(parts) + f"--{boundary}--\r\n".encode()
    headers = {"Content-Type": f"multipart/form-data; boundary={boundary}", "Prefer": "wait=60"}
    request = urllib.request.Request(f"{address}/v1/assignments/{SLUG}/submissions", body, headers)
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
