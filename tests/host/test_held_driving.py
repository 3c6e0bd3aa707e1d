"""Inside tmux, screen or mosh the robot drives only as long as somebody holds a key."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path
from typing import Literal, Self

import pytest

from tests.session.rig import HERE, SessionRig, action, call, experiment, together
from woz_tui.config.experiment import Experiment, Panel, Wait
from woz_tui.gate.questions import RequestOrigin
from woz_tui.gate.table import LET_GO
from woz_tui.host.client_connection import ClientConnection, RequestScheduler
from woz_tui.host.dead_man_switch import DeadManSwitch
from woz_tui.host.held_driving import FIRST_REPEAT_S, NEXT_REPEAT_S
from woz_tui.host.request_handlers import RequestHandlers
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import AskAction, AskLetGo, AskVerb, Hello, Request

pytestmark = pytest.mark.safety

Line = Literal["", "tmux", "screen", "mosh"]
Setting = Literal["auto", "held", "pressed"]
#: A key that is held down, as keyboards repeat it: seconds from one press to the next.
REPEAT_S = 1 / 30


class Wizard(SessionRig):
    """A wizard's console at a session whose robot drives for five seconds at a command."""

    def __init__(self, folder: Path, line: Line, driving: Setting) -> None:
        super().__init__(folder, made=driving_experiment(folder, driving), rests=False)
        self.line = line

    async def __aenter__(self) -> Self:
        session = self.session
        self.client = self._client("con1", "wizard", self.line)
        self.program = self._client("con2", "program", "")
        self.handlers = RequestHandlers(session, lambda: session.experiment)
        self.switch = self.handlers.switch = DeadManSwitch(session, lambda: [self.client])
        await super().__aenter__()
        session.hub.publish(m.ConsoleAttached(console="con1", role="wizard"))
        self.switch.update()
        return self

    def _client(self, name: str, role: str, line: Line) -> ClientConnection:
        session = self.session
        client = ClientConnection(
            name,
            session.hub,
            RequestScheduler(),
            session.standstill,
            on_request=lambda client, request: None,
            on_stop=lambda client, request: None,
            on_close=lambda client, why: None,
            recorded=self.recorder.is_written,
        )
        client.hello, client.role = Hello(role=role, line=line, protocol=2), role
        return client

    def ask(self, request: Request, client: ClientConnection | None = None) -> None:
        self.handlers.answer(client or self.client, request)

    def press(self, name: str = "Go", key: str = "g", *, stale: bool = False) -> None:
        self.ask(AskAction(action=name, source="key", key=key, stale=stale))

    async def press_and_hold(self, delay: float, seconds: float) -> None:
        """At a keyboard that waits so long before it repeats."""
        self.press()
        await asyncio.sleep(delay - REPEAT_S)
        await self.hold(seconds - delay + REPEAT_S)

    async def hold(self, seconds: float) -> None:
        """Go on with a key that has been pressed: its repeats."""
        for _ in range(round(seconds / REPEAT_S)):
            await asyncio.sleep(REPEAT_S)
            self.press()

    def drives(self) -> int:
        """How often the robot was told to drive."""
        return [verb for verb, _ in self.driver().calls].count("drive")

    def ends(self) -> list[tuple[str, float, str]]:
        """How drives ended, after how many seconds, and why."""
        begun = {line.command: line.t for line in self.of(m.Command) if line.verb == "drive"}
        return [
            (type(line).__name__, round((line.t - begun[line.command]) / 1e6, 3), line.reason)
            for line in self.of(m.End)
            if line.command in begun
        ]


def driving_experiment(folder: Path, driving: Setting) -> Experiment:
    made = experiment(folder)
    later = action("Later", Wait(1.0), together(call("drive", x=1.0)), panel="Base")
    base = Panel("Base", (*made.panels[1].actions, later), HERE)
    session = replace(made.session, driving=driving)
    return replace(made, panels=(made.panels[0], base), session=session)


def played(
    folder: Path,
    scenario: Callable[[Wizard], Awaitable[None]],
    line: Line = "tmux",
    driving: Setting = "auto",
) -> Wizard:
    return Wizard(folder, line, driving).run(scenario, 6)


async def one_press(wizard: Wizard) -> None:
    wizard.press()


@pytest.mark.parametrize("line", ["tmux", "screen", "mosh"])
def test_a_press_without_repeats_drives_for_a_moment(line: Line, tmp_path: Path) -> None:
    assert played(tmp_path, one_press, line).ends() == [("Stopped", FIRST_REPEAT_S, LET_GO)]


def test_on_a_line_that_is_seen_one_press_drives_as_far_as_it_says(tmp_path: Path) -> None:
    assert played(tmp_path, one_press, "").ends() == [("Done", 5.0, "")]


@pytest.mark.parametrize(
    ("line", "driving", "ends"),
    [
        ("", "held", ("Stopped", FIRST_REPEAT_S, LET_GO)),
        ("tmux", "pressed", ("Done", 5.0, "")),
    ],
)
def test_the_file_says_it_for_all_lines(
    line: Line, driving: Setting, ends: tuple[str, float, str], tmp_path: Path
) -> None:
    assert played(tmp_path, one_press, line, driving).ends() == [ends]


@pytest.mark.parametrize("held_s", [0.5, 1.0, 3.2])
def test_a_held_key_drives_until_it_is_let_go(held_s: float, tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        wizard.press()
        await asyncio.sleep(0.3)  # as keyboards wait before they repeat
        await wizard.hold(held_s - 0.3)

    wizard = played(tmp_path, scenario)
    [(how, seconds, why)] = wizard.ends()
    assert (how, why) == ("Stopped", LET_GO)
    last = 0.3 + round((held_s - 0.3) / REPEAT_S) * REPEAT_S
    assert seconds == pytest.approx(max(FIRST_REPEAT_S, last + NEXT_REPEAT_S), abs=0.002)
    assert wizard.drives() == 1


def test_repeats_begin_nothing_anew_when_the_robot_is_there(tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        wizard.press()
        await wizard.hold(8)

    wizard = played(tmp_path, scenario)
    assert [how for how, *_ in wizard.ends()] == ["Done"]
    assert len(wizard.of(m.ActionRequested)) == 1


def test_let_go_and_pressed_again_it_drives_again(tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        wizard.press()
        await asyncio.sleep(2)
        wizard.press()

    assert played(tmp_path, scenario).drives() == 2


def test_an_old_repeat_prolongs_nothing(tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        wizard.press()
        await asyncio.sleep(0.6)
        wizard.press(stale=True)

    assert played(tmp_path, scenario).ends() == [("Stopped", FIRST_REPEAT_S, LET_GO)]


@pytest.mark.parametrize(("delay", "moment"), [(0.25, 0.4), (0.5, 0.65), (1.0, 1.15), (1.15, 1.2)])
def test_the_first_held_key_teaches_how_long_the_keyboard_waits(
    delay: float, moment: float, tmp_path: Path
) -> None:
    """A slow keyboard's first hold is ended once; the next one drives until it is let go."""

    async def scenario(wizard: Wizard) -> None:
        await wizard.press_and_hold(delay, 2.0)
        await asyncio.sleep(3)
        await wizard.press_and_hold(delay, 2.0)
        await asyncio.sleep(3)
        wizard.press()

    wizard = played(tmp_path, scenario)
    *_, (_, held, _), (_, pressed, _) = wizard.ends()
    assert held == pytest.approx(2.0 + NEXT_REPEAT_S, abs=0.05)
    assert pressed == pytest.approx(moment, abs=0.002)
    assert wizard.drives() == (4 if delay > FIRST_REPEAT_S else 3)
    [told] = [line.text for line in wizard.of(m.Notice) if "keyboard" in line.text]
    assert f"after {delay:.2f} s" in told
    assert f"{moment:.2f} s" in told


@pytest.mark.parametrize(
    "pauses",
    [(0.5,), (0.9, 0.9), (0.3, 0.3, 0.3), (0.5, 0.0, 0.0), (1.5, 0.03, 0.03)],
    ids=["twice", "slowly", "quickly", "burst", "later"],
)
def test_presses_and_bursts_teach_nothing(pauses: tuple[float, ...], tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        wizard.press()
        for pause in pauses:
            await asyncio.sleep(pause)
            wizard.press()
        await asyncio.sleep(3)
        wizard.press()

    assert played(tmp_path, scenario).ends()[-1] == ("Stopped", FIRST_REPEAT_S, LET_GO)


def test_a_delay_that_was_seen_longer_had_waited_on_its_way(tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        for delay in (0.9, 0.4, 0.4):
            await wizard.press_and_hold(delay, 2.0)
            await asyncio.sleep(3)
        wizard.press()

    assert played(tmp_path, scenario).ends()[-1] == ("Stopped", 0.55, LET_GO)


def test_quick_taps_teach_no_delay(tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        for pause in (0.0, 0.3, 0.1, 0.1, 3.0):
            await asyncio.sleep(pause)
            wizard.press()

    assert played(tmp_path, scenario).ends()[-1] == ("Stopped", FIRST_REPEAT_S, LET_GO)


def test_longer_holds_correct_a_delay_that_was_measured_too_short(tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        for delay in (0.2, 0.5, 0.5):
            await wizard.press_and_hold(delay, 2.0)
            await asyncio.sleep(3)
        wizard.press()

    assert played(tmp_path, scenario).ends()[-1] == ("Stopped", 0.65, LET_GO)


def test_a_burst_of_repeats_counts_once(tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        wizard.press()
        await asyncio.sleep(0.6)
        for _ in range(20):
            wizard.press()

    [(_, seconds, _)] = played(tmp_path, scenario).ends()
    assert seconds == pytest.approx(0.6 + NEXT_REPEAT_S)


def test_a_terminal_that_says_so_ends_it_at_once(tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        wizard.press()
        await asyncio.sleep(0.2)
        wizard.ask(AskLetGo(key="g"))

    assert played(tmp_path, scenario).ends() == [("Stopped", 0.2, LET_GO)]


def test_a_step_that_comes_after_the_key_is_up_does_not_drive(tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        wizard.press("Later", "l")

    wizard = played(tmp_path, scenario)
    assert [(how, why) for how, _, why in wizard.ends()] == [("Refused", LET_GO)]
    assert wizard.drives() == 0


@pytest.mark.parametrize(
    "ask",
    [
        AskAction(action="Go", source="palette"),
        AskVerb(verb="drive", args={"x": 1.0}, source="key"),
    ],
)
def test_what_no_key_holds_does_not_drive_and_says_why(ask: Request, tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        wizard.ask(ask)

    wizard = played(tmp_path, scenario)
    [refused] = wizard.of(m.Refused)
    assert refused.code == "unwatched"
    assert "tmux" in refused.reason
    assert "driving: pressed" in refused.remedy
    assert wizard.drives() == 0


def test_nor_does_a_program(tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        wizard.ask(AskAction(action="Go", key="g"), wizard.program)

    assert played(tmp_path, scenario).drives() == 0


def test_a_control_that_says_when_it_is_let_go_drives(tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        hand = RequestOrigin("gamepad", "a")
        wizard.session.send("drive", {"x": 1.0}, "", hand)

    assert played(tmp_path, scenario).ends() == [("Done", 5.0, "")]


def test_what_else_a_held_key_does_goes_on(tmp_path: Path) -> None:
    """Its sentence is not cut, and other keys are not affected."""

    async def scenario(wizard: Wizard) -> None:
        wizard.press()
        wizard.press("Hello", "h")

    wizard = played(tmp_path, scenario)
    said = wizard.of(m.Done)
    assert [line.sent for line in said] == [{"text": "Hello P07"}]
