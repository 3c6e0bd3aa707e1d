"""What the robot process says of itself by the way, in German: reasons, names of ours, subjects."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from tests.console import scenes, study_scene
from tests.console.dialogs import open_dialog
from tests.console.piloting import piloted_console
from tests.console.test_replay_console import watching
from woz_tui.cli.console_start import ClosedConsole, farewell
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.screen_language import use, word, worded, worded_data
from woz_tui.console.drawing.glyphs import UNICODE
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.engagement_text import change_reason, forced_by_another
from woz_tui.console.state.replay import updated
from woz_tui.features.questionnaires.dialog import LanguageDialog
from woz_tui.features.repairs.section import LABELS
from woz_tui.features.study.condition_proposal import propose
from woz_tui.features.study.design import Design
from woz_tui.machine.machine_checks import free_space
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import TYPED, TYPED_NAME, ActionView, PanelView
from woz_tui.protocol.requesters import SESSION_ENDED, requester
from woz_tui.protocol.welcome import PerceptionView, StudySettings
from woz_tui.replay.bookmarks import bookmark_of
from woz_tui.sensing.engagement_model import EngagementModel, Transition
from woz_tui.session.redactor import Redactor
from woz_tui.session.typed_actions import LABEL

SECOND = scenes.SECOND


@pytest.fixture(autouse=True)
def german() -> Iterator[None]:
    use("de")
    yield
    use("en")


def came(change: Transition) -> m.EngagementChanged:
    """As a console gets it."""
    told = m.EngagementChanged(
        **{
            name: getattr(change, name)
            for name in m.EngagementChanged.__struct_fields__
            if hasattr(change, name)
        }
    )
    message = codec.decode_message(codec.encode(told))
    assert isinstance(message, m.EngagementChanged)
    return message


def model() -> EngagementModel:
    """Somebody stands before the robot and looks past it."""
    found = EngagementModel(EngagementSettings())
    found.advance(SECOND)
    for _ in range(8):
        found.sample("presence", 1)
        found.sample("gaze", 0)
        found.sample("distance", 0.8)
    return found


def test_reasons_of_the_engagement_model_are_worded() -> None:
    change = model().step()
    assert change is not None
    message = came(change)
    assert message.why == "present, looks away, near 0.8 m, no name"
    assert worded(message).why == "jemand da, schaut weg, nah 0.8 m, ohne Namen"


def test_what_was_moved_by_hand_is_told_with_whose_hand_it_was() -> None:
    people = model()
    people.override("gaze", value=True)
    message = came(people.force("EngagedWithUnknown"))
    assert message.why == "forced by the wizard: present, looks (wizard), near 0.8 m, no name"
    german = "jemand da, schaut her (Versuchsleitung), nah 0.8 m, ohne Namen"
    assert worded(message).why == f"erzwungen (Versuchsleitung): {german}"
    assert change_reason(worded(message)) == german
    assert not forced_by_another(worded(message))
    program = m.ConsoleAttached(console="c2", role="program", name="{greeter}")
    other = came(people.force("Handshake", requester("program", program)))
    assert other.why.startswith("forced by the program {greeter}: ")
    assert change_reason(worded(other)).startswith("erzwungen (Programm {greeter}): jemand da")
    assert forced_by_another(worded(other))
    use("en")
    assert change_reason(message) == "present, looks (wizard), near 0.8 m, no name"
    assert forced_by_another(other)


def test_where_signs_are_hidden_their_code_and_values_are_hidden_too() -> None:
    change = model().step()
    assert change is not None
    redactor = Redactor(StudySettings(perception=PerceptionView(hide=["gaze"])))
    seen = redactor.message(came(change))  # of a log, too, which has them already
    assert seen is not None
    line = codec.encode(seen)
    assert b"0.8" not in line
    assert b"signs." not in line


def test_what_came_before_this_console_is_worded() -> None:
    change = model().step()
    assert change is not None
    line = msgspec.Raw(codec.encode(came(change)).rstrip())
    state = ConsoleState()
    state.apply([msgspec.structs.replace(scenes.welcome(), recent=[line])], 0)
    assert "schaut weg" in state.events[-1].detail


def test_why_a_participant_gets_this_order_is_worded() -> None:
    data = propose("P08", Design(order="latin-square"), ("warm", "cold"), []).data()
    assert data["why"] == "row 1 of 2: least used so far (0 participants)"
    told = worded_data(msgspec.json.decode(msgspec.json.encode(data)))
    assert told["why"] == "Zeile 1 von 2: am seltensten vergeben (bisher 0 Teilnehmer)"


async def test_how_the_order_came_about_is_worded() -> None:
    async with piloted_console(size=(160, 50)) as pilot:
        await pilot.tell(
            m.ConditionsAssigned(
                participant="P08", order=["warm", "cold"], method="latin-square", row=0
            )
        )
        await pilot.until(lambda: "lateinisches Quadrat" in pilot.drawn())


def test_the_disk_is_told_in_german(tmp_path: Path) -> None:
    found = free_space(tmp_path)
    assert word(found.subject) == "Platte"
    assert "GB frei für" in word(found.text)


async def test_why_a_session_ended_is_worded() -> None:
    async with piloted_console(size=(160, 50)) as pilot:
        await pilot.tell(m.TrialEnded(trial=3, outcome="aborted", text=SESSION_ENDED))
        await pilot.tell(m.SessionEnd(reason="abandoned", sha256=""))
        await pilot.until(lambda: "Sitzung beendet" in pilot.drawn())
        assert "verlassen" in pilot.drawn()
        assert "abandoned" not in pilot.drawn()
        assert "die Sitzung endete" in pilot.drawn()


def typed_panel(*labels: str) -> PanelView:
    return PanelView(
        title=TYPED,
        actions=[ActionView(name=f"{TYPED_NAME}{label[:LABEL]}", label=label) for label in labels],
    )


async def test_the_panel_of_typed_sentences_has_a_german_title_and_one_of_a_file_its_own() -> None:
    own = PanelView(title=TYPED, actions=[ActionView(name="Hello", label="Hello", key="h")])
    first = scenes.welcome(shown=[typed_panel("Guten Tag")])
    async with piloted_console(first, size=(100, 140)) as pilot:
        assert "Getippt" in pilot.drawn()
        await open_dialog(pilot, "HelpDialog")
        assert "Getippt" in pilot.drawn()
    async with piloted_console(scenes.welcome(shown=[own])) as pilot:
        assert TYPED in pilot.drawn()


async def test_repairs_have_german_names() -> None:
    repairs = [
        ActionView(name="repair repeat", label="repeat", code="repairs.repeat"),
        ActionView(name="repair odd", label="own", code=""),
    ]
    async with piloted_console(scenes.welcome(settings={"repairs": repairs})) as pilot:
        row = pilot.text("ActionRow")
        assert "erneut" in row
        assert "own" in row
        assert pilot.console.state.label("repair repeat") == "erneut"


async def test_languages_are_called_what_their_readers_call_them() -> None:
    asked = {
        **study_scene.QUICK,
        "language": "en",
        "versions": [{**study_scene.QUICK, "language": "de"}],
    }
    told = study_scene.study_description(questionnaires=[asked])
    async with piloted_console(study_scene.welcome(study=told)) as pilot:
        pilot.console.open_dialog(LanguageDialog("quick", lambda code: None))
        await pilot.until(lambda: "Deutsch" in pilot.drawn())
        assert "English" in pilot.drawn()


def test_places_of_a_replay_are_worded() -> None:
    messages = [
        m.StopPressed(source="key"),
        m.TrialStarted(trial=3, condition="warm"),
        m.BreakStarted(),
        m.BreakStarted(text="tea"),
        m.DriverLost(driver="head"),
        m.SessionEnd(reason="abandoned"),
        m.SessionEnd(reason=""),
        m.Marker(),
        m.Marker(text="look here"),
    ]
    told = r.Replaying(
        t=0,
        length_us=1,
        rate=1.0,
        paused=True,
        marks=[(0, mark.text) for each in messages if (mark := bookmark_of(each, 0)) is not None],
    )
    assert [word(place.text) for place in updated(None, told).places] == [
        "Stopp durch Taste",
        "Durchgang 3 warm",
        "Pause",
        "Pause tea",
        "head verloren",
        "Ende: verlassen",
        "Ende",
        "Marke",
        "look here",
    ]


async def test_what_a_replay_refuses_is_worded() -> None:
    async with watching(size=(100, 36)) as pilot:
        await pilot.press("g", *"zzz", "enter")
        assert "gibt es in diesem Protokoll nicht" in pilot.drawn()


def test_of_whom_a_request_is_is_known_by_a_code() -> None:
    for source in ("key", "program", "replay", "phase", "driver", "participant"):
        assert "requester." in getattr(requester(source), "code", "")
    assert r.Reply(ref=1, ok=True).wording == {}


async def test_all_repairs_stand_in_one_row_of_eighty_columns() -> None:
    repairs = [
        ActionView(name=name, label=str(label), code=label.code, verbs=["say"])
        for name, label in LABELS.items()
    ]
    async with piloted_console(scenes.welcome(settings={"repairs": repairs})) as pilot:
        row = pilot.text("ActionRow")
        assert all(word(label) in row for label in LABELS.values())
        assert UNICODE.ellipsis not in row


def test_what_the_shell_says_behind_a_session_is_german() -> None:
    told = farewell(ClosedConsole("detached", 0, abandon_after=600.0), "attach", Path("P01.jsonl"))
    assert told == [
        "Die Sitzung geht weiter; `woz attach` führt zu ihr zurück.",
        "Ohne Konsole endet sie nach 10 min von selbst"
        " (`session: {abandon_after: 1 h}` in der Versuchsdatei ändert das).",
        "Protokoll: P01.jsonl",
    ]


async def test_what_is_kept_from_the_wizard_is_named_in_german() -> None:
    async with piloted_console(size=(160, 50)) as pilot:
        await pilot.tell(m.PerceptionChanged(hidden=["loudness", "gaze"], blurred=["transcript"]))
        await pilot.until(lambda: "Verborgen: Lautheit, Blick" in pilot.drawn())
        assert "Nur grob gezeigt: Gesprochenes" in pilot.drawn()


def test_words_that_are_kept_are_hidden_in_german_and_a_wizards_own_stay() -> None:
    redactor = Redactor(StudySettings(blind={"warm": "A", "cold": "B"}))
    kept = redactor.message(m.Note(text="it is warm", tells=("condition",)))
    assert isinstance(kept, m.Note)
    state = ConsoleState()
    state.apply([scenes.welcome(), kept, m.Note(text="hidden")], 0)
    assert [event.text for event in list(state.events)[-2:]] == ["verborgen", "hidden"]
