"""The conformance check finds what is wrong with a driver, and nothing in a right one."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import pytest

from woz_tui.core.conformance import MODEL_VERBS, RESERVED, check
from woz_tui.core.driver import (
    Argument,
    Driver,
    Finding,
    Job,
    Lost,
    Probe,
    Rejected,
    Scope,
    Verb,
    Written,
)
from woz_tui.core.fields import Range
from woz_tui.core.messages import Json
from woz_tui.experiment.actions import ACTION_FIELDS
from woz_tui.experiment.verbs import ENGAGEMENT_VERBS, WAIT, session_verbs


@dataclass(frozen=True)
class Nothing:
    """No setting at all."""


class Right(Driver):
    """The smallest driver that keeps the contract."""

    Settings = Nothing
    summary = "nothing at all"
    offered: ClassVar[tuple[Verb, ...]] = (Verb("rest-hands", "rest"),)
    closed = False

    @classmethod
    def verbs(cls, settings: Any) -> tuple[Verb, ...]:
        return cls.offered

    async def perform(self, job: Job) -> Mapping[str, Json]:
        if self.closed:
            raise Lost("closed")
        raise Rejected(f"unknown verb {job.verb}")

    async def stop(self, scope: Scope) -> None:
        return

    async def close(self) -> None:
        self.closed = True


async def complaints(driver: type[Right]) -> list[str]:
    found = await check(driver, driver.Settings())
    return [f"{finding.subject}: {finding.text}" for finding in found if finding.level == "error"]


async def test_a_right_driver_passes() -> None:
    assert [finding.level for finding in await check(Right, Right.Settings())] == ["ok"]


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
    ],
)
async def test_wrong_verbs_are_found(verbs: tuple[Verb, ...], complaint: str) -> None:
    assert complaint in await complaints(offering(*verbs))


class Talkative(Right):
    async def open(self) -> None:
        await super().open()
        self.outlet.reading("warmth", 1.0)


class Mute(Right):
    async def open(self) -> None:
        return


class Patient(Right):
    async def open(self) -> None:
        await asyncio.Event().wait()


class Obliging(Right):
    async def perform(self, job: Job) -> Mapping[str, Json]:
        return {}


class Clumsy(Right):
    async def perform(self, job: Job) -> Mapping[str, Json]:
        raise KeyError(job.verb)


class Stubborn(Right):
    async def stop(self, scope: Scope) -> None:
        await asyncio.Event().wait()


class OnlyOnce(Right):
    async def close(self) -> None:
        if self.closed:
            raise RuntimeError("closed already")
        await super().close()


class Careless(Right):
    async def open(self) -> None:
        await super().open()
        self.task = asyncio.create_task(asyncio.sleep(3), name="forgotten")


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
    assert "remarks" not in await complaints(right)


@pytest.mark.parametrize(
    ("driver", "complaint"),
    [
        (Talkative, "sensors: publishes warmth undeclared"),
        (Mute, "open: said nothing about its health"),
        (Patient, "open: took more than 0.5 s"),
        (Obliging, "perform of an unknown verb: raised nothing"),
        (Clumsy, "perform of an unknown verb: raised KeyError('no-such-verb')"),
        (Stubborn, "stop(ALL) with nothing running: took more than 0.5 s"),
        (OnlyOnce, "close for the second time: raised RuntimeError('closed already')"),
        (Careless, "close: left 'forgotten' running"),
        (Excited, "examine: raised OSError('no such port')"),
    ],
)
async def test_wrong_behaviour_is_found(driver: type[Right], complaint: str) -> None:
    assert complaint in await complaints(driver)


def test_the_words_it_reserves_are_those_of_actions_session_and_model() -> None:
    session = [verb.name for verb in session_verbs()]
    assert set(RESERVED) == {*ACTION_FIELDS, WAIT.name, *session}
    assert set(MODEL_VERBS) == set(ENGAGEMENT_VERBS)
