"""What the wizard does not get to see: nowhere on any screen, and with its place kept."""

from __future__ import annotations

from typing import Any

import msgspec
import pytest

from tests.console import bodies, engagement_scene, scenes, study_scene
from tests.console.dialogs import OPENERS, open_dialog
from tests.console.piloting import ConsolePilot, piloted_console
from tests.console.scripted_feed import redacted_welcome
from woz_tui.console.drawing.cells import Cells
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.features.scripts.kinds import ScriptMoved
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.welcome import PerceptionView, StudySettings
from woz_tui.session.redactor import PerceptionFilter, Redactor, dots, perceived_kind

NOW, SECOND = scenes.NOW, scenes.SECOND
EVERYTHING = ["transcript", "distance", "loudness", "presence", "gaze", "identity", "direction"]
EVERYTHING += ["engagement", "joints", "face"]

#: For each thing that can be hidden, what would give it away in the session of `told`.
TRACES = {
    "transcript": ["hello robot", "roman glass", "where is"],
    "distance": ["0.84", "0.8 m", "personal"],
    "loudness": ["-31 dB", " dB"],
    "identity": ["v12", "visitor 12", "introduced"],
    "engagement": ["waits for", "engaged,", "visitor speaks", "attention"],
    "joints": ["14°", "30°", "-6°"],
    "direction": ["77"],
}


def restricted_welcome(hide: list[str], blur: list[str] | None = None, **more: Any) -> r.Welcome:
    """A session with a model, sensors, a talk; some of it is kept from the wizard."""
    study = study_scene.study_description(perception={"hide": hide, "blur": blur or []})
    direction = scenes.reading(NOW, "direction", 77.0, unit="deg")
    return scenes.welcome(
        state=[*scenes.healthy(), *scenes.sensors(), direction, engagement_scene.waits()],
        recent=sorted(
            [*scenes.history(), *engagement_scene.way(), *engagement_scene.talk()],
            key=lambda message: message.t,
        ),
        settings={"study": study},
        shown=[],  # the labels of actions say nothing of sensors
        **more,
    )


def everything(pilot: ConsolePilot) -> str:
    parts = ("StatusLines", "Meters", "BodyPane", "EventList", "StopBar", "OrderPane")
    return pilot.drawn() + "\n" + "\n".join(map(pilot.text, parts))


def readings(asked: r.Request, ref: int) -> r.Reply:
    """The preflight tells the sensors' last values."""
    found: list[m.Json] = [
        {"level": "ok", "subject": subject, "text": text, "remedy": ""}
        for subject, text in (
            ("distance", "0.84 m"),
            ("loudness", "0.028"),
            ("identity", "visitor 12"),
            ("direction", "77 deg"),
            ("head", "3 servos XL330"),
        )
    ]
    return r.Reply(ref=ref, ok=True, data=found)


async def test_without_it_the_traces_are_there() -> None:
    """The search below would find something in a session that has nothing to hide."""
    async with piloted_console(restricted_welcome([]), size=(160, 50)) as pilot:
        shown = everything(pilot)
        await open_dialog(pilot, "EngagementDialog")
        shown += everything(pilot)
        for what, traces in TRACES.items():
            assert any(trace in shown for trace in traces), what


@pytest.mark.parametrize(
    ("role", "size", "hidden"),
    [
        ("wizard", (80, 24), EVERYTHING),
        ("watcher", (160, 50), EVERYTHING),
        *(("wizard", (160, 50), [what]) for what in TRACES),
    ],
)
async def test_what_is_hidden_stands_nowhere(
    role: str, size: tuple[int, int], hidden: list[str]
) -> None:
    async with piloted_console(restricted_welcome(hidden, role=role), size=size) as pilot:
        pilot.feed.answers[r.AskPreflight] = readings
        all_of_them = len(hidden) > 1 and role == "wizard"
        names = OPENERS if all_of_them else ["EngagementDialog", "PreflightDialog"]
        shown = {"main": everything(pilot)}
        for name in names:
            await open_dialog(pilot, name)
            await pilot.settle()
            shown[name] = everything(pilot)
            await pilot.press("ctrl+q")
        for what in set(hidden) & set(TRACES):
            for where, text in shown.items():
                found = [trace for trace in TRACES[what] if trace in text]
                assert not found, (what, where, text)


@pytest.mark.parametrize("what", ["distance", "loudness", "direction"])
async def test_its_place_stays_with_a_quiet_word(what: str) -> None:
    async with piloted_console(restricted_welcome([what]), size=(160, 50)) as pilot:
        assert "hidden" in pilot.text("Meters")
        before = pilot.text("Meters")
        await pilot.tell(
            scenes.reading(NOW + SECOND, "distance", 3.1, unit="m"),
            scenes.reading(NOW + SECOND, "loudness", 0.5),
            scenes.reading(NOW + SECOND, "identity", None, text="visitor 13"),
            scenes.reading(NOW + SECOND, "direction", 12.0, unit="deg"),
        )
        lines = zip(before.splitlines(), pilot.text("Meters").splitlines(), strict=True)
        hidden = [pair for pair in lines if "hidden" in pair[0]]
        assert hidden
        assert all(was == now for was, now in hidden)


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_no_word_is_as_faint_as_a_line(size: tuple[int, int]) -> None:
    moved = ScriptMoved(position=2, played=[0, 1], t=NOW)
    for hidden in ([*TRACES], []):
        async with piloted_console(restricted_welcome(hidden, role="wizard"), size=size) as pilot:
            await pilot.tell(moved)
            for widget in pilot.console.screen.query(Cells):
                words = [text for row in widget.rows for text, look in row if look == "faint"]
                assert not [text for text in words if any(map(str.isalpha, text))], widget


async def test_nothing_tells_how_old_something_hidden_is() -> None:
    async with piloted_console(
        restricted_welcome(["distance", "loudness"]), size=(160, 50)
    ) as pilot:
        await pilot.pass_time(30)
        rows = [row for row in pilot.text("Meters").splitlines() if "hidden" in row]
        assert len(rows) >= 2
        assert not any("old" in row for row in rows)


async def test_blurred_figures_are_words() -> None:
    async with piloted_console(
        restricted_welcome([], ["distance", "loudness", "transcript"]), size=(160, 50)
    ) as pilot:
        shown = everything(pilot)
        for what in ("distance", "loudness", "transcript"):
            assert not [trace for trace in TRACES[what] if trace in shown], what
        rows = {row.split()[0]: row for row in pilot.text("Meters").splitlines() if row.strip()}
        assert "near" in rows["distance"]
        assert "loud" in rows["loudness"].replace("loudness", "")
        assert "“● ●”" in shown
        await pilot.tell(
            scenes.reading(NOW + SECOND, "distance", 3.1, unit="m"),
            scenes.reading(NOW + SECOND, "loudness", 0.001),
        )
        rows = {row.split()[0]: row for row in pilot.text("Meters").splitlines() if row.strip()}
        assert "far" in rows["distance"]
        assert "quiet" in rows["loudness"]
        await open_dialog(pilot, "EngagementDialog")
        assert "0.84" not in pilot.drawn()


async def test_a_hidden_face_is_not_drawn_and_keeps_its_place() -> None:
    study = StudySettings(perception=PerceptionView(hide=["face", "joints"]))
    welcome = bodies.welcome(bodies.alive())
    kept = msgspec.structs.replace(
        welcome, settings=msgspec.structs.replace(welcome.settings, study=study)
    )
    async with piloted_console(welcome, size=(160, 50)) as pilot:
        seen = pilot.text("BodyPane").splitlines()
    async with piloted_console(kept, size=(160, 50)) as pilot:
        hidden = pilot.text("BodyPane").splitlines()
        assert "hidden" in "".join(hidden)
        assert len(hidden) == len(seen)
        emotion = next(row for row in seen if " face " in row).split(" face ")[1].split()[0]
        assert emotion not in "".join(hidden)


async def test_it_may_change_while_the_session_runs() -> None:
    async with piloted_console(restricted_welcome([]), size=(160, 50)) as pilot:
        assert "roman glass" in pilot.text("EventList")
        everything_kept = m.PerceptionChanged(hidden=EVERYTHING, blurred=[], t=NOW + 1)
        await pilot.tell(everything_kept)
        shown = everything(pilot)
        for what, traces in TRACES.items():
            assert not [trace for trace in traces if trace in shown], what
        assert "Hidden: " in pilot.text("EventList")


def redactor_hiding(*what: str) -> Redactor:
    return Redactor(StudySettings(perception=PerceptionView(hide=[*what])))


# -- message by message ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("sensor", "kind"),
    [
        ("distance", "distance"),
        ("left.distance", "distance"),
        ("loudness.threshold", "loudness"),
        ("joint.head.yaw", "joints"),
        ("left.setpoint.pan", "joints"),
        ("joint.head.direction", "joints"),
        ("direction.azimuth", "direction"),
        ("battery", ""),
        ("left.speech", "transcript"),
    ],
)
def test_what_a_sensor_tells(sensor: str, kind: str) -> None:
    assert perceived_kind(sensor) == kind


def test_who_is_addressed_is_kept_with_who_is_there() -> None:
    addressed = m.AddressedChanged(driver="eye", face=2)
    assert redactor_hiding("presence").message(addressed) is None
    assert redactor_hiding("distance").message(addressed) is addressed


def test_the_words_of_a_blurred_text_are_left_out() -> None:
    word = m.SpokenWord(text="roman", began=1, ended=2)
    text = m.SpeechText(driver="ears", segment=1, text="roman glass", words=[word], t=NOW)
    blurred = PerceptionView(blur=["transcript"])
    told = Redactor(StudySettings(perception=blurred)).message(text)
    assert isinstance(told, m.SpeechText)
    assert (told.text, told.words) == ("●", [])
    assert Redactor().message(text) is text


@pytest.mark.parametrize(
    ("text", "shown"),
    [("", ""), ("yes", "●"), ("a b c", "●"), ("a b c d", "● ●"), ("w " * 11, "● ● ●")],
)
def test_how_long_an_utterance_is(text: str, shown: str) -> None:
    assert dots(text) == shown


def test_a_reason_that_may_tell_a_sign_is_left_out() -> None:
    changed = engagement_scene.way()[1]
    told = redactor_hiding("distance").message(changed)
    assert isinstance(told, m.EngagementChanged)
    assert told.why == ""
    assert "distance" not in told.verdicts
    assert redactor_hiding("joints").message(changed) is changed


def test_an_effect_of_a_hidden_state_has_no_name_that_tells_it() -> None:
    told = redactor_hiding("engagement").message(
        m.ActionFailed(run="a1", action="on RobotThinks", reason="x", t=NOW)
    )
    assert isinstance(told, m.ActionFailed)
    assert told.action == "on engagement"
    other = m.ActionFailed(run="a1", action="on the way", reason="x", t=NOW)
    assert redactor_hiding("engagement").message(other) is other


def test_a_notice_that_tells_what_is_kept_has_no_words() -> None:
    room = m.Notice(
        level="warning",
        text="microphone: it was not quiet: 0.0321 at the loudest",
        remedy="threshold: 0.0321 keeps it",
        driver="microphone",
        tells=("loudness",),
        t=NOW,
    )
    told = redactor_hiding("loudness").message(room)
    assert isinstance(told, m.Notice)
    assert told.text.startswith("microphone: ")
    assert not any(sign.isdecimal() for sign in told.text + told.remedy)
    disk = m.Notice(level="warning", text="distance to the disk: 12 MB", t=NOW)
    assert redactor_hiding("loudness", "distance").message(disk) is disk
    assert redactor_hiding("gaze").message(room) is room


def test_a_hidden_model_asks_the_wizard_nothing() -> None:
    handshake = m.Notice(level="info", text="who is it?", tells=("engagement",), t=NOW)
    assert redactor_hiding("engagement").message(handshake) is None
    assert redactor_hiding("gaze").message(handshake) is handshake
    failed = m.Notice(level="error", text="engagement: it failed", t=NOW)
    assert redactor_hiding("engagement").message(failed) is failed


def test_the_checks_of_the_robot_tell_no_value() -> None:
    checked = m.PreflightChecked(check="distance", level="ok", detail="0.84 m", source="robot")
    told = redactor_hiding("distance").message(checked)
    assert isinstance(told, m.PreflightChecked)
    assert told.detail == "gives values"


def test_what_nobody_knows_cannot_be_hidden() -> None:
    assert not PerceptionFilter(["tea"], ["cake"])
    assert PerceptionFilter(["distance"], ["distance"]).blurred == frozenset()


def test_a_picture_never_holds_what_is_hidden() -> None:
    state = ConsoleState()
    state.apply([redacted_welcome(restricted_welcome(EVERYTHING))], 0)
    assert state.session.model.changed is None
    assert state.session.model.shown is None
    assert not state.session.faces
    assert {each.value for each in map(state.sensor, state.sensors) if each} == {None}


async def test_hidden_signs_of_the_model_have_no_verdict() -> None:
    async with piloted_console(restricted_welcome(["presence", "gaze"]), size=(160, 50)) as pilot:
        rows = [row for row in pilot.text("Meters").splitlines() if "hidden" in row]
        assert {row.split()[0] for row in rows} >= {"person", "looks"}
        await open_dialog(pilot, "EngagementDialog")
        drawn = pilot.drawn()
        assert "presence hidden AND gaze hidden" in drawn
        assert "5 of 8" not in drawn
