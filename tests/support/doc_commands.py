"""The shell commands of the documentation, to parse and to run."""

import os
import re
import subprocess
import sys
import textwrap
from pathlib import Path

from service.cli.server.demo import free_port
from tests.support.checkout import ROOT

SERVE = "polhode serve --port 8000"
START = """polhode serve --port 8000 > serve.log 2>&1 &
server=$!
trap 'kill $server; wait $server' EXIT
curl --silent --fail --retry 120 --retry-delay 1 --retry-all-errors http://localhost:8000/readyz > /dev/null
"""


def blocks(page: Path) -> list[str]:
    """Return the blocks of shell commands of a page."""
    return [
        textwrap.dedent(text)
        for _, text in re.findall(r"^( *)```sh\n(.*?)^\1```", page.read_text(), re.MULTILINE | re.DOTALL)
    ]


def polhode_lines(page: Path) -> list[str]:
    """Return the commands of a page that call polhode, one per line, without pipes and redirections."""
    lines = "\n".join(blocks(page)).replace("\\\n", " ").split("\n")
    starts = [re.sub(r"\s+#.*|[|<>&;].*", "", line.strip()) for line in lines]
    return [line.removeprefix(".venv/bin/") for line in starts if re.match(r"(\.venv/bin/)?polhode ", line)]


def run(page: Path, folder: Path, *, server: bool = False) -> None:
    """Run all blocks of a page as one script in ``folder``; with ``server`` start a server first. Raises if a
    command fails.
    """
    script = (
        "\n".join([SERVE] * server + blocks(page)).replace(SERVE, START).replace("8000", str(free_port()))
    )
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    environment = {k: v for k, v in os.environ.items() if not k.startswith("POLHODE_")} | {
        "PATH": path,
        "TOKEN": "none",
    }
    environment["PYTHONPATH"] = str(ROOT)
    ended = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", script],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, f"{ended.stdout[-3000:]}\n{ended.stderr[-3000:]}"
