"""View models of a robot's settings: value, signs and sentences of each line."""

from __future__ import annotations

from dataclasses import dataclass

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Piece, clean
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.console.drawing.number_text import age
from woz_tui.console.robot_settings.lines import (
    CONNECTION,
    LineKind,
    SettingLine,
    bare_address,
    lines_of,
)
from woz_tui.console.robot_settings.requests import SettingRequests
from woz_tui.console.robot_settings.status import is_stale, trouble_words
from woz_tui.console.robot_settings.step_sizes import ArrowSteps
from woz_tui.console.robot_settings.values import allowed_values, color_of, value_text
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.remedy_text import remedy_text
from woz_tui.protocol.messages import Json, SettingsShown
from woz_tui.protocol.panels import covers_verb
from woz_tui.protocol.robot_outline import RobotOutline
from woz_tui.protocol.sentence import Sentence


@dataclass(frozen=True, slots=True)
class LineView:
    """One line: its value, the colour (`#rrggbb`) to go with it, signs behind it, and what is said
    of it at the bottom while it is chosen. `fixed`: it is only shown.
    """

    section: str
    label: str
    value: str
    color: str = ""
    stale: bool = False
    fixed: bool = False
    signs: tuple[Piece, ...] = ()
    about: tuple[Piece, ...] = ()


@dataclass(frozen=True, slots=True)
class RobotView:
    """One robot: how it is (`state`), how much is wrong with its settings (`count`), conflicts
    between them or else why it is not there, its lines.
    """

    driver: str
    state: Piece
    count: str
    conflicts: tuple[str, ...]
    lines: tuple[LineView, ...]


class SettingViewer:
    """Describes robots of the console state; `arrows` and `requests` tell what it does not know."""

    def __init__(
        self, state: ConsoleState, glyphs: Glyphs, arrows: ArrowSteps, requests: SettingRequests
    ) -> None:
        self._picture, self._glyphs = state, glyphs
        self._arrows, self._requests = arrows, requests

    def lines(self, driver: str, outline: RobotOutline) -> list[SettingLine]:
        """All lines; in a replay those of the robot's own settings."""
        found = lines_of(outline, self._picture.verbs.get(driver, ()))
        if self._picture.replay is None:
            return found
        return [line for line in found if line.kind is LineKind.SETTING]

    def value(self, driver: str, line: SettingLine) -> Json:
        """The value from which an arrow key goes on: the requested one, else the robot's."""
        if line.kind is LineKind.STEP:
            return self._arrows.value(line.setting.name)
        awaited = self._requests.awaited(driver, line)
        name = "robot" if line.kind is LineKind.ADDRESS else line.setting.name
        return self._robot(driver).values.get(name) if awaited is None else awaited

    def locked(self, driver: str, line: SettingLine) -> str:
        """The panel whose lock covers the line's verb of this driver, or nothing."""
        if line.kind is LineKind.STEP or not line.setting.verb:
            return ""
        return locked_by(self._picture, line.setting.verb, driver)

    def see(self, driver: str, outline: RobotOutline, now: int) -> RobotView:
        """The robot as it is at `now`, session time."""
        robot = self._robot(driver)
        stale = is_stale(self._picture, driver)
        lines = tuple(self._line(driver, line, stale) for line in self.lines(driver, outline))
        count = "" if stale else trouble_words(robot)
        sentences = tuple(robot.conflicts)
        if stale:  # why it is not there and what to do, whole: the reason of a loss takes a line
            known = None if self._picture.lost else self._picture.drivers.get(driver)
            why = () if known is None else (known.detail, remedy_text(known.remedy, self._picture))
            sentences = tuple(text for text in why if text)
        return RobotView(driver, self._state(driver, now), count, sentences, lines)

    def _robot(self, driver: str) -> SettingsShown:
        shown = self._picture.session.robots.shown.get(driver)
        return shown or SettingsShown(driver=driver, values={})

    def _state(self, driver: str, now: int) -> Piece:
        if (lost := self._picture.lost) is not None:
            return f"{self._glyphs.error} {lost.part.sentence}", "bad"
        known = self._picture.drivers.get(driver)
        health = self._picture.health(driver)
        if known is None or health == "unknown":
            return f"{self._glyphs.no} {say('settings.unknown', 'not heard of yet')}", "muted"
        if health == "connected":
            told = known.detail or say("settings.connected", "connected")
            return f"{self._glyphs.yes} {told}", "good"
        if health == "lost":
            ago = say("settings.lost_ago", "lost {age} ago", age=age(now - known.t))
            return f"{self._glyphs.error} {ago}", "bad"
        why = f": {known.detail}" if known.detail and health == "faulted" else ""
        return f"{self._glyphs.warning} {word(_HEALTH.get(health, health))}{why}", "warn"

    def _line(self, driver: str, line: SettingLine, stale: bool) -> LineView:
        setting, glyphs = line.setting, self._glyphs
        robot = self._robot(driver)
        read = line.kind is LineKind.SETTING
        value = robot.values.get(setting.name) if read else None
        if line.kind is LineKind.STEP:
            value = self._arrows.value(setting.name)
        text = value_text(setting, value, glyphs) if read or line.kind is LineKind.STEP else ""
        label = setting.label[:1].upper() + setting.label[1:]
        if line.kind is LineKind.ROBOT:
            label = setting.label  # an address stays as it is
            here = robot.values.get("robot")
            if isinstance(here, str) and bare_address(here) == bare_address(setting.name):
                text = f"{glyphs.yes} {say('settings.this_one', 'this one')}"
        wanted = ""
        if read and not stale and setting.name in robot.wanted:
            wanted = value_text(setting, robot.wanted[setting.name], glyphs)
        old = stale and line.kind is not LineKind.STEP
        signs, sentences = self._signs_and_sentences(driver, line, text, wanted)
        return LineView(
            word(setting.section),
            label,
            f"{glyphs.stale} {text}" if old and text not in ("", glyphs.dash) else text,
            color="" if old or setting.kind != "color" else color_of(value),
            stale=stale and read,
            fixed=read and not line.is_set,
            signs=tuple(signs),
            about=(*sentences, *self._about(line)),
        )

    def _signs_and_sentences(
        self, driver: str, line: SettingLine, text: str, wanted: str
    ) -> tuple[list[Piece], list[Piece]]:
        """Signs behind a line: locked; else: asked for, otherwise than wanted, refused. And what
        is wrong in sentences.
        """
        glyphs, refusal = self._glyphs, self._requests.refusal(driver, line)
        signs: list[Piece] = []
        sentences: list[Piece] = []
        if refusal:
            not_done = say("settings.not_done", "Not done: {why}", why=refusal)
            sentences.append((f"{glyphs.refused} {not_done}", "bad"))
        if panel := self.locked(driver, line):
            locked = say("settings.locked_with", "locked with {panel}", panel=panel)
            unlock = say("settings.unlock", "Unlock {panel} to change it.", panel=panel)
            signs = [(f"{glyphs.locked} {locked}", "warn")]
            sentences.append((f"{glyphs.locked} {unlock}", "warn"))
        if wanted:
            has = say(
                "settings.wanted_has",
                "Wanted: {wanted}; the robot has {has}.",
                wanted=wanted,
                has=text,
            )
            sentences.append((f"{glyphs.warning} {has}", "warn"))
        if panel:
            return signs, sentences
        if (awaited := self._requests.awaited(driver, line)) is not None:
            asked = (
                value_text(line.setting, awaited, glyphs)
                if line.is_set
                else say("settings.asked", "asked")
            )
            signs.append((f"{glyphs.next} {asked}", "run"))
        elif wanted:
            differs = say("settings.wanted", "wanted {wanted}", wanted=wanted)
            signs.append((f"{glyphs.warning} {differs}", "warn"))
        if refusal:
            signs.append((f"{glyphs.refused} {refusal}", "bad"))
        return signs, sentences

    def _about(self, line: SettingLine) -> tuple[Piece, ...]:
        words = [line.setting.help, allowed_values(line.setting) if line.is_set else ""]
        if line.kind is LineKind.SETTING and not line.is_set:
            connects = line.setting.verb == "connect"
            words.append(
                say("settings.chosen_under", "chosen under {section}", section=CONNECTION)
                if connects
                else say("settings.only_shown", "only shown")
            )
        if line.setting.section == CONNECTION:
            words.append(word(_CONNECTION[line.kind]))
        told = "; ".join(filter(None, words))
        return ((self._glyphs.plain(told), "muted"),) if told else ()


_CONNECTION = {
    LineKind.ROBOT: Sentence("settings.enter_connects", "enter connects to this robot"),
    LineKind.ADDRESS: Sentence("settings.enter_address", "enter asks for the address of any robot"),
    LineKind.DISCONNECT: Sentence(
        "settings.enter_disconnects", "enter lets go of the robot; it is not looked for any more"
    ),
}
#: How a driver is that is neither connected nor lost.
_HEALTH = {
    "connecting": Sentence("settings.connecting", "connecting"),
    "faulted": Sentence("settings.faulted", "faulted"),
}


def locked_by(state: ConsoleState, verb: str, driver: str) -> str:
    """The title of a locked panel that covers `verb` of `driver`, or nothing."""
    covering = (panel for panel in state.panels if covers_verb(panel.covers, verb, driver))
    return next((clean(panel.title) for panel in covering if state.is_locked(panel)), "")
