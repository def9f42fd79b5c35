"""The services of docker-compose.yml, brought up by podman-compose: a server, two workers and PostgreSQL."""

import secrets
import time
from collections.abc import Sequence
from pathlib import Path

from exercises.authoring.assignments.samples import Sample
from service.cli.server.demo import free_port
from tests.image.calls import graded, readyz, submit, until
from tests.image.engine import Failed, Podman

PEOPLE = "name,role\nada,student\nemmy,instructor\n"
ENTER = "polhode roster /dev/stdin --tokens tokens.csv >&2 && cat tokens.csv && rm tokens.csv"
BY_WORKER = "SELECT split_part(worker, '/', 1), count(*) FROM run WHERE end_reason = 'finished' GROUP BY 1"
IN_HAND = "SELECT DISTINCT split_part(worker, '/', 1) FROM run WHERE ended_at IS NULL"
LOST = "SELECT count(*) FROM run WHERE end_reason = 'lost'"
STOP_S = 30


class Course:
    """A folder with the compose file and the .env that docs/docker.md tells to write."""

    def __init__(self, podman: Podman, compose: Path, image: str, postgres: str) -> None:
        self.podman, self.folder, self._port = podman, podman.home / "course", free_port()
        self.folder.mkdir()
        (self.folder / compose.name).write_text(compose.read_text())
        own = {"POSTGRES_PASSWORD": secrets.token_hex(24), "POSTGRES_IMAGE": postgres, "POLHODE_IMAGE": image}
        own["PUBLISH"] = f"127.0.0.1:{self._port}"
        (self.folder / ".env").write_text("".join(f"{name}={value}\n" for name, value in own.items()))
        self.address = f"http://127.0.0.1:{self._port}"

    def up(self) -> None:
        """Start everything; return when the server says it can grade."""
        self._compose("up", "-d", "--no-build")
        until(lambda: readyz(self.address).get("status") == "ready", 120, "the course is ready")

    def enter_people(self) -> str:
        """A student's token."""
        told = self.podman("exec", "-i", self._container("server")[0], "sh", "-c", ENTER, sent=PEOPLE)
        return dict(line.split(",") for line in told.split())["ada"]

    def publish(self) -> None:
        """Let students see and submit the assignment of the samples."""
        self.podman("exec", self._container("server")[0], "polhode", "assign", "rigid-body", "--publish")

    def grade(self, some: Sequence[Sample], token: str) -> None:
        """Send them all, then wait for the reports they should get."""
        sent = [(submit(self.address, one, token), one) for one in some]
        for id, one in sent:
            graded(self.address, id, one, token)

    def grade_while_one_dies(self, some: Sequence[Sample], token: str) -> str:
        """As ``grade``, but a worker that has one of them in hand is killed; its container."""
        sent = [(submit(self.address, one, token), one) for one in some]
        names = {
            self.podman("exec", worker, "cat", "/etc/hostname").strip(): worker
            for worker in self._container("worker")
        }
        busy = until(
            lambda: [name for name in self.query(IN_HAND).split() if name in names],
            30,
            "a worker has one in hand",
        )
        self.podman("kill", "--signal", "KILL", names[busy[0]])
        for id, one in sent:
            graded(self.address, id, one, token)
        return names[busy[0]]

    def query(self, statement: str) -> str:
        """What the database says."""
        psql = (
            "PGPASSWORD=$POSTGRES_PASSWORD psql --host=127.0.0.1 --username=polhode --tuples-only --no-align"
            " --command"
        )
        return self.podman("exec", self._container("db")[0], "sh", "-c", f'{psql} "{statement}"').strip()

    def stop(self, but: str) -> float:
        """Stop all that run, seconds it took; Failed where one does not end by itself with 0."""
        began = time.monotonic()
        for container in [*self._container("server"), *self._container("worker"), *self._container("db")]:
            if container != but:
                stop(self.podman, container)
        took = time.monotonic() - began
        self._compose("down", "--volumes")
        return took

    def _container(self, service: str) -> list[str]:
        words = (
            "ps",
            "--all",
            "--format",
            "{{.Names}}",
            "--filter",
            f"label=com.docker.compose.service={service}",
        )
        return sorted(self.podman(*words).split())

    def _compose(self, *words: str) -> None:
        self.podman(
            "--file", str(self.folder / "docker-compose.yml"), *words, program="podman-compose", seconds=240
        )


def stop(podman: Podman, container: str) -> float:
    """SIGTERM, seconds until it ended; Failed where that was not by itself, or not with 0."""
    began = time.monotonic()
    podman("stop", "--time", str(STOP_S), container)
    code, took = (
        podman("inspect", "--format", "{{.State.ExitCode}}", container).strip(),
        time.monotonic() - began,
    )
    if code != "0":
        raise Failed(
            f"{container} ended with {code} after {took:.1f} s:\n{podman('logs', container)[-3000:]}"
        )
    return took
