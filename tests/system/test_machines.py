"""Workers on two machines against one PostgreSQL over TCP, with password and TLS; a link is cut, a host is
killed.

What a machine is, see ``tests.support.machines``.
"""

import os
import secrets
import signal
import subprocess
import time
from pathlib import Path

import psycopg
import pytest
import trustme

from service.cli.server.demo import free_port
from service.store.postgres.os_user import as_server, own
from service.store.postgres.server import find_programs
from tests.support.machines import NAMESPACES, Machine
from tests.support.waiting import wait_for
from tests.system.test_workers import SLOW, TAKEOVER_S, get, post, rows

pytestmark = (
    pytest.mark.slow
)  # a cut link and a dead host look like a frozen and a killed worker, see test_workers.py


def programs_with_tls():
    """A site's own PostgreSQL speaks TLS; the wheel's is built without. (folder, whether it does)"""
    for folder in sorted(Path("/usr/lib/postgresql").glob("*/bin"), reverse=True):
        told = subprocess.run(
            ["ldd", folder / "postgres"], capture_output=True, text=True, check=False
        ).stdout
        if "libssl" in told:
            return folder, True
    return find_programs(), False


class Postgres:
    """A PostgreSQL as a site has it: on TCP, with password (SCRAM), and TLS required where it speaks it."""

    def __init__(self, folder, addresses, port):
        self.programs, self.tls = programs_with_tls()
        self.data, self.password = folder / "cluster", secrets.token_hex(12)
        authority = trustme.CA()
        authority.cert_pem.write_to_path(str(folder / "ca.pem"))
        server = authority.issue_cert(*addresses)
        (folder / "password").write_text(self.password)
        self.data.mkdir(mode=0o700)
        own(self.data)
        options = [
            "-U",
            "polhode",
            "--auth=scram-sha-256",
            f"--pwfile={folder / 'password'}",
            "--encoding=UTF8",
            "--locale=C",
        ]
        self.view = as_server(self.programs, self.data, folder)
        own(folder)
        subprocess.run(
            [*self.view, str(self.programs / "initdb"), "-D", str(self.data), *options],
            check=True,
            capture_output=True,
        )
        server.private_key_pem.write_to_path(str(self.data / "server.key"))
        server.cert_chain_pems[0].write_to_path(str(self.data / "server.crt"))
        for name in ("server.key", "server.crt"):
            (self.data / name).chmod(0o600)
            os.chown(self.data / name, self.data.stat().st_uid, self.data.stat().st_gid)
        (self.data / "pg_hba.conf").write_text(
            f"{'hostssl' if self.tls else 'host'} all all all scram-sha-256\n"
        )
        self.settings = {
            "listen_addresses": ",".join(addresses),
            "port": str(port),
            "unix_socket_directories": "",
        }
        self.settings |= {"ssl": "on" if self.tls else "off"}
        how = f"sslmode=verify-full&sslrootcert={folder / 'ca.pem'}" if self.tls else "sslmode=disable"
        self.url = f"postgresql://polhode:{self.password}@{{}}:{port}/postgres?{how}"
        self.log = (folder / "log").open("wb")
        arguments = [part for name, value in self.settings.items() for part in ("-c", f"{name}={value}")]
        command = [*self.view, str(self.programs / "postgres"), "-D", str(self.data), *arguments]
        self.process = subprocess.Popen(command, stdout=self.log, stderr=self.log)

    def ready(self, address):
        try:
            psycopg.connect(self.url.format(address), connect_timeout=2).close()
            return True
        except psycopg.OperationalError:
            return False

    def stop(self):
        if self.process.poll() is None:
            os.kill(int((self.data / "postmaster.pid").read_text().split("\n")[0]), signal.SIGINT)
        self.process.wait(20)
        self.log.close()


@pytest.fixture(scope="module")
def site(tmp_path_factory, new_server):
    """A database, a server that does not grade, and two machines that do."""
    folder = tmp_path_factory.mktemp("site")
    machines = [Machine(1), Machine(2)]
    addresses = sorted({m.ours for m in machines} | {"127.0.0.1"})
    postgres = Postgres(folder, addresses, free_port())
    try:
        wait_for(lambda: postgres.ready("127.0.0.1"))
        url = postgres.url.format("127.0.0.1")
        server = new_server(folder / "data", "/livez", POLHODE_DATABASE_URL=url, POLHODE_WORKERS="0")
        for machine in machines:
            machine.start(postgres.url.format(machine.ours))
        wait_for(lambda: len(rows(url, "SELECT name FROM worker WHERE isolation IS NOT NULL")) == 2, 60)
        yield server, url, machines, postgres
        server.stop()
    finally:
        for machine in machines:
            machine.remove()
        postgres.stop()


def of(url, id):
    """Worker and end reason of each run of a submission, in order."""
    query = (
        "SELECT worker, end_reason FROM run JOIN grading a ON a.id = grading_id WHERE a.submission_id = %s"
        " ORDER BY started_at"
    )
    return rows(url, query, id)


def whose(machines, worker):
    return next(m for m in machines if m.process.poll() is None and int(worker.split("/")[1]) in m.workers())


def test_the_database_wants_password_and_tls(site):
    _, url, _, postgres = site
    with pytest.raises(psycopg.OperationalError, match="password authentication failed"):
        psycopg.connect(url.replace(postgres.password, "guess"))
    if not postgres.tls:
        pytest.skip("the only PostgreSQL here is built without TLS")
    everybody = (
        "SELECT DISTINCT ssl FROM pg_stat_ssl JOIN pg_stat_activity USING (pid) WHERE client_addr IS NOT NULL"
    )
    assert rows(url, everybody) == [(True,)]
    with pytest.raises(psycopg.OperationalError, match="no encryption"):
        psycopg.connect(url.split("?")[0] + "?sslmode=disable")


def test_both_machines_grade(site):
    server, url, machines, _ = site
    ids = [post(server.url, SLOW.format(0.5))["id"] for _ in range(6)]
    for id in ids:
        wait_for(lambda id=id: get(server.url, id)["status"] == "graded", 60)
    assert {whose(machines, of(url, id)[0][0]) for id in ids} == set(machines)
    if NAMESPACES:
        hosts = rows(
            url,
            "SELECT DISTINCT host(client_addr) FROM pg_stat_activity WHERE application_name LIKE 'polhode"
            " worker%%'",
        )
        assert {h for (h,) in hosts} == {m.theirs for m in machines}


def test_a_cut_link(site):
    server, url, machines, _ = site
    id = post(server.url, SLOW.format(3))["id"]
    worker = wait_for(lambda: of(url, id))[0][0]
    machine = whose(machines, worker)
    time.sleep(0.7)
    began = time.monotonic()
    machine.cut()
    try:
        wait_for(lambda: len(of(url, id)) == 2)
        assert time.monotonic() - began < TAKEOVER_S
        document = wait_for(lambda: (d := get(server.url, id))["status"] == "graded" and d)
    finally:
        machine.heal()
    assert wait_for(lambda: ("superseded" in dict(of(url, id)).values()) and of(url, id))[0] == (
        worker,
        "superseded",
    )
    assert get(server.url, id) == document
    ids = [post(server.url, SLOW.format(1))["id"] for _ in range(4)]  # and the machine is back
    for id in ids:
        wait_for(lambda id=id: get(server.url, id)["status"] == "graded", 60)
    assert {of(url, id)[0][0] for id in ids} >= {worker}


def test_a_host_that_dies(site):
    server, url, machines, postgres = site
    id = post(server.url, SLOW.format(2))["id"]
    machine = whose(machines, wait_for(lambda: of(url, id))[0][0])
    time.sleep(0.7)
    began = time.monotonic()
    machine.die()
    wait_for(lambda: len(of(url, id)) == 2)
    assert time.monotonic() - began < TAKEOVER_S
    assert wait_for(lambda: (d := get(server.url, id))["status"] == "graded" and d)["report"]["passed"]
    assert [scene_end for _, scene_end in of(url, id)] == ["lost", "finished"]
    machine.start(postgres.url.format(machine.ours))
