"""For tests of pages: a server of each module's own, which wants a token from everybody and grades nothing."""

import pytest


@pytest.fixture(scope="module")
def server(new_server, tmp_path_factory, url):
    own = {"POLHODE_DATABASE_URL": url, "POLHODE_WORKERS": "0", "POLHODE_IDENTITY": "token"}
    started = new_server(tmp_path_factory.mktemp("pages") / "data", "/livez", **own)
    yield started
    started.stop()
