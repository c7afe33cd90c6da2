"""Settings of the oracle: what kind of person it plays."""

from typing import Annotated

from pydantic import Field, SecretStr

from shared.workcell.person import Habits

Id = Annotated[str, Field(pattern=r"^[a-z0-9-]{1,64}$")]


class OracleSettings(Habits):
    """A person of given attention and skill.

    url: the correction API. token: what it asks for, where it does.
    author: the name under which the oracle speaks. robots: whom it watches; none named: all.
    delay_s: in real time, from seeing a mistake to speaking, if it is one still.
    delay_steps: in supervised lockstep, from the decision to the effect of what is said.
    hold_steps: control steps that an override holds; None: until it is released.
    approve: say so when a command is right; None: only where the robot waits for it.
    only_when_asked: watch only robots that ask for help, and those whom somebody's word holds.
    miss_rate, wrong_phrase_rate, seed: see `Habits`.
    wait_s: how long to wait for a decision before asking again. report_s: between two log lines.
    """

    url: Annotated[str, Field(pattern=r"^https?://")] = "http://127.0.0.1:8000"
    token: SecretStr | None = None
    author: Id = "oracle"
    robots: tuple[Id, ...] = ()
    delay_s: Annotated[float, Field(ge=0, le=60)] = 0.6
    delay_steps: Annotated[int, Field(ge=0, le=10_000)] = 0
    hold_steps: Annotated[int, Field(ge=1, le=100_000)] | None = None
    approve: bool | None = None
    only_when_asked: bool = False
    wait_s: Annotated[float, Field(gt=0, le=60)] = 5.0
    report_s: Annotated[float, Field(gt=0)] = 30.0
    log_level: str = "info"
