"""How training varies what the high level sees, so that it learns neither pictures nor itself."""

from typing import Annotated

from pydantic import Field

from shared.config import Settings

Share = Annotated[float, Field(ge=0, le=1)]


class Variation(Settings):
    """How decisions are varied each time that they are shown.

    history_dropout: share of decisions that are shown without previous commands; of the others
        each command is left out half as often. look_dropout: the same for earlier looks.
    shift_px, brightness, tint, noise: how pictures are varied; noise in levels of 0..255.
    sense_noise: on each number of the proprioception, in rad or m.
    """

    history_dropout: Share = 0.5
    look_dropout: Share = 0.2
    shift_px: Annotated[int, Field(ge=0, le=16)] = 3
    brightness: Share = 0.12
    tint: Share = 0.05
    noise: Annotated[float, Field(ge=0, le=64)] = 3.0
    sense_noise: Annotated[float, Field(ge=0, le=1)] = 0.005
