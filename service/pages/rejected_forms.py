"""Forms of pages. A rejected one is shown again: its page, with the reason beside the field and with what was
typed.
"""

from collections.abc import Callable, Coroutine
from contextlib import suppress
from typing import Any, TypeVar

from fastapi import APIRouter, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from starlette.datastructures import FormData

from service.http.errors import Problem, encodable, wants_page

View = Callable[..., Coroutine[Any, Any, Response]]
Handler = Callable[[Request], Coroutine[Any, Any, Response]]
Receiver = TypeVar("Receiver", bound=View)


class FormState:
    """What a template shows in a form: what was typed and why it was rejected, or nothing of either.

    ``action`` is the path that the form was sent to, and ``field`` the name of the field that the reason is
    about, or "". ``shown`` is whether the page has the reason.
    """

    def __init__(self, action: str = "", reason: str = "", field: str = "", typed: FormData | None = None):
        self.action, self.reason, self.field, self.typed = action, reason, field, typed or FormData()
        self.shown = False

    def __bool__(self) -> bool:
        return self.reason != ""

    def value(self, name: str, stored: str = "") -> str:
        """Return what was typed in the field, else ``stored``."""
        typed = self.typed.get(name)
        return encodable(typed) if isinstance(typed, str) else stored

    def error(self, name: str = "") -> str:
        """Return the reason if it is about the field ``name``, or for "" if it is about none; else ""."""
        if self.field != name:
            return ""
        self.shown = True
        return self.reason


def form_state(request: Request, action: str, /, **hidden: str | None) -> FormState:
    """Return the state of the form that is sent to the path ``action``.

    Of several forms with this action it is the one with the values of ``hidden``; None is a missing field.
    """
    rejected: FormState | None = getattr(request.state, "rejected", None)
    if rejected is None or rejected.action != action:
        return FormState()
    return rejected if all(rejected.typed.get(k) == value for k, value in hidden.items()) else FormState()


def post_form(router: APIRouter, path: str, *, page: View, at: str) -> Callable[[Receiver], Receiver]:
    """Return the decorator of a function that receives a form, as ``router.post`` does.

    The form is on the page with the view ``page`` and the path ``at``, whose parameters ``path`` has too. A
    browser gets this page again if the form is rejected; its query is that of the form's action.
    """
    show = APIRoute(at, page).get_route_handler()

    class FormRoute(APIRoute):
        def get_route_handler(self) -> Handler:
            receive = super().get_route_handler()

            async def handle(request: Request) -> Response:
                try:
                    return await receive(request)
                except Problem as problem:
                    if not wants_page(request) or problem.status >= 500:
                        raise
                    address = at.format(**request.path_params)
                    if (response := await _show_again(request, problem, show, address)) is None:
                        raise
                    return response

            return handle

    def register(receive: Receiver) -> Receiver:
        router.add_api_route(path, receive, methods=["POST"], route_class_override=FormRoute)
        return receive

    return register


async def _show_again(request: Request, problem: Problem, show: Handler, address: str) -> Response | None:
    """Return the page at ``address`` with the reason beside its field, at the beginning of the form if that
    has no such field; None if the page does not have the form.
    """
    field, typed = (problem.pointer or "").removeprefix("/"), getattr(request.state, "form", None)
    with suppress(Problem, RequestValidationError):  # of the page itself
        for place in dict.fromkeys((field, "")):
            state = FormState(request.url.path, encodable(problem.detail), place, typed)
            request.state.rejected = state
            response = await show(Request({**request.scope, "method": "GET", "path": address}))
            if state.shown:
                response.status_code = problem.status
                response.headers.update(problem.headers())
                return response
    request.state.rejected = None
    return None
