"""The recogniser: a process of its own, so that neither the event loop nor a correction ever waits
for it, and so that its libraries can fall without taking the service along.

Reads on stdin, for each utterance, a line of JSON and then the sound itself:
`{"commands": ["wait", …], "bytes": 48000}`; answers each with a `Recognition` in one line. Its
first line says which engines it has: `{"engines": […], "failed": {engine: reason}}`.
"""

import json
import sys

import numpy as np

from services.correction_api.speech.engines import KINDS, Engine
from services.correction_api.speech.hear import hear


def main() -> None:
    engines, failed = load()
    reply(json.dumps({"engines": list(engines), "failed": failed}))
    while line := sys.stdin.buffer.readline():
        asked = json.loads(line)
        sound = np.frombuffer(sys.stdin.buffer.read(asked["bytes"]), "<i2").astype(np.int16)
        reply(hear([*engines.values()], sound, tuple(asked["commands"])).model_dump_json())


def load() -> tuple[dict[str, Engine], dict[str, str]]:
    """The engines that are installed, and why those that are broken can't be used."""
    engines, failed = dict[str, Engine](), dict[str, str]()
    for name, kind in KINDS.items():
        if kind.installed:
            try:
                engines[name] = kind.make()
            except Exception as error:  # Whatever a library raises; the other may still work.
                failed[name] = f"{type(error).__name__}: {error}"
    return engines, failed


def reply(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
