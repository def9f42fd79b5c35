"""The units in deploy/systemd, verified, and run by systemd in namespaces: a submission, a kill, a backup
with its drill.
"""

import io
import json
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from exercises.authoring.publishing.wheel import wheel
from tests.support import systemd
from tests.support.checkout import ROOT

UNITS = ROOT / "deploy/systemd"
PATH = "http://127.0.0.1:8000/v1/assignments/rigid-body/submissions"


def test_the_units_are_valid(tmp_path):
    if shutil.which("systemd-analyze") is None:
        pytest.skip("systemd-analyze is not installed")
    for unit in UNITS.iterdir():
        (tmp_path / unit.name).write_text(unit.read_text().replace("/opt/polhode/bin/polhode", "/bin/true"))
    done = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", *tmp_path.iterdir()],
        capture_output=True,
        text=True,
        check=False,
    )
    assert not [line for line in done.stderr.splitlines() if "polhode" in line], done.stderr


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    if not systemd.is_possible():
        pytest.skip("systemd cannot run in namespaces here")
    folder = tmp_path_factory.mktemp("systemd")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", folder]
    subprocess.run(build, cwd=ROOT, capture_output=True, check=True)
    with zipfile.ZipFile(next(folder.glob("*.whl"))) as archive:
        archive.extractall(folder / "wheel")
    with zipfile.ZipFile(io.BytesIO(wheel())) as archive:
        archive.extractall(folder / "wheel")
    (folder / "machine").mkdir()
    folder.joinpath("mine.py").write_text("def euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n")
    one = systemd.Machine(folder / "machine", Path(sys.prefix), folder / "wheel", UNITS)
    try:
        one.wait("systemctl", "show", "--value", "-p", "ActiveState", "basic.target")
        one("cp", str(folder / "mine.py"), "/var/mine.py")
        one("systemctl", "start", "polhode.service", "polhode-backup.timer")
        one.wait("curl", "--silent", "--fail", "http://127.0.0.1:8000/readyz")
        yield one
    finally:
        one.end()


def ready(machine):
    machine.wait("curl", "--silent", "--fail", "http://127.0.0.1:8000/readyz")


@pytest.mark.slow
def test_the_service_grades_in_namespaces_as_its_own_user(machine):
    answer = json.loads(
        machine("curl", "--silent", "--fail", "-F", "file=@/var/mine.py", "-H", "Prefer: wait=60", PATH)
    )
    assert answer["report"]["passed"] and answer["report"]["provenance"]["isolation"].startswith(
        "namespaces:"
    )
    process = machine("systemctl", "show", "--value", "-p", "MainPID", "polhode.service").strip()
    assert machine("stat", "-c", "%U", f"/proc/{process}").strip() == "polhode"
    assert machine("stat", "-c", "%U %a", "/var/lib/polhode").strip() == "polhode 700"


@pytest.mark.slow
def test_systemd_starts_a_killed_server_again_and_nothing_is_lost(machine):
    before = machine("systemctl", "show", "--value", "-p", "MainPID", "polhode.service").strip()
    count = machine("curl", "--silent", PATH).count('"submitted_at"')
    machine("kill", "-KILL", before)
    machine.wait("sh", "-c", f"test $(systemctl show --value -p MainPID polhode.service) -ne {before}")
    ready(machine)
    assert count > 0 and machine("curl", "--silent", PATH).count('"submitted_at"') == count


@pytest.mark.slow
def test_the_backup_is_written_and_restored(machine):
    machine("systemctl", "start", "polhode-backup.service")
    assert machine("sh", "-c", "stat -c '%U %a' /var/lib/polhode/backup/*.dump").strip() == "polhode 600"
    assert "✓  the data is consistent" in machine("journalctl", "--no-pager", "--unit=polhode-backup.service")
    assert "polhode-backup.timer" in machine("systemctl", "list-timers", "--no-pager")
    machine(
        "sh",
        "-c",
        "touch -d '40 days ago' /var/lib/polhode/backup/old.dump; systemctl start polhode-backup.service",
    )
    assert "old.dump" not in machine("ls", "/var/lib/polhode/backup")


@pytest.mark.slow
def test_stopping_ends_every_process(machine):
    machine("systemctl", "stop", "polhode.service")
    assert machine("systemctl", "show", "--value", "-p", "Result", "polhode.service").strip() == "success"
    assert machine("pgrep", "-u", "polhode", check=False) == ""
    machine("systemctl", "start", "polhode.service")
    ready(machine)


@pytest.mark.slow
def test_the_unit_of_workers_grades_for_the_same_database(machine):
    count = "curl --silent http://127.0.0.1:8000/metrics | grep '^polhode_workers' | grep ready"
    before = float(machine("sh", "-c", count).split()[-1])
    machine(
        "sh",
        "-c",
        "echo 'POLHODE_DATABASE_URL=postgresql://polhode@/polhode?host=/var/lib/polhode/data/run' >"
        " /etc/polhode.env",
    )
    machine("systemctl", "start", "polhode-worker.service")
    machine.wait("sh", "-c", f"test $({count} | cut -d' ' -f2 | cut -d. -f1) -gt {before:.0f}")
    machine("systemctl", "stop", "polhode-worker.service")
    assert (
        machine("systemctl", "show", "--value", "-p", "Result", "polhode-worker.service").strip() == "success"
    )
