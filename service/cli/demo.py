"""The demonstration: a real server on a free port, some samples sent over HTTP, its lines printed as they come back."""

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
    """Exit code 0 if every one of them got its expected report, 1 if not, 2 if nothing could be graded."""
    parser = argparse.ArgumentParser(prog="polhode demo", description=__doc__)
    parser.add_argument("--once", action="store_true", help="stop the server after the last sample")
    once = parser.parse_args().once
    for stop in (signal.SIGINT, signal.SIGTERM):  # also where a shell started us with interrupts ignored
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
            print(f"The notebook for students is at {address}/v1/assignments/{SLUG}/notebook.ipynb")
            if count:
                print(f"A class of {STUDENTS} invented students handed in {count} times; the rest of it is being graded.")
            print(f"The dashboard: {address}/assignments/{SLUG}/class and {address}/queue")
            print(f"The server is running: open {address}/ in a browser. Press Ctrl-C to stop it.", flush=True)
            server.wait()
        return 1 if wrong else 0
    except KeyboardInterrupt:
        return 0
    finally:
        server.send_signal(signal.SIGTERM)
        server.wait(30)


def _grade_all(address: str) -> list[str]:
    """Send them, a few at a time, print the reports in order; names of those with an unexpected report."""
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
    return f"unexpected reports: {', '.join(wrong)}" if wrong else "every sample got the report it should"


def _submit(address: str, sample: Sample) -> dict[str, Any]:
    """POST the file as a form and wait for the report."""
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
    print(f"starting a server at {address} ", end="", flush=True)
    while server.poll() is None and time.monotonic() < deadline:
        try:
            with urllib.request.urlopen(f"{address}/readyz", timeout=ANSWER_S) as answer:
                print(f"ready: {json.load(answer)['checks']}", flush=True)
                return True
        except OSError:  # also a server too busy to answer in time
            print(".", end="", flush=True)
            time.sleep(0.25)
    print("\nthe server did not start", file=sys.stderr)
    return False


def free_port() -> int:
    """A port of loopback that nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
    return port


if __name__ == "__main__":
    sys.exit(main())
