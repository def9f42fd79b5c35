"""Bubblewrap's namespaces by their effect, without the layers that a child adds."""

import json
import os
import socket
import subprocess

from service.sandbox.isolation.guest_files import STANDARD_LIBRARY
from service.sandbox.isolation.select import choose

SOURCE = """
import json, os, socket, sys
told = {"pid": os.getpid(), "variables": sorted(os.environ)}
told["there"] = [path for path in sys.argv[3:] if os.path.exists(path)]
try:
    socket.create_connection(("127.0.0.1", int(sys.argv[1])), 5).close()
    told["connected"] = True
except OSError:
    told["connected"] = False
try:
    os.kill(int(sys.argv[2]), 0)
    told["signalled"] = True
except OSError:
    told["signalled"] = False
try:
    open("/polhode/x", "w")
    told["written"] = True
except OSError:
    told["written"] = False
print(json.dumps(told))
"""


def test_network_processes_files_and_variables_of_the_machine_are_not_there(monkeypatch):
    monkeypatch.setenv("POLHODE_CANARY", "swordfish")
    other_packages = [str(path) for path in STANDARD_LIBRARY.glob("*-packages/pip")]
    isolation, files = choose("namespaces"), ["/proc", "/etc/passwd", __file__, *other_packages]
    with socket.create_server(("127.0.0.1", 0)) as listening:
        numbers = [str(listening.getsockname()[1]), str(os.getpid())]
        command = [*isolation.around, isolation.inside[0], "-I", "-S", "-c", SOURCE, *numbers, *files]
        told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found = json.loads(told)
    assert found["pid"] < 10 and found["there"] == []
    assert not found["connected"] and not found["signalled"] and not found["written"]
    assert "POLHODE_CANARY" not in found["variables"] and "PATH" in found["variables"]


def test_the_mounts_are_few():
    assert (
        choose("namespaces").around.count("--ro-bind") < 120
    )  # bwrap's time grows with their square: 0.2 s for 280
