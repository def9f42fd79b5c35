"""The folder of the embedded database, and the file beside it that records which database it holds."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path

from service.store.postgres.os_user import DatabaseUnavailable

REMEDY = "put it back, or restore a backup with polhode db restore FILE"
# Every query needs these, and PostgreSQL never removes them.
NEEDED = ("", "PG_VERSION", "global/pg_control", "base", "pg_wal", "pg_xact", "pg_multixact")


class Cluster:
    """A cluster is one PostgreSQL server's data: a folder that ``initdb`` creates and nothing can re-create.

    A file beside the folder holds the cluster's system identifier, so that a missing or different folder is
    not taken for a first start.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.record, self._log = folder.with_name("postgres.id"), folder.with_name("postgres.log")
        self._needed: list[str] = [*NEEDED]
        self._identity: tuple[object, ...] | None = None

    @property
    def exists(self) -> bool:
        """Return whether the folder holds a cluster."""
        return os.path.exists(self.folder / "PG_VERSION")

    def check_nothing_lost(self) -> None:
        """Raise DatabaseUnavailable if the folder held a cluster before, or holds the rest of one."""
        try:
            remains = os.path.lexists(self.folder) and any(self.folder.iterdir())
        except OSError as error:
            raise DatabaseUnavailable(f"{self.folder} cannot be read ({error.strerror}): {REMEDY}") from error
        if remains:
            raise DatabaseUnavailable(
                f"{self.folder} is not a complete database, PG_VERSION is missing: move it away and put the"
                " complete folder back, or restore a backup with polhode db restore FILE"
            )
        if traces := " and ".join(str(file) for file in (self.record, self._log) if file.exists()):
            raise DatabaseUnavailable(
                f"the database folder {self.folder} is missing, although it existed before (see {traces}):"
                f" {REMEDY}; to start with an empty database, move {traces} away"
            )

    def check_identity(self) -> None:
        """Raise DatabaseUnavailable if the folder is damaged or holds another cluster than recorded."""
        if loss := self._find_missing(NEEDED):
            raise DatabaseUnavailable(
                f"the database in {self.folder.parent} is damaged, because {loss}: put back what is missing,"
                f" or move {self.folder} away and restore a backup with polhode db restore FILE"
            )
        found, recorded = self.system_identifier(), self.recorded()
        if recorded is not None and recorded != found:
            raise DatabaseUnavailable(
                f"{self.folder} holds another database (system identifier {found}) than {self.record} records"
                f" ({recorded}): put the right folder back; to use this one, move {self.record} away"
            )

    def recorded(self) -> str | None:
        """Return the system identifier of the recorded cluster, or None without a record."""
        try:
            return self.record.read_text().strip() or None
        except FileNotFoundError:
            return None

    def system_identifier(self) -> str:
        """Return the number by which PostgreSQL identifies a cluster and its copies.

        Raises DatabaseUnavailable if it cannot be read.
        """
        try:
            with (self.folder / "global" / "pg_control").open("rb") as control:
                start = control.read(8)  # the first field of ControlFileData
        except OSError as error:
            raise DatabaseUnavailable(
                f"{self.folder}/global/pg_control cannot be read ({error.strerror}): {REMEDY}"
            ) from error
        return str(int.from_bytes(start, sys.byteorder))

    def write_record(self, identifier: str) -> None:
        """Record the cluster beside its folder."""
        if self.recorded() != identifier:
            unfinished = self.record.with_suffix(".part")
            unfinished.write_text(identifier + "\n")
            unfinished.replace(self.record)

    def leave_record(self) -> None:
        """Record a cluster whose folder was lost while the server ran, if the record was lost with it."""
        if self._identity is not None and not self.exists and not self.record.exists():
            self.record.parent.mkdir(mode=0o700, exist_ok=True)
            self.write_record(str(self._identity[-1]))

    def watch(self, database: int) -> None:
        """Remember the folder of a running server, whose database has that object id."""
        tablespaces = [
            str(path.relative_to(self.folder)) for path in self.folder.glob(f"pg_tblspc/*/*/{database}")
        ]
        self._needed = [*NEEDED, f"base/{database}", f"base/{database}/PG_VERSION", *tablespaces]
        self._identity = self._read_identity()

    def find_loss(self, server: int | None) -> str | None:
        """Return what is wrong with the watched folder of the server with that process id, or None.

        A server whose folder was moved or replaced still runs in the old one.
        """
        if missing := self._find_missing(self._needed):
            return missing
        try:
            same = server is None or os.path.samefile(f"/proc/{server}/cwd", self.folder)
        except OSError:  # the server has ended
            same = True
        return None if same else f"{self.folder.name} is another folder than the one in use"

    def unchanged(self) -> bool:
        """Return whether the watched folder is complete and the same as before, rather than a copy that may
        still be growing.
        """
        return self.find_loss(None) is None and self._read_identity() == self._identity

    def _find_missing(self, paths: Sequence[str]) -> str | None:
        for path in paths:
            reason = None
            try:
                if not os.stat(os.path.join(self.folder, path)).st_mode & 0o400:
                    reason = "cannot be read by its owner"
            except OSError as error:
                reason = (
                    "is missing"
                    if isinstance(error, FileNotFoundError)
                    else f"cannot be read ({error.strerror})"
                )
            if reason is not None:
                return f"{Path(self.folder.name) / path} {reason}"
        return None

    def _read_identity(self) -> tuple[object, ...]:
        folder, version = os.stat(self.folder), os.stat(self.folder / "PG_VERSION")
        return folder.st_dev, folder.st_ino, version.st_ino, version.st_ctime_ns, self.system_identifier()
