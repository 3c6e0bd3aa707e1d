"""What the wizard tells the model, and moments at which something is just due."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.sensing.test_engagement_stream import PLAIN, SECOND, Log, session_start
from woz_tui.config.engagement import (
    AttentionSettings,
    EngagementSettings,
    JointSettings,
    Timeouts,
)
from woz_tui.protocol import messages as m
from woz_tui.sensing import engagement_commands
from woz_tui.sensing.engagement_model import EngagementModel
from woz_tui.sensing.engagement_stream import EngagementFollower

KNOWN = "EngagedWithKnown"


def nothing_happens(log: Log, seconds: float) -> None:
    log.say(m.ClockTie(wall=""), after=seconds)


def test_a_time_limit_is_over_at_its_last_microsecond() -> None:
    log = Log(replace(PLAIN, timeouts=Timeouts(approach=5.0)))
    log.tell("sense", sign="presence", value="on")
    nothing_happens(log, 4.999999)
    assert log.path == ["PersonDetected"]
    nothing_happens(log, 0.000001)
    assert log.path[1] == "Wait"
    assert log.changes[1].t - log.changes[0].t == 5 * SECOND


def test_patience_with_a_face_begins_when_its_owner_engages() -> None:
    """And ends by itself, to the microsecond: no message need come."""
    log = Log(replace(PLAIN, timeouts=Timeouts(unrecognized=4.0)))
    log.tell("sense", sign="presence", value="on")
    nothing_happens(log, 10)
    engaged = log.t
    log.tell("sense", sign="all", value="on")
    assert log.state == "PersonDetected"
    nothing_happens(log, 20)
    assert log.state == "EngagedWithUnknown"
    assert log.changes[-1].t - engaged == 4 * SECOND


def test_a_face_that_was_known_before_the_handshake_does_not_end_it() -> None:
    log = Log()
    log.here()
    log.tell("handshake", what="begin")
    nothing_happens(log, 1)
    log.sense("presence", 1)
    assert log.state == "Handshake"
    log.tell("sense", sign="identity", value="V2")
    assert log.path[-1] == KNOWN


@pytest.mark.parametrize(
    ("sign", "value", "verdict"),
    [
        ("presence", "on", 1),
        ("gaze", "off", 0),
        ("distance", "off", 0),
        ("distance", "0.8", 1),
        ("distance", "0", 1),
        ("distance", "1e300", 0),
        ("identity", "V07", "V07"),
        ("identity", "Unknown", "Unknown"),
    ],
)
def test_what_the_wizard_says_of_a_sign_holds(sign: str, value: str, verdict: object) -> None:
    log = Log()
    log.tell("sense", sign=sign, value=value)
    assert log.follower.model.verdicts[sign] == verdict


def test_another_participant_who_stands_there_is_seen_at_once() -> None:
    """They are no participant of a forced state: signs that say the same as before count."""
    log = Log()
    log.say(session_start("P01"))
    for _ in range(10):
        log.sense("presence", 1, after=1 / 3)
    assert log.state == "PersonDetected"
    log.say(m.SessionChanged(participant="P02"))
    log.sense("presence", 1, after=0.1)
    assert log.path[-2:] == ["Wait", "PersonDetected"]


def test_a_mode_set_by_hand_outlasts_other_settings() -> None:
    log = Log()
    log.tell("attend", mode="FullyEngaged")
    log.follower.adopt(replace(PLAIN, samples=3))
    assert log.follower.mode == "FullyEngaged"
    log.follower.adopt(replace(PLAIN, attention=AttentionSettings(mode="Unengaged")))
    assert log.follower.mode == "Unengaged"


def holding() -> Log:
    """Held while somebody known begins to speak."""
    log = Log()
    log.here()
    log.tell("engagement", run="hold")
    log.say(m.SpeechStarted(driver="mic", segment=1, began=log.t))
    assert log.follower.model.pending == "UserSpeaks"
    return log


def test_what_was_held_is_over_once_the_model_has_run() -> None:
    log = holding()
    log.tell("engagement", run="run")
    log.tell("engagement", run="hold")
    assert log.follower.model.pending == ""


def test_what_was_held_is_over_once_the_wizard_goes_elsewhere() -> None:
    log = holding()
    log.tell("force", to="Wait")
    log.tell("force", to=KNOWN)
    assert log.follower.model.pending == ""


@pytest.mark.parametrize(
    ("verb", "args", "state"),
    [
        ("visitor", {"code": "V1"}, KNOWN),
        ("handshake", {"what": "ok", "code": "V1"}, KNOWN),
        ("handshake", {"what": "fail"}, "EngagedWithUnknown"),
    ],
)
def test_a_handshake_that_the_wizard_ends_is_over_though_the_model_is_held(
    verb: str, args: dict[str, str], state: str
) -> None:
    log = Log()
    log.tell("engagement", run="hold")
    log.tell("handshake", what="begin")
    assert log.state == "Handshake"
    log.tell(verb, **args)
    assert log.state == state


@pytest.mark.parametrize(
    ("verb", "args", "sentence"),
    [
        ("force", {"to": "Wait"}, "it is Wait already"),
        ("force", {"to": "eng2know"}, "does not lead out of Wait"),
        ("force", {"to": "Nowhere"}, "does not lead out of Wait"),
        ("engagement", {"run": "step"}, "only a model on hold"),
        ("handshake", {"what": "ok"}, "no handshake to end"),
        ("social_distance", {"metres": 5.0}, "beyond the sensor's reach"),
        ("visitor", {"code": "Unknown"}, "cannot be a name"),
        ("sense", {"sign": "identity", "value": "?"}, "no letters and no digits"),
        ("filter", {"sign": "all", "kind": "median"}, "sign: distance, kind: median"),
    ],
)
def test_what_makes_no_sense_now_is_said_before_it_is_done(
    verb: str, args: dict[str, m.Json], sentence: str
) -> None:
    with pytest.raises(ValueError, match=sentence):
        engagement_commands.resolved_arguments(EngagementModel(EngagementSettings()), verb, args)


def test_a_step_that_leads_nowhere_is_refused() -> None:
    model = EngagementModel(EngagementSettings())
    model.run = "hold"
    with pytest.raises(ValueError, match="no way out of Wait is open now"):
        engagement_commands.resolved_arguments(model, "engagement", {"run": "step"})
    model.override("presence", True)
    assert engagement_commands.resolved_arguments(model, "engagement", {"run": "step"}) == {
        "run": "step"
    }


def test_all_signs_are_given_back_the_name_too() -> None:
    log = Log()
    log.here()
    log.tell("sense", sign="all", value="sensor")
    shown = log.follower.shown().signs
    assert [name for name, sign in shown.items() if sign.forced] == []
    assert log.follower.model.verdicts["identity"] == "Unknown"


def test_what_lies_on_the_limit_is_near() -> None:
    log = Log(replace(PLAIN, social_distance=1.3))
    log.tell("sense", sign="distance", value="1.3")
    assert log.follower.model.verdicts["distance"] == 1
    log.tell("sense", sign="distance", value="1.31")
    assert log.follower.model.verdicts["distance"] == 0


def looks_away(follower: EngagementFollower) -> int:
    """How many samples tell an engaged visitor's turning away."""
    for number in range(200):
        t = number * SECOND // 3
        for sensor in ("presence", "gaze", "distance"):
            value = 0.0 if sensor == "gaze" and number >= 30 else 1.0
            follower.apply(m.Reading(sensor=sensor, value=value, t=t))
        if number >= 30 and follower.model.verdicts["gaze"] == 0:
            return number - 29
    raise AssertionError("it is never noticed")


def test_another_length_of_glances_counts_from_a_reload_on() -> None:
    brief, long = (
        replace(PLAIN, filter="joint", joint=JointSettings(glance=each)) for each in (0.2, 5.0)
    )
    engagement_follower = EngagementFollower(brief)
    engagement_follower.adopt(long)
    assert looks_away(engagement_follower) > 2 * looks_away(EngagementFollower(brief))
