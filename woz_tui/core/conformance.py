"""Does a driver keep the contract? For its author's own tests; no hardware is moved.

    findings = await check(MyDriver, MyDriver.Settings(port="/dev/null"))
    assert not [finding for finding in findings if finding.level == "error"]

What it looks at holds for every driver, whether its hardware is there or not: verbs that the
experiment file can address, an `open` that does not wait, refusals of the right kind, a stop that
returns, a `close` that leaves no task and no thread behind.
"""

from __future__ import annotations

import asyncio
import dataclasses
import re
import threading
import time
from collections.abc import Awaitable, Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from woz_tui.core.clock import Clock, RealClock
from woz_tui.core.driver import (
    KINDS,
    UNKNOWN,
    Argument,
    Ask,
    Driver,
    DriverError,
    Finding,
    Health,
    Probe,
    Rejected,
    Scope,
    Verb,
    Written,
)
from woz_tui.core.feeds import Feed, Feeds
from woz_tui.core.messages import Json, Shown, Speech

#: Main argument of the verbs whose names everybody shares.
COMMON_VERBS: Mapping[str, str] = {
    "say": "text",
    "play": "move",
    "pose": "joints",
    "poses": "poses",
    "home": "seconds",
    "gaze": "yaw",
    "nudge": "yaw",
    "torque": "on",
    "emotion": "emotion",
    "eyes": "color",
    "screen": "file",
    "sound": "file",
    "drive": "x",
    "mode": "mode",
    "volume": "level",
    "learn_face": "name",
    "listen_room": "seconds",
}

#: Words that mean something else in every action: its own fields, and the session's verbs.
RESERVED = (
    *("key", "label", "name", "help", "locked", "when_busy", "on", "steps"),
    *("wait", "mark", "note", "set", "lock", "unlock"),
)
#: Verbs of the engagement model: in an experiment that has it a driver's could not be called.
MODEL_VERBS = (
    *("toggle", "sense", "force", "engagement", "filter", "social_distance"),
    *("attend", "handshake", "visitor"),
)

_NAME = re.compile(r"[a-z][a-z0-9_-]*")
_LEVELS = ("ok", "info", "warning", "error")

#: `open`, `stop` and a refusal may take this long, in seconds: the stop waits no longer.
PROMPT = 0.5


class Silence:
    """An outlet that keeps only what the check asks about."""

    def __init__(self, folder: Path, clock: Clock) -> None:
        self._folder = folder
        self._clock = clock
        self.sensors: set[str] = set()
        self.healths: list[Health] = []
        self._feeds = Feeds()

    @property
    def clock(self) -> Clock:
        """The session's clock."""
        return self._clock

    @property
    def folder(self) -> Path:
        """Where relative paths start."""
        return self._folder

    @property
    def media(self) -> Path:
        """Nobody speaks, so nobody writes anything here."""
        return self._folder / "conformance.media"

    def t(self, clock_us: int) -> int:
        """The session began with the clock."""
        return clock_us

    def reading(
        self,
        sensor: str,
        value: float | None,
        *,
        text: str = "",
        unit: str = "",
        raw: float | None = None,
    ) -> None:
        """Keep the sensor's name."""
        self.sensors.add(sensor)

    def sensor(self, sensor: str, state: str, why: str = "") -> None:
        """Keep the sensor's name."""
        self.sensors.add(sensor)

    def health(self, health: Health, detail: str = "", remedy: str = "") -> None:
        """Keep it."""
        self.healths.append(health)

    def mode(self, mode: str, why: str = "") -> None:
        """Nothing is asked about modes."""

    def notice(self, level: str, text: str, remedy: str = "") -> None:
        """Nothing is asked about these."""

    def show(self, shown: Shown) -> None:
        """Nothing is asked about these."""

    def tell(self, speech: Speech) -> None:
        """Nothing is asked about these."""

    def feed(self, topic: str, of: str = "") -> Feed:
        """Nobody else is there."""
        return self._feeds.feed(of, topic)

    def ask(self, ask: Ask, done: Callable[[bool, str], None] | None = None) -> None:
        """Nobody answers."""


@dataclasses.dataclass(frozen=True, slots=True)
class Trial:
    """A command that no driver knows."""

    command: str = "conformance"
    verb: str = "no-such-verb"
    args: Mapping[str, Json] = dataclasses.field(default_factory=dict)
    source: str = "program"

    def expects(self, seconds: float) -> None:
        """Nobody counts down."""


async def check(
    driver_class: type[Driver],
    settings: Any,
    *,
    name: str = "driver",
    folder: Path = Path(),
    clock: Clock | None = None,
) -> list[Finding]:
    """Everything wrong with a driver class and these settings; an `ok` finding if nothing is.

    `name` is the driver's in the robot file, `folder` that of the experiment file. Takes about a
    second; opens and closes the driver, and never asks it to move.
    """
    findings = [*_declared(driver_class, settings), *_remarked(driver_class, settings, folder)]
    if not findings:
        findings += await _examined(driver_class, Probe(name, settings, folder))
        findings += await _lived(
            driver_class, settings, name, Silence(folder, clock or RealClock())
        )
    return findings or [Finding("ok", driver_class.__name__, "keeps the driver contract")]


def _error(subject: str, text: str, remedy: str = "") -> Finding:
    return Finding("error", subject, text, remedy)


# -- what it declares -----------------------------------------------------------------------------


def _declared(driver_class: type[Driver], settings: Any) -> Iterable[Finding]:
    kind = driver_class.Settings
    if not (dataclasses.is_dataclass(kind) and kind.__dataclass_params__.frozen):  # type: ignore[attr-defined]
        yield _error("Settings", "must be a frozen dataclass", "@dataclass(frozen=True)")
    if not driver_class.summary or "\n" in driver_class.summary:
        yield _error("summary", "must be one line that says what the driver is")
    verbs = driver_class.verbs(settings)
    if verbs != driver_class.verbs(settings):
        yield _error("verbs", "two calls with the same settings differ")
    yield from _repeated("verbs", [verb.name for verb in verbs])
    for verb in verbs:
        yield from _verb(verb)
    sensors = driver_class.sensors(settings)
    yield from _repeated("sensors", sensors)


def _repeated(subject: str, names: Iterable[str]) -> Iterable[Finding]:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            yield _error(subject, f"{name!r} is there twice")
        seen.add(name)


def _verb(verb: Verb) -> Iterable[Finding]:
    subject = f"verb {verb.name}"
    if not _NAME.fullmatch(verb.name):
        yield _error(subject, "a name is made of a-z, 0-9, - and _")
    if verb.name in RESERVED:
        yield _error(subject, "means something else in every action", "choose another name")
    if verb.name in MODEL_VERBS:
        yield _error(subject, "is a verb of the engagement model", "choose another name")
    if not verb.summary:
        yield _error(subject, "needs a summary")
    if not verb.lane:
        yield _error(subject, "needs a lane")
    if not verb.limit_s > 0:
        yield _error(subject, f"limit_s must be more than 0, not {verb.limit_s}")
    main = verb.arguments[0].name if verb.arguments else ""
    if verb.name in COMMON_VERBS and main != COMMON_VERBS[verb.name]:
        yield _error(
            subject,
            f"its main argument is {main!r}",
            f"everybody's is {COMMON_VERBS[verb.name]!r}, and it comes first",
        )
    yield from _repeated(subject, [argument.name for argument in verb.arguments])
    for argument in verb.arguments:
        yield from _argument(f"{subject}: {argument.name}", argument)


def _argument(subject: str, argument: Argument) -> Iterable[Finding]:
    if argument.kind not in KINDS:
        yield _error(subject, f"unknown kind {argument.kind!r}", f"one of {', '.join(KINDS)}")
    if argument.kind == "choice" and not argument.choices:
        yield _error(subject, "a choice needs choices")
    yield from _hiding(subject, argument)
    default = argument.default
    if default is None:
        return
    if argument.required:
        yield _error(subject, "is required, so its default never counts")
    if argument.choices and default not in argument.choices:
        yield _error(subject, f"its default {default!r} is not one of its choices")
    number = isinstance(default, int | float) and not isinstance(default, bool)
    if argument.range and not (number and argument.range.contains(float(default))):  # type: ignore[arg-type]
        yield _error(subject, f"its default {default!r} is not within {argument.range}")


def _hiding(subject: str, argument: Argument) -> Iterable[Finding]:
    hide = argument.hide
    if hide is None:
        return
    for text in ("", "plain", "tcps://user:password@host"):
        try:
            once = hide(text)
            again = hide(once)
        except Exception as error:  # noqa: BLE001 - a stranger's code may raise anything
            yield _error(subject, f"hide raised {error!r}", "hide what cannot be judged")
            return
        if again != once:
            yield _error(subject, f"hide({text!r}) is {once!r}, then {again!r}", "twice is as once")


# -- what it says of commands that are only written -----------------------------------------------

#: Texts of a command that is looked at: none, one that only the session knows, and nonsense.
_TEXTS = ("", UNKNOWN, "no/such thing")


def _remarked(driver_class: type[Driver], settings: Any, folder: Path) -> Iterable[Finding]:
    """`remarks`: about any command, without raising."""
    names = [*(driver_class.joints(settings) or ())]
    joints: dict[str, Json] = dict.fromkeys(names[:1] or ["joint"], 0.0)
    for verb in driver_class.verbs(settings):
        for text in _TEXTS:
            args = {one.name: _sample(one, text, joints) for one in verb.arguments}
            try:
                found = [*driver_class.remarks(settings, Written(verb.name, args, folder))]
            except Exception as error:  # noqa: BLE001 - a stranger's code may raise anything
                yield _error("remarks", f"raised {error!r} about {verb.name}", "yield a Finding")
                return
            for finding in found:
                if finding.level not in _LEVELS:
                    yield _error("remarks", f"unknown level {finding.level!r}", ", ".join(_LEVELS))
                if finding.subject not in args:
                    what = f"{verb.name} has no argument {finding.subject!r}"
                    yield _error("remarks", what, "a finding's subject is an argument")


def _sample(argument: Argument, text: str, joints: dict[str, Json]) -> Json:
    """A value that the argument may have."""
    if argument.choices:
        return argument.choices[0]
    match argument.kind:
        case "text" | "file" | "choice":
            return text
        case "flag":
            return True
        case "joints":
            return joints
        case "poses":
            return [{"joints": joints, "seconds": 1.0}]
    low = argument.range.low if argument.range is not None else None
    return 0 if low is None else low


# -- what it does ---------------------------------------------------------------------------------


async def _examined(driver_class: type[Driver], probe: Probe) -> list[Finding]:
    try:
        found = await asyncio.wait_for(driver_class.examine(probe), 10.0)
    except Exception as error:  # noqa: BLE001 - a stranger's code may raise anything
        return [_error("examine", f"raised {error!r}", "turn it into a Finding")]
    wrong = [finding.level for finding in found if finding.level not in _LEVELS]
    return [_error("examine", f"unknown level {level!r}", ", ".join(_LEVELS)) for level in wrong]


async def _lived(
    driver_class: type[Driver], settings: Any, name: str, outlet: Silence
) -> list[Finding]:
    tasks, threads = asyncio.all_tasks(), set(threading.enumerate())
    findings: list[Finding] = []
    driver = driver_class(name, settings, outlet)
    findings += await _quiet("open", driver.open())
    await asyncio.sleep(0)
    if not outlet.healths:
        findings.append(
            _error("open", "said nothing about its health", "outlet.health(Health.CONNECTING)")
        )
    findings += await _refuses("perform of an unknown verb", driver, Rejected)
    for scope in Scope:
        findings += await _quiet(f"stop({scope.name}) with nothing running", driver.stop(scope))
    undeclared = sorted(outlet.sensors - set(driver_class.sensors(settings)))
    if undeclared:
        findings.append(_error("sensors", f"publishes {', '.join(undeclared)} undeclared"))
    findings += await _quiet("close", driver.close(), limit=5.0)
    findings += await _quiet("close for the second time", driver.close())
    findings += await _refuses("perform after close", driver, DriverError)
    findings += await _left_behind(tasks, threads)
    return findings


async def _quiet(what: str, call: Awaitable[object], limit: float = PROMPT) -> list[Finding]:
    try:
        await asyncio.wait_for(call, limit)
    except TimeoutError:
        return [_error(what, f"took more than {limit:g} s")]
    except Exception as error:  # noqa: BLE001 - a stranger's code may raise anything
        return [_error(what, f"raised {error!r}")]
    return []


async def _refuses(what: str, driver: Driver, kind: type[DriverError]) -> list[Finding]:
    try:
        await asyncio.wait_for(driver.perform(Trial()), PROMPT)
    except kind:
        return []
    except TimeoutError:
        return [_error(what, f"took more than {PROMPT:g} s", f"raise {kind.__name__} at once")]
    except Exception as error:  # noqa: BLE001 - a stranger's code may raise anything
        return [_error(what, f"raised {error!r}", f"raise {kind.__name__}")]
    return [_error(what, "raised nothing", f"raise {kind.__name__}")]


async def _left_behind(
    tasks: set[asyncio.Task[Any]], threads: set[threading.Thread]
) -> list[Finding]:
    """Tasks and threads that outlive the driver; they get as long as a stop to end."""
    patience = time.monotonic() + PROMPT
    while True:
        left = [task.get_name() for task in asyncio.all_tasks() - tasks]
        left += [thread.name for thread in set(threading.enumerate()) - threads]
        left = [one for one in left if not one.startswith("asyncio_")]
        if not left or time.monotonic() > patience:
            return [_error("close", f"left {one!r} running") for one in sorted(left)]
        await asyncio.sleep(0.01)
