"""Check a release: ``python -m tests.support.release`` examines the docs' pictures, builds the wheels of the
server and the kit and the server's sdist in dist/, and installs and uses the wheels.

They are installed with the hashed lock file into an empty environment of each given Python, outside the
clone: there it grades a file, serves and grades the same over HTTP, and backs up and restores its database.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
import tomllib
import urllib.request
import zipfile
from pathlib import Path

from polhode.client.kit_hash import WHEEL
from service.cli.server.demo import free_port
from tests.support.checkout import ROOT
from tests.support.pictures import shown

DIST = ROOT / "dist"
BIN = Path(sys.executable).parent
SAMPLE = ROOT / "exercises/rigid_body/samples/right_terms.py"
LEFT_OUT = re.compile(r"(^|/)(samples|tests|\.venv|\.cache|\.site|dist)/|\.(dump|env)$")


class Refused(Exception):
    """The release is not in order; the message says why."""


def main() -> int:
    """Run every check and return 0 if all pass."""
    parser = argparse.ArgumentParser(prog="release-check", description=__doc__)
    parser.add_argument(
        "pythons", nargs="*", default=[sys.executable], help="interpreters to install the wheel for"
    )
    pythons = parser.parse_args().pythons
    try:
        version = tagged_version()
        examine_pictures()
        wheel, sdist = build(version)
        examine(wheel, sdist)
        for python in pythons:
            use(wheel, python)
    except Refused as refusal:
        print(f"✗  {refusal}")
        return 1
    print(f"✓  {wheel.name} and {sdist.name} are in order")
    return 0


def tagged_version() -> str:
    """Return the version, which the changelog and CITATION.cff name too if this commit has a tag ``v…``; then
    the tag is it.
    """
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    if f"version: {version}\n" not in (ROOT / "CITATION.cff").read_text():
        raise Refused(f"CITATION.cff does not have the version {version}")
    tags = run("git", "tag", "--points-at", "HEAD").split()
    if releases := [tag for tag in tags if tag.startswith("v")]:
        if releases != [f"v{version}"]:
            raise Refused(f"the tag is {', '.join(releases)}, and the version in pyproject.toml {version}")
        if f"\n## {version}" not in (ROOT / "CHANGELOG.md").read_text():
            raise Refused(f"CHANGELOG.md has no heading ## {version}")
    print(f"✓  version {version}" + ("" if releases else ", not tagged"))
    return str(version)


def examine_pictures(root: Path = ROOT) -> None:
    """Refuse pictures of the docs that show former templates."""
    if former := shown.outdated(root):
        raise Refused("\n   ".join(f"{name} shows former templates: run make pictures" for name in former))
    print("✓  the pictures of the docs show the present templates")


def build(version: str) -> tuple[Path, Path]:
    """Build the sdist and, from it, the wheel; refuse a wheel that differs from that of the clone."""
    shutil.rmtree(DIST, ignore_errors=True)
    run(BIN / "python", "-m", "hatchling", "build", "-d", DIST)
    run(BIN / "python", "-m", "hatchling", "build", "-t", "wheel", "-d", DIST, cwd=ROOT / "exercises/kit")
    wheel, sdist = DIST / f"polhode-{version}-py3-none-any.whl", DIST / f"polhode-{version}.tar.gz"
    with tempfile.TemporaryDirectory() as folder:
        run("tar", "-xzf", sdist, "-C", folder)  # tarfile has no filter before Python 3.11.4
        run(
            BIN / "python",
            "-m",
            "hatchling",
            "build",
            "-t",
            "wheel",
            "-d",
            f"{folder}/dist",
            cwd=Path(folder) / f"polhode-{version}",
        )
        if contents(wheel) != contents(Path(folder) / "dist" / wheel.name):
            raise Refused("the wheel built from the sdist differs from the one of the clone")
    print("✓  the sdist builds the same wheel")
    return wheel, sdist


def contents(wheel: Path) -> dict[str, bytes]:
    """Return the files of a wheel."""
    with zipfile.ZipFile(wheel) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def examine(wheel: Path, sdist: Path) -> None:
    """Let twine and check-wheel-contents examine the files; refuse solutions and leftovers."""
    run(BIN / "twine", "check", "--strict", wheel, sdist)
    run(BIN / "twine", "check", DIST / WHEEL)
    run(BIN / "check-wheel-contents", wheel)
    run(BIN / "check-wheel-contents", "--toplevel", "polhode", DIST / WHEEL)
    if strays := [n for built in (wheel, DIST / WHEEL) for n in contents(built) if LEFT_OUT.search(n)]:
        raise Refused(f"a wheel contains {', '.join(strays[:5])}")
    if both := contents(wheel).keys() & contents(DIST / WHEEL).keys():
        raise Refused(f"both wheels contain {', '.join(sorted(both)[:5])}")
    with tarfile.open(sdist) as archive:
        inside = {name.partition("/")[2] for name in archive.getnames()} - {"", "PKG-INFO"}
    if strays := sorted(inside - set(run("git", "ls-files").splitlines())):
        raise Refused(f"the sdist contains files that git does not know: {', '.join(strays[:5])}")
    print("✓  twine and check-wheel-contents find nothing, and neither file contains leftovers")


def use(wheel: Path, python: str) -> None:
    """Install the wheel in an empty environment, and grade and serve with it outside the clone."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("POLHODE_", "PYTHON"))}
    with tempfile.TemporaryDirectory(prefix="release-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        folder.chmod(0o755)  # the sandbox of a root's server reads it as another user
        run(python, "-m", "venv", folder / "venv")
        install = [
            folder / "venv/bin/python",
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
        ]
        run(*install, "--require-hashes", "-r", ROOT / "requirements/runtime.lock", env=environment)
        run(*install, "--no-deps", DIST / WHEEL, wheel, env=environment)
        run(folder / "venv/bin/python", "-m", "pip", "check", env=environment)
        polhode = folder / "venv/bin/polhode"
        printed = run(polhode, "grade", SAMPLE, "--exercise", "2", "--json", env=environment, cwd=folder)
        report = json.loads(printed)["reports"][0]["report"]
        if not report["passed"]:
            raise Refused(
                f"the installed wheel grades {SAMPLE.name} with {report['score']} of {report['max_score']}"
                " points"
            )
        isolation = serve(polhode, folder, environment)
        keep(polhode, folder, environment)
        print(
            f"✓  {report['provenance']['versions']['python']}: installed outside the clone it grades, serves"
            f" ({isolation}), backs up and restores"
        )


def serve(polhode: Path, folder: Path, environment: dict[str, str]) -> str:
    """Serve in ``folder``, grade a submission over HTTP and return the isolation level."""
    address = f"http://127.0.0.1:{(port := free_port())}"
    with (folder / "log").open("wb") as log:
        server = subprocess.Popen(
            [polhode, "serve", "--port", str(port)],
            cwd=folder,
            env=environment | {"POLHODE_WORKERS": "1"},
            stdout=log,
            stderr=log,
        )
    try:
        for _ in range(300):
            try:
                urllib.request.urlopen(f"{address}/readyz", timeout=5).close()
                break
            except OSError:  # not listening, or no worker yet
                time.sleep(0.2)
        body = json.dumps({"source": SAMPLE.read_text(), "exercises": ["2"]}).encode()
        headers = {"Content-Type": "application/json", "Prefer": "wait=60"}
        request = urllib.request.Request(f"{address}/v1/assignments/rigid-body/submissions", body, headers)
        with urllib.request.urlopen(request, timeout=90) as answer:
            report = json.load(answer)["report"]
    except OSError as error:
        raise Refused(f"the installed server: {error}\n{(folder / 'log').read_text()[-1000:]}") from error
    finally:
        server.terminate()
        server.wait(30)
    if not (report and report["passed"]):
        raise Refused("the installed server does not pass a right submission")
    return str(report["provenance"]["isolation"])


def keep(polhode: Path, folder: Path, environment: dict[str, str]) -> None:
    """Back up what ``serve`` has stored in ``folder``, and restore it into an empty database, which must then
    have the same content.
    """
    backup = folder / "backup.dump"
    run(polhode, "db", "backup", backup, env=environment, cwd=folder)
    run(polhode, "db", "drill", backup, env=environment, cwd=folder)


def run(*command: object, cwd: Path = ROOT, env: dict[str, str] | None = None) -> str:
    """Run a command and return what it prints. Raises Refused with its last lines if it fails."""
    done = subprocess.run(
        [str(word) for word in command], cwd=cwd, env=env, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        raise Refused(
            f"{' '.join(map(str, command[:6]))} ended with {done.returncode}:\n"
            f"{(done.stdout + done.stderr)[-2000:]}"
        )
    return done.stdout


if __name__ == "__main__":
    sys.exit(main())
