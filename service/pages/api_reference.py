"""The page of the HTTP API, made from the OpenAPI document."""

import json
import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, Response
from markupsafe import Markup, escape

from service.auth.roles import OptionalUser
from service.http.openapi import JSON
from service.http.requests import PublicAddress
from service.http.templating import templates

router = APIRouter()
Schema = Mapping[str, Any]
LIMITS = {
    "minimum": "from {}",
    "maximum": "up to {}",
    "minLength": "at least {} characters",
    "maxLength": "at most {} characters",
}
LIMITS |= {"minItems": "at least {}", "pattern": "matches {}"}
EXAMPLES = {"string": "…", "integer": 1, "number": 1.0, "boolean": True, "array": [], "object": {}}
CODE = re.compile(r"``?(.+?)``?", re.DOTALL)


@dataclass(frozen=True)
class Field:
    """A parameter, or a field of an object."""

    name: str
    type: Markup
    required: bool
    description: Markup
    place: str = ""


@router.get("/docs", response_class=HTMLResponse)
async def show_api(request: Request, person: OptionalUser, address: PublicAddress) -> Response:
    """Show every operation of the API with its parameters, bodies and responses."""
    document = request.app.openapi()
    schemas = document["components"]["schemas"]
    groups: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            groups[operation["tags"][0]].append(_operation(address, schemas, method.upper(), path, operation))
    # fields of one request
    named = sorted((name, schema) for name, schema in schemas.items() if not name.startswith("Body_"))
    objects = [
        (name, code(schema.get("description", "")), type_of(schema), fields(schema)) for name, schema in named
    ]
    return templates.TemplateResponse(
        request, "api_reference.html", {"groups": groups, "objects": objects, "address": address}
    )


def _operation(address: str, schemas: Schema, method: str, path: str, operation: Schema) -> dict[str, Any]:
    parameters = [
        Field(p["name"], type_of(p["schema"]), p["required"], code(p.get("description", "")), p["in"])
        for p in operation.get("parameters", ())
    ]
    contents = operation.get("requestBody", {}).get("content", {})
    bodies = {media: schemas.get(_name(one["schema"]), one["schema"]) for media, one in contents.items()}
    responses = operation["responses"].items()
    return {
        "id": operation["operationId"],
        "method": method,
        "path": path,
        "description": [code(part) for part in operation.get("description", "").split("\n\n")],
        "token": "security" in operation,
        "parameters": parameters,
        "bodies": [(media, fields(schema)) for media, schema in bodies.items()],
        "responses": [
            (
                status,
                code(one["description"]),
                [(media, *_content(content)) for media, content in one.get("content", {}).items()],
            )
            for status, one in responses
            if status < "4"
        ],
        "errors": [(status, code(one["description"])) for status, one in responses if status >= "4"],
        "curl": _curl(address, method, path, bodies, "security" in operation),
    }


def _content(content: Schema) -> tuple[Markup, list[Field]]:
    """Return the type of a body, and its fields if it is an object without a name."""
    schema = content.get("schema") or content.get("itemSchema") or {}
    return type_of(schema), fields(schema)


def fields(schema: Schema) -> list[Field]:
    """Return the fields of an object in the order of its declaration."""
    required = schema.get("required", ())
    return [
        Field(name, type_of(one), name in required, code(one.get("description", "")))
        for name, one in schema.get("properties", {}).items()
    ]


def type_of(schema: Schema) -> Markup:
    """Return the type of a schema in words, with its limits and default;
    names of objects are links to them.
    """
    if "$ref" in schema:
        return Markup('<a href="#{0}">{0}</a>').format(_name(schema))
    if "anyOf" in schema:
        shown = _joined(" or ", (type_of(one) for one in schema["anyOf"]))
    elif "enum" in schema or "const" in schema:
        shown = _joined(
            " or ",
            (Markup("<code>{}</code>").format(one) for one in schema.get("enum", [schema.get("const")])),
        )
    elif schema.get("type") == "array":
        shown = Markup("list of {}").format(type_of(schema["items"]))
    elif isinstance(schema.get("additionalProperties"), dict):
        shown = Markup("object with values {}").format(type_of(schema["additionalProperties"]))
    else:
        shown = escape(schema.get("format", schema.get("type", "any")))
    limits = [escape(words).format(schema[key]) for key, words in LIMITS.items() if key in schema]
    if schema.get("default") not in (None, [], {}) and "const" not in schema:
        limits.append(
            Markup("default <code>{}</code>").format(json.dumps(schema["default"], ensure_ascii=False))
        )
    return _joined(", ", [shown, *limits])


def _name(schema: Schema) -> str:
    return str(schema.get("$ref", "")).rpartition("/")[2]


def _joined(separator: str, parts: Iterable[Markup]) -> Markup:
    return escape(separator).join(parts)


def code(text: str) -> Markup:
    """Return the text with what stands between backticks as code."""
    parts = enumerate(CODE.split(text))
    return _joined(
        "", (Markup("<code>{}</code>").format(part) if k % 2 else escape(part) for k, part in parts)
    )


def _curl(address: str, method: str, path: str, bodies: Schema, token: bool) -> str:
    """Return the command that sends a request; what the reader replaces is in capitals."""
    parts = ["curl"] + ([f"-X {method}"] if method != "GET" else [])
    if token:
        parts.append('-H "Authorization: Bearer $TOKEN"')
    if JSON in bodies:
        properties, required = bodies[JSON]["properties"], bodies[JSON].get("required", ())
        example = {
            name: properties[name].get("enum", [EXAMPLES[properties[name]["type"]]])[0] for name in required
        }
        parts += ["-H 'Content-Type: application/json'", f"-d '{json.dumps(example, ensure_ascii=False)}'"]
    address = address + re.sub(r"\{(\w+)\}", lambda name: name[1].upper(), path)
    return " ".join([*parts, f"'{address}'"])
