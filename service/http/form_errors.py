"""A rejected form in a browser without JavaScript: its page again, with the reason beside the field and with
what was typed.
"""

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from html import unescape
from urllib.parse import quote, unquote, urlsplit

from fastapi import Request
from fastapi.responses import HTMLResponse, Response
from markupsafe import Markup, escape
from starlette.datastructures import FormData, Headers
from starlette.types import Message

from service.http.form_parser import Element, FormParser
from service.http.templating import neutralize_bidi
from service.settings import Settings

Typed = Mapping[str, Sequence[str]]
Changes = defaultdict[Element, dict[str, str | None]]
PAGE = "page"  # query parameter of a form's action: the address of the page that shows the form
UNTYPED = (
    "hidden",
    "file",
    "password",
    "submit",
    "button",
    "select",
    "textarea",
)  # their start tags have nothing that is typed
ENTER_AGAIN = {
    "file": "; choose the file again",
    "password": "; enter the passwords again",
}  # a page cannot contain them
ERROR = Markup('<span class="refused" id="refused" role="alert"{}>{}</span>')
REFRESH = re.compile(
    r'<meta http-equiv="refresh"[^>]*>'
)  # it would ask for the form's address, and discard what was typed
FOCUS = Markup(' tabindex="-1" autofocus')
NOT_OF_THE_PAGE = re.compile(r"accept-encoding|content-(length|type)|if-.*|range|transfer-encoding")
MOST_PAGE = 1 << 19  # characters; parsing a longer page would keep other requests waiting
OF_THE_SERVER = ("type", "asgi", "http_version", "server", "client", "scheme", "root_path")


async def page_with_error(request: Request, status: int, detail: str, pointer: str | None) -> Response | None:
    """Return the page from which a form was sent with ``detail`` beside the field ``pointer``, or None if
    that is impossible.
    """
    if request.method != "POST" or not 400 <= status < 500 or not (address := _address(request)):
        return None
    page, cookies = await _get(request, address)
    if len(page) > MOST_PAGE or f'action="{request.url.path}' not in page:
        return None
    form: FormData = getattr(request.state, "form", FormData())
    typed = {
        name: [_encodable(value) for value in form.getlist(name) if isinstance(value, str)] for name in form
    }
    name = (pointer or "").removeprefix("/")
    shown = refill(
        page, request.url.path, address=address, typed=typed, detail=neutralize_bidi(detail), name=name
    )
    if shown is None:
        return None
    response = HTMLResponse(shown, status)
    response.raw_headers += cookies
    return response


def _encodable(text: str) -> str:
    return text.encode("utf-8", "replace").decode()  # a form may decode to lone surrogates


def _address(request: Request) -> str:
    """Return path and query of the page with the form, "" if it is of another server or not known."""
    settings: Settings = request.app.state.held[Settings]
    try:
        page = urlsplit(request.query_params.get(PAGE) or request.headers.get("referer", ""))
    except ValueError:
        return ""
    own = ("", request.headers.get("host"), urlsplit(settings.public_url or "").netloc)
    if page.netloc not in own or not page.path.startswith("/"):
        return ""
    return page.path + (f"?{page.query}" if page.query else "")


async def _get(request: Request, address: str) -> tuple[str, list[tuple[bytes, bytes]]]:
    """Request the page at ``address`` for the sender of the request. Return its HTML, "" if the answer is
    none, and its cookies.
    """
    path, _, query = address.partition("?")
    headers = [
        (name, value)
        for name, value in request.headers.raw
        if not NOT_OF_THE_PAGE.fullmatch(name.decode("latin-1"))
    ]
    scope = {key: request.scope[key] for key in OF_THE_SERVER if key in request.scope}
    scope |= {
        "method": "GET",
        "path": unquote(path),
        "raw_path": path.encode(),
        "query_string": query.encode(),
        "headers": headers,
    }
    received: list[Message] = [
        {"type": "http.disconnect"},
        {"type": "http.request"},
    ]  # the first ends a stream of events
    start: list[Message] = []
    body = bytearray()

    async def receive() -> Message:
        return received[0] if len(received) == 1 else received.pop()

    async def send(message: Message) -> None:
        if message["type"] == "http.response.start":
            start.append(message)
        elif start[0]["status"] == 200 and Headers(raw=start[0]["headers"]).get(
            "content-type", ""
        ).startswith("text/html"):
            body.extend(message["body"])

    await request.app(scope, receive, send)
    return body.decode(), [
        pair for message in start for pair in message["headers"] if pair[0] == b"set-cookie"
    ]


def refill(page: str, path: str, *, address: str, typed: Typed, detail: str, name: str = "") -> str | None:
    """Return the page with ``typed`` in the form that is sent to ``path``, and with ``detail`` beside the
    field ``name``.

    Without such a field ``detail`` is at the beginning of the form. Every form then sends ``address``, which
    is the page's. Return None if the page has no such form.
    """
    parsed = FormParser(page)
    form = _sent(parsed.forms, path, typed)
    if form is None:
        return None
    changes: Changes = defaultdict(dict)
    for one in parsed.forms:
        if one.attributes.get("method") == "post":
            changes[one]["action"] = f"{_path(one)}?{PAGE}={quote(address, safe='/')}"
    texts = _fill(form, typed, changes)
    for option in parsed.options:
        choice = next((one for one in option.around if one in form.controls), None)
        if choice is not None and typed.get(choice.name):
            value = option.attributes.get(
                "value", unescape(page[option.start_stop : option.content_stop]).strip()
            )
            changes[option]["selected"] = "" if value in typed[choice.name] else None
    place, error = _explain(form, name, detail, changes)
    tags = [
        (element.start, element.start_stop, element.start_tag(changed))
        for element, changed in changes.items()
    ]
    for start, stop, text in sorted([*texts, *tags, (place, place, error)], reverse=True):
        page = page[:start] + text + page[stop:]
    return REFRESH.sub("", page).replace("<title>", "<title>Error: ", 1)


def _fill(form: Element, typed: Typed, changes: Changes) -> list[tuple[int, int, str]]:
    """Change the controls of the form to what was typed, and return the new contents of text areas with their
    places.
    """
    texts: list[tuple[int, int, str]] = []
    for control in form.controls:
        if typed and control.kind in ("checkbox", "radio"):
            checked = control.attributes.get("value", "on") in typed.get(control.name, ())
            changes[control]["checked"] = "" if checked else None
        elif typed.get(control.name) and control.kind == "textarea":
            texts.append(
                (control.start_stop, control.content_stop, str(escape("\n" + typed[control.name][0])))
            )
        elif typed.get(control.name) and control.kind not in UNTYPED:
            changes[control]["value"] = typed[control.name][0]
    return texts


def _explain(form: Element, name: str, detail: str, changes: Changes) -> tuple[int, str]:
    """Mark the field ``name``, unfold what encloses it, and return the element with ``detail`` and its
    place.
    """
    kinds = {control.kind for control in form.controls}
    words = detail + "".join(sentence for kind, sentence in ENTER_AGAIN.items() if kind in kinds)
    at = next(
        (one for one in form.controls if one.name == name and one.kind not in ("hidden", "button", "submit")),
        None,
    )
    if at is not None:
        changes[at] |= {"aria-invalid": "true", "aria-describedby": "refused", "autofocus": ""}
    for folded in (one for one in form.around if one.tag == "details"):
        changes[folded]["open"] = ""
    if at is None:
        return form.start_stop, str(ERROR.format(FOCUS, words))
    label = next((one for one in reversed(at.around) if one.tag == "label"), at)
    return label.stop, str(ERROR.format("", words))


def _sent(forms: Sequence[Element], path: str, typed: Typed) -> Element | None:
    """Return the form of this action that has all names; of several, that with the most hidden values that
    were sent.
    """

    def same(form: Element) -> int:
        hidden = [one for one in form.controls if one.kind == "hidden"]
        return sum(1 if one.attributes.get("value") in typed.get(one.name, ()) else -1 for one in hidden)

    fitting = [
        one
        for one in forms
        if _path(one) == path and typed.keys() <= {control.name for control in one.controls}
    ]
    return max(fitting, key=same, default=None)


def _path(form: Element) -> str:
    return urlsplit(form.attributes.get("action") or "").path
