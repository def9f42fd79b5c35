"""Grade in the tests' own warm guest, where ``polhode grade`` would start one for each command."""

import os
import sys

from service.grading import batch
from service.sandbox import guest_process
from service.sandbox.sandbox import Sandbox


def lend(sandbox, monkeypatch):
    """Let what this process grades run in ``sandbox``; the processes of ``--jobs 2`` start a guest each as
    always.
    """
    here = os.getpid()
    monkeypatch.setattr(sandbox, "close", lambda: None)
    for module in (batch, sys.modules["service.sandbox.sandbox"]):
        monkeypatch.setattr(
            module, "Sandbox", lambda *options: sandbox if os.getpid() == here else Sandbox(*options)
        )
    monkeypatch.setattr(guest_process, "GuestProcess", lambda *options, libraries: None)
