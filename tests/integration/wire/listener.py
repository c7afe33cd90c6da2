"""A process that can be killed or stopped: says `up` when it is alive on the bus, then listens.

`python -m tests.integration.wire.listener PORT KEYS`.
"""

import sys
import threading

from shared.wire.bus import BusSettings, open_bus

ALIVE = "hld/v1/lab/listener/l-1/alive"


def main() -> None:
    port, keys = sys.argv[1:]
    with open_bus(BusSettings(connect=(f"tcp/127.0.0.1:{port}",))) as bus:
        bus.subscribe(keys, lambda _key, _data: None)
        bus.alive(ALIVE)
        threading.Event().wait()


if __name__ == "__main__":
    main()
