"""Settings, read from environment variables with the prefix ``POLHODE_``; docs/settings.md lists them."""

import os
from pathlib import Path
from typing import Literal
from urllib.parse import urlsplit

from pydantic import AliasChoices, Field, SecretStr, field_validator, model_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

LEASE_S, DATABASE_WAIT_S = 2.0, 5.0
LONGEST_ESCAPE = 6  # characters of JSON for one byte, as in \u0001


class Settings(BaseSettings):
    """All settings of a server and its workers."""

    model_config = SettingsConfigDict(
        env_prefix="POLHODE_", extra="ignore", env_ignore_empty=True, populate_by_name=True
    )

    data: Path = Field(Path("polhode-data"), description="Folder for the embedded database and its log.")
    database_url: str | None = Field(
        None, description="A PostgreSQL to use instead of the embedded one (postgresql://…)."
    )
    min_isolation: Literal["namespaces", "process"] = Field(
        "process",
        description=(
            "The weakest isolation level to grade at: namespaces (bubblewrap), or process, as in an ordinary"
            " container."
        ),
    )
    allow_root_guest: bool = Field(
        False, description="Grade even if a server that runs as root cannot run submissions as another user."
    )
    workers: int = Field(
        os.cpu_count() or 1,
        ge=0,
        description="Number of worker processes; each has three warm guests (150 MB).",
    )
    drain: float = Field(
        3.0, ge=0, description="Seconds a stopping worker may finish its grading before queueing it again."
    )
    submission_kib: int = Field(
        256,
        ge=1,
        le=32768,
        description="Largest source of a submission in KiB, of a notebook without its outputs.",
    )
    upload_mib: int = Field(
        20, ge=1, le=200, description="Largest upload of a submission in MiB, of a notebook with its outputs."
    )
    grading_cpu: float = Field(
        60.0,
        gt=0,
        le=3600,
        description="Seconds of CPU time a grading may use in the sandbox; an assignment may declare more.",
    )
    grading_wall: float = Field(
        120.0,
        gt=0,
        le=7200,
        description="Seconds that a grading may take in the sandbox. What has not run by then has timed out.",
    )
    lease: float = Field(
        LEASE_S,
        ge=0.4,
        le=60.0,
        description="Seconds without a heartbeat after which a run is lost; workers send four per lease.",
    )
    database_wait: float = Field(
        DATABASE_WAIT_S,
        gt=0,
        le=60.0,
        description="Seconds a request or a worker waits for a connection to the database.",
    )
    postgres: Path | None = Field(
        None, description="Folder of PostgreSQL's programs, instead of the wheel's or the system's."
    )
    identity: Literal["local", "token"] = Field(
        "local", description="local: one local student without login; token: people log in."
    )
    person_header: str | None = Field(
        None, description="Header in which a reverse proxy passes the name of the user."
    )
    token_days: float = Field(
        200.0, gt=0, description="Days for which a token from polhode.login() is valid."
    )
    hub_api_url: str | None = Field(
        None,
        validation_alias=AliasChoices("POLHODE_HUB_API_URL", "JUPYTERHUB_API_URL"),
        description="The API of a JupyterHub whose users' tokens are accepted.",
    )
    hub_service: str = Field("polhode", description="Name of this server among the services of that hub.")
    origins: str = Field(
        "", description="Web origins whose pages may call the server, comma-separated (CORS)."
    )
    public_url: str | None = Field(None, description="The address that students use, if a proxy changes it.")
    oidc_issuer: str | None = Field(
        None, description="The OpenID provider whose users may sign in (https://…)."
    )
    oidc_client_id: str | None = Field(None, description="Client id of this server at the provider.")
    oidc_client_secret: SecretStr | None = Field(
        None, description="Client secret at the provider; empty for a public client."
    )
    oidc_claim: str = Field("preferred_username", description="The claim that holds the person's name.")
    oidc_name: str = Field("your institution", description="The provider's name on the sign-in button.")
    log_level: Literal["debug", "info", "warning", "error"] = Field(
        "warning", description="Lowest level that is logged."
    )

    @property
    def is_single_user(self) -> bool:
        """Whether a request without authentication belongs to the one local person, until people log in."""
        return self.identity == "local" and self.person_header is None

    @field_validator("origins")
    @classmethod
    def _origins(cls, value: str) -> str:
        origins = [origin.strip().rstrip("/") for origin in value.split(",") if origin.strip()]
        if wrong := [o for o in origins if not o.startswith(("http://", "https://")) or o.count("/") != 2]:
            raise ValueError(f"{wrong[0]} is not an origin such as https://lite.example")
        return ",".join(origins)

    @model_validator(mode="after")
    def _hub_needs_tokens(self) -> "Settings":
        """Ignore the hub's address that a server inside a hub inherits, unless people log in by tokens."""
        if self.identity == "local" and self.hub_api_url is not None:
            if os.environ.get("POLHODE_HUB_API_URL"):
                raise ValueError("POLHODE_HUB_API_URL needs POLHODE_IDENTITY=token")
            self.hub_api_url = None
        return self

    @model_validator(mode="after")
    def _upload_holds_a_submission(self) -> "Settings":
        if 1024 * self.upload_mib < LONGEST_ESCAPE * self.submission_kib:
            raise ValueError(
                f"POLHODE_UPLOAD_MIB must hold at least {LONGEST_ESCAPE} times POLHODE_SUBMISSION_KIB, its"
                " longest form in JSON"
            )
        return self

    @field_validator("oidc_issuer")
    @classmethod
    def _issuer(cls, issuer: str | None) -> str | None:
        url = urlsplit(issuer or "")
        loopback = url.hostname in ("localhost", "127.0.0.1", "::1")
        if issuer is not None and not (
            url.netloc and (url.scheme == "https" or (url.scheme == "http" and loopback))
        ):
            raise ValueError(
                "the issuer must be an address https://…; http:// is allowed only on this machine"
            )
        return issuer

    @model_validator(mode="after")
    def _provider_needs_tokens(self) -> "Settings":
        if self.oidc_issuer is not None and self.oidc_client_id is None:
            raise ValueError("POLHODE_OIDC_ISSUER needs POLHODE_OIDC_CLIENT_ID")
        if self.oidc_issuer is not None and self.identity == "local":
            raise ValueError("POLHODE_OIDC_ISSUER needs POLHODE_IDENTITY=token")
        return self

    @field_validator("database_url")
    @classmethod
    def _postgresql(cls, url: str | None) -> str | None:
        if url is not None and not url.startswith(("postgresql://", "postgres://")):
            raise ValueError("the address must have the form postgresql://user:password@host/database")
        return url

    host: str = Field("127.0.0.1", description="Address the server listens on.")
    port: int = Field(8000, ge=0, le=65535, description="Port the server listens on.")
    connections: int = Field(
        4000, ge=8, description="Connections to the server at the same time; half of them from one address."
    )
    header_timeout: float = Field(
        10.0, gt=0, description="Seconds in which the header of a request must arrive."
    )
    body_timeout: float = Field(
        20.0,
        gt=0,
        description=(
            "Seconds in which the body of a request must arrive, plus one second for each 10 000 bytes."
        ),
    )
    open_submissions: int = Field(
        20, ge=1, description="Submissions of one student that may wait for their reports at the same time."
    )

    def allowed_origins(self) -> list[str]:
        """Return ``origins`` as a list."""
        return [origin for origin in self.origins.split(",") if origin]
