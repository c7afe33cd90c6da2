"""Which endpoints are safe, and what a refusal says."""

import json

import pytest
from pydantic import ValidationError

from shared.config import load
from shared.errors import ConfigError
from shared.wire.bus import BusSettings, open_bus
from shared.wire.link import RouterSettings, client_config, router_config

FILES = ("ca_certificate", "certificate", "private_key")


@pytest.fixture
def files(tmp_path):
    """Three files that are there; what is in them is looked at by the handshake."""
    for name in FILES:
        (tmp_path / name).write_text("PEM")
    return {name: tmp_path / name for name in FILES}


def value(config, key):
    return json.loads(config.get_json(key))


@pytest.mark.parametrize(
    "endpoint",
    ["tcp/127.0.0.1:7447", "tcp/127.8.9.1:1", "tcp/localhost:65535", "tcp/[::1]:7447",
     "unixsock-stream//run/hld.sock"],
)  # fmt: skip
def test_this_machine_alone_needs_no_certificates(endpoint):
    assert value(client_config(BusSettings(connect=(endpoint,))), "connect/endpoints") == [endpoint]
    assert value(router_config(RouterSettings(listen=(endpoint,))), "listen/endpoints") == [
        endpoint
    ]


@pytest.mark.parametrize(
    "endpoint",
    ["tcp/0.0.0.0:7447", "tcp/[::]:7447", "tcp/192.168.1.7:7447", "tcp/router.example.org:7447",
     "tcp/localhost.example.org:7447", "tcp/127.0.0.1.example.org:7447", "tcp/[2001:db8::1]:7447"],
)  # fmt: skip
def test_the_network_without_tls_is_refused_and_the_right_way_is_said(endpoint, files):
    for settings in ({}, files):
        with pytest.raises(
            ConfigError, match=r"open to the network.*tls/.*ca_certificate"
        ) as error:
            open_bus(BusSettings(connect=(endpoint,), **settings))
        assert endpoint.replace("tcp/", "tls/") in str(error.value)
        with pytest.raises(ConfigError, match=r"listen: .*open to the network"):
            router_config(RouterSettings(listen=(endpoint,), **settings))


def test_every_endpoint_of_a_list_must_be_safe():
    with pytest.raises(ConfigError, match=r"0\.0\.0\.0"):
        client_config(BusSettings(connect=("tcp/127.0.0.1:7447", "tcp/0.0.0.0:7447")))


@pytest.mark.parametrize(
    "endpoint",
    ["", "127.0.0.1:7447", "tcp/127.0.0.1", "tcp/127.0.0.1:", "tcp/127.0.0.1:99999", "tcp/:7447",
     "udp/127.0.0.1:7447", "quic/127.0.0.1:7447", "ws/127.0.0.1:7447", "tcp/127.0.0.1:7447?rel=0",
     "tcp/127.0.0.1:7447#iface=eth0", "tcp/127.0.0.1:7447\n", "unixsock-stream/relative"],
)  # fmt: skip
def test_what_is_no_endpoint_is_said_so_with_examples(endpoint):
    with pytest.raises(ConfigError, match=r"is no endpoint; right would be tcp/127\.0\.0\.1:7447"):
        client_config(BusSettings(connect=(endpoint,)))


def test_tls_asks_both_sides_who_they_are(files):
    client = client_config(BusSettings(connect=("tls/robots.example.org:7447",), **files))
    router = router_config(RouterSettings(listen=("tls/0.0.0.0:7447",), **files))
    for config, side in ((client, "connect"), (router, "listen")):
        tls = value(config, "transport/link/tls")
        assert tls["enable_mtls"] is True
        assert tls["verify_name_on_connect"] is True
        assert tls["root_ca_certificate"] == str(files["ca_certificate"])
        assert tls[f"{side}_certificate"] == str(files["certificate"])
        assert tls[f"{side}_private_key"] == str(files["private_key"])


def test_tls_without_certificates_is_refused():
    with pytest.raises(ConfigError, match="needs ca_certificate, certificate and private_key"):
        client_config(BusSettings(connect=("tls/127.0.0.1:7447",)))


@pytest.mark.parametrize("missing", FILES)
def test_half_of_the_certificates_are_none(files, missing):
    given = {name: path for name, path in files.items() if name != missing}
    with pytest.raises(ConfigError, match=f"missing: {missing}"):
        router_config(RouterSettings(**given))


@pytest.mark.parametrize("name", FILES)
def test_a_file_that_is_not_there_is_named(files, name):
    files[name].unlink()
    with pytest.raises(ConfigError, match=f"{name}: there is no file {files[name]}"):
        client_config(BusSettings(**files))


def test_a_user_needs_a_password_which_no_log_shows():
    settings = BusSettings(user="robot-1", password="hunter2")
    assert value(client_config(settings), "transport/auth/usrpwd/user") == "robot-1"
    assert "hunter2" not in str(settings) + repr(settings) + settings.model_dump_json()
    with pytest.raises(ConfigError, match="user and password belong together"):
        client_config(BusSettings(user="robot-1"))
    with pytest.raises(ConfigError, match="users: there is no file"):
        router_config(RouterSettings(users="/nowhere/users"))


def test_no_link_scouts_or_saves_on_fragments():
    for config in (client_config(BusSettings()), router_config(RouterSettings())):
        assert value(config, "scouting/multicast/enabled") is False
        assert value(config, "scouting/gossip/enabled") is False
        assert value(config, "transport/unicast/lowlatency") is False
        assert value(config, "transport/link/tx/lease") == 2000
    assert value(client_config(BusSettings()), "mode") == "client"
    assert value(router_config(RouterSettings()), "mode") == "router"


def test_the_router_listens_at_its_port_on_this_machine_alone():
    assert RouterSettings(port=1234).endpoints == ("tcp/127.0.0.1:1234",)
    assert RouterSettings(listen=("tcp/[::1]:1",), port=1234).endpoints == ("tcp/[::1]:1",)


@pytest.mark.parametrize(
    "fields", [{"fleet": "a/b"}, {"fleet": "*"}, {"connect": ()}, {"lease_ms": 0}]
)
def test_settings_out_of_range_are_refused(fields):
    with pytest.raises(ValidationError):
        BusSettings(**fields)


def test_settings_are_loaded_like_all_others():
    sets = ['connect=["tcp/127.0.0.1:1"]', "fleet=kitchen"]
    assert load(BusSettings, "bus", sets=sets, environment={}).connect == ("tcp/127.0.0.1:1",)
    assert load(RouterSettings, "router", environment={"HLD_ROUTER_PORT": "5"}).port == 5
    with pytest.raises(ConfigError, match=r"unknown key 'conect'.*'connect'"):
        load(BusSettings, "bus", sets=["conect=1"], environment={})
