"""The token of a course server, stored outside the notebook in a file that only its owner can read."""

import json
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

from polhode.client.errors import NotebookError


class NotLoggedIn(NotebookError):
    """The login was not completed; the message gives the reason."""


def authorization(server: str) -> Mapping[str, str]:
    """Return the Authorization header for ``server``, or an empty mapping if there is no token for it.

    The token is the one ``login`` stored, else POLHODE_TOKEN, else JUPYTERHUB_API_TOKEN. If POLHODE_SERVER is
    set, the last two are sent to that server only. JUPYTERHUB_API_TOKEN, which other servers accept too, is
    sent only if POLHODE_SERVER is set.
    """
    named = os.environ.get("POLHODE_SERVER", "").rstrip("/")
    token = tokens().get(server)
    if token is None and named in ("", server):
        token = os.environ.get("POLHODE_TOKEN")
    if token is None and named == server:
        token = os.environ.get("JUPYTERHUB_API_TOKEN")
    return {"Authorization": f"Bearer {token}"} if token else {}


def _file() -> Path:
    home = os.environ.get("XDG_CONFIG_HOME") or os.environ.get("APPDATA")
    return (Path(home) if home else Path.home() / ".config") / "polhode" / "tokens.json"


def tokens() -> dict[str, str]:
    """Return the stored tokens by server."""
    try:
        found = json.loads(_file().read_bytes())
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def store(server: str, token: str | None) -> None:
    """Store the token for ``server``, or delete it if None. Only the file's owner can read it."""
    kept = {name: value for name, value in tokens().items() if name != server} | (
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
