from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.rig import ScriptedDriver, SessionRig, action, call, experiment, together
from woz_tui.config import utterance_template
from woz_tui.config.file_position import FilePosition, Problem
from woz_tui.config.screen_language import use, word
from woz_tui.drivers.contract import (
    DeviceLostError,
    Finding,
    Job,
    Offer,
    RejectedError,
    Scope,
)
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.action_texts import utterances
from woz_tui.session.participant_identity import SessionIdentity, check_participant
from woz_tui.session.preflight import preflight
from woz_tui.session.variables import VariableValues

KEY = RequestOrigin("key", "h", "con1")
#: What `re` compares with sixteen letters for hours.
ENDLESS = "(?:(?:A|A)+(?:A|A|A|A)*(?:A|A|A|A)*)+1"


def on_stage(
    tmp_path: Path,
    scenario: Callable[[SessionRig], Awaitable[None]],
    drivers: tuple[str, ...] = ("robot",),
    identity: SessionIdentity | None = None,
) -> SessionRig:
    return SessionRig(tmp_path, drivers, identity).run(scenario, 5)


def test_a_press_becomes_commands_with_variables_filled_in(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assert rig.session.play("Hello", KEY) == "a00001"

    rig = on_stage(tmp_path, scenario)
    assert rig.driver().calls[0] == ("say", {"text": "Hello P07"})
    (command,) = rig.of(m.Command)
    assert (command.run, command.action, command.key) == ("a00001", "Hello", "h")
    assert rig.kinds(m.ActionRequested, m.ActionEnd) == ["ActionRequested", "ActionDone"]


def test_an_action_that_was_not_played_says_why_in_words_for_the_wizard(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        for _ in range(17):  # a second each
            rig.session.play("Hello", KEY, "queue")
        with pytest.raises(RequestError, match="queue full") as full:  # the seventeenth that waits
            rig.session.play("Hello", KEY, "queue")
        assert (full.value.hint, full.value.command) == ("empty the queue, or wait", "queue_empty")
        await asyncio.sleep(15)
        rig.session.play("Hello", KEY, "queue")
        rig.session.play("Welcome", KEY, "replace")

    rig = on_stage(tmp_path, scenario)
    refused = [end.reason for end in rig.of(m.ActionRefused)]
    assert refused[0] == "queue full (16): not played"
    assert set(refused[1:]) == {"not said: robot was busy for 10 s"}
    (stopped,) = [end.reason for end in rig.of(m.ActionSuperseded)]
    assert stopped == 'replaced by "Welcome"'


def test_together_and_steps_in_order_with_a_pause(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Welcome", KEY)
        await asyncio.sleep(3)
        rig.session.play("Map", KEY)

    rig = on_stage(tmp_path, scenario)
    times = [line.t for line in rig.of(m.Dispatched)]
    assert times[0] == times[1]
    map_said, pointed, marked = times[2:]
    assert pointed - map_said == pytest.approx(1_500_000, abs=100)
    assert pointed == marked
    assert [line.text for line in rig.of(m.Marker)] == ["map"]


def test_a_failed_step_ends_the_action_and_names_the_reason(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Fall", KEY)

    rig = on_stage(tmp_path, scenario)
    (end,) = rig.of(m.ActionEnd)
    assert isinstance(end, m.ActionFailed)
    assert end.reason == "robot: it fell over"
    assert ("say", {"text": "Ouch"}) not in rig.driver().calls


@pytest.mark.parametrize(
    ("name", "reason", "hint", "command"),
    [
        ("Nope", "there is no action 'Nope'", "", ""),
        ("Never", "'Never' is locked", "the experiment file locks it", ""),
        ("Go", "the panel 'Base' is locked", "find 'Unlock Base'", "find"),
        (
            *("Hello", "{participant} has no value yet"),
            *("choose participant and condition", "start"),
        ),
    ],
)
def test_refusals_are_said_and_logged(
    tmp_path: Path, name: str, reason: str, hint: str, command: str
) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.lock("Base", True)
        with pytest.raises(RequestError) as caught:
            rig.session.play(name, KEY)
        error = caught.value
        assert (error.reason, error.hint, error.command) == (reason, hint, command)

    rig = on_stage(tmp_path, scenario, identity=SessionIdentity())
    assert rig.kinds(m.ActionRequested, m.ActionEnd) == ["ActionRequested", "ActionRefused"]
    assert not [call for call in rig.driver().calls if call[0] == "say"]


class LimpDriver(ScriptedDriver):
    """Speaks; its motors are off, which it finds out when it shall move."""

    async def perform(self, job: Job) -> Mapping[str, Json]:
        if job.verb == "play":
            raise RejectedError("the motors are off", "switch them on")
        return await super().perform(job)


def test_an_action_of_which_a_part_was_said_has_failed_and_was_not_refused(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Welcome", KEY)  # says something and nods
        await asyncio.sleep(2)
        rig.session.play("Nod", KEY)

    made = experiment(tmp_path)
    nod = action("Nod", together(call("play", move="nod")))
    panel = replace(made.panels[0], actions=(*made.panels[0].actions, nod))
    made = replace(made, panels=(panel, *made.panels[1:]))
    rig = SessionRig(tmp_path, catalogue={"puppet": LimpDriver}, made=made).run(scenario, 5)
    assert ("say", {"text": "Welcome"}) in rig.driver().calls
    ends = [(end.action, type(end).__name__, end.reason) for end in rig.of(m.ActionEnd)]
    assert ends == [
        ("Welcome", "ActionFailed", "robot: the motors are off"),
        ("Nod", "ActionRefused", "robot: the motors are off"),
    ]


def test_the_stop_ends_runs_in_a_command_and_runs_in_a_pause(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Map", KEY)
        await asyncio.sleep(1.2)  # in its pause
        rig.session.play("Hello", KEY)
        await asyncio.sleep(0.1)
        rig.session.stop("key")
        with pytest.raises(RequestError):
            rig.session.play("Hello", KEY)
        await asyncio.sleep(3)
        rig.session.release("key")
        rig.session.play("Welcome", KEY)

    rig = on_stage(tmp_path, scenario)
    ends = [(line.run, type(line).__name__) for line in rig.of(m.ActionEnd)]
    assert sorted(ends) == [
        ("a00001", "ActionStopped"),
        ("a00002", "ActionStopped"),
        ("a00003", "ActionRefused"),
        ("a00004", "ActionDone"),
    ]
    assert ("play", {"move": "point"}) not in rig.driver().calls


def test_set_checks_everything_before_it_sets_anything(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        for participant, condition in (
            ("Anna", None),
            ("P1", None),
            ("P08", "hot"),
            ("../x", None),
        ):
            with pytest.raises(RequestError):
                rig.session.set(participant, condition)
        assert rig.session.identity.participant == "P07"
        rig.session.set("P08", "cold", 2)

    rig = on_stage(tmp_path, scenario)
    assert rig.session.values()["participant"] == "P08"
    assert rig.kinds(m.SessionChanged) == ["SessionChanged"]


def test_verbs_of_the_session_are_commands_like_others(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Cold", KEY)
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        assert rig.session.identity.condition == "cold"
        rig.session.play("Hot", KEY)

    rig = on_stage(tmp_path, scenario)
    refused = rig.of(m.ActionRefused)
    assert refused[0].reason == "session: there is no condition 'hot'"


def test_a_verb_needs_a_driver_that_offers_it(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        with pytest.raises(RequestError, match=r"offered by left\.robot and right\.robot"):
            rig.session.send("say", {"text": "x"}, "", KEY)
        with pytest.raises(RequestError, match="no driver offers 'sing'"):
            rig.session.send("sing", {}, "", KEY)
        rig.session.send("say", {"text": "hi"}, "left", KEY)

    rig = on_stage(tmp_path, scenario, drivers=("left.robot", "right.robot"))
    assert rig.driver("left.robot").calls[0] == ("say", {"text": "hi"})


def test_a_driver_that_cannot_open_fails_alone(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Cold", KEY)
        findings = {finding.subject: finding for finding in await preflight(rig.session)}
        assert findings["broken"].level == "error"
        assert "no such device" in findings["broken"].text
        assert findings["robot"].level == "ok"

    on_stage(tmp_path, scenario, drivers=("robot", "broken"))


def test_the_preflight_says_in_german_who_and_what_is_not_chosen(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.experiment = replace(rig.session.experiment, conditions=("warm", "cold"))
        said = []
        for participant, condition in (("", ""), ("P07", ""), ("", "warm")):
            rig.session.identity = SessionIdentity(
                session="S01", participant=participant, condition=condition
            )
            said += [one.text for one in await preflight(rig.session) if one.subject == "session"]
        assert said == [
            "no participant and no condition set",
            "no condition set",
            "no participant set",
        ]
        use("de")
        assert [word(text) for text in said] == [
            "weder Teilnehmer noch Bedingung gesetzt",
            "keine Bedingung gesetzt",
            "kein Teilnehmer gesetzt",
        ]

    try:
        on_stage(tmp_path, scenario)
    finally:
        use("en")


def test_the_preflight_tells_what_is_odd_in_the_file(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assert "experiment" not in {one.subject for one in await preflight(rig.session)}
        odd = [
            Problem(
                FilePosition("made.yaml", line, 1),
                "panels[0]",
                "p plays Plan instead",
                warning=True,
            )
            for line in (7, 9)
        ]
        rig.session.experiment = replace(rig.session.experiment, warnings=tuple(odd))
        findings = {finding.subject: finding for finding in await preflight(rig.session)}
        assert findings["experiment"] == Finding(
            "warning",
            "experiment",
            "line 7, panels[0]: p plays Plan instead; and 1 more",
            "woz check made.yaml",
        )

    on_stage(tmp_path, scenario)


def test_the_preflight_warns_of_a_robot_that_cannot_move(tmp_path: Path) -> None:
    off = "the motors are off: nothing moves until the robot is woken up"

    async def scenario(rig: SessionRig) -> None:
        rig.session.hub.publish(m.SettingsShown(driver="robot", values={}, conflicts=[off]))
        findings = [one for one in await preflight(rig.session) if one.subject == "robot"]
        assert findings == [Finding("warning", "robot", off)]

    on_stage(tmp_path, scenario)


#: Sensor -> its value, the unit, and what a wizard reads.
VALUES_IN_WORDS = {
    "presence": (0.0, "", "nobody"),
    "gaze": (1.0, "", "looking"),
    "loudness": (0.0076, "", "-42 dB"),
    "people": (0.0, "", "nobody"),
    "battery": (0.874, "", "87 %"),
    "distance": (5.0, "m", "5.00 m"),
    "temperature": (41.5, "C", "41.5 C"),
    "fallen": (0.0, "", "no"),
    "bumper": (1.0, "", "pressed"),
}


def test_the_preflight_says_in_words_what_sensors_say_in_numbers(tmp_path: Path) -> None:
    made = experiment(tmp_path)
    spec = replace(made.drivers[0], offer=Offer(sensors=tuple(VALUES_IN_WORDS)))
    said: dict[str, str] = {}

    async def scenario(rig: SessionRig) -> None:
        context = rig.driver().context
        for name, (value, unit, _) in VALUES_IN_WORDS.items():
            context.reading(name, value, unit=unit)
        said.update((one.subject, one.text) for one in await preflight(rig.session))

    SessionRig(tmp_path, made=replace(made, drivers=(spec,))).run(scenario)
    assert {name: said[name] for name in VALUES_IN_WORDS} == {
        name: words for name, (_, _, words) in VALUES_IN_WORDS.items()
    }
    use("de")
    try:
        assert [word(said[name]) for name in ("presence", "gaze", "people", "stop")] == [
            *("niemand", "schaut her", "niemand", "gelöst"),
        ]
    finally:
        use("en")


def test_the_preflight_knows_seldom_sensors_and_those_of_events(tmp_path: Path) -> None:
    made = experiment(tmp_path)
    spec = replace(
        made.drivers[0],
        offer=Offer(sensors=("distance", "battery", "mood", "prepared", "direction")),
    )

    findings: dict[str, Finding] = {}

    async def scenario(rig: SessionRig) -> None:
        context = rig.driver().context
        context.sensor("battery", "ok", every=10.0)
        context.reading("battery", 0.8)
        context.reading("distance", 1.2)
        context.reading("prepared", None, text="12 of 12")
        await asyncio.sleep(5)
        context.reading("mood", None, text="calm")
        findings.update((finding.subject, finding) for finding in await preflight(rig.session))

    SessionRig(tmp_path, made=replace(made, drivers=(spec,))).run(scenario)
    assert findings["battery"].level == findings["mood"].level == "ok"
    assert findings["mood"].text == "calm"
    assert findings["distance"].level == "warning"
    assert not findings.keys() & {"prepared", "direction"}


def test_the_end_rests_closes_and_signs_the_log(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Map", KEY)
        await asyncio.sleep(0.1)

    rig = on_stage(tmp_path, scenario)
    assert [verb for verb, _ in rig.driver().calls][-2:] == ["rest", "close"]
    lines = [json.loads(line) for line in rig.recorder.path.read_text().splitlines()]
    assert lines[0]["kind"] == "session.start"
    assert lines[-1]["kind"] == "session.end"
    assert len(lines[-1]["sha256"]) == 64
    with pytest.raises(RequestError, match="ending"):
        rig.session.play("Hello", KEY)


class SlowDriver(ScriptedDriver):
    """Takes its time for everything."""

    async def perform(self, job: Job) -> Mapping[str, m.Json]:
        try:
            return await super().perform(job)
        except asyncio.CancelledError:
            await asyncio.sleep(0.3)
            raise

    async def stop(self, scope: Scope) -> None:
        await asyncio.sleep(0.2)

    async def rest(self) -> None:
        await asyncio.sleep(1.0)

    async def close(self) -> None:
        await asyncio.sleep(0.5)


@pytest.mark.parametrize("at", [0.0, 0.1, 0.25, 0.5, 1.0, 1.25, 1.29, 1.31, 1.5, 1.75, 1.79])
def test_a_stop_at_any_moment_of_the_end_is_confirmed_in_the_log(tmp_path: Path, at: float) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(0.1)
        closing = asyncio.create_task(rig.session.close("test"))
        await asyncio.sleep(at)
        rig.session.stop("key")
        await asyncio.sleep(0.15)
        rig.session.stop("key")  # a second press joins the first
        await closing

    rig = SessionRig(tmp_path, catalogue={"puppet": SlowDriver}).run(scenario)
    kinds = [json.loads(line)["kind"] for line in rig.recorder.path.read_text().splitlines()]
    stops = [kind for kind in kinds if kind.startswith("stop.")]
    assert stops == ["stop.pressed", "stop.confirmed"] * (len(stops) // 2)
    assert stops
    assert kinds[-1] == "session.end"


def test_a_driver_that_has_closed_confirms_no_stop(tmp_path: Path) -> None:
    class Closing(SlowDriver):
        async def close(self) -> None:
            if self.name == "robot":
                await super().close()

    async def scenario(rig: SessionRig) -> None:
        closing = asyncio.create_task(rig.session.close("test", rest=False))
        await asyncio.sleep(0.1)
        rig.session.stop("key")
        await closing

    rig = SessionRig(tmp_path, ("robot", "head"), catalogue={"puppet": Closing}).run(scenario)
    (stop_confirmed,) = rig.of(m.StopConfirmed)
    assert (stop_confirmed.confirmed, stop_confirmed.unreached) == (["robot"], ["head"])


def test_a_driver_that_cannot_rest_says_why_in_its_own_words(tmp_path: Path) -> None:
    class Gone(ScriptedDriver):
        async def rest(self) -> None:
            raise DeviceLostError("the cable is out")

    async def scenario(rig: SessionRig) -> None:
        await rig.session.close("test")

    rig = SessionRig(tmp_path, catalogue={"puppet": Gone}).run(scenario)
    notices = [line.text for line in rig.of(m.Notice)]
    assert "robot: rest failed: the cable is out" in notices


def test_the_stop_is_not_released_any_more_while_the_session_ends(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.stop("key")
        await rig.session.close("test")
        with pytest.raises(RequestError, match="ending"):
            rig.session.release("key")

    on_stage(tmp_path, scenario)


def test_a_newcomer_is_told_what_still_holds(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        session.play("Hello", KEY)
        await asyncio.sleep(2)
        session.play("Map", KEY)
        session.set("P08")
        session.set(condition="cold")
        session.stop("key")
        await asyncio.sleep(1)
        session.release("key")
        session.play("Map", KEY)
        await asyncio.sleep(0)
        kinds = [type(line).__name__ for line in session.state.messages()]
        assert kinds.count("SessionStart") == 1
        assert kinds.count("DriverConnected") == 1
        assert "StopPressed" not in kinds
        held = [line for line in session.state.messages() if isinstance(line, m.SessionChanged)]
        assert [(line.participant, line.condition) for line in held] == [
            ("P08", None),
            (None, "cold"),
        ]
        runs = [
            line.run for line in session.state.messages() if isinstance(line, m.ActionRequested)
        ]
        assert runs == ["a00003"]
        commands = [
            line.command for line in session.state.messages() if isinstance(line, m.Command)
        ]
        assert len(commands) == 1

    on_stage(tmp_path, scenario)


def test_a_voice_is_told_beforehand_what_it_will_say(tmp_path: Path) -> None:
    prepared: list[list[str]] = []

    class Voice(ScriptedDriver):
        async def prepare(self, utterances: list[str]) -> None:
            prepared.append(utterances)

    async def scenario(rig: SessionRig) -> None:
        await asyncio.sleep(0)
        rig.session.set("P08")
        await asyncio.sleep(0)

    rig = SessionRig(tmp_path, catalogue={"puppet": Voice}, identity=SessionIdentity())
    rig.run(scenario)
    assert prepared[0] == ["Welcome", "Look at the map", "Ouch", "x"]
    assert prepared[1] == ["Hello P08", *prepared[0]]


def test_it_is_told_with_which_voice_and_only_once_of_each(tmp_path: Path) -> None:
    made = experiment(tmp_path)
    one, other = (
        action(name, together(call("say", text="Hello {participant}", voice=voice)))
        for name, voice in (("One", "anna"), ("Other", "ben"))
    )
    again = action("Again", together(call("say", text="Hello {participant}", voice="ben")))
    panel = replace(made.panels[0], actions=(one, other, again))
    said = utterances(
        replace(made, panels=(panel,), beside_panels=()), VariableValues({"participant": "P08"})
    )
    assert [*said.values()] == [
        [{"text": "Hello P08", "voice": "anna"}, {"text": "Hello P08", "voice": "ben"}]
    ]
    assert utterances(replace(made, panels=(panel,), beside_panels=()), VariableValues({})) == {}


def test_stale_presses_of_all_kinds_are_refused_and_logged(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        with pytest.raises(RequestError, match="late"):
            rig.session.play("Hello", KEY, stale="stale: late")
        with pytest.raises(RequestError, match="late"):
            rig.session.send("drive", {"x": 1.0}, "", KEY, stale="stale: late")

    rig = on_stage(tmp_path, scenario)
    assert [line.reason for line in rig.of(m.ActionRefused)] == ["stale: late"]
    refused = rig.of(m.Refused)
    assert [(line.code, line.reason) for line in refused] == [("stale", "stale: late")]
    assert all(verb in ("rest", "close") for verb, _ in rig.driver().calls)


def test_mistakes_name_what_was_played(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        with pytest.raises(RequestError, match="nothing has been played"):
            rig.session.mistake("", "")
        hello = rig.session.play("Hello", KEY)
        typed = rig.session.send("say", {"text": "x"}, "", KEY)
        await asyncio.sleep(1.5)
        rig.session.mistake("", "typo")
        rig.session.mistake(hello, "")
        with pytest.raises(RequestError, match="there is no action with the id 'a00099'"):
            rig.session.mistake("a00099", "")
        assert typed == "c00002"
        by_itself = rig.session.play("Welcome", RequestOrigin("engagement"))
        rig.session.mistake("", "still the one by hand")
        rig.session.mistake(by_itself, "")

    rig = on_stage(tmp_path, scenario)
    labels = [(line.run, line.action) for line in rig.of(m.Mistake)]
    assert labels == [
        *(("c00002", "say"), ("a00001", "Hello")),
        *(("c00002", "say"), ("a00002", "Welcome")),
    ]


def test_the_session_fills_in_just_the_variables_that_files_may_use() -> None:
    assert set(SessionIdentity().values()) == set(utterance_template.BUILT_IN)


# -- patterns of codes -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("pattern", "fits", "does_not"),
    [
        (r"P\d\d", "P07", "P7"),
        (r"([A-Z])\1\d+", "AA1", "AB1"),
        (r"(?!P00)P\d\d", "P01", "P00"),
        (r"(?i:vp)(?P<n>\d)(?P=n)", "Vp33", "Vp34"),
        (r"(([A-Z]+)+)+[0-9]", "ABC1", "A" * 16),
        (r"B{e}*|P", "P", "B"),
    ],
)
def test_a_code_is_compared_with_whatever_pattern_the_file_has(
    pattern: str, fits: str, does_not: str
) -> None:
    check_participant(fits, pattern)
    with pytest.raises(RequestError, match="not a code"):
        check_participant(does_not, pattern)


def test_a_comparison_without_end_is_broken_off() -> None:
    with pytest.raises(RequestError, match="too long") as caught:
        check_participant("A" * 16, ENDLESS)
    assert "participants.pattern" in caught.value.hint
