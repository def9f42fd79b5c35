"""The files for Caddy and nginx in deploy/, in front of a server, with TLS by a certificate authority of this
test's own.
"""

import json
import os
import shutil
import ssl
import subprocess
import time

import httpx2
import pytest
import trustme

from service.cli.server.demo import free_port
from tests.support.big_notebook import with_outputs
from tests.support.checkout import ROOT
from tests.support.server import Server

pytestmark = pytest.mark.slow

PATH = "/v1/assignments/rigid-body/submissions"
SLOW = "import time\ntime.sleep(3)\ndef euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n"
NGINX = """daemon off; worker_processes 1; pid {folder}/pid; error_log stderr; user root;
events {{ worker_connections 64; }}
http {{
    access_log off;
    client_body_temp_path {folder}/body; proxy_temp_path {folder}/proxy; fastcgi_temp_path {folder}/fastcgi;
    uwsgi_temp_path {folder}/uwsgi; scgi_temp_path {folder}/scgi;
    {site}
}}
"""


def caddy(folder, port, upstream):
    """The command that runs Caddy with deploy/Caddyfile on another port, with the certificate of the test."""
    site = (ROOT / "deploy/Caddyfile").read_text().replace("127.0.0.1:8000", f"127.0.0.1:{upstream}")
    site = site.replace(
        "polhode.example {", f"https://localhost:{port} {{\n\ttls {folder}/chain.pem {folder}/key.pem"
    )
    (folder / "Caddyfile").write_text("{\n\tadmin off\n\tauto_https disable_redirects\n}\n" + site)
    return ["caddy", "run", "--config", str(folder / "Caddyfile"), "--adapter", "caddyfile"]


def nginx(folder, port, upstream):
    """The same for nginx with deploy/nginx.conf."""
    site = (ROOT / "deploy/nginx.conf").read_text().replace("127.0.0.1:8000", f"127.0.0.1:{upstream}")
    site = site.replace("listen 443 ssl", f"listen 127.0.0.1:{port} ssl").replace(
        "polhode.example;", "localhost;"
    )
    site = site.replace("/etc/letsencrypt/live/polhode.example/fullchain.pem", f"{folder}/chain.pem")
    site = site.replace("/etc/letsencrypt/live/polhode.example/privkey.pem", f"{folder}/key.pem")
    assert "polhode.example" not in site
    (folder / "nginx.conf").write_text(NGINX.format(folder=folder, site=site))
    return ["nginx", "-p", str(folder), "-c", str(folder / "nginx.conf")]


@pytest.fixture(scope="module")
def authority():
    return trustme.CA()


@pytest.fixture(scope="module", params=[caddy, nginx], ids=lambda proxy: proxy.__name__)
def client(request, authority, tmp_path_factory):
    """A client that talks to a server through the proxy and trusts its certificate."""
    if shutil.which(request.param.__name__) is None:
        pytest.skip(f"{request.param.__name__} is not installed")
    folder, port = tmp_path_factory.mktemp(request.param.__name__), free_port()
    certificate = authority.issue_cert("localhost")
    certificate.private_key_pem.write_to_path(folder / "key.pem")
    for pem in certificate.cert_chain_pems:
        pem.write_to_path(folder / "chain.pem", append=True)
    context = ssl.create_default_context()
    authority.configure_trust(context)
    server = Server(
        folder / "data", POLHODE_PUBLIC_URL=f"https://localhost:{port}", POLHODE_WORKERS="1"
    ).wait_ready()
    environment = os.environ | {
        "HOME": str(folder),
        "XDG_DATA_HOME": str(folder),
        "XDG_CONFIG_HOME": str(folder),
    }
    with (folder / "log").open("wb") as log:
        proxy = subprocess.Popen(
            request.param(folder, port, server.port), env=environment, stdout=log, stderr=log
        )
    try:
        with httpx2.Client(
            base_url=f"https://localhost:{port}", verify=context, timeout=90, trust_env=False
        ) as one:
            _wait(one, proxy, folder / "log")
            yield one
    finally:
        proxy.terminate()
        proxy.wait(20)
        server.stop()


def _wait(client, proxy, log):
    for _ in range(200):
        assert proxy.poll() is None, log.read_text()
        try:
            assert client.get("/readyz").status_code == 200
            return
        except httpx2.TransportError:
            time.sleep(0.1)
    raise AssertionError(log.read_text())


def test_pages_come_over_tls_and_say_so(client):
    page = client.get("/")
    assert page.status_code == 200 and "max-age=" in page.headers["Strict-Transport-Security"]
    notebook = client.get("/v1/assignments/rigid-body/notebook.ipynb").text
    assert str(client.base_url).rstrip("/") in notebook


def test_the_proxy_needs_its_certificate(client):
    with pytest.raises(httpx2.ConnectError):
        httpx2.get(str(client.base_url), trust_env=False)


def test_a_notebook_with_its_outputs_is_uploaded_and_graded(client, rigid_body):
    notebook = with_outputs(
        (rigid_body.folder / "samples/right_course_notebook.ipynb").read_bytes(), picture="A" * 560_000
    )
    assert 17e6 < len(notebook) < 20 * 2**20
    files = {"file": ("mine.ipynb", notebook)}
    answer = client.post(PATH, files=files, data={"exercises": "2"}, headers={"Prefer": "wait=60"})
    assert answer.status_code == 200, answer.text[:500]
    assert answer.json()["report"]["score"] > 0


def test_a_file_that_is_too_large_gets_polhodes_own_answer(client):
    answer = client.post(PATH, files={"file": ("mine.ipynb", b" " * (21 * 2**20))})
    assert answer.status_code == 413 and answer.headers["Content-Type"] == "application/problem+json"


def test_events_arrive_when_they_happen(client):
    sent = client.post(PATH, json={"source": SLOW, "exercises": ["2"]})
    assert sent.status_code == 202 and sent.headers["Location"].startswith("/v1/submissions/")
    began, arrived = time.monotonic(), []
    with client.stream("GET", f"{sent.headers['Location']}/events") as stream:
        for line in stream.iter_lines():
            if line.startswith("event:"):
                arrived.append((line.removeprefix("event:").strip(), time.monotonic() - began))
    assert arrived[-1][0] == "graded" and arrived[0][0] in ("queued", "running")
    assert arrived[-1][1] - arrived[0][1] > 1.0, json.dumps(arrived)
