"""Forms of our pages: a token that only a page of ours can have put into them, and a body of bounded size."""

import hmac
from typing import Annotated

from fastapi import Depends, Request
from markupsafe import Markup
from starlette.datastructures import FormData, UploadFile

from service.auth.identity import authenticate, same_origin
from service.auth.roles import current_user, optional_user
from service.auth.sessions import anonymous_id
from service.http.errors import Problem
from service.http.requests import read_capped

FIELD = "csrf"
MOST_FORM = 2 * 1024 * 1024
STALE = "this form is no longer good: load the page again and repeat what you did (cookies must be allowed)"


def csrf_token(request: Request) -> str:
    """What forms shown to this browser's session carry; another session's is another, as is the one before logging in."""
    if session := getattr(request.state, "session", None):
        whose = f"session {session.id}"
    elif person := getattr(request.state, "person", None):
        whose = f"person {person.name}"
    else:
        whose = f"visit {anonymous_id(request)}"
    return hmac.new(request.app.state.secret, whose.encode(), "sha256").hexdigest()


def csrf_field(request: Request) -> Markup:
    """The hidden field for a form of a page."""
    return Markup('<input type="hidden" name="{}" value="{}">').format(FIELD, csrf_token(request))


async def checked_form(request: Request) -> FormData:
    """The form that was sent; Problem 403 unless a page of ours sent it, to whoever may log in, 413 if it is too large."""
    await current_user(request)
    await authenticate(request, "login")  # a token that may only read or submit changes nothing here
    return await _read(request)


async def checked_public_form(request: Request) -> FormData:
    """The same for a form on a page that is open to all, such as the one to log in with."""
    await optional_user(request)
    return await _read(request)


async def _read(request: Request) -> FormData:
    same_origin(request)
    await read_capped(request, MOST_FORM, f"a form has at most {MOST_FORM} bytes")
    try:
        form = await request.form(max_files=1, max_fields=200)
    except Exception as error:
        raise Problem(400, "invalid-request", f"the form cannot be read: {error}") from error
    if not hmac.compare_digest(raw_field(form, FIELD).encode(), csrf_token(request).encode()):
        await form.close()
        raise Problem(403, "not-allowed", STALE)
    return form


Form = Annotated[FormData, Depends(checked_form)]
PublicForm = Annotated[FormData, Depends(checked_public_form)]


def field(form: FormData, name: str, most: int = 400) -> str:
    """A field's text without space around it, "" where it is missing; Problem 422 where it is longer than ``most``."""
    return raw_field(form, name, most).replace("\x00", "").strip()  # no NUL in a database


def raw_field(form: FormData, name: str, most: int = 1000) -> str:
    """A field's text exactly as it was typed, "" where it is missing; Problem 422 where it is longer than ``most``."""
    given = form.get(name)
    told = given.encode("utf-8", "replace").decode() if isinstance(given, str) else ""  # a form names its own encoding
    if len(told) > most:
        raise Problem(422, "invalid-request", f"{name} has at most {most} characters", f"/{name}")
    return told


async def file(form: FormData, name: str) -> tuple[str, bytes]:
    """Name, as far as it can be printed, and content of the uploaded file; Problem 422 where none was chosen."""
    given = form.get(name)
    if not isinstance(given, UploadFile) or not given.filename:
        raise Problem(422, "invalid-request", "choose a file first", f"/{name}")
    content = await given.read()
    await given.close()
    return "".join(c for c in given.filename if c.isprintable())[:200] or "the file", content
