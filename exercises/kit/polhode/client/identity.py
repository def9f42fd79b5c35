"""The identity a notebook submits with: a token stored outside the notebook, issued after confirming a code
in the browser.
"""

import json
import os
import platform
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from polhode.client import course
from polhode.client.errors import NotebookError
from polhode.client.http import CONTACT_S, HTTPError, Unreachable, call
from polhode.client.progress import Line

JSON = {"Content-Type": "application/json"}


class NotLoggedIn(NotebookError):
    """The login was not completed; the message gives the reason."""


def login(server: str | None = None) -> None:
    """Log this computer in to the course server: open the address shown, compare the code, confirm. Once per
    term is enough.

    The token is stored in a file that only you can read, never in the notebook. Prints whether the server can
    grade, your deadline, the submissions used, and whether the kit is current; or that the server does not
    answer. Raises NotLoggedIn if the code is not confirmed in time or the token cannot be stored.
    """
    where = course.server(server)
    try:
        who = _whoami(where)
    except Unreachable as error:
        print(f"{error} polhode.check works without the server.")
        return
    if who is None:
        _log_in(where)
    else:
        print(
            "This server has a single local student; no login is needed."
            if who["local"]
            else f"Logged in as {who['person']}."
        )
    from polhode.client.health import health  # which needs this module

    try:
        slug = course.assignment()
    except course.UnknownCourse:
        slug = None
    print(health(where, slug))


def _log_in(where: str) -> None:
    """Show a code and wait until the student has confirmed it. Raises NotLoggedIn."""
    _store(where, None)  # fails before the student confirms, not after, if the file cannot be written
    label = f"Python on {platform.node() or 'a computer'}"
    request = call("POST", f"{where}/v1/logins", body=_body(label=label), headers=JSON).json()
    line, until = Line(), time.monotonic() + request["expires_in"]
    while time.monotonic() < until:
        line.show(f"Open {request['verification_uri_complete']} and confirm the code {request['user_code']}")
        time.sleep(request["interval"])
        answer = call(
            "POST", f"{where}/v1/logins/token", body=_body(device_code=request["device_code"]), headers=JSON
        )
        if answer.status == 200:
            _store(where, answer.json()["token"])
            line.end(f"Logged in as {answer.json()['person']}.")
            return
    raise NotLoggedIn("The code was not confirmed in time: run polhode.login() again.")


def logout(server: str | None = None) -> None:
    """Delete the token that ``login`` stored, on this computer and on the server."""
    where = course.server(server)
    if (token := _tokens().get(where)) is None:
        print("This computer is not logged in.")
        return
    _store(where, None)
    try:
        call(
            "DELETE", f"{where}/v1/me/token", headers={"Authorization": f"Bearer {token}"}, patience=CONTACT_S
        )
    except HTTPError as refused:
        if refused.status != 401:  # 401: the token was already invalid
            raise
    print("Logged out.")


def authorization(server: str) -> Mapping[str, str]:
    """Return the Authorization header for ``server``, or an empty mapping if there is no token for it.

    The token is the one ``login`` stored, else POLHODE_TOKEN, else JUPYTERHUB_API_TOKEN. If POLHODE_SERVER is
    set, the last two are sent to that server only. JUPYTERHUB_API_TOKEN, which other servers accept too, is
    sent only if POLHODE_SERVER is set.
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
        person: dict[str, Any] = call(
            "GET", f"{server}/v1/me", headers=authorization(server), patience=CONTACT_S
        ).json()
    except HTTPError as refused:
        if refused.status == 401:
            return None
        raise
    return person


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


def _store(server: str, token: str | None) -> None:
    """Store the token for ``server``, or delete it if None. Only the file's owner can read it."""
    kept = {name: value for name, value in _tokens().items() if name != server} | (
        {server: token} if token else {}
    )
    folder = _file().parent
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        handle, unfinished = tempfile.mkstemp(dir=folder)  # readable by its owner only
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            json.dump(kept, stream)
        os.replace(unfinished, _file())
    except OSError as error:
        remedy = "set XDG_CONFIG_HOME to a folder you can write to, and run polhode.login() again."
        raise NotLoggedIn(f"The token cannot be stored in {folder} ({error.strerror}): {remedy}") from None
