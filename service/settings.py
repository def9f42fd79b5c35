"""Settings, all from the environment with the prefix ``POLHODE_``; docs/settings.md lists them."""

import os
from pathlib import Path
from typing import Literal
from urllib.parse import urlsplit

from pydantic import AliasChoices, Field, SecretStr, field_validator, model_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

LEASE_S, DATABASE_WAIT_S = 2.0, 5.0


class Settings(BaseSettings):
    """Everything an operator can set."""

    model_config = SettingsConfigDict(env_prefix="POLHODE_", extra="ignore", env_ignore_empty=True, populate_by_name=True)

    data: Path = Field(Path("polhode-data"), description="Folder for the embedded database and its log.")
    database_url: str | None = Field(None, description="A PostgreSQL to use instead of the embedded one (postgresql://…).")
    min_isolation: Literal["namespaces", "process"] = Field(
        "process",
        validation_alias=AliasChoices("POLHODE_MIN_ISOLATION", "POLHODE_MIN_TIER"),
        description="The weakest isolation level to grade at: namespaces (bubblewrap), or process, as in an ordinary container.",
    )
    workers: int = Field(os.cpu_count() or 1, ge=0, description="Submissions graded at the same time; each keeps one warm guest.")
    drain: float = Field(3.0, ge=0, description="Seconds a stopping worker gives what it is grading, before it is queued again.")
    lease: float = Field(
        LEASE_S, ge=0.4, le=60.0, description="Seconds without one of the four signs of life in a lease: a run is lost."
    )
    database_wait: float = Field(
        DATABASE_WAIT_S, gt=0, le=60.0, description="Seconds a request or a worker waits for a connection to the database."
    )
    postgres: Path | None = Field(None, description="Folder of PostgreSQL's programs, instead of the wheel's or the system's.")
    identity: Literal["local", "token"] = Field("local", description="Whether everybody is one local student, or brings a token.")
    person_header: str | None = Field(None, description="Header in which a proxy in front tells who submits.")
    token_days: float = Field(200.0, gt=0, description="Days a token is good that a notebook got by ecp.login().")
    hub_api_url: str | None = Field(
        None,
        validation_alias=AliasChoices("POLHODE_HUB_API_URL", "JUPYTERHUB_API_URL"),
        description="The API of a JupyterHub whose users' tokens are accepted.",
    )
    hub_service: str = Field("polhode", description="The name this server has as a service of that hub.")
    origins: str = Field("", description="Sites whose pages may call the server, with commas between.")
    public_url: str | None = Field(None, description="The address students use, where a proxy changes it.")
    oidc_issuer: str | None = Field(None, description="The OpenID provider whose users may sign in (https://…).")
    oidc_client_id: str | None = Field(None, description="What this server is called there.")
    oidc_client_secret: SecretStr | None = Field(None, description="The secret it has there; none for a public client.")
    oidc_claim: str = Field("preferred_username", description="The claim that is the person's name.")
    oidc_name: str = Field("your institution", description="What the button says to sign in with.")
    log_level: Literal["debug", "info", "warning", "error"] = Field("warning", description="Log lines from this level on.")

    @field_validator("min_isolation", mode="before")
    @classmethod
    def _tier(cls, level: object) -> object:
        """Accept the values of the former setting POLHODE_MIN_TIER."""
        return {"A": "namespaces", "B": "process"}.get(level, level) if isinstance(level, str) else level

    @field_validator("origins")
    @classmethod
    def _origins(cls, told: str) -> str:
        origins = [origin.strip().rstrip("/") for origin in told.split(",") if origin.strip()]
        if wrong := [o for o in origins if not o.startswith(("http://", "https://")) or o.count("/") != 2]:
            raise ValueError(f"{wrong[0]} is no origin such as https://lite.example")
        return ",".join(origins)

    @model_validator(mode="after")
    def _hub_needs_tokens(self) -> "Settings":
        """A server inside a hub inherits its address; only one that asks for tokens may mean it."""
        if self.identity == "local" and self.hub_api_url is not None:
            if os.environ.get("POLHODE_HUB_API_URL"):
                raise ValueError("POLHODE_HUB_API_URL needs POLHODE_IDENTITY=token: else everybody is one local student")
            self.hub_api_url = None
        return self

    @field_validator("oidc_issuer")
    @classmethod
    def _issuer(cls, issuer: str | None) -> str | None:
        told = urlsplit(issuer or "")
        loopback = told.hostname in ("localhost", "127.0.0.1", "::1")
        if issuer is not None and not (told.netloc and (told.scheme == "https" or (told.scheme == "http" and loopback))):
            raise ValueError("an issuer is https://…, without encryption only on this machine")
        return issuer

    @model_validator(mode="after")
    def _provider_needs_tokens(self) -> "Settings":
        if self.oidc_issuer is not None and self.oidc_client_id is None:
            raise ValueError("POLHODE_OIDC_ISSUER needs POLHODE_OIDC_CLIENT_ID")
        if self.oidc_issuer is not None and self.identity == "local":
            raise ValueError("POLHODE_OIDC_ISSUER needs POLHODE_IDENTITY=token: else everybody is one local student")
        return self

    @field_validator("database_url")
    @classmethod
    def _postgresql(cls, url: str | None) -> str | None:
        if url is not None and not url.startswith(("postgresql://", "postgres://")):
            raise ValueError("an address is postgresql://user:password@host/database")
        return url

    host: str = Field("127.0.0.1", description="Address the server listens on.")
    port: int = Field(8000, ge=0, le=65535, description="Port the server listens on.")

    def allowed_origins(self) -> list[str]:
        """``origins`` one by one."""
        return [origin for origin in self.origins.split(",") if origin]
