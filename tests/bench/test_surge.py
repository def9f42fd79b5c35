"""A small surge, whose gradings are waits: the workers' stand-ins have all that a worker calls."""

import subprocess
import sys

import pytest

from tests.support.checkout import ROOT


@pytest.mark.slow
def test_stand_ins_grade_every_submission():
    command = [sys.executable, "-m", "bench.surge", "--students", "3", "--seconds", "3", "--waits"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=400)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "graded 9, faults 0 [], lost 0" in done.stdout and "Traceback" not in done.stderr
