"""OpenID Connect sign-in with authlib: authorization code with PKCE, state and nonce, and a verified ID
token.

The state of a sign-in is kept in a signed cookie of the browser that started it, so any server can finish it.
An account is identified by issuer and subject; its name is used only at the first sign-in.
"""

import importlib.util
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Request, Response
from fastapi.responses import RedirectResponse
from itsdangerous import BadData

from service.auth.cookies import BrowserCookies
from service.auth.roles import OptionalUser
from service.http.errors import Problem
from service.http.requests import LONGEST_PATH, PublicAddress, local_path
from service.http.state import Config, Db, Held
from service.settings import Settings
from service.store.people import credentials, people

router = APIRouter()
COOKIE, PATH, SIGN_IN_S, TIMEOUT_S = "polhode_sign_in", "/oidc", 600, 5.0
SIGNED = ("RS256", "RS384", "RS512", "PS256", "PS384", "PS512", "ES256", "ES384", "ES512", "EdDSA", "Ed25519")
UNAVAILABLE = "the sign-in provider does not respond correctly: try again in a moment, or log in another way"
START_AGAIN = "this sign-in was not started in this browser, or more than ten minutes ago: start again"


class NotInstalled(Exception):
    """The settings need packages that are not installed."""


def provider(settings: Settings) -> Any | None:
    """Return authlib's client for the provider in the settings, None without one.

    Raises NotInstalled if packages are missing.
    """
    if settings.oidc_issuer is None:
        return None
    if missing := [name for name in ("authlib", "httpx2") if importlib.util.find_spec(name) is None]:
        raise NotInstalled(
            f"POLHODE_OIDC_ISSUER needs {' and '.join(missing)}: install polhode's wheel with its extra oidc"
        )
    from authlib.integrations.starlette_client import OAuth

    secret = settings.oidc_client_secret
    options = {"scope": "openid profile email", "code_challenge_method": "S256", "timeout": TIMEOUT_S}
    return OAuth().register(
        "provider",
        client_id=settings.oidc_client_id,
        client_secret=secret and secret.get_secret_value(),
        server_metadata_url=settings.oidc_issuer.rstrip("/") + "/.well-known/openid-configuration",
        client_kwargs=options if secret else options | {"token_endpoint_auth_method": "none"},
    )


class Provider:
    """The sign-in provider; ``client`` is authlib's, None without one in the settings."""

    def __init__(self, settings: Settings) -> None:
        self.client = provider(settings)


async def _client(provider: Held[Provider]) -> Any:
    if provider.client is None:
        raise Problem(
            404, "not-found", "this server has no sign-in provider: log in with a password or token"
        )
    return provider.client


Client = Annotated[Any, Depends(_client)]


@router.get("/oidc/login")
async def start(
    request: Request,
    client: Client,
    settings: Config,
    cookies: BrowserCookies,
    server: PublicAddress,
    next: str = "",
) -> Response:
    """Redirect the browser to the provider."""
    request.scope["session"] = {}
    with _provider_errors():
        await _metadata(client, settings)
        response: Response = await client.authorize_redirect(request, f"{server}{PATH}/callback")
    state = cookies.serializer("sign-in").dumps([request.scope["session"], local_path(next[:LONGEST_PATH])])
    cookies.set(response, COOKIE, state, max_age=SIGN_IN_S, path=PATH)
    return response


@router.get("/oidc/callback")
async def finish(
    request: Request,
    user: OptionalUser,
    client: Client,
    settings: Config,
    database: Db,
    cookies: BrowserCookies,
) -> Response:
    """Log in the person that the provider names, and redirect to the page they requested."""
    try:
        cookie = request.cookies.get(COOKIE, "")
        request.scope["session"], back = cookies.serializer("sign-in").loads(cookie, max_age=SIGN_IN_S)
    except BadData:
        raise Problem(403, "not-allowed", START_AGAIN) from None
    with _provider_errors():
        claims = await _verified_claims(request, client, settings)
    account, logged_in = (
        (str(claims["iss"]), str(claims["sub"])),
        None if user is None else user.viewer or user.name,
    )
    try:
        async with database.begin() as connection:
            name = await credentials.signed_in(
                connection, account, _name(settings.oidc_claim, claims), logged_in
            )
    except credentials.NameTaken as error:
        raise Problem(403, "not-allowed", str(error)) from None
    response = RedirectResponse(back or "/", 303)
    response.delete_cookie(COOKIE, path=PATH)
    await cookies.start_session(response, name, settings.oidc_name)
    return response


async def _verified_claims(request: Request, client: Any, settings: Settings) -> dict[str, Any]:
    """Return the claims of the ID token after verifying signature, issuer, audience, nonce and expiry."""
    metadata, claim = await _metadata(client, settings), settings.oidc_claim
    options = {
        "iss": {"essential": True, "value": metadata["issuer"]},
        "aud": {"essential": True, "value": client.client_id},
    }
    try:
        token = await client.authorize_access_token(request, claims_options=options)
    except Exception:
        metadata.pop("jwks", None)  # the provider may have new keys
        raise
    if not (claims := token.get("userinfo")):
        raise Problem(403, "not-allowed", "the sign-in provider sent no ID token: contact the course staff")
    if claim not in claims and "userinfo_endpoint" in metadata:
        more = await client.userinfo(token=token)
        claims = {**more, **claims} if more.get("sub") == claims["sub"] else claims
    return dict(claims)


def _name(claim: str, claims: dict[str, Any]) -> str:
    if claim == "email" and claims.get("email_verified") is not True:
        raise Problem(
            403,
            "not-allowed",
            "the sign-in provider has not verified your email address: verify it there, then sign in again",
        )
    try:
        return people.normalize_name(claims[claim] if isinstance(claims.get(claim), str) else "")
    except people.InvalidName:
        raise Problem(
            403,
            "not-allowed",
            f"the sign-in provider did not send a usable name (claim {claim}): contact the course staff",
        ) from None


async def _metadata(client: Any, settings: Settings) -> dict[str, Any]:
    """Return the provider's metadata, loaded once.

    Raises Problem 503 if its issuer is not the one in the settings.
    """
    metadata: dict[str, Any] = await client.load_server_metadata()
    if str(metadata.get("issuer")).rstrip("/") != (settings.oidc_issuer or "").rstrip("/"):
        metadata.pop("_loaded_at", None)
        raise Problem(
            503, "busy", "the sign-in provider's issuer differs from POLHODE_OIDC_ISSUER: correct the setting"
        )
    offered = metadata.get("id_token_signing_alg_values_supported") or []
    metadata["id_token_signing_alg_values_supported"] = [name for name in offered if name in SIGNED] or [
        "RS256"
    ]
    return metadata


@contextmanager
def _provider_errors() -> Iterator[None]:
    """Turn errors of the provider and of authlib into problems."""
    import httpx2
    from authlib.integrations.base_client import MismatchingStateError, OAuthError
    from joserfc.errors import JoseError

    try:
        yield
    except MismatchingStateError:
        raise Problem(403, "not-allowed", START_AGAIN) from None
    except OAuthError as error:
        code = error.error if re.fullmatch(r"[a-z_]{1,40}", str(error.error)) else "error"
        raise Problem(
            403, "not-allowed", f"the sign-in provider refused the sign-in ({code}): try again"
        ) from None
    except JoseError as error:
        raise Problem(
            403,
            "not-allowed",
            f"the sign-in provider's response could not be verified ({error.error}): try again",
        ) from None
    except (httpx2.HTTPError, httpx2.InvalidURL, ValueError, LookupError, TypeError, RuntimeError) as error:
        raise Problem(503, "busy", f"{UNAVAILABLE} ({type(error).__name__})") from None
