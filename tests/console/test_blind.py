"""Condition-blind: no screen, dialog or sentence tells which condition it is."""

from __future__ import annotations

from typing import Any

import msgspec
import pytest

from tests.console import study_scene
from tests.console.dialogs import OPENERS, open_dialog
from tests.console.piloting import ConsolePilot, piloted_console
from tests.console.scripted_feed import Answer, redacted_welcome
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.features.study.kinds import AskAssign, AskProposal
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.protocol.welcome import StudySettings
from woz_tui.session.redactor import Redactor

pytestmark = pytest.mark.safety

NOW = study_scene.NOW
#: What must not stand anywhere: the conditions, and what only one of them has the robot say.
SECRETS = ("warm", "cold", "How lovely", "Good day")
OVERLOADED = "the voice cannot say 'Good day.' in the cold condition"


def panels() -> list[PanelView]:
    """Utterances whose words depend on the condition."""
    texts = {"g": "{greeting}", "c": "This is {condition}, {participant}."}
    actions = [
        ActionView(name=f"say {key}", label=f"Say {key}", key=key, verbs=["say"], utterances=[text])
        for key, text in texts.items()
    ]
    return [PanelView(title="Speech", actions=actions)]


def blind_messages() -> list[m.Message]:
    """A robot process that tells everything it knows."""
    return [
        m.SessionChanged(condition="cold", trial=3, t=NOW),
        study_scene.trial(),
        m.Notice(
            level="info",
            text="the condition is cold now",
            remedy="warm is over",
            t=NOW,
            tells=("condition",),
        ),
        m.Note(text="cold seems to work", t=NOW, tells=("condition",)),
        m.Marker(text="preflight: warm", t=NOW, tells=("condition",)),
        m.ActionRequested(run="a1", action="say g", source="key", t=NOW),
        m.Command(
            command="c1",
            verb="say",
            args={"text": "Good day."},
            source="key",
            t=NOW,
            tells=("condition",),
            unfilled={"text": "{greeting}"},
        ),
        m.Failed(
            command="c1",
            driver="voice",
            reason=OVERLOADED,
            remedy="try warm",
            t=NOW,
            tells=("condition",),
        ),
        m.ActionFailed(run="a1", action="say g", reason=OVERLOADED, t=NOW, tells=("condition",)),
        m.ExperimentReloaded(
            experiment_sha256="0" * 64,
            changes=["conditions: warm, cold, none"],
            t=NOW,
            telling=["conditions: warm, cold, none"],
        ),
        m.TrialEnded(
            trial=3, outcome="aborted", text="cold was too cold", t=NOW, tells=("condition",)
        ),
        study_scene.trial(4),
    ]


def welcome(**more: Any) -> r.Welcome:
    values: dict[str, m.Json] = {"condition": "cold", "greeting": "Good day.", "participant": "P07"}
    told = study_scene.welcome(
        *blind_messages(),
        study=study_scene.study_description(blind=study_scene.LABELS),
        settings={"values": values},
        recent=blind_messages(),
        shown=panels(),
        **more,
    )
    told.script[:] = ["say g", "say c"]
    return told


def answering(reply: r.Reply) -> Answer:
    return lambda asked, ref: msgspec.structs.replace(reply, ref=ref)


def robot_that_tells(pilot: ConsolePilot) -> None:
    """Every reply has the true conditions in it."""
    proposal: m.Json = {"order": ["cold", "warm"], "why": "row 1", "condition": "cold"}
    finding: m.Json = [
        {"level": "warning", "subject": "experiment", "text": "line 3, greeting.warm: odd"}
    ]
    told: dict[type, r.Reply] = {
        AskProposal: r.Reply(ref=0, ok=True, data=proposal),
        r.AskPreflight: r.Reply(ref=0, ok=True, data=finding),
    }
    for kind, reply in told.items():
        pilot.feed.answers[kind] = answering(reply)


def assert_blind(pilot: ConsolePilot, where: str) -> None:
    screens = pilot.console.screen_stack
    drawn = pilot.drawn() + "".join(
        pilot.text(name)
        for name in ("StatusLines", "ActionPanels", "Meters", "EventList", "StopBar", "OrderPane")
    )
    assert screens
    for secret in SECRETS:
        assert secret.casefold() not in drawn.casefold(), (where, secret)


@pytest.mark.parametrize(("role", "size"), [("wizard", (80, 24)), ("watcher", (160, 50))])
async def test_no_screen_and_no_dialog_tells_the_condition(
    role: str, size: tuple[int, int]
) -> None:
    async with piloted_console(welcome(role=role), size=size) as pilot:
        robot_that_tells(pilot)
        assert "Orange" in pilot.text("StatusLines")
        assert_blind(pilot, "main screen")
        for name in OPENERS:
            await open_dialog(pilot, name)
            await pilot.settle()
            assert_blind(pilot, name)
            await pilot.press("ctrl+q")
        assert "{greeting}" in pilot.text("OrderPane") or size == (80, 24)
        await pilot.press("colon")
        await pilot.type("greet")
        assert_blind(pilot, "find")


async def test_the_wizard_chooses_among_labels() -> None:
    async with piloted_console(welcome()) as pilot:
        robot_that_tells(pilot)
        await open_dialog(pilot, "StartDialog")
        assert "1. Orange" in pilot.drawn()
        await pilot.press("enter")
        asked = pilot.feed.last(AskAssign)
        assert isinstance(asked, AskAssign)
        assert asked.order == ["Orange", "Lemon"]


async def test_without_a_design_a_label_stands_for_its_condition() -> None:
    study = study_scene.study_description(blind=study_scene.LABELS, design=None)
    async with piloted_console(study_scene.welcome(study=study)) as pilot:
        await open_dialog(pilot, "StartDialog")
        assert "Lemon" in pilot.drawn()
        await pilot.press("enter")
        asked = pilot.feed.last(r.AskSet)
        assert isinstance(asked, r.AskSet)
        assert asked.condition == "Lemon"


async def test_a_reload_that_blinds_the_wizard_counts_at_once() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        panels_changed = r.PanelsChanged(
            title="Museum guide",
            panels=panels(),
            script=[],
            verbs={},
            conditions=["warm", "cold"],
            keyboard="us",
            study=study_scene.study_settings(
                study_scene.study_description(blind=study_scene.LABELS)
            ),
        )
        await pilot.tell(panels_changed, m.SessionChanged(condition="cold", t=NOW))
        assert "Orange" in pilot.text("StatusLines")
        assert pilot.console.state.plan.conditions == ["Lemon", "Orange"]
        assert pilot.console.state.session.study.order == ["Lemon", "Orange"]


def blind(labels: dict[str, str] = study_scene.LABELS, **more: Any) -> Redactor:
    return Redactor(StudySettings(blind=labels, **more))


def test_what_depends_on_the_condition_is_shown_as_its_variable() -> None:
    command = m.Command(
        command="c1",
        verb="say",
        args={"text": "Good day, P07", "volume": 3},
        source="key",
        tells=("condition",),
        unfilled={"text": "{greeting}, P07"},
    )
    shown = blind().message(command)
    assert isinstance(shown, m.Command)
    assert shown.args == {"text": "{greeting}, P07", "volume": 3}
    assert Redactor().message(command) is command


def test_the_condition_behind_a_label_is_known_to_the_robot_process_alone() -> None:
    redactor = blind()
    assert redactor.label("unheard of") == "?"
    assert redactor.label("") == ""
    asked = redactor.request(AskAssign(participant="P07", order=["Orange", "Plum"]))
    assert isinstance(asked, AskAssign)
    assert asked.order == ["cold", "Plum"]


def test_one_label_for_all_still_lets_the_wizard_choose() -> None:
    redactor = blind({"warm": "hidden", "cold": "hidden"})
    assert redactor.labels(["warm", "cold"]) == ["hidden", "hidden (2)"]
    asked = redactor.request(r.AskSet(condition="hidden (2)"))
    assert isinstance(asked, r.AskSet)
    assert asked.condition == "cold"


def test_what_a_robot_shows_of_what_it_was_given_is_hidden() -> None:
    redactor = blind()
    redactor.apply(
        m.Command(
            command="c1",
            verb="screen",
            args={"file": "pictures/otter.png"},
            source="key",
            tells=("condition",),
            unfilled={"file": "{picture}"},
        )
    )
    values: dict[str, m.Json] = {"tablet": "http://10.0.0.1/otter.png", "state": "interactive"}
    shown = redactor.message(m.SettingsShown(driver="pepper", values=values))
    assert isinstance(shown, m.SettingsShown)
    assert shown.values == {"tablet": "hidden", "state": "interactive"}


def test_nothing_is_changed_where_nobody_is_blind() -> None:
    message = m.Notice(level="info", text="cold", t=NOW, tells=("condition",))
    assert Redactor().message(message) is message
    assert not Redactor(StudySettings())


def test_names_of_actions_stay_what_they_are() -> None:
    requested = m.ActionRequested(run="a1", action="cold water", source="key", t=NOW)
    assert blind().message(requested) is requested


async def test_a_program_that_sees_all_is_named_as_long_as_it_is_there() -> None:
    attached = m.ConsoleAttached(console="con2", role="program", name="stimulus", sees="all", t=NOW)
    async with piloted_console(welcome(), size=(160, 50)) as pilot:
        await pilot.tell(attached)
        assert "stimulus sees all" in pilot.text("StatusLines")
        assert "program stimulus attached" in pilot.text("EventList")
        await pilot.tell(m.ConsoleLost(console="con2", role="program", why="closed", t=NOW))
        assert "sees all" not in pilot.text("StatusLines")
    async with piloted_console(study_scene.welcome(), size=(160, 50)) as pilot:
        await pilot.tell(attached)
        assert "sees all" not in pilot.text("StatusLines"), "nothing is kept from this wizard"


def test_an_utterance_shows_the_variable_and_not_its_value() -> None:
    state = ConsoleState()
    state.apply([redacted_welcome(welcome())], 0)
    assert state.filled("{greeting} {condition} {participant}") == "{greeting} {condition} P07"
