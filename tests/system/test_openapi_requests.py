"""Requests that schemathesis derives from the OpenAPI document: no 5xx, and nothing that the document does
not declare.
"""

import json

import hypothesis
import pytest
import schemathesis
from hypothesis import strategies as st
from schemathesis import GenerationMode
from schemathesis.checks import CHECKS, load_all_checks

from polhode.client.kit_hash import WHEEL
from polhode.judging.outcome import SweepResult
from polhode.report.dataclass_json import document
from polhode.report.report import Picture
from service.store.queue.workers import register_worker
from service.store.submissions.artefacts import store_artefacts
from tests.support.app import App
from tests.support.database import entered, new_database, run
from tests.support.http_client import call
from tests.support.submissions import graded

load_all_checks()
SWEEP = json.dumps(document(SweepResult("free", [], "no points"))).encode()
EXAMPLES = 30  # of each operation, for each role
# Refuse bodies of a valid form by their content: the source, the code of a login, a line that the source does
# not have, a check that the report does not have.
REFUSES = {
    "POST /v1/assignments/{slug}/submissions",
    "POST /v1/logins/token",
    "POST /v1/submissions/{id}/comments",
    "POST /v1/submissions/{id}/regrade-requests",
}
ARTEFACTS = ("figures/omega.png", "figures/omega.svg", "sweep.json", "sweep.svg", "animations/spin.png")


@pytest.fixture(scope="module")
def url(postgres):
    return new_database(postgres.url, "polhode")


@pytest.fixture(scope="module")
def server(url):
    started = App(database_url=url, open_submissions=10_000)
    yield started
    started.stop()


@pytest.fixture(scope="module")
def known(url):
    """Path parameters of what exists: ann's graded submission with its pictures, and the names of an
    assignment.
    """
    picture = {
        "figures": [Picture("omega", "2", "ω", "ω(t)")],
        "animations": [Picture("spin", "2", "spin", "a spin")],
    }
    id = graded(url, "ann", "+-", **picture)

    async def store(database):
        grading = (await database.rows("SELECT id FROM grading WHERE submission_id = %(id)s", {"id": id}))[
            0
        ].id
        await store_artefacts(database, grading, dict.fromkeys(ARTEFACTS, SWEEP))

    run(url, store)
    return {
        "id": [str(id)],
        "slug": ["rigid-body"],
        "name": ["omega", "spin", WHEEL],
    }


def cases(operation, known):
    """Valid requests, half of them for what exists, and invalid ones."""

    def existing(case, values):
        case.path_parameters |= {
            name: value for name, value in values.items() if name in case.path_parameters
        }
        return case

    valid = operation.as_strategy(generation_mode=GenerationMode.POSITIVE)
    values = st.fixed_dictionaries({name: st.sampled_from(choices) for name, choices in known.items()})
    return st.one_of(
        valid,
        st.builds(existing, valid, values),
        operation.as_strategy(generation_mode=GenerationMode.NEGATIVE),
    )


def request_operation(server, operation, known, token):
    excluded = [CHECKS.get_one("positive_data_acceptance")] if operation.label in REFUSES else []

    @hypothesis.settings(
        max_examples=EXAMPLES,
        deadline=None,
        suppress_health_check=list(hypothesis.HealthCheck),
        database=None,
    )
    @hypothesis.seed(24)
    @hypothesis.given(cases(operation, known))
    def check(case):
        headers = {"Authorization": f"Bearer {token}"}
        case.call_and_validate(base_url=server.url, headers=headers, timeout=60, excluded_checks=excluded)

    check()


@pytest.mark.slow
@pytest.mark.parametrize("role", ["student", "instructor"])
def test_the_server_does_what_its_document_declares(server, url, known, role, subtests):
    schema = schemathesis.openapi.from_dict(json.loads(call(server, "/openapi.json")[2]))
    for operation in (found.ok() for found in schema.get_all_operations()):
        run(
            url, lambda database: register_worker(database, "w1", "namespaces", None)
        )  # counts as alive for ten seconds
        token = entered(
            url, "ann" if role == "student" else "prof", role
        )  # of one operation, which may revoke it
        with subtests.test(operation.label):
            request_operation(server, operation, known, token)
