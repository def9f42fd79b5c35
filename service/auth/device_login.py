"""Logging a notebook in: it shows a code, a browser confirms it at /login, the notebook gets a token of its own. After RFC 8628."""

from typing import Annotated

from fastapi import APIRouter, Body, Request, Response
from fastapi.responses import JSONResponse

from service.auth.identity import authenticate
from service.http.errors import Problem
from service.http.requests import public_address
from service.store.course import tokens

router = APIRouter()
INTERVAL_S = 2
LONGEST_LABEL = 60
ShortText = Annotated[str, Body(embed=True, max_length=120)]


@router.post("/v1/logins", status_code=201)
async def start(request: Request, label: ShortText = "a notebook") -> dict[str, object]:
    """Begin a login: the code to show to the person, where to confirm it, and the secret to collect the token with."""
    label = "".join(c for c in label if c.isprintable())[:LONGEST_LABEL] or "a notebook"
    try:
        device, code = await tokens.create_login(request.app.state.database, label)
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
    person = await authenticate(request)
    return {"person": person.name, "scopes": sorted(person.scopes), "local": person.alone}


@router.delete("/v1/me/token", status_code=204)
async def revoke(request: Request) -> Response:
    """Revoke the token that the request brings."""
    token = request.headers.get("authorization", "").partition(" ")[2].strip()
    known = await tokens.find(request.app.state.database, token)
    if known is None:
        raise Problem(401, "nobody", "the request brings no token of this server")
    async with request.app.state.database.begin() as connection:
        await tokens.revoke(connection, id=known.id)
    return Response(status_code=204)
