"""The kit for drivers finds what is wrong with one, and nothing in a right one."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import pytest

from tools import ROOT
from woz_tui.config.actions import ACTION_FIELDS
from woz_tui.config.session_verbs import ENGAGEMENT_VERBS, WAIT, session_verbs
from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    Driver,
    Finding,
    Health,
    Job,
    Offer,
    Probe,
    RejectedError,
    Scope,
    Verb,
    Written,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json
from woz_tui.testing import check, contract_checks
from woz_tui.testing.contract_checks import MODEL_VERBS, RESERVED, reserved_words


@dataclass(frozen=True)
class NoSettings:
    """No setting at all."""


class Right(Driver):
    """The smallest driver that keeps the contract."""

    Settings: ClassVar[type] = NoSettings
    summary = "nothing at all"
    offered: ClassVar[tuple[Verb, ...]] = (Verb("rest-hands", "rest"),)
    closed = False

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return Offer(verbs=cls.offered)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        if self.closed:
            raise DeviceLostError("closed")
        raise RejectedError(f"unknown verb {job.verb}")

    async def stop(self, scope: Scope) -> None:
        return

    async def close(self) -> None:
        self.closed = True


async def complaints(driver: type[Right]) -> list[str]:
    found = await check(driver, driver.Settings())
    return [f"{finding.subject}: {finding.text}" for finding in found]


async def test_a_right_driver_passes() -> None:
    assert await check(Right, Right.Settings()) == []


def offering(*verbs: Verb) -> type[Right]:
    class Offering(Right):
        offered = verbs

    return Offering


@pytest.mark.parametrize(
    ("verbs", "complaint"),
    [
        ((Verb("go", "a"), Verb("go", "b")), "verbs: 'go' is there twice"),
        ((Verb("Go", "a"),), "verb Go: a name is made of a-z, 0-9, - and _"),
        ((Verb("label", "a"),), "verb label: means something else in every action"),
        ((Verb("mark", "a"),), "verb mark: means something else in every action"),
        ((Verb("filter", "a"),), "verb filter: is a verb of the engagement model"),
        ((Verb("go", ""),), "verb go: needs a summary"),
        ((Verb("go", "a", limit_s=0),), "verb go: limit_s must be more than 0, not 0"),
        ((Verb("go", "a", evidence="seen"),), "verb go: unknown evidence 'seen'"),  # type: ignore[arg-type]
        ((Verb("say", "a", (Argument("what", "text"),)),), "verb say: its main argument is 'what'"),
        ((Verb("say", "a"),), "verb say: its main argument is ''"),
        (
            (Verb("go", "a", (Argument("far", "metres"),)),),
            "verb go: far: unknown kind 'metres'",
        ),
        ((Verb("go", "a", (Argument("way", "choice"),)),), "verb go: way: a choice needs choices"),
        (
            (Verb("go", "a", (Argument("far", "number", default=9, range=Range(0, 5)),)),),
            "verb go: far: its default 9 is not within 0 to 5",
        ),
        (
            (Verb("go", "a", (Argument("way", "choice", default="up", choices=("left",)),)),),
            "verb go: way: its default 'up' is not one of its choices",
        ),
        (
            (Verb("go", "a", (Argument("key", "text", hide=lambda text: f"*{text}"),)),),
            "verb go: key: hide('') is '*', then '**'",
        ),
        (
            (Verb("go", "a", (Argument("key", "text", hide={"x": "y"}.__getitem__),)),),
            "verb go: key: hide raised KeyError('')",
        ),
        (
            (common_verb("learn_face"),),
            "verb learn_face: needs a verb 'face_consent' beside it",
        ),
        (
            (common_verb("face_consent"), Verb("teach", "a", needs_consent=True)),
            "verb teach: its main argument must be a person's name, a text",
        ),
        (
            (common_verb("learn_face"), Verb("face_consent", "a", (Argument("name", "text"),))),
            "verb face_consent: takes `name`, a text, and `given`, a flag",
        ),
    ],
)
async def test_wrong_verbs_are_found(verbs: tuple[Verb, ...], complaint: str) -> None:
    assert complaint in await complaints(offering(*verbs))


class Talkative(Right):
    async def open(self) -> None:
        await super().open()
        self.context.reading("warmth", 1.0)


class Mute(Right):
    async def open(self) -> None:
        return


class Patient(Right):
    async def open(self) -> None:
        await asyncio.Event().wait()


class Obliging(Right):
    async def perform(self, job: Job) -> Mapping[str, Json]:
        return {}


class HardwareFirst(Right):
    """Decides what it is asked only where its hardware is there."""

    missing = False

    async def open(self) -> None:
        self.context.health(Health.CONNECTING)
        asyncio.get_running_loop().call_later(0.02, self.looked)

    def looked(self) -> None:
        self.missing = True
        self.context.health(Health.LOST, remedy="plug it in")

    async def perform(self, job: Job) -> Mapping[str, Json]:
        if self.missing:
            raise DeviceLostError("it is not there")
        return await super().perform(job)


class Clumsy(Right):
    async def perform(self, job: Job) -> Mapping[str, Json]:
        raise KeyError(job.verb)


class Stubborn(Right):
    async def stop(self, scope: Scope) -> None:
        await asyncio.Event().wait()


class Opened(Right):
    """Makes in `open` what its stop needs."""

    async def open(self) -> None:
        await super().open()
        self.still = asyncio.Event()

    async def stop(self, scope: Scope) -> None:
        self.still.set()


class OnlyOnce(Right):
    async def close(self) -> None:
        if self.closed:
            raise RuntimeError("closed already")
        await super().close()


class Careless(Right):
    async def open(self) -> None:
        await super().open()
        self.task = asyncio.create_task(asyncio.sleep(3), name="forgotten")


class Restless(Right):
    async def close(self) -> None:
        await super().close()
        asyncio.get_running_loop().call_later(0.05, self.context.reading, "warmth", 1.0)

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return Offer(sensors=("warmth",))


class Careful(Right):
    """Waits for the end of what it cancels, and lets that out."""

    async def open(self) -> None:
        await super().open()
        self.task = asyncio.create_task(asyncio.Event().wait())

    async def close(self) -> None:
        self.task.cancel()
        await super().close()
        await self.task


@dataclass(frozen=True)
class Ruled:
    """Settings with rules that nobody asks for: it is no `Section`."""

    def problems(self) -> list[tuple[str, str]]:
        return [("", "never right")]


class Lawless(Right):
    Settings: ClassVar[type] = Ruled


class Excited(Right):
    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        raise OSError("no such port")


def remarking(found: Callable[[Written], Finding]) -> type[Right]:
    """A driver with two verbs that says this of each command."""

    class Remarking(offering(Verb("go", "a", (Argument("to", "text"),)), Verb("stay", "b"))):  # type: ignore[misc]
        @classmethod
        def remarks(cls, settings: Any, written: Written) -> list[Finding]:
            return [found(written)] if written.verb == "go" else []

    return Remarking


@pytest.mark.parametrize(
    ("found", "complaint"),
    [
        (lambda written: {}[written.args["to"]], "remarks: raised KeyError('') about go"),
        (lambda written: Finding("odd", "to", "x"), "remarks: unknown level 'odd'"),
        (lambda written: Finding("warning", "far", "x"), "remarks: go has no argument 'far'"),
    ],
)
async def test_wrong_remarks_are_found(found: Callable[[Written], Finding], complaint: str) -> None:
    assert complaint in await complaints(remarking(found))


async def test_remarks_about_arguments_are_right() -> None:
    right = remarking(lambda written: Finding("warning", "to", str(written.args["to"])))
    assert await complaints(right) == []


@pytest.mark.parametrize(
    ("driver", "complaint"),
    [
        (Talkative, "sensors: publishes warmth undeclared"),
        (Mute, "open: said nothing about its health"),
        (Patient, "open: took more than 0.5 s"),
        (Obliging, "perform of an unknown verb: raised nothing"),
        (
            HardwareFirst,
            "perform of an unknown verb, once it has looked: raised"
            " DeviceLostError('it is not there')",
        ),
        (Clumsy, "perform of an unknown verb: raised KeyError('no-such-verb')"),
        (Stubborn, "stop(ALL) with nothing running: took more than 0.5 s"),
        (
            Opened,
            "stop(ALL) before open: raised"
            """ AttributeError("'Opened' object has no attribute 'still'")""",
        ),
        (OnlyOnce, "close for the second time: raised RuntimeError('closed already')"),
        (Careless, "close: left 'forgotten' running"),
        (Careful, "close: raised CancelledError()"),
        (Restless, "close: published something afterwards"),
        (Lawless, "Settings: nobody calls its problems()"),
        (Excited, "examine: raised OSError('no such port')"),
    ],
)
async def test_wrong_behaviour_is_found(
    driver: type[Right], complaint: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(contract_checks, "PROMPT_S", 0.5)
    assert complaint in await complaints(driver)


def test_the_words_it_reserves_are_those_of_actions_session_and_model() -> None:
    session = [verb.name for verb in session_verbs()]
    assert set(RESERVED) == {*ACTION_FIELDS, WAIT.name, *session}
    assert set(MODEL_VERBS) == set(ENGAGEMENT_VERBS)
    page = (ROOT / "drivers/README.md").read_text(encoding="utf-8")
    assert [word for word in (*reserved_words(), *MODEL_VERBS) if f"`{word}`" not in page] == []
