"""Logging a notebook in: it shows a code, a browser confirms it, the notebook gets a token of its own. After RFC 8628."""

from typing import Annotated

from fastapi import APIRouter, Body, Form, Request, Response
from fastapi.responses import HTMLResponse, JSONResponse

from exercises.assignment import assignments
from service.store import tokens
from service.web.address import public_address
from service.web.identity import COOKIE, by_token, same_origin, who
from service.web.problems import Problem
from service.web.templating import templates

router, pages = APIRouter(), APIRouter()
SESSION_S = 12 * 3600.0
INTERVAL_S = 2
LONGEST_LABEL = 60
ShortText = Annotated[str, Body(embed=True, max_length=120)]


@router.post("/v1/logins", status_code=201)
async def begin(request: Request, label: ShortText = "a notebook") -> dict[str, object]:
    """Begin a login: the code to show to the person, where to confirm it, and the secret to collect the token with."""
    label = "".join(c for c in label if c.isprintable())[:LONGEST_LABEL] or "a notebook"
    try:
        device, code = await tokens.begin_login(request.app.state.database, label)
    except tokens.TooManyLogins:
        raise Problem(503, "busy", "too many logins wait to be confirmed: try again in a moment") from None
    address = f"{public_address(request)}/login"
    return {
        "device_code": device,
        "user_code": code,
        "verification_uri": address,
        "verification_uri_complete": f"{address}?code={code}",
        "expires_in": int(tokens.LOGIN_S),
        "interval": INTERVAL_S,
    }


@router.post("/v1/logins/token")
async def collect(request: Request, device_code: ShortText) -> JSONResponse:
    """The token of a login that was confirmed: 200, once; 202 while it waits; 410 when it is over."""
    days = request.app.state.settings.token_days
    try:
        found = await tokens.collect_login(request.app.state.database, device_code, days)
    except tokens.LoginOver:
        raise Problem(410, "login-over", "this login was refused, used or not confirmed in time: run ecp.login() again") from None
    if found is None:
        return JSONResponse({"status": "pending"}, 202, {"Retry-After": str(INTERVAL_S)})
    return JSONResponse({"token": found[0], "person": found[1]})


@router.get("/v1/me")
async def me(request: Request) -> dict[str, object]:
    """Who the request's token belongs to and what it may; "local" where no login is needed."""
    person = await who(request)
    return {"person": person.name, "scopes": sorted(person.scopes), "local": person.alone}


@router.delete("/v1/me/token", status_code=204)
async def forget(request: Request) -> Response:
    """Revoke the token that the request brings."""
    token = request.headers.get("authorization", "").partition(" ")[2].strip()
    known = await tokens.find(request.app.state.database, token)
    if known is None:
        raise Problem(401, "nobody", "the request brings no token of this server")
    async with request.app.state.database.begin() as connection:
        await tokens.revoke(connection, id=known.id)
    return Response(status_code=204)


@pages.get("/login", response_class=HTMLResponse)
async def ask(request: Request, code: str = "") -> HTMLResponse:
    """The page that confirms a code, or logs a browser in."""
    return await _page(request, code[:20], "", 200)


@pages.post("/login", response_class=HTMLResponse)
async def answer(
    request: Request,
    code: Annotated[str, Form(max_length=20)] = "",
    token: Annotated[str, Form(max_length=200)] = "",
    refuse: Annotated[str, Form(max_length=10)] = "",
) -> HTMLResponse:
    """Confirm or refuse the code, as whom the given token or the browser's session is."""
    same_origin(request)
    database = request.app.state.database
    try:
        person = await by_token(request, token.strip()) if token.strip() else await who(request, "login")
        if "login" not in person.scopes:
            raise Problem(403, "not-allowed", "this token is a notebook's own: only one that your course gave you logs in here")
        if code and not await tokens.confirm_login(database, code, None if refuse else person.name):
            raise Problem(404, "not-found", "no login waits under this code: begin again in the notebook")
    except Problem as problem:
        return await _page(request, code, problem.detail, problem.status)
    done = "refused" if refuse else "confirmed" if code else "in"
    context = {"person": person.name, "done": done, "assignments": assignments().values()}
    response = templates.TemplateResponse(request, "login_done.html", context)
    if token.strip():
        async with database.begin() as connection:
            session = await tokens.give(connection, person.name, label="a browser", scopes=tokens.BROWSER, seconds=SESSION_S)
        secure = public_address(request).startswith("https://")
        response.set_cookie(COOKIE, session, max_age=int(SESSION_S), httponly=True, samesite="lax", secure=secure)
    return response


@pages.post("/logout", response_class=HTMLResponse)
async def leave(request: Request) -> HTMLResponse:
    """Forget the browser's session."""
    same_origin(request)
    if known := await tokens.find(request.app.state.database, request.cookies.get(COOKIE, "")):
        async with request.app.state.database.begin() as connection:
            await tokens.revoke(connection, id=known.id)
    response = templates.TemplateResponse(request, "login_done.html", {"person": None, "done": "out"})
    response.delete_cookie(COOKIE)
    return response


async def _page(request: Request, code: str, error: str, status: int) -> HTMLResponse:
    try:
        person = await who(request, "login")
    except Problem:
        person = None
    label = await tokens.open_login(request.app.state.database, code) if code else None
    context = {"code": code, "label": label, "person": person, "error": error}
    return templates.TemplateResponse(request, "login.html", context, status_code=status)
