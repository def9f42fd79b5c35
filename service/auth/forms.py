"""HTML forms: CSRF tokens, size-capped bodies and access to fields."""

import hmac
from contextlib import suppress
from typing import Annotated, TypeVar

from fastapi import Depends, Request
from markupsafe import Markup
from starlette.datastructures import FormData, UploadFile

from service.auth.cookies import BrowserCookies, Cookies
from service.auth.identity import Person, same_origin
from service.auth.roles import CurrentUser, OptionalUser
from service.http.errors import Problem, encodable
from service.http.requests import read_capped

Default = TypeVar("Default", float, None)
FIELD = "csrf"
MOST_FORM = 2 * 1024 * 1024
MOST_FIELDS = 4000  # four for each of 1000 assignments
STALE = "this form has expired: reload the page and submit it again (cookies must be allowed)"
SameOrigin = Annotated[None, Depends(same_origin)]


def csrf_token(person: Person | None, cookies: Cookies) -> str:
    """Return the CSRF token of the session, of the person without a session, or of the anonymous browser.
    Who sees the pages as a student does gets their own token, not the student's.
    """
    if person is None:
        owner = f"visit {cookies.anonymous_id}"
    else:
        owner = f"session {person.session}" if person.session else f"person {person.viewer or person.name}"
    return hmac.new(cookies.secret, owner.encode(), "sha256").hexdigest()


def csrf_field(request: Request) -> Markup:
    """Return the hidden input element with the CSRF token."""
    return Markup('<input type="hidden" name="{}" value="{}">').format(
        FIELD, csrf_token(request.state.person, request.state.cookies)
    )


async def checked_public_form(
    request: Request, person: OptionalUser, cookies: BrowserCookies, origin: SameOrigin
) -> FormData:
    """Return the form of a page that needs no login, such as the log-in page.

    Raises Problem 403 if the CSRF token is wrong, and 413 if the form is too large.
    """
    await read_capped(request, MOST_FORM, f"the form is larger than {MOST_FORM} bytes: send less")
    try:
        form = await request.form(max_files=1, max_fields=MOST_FIELDS)
    except Exception as error:
        raise Problem(400, "invalid-request", f"the form cannot be parsed: {error}") from error
    request.state.form = form  # to show what was typed again
    if not hmac.compare_digest(raw_field(form, FIELD).encode(), csrf_token(person, cookies).encode()):
        await form.close()
        raise Problem(403, "not-allowed", STALE)
    return form


PublicForm = Annotated[FormData, Depends(checked_public_form)]


async def checked_form(
    request: Request, person: CurrentUser, cookies: BrowserCookies, origin: SameOrigin
) -> FormData:
    """Return the form of a logged-in person. Raises Problem 403 if the person's token may not log in."""
    person.with_scope("login")  # a token limited to reading or submitting may not send forms
    return await checked_public_form(request, person, cookies, origin)


Form = Annotated[FormData, Depends(checked_form)]


def field(form: FormData, name: str, most: int = 400) -> str:
    """Return a field's text, stripped; "" if it is missing.

    Raises Problem 422 if it is longer than ``most`` characters.
    """
    return raw_field(form, name, most).replace("\x00", "").strip()  # PostgreSQL text cannot hold NUL


def required(form: FormData, name: str, most: int = 400) -> str:
    """Return a field's text, stripped. Raises Problem 422 if it is empty or longer than ``most``
    characters.
    """
    if not (text := field(form, name, most)):
        raise Problem(422, "invalid-request", f"enter the {name}", f"/{name}")
    return text


def number(form: FormData, name: str, least: int, most: int, default: Default) -> float | Default:
    """Return a field's number, ``default`` if it is empty. Raises Problem 422 if it is not one from ``least``
    to ``most``.
    """
    if not (text := field(form, name, 40)):
        return default
    with suppress(ValueError):
        if least <= (value := float(text)) <= most:
            return value
    raise Problem(
        422, "invalid-request", f"expected a number from {least} to {most}, got {text[:40]!r}", f"/{name}"
    )


def raw_field(form: FormData, name: str, most: int = 1000) -> str:
    """Return a field's text unchanged; "" if it is missing.

    Raises Problem 422 if it is longer than ``most`` characters.
    """
    value = form.get(name)
    text = encodable(value) if isinstance(value, str) else ""
    if len(text) > most:
        raise Problem(
            422, "invalid-request", f"{name} is too long: use at most {most} characters", f"/{name}"
        )
    return text


async def file(form: FormData, name: str) -> tuple[str, bytes]:
    """Return the printable name and the content of an uploaded file.

    Raises Problem 422 if no file was chosen.
    """
    upload = form.get(name)
    if not isinstance(upload, UploadFile) or not upload.filename:
        raise Problem(422, "invalid-request", "no file was uploaded: choose a file first", f"/{name}")
    content = await upload.read()
    await upload.close()
    return "".join(c for c in upload.filename if c.isprintable())[:200] or "the file", content
