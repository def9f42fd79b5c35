"""Logging in: a token, issued after confirming a code in the browser."""

import json
import platform
import time
from typing import Any

from polhode.client import course
from polhode.client.progress import Line
from polhode.client.server_status import health
from polhode.client.tokens import NotLoggedIn, authorization, store, tokens
from polhode.client.transport.http import CONTACT_S, HTTPError, Unreachable, call

JSON = {"Content-Type": "application/json"}


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
    try:
        slug = course.assignment()
    except course.UnknownCourse:
        slug = None
    print(health(where, slug))


def _log_in(where: str) -> None:
    """Show a code and wait until the student has confirmed it. Raises NotLoggedIn."""
    store(where, None)  # fails before the student confirms, not after, if the file cannot be written
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
            store(where, answer.json()["token"])
            line.end(f"Logged in as {answer.json()['person']}.")
            return
    raise NotLoggedIn("The code was not confirmed in time: run polhode.login() again.")


def logout(server: str | None = None) -> None:
    """Delete the token that ``login`` stored, on this computer and on the server."""
    where = course.server(server)
    if (token := tokens().get(where)) is None:
        print("This computer is not logged in.")
        return
    store(where, None)
    try:
        call(
            "DELETE", f"{where}/v1/me/token", headers={"Authorization": f"Bearer {token}"}, patience=CONTACT_S
        )
    except HTTPError as refused:
        if refused.status != 401:  # 401: the token was already invalid
            raise
    print("Logged out.")


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
