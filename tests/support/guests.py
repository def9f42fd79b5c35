"""Grade in the tests' own warm guest, where ``polhode grade`` would start one for each command."""

import os

from service.cli.grading import grade
from service.grading import grade_files
from service.sandbox.sandbox import Sandbox


def lend(sandbox, monkeypatch):
    """Let what this process grades run in ``sandbox``; the processes of ``--jobs 2`` start a guest each as
    always.
    """
    here = os.getpid()

    def lent(*options, **named):
        return sandbox if os.getpid() == here else Sandbox(*options, **named)

    monkeypatch.setattr(sandbox, "close", lambda: None)
    for module in (grade_files, grade):
        monkeypatch.setattr(module, "Sandbox", lent)
