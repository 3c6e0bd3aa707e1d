"""What features, a robot's settings and a replay say in German: all of it, and none of it cut."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from msgspec.structs import replace
from textual.widgets import Input

from tests.console import scenes, study_scene
from tests.console.dialogs import named, open_dialog
from tests.console.piloting import ConsolePilot, piloted_console
from tests.console.robot import pepper
from tests.console.test_replay_console import watching
from tests.features.phases.test_phases_on_screen import at, begins, guide
from tests.features.proposals.test_proposals_on_screen import ON, offered, told
from tests.features.training.test_training_screen import CUE, OVER, RUNS, WAITS
from tools.screen_sentences import sentences
from woz_tui.config.screen_language import use, word
from woz_tui.console.app import Console
from woz_tui.console.replay.commands import COMMANDS
from woz_tui.features.questionnaires.dialog import OfferDialog
from woz_tui.features.training.dialog import BeginDialog, ScoreDialog
from woz_tui.protocol import messages as m

#: Where everything has the least room.
SMALL = (80, 24)
#: The sections of what is drawn here.
SECTIONS = (
    *("study", "phases", "scripts", "profiles", "questionnaires", "training", "slots", "people"),
    *("proposals", "choices", "dictation", "page", "lsl", "blocks", "delay"),
    *("settings", "camera", "replay"),
)
#: Shorter sentences may be words of an experiment, or German, too.
LEAST = 2


@pytest.fixture(autouse=True)
def german() -> Iterator[None]:
    use("de")
    yield
    use("en")


def english_in(drawn: str) -> set[str]:
    """Parts of English sentences of these sections that are on the screen, with their codes."""
    flat = f" {' '.join(drawn.split())} "
    found = set()
    for code, english in sentences().items():
        if code.split(".")[0] not in SECTIONS:
            continue
        for part in re.split(r"\{[^}]*\}", english):
            words = part.strip(" :;,.·").split()
            if len(words) >= LEAST and f" {' '.join(words)} " in flat:
                found.add(f"{code}: {part}")
    return found


def in_dialog(console: Console, drawn: str) -> str:
    """What is drawn of the dialog on top; where there is none, all."""
    for box in console.screen.query(".dialog"):
        place = box.region
        rows = drawn.splitlines()[place.y : place.bottom]
        drawn = "\n".join(row[place.x : place.right] for row in rows)
    return drawn


def is_german(pilot: ConsolePilot, *told: str) -> None:
    """Each of these is on the screen as a whole, and nothing is English in the dialog, if any."""
    drawn = in_dialog(pilot.console, pilot.drawn())
    missing = [text for text in told if text not in drawn]
    assert not missing, drawn
    assert not english_in(drawn), drawn


async def test_trials_and_breaks() -> None:
    async with piloted_console(study_scene.welcome(study_scene.trial()), size=SMALL) as pilot:
        await open_dialog(pilot, "TrialDialog")
        is_german(
            pilot,
            "Durchgang 3 von 4, 02:41",
            "fertig: dieser Durchgang ist zu Ende",
            "abgebrochen: er wird wiederholt",
            "ausgeschlossen: wird nicht ausgewertet",
            "Pause machen",
            "Buchstaben drücken, oder Enter · ctrl+q schließt",
        )
        await pilot.press("z")
        is_german(pilot, "z tut hier nichts; möglich: d a x p")
        await pilot.press("a")
        is_german(pilot, "abgebrochen: er wird wiederholt: Enter tut es · ctrl+q lässt es")


async def test_the_trial_that_runs_is_on_a_small_screen_inside_tmux() -> None:
    """German words are longer: the title gives way to it."""
    first = study_scene.welcome(study_scene.trial())
    async with piloted_console(first, size=SMALL) as pilot:
        await pilot.tell(
            m.ConsoleAttached(console=first.console, role="wizard", line="tmux", t=scenes.NOW),
            m.SessionChanged(condition="empathic", t=scenes.NOW),
        )
        top = pilot.text("StatusLines").splitlines()[0]
        assert "über tmux" in top
        assert "P07 · empathic · Durchgang 3/4 02:41" in top


async def test_between_trials() -> None:
    async with piloted_console(study_scene.welcome(), size=SMALL) as pilot:
        await open_dialog(pilot, "TrialDialog")
        is_german(pilot, "noch kein Durchgang, 4 geplant", "Durchgang 3 beginnen")
        await pilot.press("1")
        await pilot.until(lambda: isinstance(pilot.console.dialog, OfferDialog))
        await pilot.settle()
        is_german(
            pilot,
            "Er bedeckt diesen Bildschirm; ctrl+q bringt die Konsole zurück.",
            "Hier fragen: ich lese vor",
            "Später",
            "Pfeile wählen · Enter · ctrl+q: später",
        )


async def test_the_order_of_conditions() -> None:
    from tests.features.study.test_order_dialog import propose  # noqa: PLC0415

    first = scenes.welcome(
        state=[scenes.start("", "")], settings={"study": study_scene.study_description()}
    )
    async with piloted_console(first, size=SMALL) as pilot:
        propose(pilot)
        await named(pilot)
        drawn = pilot.drawn()
        assert "Vorschlag  ▸ 1. cold" in drawn
        assert "als Nächstes: Durchgang 1 in cold" in drawn
        assert "Reihenfolge (kann geändert werden)" in drawn
        pilot.console.screen.query_one("#order", Input).value = "cold, mild"
        await pilot.press("enter")
        assert "Es gibt keine Bedingung 'mild', nur: warm, cold" in " ".join(pilot.drawn().split())


async def test_phases() -> None:
    async with piloted_console(guide(), size=SMALL) as pilot:
        assert "keine Phase  )  Opening" in pilot.text("StatusLines")
        await at(pilot, begins("opening"))
        assert ") Phase" in pilot.text("StopBar")
        await open_dialog(pilot, "PhasesDialog")
        is_german(pilot, "jetzt; Speech", "geplant 02:00", "Pfeile wählen · Enter beginnt sie")


async def test_profiles() -> None:
    settings: dict[str, m.Json] = {
        "profile": "easy",
        "profiles": ["easy", "all of it"],
        "allows": {"easy": {"panels": ["Speech"], "controls": ["volume"], "hide": True}},
    }
    async with piloted_console(scenes.welcome(settings=settings), size=SMALL) as pilot:
        await open_dialog(pilot, "ProfileDialog")
        is_german(
            pilot,
            "Stopp, Marken und Notizen gelten in jedem.",
            "gilt  easy",
            "Gruppen: Speech; Regler: volume",
            "Pfeile wählen · Enter benutzt es · ctrl+q schließt",
        )


async def test_a_training() -> None:
    async with piloted_console(size=SMALL) as pilot:
        await pilot.tell(WAITS)
        await pilot.until(lambda: isinstance(pilot.console.dialog, BeginDialog))
        await pilot.settle()
        is_german(
            pilot,
            "Eine Person wird simuliert: 20 Anlässe.",
            "Jeden mit der richtigen Taste beantworten. Nichts bewegt sich.",
            "Erst die Tasten ansehen; * beginnt",
        )
        await pilot.tell(RUNS)
        await pilot.press("down", "enter")
        await pilot.until(lambda: "Der erste Anlass kommt bald." in pilot.drawn())
        await pilot.tell(replace(CUE, text="", sort="silence"))
        is_german(pilot, "Die Person schweigt.")
        await pilot.tell(OVER)
        await pilot.until(lambda: isinstance(pilot.console.dialog, ScoreDialog))
        await pilot.settle()
        is_german(
            pilot,
            "60 %: 3 von 5 richtig",
            "falsch 1, verpasst 1, ohne Anlass gedrückt 2",
            "Reaktion im Median 1.24 s",
            "Bleiben und den Bildschirm lesen",
        )


async def test_proposals() -> None:
    async with piloted_console(size=SMALL) as pilot:
        await told(pilot, ON)
        is_german(pilot, "nichts wird vorgeschlagen")
        await told(pilot, offered(1, "It is a whale.", approval=True))
        is_german(pilot, "mcp möchte:", "F9 ändern  ^S nein")


@pytest.mark.parametrize("size", [SMALL, (160, 50)])
async def test_the_settings_of_a_robot(size: tuple[int, int]) -> None:
    first = pepper.welcome(pepper.settings_shown())
    async with piloted_console(first, size=size) as pilot:
        await open_dialog(pilot, "RobotDialog")
        is_german(pilot, "darunter" if size[1] < 50 else "Pfeiltasten dieser Konsole")
        await pilot.press("end")
        is_german(pilot, "Pfeiltasten dieser Konsole", "Drehen, mit alt", "1° bis 360°, um 5°")


async def test_a_replay() -> None:
    async with watching(size=SMALL) as pilot:
        await pilot.press("i")
        about = pilot.drawn()
        for text in ("Dieses Protokoll", "Protokoll     ", "Beginn        ", "Versuch       "):
            assert text in about
        assert "Das Protokoll ist vollständig." in about
        await pilot.press("ctrl+q", "g")
        go_to = in_dialog(pilot.console, pilot.drawn())
        assert "Gehe zu" in go_to
        assert "12:34, oder Buchstaben von Marke" in go_to
        assert "Enter geht dorthin · Pfeile wählen · ctrl+q schließt" in go_to
        assert not english_in(go_to), go_to


def test_the_keys_of_a_replay() -> None:
    keys = {key.id: key.description for command in COMMANDS for key in command.keys}
    assert word(keys["pause"]) == "anhalten, weiterlaufen"
    assert word(keys["step"]) == "zur nächsten Zeile des Protokolls"
    hints = [each.hint.word for each in COMMANDS if each.hint is not None]
    assert [word(hint) for hint in hints if hint in ("keys", "leave")] == ["Tasten", "verlassen"]
