"""What the tests of dialogs share: how each is opened, and what they look at."""

from __future__ import annotations

from textual.widgets import Input

from tests.console import scenes
from tests.console.piloting import ConsolePilot
from woz_tui.protocol import requests as r

NOW = scenes.NOW
SIZES = [(80, 24), (160, 50), (60, 20)]
#: Key that opens each dialog.
OPENERS = {
    "SayDialog": "slash",
    "FindDialog": "colon",
    "PeekDialog": "apostrophe",
    "NoteDialog": "comma",
    "MistakeDialog": "ctrl+w",
    "FailuresDialog": "enter",
    "HelpDialog": "question_mark",
    "StartDialog": "ctrl+t",
    "PreflightDialog": "ctrl+f",
    "ReloadDialog": "ctrl+e",
    "DriversDialog": "ctrl+d",
    "LeaveDialog": "ctrl+q",
    "BodyDialog": "semicolon",
    "KnobsDialog": "plus",
    "ProfileDialog": "minus",
    "EngagementDialog": "equals_sign",
    "TrialDialog": "asterisk",
    "PhasesDialog": "quotation_mark",
    "RobotDialog": "at",
    "MoveDialog": "percent_sign",
    "UnrecordedDialog": "home",
}


def busy() -> r.Welcome:
    return scenes.welcome(recent=scenes.history())


async def open_dialog(pilot: ConsolePilot, name: str) -> None:
    await pilot.press(OPENERS[name])
    await pilot.until(lambda: name in [each.__name__ for each in type(pilot.console.dialog).mro()])
    await pilot.settle()


async def named(pilot: ConsolePilot, code: str = "P08") -> None:
    """Open the participant dialog and write another code."""
    await open_dialog(pilot, "StartDialog")
    field = pilot.console.screen.query_one("#participant", Input)
    field.value = ""
    await pilot.type(code)
    await pilot.until(lambda: field.value == code)
    for _ in range(5):  # the question, its answer, the fields that it fills in, their places
        await pilot.press()


#: The console's keys that open a dialog.
OPENING: tuple[str, ...] = (
    "say",
    "find",
    "note",
    "mistake",
    "failures",
    "help",
    "start",
    "preflight",
    "reload",
)
OPENING += ("drivers", "leave", "body", "knobs", "profile", "engagement", "trial")
OPENING += ("robot", "move")
#: What Textual's names of keys stand for.
CHARACTERS = {
    "slash": "/",
    "colon": ":",
    "comma": ",",
    "quotation_mark": '"',
    "apostrophe": "'",
    "question_mark": "?",
    "semicolon": ";",
    "plus": "+",
    "minus": "-",
    "equals_sign": "=",
    "asterisk": "*",
    "at": "@",
    "percent_sign": "%",
    "enter": "\r",
}


def stops(pilot: ConsolePilot) -> int:
    return sum(isinstance(asked, r.AskStop) for asked in pilot.feed.asked)


def entry(pilot: ConsolePilot) -> Input:
    return pilot.console.screen.query_one("#entry", Input)
