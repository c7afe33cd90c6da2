"""Settings of the correction API."""

import ipaddress
from pathlib import Path
from typing import Annotated, Self

from pydantic import AfterValidator, Field, SecretStr, model_validator

from services.correction_api.people import check_kept, same_token
from shared.config import Settings
from shared.messages.message import MAX_TEXT, Id
from shared.wire.bus import BusSettings

MAX_PEOPLE = 256
PREFIX = r"^(/[A-Za-z0-9._~-]+)*$"
Token = Annotated[SecretStr, AfterValidator(check_kept)]


class WatchSettings(Settings):
    """When a robot that says nothing counts as stale, and then as offline.

    settle_s: after a start, an unknown robot may only not have spoken yet.
    """

    stale_s: Annotated[float, Field(gt=0)] = 2.0
    offline_s: Annotated[float, Field(gt=0)] = 6.0
    settle_s: Annotated[float, Field(ge=0)] = 2.0


class DeliverySettings(Settings):
    """How a correction gets to its robot.

    ask_s: how long one attempt waits for the receipt; retry_s, retry_max_s: the pause between
        two attempts, which doubles. expire_s: after this nobody obeys it any more.
    answer_s: how long a client waits for the receipt before the answer is "pending".
    asking: attempts that may be under way at once, over all robots.
    """

    ask_s: Annotated[float, Field(gt=0, le=60)] = 2.0
    retry_s: Annotated[float, Field(gt=0)] = 0.1
    retry_max_s: Annotated[float, Field(gt=0)] = 2.0
    expire_s: Annotated[float, Field(gt=0)] = 120.0
    answer_s: Annotated[float, Field(ge=0, le=30)] = 2.0
    asking: Annotated[int, Field(ge=1, le=256)] = 32


class HelpSettings(Settings):
    """How much of people's attention all robots together may ask for.

    per_hour: calls for help that are shown within any hour since this service started; what is
        beyond is counted, and its robots carry on as they do when nobody comes. 0: no limit.
    """

    per_hour: Annotated[int, Field(ge=0, le=100_000)] = 0


class SpeechSettings(Settings):
    """How speech is recognised, where an engine for it is installed.

    max_s: length of the longest utterance. waiting: utterances that may wait at once, the one that
        is being recognised among them. hear_s: after this the recogniser counts as fallen.
    """

    enabled: bool = True
    max_s: Annotated[float, Field(gt=0, le=60)] = 15.0
    waiting: Annotated[int, Field(ge=1, le=64)] = 4
    hear_s: Annotated[float, Field(gt=0, le=300)] = 30.0


class ApiSettings(Settings):
    """One correction API.

    id: its name on the bus. host, port: where it listens; port 0 takes a free one.
    prefix: path below which a reverse proxy offers it, such as "/robots".
    hosts: further host names under which a browser may reach it (a proxy's, for example).
    token: what a client must send as `Authorization: Bearer …`, or "sha256:" and its hash.
    people: the same for each person by name, who then speaks under no other; `hld token NAME`
        makes one. Take a line out, and whoever had that token is out at the next start.
    tls_certificate, tls_key: PEM files. Beyond this machine both tokens and TLS are needed.
    text_characters: length of the longest command.
    archive_s: how long the learner may take to answer what it keeps.
    reports: folder with reports of `hld experiment`, as NAME/report.json, for the page of figures.
    evaluations: folder with reports of `hld evaluate` by version, as `hld up` writes them.
    """

    id: Id = "api"
    host: str = "127.0.0.1"
    port: Annotated[int, Field(ge=0, le=65_535)] = 8000
    prefix: Annotated[str, Field(pattern=PREFIX)] = ""
    hosts: tuple[str, ...] = ()
    token: Token | None = None
    people: Annotated[dict[Id, Token], Field(max_length=MAX_PEOPLE)] = {}
    tls_certificate: Path | None = None
    tls_key: Path | None = None
    database: Path = Path("runs/correction_api.sqlite")
    text_characters: Annotated[int, Field(ge=1, le=MAX_TEXT)] = MAX_TEXT
    archive_s: Annotated[float, Field(gt=0, le=30)] = 3.0
    reports: Path | None = None
    evaluations: Path | None = None
    watch: WatchSettings = WatchSettings()
    delivery: DeliverySettings = DeliverySettings()
    help: HelpSettings = HelpSettings()
    speech: SpeechSettings = SpeechSettings()
    bus: BusSettings = BusSettings()
    log_level: str = "info"

    @property
    def secure(self) -> bool:
        """It speaks TLS."""
        return self.tls_certificate is not None

    @property
    def loopback(self) -> bool:
        """Only this machine can reach it."""
        return is_loopback(self.host)

    @model_validator(mode="after")
    def _check_exposure(self) -> Self:
        if (self.tls_certificate is None) != (self.tls_key is None):
            raise ValueError("tls_certificate and tls_key belong together: give both or none")
        if not self.loopback and not ((self.token or self.people) and self.secure):
            raise ValueError(
                f"host {self.host} can be reached from other machines: set token or people, "
                "tls_certificate and tls_key as well, or listen on 127.0.0.1"
            )
        return self

    @model_validator(mode="after")
    def _check_tokens(self) -> Self:
        if same_token([*self.people.values(), *([self.token] if self.token else [])]):
            raise ValueError("people: two have the same token; make one each by `hld token NAME`")
        return self


def is_loopback(host: str) -> bool:
    """Whether `host` is this machine and nothing else."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
