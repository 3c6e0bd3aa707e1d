"""Messages of a session into the model: what counts, and what must not hurt."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.config.engagement import (
    EngagementSettings,
    HandshakeSettings,
    SignSettings,
    SoundSettings,
)
from woz_tui.config.engagement_words import MODES, OUTCOMES, RUNS, SIGNS, STATES
from woz_tui.config.session_verbs import ENGAGEMENT_VERBS
from woz_tui.protocol import messages as m
from woz_tui.sensing.engagement_model import Transition
from woz_tui.sensing.engagement_stream import EngagementFollower

SECOND = 1_000_000
PLAIN = EngagementSettings(handshake=HandshakeSettings(by="nobody"))


class Log:
    """A follower, and messages in the order of their time."""

    def __init__(self, settings: EngagementSettings = PLAIN) -> None:
        self.follower = EngagementFollower(settings)
        self.t = 0
        self.changes: list[Transition] = []
        self._commands = 0

    @property
    def path(self) -> list[str]:
        return [change.now for change in self.changes]

    @property
    def state(self) -> str:
        return str(self.follower.model.state)

    def say(self, message: m.Message, after: float = 0.0) -> None:
        self.t += round(after * SECOND)
        self.changes += self.follower.apply(m_replace(message, t=self.t))

    def sense(self, sensor: str, value: float | None, text: str = "", after: float = 0.0) -> None:
        self.say(m.Reading(sensor=sensor, value=value, text=text), after)

    def command(self, verb: str, driver: str = "robot", source: str = "key", **args: Any) -> str:
        self._commands += 1
        command = f"c{self._commands}"
        self.say(m.Command(command=command, verb=verb, args=args, driver=driver, source=source))
        return command

    def tell(self, verb: str, **args: Any) -> None:
        """A verb of the model that is done."""
        command = self.command(verb, "engagement", **args)
        self.say(m.Done(command=command, sent=args, latency_us=0, duration_us=0))

    def begins_to_say(self, source: str = "key") -> str:
        command = self.command("say", source=source, text="x")
        self.say(m.Dispatched(command=command, driver="robot", latency_us=0))
        return command

    def here(self) -> None:
        self.tell("sense", sign="identity", value="V1")
        self.tell("sense", sign="all", value="on")
        self.say(m.ClockTie(wall=""), after=0.1)

    def visitor_spoke(self, segment: int = 1) -> None:
        self.say(m.SpeechStarted(driver="mic", segment=segment, began=self.t))
        self.say(m.SpeechEnded(driver="mic", segment=segment, began=0, ended=self.t), after=1)


def m_replace(message: m.Message, **changes: Any) -> Any:
    return msgspec.structs.replace(message, **changes)


def done_message(command: str) -> m.Done:
    return m.Done(command=command, sent={}, latency_us=0, duration_us=0)


def stopped_message(command: str) -> m.Stopped:
    return m.Stopped(command=command, reason="stop pressed")


def test_which_readings_count_is_a_setting() -> None:
    settings = replace(
        PLAIN,
        gaze=SignSettings(sensor="left.gaze"),
        sound=SoundSettings(sensor="left.loudness"),
    )
    follower = EngagementFollower(settings)

    def reads(sensor: str) -> bool:
        return follower.reads(m.Reading(sensor=sensor, value=1))

    assert reads("presence")
    assert reads("left.gaze")
    assert reads("left.loudness")
    assert reads("left.loudness.threshold")
    assert not reads("gaze")
    assert not reads("loudness")
    assert not reads("joint.pan")


def test_a_look_at_readings_of_others_costs_nothing() -> None:
    log = Log()
    log.sense("presence", 1)
    model = log.follower.model
    before = model.now
    log.sense("joint.pan", 12.0, after=0.01)
    assert model.now == before


@pytest.mark.parametrize("ending", [done_message, stopped_message, lambda c: m.Failed(command=c)])
def test_any_end_of_the_answer_is_its_end(ending: Any) -> None:
    log = Log()
    log.here()
    log.visitor_spoke()
    assert log.state == "RobotThinks"
    command = log.begins_to_say()
    assert log.state == "RobotReplies"
    log.say(ending(command), after=1)
    assert log.state == "EngagedWithKnown"
    assert log.changes[-1].why == "the answer is over"  # whether it was spoken or stopped


def test_a_refused_sentence_is_no_answer() -> None:
    log = Log()
    log.here()
    log.visitor_spoke()
    command = log.command("say", text="x")
    log.say(m.Refused(command=command, code="full"))
    assert log.state == "RobotThinks"


def test_two_robots_speak_until_the_last_is_silent() -> None:
    log = Log()
    log.here()
    first, second = log.begins_to_say(), log.begins_to_say()
    assert log.state == "RobotSpeaks"
    log.say(done_message(first), after=1)
    assert log.state == "RobotSpeaks"
    log.say(done_message(second), after=1)
    assert log.state == "EngagedWithKnown"


def test_the_effect_of_a_state_is_no_early_answer_but_the_wizards_is() -> None:
    for source, state in (("engagement", "RobotThinks"), ("key", "RobotReplies")):
        log = Log()
        log.here()
        log.say(m.SpeechStarted(driver="mic", segment=1, began=0))
        log.begins_to_say(source)
        log.say(m.SpeechEnded(driver="mic", segment=1, began=0, ended=1), after=1)
        assert log.state == state


def test_a_driver_that_cuts_speech_is_the_only_one_who_does() -> None:
    log = Log()
    log.here()
    log.say(m.SpeechStarted(driver="mic", segment=1, began=0))
    for _ in range(5):
        log.sense("loudness", 0.5, after=0.1)
    for _ in range(50):
        log.sense("loudness", 0.0, after=0.1)
    assert log.state == "UserSpeaks"
    log.say(m.SpeechEnded(driver="mic", segment=1, began=0, ended=1))
    assert log.state == "RobotThinks"


@pytest.mark.parametrize("sensor", ["speech", "left.speech", "left.ears.speech"])
def test_a_driver_that_says_it_cuts_speech_is_believed_before_the_first_word(sensor: str) -> None:
    log = Log()
    log.say(m.SensorChanged(sensor=sensor, state="ready", was=""))
    log.here()
    for _ in range(5):
        log.sense("loudness", 0.5, after=0.1)  # a door: the microphone makes no speech of it
    assert log.state == "EngagedWithKnown"
    log.say(m.SpeechStarted(driver="mic", segment=1, began=0))
    assert log.state == "UserSpeaks"


def test_only_nothing_that_has_no_excuse_is_an_error_of_speech() -> None:
    log = Log()
    log.here()
    log.say(m.SpeechStarted(driver="mic", segment=1, began=0))
    log.say(m.SpeechText(driver="mic", segment=1, text="", detail="the program failed"))
    assert log.state == "UserSpeaks"
    log.say(m.SpeechText(driver="mic", segment=1, text=" "))
    assert log.changes[-1].outcome == "error"


def test_the_robots_own_voice_is_nobodys() -> None:
    log = Log()
    log.here()
    log.say(m.SpeechStarted(driver="mic", segment=1, began=0, own=True))
    assert log.state == "EngagedWithKnown"
    log.say(m.SpeechStarted(driver="mic", segment=2, began=0, own=False))
    log.say(m.SpeechEnded(driver="mic", segment=1, began=0, ended=1, own=True))
    log.say(m.SpeechText(driver="mic", segment=1, text=" ", own=True))
    assert log.state == "UserSpeaks"
    log.say(m.SpeechEnded(driver="mic", segment=2, began=0, ended=1, own=False))
    assert log.state == "RobotThinks"


def test_the_same_participant_said_again_changes_nothing() -> None:
    log = Log()
    log.say(session_start("P07"))
    log.here()
    log.say(m.SessionChanged(participant="P07", trial=2))
    assert log.state == "EngagedWithKnown"
    log.say(m.SessionChanged(participant="P08"))
    assert log.state == "Wait"
    began = log.changes[-1]
    assert (began.outcome, began.why) == ("new_participant", "another participant")
    assert not began.forced, "nobody has forced it, whoever has set the participant"


@pytest.mark.parametrize(
    ("source", "attached", "who"),
    [
        ("key", {"role": "wizard"}, "the wizard"),
        ("key", {"role": "wizard", "part": "voice"}, "the wizard (voice)"),
        ("program", {"role": "program", "name": "greeter"}, "the program greeter"),
        ("key", {"role": "program"}, "the program con7"),
        ("program", None, "a program"),
        ("midi", None, "the wizard"),
        ("replay", None, "the re-run"),
        ("phase", None, "the experiment"),
    ],
)
@pytest.mark.parametrize("action", [False, True])
def test_whoever_forces_a_state_is_named(
    source: str, attached: dict[str, Any] | None, who: str, action: bool
) -> None:
    log = Log()
    if attached is not None:
        log.say(m.ConsoleAttached(console="con7", **attached))
    console = "con7" if attached is not None else ""
    if action:  # then its commands do not tell the connection
        log.say(m.ActionRequested(run="r1", action="Thinks", source=source, console=console))
    asked = m.Command(
        command="x1",
        run="r1" if action else "",
        verb="force",
        args={},
        driver="engagement",
        source=source,
        console="" if action else console,
    )
    log.say(asked)
    done = m.Done(command="x1", sent={"to": "RobotThinks"}, latency_us=0, duration_us=0)
    log.say(done)
    assert log.changes[-1].forced
    assert log.changes[-1].why.startswith(f"forced by {who}: ")


def test_a_sign_given_by_a_program_is_not_the_wizards() -> None:
    log = Log()
    log.say(m.ConsoleAttached(console="con7", role="program", name="greeter"))
    log.say(m.Command(command="x1", verb="sense", args={}, driver="engagement", source="program",
                      console="con7"))  # fmt: skip
    sent: dict[str, m.Json] = {"sign": "presence", "value": "on"}
    log.say(m.Done(command="x1", sent=sent, latency_us=0, duration_us=0))
    assert log.state == "PersonDetected"
    assert "present (program greeter)" in log.changes[-1].why


def test_it_does_not_matter_who_looks_when() -> None:
    """Whether a timer looks in between or only the next message does: the path is the same."""
    paths = []
    for looks in (0, 1, 97):
        log = Log(EngagementSettings())
        for index in range(400):
            log.t += SECOND // 3
            for look in range(looks):
                log.changes += log.follower.until(log.t + look * SECOND // 300)
            log.t += SECOND // 3
            if index % 40 < 25:
                log.sense("identity", 0.9, "V1" if index % 3 else "")
                log.sense("presence", 1)
                log.sense("gaze", index % 7 > 2)
                log.sense("distance", 1.0)
        log.changes += log.follower.until(log.t)
        paths.append([(change.t, change.now, change.why) for change in log.changes])
    assert paths[0] == paths[1] == paths[2]
    assert len(paths[0]) > 10


def test_a_gap_of_days_in_a_log_takes_no_time() -> None:
    log = Log(replace(PLAIN, timeouts=replace(PLAIN.timeouts, approach=0.1)))
    log.tell("sense", sign="presence", value="on")
    log.say(m.ClockTie(wall=""), after=30 * 86_400)
    assert log.state in ("Wait", "PersonDetected")


def session_start(participant: str) -> m.SessionStart:
    return m.SessionStart(
        session="S01",
        participant=participant,
        condition="",
        wizard="",
        software={},
        experiment="x.yaml",
        experiment_sha256="",
        seed=0,
        clock={},
    )


# -- whatever comes ------------------------------------------------------------------------------

JUNK = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=8),
    st.sampled_from(["on", "off", "sensor", "Unknown", "all", *SIGNS, *STATES, *OUTCOMES]),
    st.sampled_from([*RUNS, *MODES, "step", "begin", "ok", "fail", "stop", "NaN", "1e300"]),
    st.lists(st.integers(), max_size=2),
)
SENT = st.dictionaries(
    st.sampled_from(["sign", "value", "to", "run", "kind", "samples", "threshold", "code", "x"])
    | st.sampled_from(["metres", "mode", "what"]),
    JUNK,
    max_size=4,
)
COMMANDS = st.sampled_from(["c1", "c2", "c3"])
VERBS = st.sampled_from([*ENGAGEMENT_VERBS, "say", "nonsense"])
SPEECH = st.sampled_from([1, 2])
MESSAGES = st.one_of(
    st.builds(
        m.Reading,
        sensor=st.sampled_from([*SIGNS, "loudness", "loudness.threshold", "joint.x"]),
        value=JUNK,
        text=st.sampled_from(["", "V1", "V2", "Unknown", "\x00", "x" * 2000]),
    ),
    st.builds(
        m.Command,
        command=COMMANDS,
        verb=VERBS,
        args=st.just({}),
        driver=st.sampled_from(["engagement", "robot"]),
        source=st.sampled_from(["key", "engagement"]),
    ),
    st.builds(m.Dispatched, command=COMMANDS, latency_us=st.just(0)),
    st.builds(m.Done, command=COMMANDS, sent=SENT, latency_us=st.just(0), duration_us=st.just(0)),
    st.builds(m.Stopped, command=COMMANDS),
    st.builds(m.Superseded, command=COMMANDS, by=COMMANDS),
    st.builds(m.SpeechStarted, driver=st.just("mic"), segment=SPEECH, began=st.integers()),
    st.builds(
        m.SpeechEnded,
        driver=st.just("mic"),
        segment=SPEECH,
        began=st.integers(),
        ended=st.integers(),
    ),
    st.builds(m.SpeechText, driver=st.just("mic"), segment=SPEECH, text=st.text(max_size=3)),
    st.builds(m.SessionChanged, participant=st.sampled_from([None, "P1", "P2"])),
    st.builds(m.ClockTie, wall=st.just("")),
)
TIMES = st.one_of(
    st.integers(0, SECOND), st.integers(-(10**18), 10**18), st.just(0), st.just(-SECOND)
)


@given(st.lists(st.tuples(MESSAGES, TIMES), max_size=60))
def test_no_message_hurts(messages: list[tuple[Any, int]]) -> None:
    """E9: whatever a message holds, and whatever its time says."""
    follower = EngagementFollower(EngagementSettings())
    t = 0
    for message, step in messages:
        t += step
        for change in follower.apply(m_replace(message, t=t)):
            assert change.now in (*STATES, "stop")
        follower.until(t)
        follower.due()
        engagement_shown = follower.shown()
        assert engagement_shown.state in (*STATES, "stop")


def test_two_faces_are_somebody_live() -> None:
    log = Log()
    for _ in range(4):
        log.sense("presence", 2.0, after=1 / 3)
    assert log.state == "PersonDetected"
    assert log.follower.shown().signs["presence"].raw == 2.0
