"""Who a notebook submits as: a token that is kept outside the notebook, got by confirming a code in the browser."""

import json
import os
import platform
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ecp import course
from ecp.errors import NotebookError
from ecp.http import CONTACT_S, HTTPError, call
from ecp.progress import Line

JSON = {"Content-Type": "application/json"}


class NotLoggedIn(NotebookError):
    """The login was not confirmed; the message says why."""


def login(server: str | None = None) -> None:
    """Log this computer in at the course's server: open the address shown, compare the code, confirm. Once in a term is enough.

    The token is kept in a file of yours and never gets into the notebook. NotLoggedIn if nobody confirms.
    """
    where = course.server(server)
    if (who := _whoami(where)) is not None:
        print("This server knows one local student; no login is needed." if who["local"] else f"Logged in as {who['person']}.")
        return
    _keep(where, None)  # where nothing can be kept that is better known now than later
    label = f"Python on {platform.node() or 'a computer'}"
    asked = call("POST", f"{where}/v1/logins", body=_body(label=label), headers=JSON).json()
    line, until = Line(), time.monotonic() + asked["expires_in"]
    while time.monotonic() < until:
        line.tell(f"Open {asked['verification_uri_complete']} and confirm the code {asked['user_code']}")
        time.sleep(asked["interval"])
        answer = call("POST", f"{where}/v1/logins/token", body=_body(device_code=asked["device_code"]), headers=JSON)
        if answer.status == 200:
            _keep(where, answer.json()["token"])
            line.end(f"Logged in as {answer.json()['person']}.")
            return
    raise NotLoggedIn("Nobody confirmed the code in time: run ecp.login() again.")


def logout(server: str | None = None) -> None:
    """Forget the token that ``login`` got for this computer, here and at the server."""
    where = course.server(server)
    if (token := _tokens().get(where)) is None:
        print("Nothing to forget: this computer was not logged in.")
        return
    _keep(where, None)
    try:
        call("DELETE", f"{where}/v1/me/token", headers={"Authorization": f"Bearer {token}"}, patience=CONTACT_S)
    except HTTPError as refused:
        if refused.status != 401:  # it was not good any more
            raise
    print("Logged out.")


def authorization(server: str) -> Mapping[str, str]:
    """The header that tells who asks, or nothing where there is no token for that server.

    The token is the one ``login`` got, else POLHODE_TOKEN, else the hub's own. Where POLHODE_SERVER names a server the last two go
    to no other; the hub's, which opens more than one server, only goes where it is named so.
    """
    named = os.environ.get("POLHODE_SERVER", "").rstrip("/")
    token = _tokens().get(server)
    if token is None and named in ("", server):
        token = os.environ.get("POLHODE_TOKEN")
    if token is None and named == server:
        token = os.environ.get("JUPYTERHUB_API_TOKEN")
    return {"Authorization": f"Bearer {token}"} if token else {}


def _whoami(server: str) -> dict[str, Any] | None:
    try:
        told: dict[str, Any] = call("GET", f"{server}/v1/me", headers=authorization(server), patience=CONTACT_S).json()
    except HTTPError as refused:
        if refused.status == 401:
            return None
        raise
    return told


def _body(**fields: str) -> bytes:
    return json.dumps(fields).encode()


def _file() -> Path:
    home = os.environ.get("XDG_CONFIG_HOME") or os.environ.get("APPDATA")
    return (Path(home) if home else Path.home() / ".config") / "polhode" / "tokens.json"


def _tokens() -> dict[str, str]:
    try:
        found = json.loads(_file().read_bytes())
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _keep(server: str, token: str | None) -> None:
    """Remember the token for that server, or forget it; nobody else on the computer can read the file."""
    kept = {name: value for name, value in _tokens().items() if name != server} | ({server: token} if token else {})
    folder = _file().parent
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        handle, unfinished = tempfile.mkstemp(dir=folder)  # readable by its owner only
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            json.dump(kept, stream)
        os.replace(unfinished, _file())
    except OSError as error:
        elsewhere = "Set XDG_CONFIG_HOME to a folder that can, and run ecp.login() again."
        raise NotLoggedIn(f"{folder} cannot be written ({error.strerror}), so no token can be kept. {elsewhere}") from None
