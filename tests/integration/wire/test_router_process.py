"""`python -m deploy.router` from the outside."""

import signal

import pytest

from tests.integration.wire.processes import Child, RouterProcess


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_the_router_ends_in_good_order_when_it_is_asked_to(router, number):
    router.bus().close()
    router.signal(number)
    code, _, log = router.ended()
    assert code == 0, log
    assert f"tcp/127.0.0.1:{router.port}" in log


@pytest.mark.parametrize(
    ("setting", "says"),
    [
        ('listen=["tcp/0.0.0.0:7447"]', "open to the network"),
        ('listen=["tls/0.0.0.0:7447"]', "needs ca_certificate"),
        ("prot=7447", "nearest known: 'port'"),
        ("port=99999", "less than or equal to 65535"),
    ],
)
def test_a_wrong_setting_ends_it_with_code_2_and_says_what_is_right(setting, says):
    with Child("deploy.router", "--set", setting) as child:
        code, _, log = child.ended()
    assert code == 2
    assert says in log
    assert "Traceback" not in log


def test_a_port_that_is_taken_is_said_so(router):
    router.bus().close()
    with Child("deploy.router", "--set", f"port={router.port}") as second:
        code, _, log = second.ended()
    assert code == 2
    assert f"cannot listen on tcp/127.0.0.1:{router.port}" in log


def test_a_router_reads_its_table_of_a_settings_file(tmp_path):
    probe = RouterProcess()
    (tmp_path / "hld.toml").write_text(f"[router]\nport = {probe.port}\n[actor]\nunknown = 1\n")
    with Child("deploy.router", "--config", str(tmp_path / "hld.toml")):
        probe.bus().close()
