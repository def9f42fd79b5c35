"""The kit in real Pyodide, as JupyterLite runs it: in a web worker of another site, against a server with a
worker.

npm's package has Python and its standard library. numpy and scipy for WebAssembly are in no package registry:
Pyodide fetches them from its own site. POLHODE_PYODIDE names a folder with a complete Pyodide, in which
``polhode.check`` is tried too. Without it, modules stand in for numpy and scipy, of which ``polhode.submit``
needs little more than the names.
"""

import functools
import http.server
import json
import os
import shutil
import subprocess
import threading
from pathlib import Path

import pytest

from polhode.client.kit_hash import WHEEL

pytestmark = pytest.mark.slow  # it starts a browser and downloads 6 MB
PYODIDE = "pyodide@314.0.7"
EULER = """def euler_eqs(t, w, I):
    return [
        (I[1] - I[2]) * w[1] * w[2] / I[0],
        (I[2] - I[0]) * w[2] * w[0] / I[1],
        (I[0] - I[1]) * w[0] * w[1] / I[2],
    ]
"""
WORKER = """
import { loadPyodide } from "./pyodide.mjs";
let pyodide;
onmessage = async ({ data: { action, argument } }) => {
  try {
    if (action === "start") {
      pyodide = await loadPyodide();
      const kit = await fetch(argument.kit);
      pyodide.unpackArchive(await kit.arrayBuffer(), "wheel");
      if (argument.packages.length) await pyodide.loadPackage(argument.packages);
      postMessage({ result: pyodide.version });
    } else {
      const waits = action === "wait";
      const result = waits ? await pyodide.runPythonAsync(argument) : pyodide.runPython(argument);
      postMessage({ result: String(result) });
    }
  } catch (error) { postMessage({ error: String(error) }); }
};
"""
ASK = """([action, argument]) => new Promise(done => {
  window.kernel ??= new Worker("./worker.mjs", { type: "module" });
  window.kernel.onmessage = event => done(event.data);
  window.kernel.postMessage({ action, argument });
})"""
STAND_IN = Path(__file__).parents[1] / "support" / "stand_in.py"


class Site(http.server.SimpleHTTPRequestHandler):
    """Files of a folder, with the media types that a browser demands of modules."""

    extensions_map = http.server.SimpleHTTPRequestHandler.extensions_map | {
        ".mjs": "text/javascript",
        ".wasm": "application/wasm",
    }

    def log_message(self, *_):
        pass


@pytest.fixture(scope="module")
def pyodide(tmp_path_factory):
    """A folder with Pyodide, and whether it has numpy and scipy."""
    if complete := os.environ.get("POLHODE_PYODIDE"):
        return Path(complete), True
    if shutil.which("npm") is None:
        pytest.skip("no npm on this machine, from which Pyodide comes: apt-get install npm")
    folder = tmp_path_factory.mktemp("pyodide")
    packed = subprocess.run(
        ["npm", "pack", "--silent", PYODIDE], cwd=folder, capture_output=True, text=True, check=False
    )
    if packed.returncode:
        pytest.skip(f"npm cannot download {PYODIDE}: {packed.stderr[-200:]}")
    # tarfile has no filter before Python 3.11.4
    subprocess.run(["tar", "-xzf", packed.stdout.split()[-1]], cwd=folder, check=True)
    return folder / "package", False


@pytest.fixture(scope="module")
def site(pyodide, tmp_path_factory):
    """The address of a site with Pyodide, a page and the worker."""
    folder = tmp_path_factory.mktemp("site")
    for path in pyodide[0].iterdir():
        (folder / path.name).symlink_to(path)
    (folder / "worker.mjs").write_text(WORKER)
    (folder / "index.html").write_text('<!doctype html><title>Lite</title><link rel="icon" href="data:,">')
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Site, directory=folder))
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{server.server_address[1]}"
    server.shutdown()
    server.server_close()
    thread.join()


@pytest.fixture(scope="module")
def server(new_server, tmp_path_factory, site):
    """A server with one worker that accepts requests from the site."""
    started = new_server(tmp_path_factory.mktemp("lite") / "data", POLHODE_WORKERS="1", POLHODE_ORIGINS=site)
    yield started
    started.stop()


@pytest.fixture
def python(page, site, server, pyodide):
    """``python(code)`` runs code in the worker's Python, which has the kit, and returns the text of its last
    expression.
    """
    page = page()
    page.set_default_timeout(120_000)
    page.goto(site)

    def ask(action, argument):
        found = page.evaluate(ASK, [action, argument])
        assert "error" not in found, found["error"]
        return found["result"]

    kit = f"{server.url}/kit/{WHEEL}"
    ask("start", {"kit": kit, "packages": ["numpy", "scipy"] if pyodide[1] else []})
    if not pyodide[1]:
        ask("run", STAND_IN.read_text())
    ask("run", f'import polhode\npolhode.connect("{server.url}", assignment="rigid-body")')
    ask("run", EULER)
    return ask


@pytest.mark.parametrize("how", ["wait", "run"], ids=["waits for promises", "synchronous"])
def test_a_submission_is_graded_and_its_report_is_read(python, how):
    assert python("run", "import sys; sys.platform") == "emscripten"
    assert python(how, 'open("mine.py", "w").write("x = 1")') == "5"
    python(
        how, "import io, contextlib\nwith contextlib.redirect_stdout(io.StringIO()) as said: polhode.login()"
    )
    assert "is ready. Deadline: none." in python(how, "said.getvalue()")
    source = json.dumps(EULER + f"# {how}\n")
    python(
        how, f'open("mine.py", "w").write({source})\nreport = polhode.submit(file="mine.py", exercises=["2"])'
    )
    assert python(how, "report.summary()") == "5 of 5 points (public checks: 3 of 3)"
    assert python(how, 'report.drawn(report.figures[0].name)[:4] == b"\\x89PNG"') == "true"
    assert "5 of 36 + 6 bonus" in python(how, "repr(polhode.submissions())")
    again = 'polhode.submit(file="mine.py", exercises=["2"]).remark.startswith("Not submitted again")'
    assert python(how, again) == "true"


LIMITED = """
from polhode.judging.time_limit import OutOfTime, limited
ended = ""
try:
    with limited(0.5):
        exec(loop)
except OutOfTime:
    ended = "out of time"
ended
"""


def test_an_endless_loop_ends_after_its_time(python):
    broad = "while True:\n    try:\n        1 / 0\n    except Exception:\n        pass"
    for loop in ("while True:\n    pass", "while True: pass", broad):
        assert python("run", f"loop = {loop!r}\n{LIMITED}") == "out of time", loop


def test_the_checks_of_a_cell_are_those_of_the_server(python, pyodide):
    if not pyodide[1]:
        pytest.skip("npm's Pyodide has no numpy: name a folder with a complete Pyodide in POLHODE_PYODIDE")
    assert python("wait", 'polhode.check("2").summary()') == "3 of 3 public checks ✓"
    assert python("wait", "polhode.submit(euler_eqs).summary()").startswith("5 of 36, +0 of 6 bonus points")


def test_the_courses_package_that_connect_brings_is_imported_after_what_is_installed(python):
    which = "from ecp.validate import check\nimport ecp\necp.__file__"
    assert python("run", which).endswith("/assignments/rigid_body/course/ecp/__init__.py")
    python("run", "import os\nos.makedirs('/own/ecp')\nopen('/own/ecp/__init__.py', 'w').close()")
    again = "import sys\nfor name in [n for n in sys.modules if n.startswith('ecp')]: del sys.modules[name]"
    assert (
        python("run", f"{again}\nsys.path.append('/own')\nimport ecp\necp.__file__") == "/own/ecp/__init__.py"
    )
