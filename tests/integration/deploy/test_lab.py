"""The example for a lab: by its settings people and robots come in, by TLS, and nobody else does.

Real processes: a router and an API by that file, with certificates that its script has just made.
"""

import re
import shutil
import ssl
import subprocess
import tomllib
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from deploy.ports import free_port
from services.actor.config import ActorSettings
from services.correction_api.config import ApiSettings
from services.correction_api.people import fresh_token, hashed
from services.learner.config import LearnerSettings
from shared.config import Settings, load
from shared.wire.bus import open_bus
from shared.wire.link import RouterSettings
from tests.integration.correction_api.fakes import FakeRobot
from tests.integration.correction_api.processes import Process
from tests.integration.correction_api.running import eventually

LAB = Path(__file__).parents[3] / "deploy" / "lab"
EXAMPLE = LAB / "lab.toml"
MODELS: dict[str, type[Settings]] = {
    "router": RouterSettings,
    "api": ApiSettings,
    "learner": LearnerSettings,
    "actor": ActorSettings,
}
DESK = "desk.lab.example"
WITHIN_S = 60.0  # Processes start on a busy machine.
OUTSIDE_S = 1.5  # in which who is welcome has long been let in


def certify(folder: Path, *words: str) -> None:
    subprocess.run([LAB / "certificates.sh", folder, *words], check=True, capture_output=True)


class Lab:
    """The example in a folder of its own, on free ports, with Anna among its people."""

    def __init__(self, folder: Path) -> None:
        self.token = fresh_token()
        self.port, self._outside, self._inside = free_port(), free_port(), free_port()
        certify(folder / "etc", DESK, "127.0.0.1")
        certify(folder / "etc", "actor-1")
        text = EXAMPLE.read_text()
        for there, here in (("/etc/hl-dagger", "etc"), ("/var/lib/hl-dagger", "var")):
            assert there in text
            text = text.replace(there, str(folder / here))
        self.file = folder / "lab.toml"
        self.file.write_text(text)
        self.authority = ssl.create_default_context(cafile=str(folder / "etc" / "ca.pem"))
        self.url = f"https://127.0.0.1:{self.port}/"

    def start(self) -> list[Process]:
        inside = f"tcp/127.0.0.1:{self._inside}"
        listen = [f"tls/127.0.0.1:{self._outside}", inside]
        people = {"people__anna": hashed(self.token)}
        return [
            Process("deploy.router", config=self.file, listen=listen),
            Process(
                "services.correction_api",
                config=self.file,
                port=self.port,
                bus__connect=[inside],
                **people,
            ),
        ]

    def actor(self) -> ActorSettings:
        """As the machine of the robots reads it."""
        connect = f'bus.connect=["tls/127.0.0.1:{self._outside}"]'
        return load(ActorSettings, "actor", file=self.file, sets=[connect], environment={})

    def client(self, token: str = "") -> httpx.Client:
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        return httpx.Client(base_url=self.url, verify=self.authority, headers=headers)


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    """Router and API at work."""
    assert shutil.which("openssl"), "this test makes its certificates with openssl"
    lab = Lab(tmp_path_factory.mktemp("lab"))
    processes = lab.start()
    with lab.client() as client:
        eventually(lambda: _ready(client), within_s=WITHIN_S)
        yield lab
    assert [process.end() for process in reversed(processes)] == [0, 0]


def test_every_table_of_the_example_is_settings_of_a_service() -> None:
    tables = tomllib.loads(EXAMPLE.read_text())
    assert set(tables) == set(MODELS)
    loaded = {
        name: load(model, name, file=EXAMPLE, environment={}) for name, model in MODELS.items()
    }
    api, actor = loaded["api"], loaded["actor"]
    assert isinstance(api, ApiSettings)
    assert isinstance(actor, ActorSettings)
    assert api.secure
    assert not api.loopback
    assert set(api.people) == {"anna", "ben"}
    assert all(endpoint.startswith("tls/") for endpoint in actor.bus.connect)


def test_who_has_a_token_is_let_in_under_their_name_and_nobody_else(lab: Lab) -> None:
    with lab.client() as nobody, lab.client(lab.token) as anna, lab.client("x" * 32) as other:
        assert nobody.get("api/v1/robots").status_code == 401
        assert other.get("api/v1/robots").status_code == 401
        assert anna.get("api/v1/me").json() == {"person": "anna"}
        assert nobody.get("").status_code == 200  # The page, which asks for the token.


def test_it_speaks_tls_alone_and_is_trusted_by_the_labs_own_authority_alone(lab: Lab) -> None:
    with pytest.raises(httpx.TransportError):
        httpx.get(f"http://127.0.0.1:{lab.port}/")
    with pytest.raises(httpx.ConnectError, match="CERTIFICATE_VERIFY_FAILED"):
        httpx.get(lab.url)


def test_a_robot_with_a_certificate_of_the_lab_is_seen_and_obeys(lab: Lab) -> None:
    with open_bus(lab.actor().bus) as bus, lab.client(lab.token) as anna:
        robot = FakeRobot(bus)
        found = eventually(lambda: anna.get("api/v1/robots").json()["robots"], within_s=WITHIN_S)
        assert [one["robot"] for one in found] == ["robot-1"]
        answer = anna.post("api/v1/robots/robot-1/corrections", json={"kind": "pause"})
        assert answer.status_code == 201, answer.text
        assert [said.author for said in robot.heard] == ["anna"]
        robot.close()


def test_a_robot_without_a_certificate_is_not_let_in(lab: Lab, tmp_path: Path) -> None:
    certify(tmp_path, "actor-1")  # By another authority.
    names = {"certificate": "actor-1.pem", "private_key": "actor-1.key"}
    own = {name: tmp_path / file for name, file in names.items()}
    with open_bus(lab.actor().bus.model_copy(update=own)) as stranger:
        with open_bus(lab.actor().bus) as known:
            assert known.joined(WITHIN_S)
        assert not stranger.joined(OUTSIDE_S)


def test_the_command_for_a_single_certificate_makes_one_for_the_host(tmp_path: Path) -> None:
    text = (LAB / "README.md").read_text()
    (command,) = re.findall(r"```sh\n(openssl .*?)```", text, re.DOTALL)
    subprocess.run(["bash", "-ec", command], cwd=tmp_path, check=True, capture_output=True)
    look = ["openssl", "x509", "-in", f"{DESK}.pem", "-noout", "-checkhost", DESK]
    told = subprocess.run(look, cwd=tmp_path, check=True, capture_output=True, text=True)
    assert f"Hostname {DESK} does match certificate" in told.stdout
    ssl.create_default_context(ssl.Purpose.CLIENT_AUTH).load_cert_chain(
        tmp_path / f"{DESK}.pem", tmp_path / f"{DESK}.key"
    )


def _ready(client: httpx.Client) -> bool:
    try:
        return client.get("readyz").status_code == 200
    except httpx.TransportError:
        return False
