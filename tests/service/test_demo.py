"""The demonstration as a newcomer runs it."""

import os
import re
import signal
import subprocess
import sys
import time
import urllib.request


def demo(tmp_path, *arguments):
    environment = os.environ | {"POLHODE_DATA": str(tmp_path / "demo"), "PYTHONUNBUFFERED": "1"}
    return subprocess.Popen([sys.executable, "-m", "service.demo", *arguments], env=environment, stdout=subprocess.PIPE, text=True)


def test_demo_ends_with_the_address_of_a_running_page_and_stops_when_told(tmp_path):
    process = demo(tmp_path)
    try:
        told = ""
        while "Press Ctrl-C" not in told:
            line = process.stdout.readline()
            assert line, told[-2000:]
            told += line
        assert "every specimen got the report it should" in told
        assert told.count("rotational energy conserved (torque-free)   [") > 20
        address = re.search(r"open (http://127\.0\.0\.1:\d+/)", told)[1]
        assert re.search(rb"<b>\d\d/40</b> submitted", urllib.request.urlopen(address, timeout=10).read())
        with urllib.request.urlopen(f"{address}assignments/rigid-body/class", timeout=10) as answer:
            assert b'<td class="pass">' in answer.read(), "what was graded so far is shown"
        process.send_signal(signal.SIGINT)
        process.stdout.close()
        assert process.wait(30) == 0
        time.sleep(0.2)
        assert not (tmp_path / "demo" / "postgres" / "postmaster.pid").exists()
    finally:
        process.terminate()  # it stops its server, however the test went
        process.wait(60)
