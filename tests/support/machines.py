"""Machines to run workers on. As root each has a network namespace and an address of its own, joined to ours
by a cable that can be cut; otherwise it is a process on loopback, and the cut is a freeze, as only the
kernel's side of it differs.
"""

import asyncio
import contextlib
import os
import shutil
import signal
import subprocess
import sys
import threading
from pathlib import Path

ROOT = os.geteuid() == 0
ID = f"{os.getpid() % 100000:05d}"


def namespaces_work():
    if not ROOT or shutil.which("ip") is None:
        return False
    made = (
        subprocess.run(["ip", "netns", "add", f"ph{ID}t"], capture_output=True, check=False).returncode == 0
    )
    subprocess.run(["ip", "netns", "delete", f"ph{ID}t"], capture_output=True, check=False)
    return made


NAMESPACES = namespaces_work()


def ip(*words):
    subprocess.run(["ip", *words], check=True, capture_output=True)


def children(pid):
    """Numbers of the processes that the first thread of a process has started; none once it is gone."""
    try:
        return [int(p) for p in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


def command_of(pid):
    """The command line of a process, as bytes; empty once it is gone."""
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return b""


def started_with(variable):
    """Numbers of the processes of ours that run and have this in their environment."""
    found = []
    for path in Path("/proc").glob("[0-9]*/environ"):
        with contextlib.suppress(OSError):
            if variable.encode() in path.read_bytes().split(b"\0"):
                found.append(int(path.parent.name))
    return found


class Machine:
    """Where a crew runs."""

    def __init__(self, number, **output):
        self.output = output
        self.name, self.cable = f"ph{ID}{number}", f"ph{ID}v{number}"
        self.ours, self.theirs = (
            (f"10.{200 + os.getpid() % 50}.{number}.{k}" for k in (1, 2))
            if NAMESPACES
            else ("127.0.0.1", "127.0.0.1")
        )
        self.process = None
        if NAMESPACES:
            ip("netns", "add", self.name)
            ip("link", "add", self.cable, "type", "veth", "peer", "name", "eth0", "netns", self.name)
            ip("addr", "add", f"{self.ours}/24", "dev", self.cable)
            ip("link", "set", self.cable, "up")
            for words in (f"addr add {self.theirs}/24 dev eth0", "link set eth0 up", "link set lo up"):
                ip("-n", self.name, *words.split())

    def start(self, url, slots=1, **more):
        inside = ["ip", "netns", "exec", self.name] if NAMESPACES else []
        own = {"POLHODE_DATABASE_URL": url, "POLHODE_WORKERS": str(slots), "OMP_NUM_THREADS": "1"}
        command = [*inside, sys.executable, "-m", "service.cli", "worker"]
        self.process = subprocess.Popen(command, env=os.environ | own | more, **self.output)

    def workers(self):
        """The numbers of its worker processes; ``ip netns exec`` becomes the command itself."""
        return children(self.process.pid)

    def cut(self):
        if NAMESPACES:
            ip("link", "set", self.cable, "down")
        else:
            self._signal(signal.SIGSTOP)

    def heal(self):
        if NAMESPACES:
            ip("link", "set", self.cable, "up")
        else:
            self._signal(signal.SIGCONT)

    def die(self):
        """All at once, as when the power goes."""
        self._signal(signal.SIGKILL)
        self.process.kill()
        self.process.wait(10)

    def _signal(self, how):
        for worker in self.workers():
            with contextlib.suppress(ProcessLookupError):
                os.kill(worker, how)

    def remove(self):
        if self.process is not None and self.process.poll() is None:
            self.heal()
            self.process.terminate()
            self.process.wait(60)
        if NAMESPACES:
            subprocess.run(["ip", "netns", "delete", self.name], check=False)
            subprocess.run(["ip", "link", "delete", self.cable], check=False, capture_output=True)


class Relay(threading.Thread):
    """Carries TCP connections from another machine to the socket of an embedded database,
    which has no port.
    """

    def __init__(self, address, data):
        super().__init__(daemon=True)
        self._address, self._data, self._ready = address, data, threading.Event()
        self.start()
        self._ready.wait(10)

    def run(self):
        asyncio.run(self._serve())

    def stop(self):
        self._loop.call_soon_threadsafe(self._ending.set)
        self.join(10)

    async def _serve(self):
        self._loop, self._ending = asyncio.get_running_loop(), asyncio.Event()
        server = await asyncio.start_server(self._carry, self._address, 0)
        self.port = server.sockets[0].getsockname()[1]
        self._ready.set()
        await self._ending.wait()
        server.close()

    async def _carry(self, reader, writer):
        try:
            there = await asyncio.open_unix_connection(f"{(self._data / 'socket').read_text()}/.s.PGSQL.5432")
        except OSError:
            writer.close()
            return
        await asyncio.gather(_copy(reader, there[1]), _copy(there[0], writer))


async def _copy(reader, writer):
    with contextlib.suppress(OSError):
        while data := await reader.read(65536):
            writer.write(data)
            await writer.drain()
    writer.close()
