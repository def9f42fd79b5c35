"""Time to accept a submission on an idle server, without and with clients that hold connections, in the same
run.

The attack, a process of its own, is 2000 idle connections, half of them with an incomplete header, and 200
bodies of one byte per second. It opens a connection again when the server closes it. The goal holds for a
machine with two cores.
"""

import contextlib
import http.client
import json
import multiprocessing
import os
import resource
import selectors
import socket
import time
from multiprocessing.sharedctypes import Synchronized

from bench.queue import PATH, SOURCE, line, quantile, server

IDLE, SLOW = 2000, 200
# a loopback address other than 127.0.0.1 is no proxy to the server
ADDRESSES = [f"127.0.1.{k}" for k in range(1, 9)]
SUBMISSIONS, PAUSE_S = 300, 0.05
GOAL_MS = 100.0
UNFINISHED = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n"
HEAD = f"POST {PATH} HTTP/1.1\r\nHost: 127.0.0.1\r\nRemote-User: slow\r\nContent-Type: application/json\r\n"
BODY = HEAD + "Content-Length: 100000\r\n\r\n"


def main() -> None:
    """Measure and print one line per measurement."""
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
    with server(workers=0) as (url, _, _):
        port = int(url.rpartition(":")[2])
        submit(port, "warm-up", count=50)
        submit(port, "accepting a submission, no attack")
        open_now, opened = multiprocessing.Value("i"), multiprocessing.Value("i")
        process = multiprocessing.Process(target=attack, args=(port, open_now, opened), daemon=True)
        process.start()
        try:
            until = time.monotonic() + 60
            while open_now.value < 0.95 * (IDLE + SLOW) and time.monotonic() < until:
                time.sleep(0.05)
            submit(port, f"{IDLE} idle connections and {SLOW} slow bodies")
            line("  connections of the attack", open_now.value, "", f"opened until now {opened.value}")
        finally:
            process.terminate()
            process.join()
        submit(port, "after the attack")


def submit(port: int, name: str, count: int = SUBMISSIONS) -> None:
    """Measure the time to a durable 202, one submission at a time, each on a new connection."""
    times, others = [], []
    for k in range(count):
        body = json.dumps({"source": f"{SOURCE}# {k}\n", "exercises": ["2"]})
        headers = {"Content-Type": "application/json", "Remote-User": f"{name} {k % 40}"}
        began = time.perf_counter()
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
        connection.request("POST", PATH, body, headers)
        status = connection.getresponse().status
        connection.close()
        times.append(time.perf_counter() - began)
        others += [status] if status != 202 else []
        time.sleep(PAUSE_S)
    p50, p99, most = (1e3 * quantile(times, q) for q in (0.5, 0.99, 1.0))
    answers = f"other answers than 202: {others}" if others else "all 202"
    line(
        f"{name}, p99",
        p99,
        "ms",
        f"p50 {p50:.1f}, max {most:.1f}; goal {GOAL_MS:g}; {answers}; load {os.getloadavg()[0]:.1f}",
    )


def attack(port: int, open_now: "Synchronized[int]", opened: "Synchronized[int]") -> None:
    """Hold the connections until this process is terminated."""
    waiting = selectors.DefaultSelector()
    missing, slow, next_s = list(range(IDLE + SLOW)), {}, time.monotonic() + 1.0
    while True:
        for k in missing[:100]:
            connection = socket.create_connection(("127.0.0.1", port), 10, (ADDRESSES[k % len(ADDRESSES)], 0))
            connection.sendall(BODY.encode() if k >= IDLE else UNFINISHED if k % 2 else b"")
            waiting.register(connection, selectors.EVENT_READ, k)
            opened.value += 1
            if k >= IDLE:
                slow[k] = connection
        missing = missing[100:]
        for key, _ in waiting.select(0.0 if missing else max(0.0, next_s - time.monotonic())):
            connection, k = key.fileobj, key.data
            assert isinstance(connection, socket.socket)
            received = b""
            with contextlib.suppress(OSError):
                received = connection.recv(65536)
            if not received:
                waiting.unregister(connection)
                connection.close()
                slow.pop(k, None)
                missing.append(k)
        if time.monotonic() >= next_s:
            for connection in slow.values():
                with contextlib.suppress(OSError):
                    connection.sendall(b" ")
            next_s += 1.0
        open_now.value = IDLE + SLOW - len(missing)


if __name__ == "__main__":
    main()
