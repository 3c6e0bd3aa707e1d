"""Does a driver keep the contract of `drivers.contract`?

What holds for every driver: verbs that an experiment file can name, an `open` that does not wait,
refusals of the right kind, a stop in time, a `close` that leaves no task and no thread behind and
after which nothing is published; nothing that holds up the event loop, no error that nobody waits
for, no reading undeclared, no lost device without a remedy. With a `Device`: a command that ends
when it is cancelled, a stop that is over when it returns, a lost device that is noticed and found
again, errors and units of the device. Every finding is an error.
"""

from __future__ import annotations

import asyncio
import contextlib
import dataclasses
import math
import os
import re
import threading
import time
from collections.abc import Awaitable, Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from woz_tui.config.feature_section import FeatureSection
from woz_tui.drivers.contract import (
    FACE_CONSENT,
    KINDS,
    SPEECH,
    UNKNOWN,
    Argument,
    DeviceLostError,
    Driver,
    DriverError,
    Finding,
    Health,
    Probe,
    RejectedError,
    Scope,
    Verb,
    Written,
)
from woz_tui.drivers.fields import Section
from woz_tui.drivers.robot_verbs import COMMON_VERBS, main_argument
from woz_tui.feature import pieces
from woz_tui.protocol.action_messages import EVIDENCE
from woz_tui.protocol.messages import Json
from woz_tui.system.processor_time import STALL_S
from woz_tui.testing.device import Device, Devices, answer
from woz_tui.testing.life_watch import LifeWatch
from woz_tui.testing.recording_context import PlainJob, RecordingContext, until

#: Words that mean something else in every action: its own fields, and the session's verbs.
RESERVED = (
    *("key", "label", "name", "help", "locked", "when_busy", "on", "until", "steps", "then"),
    *("wait", "mark", "note", "set", "lock", "unlock"),
)
#: Verbs of the engagement model: in an experiment that has it a driver's could not be called.
MODEL_VERBS = (
    *("toggle", "sense", "force", "engagement", "filter", "social_distance"),
    *("attend", "handshake", "visitor"),
)

#: `examine` and `close` may take so long, in seconds.
EXAMINE_S, CLOSE_S = 10.0, 5.0
#: So long a lost or found device may take to be noticed, in seconds.
NOTICE_S = 15.0
#: So long nothing may be published after `close`, in seconds: more than twice a tick of 10 Hz.
QUIET_S = 0.25


def reserved_words() -> tuple[str, ...]:
    """The same, with the verbs of features."""
    sections = pieces("section", FeatureSection).values()
    return (*RESERVED, *(verb.name for each in sections for verb in each.verbs))


_NAME = re.compile(r"[a-z][a-z0-9_-]*")
_LEVELS = ("ok", "info", "warning", "error")
#: How often the device is asked, in seconds.
_LOOK_S = 0.01
_UNKNOWN_VERB = PlainJob("no-such-verb", source="program")

_PATIENCE = float(os.environ.get("WOZ_CONTRACT_PATIENCE") or 1)
#: `open`, `stop`, a refusal and the end of a cancelled command may take so long, in seconds: the
#: session waits no longer for a stop. A slow machine may have more patience.
PROMPT_S = 0.5 * _PATIENCE
#: So long a driver may hold up the event loop that all drivers share, in seconds.
LAG_S = STALL_S * _PATIENCE
#: So long nothing may move by itself after a stop and after a device is back, in seconds.
REST_S = 1.0
#: A number that reached the device, or came from it, may be off by such a share: no two units are
#: so near to each other.
OFF = 0.1


async def check(driver_class: type[Driver], settings: Any, folder: Path = Path()) -> list[Finding]:
    """Everything wrong with a driver class and these settings, without hardware; empty if nothing.

    `folder` is the experiment file's. Takes about a second, and never asks the driver to move.
    """
    findings = await declared(driver_class, settings, folder)
    return findings or await closes(driver_class, settings, folder)


def _error(subject: str, text: str, remedy: str = "") -> Finding:
    return Finding("error", subject, text, remedy)


# -- what it declares -----------------------------------------------------------------------------


async def declared(
    driver_class: type[Driver], settings: Any, folder: Path = Path()
) -> list[Finding]:
    """What is wrong with what the class says of itself: verbs, sensors, remarks, findings."""
    findings = [*_offered(driver_class, settings), *_remarked(driver_class, settings, folder)]
    if findings:
        return findings
    try:
        found = await asyncio.wait_for(
            driver_class.examine(Probe("driver", settings, folder)), EXAMINE_S
        )
    except Exception as error:  # noqa: BLE001 - a stranger's code may raise anything
        return [_error("examine", f"raised {error!r}", "turn it into a Finding")]
    return [
        _error("examine", f"unknown level {each.level!r}", ", ".join(_LEVELS))
        for each in found
        if each.level not in _LEVELS
    ]


def _offered(driver_class: type[Driver], settings: Any) -> Iterable[Finding]:
    kind = driver_class.Settings
    if "problems" in vars(kind) and not issubclass(kind, Section):
        yield _error("Settings", "nobody calls its problems()", f"class {kind.__name__}(Section)")
    if not (dataclasses.is_dataclass(kind) and kind.__dataclass_params__.frozen):  # type: ignore[attr-defined]
        yield _error("Settings", "must be a frozen dataclass", "@dataclass(frozen=True)")
    if not driver_class.summary or "\n" in driver_class.summary:
        yield _error("summary", "must be one line that says what the driver is")
    offered = driver_class.offer(settings)
    if offered != driver_class.offer(settings):
        yield _error("offer", "two calls with the same settings differ")
    yield from _repeated("verbs", [verb.name for verb in offered.verbs])
    for verb in offered.verbs:
        yield from _verb(verb)
    yield from _consent(offered.verbs)
    yield from _repeated("sensors", offered.sensors)


def _consent(verbs: Iterable[Verb]) -> Iterable[Finding]:
    """What needs a consent is refused for good where nobody can give one, or to no name."""
    offered = {verb.name: verb for verb in verbs}
    consent = COMMON_VERBS[FACE_CONSENT]
    for verb in offered.values():
        if not verb.needs_consent:
            continue
        if not verb.arguments or verb.arguments[0].kind != "text":
            yield _error(f"verb {verb.name}", "its main argument must be a person's name, a text")
        if FACE_CONSENT not in offered:
            remedy = f"common_verb({FACE_CONSENT!r}); withdrawn, it deletes what is kept"
            yield _error(f"verb {verb.name}", f"needs a verb {FACE_CONSENT!r} beside it", remedy)
    if FACE_CONSENT in offered:
        taken = {(one.name, one.kind) for one in offered[FACE_CONSENT].arguments}
        if not taken >= {(one.name, one.kind) for one in consent.arguments}:
            said = "takes `name`, a text, and `given`, a flag"
            yield _error(f"verb {FACE_CONSENT}", said, f"common_verb({FACE_CONSENT!r})")


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
    if verb.name in reserved_words():
        yield _error(subject, "means something else in every action", "choose another name")
    if verb.name in MODEL_VERBS:
        yield _error(subject, "is a verb of the engagement model", "choose another name")
    if not verb.summary:
        yield _error(subject, "needs a summary")
    if not verb.lane:
        yield _error(subject, "needs a lane")
    if not verb.limit_s > 0:
        yield _error(subject, f"limit_s must be more than 0, not {verb.limit_s}")
    if verb.evidence and verb.evidence not in EVIDENCE:
        yield _error(subject, f"unknown evidence {verb.evidence!r}", ", ".join(EVIDENCE))
    main = verb.arguments[0].name if verb.arguments else ""
    if verb.name in COMMON_VERBS and main != main_argument(verb.name):
        yield _error(
            subject,
            f"its main argument is {main!r}",
            f"everybody's is {main_argument(verb.name)!r}, and it comes first",
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
    offered = driver_class.offer(settings)
    names = [*(offered.joints or ())]
    joints: dict[str, Json] = dict.fromkeys(names[:1] or ["joint"], 0.0)
    for verb in offered.verbs:
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


async def closes(driver_class: type[Driver], settings: Any, folder: Path = Path()) -> list[Finding]:
    """What is wrong with a driver's life: open, refusals, a stop with nothing running, close."""
    async with _Life(driver_class, settings, folder) as life:
        await life.lived()
    return life.findings


async def closes_with(driver_class: type[Driver], device: Devices) -> list[Finding]:
    """The same with its device there, which it finds first."""
    async with device as there:
        async with _Life(driver_class, there.settings) as life:
            await life.lived(found=True)
        return life.findings


async def stops(driver_class: type[Driver], device: Devices) -> list[Finding]:
    """What is wrong with a stop in the middle of a command, and with a command that is cancelled.

    Where the device says what stands still, it does so when the stop returns, and goes on to. Each
    time the next command must be taken again.
    """
    async with device as there:
        if (command := there.command) is None:
            return []
        driving = (verb for verb in driver_class.offer(there.settings).verbs if verb.drives)
        drives = command.verb in {verb.name for verb in driving}
        async with _Life(driver_class, there.settings) as life:
            await life.connected()
            for scope in (Scope.ALL, Scope.DRIVE) if drives else (Scope.ALL,):
                after = "" if scope is Scope.ALL else " after a stop"
                if (running := await life.begins(command, f"perform{after}")) is None:
                    return life.findings
                await life.moves(there)
                await life.stopped(running, there, scope)
                await life.driver.resume()
            if (running := await life.begins(command, "perform after a stop")) is not None:
                await life.cancelled(running, "a command that is cancelled")
                await life.comes_to_rest(there, "a command that is cancelled")
        return life.findings


async def loses(driver_class: type[Driver], device: Devices) -> list[Finding]:
    """What is wrong when the device is unplugged in the middle of a command.

    Whatever is under way ends with `DeviceLostError`, health is LOST (or FAULTED), further commands
    are refused at once with `DeviceLostError`, and an unknown verb is rejected as before.
    """
    async with device as there:
        async with _Life(driver_class, there.settings) as life:
            if await life.unplugged(there):
                await life.refuses("perform of an unknown verb without a device", RejectedError)
                if there.command is not None:
                    await life.refuses("perform without a device", DeviceLostError, there.command)
        return life.findings


async def returns(driver_class: type[Driver], device: Devices) -> list[Finding]:
    """What is wrong when the device is plugged in again after that: it is found again, and moves
    only when it is asked to.
    """
    async with device as there:
        there.needs("return")
        assert there.plug is not None
        async with _Life(driver_class, there.settings) as life:
            if not await life.unplugged(there):
                return life.findings
            moving = not await there.stands_still()
            await answer(there.plug)
            if not await life.healthy(Health.CONNECTED):
                life.wrong("a device that is back", f"is not CONNECTED after {NOTICE_S:g} s")
                return life.findings
            if moving:  # nobody could stop it meanwhile
                await life.comes_to_rest(there, "a device that is back")
            await life.rests(there, "a device that is back")
            if there.command is not None:  # it may be refused until somebody has had a look
                error = await _raised_within(life.driver.perform(there.command), QUIET_S)
                if isinstance(error, DeviceLostError):
                    life.wrong("perform on a device that is back", f"raised {error!r}")
        return life.findings


async def fails(driver_class: type[Driver], device: Devices) -> list[Finding]:
    """What is wrong when the device answers a command with an error: the command has to end."""
    async with device as there:
        there.needs("errors")
        assert there.command is not None
        assert there.fail is not None
        async with _Life(driver_class, there.settings) as life:
            await life.connected()
            await answer(there.fail)
            error = await _raised_within(life.driver.perform(there.command), NOTICE_S)
            subject, remedy = "an error of the device", "raise DriverError with what it says"
            if isinstance(error, TimeoutError):
                life.wrong(subject, f"perform goes on for {NOTICE_S:g} s", remedy)
            elif not isinstance(error, DriverError):
                life.wrong(subject, f"perform raised {_shown(error)}", remedy)
        return life.findings


async def measures(driver_class: type[Driver], device: Devices) -> list[Finding]:
    """What is wrong with the numbers that reach the device, and with those that come from it."""
    async with device as there:
        there.needs("units")
        async with _Life(driver_class, there.settings) as life:
            await life.connected()
            if there.senses is not None:
                await life.senses(there.senses)
            if there.received is not None and there.command is not None:
                running = await life.begins(there.command, "perform")
                if running is not None:
                    await life.reaches(there.received, there.expected, there.command)
                    await life.cancelled(running, "a command that is cancelled")
        return life.findings


async def claimed(driver_class: type[Driver], device: Devices) -> list[Finding]:
    """What its `facts` say was shown, and nobody could show."""
    async with device as there:
        return [
            _error("facts", f"say that {each!r} was shown", f"there are: {', '.join(there.shows)}")
            for each in driver_class.facts.shown
            if each not in there.shows
        ]


class _Life:
    """One driver from its making to its end, and what was found to be wrong."""

    def __init__(self, driver_class: type[Driver], settings: Any, folder: Path = Path()) -> None:
        self.findings: list[Finding] = []
        self._sensors = set(driver_class.offer(settings).sensors)
        self._tasks, self._threads = asyncio.all_tasks(), set(threading.enumerate())
        self._context = RecordingContext(folder)
        self._watch = LifeWatch(self.wrong, LAG_S)
        self._closed = False
        self.driver = driver_class("driver", settings, self._context)

    def wrong(self, subject: str, text: str, remedy: str = "") -> None:
        """Keep a finding."""
        self.findings.append(_error(subject, text, remedy))

    async def __aenter__(self) -> _Life:
        self._watch.begin()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()
        self._watch.end()
        self._told_rightly()

    async def close(self) -> None:
        """Close it, once."""
        if not self._closed:
            self._closed = True
            await self.quiet("close", self.driver.close(), limit=CLOSE_S)

    def _told_rightly(self) -> None:
        """Whatever it has told from its beginning to its end."""
        context = self._context
        named = {each.sensor for each in context.readings} | {each[0] for each in context.states}
        named |= {SPEECH} if context.told else set()
        if undeclared := sorted(named - self._sensors):
            self.wrong("sensors", f"publishes {', '.join(undeclared)} undeclared")
        for health, detail, remedy in context.healths:
            if health in (Health.LOST, Health.FAULTED) and not remedy:
                what = f"said without a remedy: {detail or 'nothing'}"
                self.wrong(f"Health.{health.name}", what, "say what to do about it")

    async def connected(self) -> None:
        """Open it, and wait until it has found its device."""
        await self.quiet("open", self.driver.open())
        await self.until_connected()

    async def lived(self, found: bool = False) -> None:
        """Stop and release, open, refuse before and after it has looked, stop, close twice."""
        context, driver = self._context, self.driver
        await self.quiet("stop(ALL) before open", driver.stop(Scope.ALL))
        await self.quiet("resume before open", driver.resume())
        await self.quiet("open", driver.open())
        await asyncio.sleep(0)
        if not context.healths:
            self.wrong("open", "said nothing about its health", "context.health(Health.CONNECTING)")
        await self.refuses("perform of an unknown verb", RejectedError)
        if found:
            await self.until_connected()
        else:
            # A driver may look for as long as it likes: one that says nothing is not waited for.
            await self.healthy(Health.CONNECTED, Health.LOST, Health.FAULTED, within=PROMPT_S)
        await self.refuses("perform of an unknown verb, once it has looked", RejectedError)
        for scope in Scope:
            await self.quiet(f"stop({scope.name}) with nothing running", driver.stop(scope))
        await self.close()
        published = context.published
        await self.quiet("close for the second time", driver.close())
        await self.refuses("perform after close", DriverError)
        await self._left_behind()
        await asyncio.sleep(QUIET_S)
        if context.published > published:
            self.wrong("close", "published something afterwards", "end what publishes first")

    # -- with a device ---------------------------------------------------------------------------

    async def unplugged(self, there: Device) -> bool:
        """Pull the cable in the middle of a command; False if the driver does not notice."""
        await self.connected()
        running = await self.begins(there.command, "perform") if there.command else None
        await answer(there.unplug)
        if running is not None:
            await asyncio.wait([running], timeout=NOTICE_S)
            if not running.done():
                what = f"perform goes on for {NOTICE_S:g} s"
                self.wrong("an unplugged device", what, "raise DeviceLostError")
                running.cancel()
            elif not isinstance(error := _raised(running), DeviceLostError):
                what = f"perform raised {_shown(error)}, not DeviceLostError"
                self.wrong("an unplugged device", what)
        if await self.healthy(Health.LOST, Health.FAULTED):
            return True
        self.wrong("an unplugged device", f"health is not LOST after {NOTICE_S:g} s")
        return False

    async def moves(self, there: Device) -> None:
        """Wait until the device says that it moves: one that never does cannot show a stop."""

        async def moves() -> bool:
            return not await there.stands_still()

        if there.still is not None and not await _becomes(moves):
            what = f"says for {NOTICE_S:g} s of a command that everything stands still"
            self.wrong("Device.still", what, "give the Device a command that moves what it sees")

    async def stopped(self, running: asyncio.Task[Any], there: Device, scope: Scope) -> None:
        """Stop a command: the device stands still when the stop returns, and from then on."""
        what = f"stop({scope.name}) in the middle of a command"

        async def stop() -> None:
            await self.quiet(what, self.driver.stop(scope))
            if not await there.stands_still():
                remedy = "return when the device has said that it stands still"
                self.wrong(what, "returned while the device still moves", remedy)

        # As the bus does it: the stop is called at once, then all jobs are cancelled.
        stopping = asyncio.ensure_future(stop())
        await asyncio.sleep(0)
        await self.cancelled(running, "a command that is stopped")
        await stopping
        await self.rests(there, what)

    async def comes_to_rest(self, there: Device, what: str) -> None:
        """The device stands still within NOTICE_S."""
        if not await _becomes(there.stands_still):
            self.wrong(what, f"the device still moves {NOTICE_S:g} s later", "have it stand still")

    async def rests(self, there: Device, what: str) -> None:
        """The device does not begin to move by itself for REST_S."""
        if there.still is None:
            return
        end = time.monotonic() + REST_S
        while time.monotonic() < end:
            await asyncio.sleep(_LOOK_S)
            if not await there.stands_still():
                remedy = "move only when you are asked to"
                self.wrong(what, "afterwards the device moves by itself", remedy)
                return

    async def senses(self, sense: Callable[[], Any]) -> None:
        """What the device senses comes as readings."""
        wanted: Mapping[str, float] = {}
        come: dict[str, float | None] = {}

        async def came() -> bool:
            nonlocal wanted
            wanted = await answer(sense)
            come.update((each.sensor, each.value) for each in self._context.readings)
            return not _far(come, wanted)

        if not await _becomes(came):
            for name in _far(come, wanted):
                text = f"is {come.get(name)!r} where the device senses {wanted[name]:g}"
                self.wrong(f"sensor {name}", text, "distances are in m, angles in degrees")

    async def reaches(
        self,
        received: Callable[[], Any],
        expected: Mapping[str, float] | None,
        command: PlainJob,
    ) -> None:
        """The numbers of a command arrive at the device as they were meant."""
        wanted = expected if expected is not None else _numbers(command.args)
        got: Mapping[str, float] = {}

        async def reached() -> bool:
            nonlocal got
            got = await answer(received)
            return not _far(got, wanted)

        if not wanted:
            what = f"{command.verb} has no number to compare with"
            self.wrong("Device.received", what, "give Device(expected=...)")
        elif not await _becomes(reached):
            for name in _far(got, wanted):
                text = f"{name}: {wanted[name]:g} reached the device as {got.get(name)!r}"
                self.wrong(
                    f"perform of {command.verb}", text, "lengths are in m, angles in degrees"
                )

    async def healthy(self, *wanted: Health, within: float | None = None) -> bool:
        """Whether the driver's health is one of these within so many seconds, or NOTICE_S."""
        healths = self._context.healths
        within = NOTICE_S if within is None else within
        with contextlib.suppress(TimeoutError):
            await until(lambda: bool(healths) and healths[-1][0] in wanted, within)
            return True
        return False

    async def until_connected(self) -> None:
        """Wait until it has found its device."""
        if not await self.healthy(Health.CONNECTED):
            self.wrong("open", f"is not CONNECTED to its device after {NOTICE_S:g} s")

    async def begins(self, command: PlainJob, what: str) -> asyncio.Task[Mapping[str, Json]] | None:
        """A command that is under way; None if it ended at once."""
        self._watch.doing(what)
        running = asyncio.ensure_future(self.driver.perform(command))
        await asyncio.wait([running], timeout=QUIET_S)
        if not running.done():
            return running
        how = f"ended at once and raised {_shown(_raised(running))}"
        self.wrong(what, how, "give the Device a command that lasts")
        return None

    async def cancelled(self, running: asyncio.Task[Any], what: str) -> None:
        """Cancel it and see that it ends."""
        self._watch.doing(what)
        running.cancel()
        await asyncio.wait([running], timeout=PROMPT_S)
        if not running.done():
            self.wrong(
                what, f"goes on for more than {PROMPT_S:g} s", "end and raise CancelledError"
            )
        elif not isinstance(error := _raised(running), asyncio.CancelledError | DriverError):
            self.wrong(what, f"raised {_shown(error)}", "raise CancelledError again")

    async def quiet(self, what: str, call: Awaitable[object], limit: float | None = None) -> None:
        """A call that raises nothing and takes no longer than `limit`, or PROMPT_S, in seconds."""
        self._watch.doing(what)
        limit = PROMPT_S if limit is None else limit
        match await _raised_within(call, limit):
            case None:
                return
            case TimeoutError():
                self.wrong(what, f"took more than {limit:g} s")
            case asyncio.CancelledError() as error:
                remedy = "suppress it where you wait for the end of what you cancelled"
                self.wrong(what, f"raised {error!r}", remedy)
            case error:
                self.wrong(what, f"raised {error!r}")

    async def refuses(
        self, what: str, kind: type[DriverError], command: PlainJob = _UNKNOWN_VERB
    ) -> None:
        """A command that is refused at once with the right exception."""
        self._watch.doing(what)
        remedy = f"raise {kind.__name__}"
        error = await _raised_within(self.driver.perform(command), PROMPT_S)
        if isinstance(error, TimeoutError):
            self.wrong(what, f"took more than {PROMPT_S:g} s", f"{remedy} at once")
        elif not isinstance(error, kind):
            self.wrong(what, f"raised {_shown(error)}", remedy)

    async def _left_behind(self) -> None:
        """Tasks and threads that outlive the driver; they get as long as a stop to end."""
        patience = time.monotonic() + PROMPT_S
        while True:
            left = [task.get_name() for task in asyncio.all_tasks() - self._tasks]
            left += [thread.name for thread in set(threading.enumerate()) - self._threads]
            left = sorted(one for one in left if not one.startswith("asyncio_"))
            if not left or time.monotonic() > patience:
                break
            await asyncio.sleep(0.01)
        for one in left:
            self.wrong("close", f"left {one!r} running")


def _numbers(args: Mapping[str, Json]) -> dict[str, float]:
    """The numbers among a command's arguments, joints by their names."""
    found: dict[str, float] = {}
    for name, value in args.items():
        if isinstance(value, Mapping):
            found |= _numbers(value)
        elif isinstance(value, int | float) and not isinstance(value, bool):
            found[name] = float(value)
    return found


def _far(got: Mapping[str, float | None], wanted: Mapping[str, float]) -> list[str]:
    """The names of what is something else than wanted, or not there."""
    return [
        name
        for name, value in wanted.items()
        if (found := got.get(name)) is None
        or not math.isclose(found, value, rel_tol=OFF, abs_tol=1e-3)
    ]


async def _becomes(true: Callable[[], Awaitable[bool]]) -> bool:
    """Whether that is so within NOTICE_S."""
    with contextlib.suppress(TimeoutError):
        async with asyncio.timeout(NOTICE_S):
            while not await true():  # noqa: ASYNC110 - what hardware does sets no event
                await asyncio.sleep(_LOOK_S)
            return True
    return False


def _raised(ended: asyncio.Task[Any]) -> BaseException | None:
    """What a command that has ended raised; `Task.exception` raises of one that was cancelled."""
    return asyncio.CancelledError() if ended.cancelled() else ended.exception()


def _shown(error: BaseException | None) -> str:
    return "nothing" if error is None else repr(error)


async def _raised_within(call: Awaitable[object], limit: float) -> BaseException | None:
    """What a call raises; `TimeoutError` if it takes longer than `limit` seconds."""
    try:
        await asyncio.wait_for(call, limit)
    except asyncio.CancelledError as error:
        if (task := asyncio.current_task()) is not None and task.cancelling():
            raise  # the test itself is cancelled
        return error
    except Exception as error:  # noqa: BLE001 - a stranger's code may raise anything
        return error
    return None
