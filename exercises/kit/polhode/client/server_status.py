"""The line that ``polhode.login`` prints about the server, the deadline, the submissions used and the kit."""

from datetime import datetime
from typing import Any

from polhode.client.errors import RequestError
from polhode.client.kit_hash import WHEEL, build
from polhode.client.past_submissions import own
from polhode.client.transport.http import call

PATIENCE_S = 5.0


def health(server: str, slug: str | None) -> str:
    """Return the state of the server and of one's work on the assignment ``slug``, if there is one, as a line
    of text.
    """
    try:
        call("GET", f"{server}/readyz", patience=PATIENCE_S)
        said = [f"{server} is ready."]
    except RequestError:
        said = [f"{server} cannot grade at the moment."]
    if slug is not None:
        try:
            said += [rules(own(server, slug)), outdated(server, slug)]
        except RequestError as error:
            said.append(str(error))
    return " ".join(filter(None, said))


def rules(own: dict[str, Any]) -> str:
    """Return a student's own deadline, in the notebook's time zone, and the submissions used, from the
    server's list of these.
    """
    limit = f" of {own['submission_limit']}" if own["submission_limit"] else ""
    until = (
        f"{local_time(own['due_at'])}{' with your extension' * own['extended']}" if own["due_at"] else "none"
    )
    return f"Deadline: {until}{' (over)' * own['over']}. Submissions used: {own['used']}{limit}."


def local_time(text: str) -> str:
    """Return a time of the server in the notebook's time zone."""
    return f"{datetime.fromisoformat(text).astimezone():%Y-%m-%d %H:%M %Z}"


def outdated(server: str, slug: str) -> str:
    """Return a remark if the server now distributes another kit, which may judge differently; else ""."""
    try:
        current = call("GET", f"{server}/v1/assignments/{slug}", patience=PATIENCE_S).json()
    except RequestError:
        return ""
    if current.get("kit_build") == build():
        return ""
    return (
        f"Your kit differs from the server's: %pip install --force-reinstall --no-deps {server}/kit/{WHEEL},"
        " then restart the kernel."
    )
