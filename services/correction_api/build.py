"""The composition root of the correction API: the only file here that names concrete classes."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager

from services.correction_api.accept import Desk
from services.correction_api.archive import Archive
from services.correction_api.bell import Bell
from services.correction_api.calls import Calls
from services.correction_api.cameras import Cameras
from services.correction_api.config import ApiSettings
from services.correction_api.deliver import Messenger
from services.correction_api.inquire import Inquirer
from services.correction_api.lexicon import Lexicon
from services.correction_api.listen import Listener
from services.correction_api.live import Live
from services.correction_api.metrics import Metrics
from services.correction_api.news import News
from services.correction_api.parts import Authors, Parts
from services.correction_api.reports import Reports
from services.correction_api.speech.ear import Ear
from services.correction_api.store.log import Entry
from services.correction_api.store.store import Store, open_store
from services.correction_api.watch import Watch
from shared.clock import Clock, SystemClock
from shared.wire.bus import Bus, open_bus
from shared.wire.delivery import Courier
from shared.wire.keys import service_key

SERVICE = "correction-api"


@asynccontextmanager
async def opened(
    settings: ApiSettings, bus: Bus | None = None, clock: Clock | None = None
) -> AsyncIterator[Parts]:
    """The parts, joined and at work until the context ends.

    bus, clock: others than the real ones, for tests; whoever gives a bus closes it.
    """
    clock = clock or SystemClock()
    async with AsyncExitStack() as closing:
        if bus is None:
            bus = closing.enter_context(open_bus(settings.bus))
        fleet = settings.bus.fleet
        store = closing.enter_context(
            open_store(
                settings.database,
                lambda message: service_key(fleet, SERVICE, settings.id, message),
            )
        )
        parts = _make(settings, bus, clock, store)
        _set_to_work(parts, clock, closing)
        yield parts
        parts.bell.silence()


def _make(settings: ApiSettings, bus: Bus, clock: Clock, store: Store) -> Parts:
    metrics = Metrics()
    watch = Watch(clock, settings.watch.stale_s, settings.watch.offline_s)
    lexicon = Lexicon(bus, settings.bus.fleet, watch)
    desk = Desk(
        watch,
        store.log,
        store.episodes,
        clock,
        metrics,
        answer_s=settings.delivery.answer_s,
        settle_s=settings.watch.settle_s,
        understood=lexicon.understood,
    )
    return Parts(
        settings=settings,
        bus=bus,
        metrics=metrics,
        watch=watch,
        calls=Calls(clock, settings.help.per_hour, metrics),
        log=store.log,
        parcels=store.parcels,
        episodes=store.episodes,
        lessons=store.lessons,
        rulings=store.rulings,
        archive=Archive(bus, settings.bus.fleet, settings.archive_s),
        reports=Reports(settings.reports, settings.evaluations),
        desk=desk,
        lexicon=lexicon,
        live=Live(),
        bell=Bell(asyncio.get_running_loop()),
        ear=Ear(settings.speech),
        authors=Authors(),
    )


def _set_to_work(parts: Parts, clock: Clock, closing: AsyncExitStack) -> None:
    """Start what works by itself: deliveries first, then whatever brings something in."""
    bus, fleet, settings = parts.bus, parts.settings.bus.fleet, parts.settings
    news = News(parts)
    courier = Courier(bus, parts.parcels, clock)
    closing.push_async_callback(asyncio.to_thread, courier.close)
    parts.rulings.on_post(courier.wake)

    def spoken(entry: Entry) -> None:
        courier.wake()
        if entry.receipt and not entry.later:  # What was ended just now answered long ago.
            parts.calls.answer(entry.correction, entry.receipt)
        news.spoken(entry)

    messenger = Messenger(bus, fleet, parts.log, clock, settings.delivery, parts.desk.close)
    closing.push_async_callback(messenger.close)
    parts.desk.start(messenger, spoken)
    closing.push_async_callback(parts.ear.close)
    cameras = Cameras(bus, fleet, parts.live.show, parts.metrics)
    closing.callback(cameras.close)
    parts.live.on_look(cameras.want)
    parts.watch.on_change(news.changed)
    parts.calls.on_change(news.called)
    listener = Listener(bus, fleet, parts.watch, parts.calls, parts.episodes, parts.metrics)
    closing.callback(listener.close)
    minding = asyncio.get_running_loop().create_task(news.mind())
    closing.callback(minding.cancel)
    learning = asyncio.get_running_loop().create_task(parts.lexicon.learn())
    closing.callback(learning.cancel)
    inquirer = Inquirer(bus, fleet, parts.watch, parts.lessons, news.learned)
    inquiring = asyncio.get_running_loop().create_task(inquirer.work())
    closing.callback(inquiring.cancel)
    bus.alive(service_key(fleet, SERVICE, settings.id, "alive"))
    _gauge(parts, messenger)


def _gauge(parts: Parts, messenger: Messenger) -> None:
    gauge = parts.metrics.gauge
    gauge("robots", "Robots that were ever heard of", lambda: len(parts.watch.names()))
    gauge("help_open", "Robots that ask for help", lambda: len(parts.calls.queue()))
    gauge("live_clients", "Open pages", lambda: len(parts.live))
    gauge("live_waiting", "What waits for slow pages", parts.live.waiting)
    gauge("corrections_pending", "Corrections without a receipt", lambda: len(messenger))
    gauge("outbox_parcels", "What the learner does not have yet", lambda: len(parts.parcels))
