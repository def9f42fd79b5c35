"""The user that a guest runs as: what it reports, files below closed folders, and what happens if it stays
root.
"""

import ctypes
import os
import shutil
import subprocess
import sys

import pytest

from service.sandbox.guest.confinement.lockdown import GUEST_UID
from service.sandbox.isolation import bubblewrap, levels, select
from service.sandbox.isolation.bubblewrap import find_bubblewrap, namespace_isolation
from service.sandbox.isolation.credentials import Identity
from service.sandbox.isolation.levels import process_isolation
from service.sandbox.job import Cell, Job, SceneRequest
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox

LEVELS = pytest.mark.parametrize(
    ("module", "make"),
    [
        pytest.param(levels, process_isolation, id="process"),
        pytest.param(
            bubblewrap,
            lambda **more: namespace_isolation(find_bubblewrap(), **more),
            id="namespaces",
            marks=pytest.mark.slow,
        ),
    ],
)
AS_ROOT = pytest.mark.skipif(os.geteuid() != 0, reason="needs root")
# imported by no zygote
LAZY = (
    "import bz2, scipy.stats, polhode.client.transport.pyodide, matplotlib.tri\n"
    "print(open('/dev/null').read() == '')"
)


@pytest.fixture
def copied(tmp_path):
    """A copy of the guest's code below a folder that is closed to others."""
    tmp_path.chmod(0o700)
    return shutil.copytree(
        levels.GUEST, tmp_path / "open" / "guest", ignore=shutil.ignore_patterns("__pycache__")
    )


def identity_of(isolation):
    """Run the self-test of a sandbox and a submission that imports more; return the identity that its guest
    reported.
    """
    sandbox = Sandbox(isolation)
    try:
        sandbox.self_test()
        scene = SceneRequest("one", "ask", "f", {}, {}, 5.0, None)
        seen = sandbox.play(Job("", "", (Cell("submission.py", LAZY),), ("f",), (scene,)))
        assert seen.stdout == "True\n", seen.cells
        return sandbox.identity
    finally:
        sandbox.close()


def test_the_guest_reports_a_user_without_privileges(either_sandbox):
    user, group = (GUEST_UID, GUEST_UID) if os.geteuid() == 0 else (os.getuid(), os.getgid())
    found = either_sandbox.identity
    assert found.users == [user] * 3 and found.groups[:3] == [group] * 3 and found.capabilities == []
    assert os.geteuid() != 0 or found.groups[3:] == []


@AS_ROOT
def test_another_user_finds_its_files_below_a_closed_folder(copied, monkeypatch):
    monkeypatch.setattr(levels, "GUEST", copied)
    made = process_isolation()
    assert str(copied.parent) in made.around[-1] and not made.stays_root
    found = identity_of(made)
    assert found.users == [GUEST_UID] * 3 and found.groups == [GUEST_UID] * 3


@pytest.mark.slow
@AS_ROOT
@LEVELS
def test_a_guest_that_stays_root_is_refused_unless_a_setting_allows_it(
    module, make, copied, monkeypatch, caplog
):
    copied.chmod(0o700)
    monkeypatch.setattr(module, "GUEST", copied)
    with pytest.raises(
        SystemFault, match=rf"would run as root, because {copied} is closed.*chmod.*POLHODE_ALLOW_ROOT_GUEST"
    ):
        identity_of(make())
    assert not caplog.records
    allowed = make(allow_root=True)
    found = identity_of(allowed)
    assert found.is_root and not found.capabilities and "user 0 (root)" in str(found)
    assert allowed.name.endswith(" (the guest runs as root)") and "submissions run as root" in caplog.text
    assert select.with_packages(allowed, ["iniconfig"]).allow_root


@AS_ROOT
@pytest.mark.slow
@pytest.mark.parametrize(
    ("allowed", "code", "printed"),
    [
        ("false", 2, "because root may not change to user 64001 here"),
        ("true", 0, "guest         user 0 (root), groups 0"),
    ],
)
def test_root_that_may_not_change_its_user(allowed, code, printed):
    """As in a container without the capability SETUID."""

    def drop_setuid():
        assert ctypes.CDLL(None).prctl(24, 7, 0, 0, 0) == 0  # PR_CAPBSET_DROP, CAP_SETUID

    command, environment = (
        [sys.executable, "-m", "service.cli", "doctor"],
        os.environ | {"POLHODE_ALLOW_ROOT_GUEST": allowed},
    )
    done = subprocess.run(
        command, env=environment, preexec_fn=drop_setuid, capture_output=True, text=True, check=False
    )
    assert done.returncode == code and printed in done.stdout, done.stdout


def test_a_guest_with_a_capability_is_refused_whatever_the_setting():
    allowed = process_isolation(allow_root=True)
    assert "kept the capabilities 7" in Identity([1000] * 3, [1000] * 3, [7]).refusal(allowed)
    assert Identity([1000] * 3, [0] * 3, []).refusal(process_isolation()) == ""
