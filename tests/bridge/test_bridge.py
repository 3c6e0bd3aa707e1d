"""EyePi is played by its own planners, over a broker, byte for byte."""

from __future__ import annotations

import asyncio
import os
import sys
from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest

from tests.bridge.rig import GENERAL, PATIENCE_S, PREDICTION, SEQUENCE, bridged
from woz_tui.bridge.ros_data import RosValue
from woz_tui.features.profiles.in_session import ProfileInUse
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m

ACK, NACK_FLUENCY, NACK_SOON, NACK_INVALID = (1, 1, 0), (1, 0, 1), (1, 0, 2), (1, 0, 3)
START, STROKE, END = (2, 1, 0), (2, 2, 0), (2, 3, 0)
NOD, DANCE = 3, 2
WIZARD = RequestOrigin("key", "h", "con9")


@pytest.mark.toolkit("E1")
async def test_a_nod_is_acknowledged_begins_strikes_and_ends(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        planner.send_text(  # as EyePi's engine of AsapRealizer writes it
            SEQUENCE,
            '<data><sequence type="int">3</sequence><id type="str">nod1</id>'
            '<requestType type="int">1</requestType><requestCount type="int">1</requestCount>'
            '<request type="float">0.1</request></data>',
        )
        await planner.sequence_ended("nod1")
        assert planner.general("nod1") == [ACK, START, STROKE, END]
        [played] = planner.commands("play")
        assert (played.args["move"], played.source) == ("nod", "program")
        first = planner.texts(GENERAL)[0]
        assert first == (
            '<data><id type="str">nod1</id><type type="int">1</type>'
            '<message type="int">1</message><reason type="int">0</reason></data>'
        )
        sends = [frame for frame in planner.broker.frames if frame.startswith(b"SEND")]
        assert not any(b"content-length" in frame for frame in sends)


async def test_a_stroke_is_where_it_was_asked_for_and_foretold(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        planner.send(
            "ram.animation.desired.animation", {"frequency": 1.0, "sequence": 1, "input": 2}
        )
        planner.ask("p", NOD, kind=4)
        await planner.until(lambda: bool(planner.messages_on(PREDICTION)))
        [foretold] = planner.messages_on(PREDICTION)
        lasts, stroke = foretold["duration"], foretold["stroke"]
        assert foretold["id"] == "p"
        assert isinstance(lasts, float) and isinstance(stroke, float)
        assert 0 < stroke < lasts == pytest.approx(3 / 3.2, abs=0.01)  # three beats
        assert planner.commands("play") == []
        planner.ask("n", NOD, kind=2, seconds=2.0)
        planner.ask("twice", NOD, kind=1, seconds=2.0 + lasts, count=2)
        await planner.sequence_ended("twice")
        assert planner.general("twice") == [ACK, START, STROKE, STROKE, END]
        commands = planner.commands("play")
        begun = planner.host.of(m.Dispatched)
        marks = planner.host.of(m.CommandMark)
        first = next(line for line in begun if line.command == commands[0].command)
        struck = next(line for line in marks if line.command == commands[0].command)
        planned = planner.host.of(m.ActionScheduled)
        # Never earlier than planned, but for a tick of the body; a busy machine may be late.
        assert planned[0].at - planned[0].t <= (2.0 - stroke) * 1e6
        assert first.t >= planned[0].at
        assert struck.t - first.t >= stroke * 1e6 - 40_000
        assert planned[1].at - planned[0].at >= (lasts + stroke) * 1e6 - 1000


async def test_a_sequence_whose_moment_passes_on_the_way_begins_at_once(tmp_path: Path) -> None:
    # The moment is asked for after one way to the session and over before the second.
    async with bridged(tmp_path, late_s=0.2) as planner:
        planner.ask("nod", NOD, seconds=0.25)
        await planner.sequence_ended("nod")
        assert planner.general("nod") == [ACK, START, STROKE, END]


@pytest.mark.toolkit("E1")
async def test_what_does_not_fit_is_refused_with_its_reason(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        planner.ask("soon", NOD, seconds=0.05)
        planner.ask("nothing", NOD, kind=0)
        planner.ask("past", NOD, kind=3, seconds=-1.0)
        planner.ask("unknown", 99)
        planner.ask("first", NOD, seconds=30.0, count=20)
        planner.ask("second", NOD, seconds=30.5)
        planner.send(SEQUENCE, {"id": "wrong", "sequence": "nod"})
        planner.send(SEQUENCE, {"id": "more", "sequence": NOD, "haste": 3.0})
        await planner.until(lambda: bool(planner.general("more")))
        assert {
            name: planner.general(name)
            for name in ("soon", "nothing", "past", "unknown", "first", "second", "wrong", "more")
        } == {
            "soon": [NACK_SOON],
            "nothing": [NACK_INVALID],
            "past": [NACK_INVALID],
            "unknown": [NACK_INVALID],
            "first": [ACK],
            "second": [NACK_FLUENCY],
            "wrong": [NACK_INVALID],
            "more": [NACK_INVALID],
        }


@pytest.mark.toolkit("E1")
async def test_sequence_one_ends_the_sequence_under_way(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        planner.ask("dance", DANCE)
        await planner.until(lambda: START in planner.general("dance"))
        planner.ask("stop", 1)
        await planner.sequence_ended("dance")
        assert planner.general("stop") == [ACK]
        assert [type(line) for line in planner.host.of(m.End)] == [m.Stopped]
        planner.ask("nod", NOD)
        await planner.sequence_ended("nod")


@pytest.mark.toolkit("E1")
async def test_moods_are_shown_and_acknowledged(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        topic = "ram.animation.hmmm.emotion"
        planner.send(topic, {"id": "e1", "arousal": 0.1, "valence": 0.9, "valenceWeight": 3})
        planner.send(topic, {"id": "e2", "arousal": 0.1, "valence": "very"})
        await planner.until(lambda: bool(planner.general("e2")))
        assert (planner.general("e1"), planner.general("e2")) == ([ACK], [NACK_INVALID])
        assert [line.args for line in planner.commands("affect")] == [
            {"arousal": 0.1, "valence": 0.9}
        ]


def saliency(x: float, y: float, weight: int, program: str) -> dict[str, RosValue]:
    places: dict[str, RosValue] = {"locationsX": (x,), "locationsY": (y,), "weights": (weight,)}
    return {"inputId": program, "deliberate": 1, **places}


@pytest.mark.toolkit("E1")
async def test_the_most_salient_place_is_looked_at_once(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        topic = "ram.animation.hmmm.saliency"
        for _ in range(5):
            planner.send(topic, saliency(0.0, -0.5, 1000, "2"))
        await planner.until(lambda: len(planner.commands("gaze")) == 1)
        for _ in range(5):
            planner.send(topic, saliency(0.5, 0.0, 10000, "1"))
            planner.send(topic, saliency(0.0, -0.5, 1000, "2"))
        await planner.until(lambda: len(planner.commands("gaze")) == 2)
        up, right = (line.args for line in planner.commands("gaze"))
        assert up == {"yaw": 0.0, "pitch": -22.5}
        assert right == {"yaw": -28.125, "pitch": 0.0}
        await planner.until(
            lambda: {"x": 0.5, "y": 0.0} in planner.messages_on("ram.asap.feedback.gaze")
        )


async def test_a_look_waits_for_the_sequence_to_end(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        planner.ask("nod", NOD)
        await planner.until(lambda: START in planner.general("nod"))
        planner.send("ram.animation.hmmm.saliency", saliency(0.5, 0, 10000, "1"))
        await planner.until(lambda: bool(planner.commands("gaze")))
        [nod], [gaze] = planner.commands("play"), planner.commands("gaze")
        lines = planner.host.lines
        [done] = [
            line for line in lines if isinstance(line, m.Done) and line.command == nod.command
        ]
        assert lines.index(done) < lines.index(gaze)


@pytest.mark.toolkit("E1")
async def test_states_are_played_when_they_change(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        face = {"eyePosX": 64, "eyePosY": 127, "emotionState": 3, "emotionLevel": 127}
        for _ in range(10):
            planner.send("ram.animation.desired.face", {**face, "screenBrightness": 127})
            planner.send("ram.animation.desired.joint", {"position": (0.5, 0.6, 0.45)})
            planner.send(
                "ram.animation.desired.animation", {"frequency": 1.0, "sequence": 1, "input": 2}
            )
        planner.send("ram.animation.desired.face", {**face, "screenBrightness": 64})
        await planner.until(lambda: len(planner.commands("brightness")) == 2)
        assert [(line.verb, line.args) for line in planner.commands("emotion", "look")] == [
            ("emotion", {"emotion": "happy", "intensity": 1.0}),
            ("look", {"x": 0.0, "y": 1.0}),
        ]
        [joints] = planner.commands("joints")
        assert joints.args["joints"] == pytest.approx(
            {"pitch": 28.6479, "middle": 34.3774, "top": 25.783}, abs=0.001
        )
        [way] = planner.commands("personality")
        assert way.args == {"tempo": 3.2, "smoothing": 0.0, "compression": 0.0}
        assert planner.commands("mode") == []


async def test_a_sequence_of_the_low_level_goes_on_until_another_is_wanted(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        way: dict[str, RosValue] = {"frequency": 1.0, "input": 2}
        planner.send("ram.animation.desired.animation", {**way, "sequence": NOD})
        await planner.until(lambda: len(planner.commands("play")) == 2)
        planner.send("ram.animation.desired.animation", {**way, "sequence": 1})
        await planner.until(lambda: bool(planner.commands("mode")))
        played = {line.command for line in planner.commands("play")}

        def all_over() -> bool:
            return played <= {line.command for line in planner.host.of(m.End)}

        await planner.until(all_over)
        planner.ask("p", NOD, kind=4)
        await planner.until(lambda: bool(planner.messages_on(PREDICTION)))
        assert {line.command for line in planner.commands("play")} == played


async def test_a_sequence_of_the_low_level_leaves_the_wizards_move_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_tui.bridge.topic_player.HAND_S", 2.0)  # twice as long as a nod
    async with bridged(tmp_path) as planner:
        way: dict[str, RosValue] = {"frequency": 1.0, "input": 2}
        planner.send("ram.animation.desired.animation", {**way, "sequence": NOD})
        await planner.until(lambda: len(planner.commands("play")) == 2)
        planner.host.session.send("play", {"move": "shake"}, "", WIZARD)
        [wizards] = [each for each in planner.commands("play") if each.source == "key"]
        sent = wizards.t + 300_000  # what was on its way to the session does not count
        await planner.until(lambda: planner.commands("play")[-1].t > sent)
        assert planner.commands("play")[-1].t - wizards.t > 1.9e6


async def test_a_planner_hears_how_the_robot_is(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        face, joint = "ram.animation.generated.face", "ram.animation.generated.joint"
        await planner.until(lambda: bool(planner.messages_on(joint)))
        first = planner.messages_on(joint)[0]
        assert first["name"] == ("joint1", "joint2", "joint3")
        assert first["position"] == pytest.approx((0.0, 0.7854, 0.5), abs=0.2)  # where it starts
        sad = {"emotionState": 5, "emotionLevel": 127, "screenBrightness": 127}
        planner.send("ram.animation.desired.face", {**sad, "eyePosX": 127, "eyePosY": 64})
        wanted = {"eyePosX": 127, "eyePosY": 64, **sad}
        await planner.until(lambda: wanted in planner.messages_on(face))


@pytest.mark.toolkit("E4")
async def test_a_planner_is_a_guest(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        planner.ask("dance", DANCE)
        planner.ask("later", NOD, seconds=60.0)
        await planner.until(
            lambda: START in planner.general("dance") and ACK in planner.general("later")
        )
        planner.host.session.stop("key")
        await planner.sequence_ended("dance")
        planner.ask("more", NOD)
        planner.send("ram.animation.desired.face", {"emotionState": 5})
        await planner.until(lambda: bool(planner.general("more")))
        assert planner.general("more") == [NACK_FLUENCY]
        await planner.until(lambda: planner.general("later") == [ACK, NACK_FLUENCY])
        await planner.until(lambda: any("stop" in text for text in planner.texts("bridge_status")))
        await planner.until(lambda: any("stop" in text for text in planner.sentences))


async def test_a_profile_counts_for_a_planner_too(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        planner.host.session.features.of(ProfileInUse).use("child", "key")
        planner.ask("nod", NOD)
        planner.send("ram.animation.hmmm.emotion", {"id": "e", "valence": 0.9})
        await planner.until(lambda: bool(planner.general("e")))
        assert planner.general("nod") + planner.general("e") == [NACK_FLUENCY, NACK_FLUENCY]
        await planner.until(lambda: any("child" in text for text in planner.texts("bridge_status")))
        planner.host.session.features.of(ProfileInUse).use("", "key")
        planner.ask("again", NOD)
        await planner.until(lambda: START in planner.general("again"))


async def test_what_a_mode_refuses_is_tried_again_and_a_wizards_hand_stays(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        session = planner.host.session
        joints: dict[str, RosValue] = {"position": (0.5, 0.6, 0.45)}
        session.send("mode", {"mode": "saccade"}, "", WIZARD)
        planner.send("ram.animation.desired.joint", joints)
        planner.ask("nod", NOD)
        await planner.until(lambda: NACK_FLUENCY in planner.general("nod"))
        assert START not in planner.general("nod")
        session.send("mode", {"mode": "normal"}, "", WIZARD)

        def played() -> int:
            done = {line.command for line in planner.host.of(m.Done)}
            return len(done & {each.command for each in planner.commands("joints")})

        async def tried() -> None:
            while not played():
                planner.send("ram.animation.desired.joint", joints)
                await asyncio.sleep(0.1)

        await asyncio.wait_for(tried(), PATIENCE_S)
        asked = len(planner.commands("joints"))
        session.send("joints", {"joints": {"pitch": -40.0}}, "", WIZARD)
        await planner.until(lambda: len(planner.commands("joints")) == asked + 1)
        planner.ask("q", NOD, kind=4)  # when it is answered, the bridge has heard of the wizard
        await planner.until(lambda: bool(planner.messages_on(PREDICTION)))
        for angle in (0.5, 0.1, 0.2):
            planner.send("ram.animation.desired.joint", {"position": (angle, 0.6, 0.45)})
        planner.ask("p", NOD, kind=4)
        await planner.until(lambda: len(planner.messages_on(PREDICTION)) == 2)
        assert len(planner.commands("joints")) == asked + 1


@pytest.mark.toolkit("E4")
async def test_a_sequence_gives_way_to_the_wizards_hand(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        planner.ask("dance", DANCE)
        await planner.until(lambda: START in planner.general("dance"))
        planner.host.session.send("play", {"move": "nod"}, "", WIZARD)
        await planner.sequence_ended("dance")
        done = await planner.host.published(lambda line: isinstance(line, m.Done))
        assert isinstance(done, m.Done)
        assert [line.source for line in planner.commands() if line.command == done.command] == [
            "key"
        ]
        assert any("replaced" in text for text in planner.texts("bridge_status"))


async def test_the_bridge_itself_is_asked(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        relay = '<config><relay publisher="{}" name="{}"/></config>'
        planner.send_text("bridge_config", relay.format("apollo", SEQUENCE.replace(".", "/")))
        planner.send_text("bridge_config", relay.format("ros", GENERAL.replace(".", "/")))
        planner.send_text("bridge_config", relay.format("ros", "turtle/pose"))
        planner.send_text("bridge_config", "<config><relay name='x'/></config>")
        planner.send_text("bridge_config", "<nonsense/>")
        planner.send_text("bridge_service", '<service><request name="reset"/></service>')
        planner.send_text(
            "bridge_info",
            '<info><request type="msg-structure" name="ram/asap/feedback/prediction"/>'
            '<request type="list-pubs-subs-services"/><request type="tea"/></info>',
        )
        await planner.until(lambda: len(planner.texts("bridge_status")) == 7)
        statuses = [Xml.fromstring(text) for text in planner.texts("bridge_status")]
        assert [status.findtext("relay") for status in statuses[:3]] == ["ok", "ok", "failed"]
        assert all(status.find("error") is not None for status in statuses[2:])
        [info] = planner.texts("bridge_info")
        assert '<duration type="float">0.0</duration>' in info
        request = '<request type="list-pubs-subs-services"/>'
        planner.send_text("bridge_info", f"<info>{request * 1000}</info>")
        await planner.until(lambda: len(planner.texts("bridge_info")) == 2)
        assert planner.texts("bridge_info")[1].count("<response") == 100
        assert '<sub-topic isrelayed="True">/ram/animation/hmmm/sequence</sub-topic>' in info


@pytest.mark.toolkit("E3")
async def test_nonsense_is_told_and_the_next_message_is_played(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        for topic in (SEQUENCE, "ram.animation.desired.joint", "ram.animation.hmmm.saliency"):
            for text in ("", "<data", "\x01", "<data><a type='x'/></data>", "<data>" * 100):
                planner.send_text(topic, text)
        planner.send("ram.animation.hmmm.saliency", {"locationsX": (1.0,)})
        planner.ask("nod", NOD)
        await planner.sequence_ended("nod")
        assert any("different lengths" in text for text in planner.texts("bridge_status"))


@pytest.mark.toolkit("E3")
async def test_a_flood_and_a_huge_message_are_survived(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        for number in range(250):
            angle = number / 250
            planner.send("ram.animation.desired.joint", {"position": (angle, 0.6, 0.45)})
            planner.send("ram.animation.hmmm.saliency", saliency(angle, 0.0, 100, str(number)))
            planner.ask(f"s{number}", 99)
        planner.send("ram.animation.hmmm.emotion", {"id": "x" * (1 << 19)})
        planner.ask("nod", NOD)
        await planner.sequence_ended("nod")
        assert planner.general("s249") == [NACK_INVALID]
        assert len(planner.texts("bridge_status")) <= 20


@pytest.mark.toolkit("E3")
async def test_what_was_accepted_is_played_to_its_end_without_its_planner(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        planner.ask("nod", NOD)
        await planner.until(lambda: START in planner.general("nod"))
        await planner.broker.stop()
        [command] = planner.commands("play")
        end = await planner.host.published(
            lambda line: isinstance(line, m.End) and line.command == command.command
        )
        assert isinstance(end, m.Done)


@pytest.mark.toolkit("E3")
async def test_a_broker_that_comes_back_is_used_again(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        await planner.broker.stop()
        await planner.until(lambda: any("tried again" in each for each in planner.sentences))
        await planner.broker.start()
        await planner.until(lambda: planner.broker.subscribed)
        planner.ask("nod", NOD)
        await planner.sequence_ended("nod")


async def test_what_the_command_says_comes_at_once_into_a_pipe(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        place = ("--stomp", f"127.0.0.1:{planner.broker.port}", "--session", str(planner.host.path))
        command = (sys.executable, "-m", "woz_tui", "bridge", *place)
        buffered = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
        running = await asyncio.create_subprocess_exec(
            *command, stdout=asyncio.subprocess.PIPE, env=buffered
        )
        try:
            assert running.stdout is not None
            line = await asyncio.wait_for(running.stdout.readline(), PATIENCE_S)
            assert b"connected to 127.0.0.1" in line
        finally:
            running.kill()
            await running.wait()


async def test_who_asks_is_seen(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner:
        planner.send("ram.animation.hmmm.emotion", {"id": "e", "arousal": 0.5})
        await planner.until(lambda: bool(planner.commands("affect")))
        joined = planner.host.of(m.ConsoleAttached)
        assert [line.name for line in joined] == ["bridge"]
