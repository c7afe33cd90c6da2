"""Real handshakes: who has no certificate of ours, or no password, stays outside."""

import shutil
import subprocess

import pytest

from shared.wire.bus import BusSettings, open_bus
from shared.wire.link import RouterSettings
from shared.wire.router import Router
from tests.integration.wire.processes import answered, free_port, until

NEW_KEY = "-newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes"
OUTSIDE_S = 1.5  # in which who is welcome has long been let in


def openssl(folder, arguments):
    subprocess.run(["openssl", *arguments.split()], cwd=folder, check=True, capture_output=True)


def authority(folder, name):
    """A certificate authority of one's own; the path of its certificate."""
    request = f"req -x509 {NEW_KEY} -keyout {name}.key -out {name}.pem -subj /CN={name} -days 2"
    openssl(folder, f"{request} -addext basicConstraints=critical,CA:TRUE")
    return folder / f"{name}.pem"


def certificate(folder, name, signer):
    """A certificate that the authority signed, as settings of a bus or a router."""
    openssl(folder, f"req -new {NEW_KEY} -keyout {name}.key -out {name}.csr -subj /CN={name}")
    (folder / f"{name}.ext").write_text(
        "subjectAltName=IP:127.0.0.1\nbasicConstraints=CA:FALSE\n"
        "extendedKeyUsage=serverAuth,clientAuth\n"
    )
    signed = f"x509 -req -in {name}.csr -CA {signer}.pem -CAkey {signer}.key -CAcreateserial"
    openssl(folder, f"{signed} -out {name}.pem -days 2 -extfile {name}.ext")
    return {
        "ca_certificate": folder / f"{signer}.pem",
        "certificate": folder / f"{name}.pem",
        "private_key": folder / f"{name}.key",
    }


@pytest.fixture(scope="module")
def certificates(tmp_path_factory):
    """Certificates of ours and of somebody else's."""
    assert shutil.which("openssl"), "this test makes its certificates with openssl"
    folder = tmp_path_factory.mktemp("tls")
    authority(folder, "ours")
    authority(folder, "theirs")
    return {
        "router": certificate(folder, "router", "ours"),
        "robot": certificate(folder, "robot", "ours"),
        "stranger": certificate(folder, "stranger", "theirs"),
    }


def test_a_certificate_of_ours_opens_the_door_and_no_other_does(certificates):
    endpoint = f"tls/127.0.0.1:{free_port()}"
    stranger = certificates["stranger"]
    trusting = stranger | {"ca_certificate": certificates["robot"]["ca_certificate"]}
    with Router(RouterSettings(listen=(endpoint,), **certificates["router"])):
        with (
            open_bus(BusSettings(connect=(endpoint,), **certificates["robot"])) as robot,
            open_bus(BusSettings(connect=(endpoint,), **certificates["robot"])) as other,
            open_bus(BusSettings(connect=(endpoint,), **stranger)) as refusing,
            open_bus(BusSettings(connect=(endpoint,), **trusting)) as refused,
        ):
            assert robot.joined(10)
            assert other.joined(10)
            other.serve("a", lambda _key, _data: b"ok")
            until(lambda: answered(robot))
            assert not refusing.joined(OUTSIDE_S)
            assert not refused.joined(0)


def test_a_router_that_asks_for_a_password_gets_the_right_one_or_nobody(tmp_path):
    users = tmp_path / "users"
    users.write_text("robot-1:right\n")
    port = free_port()
    here = (f"tcp/127.0.0.1:{port}",)
    with (
        Router(RouterSettings(port=port, users=users)),
        open_bus(BusSettings(connect=here, user="robot-1", password="right")) as known,
        open_bus(BusSettings(connect=here, user="robot-1", password="wrong")) as wrong,
        open_bus(BusSettings(connect=here)) as nobody,
    ):
        assert known.joined(10)
        assert not wrong.joined(OUTSIDE_S)
        assert not nobody.joined(0)
