"""The picture of a notebook in JupyterLab: a local check, and the server's report."""

import json
import os
import secrets
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Browser

from polhode.client.kit_hash import WHEEL
from service.cli.server.demo import free_port
from tests.support.pictures.browser import open_page, save

NAME = "my-rigid-body.ipynb"
CELLS = (
    "%pip install -q {address}/kit/{kit}",
    """\
import polhode
import numpy as np
polhode.connect("{address}", assignment="rigid-body")

def euler_eqs(t, w, I):
    I1, I2, I3 = I
    return np.array([
        (I3 - I2) * w[1] * w[2] / I1,
        (I3 - I1) * w[2] * w[0] / I2,
        (I1 - I2) * w[0] * w[1] / I3,
    ])""",
    'polhode.check("2")',
    'polhode.submit(euler_eqs, exercises=["2"])',
)
WIDTH, STATUS_BAR = 1200, 40
SCROLLED = 2  # the cell whose long output scrolls
SETTINGS = {  # of a JupyterLab that asks nothing and renders every cell
    "apputils-extension/notification": {"fetchNews": "false", "checkForUpdates": False},
    "notebook-extension/tracker": {"windowingMode": "none"},
}
LOADED = """() => {
    const prompts = [...document.querySelectorAll(".jp-CodeCell .jp-InputPrompt")].map(p => p.textContent);
    return prompts.every(p => /\\[\\d+\\]/.test(p)) && [...document.images].every(i => i.complete);
}"""


def draw(browser: Browser, address: str, folder: Path, file: Path) -> Path:
    """Write the picture of a notebook that JupyterLab runs in ``folder`` with the kit of the server."""
    folder.mkdir()
    (folder / NAME).write_text(json.dumps(_notebook(address)), encoding="utf-8")
    with _jupyterlab(folder) as lab, open_page(browser, width=WIDTH) as page:
        page.goto(lab)
        page.get_by_text("Python 3 (ipykernel) | Idle").wait_for()
        page.keyboard.press("Control+b")  # hides the list of files
        page.locator(".jp-Cell").first.click()
        page.get_by_role("menuitem", name="Run", exact=True).click()
        page.get_by_text("Run All Cells", exact=True).click()
        page.wait_for_function(LOADED)
        page.get_by_text("Python 3 (ipykernel) | Idle").wait_for()
        figure = page.locator(".jp-Cell").last.locator("figure").first.bounding_box()
        page.set_viewport_size({"width": WIDTH, "height": round(figure["y"] + figure["height"] + STATUS_BAR)})
        page.wait_for_timeout(1000)
        return save(page.screenshot(), file)


def _notebook(address: str) -> dict[str, object]:
    kit = WHEEL
    cells = [
        {
            "id": f"cell-{number}",
            "cell_type": "code",
            "metadata": {"scrolled": True} if number == SCROLLED else {},
            "execution_count": None,
            "outputs": [],
            "source": source.replace("{address}", address).replace("{kit}", kit),
        }
        for number, source in enumerate(CELLS)
    ]
    kernel = {"name": "python3", "display_name": "Python 3 (ipykernel)", "language": "python"}
    return {"nbformat": 4, "nbformat_minor": 5, "metadata": {"kernelspec": kernel}, "cells": cells}


@contextmanager
def _jupyterlab(folder: Path) -> Iterator[str]:
    """Provide the address of the notebook in a JupyterLab; the kit is installed into ``folder``."""
    for name, values in SETTINGS.items():
        settings = folder / "settings/@jupyterlab" / f"{name}.jupyterlab-settings"
        settings.parent.mkdir(parents=True, exist_ok=True)
        settings.write_text(json.dumps(values), encoding="utf-8")
    (kit := folder / "kit").mkdir()
    own = {"PIP_TARGET": str(kit), "PYTHONPATH": str(kit), "PIP_NO_DEPS": "1", "PIP_CONFIG_FILE": os.devnull}
    own |= {"XDG_CACHE_HOME": str(folder / "cache")}
    own |= {"PIP_DISABLE_PIP_VERSION_CHECK": "1", "PIP_ROOT_USER_ACTION": "ignore"}
    own |= {f"JUPYTER_{name}_DIR": str(folder / name.lower()) for name in ("CONFIG", "DATA", "RUNTIME")}
    own |= {"JUPYTERLAB_SETTINGS_DIR": str(folder / "settings"), "IPYTHONDIR": str(folder / "ipython")}
    own |= {"JUPYTERLAB_WORKSPACES_DIR": str(folder / "workspaces")}
    port, token = free_port(), secrets.token_hex()
    command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", f"--port={port}"]
    command += ["--ip=127.0.0.1", f"--ServerApp.root_dir={folder}", f"--IdentityProvider.token={token}"]
    address, log = f"http://127.0.0.1:{port}", folder / "jupyterlab.log"
    with log.open("wb") as lines:
        process = subprocess.Popen(command, env=os.environ | own, stdout=lines, stderr=lines)
    try:
        while True:
            try:
                urllib.request.urlopen(f"{address}/api", timeout=5).close()
                break
            except OSError:
                if process.poll() is not None:
                    raise SystemExit(f"JupyterLab ended:\n{log.read_text()[-2000:]}") from None
                time.sleep(0.3)
        yield f"{address}/lab/tree/{NAME}?token={token}"
    finally:
        process.terminate()
        process.wait(30)
