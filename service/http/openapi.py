"""The OpenAPI document, with the media types of responses and errors as problems."""

from collections.abc import Mapping
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel

from service.http.errors import PROBLEM_TYPE, TITLES

JSON = "application/json"
Kinds = str | tuple[str, ...]
Responses = dict[int | str, dict[str, Any]]
EVERY = {400: "invalid-request", 500: "fault"}
PERSON: dict[int, Kinds] = {401: "nobody", 403: "not-allowed", 503: "busy"}  # of every authenticated request
PROBLEM = {
    "type": "object",
    "required": ["type", "title", "status", "detail"],
    "properties": {
        "type": {"type": "string", "enum": [f"urn:polhode:problem:{kind}" for kind in TITLES]},
        "title": {"type": "string"},
        "status": {"type": "integer"},
        "detail": {"type": "string", "description": "What failed and what to do."},
        "errors": {
            "type": "array",
            "items": {
                "type": "object",
                "properties": {"pointer": {"type": "string"}, "detail": {"type": "string"}},
            },
        },
    },
}


def problems(kinds: Mapping[int, Kinds]) -> Responses:
    """Return the responses that a route adds to the document: its problem type, or types, by status.

    Every route has 400 and 500.
    """
    content = {PROBLEM_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
    every = {
        status: (names,) if isinstance(names, str) else names for status, names in {**EVERY, **kinds}.items()
    }
    return {
        status: {"description": "; ".join(f"`{kind}`: {TITLES[kind]}" for kind in names), "content": content}
        for status, names in sorted(every.items())
    }


def media(*types: str, model: str | None = None) -> Responses:
    """Return the response 200 with these media types; JSON is an object of the named schema, if one is given.

    Use it with ``response_class=Response``.
    """
    of_json = {"$ref": f"#/components/schemas/{model}"} if model else {"type": "object"}
    return {
        200: {
            "content": {
                type: {"schema": of_json if type.endswith("json") else {"type": "string"}} for type in types
            }
        }
    }


def also(status: int, description: str, model: type[BaseModel]) -> Responses:
    """Return one more response with JSON."""
    return {status: {"description": description, "model": model}}


def install(app: FastAPI) -> None:
    """Give ``app`` a document in which 422 is a problem too, and only on routes that declare it, and in which
    a route that never answers with 401 needs no token.
    """

    def document() -> dict[str, Any]:
        if not app.openapi_schema:
            made = get_openapi(title=app.title, version=app.version, routes=app.routes)
            for operation in (o for path in made["paths"].values() for o in path.values()):
                if PROBLEM_TYPE not in operation["responses"].get("422", {}).get("content", {}):
                    operation["responses"].pop("422", None)
                if "security" in operation and "401" not in operation["responses"]:
                    operation["security"].append({})
            schemas = made.setdefault("components", {}).setdefault("schemas", {})
            for unused in ("HTTPValidationError", "ValidationError"):
                schemas.pop(unused, None)
            schemas["Problem"] = PROBLEM
            app.openapi_schema = made
        return app.openapi_schema

    app.openapi = document  # type: ignore[method-assign]
