"""What is asked of a server in a container, over HTTP."""

import json
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from typing import Any

from exercises.authoring.assignments.samples import Sample
from tests.image.engine import Failed

GRADED_S = 90


def readyz(address: str) -> dict[str, Any]:
    """What it tells of itself; {} where nobody answers."""
    try:
        return _json(urllib.request.Request(f"{address}/readyz"))
    except (OSError, urllib.error.URLError):
        return {}


def until(seen: Callable[[], Any], seconds: float, what: str) -> Any:
    """The first truth that ``seen`` tells; Failed after ``seconds``."""
    deadline = time.monotonic() + seconds
    while not (found := seen()):
        if time.monotonic() > deadline:
            raise Failed(f"{what}: not within {seconds:g} s")
        time.sleep(0.25)
    return found


def submit(address: str, sample: Sample, token: str | None = None) -> str:
    """Send it; the submission's id."""
    body = {"source": sample.file.read_text()} | ({"exercises": sample.ask} if sample.ask else {})
    headers = {"Content-Type": "application/json"} | _bearer(token)
    sent = urllib.request.Request(
        f"{address}/v1/assignments/rigid-body/submissions", json.dumps(body).encode(), headers
    )
    return str(_json(sent)["id"])


def graded(address: str, id: str, sample: Sample, token: str | None = None) -> dict[str, Any]:
    """Its report once there is one; Failed where it is not the one expected."""
    asked = urllib.request.Request(f"{address}/v1/submissions/{id}", headers=_bearer(token))
    told = until(
        lambda: (now := _json(asked))["status"] not in ("queued", "running") and now,
        GRADED_S,
        sample.file.name,
    )
    if told["report"] is None or (odd := sample.unexpected(told["report"])):
        raise Failed(
            f"{sample.file.name}: {told['status']}"
            f" {told.get('system_fault', '')}{'' if told['report'] is None else odd}"
        )
    report: dict[str, Any] = told["report"]
    return report


def marks(report: dict[str, Any]) -> str:
    """Its verdicts as marks, one a check."""
    shown = {"pass": "✓", "fail": "✗", "unmeasured": "–"}
    return "".join(
        shown[outcome["verdict"]] for exercise in report["exercises"] for outcome in exercise["outcomes"]
    )


def _json(request: urllib.request.Request) -> dict[str, Any]:
    with urllib.request.urlopen(request, timeout=10) as answer:
        told: dict[str, Any] = json.load(answer)
    return told


def _bearer(token: str | None) -> dict[str, str]:
    return {"Authorization": f"Bearer {token}"} if token else {}
