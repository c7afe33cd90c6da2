"""The OpenAPI text against the service: whatever it allows or not, nothing crashes, and what is
answered is what it says."""

import json

import httpx
import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from schemathesis.checks import (
    content_type_conformance,
    not_a_server_error,
    response_schema_conformance,
    status_code_conformance,
)
from schemathesis.generation import GenerationMode
from schemathesis.schemas import APIOperation, BaseSchema

CHECKS = [
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_schema_conformance,
]
EXAMPLES = 40


@schemathesis.serializer("audio/l16")
def _sound(ctx: schemathesis.SerializationContext, value: object) -> object:
    """Sound goes out as it is."""
    del ctx  # Unused.
    return value if isinstance(value, bytes) else json.dumps(value).encode()


LIMITS = settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=list(HealthCheck),
)


def _schema(api: httpx.Client) -> BaseSchema:
    return schemathesis.openapi.from_url(str(api.base_url.join("api/v1/openapi.json")))


@pytest.mark.parametrize("mode", [GenerationMode.POSITIVE, GenerationMode.NEGATIVE])
def test_no_request_makes_the_service_fail(
    standing_api: httpx.Client, mode: GenerationMode
) -> None:
    for found in _schema(standing_api).get_all_operations():
        operation = found.ok()
        if mode is GenerationMode.POSITIVE or _can_be_wrong(operation):
            _fuzz(operation, mode)
    assert standing_api.get("readyz").status_code == 200


def _can_be_wrong(operation: APIOperation) -> bool:
    """Something is asked besides the path, in which any text is a name."""
    asked = operation.definition.raw
    places = {parameter["in"] for parameter in asked.get("parameters", ())}
    return "requestBody" in asked or bool(places - {"path"})


def _fuzz(operation: APIOperation, mode: GenerationMode) -> None:
    @LIMITS
    @given(case=operation.as_strategy(generation_mode=mode))
    def call(case: schemathesis.Case) -> None:
        if "robot" in case.path_parameters and case.method == "POST":
            case.path_parameters["robot"] = "robot-1"  # Else it would be unknown every time.
        if case.query.get("wait_s"):
            case.query["wait_s"] = "0"
        case.call_and_validate(checks=CHECKS)

    call()


def test_every_route_is_shown_with_an_example(standing_api: httpx.Client) -> None:
    paths = standing_api.get("api/v1/openapi.json").json()["paths"]
    for path, methods in paths.items():
        for method, route in methods.items():
            assert route["summary"], (method, path)
            good = route["responses"].get("201") or route["responses"]["200"]
            media = next(iter(good["content"].values()))
            assert "example" in media or path.endswith(("/healthz", "/readyz")), path
    assert len(paths) == 25
