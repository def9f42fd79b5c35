"""Settings, all from the environment with the prefix ``POLHODE_``; docs/settings.md lists them."""

import os
from pathlib import Path
from typing import Literal

from pydantic import Field, field_validator
from pydantic_settings import BaseSettings, SettingsConfigDict


class Settings(BaseSettings):
    """Everything an operator can set."""

    model_config = SettingsConfigDict(env_prefix="POLHODE_", extra="ignore", env_ignore_empty=True)

    data: Path = Field(Path("polhode-data"), description="Folder for the embedded database and its log.")
    database_url: str | None = Field(None, description="A PostgreSQL to use instead of the embedded one (postgresql://…).")
    min_tier: Literal["A", "B"] = Field(
        "B",
        description="The least walls to grade behind: A with namespaces (bubblewrap), B without, as in an ordinary container.",
    )
    workers: int = Field(os.cpu_count() or 1, ge=0, description="Submissions graded at the same time; each keeps one warm guest.")
    drain: float = Field(3.0, ge=0, description="Seconds a stopping worker gives what it is grading, before it is queued again.")
    postgres: Path | None = Field(None, description="Folder of PostgreSQL's programs, instead of the wheel's or the system's.")
    person_header: str | None = Field(None, description="Header in which a proxy in front tells who submits.")
    log_level: Literal["debug", "info", "warning", "error"] = Field("warning", description="Log lines from this level on.")

    @field_validator("database_url")
    @classmethod
    def _postgresql(cls, url: str | None) -> str | None:
        if url is not None and not url.startswith(("postgresql://", "postgres://")):
            raise ValueError("an address is postgresql://user:password@host/database")
        return url

    host: str = Field("127.0.0.1", description="Address the server listens on.")
    port: int = Field(8000, ge=0, le=65535, description="Port the server listens on.")
