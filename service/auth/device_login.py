"""Device login for notebooks, after RFC 8628: the notebook shows a code, the student confirms it at
/login in a browser.
"""

from typing import Annotated, Literal

from fastapi import APIRouter, Body, Request, Response
from fastapi.responses import JSONResponse
from pydantic import BaseModel

from service.auth.identity import Bearer, Reader
from service.auth.rate_limit import LoginRateLimiter
from service.http.errors import Problem
from service.http.openapi import PERSON, also, problems
from service.http.requests import PublicAddress, SmallBody
from service.http.state import Config, Db, Held
from service.store.people import tokens

router = APIRouter(route_class=SmallBody, tags=["Login and account"])
INTERVAL_S = 2
LONGEST_LABEL = 60


class Started(BaseModel):
    """A login: the code to show to the student, the addresses to confirm it at, and the secret that collects
    the token.
    """

    device_code: str
    user_code: str
    verification_uri: str
    verification_uri_complete: str
    expires_in: int
    interval: int = INTERVAL_S


class Pending(BaseModel):
    """A login that is not confirmed yet."""

    status: Literal["pending"] = "pending"


class Token(BaseModel):
    """The token of a confirmed login, and its owner."""

    token: str
    person: str


class Owner(BaseModel):
    """The owner and the scopes of the request's token; ``local`` is true in single-user mode."""

    person: str
    scopes: list[str]
    local: bool


ShortText = Annotated[str, Body(embed=True, max_length=120)]


@router.post(
    "/v1/logins",
    status_code=201,
    responses=problems(
        {408: "timed-out", 413: "too-large", 422: "invalid-request", 429: "too-many", 503: "busy"}
    ),
)
async def start(
    request: Request,
    database: Db,
    limits: Held[LoginRateLimiter],
    server: PublicAddress,
    label: ShortText = "a notebook",
) -> Started:
    """Start a login.

    Return the code to show to the student, the address to confirm it at, and the secret that collects
    the token.
    """
    limits.start(request)
    label = "".join(c for c in label if c.isprintable())[:LONGEST_LABEL] or "a notebook"
    device, code = await tokens.create_login(database, label)
    address = f"{server}/login"
    return Started(
        device_code=device,
        user_code=code,
        verification_uri=address,
        verification_uri_complete=f"{address}?code={code}",
        expires_in=int(tokens.LOGIN_S),
    )


@router.post(
    "/v1/logins/token",
    response_model=Token,
    responses=also(202, "Not confirmed yet", Pending)
    | problems({408: "timed-out", 413: "too-large", 410: "login-over", 422: "invalid-request", 503: "busy"}),
)
async def collect(settings: Config, database: Db, device_code: ShortText) -> JSONResponse:
    """Return the token of a confirmed login: 200, once; 202 while it is unconfirmed; 410 once it is
    refused, used or expired.
    """
    try:
        found = await tokens.collect_login(database, device_code, settings.token_days)
    except tokens.LoginOver:
        raise Problem(
            410,
            "login-over",
            "this login was refused, already used or not confirmed in time: run polhode.login() again",
        ) from None
    if found is None:
        return JSONResponse(Pending().model_dump(), 202, {"Retry-After": str(INTERVAL_S)})
    return JSONResponse(Token(token=found[0], person=found[1]).model_dump())


@router.get("/v1/me", responses=problems(PERSON | {413: "too-large"}))
async def me(person: Reader) -> Owner:
    """Return the person and scopes of the request's token. ``local`` is true in single-user mode."""
    return Owner(person=person.name, scopes=sorted(person.scopes), local=person.single_user)


@router.delete(
    "/v1/me/token", status_code=204, responses=problems({401: "nobody", 413: "too-large", 503: "busy"})
)
async def revoke(request: Request, database: Db, bearer: Bearer) -> Response:
    """Revoke the token in the request's Authorization header."""
    token = request.headers.get("authorization", "").partition(" ")[2].strip()
    info = await tokens.find(database, token)
    if info is None:
        raise Problem(401, "nobody", "the request has no valid token of this server: run polhode.login()")
    async with database.begin() as connection:
        await tokens.revoke(connection, id=info.id)
    return Response(status_code=204)
