"""Images that stand in for public ones where no registry of images is reached: Debian's own Python, Debian's
own PostgreSQL.
"""

import platform

from tests.image.engine import Podman

# as Debian's slim images are
SLIM = [f"--dpkgopt=path-exclude=/usr/share/{folder}/*" for folder in ("doc", "man", "locale")]
# What the image `postgres` does with its variables, as far as docker-compose.yml counts on it.
ENTRY = r"""#!/bin/sh
set -e
export PATH="$(echo /usr/lib/postgresql/*/bin):$PATH"
data=/var/lib/postgresql/data
if [ ! -s "$data/PG_VERSION" ]; then
    echo "$POSTGRES_PASSWORD" > /tmp/password
    initdb --pgdata="$data.new" --username="$POSTGRES_USER" --pwfile=/tmp/password \
        --auth=scram-sha-256 --encoding=UTF8 --locale=C
    rm /tmp/password
    echo "host all all all scram-sha-256" >> "$data.new/pg_hba.conf"
    echo "CREATE DATABASE $POSTGRES_USER" | postgres --single -D "$data.new" postgres
    mv "$data.new" "$data"
fi
exec postgres -D "$data" -c listen_addresses='*' -c unix_socket_directories=/tmp
"""
POSTGRES = """FROM {base}
COPY entry /entry
RUN install --directory --owner=postgres --group=postgres /var/lib/postgresql
USER postgres
STOPSIGNAL SIGINT
VOLUME /var/lib/postgresql
CMD ["sh", "/entry"]
"""


def python(podman: Podman) -> str:
    """For ``python:…-slim``: its name."""
    return _debian(podman, "python", "python3,python3-venv")


def postgres(podman: Podman) -> str:
    """For ``postgres:…``: its name."""
    base = _debian(podman, "debian-postgresql", "postgresql")
    context = podman.home / "postgres"
    context.mkdir()
    (context / "entry").write_text(ENTRY)
    (context / "Dockerfile").write_text(POSTGRES.format(base=base))
    podman("build", "--quiet", "--format", "docker", "--tag", "localhost/postgres", str(context))
    return "localhost/postgres"


def _debian(podman: Podman, name: str, packages: str) -> str:
    archive, release = podman.home / f"{name}.tar", platform.freedesktop_os_release()["VERSION_CODENAME"]
    podman(
        "--variant=minbase",
        f"--include={packages}",
        *SLIM,
        release,
        str(archive),
        program="mmdebstrap",
        seconds=600,
    )
    podman("import", "--quiet", str(archive), f"localhost/{name}")
    archive.unlink()
    return f"localhost/{name}"
