"""The API is not to be opened to the world by accident."""

from pathlib import Path

import pytest

from services.correction_api.config import ApiSettings
from shared.config import load
from shared.errors import ConfigError

SAFE = {
    "token": "0123456789abcdef",
    "tls_certificate": Path("a.pem"),
    "tls_key": Path("b.pem"),
}


@pytest.mark.parametrize("host", ["127.0.0.1", "::1", "localhost", "127.0.0.9"])
def test_this_machine_needs_no_token(host: str) -> None:
    assert ApiSettings(host=host).loopback


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.4", "robots.example"])
@pytest.mark.parametrize("missing", list(SAFE))
def test_other_machines_need_a_token_and_tls(host: str, missing: str) -> None:
    ApiSettings.model_validate({"host": host, **SAFE})
    with pytest.raises(ValueError, match=r"token|tls"):
        ApiSettings.model_validate({"host": host, **SAFE, missing: None})


def test_the_refusal_names_the_host_and_the_way_out() -> None:
    with pytest.raises(ConfigError, match=r"0\.0\.0\.0 .* set token.* or listen on 127\.0\.0\.1"):
        load(ApiSettings, "api", sets=['host="0.0.0.0"'], environment={})


@pytest.mark.parametrize("prefix", ["robots", "/robots/", "/a b", "//"])
def test_a_prefix_begins_and_does_not_end_with_a_slash(prefix: str) -> None:
    with pytest.raises(ValueError, match="prefix"):
        ApiSettings(prefix=prefix)


def test_an_unknown_key_names_the_nearest() -> None:
    with pytest.raises(ConfigError, match=r"delivery\.expire_s"):
        load(ApiSettings, "api", sets=["delivery.expires_s=3"], environment={})
