"""The image as its users have it: built, looked into, run without privileges and with those for namespaces,
and as a whole course.

``make image-test`` runs it, in about five minutes, as root on Debian; BASE and POSTGRES_IMAGE name public
images to use instead of stand-ins made of Debian's packages. Exit code 0 if all was as docs/docker.md says,
else 1.
"""

import json
import os
import signal
import sys
import tempfile
import time
from hashlib import sha256
from pathlib import Path

from exercises.authoring.assignments.catalogue import assignments
from exercises.authoring.assignments.samples import Sample, samples
from service.cli.server.demo import free_port
from tests.image import calls, stand_ins
from tests.image.course import BY_WORKER, LOST, Course, stop
from tests.image.engine import Failed, Podman

ROOT = Path(__file__).parents[2]
IMAGE, MOST_BYTES = "localhost/polhode", 700e6
HARDENED = ["--read-only", "--tmpfs", "/tmp", "--cap-drop", "ALL", "--security-opt", "no-new-privileges"]
NAMESPACES = [
    "--cap-drop",
    "ALL",
    "--security-opt",
    "seccomp=unconfined",
    "--security-opt",
    "apparmor=unconfined",
]
KNOWN = {one.file.stem: one for one in samples(assignments()["rigid-body"])}
RIGHT, WRONG = KNOWN["right_all"], KNOWN["wrong_sign_flipped"]
SOME = [RIGHT, WRONG, KNOWN["right_animation_box"], KNOWN["wrong_zeros"]]
EVERY_FILE = """
import hashlib, os, sys
for folder, _, names in os.walk("/", onerror=lambda error: None):
    if not folder.startswith(("/proc", "/sys", "/dev")):
        for path in (os.path.join(folder, name) for name in names if name.endswith((".py", ".ipynb"))):
            print(hashlib.sha256(open(path, "rb").read()).hexdigest(), path)
"""


def main() -> int:
    """Every step in order; the first that is not as it should be ends it."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    podman = Podman(Path(tempfile.mkdtemp(prefix="polhode-image-", dir="/var/tmp")))
    try:
        _build(podman)
        _look_into(podman)
        _run_plainly(podman)
        _run_with_namespaces(podman)
        _run_course(podman)
    except (Failed, KeyboardInterrupt) as error:
        _say(f"✗ {error or 'interrupted'}")
        return 1
    finally:
        podman.end()
    _say("everything is as docs/docker.md says")
    return 0


def _build(podman: Podman) -> None:
    _say("a base")
    base = os.environ.get("BASE") or stand_ins.python(podman)
    _say(f"building on {base}, with {podman.adapt(base)}")
    arguments = ["--build-arg", f"BASE={base}", "--network", "host", "--format", "docker", "--tag", IMAGE]
    if index := os.environ.get("PIP_INDEX_URL"):
        arguments += ["--build-arg", f"PIP_INDEX_URL={index}"]
    if certificates := os.environ.get("SSL_CERT_FILE"):
        arguments += ["--secret", f"id=ca,src={certificates}"]
    podman("build", *arguments, str(ROOT), seconds=1200)


def _look_into(podman: Podman) -> None:
    about = json.loads(podman("inspect", "--type", "image", IMAGE))[0]
    size, user = about["Size"], about["Config"]["User"]
    _expect(size < MOST_BYTES, f"{size / 1e6:.0f} MB")
    _expect(user.isdigit() and int(user) > 0, f"runs as user {user}")
    files = dict(line.split(" ", 1) for line in _inside(podman, "python3", "-c", EVERY_FILE).splitlines())
    kept_out = [*(one.file for one in KNOWN.values()), *(ROOT / "tests").rglob("*.py")]
    found = [files[digest] for path in kept_out if (digest := sha256(path.read_bytes()).hexdigest()) in files]
    _expect(
        len(files) > 1000 and not found,
        f"{len(files)} different Python files, no sample or test among them {found or ''}",
    )
    told = _inside(
        podman, "sh", "-c", "python3 -v -c 'import service.app, service.workers.worker, scipy.integrate' 2>&1"
    )
    slow = [
        line
        for line in told.splitlines()
        if line.startswith("# code object from") and not line.endswith("c'")
    ]
    fast = told.count(".pyc matches")
    _expect(fast > 500 and not slow, f"{fast} modules imported, all from bytecode {slow[:3] or ''}")


def _run_plainly(podman: Podman) -> None:
    """As a container of Docker's or podman's default, with nothing more allowed and much less."""
    profile = ["--security-opt", f"seccomp={podman.profile()}"]
    address, took = _serve(podman, "plain", *HARDENED, *profile)
    _expect(
        calls.readyz(address)["checks"]["isolation"].startswith("process:"),
        f"HEALTHCHECK succeeds after {took:.1f} s, at isolation level process",
    )
    _expect(
        "isolation     process:" in podman("exec", "plain", "polhode", "doctor"), "polhode doctor says so"
    )
    able = podman("exec", "plain", "grep", "-E", "^(Uid|CapEff|NoNewPrivs)", "/proc/1/status").split()
    _expect(
        able[1] != "0" and able[6] == "0" * 16 and able[8] == "1",
        f"no root, and no more rights than {' '.join(able[5:])}",
    )
    ids = _grade(address)
    _say(f"✓ SIGTERM ends it in {stop(podman, 'plain'):.1f} s with exit code 0")
    podman("start", "plain")
    calls.until(lambda: calls.readyz(address).get("status") == "ready", 60, "ready again")
    for id, one in ids.items():
        calls.graded(address, id, one)
    _say("✓ started again on its volume, it has them still")
    podman("rm", "--force", "--volumes", "plain")


def _run_with_namespaces(podman: Podman) -> None:
    """With what docs/docker.md says isolation level namespaces needs."""
    address, _ = _serve(podman, "namespaces", *NAMESPACES)
    told = podman("exec", "namespaces", "polhode", "doctor")
    if "namespaces    yes" not in told:
        _say(f"– this machine gives no namespaces, so isolation level namespaces was not tried:\n{told}")
    else:
        _expect(
            calls.readyz(address)["checks"]["isolation"].startswith("namespaces:"),
            "namespaces by their documented flags, without a capability",
        )
        _grade(address)
    podman("rm", "--force", "--volumes", "namespaces")


def _run_course(podman: Podman) -> None:
    _say("a database for docker-compose.yml")
    postgres = os.environ.get("POSTGRES_IMAGE") or stand_ins.postgres(podman)
    course = Course(podman, ROOT / "docker-compose.yml", IMAGE, postgres)
    course.up()
    token = course.enter_people()
    course.publish()
    course.grade(SOME * 3, token)
    shares = dict(line.split("|") for line in course.query(BY_WORKER).split())
    _expect(len(shares) == 2, f"{len(SOME) * 3} submissions with a token, graded by two workers: {shares}")
    killed = course.grade_while_one_dies(SOME * 3, token)
    counted = (
        f"{course.query(LOST)} lost run(s),"
        f" {course.query('SELECT count(*) FROM result WHERE fault IS NOT NULL')} faults"
    )
    _say(f"✓ {len(SOME) * 3} more while {killed} is killed: each has its report ({counted})")
    _say(f"✓ stopped in {course.stop(but=killed):.1f} s, all with exit code 0")


def _serve(podman: Podman, name: str, *flags: str) -> tuple[str, float]:
    """A server in a container, healthy by the image's own HEALTHCHECK: its address and how long that took."""
    port, began = free_port(), time.monotonic()
    podman("run", "--detach", "--init", "--name", name, "--publish", f"127.0.0.1:{port}:8000", *flags, IMAGE)
    # `healthcheck run` hides failures
    check = json.loads(podman("inspect", "--format", "{{json .Config.Healthcheck.Test}}", name))
    calls.until(lambda: podman.works("exec", name, *check[1:]), 90, f"{name} is healthy")
    took, address = time.monotonic() - began, f"http://127.0.0.1:{port}"
    calls.until(lambda: calls.readyz(address), 10, f"{address} answers")
    return address, took


def _grade(address: str) -> dict[str, Sample]:
    ids = {calls.submit(address, one): one for one in (RIGHT, WRONG)}
    for id, one in ids.items():
        report = calls.graded(address, id, one)
        _expect(report["passed"] == (one is RIGHT), f"{one.file.name}  {calls.marks(report)}")
    return ids


def _inside(podman: Podman, *command: str) -> str:
    return podman("run", "--rm", "--no-healthcheck", IMAGE, *command)


def _expect(right: bool, told: str) -> None:
    if not right:
        raise Failed(f"not so: {told}")
    _say(f"✓ {told}")


def _say(told: str) -> None:
    print(f"{time.monotonic() - BEGAN:6.1f} s  {told}", flush=True)


BEGAN = time.monotonic()

if __name__ == "__main__":
    sys.exit(main())
