"""Signing in at an OpenID provider: authorization code with PKCE, state and nonce, the ID token verified; by authlib.

What is under way lies in a signed cookie of the browser that began it, so any server can go on with it. An account there is
remembered by issuer and subject; its name only counts the first time.
"""

import importlib.util
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import RedirectResponse
from itsdangerous import BadData

from service.auth import sessions
from service.auth.roles import OptionalUser
from service.http.errors import Problem
from service.http.requests import LONGEST_PATH, local_path, public_address
from service.settings import Settings
from service.store.course import credentials, people

router = APIRouter()
COOKIE, PATH, UNDER_WAY_S, ANSWER_S = "polhode_sign_in", "/oidc", 600, 5.0
SIGNED = ("RS256", "RS384", "RS512", "PS256", "PS384", "PS512", "ES256", "ES384", "ES512", "EdDSA", "Ed25519")
AWAY = "the provider does not answer as it should: try again in a moment, or log in another way"
BEGIN_AGAIN = "this sign-in was not begun in this browser, or more than ten minutes ago: begin again"


class NotInstalled(Exception):
    """Settings ask for what is not installed."""


def provider(settings: Settings) -> Any | None:
    """authlib's client of the provider in the settings, None without one; NotInstalled where the packages are missing."""
    if settings.oidc_issuer is None:
        return None
    if missing := [name for name in ("authlib", "httpx2") if importlib.util.find_spec(name) is None]:
        raise NotInstalled(f"POLHODE_OIDC_ISSUER needs {' and '.join(missing)}: pip install 'polhode[oidc]'")
    from authlib.integrations.starlette_client import OAuth

    secret = settings.oidc_client_secret
    how = {"scope": "openid profile email", "code_challenge_method": "S256", "timeout": ANSWER_S}
    return OAuth().register(
        "provider",
        client_id=settings.oidc_client_id,
        client_secret=secret and secret.get_secret_value(),
        server_metadata_url=settings.oidc_issuer.rstrip("/") + "/.well-known/openid-configuration",
        client_kwargs=how if secret else how | {"token_endpoint_auth_method": "none"},
    )


@router.get("/oidc/login")
async def start(request: Request, next: str = "") -> Response:
    """Send the browser to the provider."""
    client, request.scope["session"] = _client(request), {}
    with _sentences():
        await _metadata(request)
        response: Response = await client.authorize_redirect(request, f"{public_address(request)}{PATH}/callback")
    under_way = sessions.serializer(request, "sign-in").dumps([request.scope["session"], local_path(next[:LONGEST_PATH])])
    sessions.set_cookie(request, response, COOKIE, under_way, max_age=UNDER_WAY_S, path=PATH)
    return response


@router.get("/oidc/callback")
async def finish(request: Request, present: OptionalUser) -> Response:
    """Log in whom the provider names, and go on to where they were going."""
    _client(request)
    try:
        given = request.cookies.get(COOKIE, "")
        request.scope["session"], back = sessions.serializer(request, "sign-in").loads(given, max_age=UNDER_WAY_S)
    except BadData:
        raise Problem(403, "not-allowed", BEGIN_AGAIN) from None
    with _sentences():
        claims = await _verified(request)
    account, now = (str(claims["iss"]), str(claims["sub"])), None if present is None else present.name
    try:
        async with request.app.state.database.begin() as connection:
            name = await credentials.signed_in(connection, account, _name(request, claims), now)
    except credentials.NameTaken as error:
        raise Problem(403, "not-allowed", str(error)) from None
    response = RedirectResponse(back or "/", 303)
    response.delete_cookie(COOKIE, path=PATH)
    await sessions.start_session(request, response, name, request.app.state.settings.oidc_name)
    return response


async def _verified(request: Request) -> dict[str, Any]:
    """The claims of an ID token that is signed by the provider for us, for this browser and now."""
    client, metadata = _client(request), await _metadata(request)
    claim = request.app.state.settings.oidc_claim
    options = {"iss": {"essential": True, "value": metadata["issuer"]}, "aud": {"essential": True, "value": client.client_id}}
    try:
        token = await client.authorize_access_token(request, claims_options=options)
    except Exception:
        metadata.pop("jwks", None)  # the provider may have new keys
        raise
    if not (claims := token.get("userinfo")):
        raise Problem(403, "not-allowed", "the provider sent no ID token")
    if claim not in claims and "userinfo_endpoint" in metadata:
        more = await client.userinfo(token=token)
        claims = {**more, **claims} if more.get("sub") == claims["sub"] else claims
    return dict(claims)


def _name(request: Request, claims: dict[str, Any]) -> str:
    claim = request.app.state.settings.oidc_claim
    if claim == "email" and claims.get("email_verified") is not True:
        raise Problem(403, "not-allowed", "the provider has not verified your email address")
    try:
        return people.normalize_name(claims[claim] if isinstance(claims.get(claim), str) else "")
    except people.InvalidName:
        raise Problem(403, "not-allowed", f"the provider does not tell your name (its claim {claim})") from None


async def _metadata(request: Request) -> dict[str, Any]:
    """What the provider tells of itself, asked for once: who it is must be whom the settings name."""
    metadata: dict[str, Any] = await _client(request).load_server_metadata()
    if str(metadata.get("issuer")).rstrip("/") != request.app.state.settings.oidc_issuer.rstrip("/"):
        metadata.pop("_loaded_at", None)
        raise Problem(503, "busy", "the provider calls itself by another name than POLHODE_OIDC_ISSUER")
    offered = metadata.get("id_token_signing_alg_values_supported") or []
    metadata["id_token_signing_alg_values_supported"] = [name for name in offered if name in SIGNED] or ["RS256"]
    return metadata


def _client(request: Request) -> Any:
    if (client := request.app.state.oidc) is None:
        raise Problem(404, "not-found", "this server has no provider to sign in at")
    return client


@contextmanager
def _sentences() -> Iterator[None]:
    """What may go wrong at the provider, as a problem with a sentence."""
    import httpx2
    from authlib.integrations.base_client import MismatchingStateError, OAuthError
    from joserfc.errors import JoseError

    try:
        yield
    except MismatchingStateError:
        raise Problem(403, "not-allowed", BEGIN_AGAIN) from None
    except OAuthError as error:
        code = error.error if re.fullmatch(r"[a-z_]{1,40}", str(error.error)) else "error"
        raise Problem(403, "not-allowed", f"the provider did not sign you in ({code})") from None
    except JoseError as error:
        raise Problem(403, "not-allowed", f"what the provider sent cannot be trusted ({error.error})") from None
    except (httpx2.HTTPError, httpx2.InvalidURL, ValueError, LookupError, TypeError, RuntimeError) as error:
        raise Problem(503, "busy", f"{AWAY} ({type(error).__name__})") from None
