"""One instance of everything that goes over the wire, as it might stand in a real session.

The golden files beside this are made from these: `python -m tests.protocol.examples` writes them. A
golden file that changes means that logs and programs of yesterday are read differently today:
think of them before you write the files anew.
"""

from __future__ import annotations

from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import msgspec

from tests.protocol.feature_examples import feature_examples, further_examples
from tests.protocol.study_examples import BEGINNING, COURSE, FILE_SHA
from woz_tui.gate.table import UNDONE, locked_panel
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol import welcome as s
from woz_tui.protocol.camera_pictures import PictureShown
from woz_tui.protocol.envelope import Answer
from woz_tui.protocol.live_sound import SoundHeard
from woz_tui.protocol.panels import ActionView, PanelView, PhaseView
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.clock import timestamp

GOLDEN = Path(__file__).parent / "golden"
BEGIN = datetime(2026, 3, 1, 10, 0, 0, tzinfo=UTC)
SHA = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"

MESSAGES: tuple[m.Message, ...] = (
    m.SessionStart(
        session="S01",
        participant="P07",
        condition="warm",
        wizard="W2",
        software={"name": "woz-tui", "version": "0.1.0", "commit": "39700bb7" * 5},
        experiment="museum.yaml",
        experiment_sha256=SHA,
        file_sha256=FILE_SHA,
        seed=1207,
        clock={
            "source": "monotonic",
            "unit": "us",
            "wall_at_t0": timestamp(BEGIN),
            "boot_id": "6ba7b810-9dad-11d1-80b4-00c04fd430c8",
        },
        spill=["/mnt/stick/spill", "../spill"],
        robot="robots/nao.yaml",
    ),
    m.ClockTie(wall=timestamp(BEGIN)),
    m.ConsoleAttached(console="con1", role="wizard", part="voice", line="tmux", driving="held"),
    m.DriverConnecting(driver="head", detail="looking for /dev/serial/by-id/usb-U2D2"),
    m.DriverConnected(driver="head", detail="4 servos at 1 Mbit/s"),
    m.RecorderState(level="ok", lag_us=8200, path="2026-03-01T10-00-00_P07_S01.jsonl"),
    m.Notice(
        level="warning",
        text=Sentence(
            "gate.undone", "{undone} ({why})", undone=UNDONE[r.AskEnd], why="it came too late"
        ),
        remedy="close other programs",
    ),
    m.SessionChanged(condition="cold", trial=2),
    m.ActionsFilled(
        actions={
            "Hello": [
                [
                    m.FilledCall(
                        verb="say",
                        args={"text": "Grüß Gott, P07!"},
                        driver="voice",
                        tells=("condition",),
                        unfilled={"text": "..."},
                    ),
                    m.FilledCall(verb="play", args={"move": "nod"}, driver="head"),
                ],
                0.5,
            ]
        }
    ),
    m.ActionRequested(
        run="a00001",
        action="Hello",
        panel="Speech",
        source="key",
        key="h",
        console="con1",
        without=["eyes", "play.speed"],
        edited=True,
    ),
    m.Command(
        command="c00001",
        run="a00001",
        action="Hello",
        panel="Speech",
        verb="say",
        args={"text": "Grüß Gott, P07!"},
        driver="voice",
        source="key",
        key="h",
        deadline_us=19_000_000,
        limit_s=20.0,
        when_busy="replace",
    ),
    m.Dispatched(command="c00001", driver="voice", latency_us=1900),
    m.Progress(command="c00001", driver="voice", expected_us=1_450_000),
    m.Done(
        command="c00001",
        driver="voice",
        sent={"text": "Grüß Gott, P07!", "seconds": 1.45},
        latency_us=1900,
        duration_us=1_462_000,
        evidence="reported",
    ),
    m.ActionDone(run="a00001", action="Hello", evidence="reported"),
    m.Command(command="c00002", verb="gaze", args={"yaw": 10.0}, driver="head", source="key"),
    m.Command(command="c00003", verb="gaze", args={"yaw": 12.0}, driver="head", source="key"),
    m.Superseded(command="c00002", driver="head", by="c00003", reason="a newer setpoint"),
    m.TimedOut(command="c00003", driver="head", reason="still running after 30 s"),
    m.LaneFaulted(driver="head", lane="body", command="c00003"),
    m.LaneRecovered(driver="head", lane="body"),
    m.ActionRequested(run="a00003", action="Nod", source="script"),
    m.Command(command="c00004", run="a00003", verb="home", args={}, driver="head", source="script"),
    m.Failed(
        command="c00004", driver="head", reason="servo 3 overheated", remedy="let it cool down"
    ),
    m.ActionFailed(run="a00003", action="Nod", reason="c00004: servo 3 overheated"),
    m.Command(command="c00005", verb="drive", args={"x": 1.0}, driver="base", source="program"),
    m.Refused(
        command="c00005",
        driver="base",
        code="faulted",
        reason=Sentence(
            "gate.faulted",
            "{driver} does not respond: its last command has not ended",
            driver="base",
        ),
    ),
    m.ActionRequested(run="a00004", action="Map", source="key", key="m"),
    m.ActionRefused(run="a00004", action="Map", reason=locked_panel("Places").reason),
    m.DriverLost(driver="head", detail="the port vanished", remedy="plug the cable in"),
    m.DriverFaulted(driver="head", detail="servo 3: overheated", remedy="let it cool down"),
    m.Reading(sensor="distance", value=0.83, driver="range", unit="m", raw=831.0),
    m.Reading(sensor="distance", value=None, driver="range", unit="m", bad=["value"]),
    m.Reading(sensor="identity", value=None, text="visitor-3", driver="camera"),
    m.SensorChanged(sensor="distance", state="stale", was="ok", why="no value for 3 s"),
    m.SpeechStarted(driver="ears", segment=1, began=7_100_000),
    m.SpeechEnded(
        driver="ears",
        segment=1,
        began=7_100_000,
        ended=9_300_000,
        file="2026-03-01T10-00-00_P07_S01.media/speech-0001.wav",
        loudest=0.41,
    ),
    m.SpeechText(driver="ears", segment=1, text="Was ist das für ein Bild?", took_us=840_000),
    m.SpeechEnded(
        driver="ears", segment=2, began=9_400_000, ended=9_900_000, detail="the disk is full"
    ),
    m.SpeechText(driver="ears", segment=2, text="", detail="transcribe ended with status 1"),
    m.VisitorChanged(visitor="V012", what="learnt", about={"age_group": "child"}),
    m.VisitorChanged(visitor="V013", what="renamed", was="V012"),
    m.EngagementAdopted(
        settings={"signs": ["presence", "gaze"], "samples": 8, "timeouts": {"approach": None}}
    ),
    m.EngagementChanged(
        was="PersonDetected",
        now="EngagedWithKnown",
        outcome="recognized",
        why="present, looks (5 of 8), near 0.83 m, V013",
        verdicts={"presence": 1, "gaze": 1, "distance": 1, "identity": "V013"},
        visitor="V013",
        forced=True,
    ),
    m.EngagementShown(
        state="RobotThinks",
        since=8_200_000,
        trail=["EngagedWithKnown", "UserSpeaks", "RobotThinks"],
        signs={
            "presence": m.SignShown(raw=1.0, verdict=1, count=8, needed=4, places=8, filter="fifo"),
            "gaze": m.SignShown(verdict=0, needed=4, places=8, filter="fifo", stale=True),
            "distance": m.SignShown(
                raw=0.83, verdict=1, count=97, needed=50, places=100, filter="joint"
            ),
            "identity": m.SignShown(
                raw_name="V013", name="V013", count=6, needed=5, places=10, forced=True
            ),
        },
        run="hold",
        uses=["presence", "gaze", "distance"],
        social_distance=1.3,
        engaged=True,
        next="RobotReplies",
        waits_since=8_200_000,
        visitor="V013",
        attempt=1,
        attention="sound from the left",
    ),
    m.ModeChanged(driver="body", was="normal", now="demo", why="the wizard chose it"),
    m.FaceShown(
        driver="body",
        width=8,
        rows="00 3c 7e 66 66 7e 3c 00",
        emotion="happy",
        intensity=0.75,
        brightness=0.5,
    ),
    m.BodyChanged(driver="body", values={"mode": "demo", "tempo": 2.133, "breathing": True}),
    m.ControlsMoved(
        driver="panel",
        values={"pitch": 66, "tempo": 3},
        waiting=["tempo"],
        targets={"tempo": 40},
        lit=["demo"],
    ),
    m.SettingsShown(
        driver="pepper",
        values={"state": "interactive", "volume": 0.7, "blinking": True, "tablet": None},
        wanted={"state": "solitary"},
        conflicts=["Awareness is off, so engagement has nothing to follow."],
    ),
    m.Marker(text="smile"),
    m.Note(text="the visitor's phone rang"),
    m.Mistake(run="a00001", action="Hello", text="too early"),
    *feature_examples("scripts", "MOVED"),
    *feature_examples("phases", "MESSAGES"),
    *feature_examples("scripts", "HALTED"),
    m.PanelLocked(panel="Drive", locked=True),
    m.PanelLocked(panel="Whales", locked=True, source="phase"),
    *feature_examples("profiles", "MESSAGES"),
    m.ExperimentReloaded(experiment_sha256=SHA, changes=["Speech: 'Bye' is new"]),
    m.ActionRequested(run="a00006", action="Map", source="key", key="m"),
    m.ActionRequested(run="a00005", action="Bye", source="key", key="b"),
    m.Command(command="c00006", run="a00005", verb="say", args={}, driver="voice", source="key"),
    m.StopPressed(source="key", pressed=1_000_000),
    m.Stopped(command="c00006", driver="voice", reason="stop pressed"),
    m.ActionStopped(run="a00005", action="Bye", reason="stop pressed"),
    m.ActionSuperseded(run="a00006", action="Map", reason='replaced by "Bye"', by="a00007"),
    m.StopConfirmed(
        confirmed=["voice"],
        missing=["pepper", "base"],
        elapsed_us=500_000,
        parts={"pepper": ["speech", "motion"]},
        missing_parts={"pepper": ["tablet"]},
        unreached=["base"],
        scope="all",
    ),
    m.StopReleased(source="key"),
    m.ConsoleLost(console="con1", role="wizard", why="closed", part="voice"),
    m.Segment(
        log="2026-03-01T10-00-00_P07_S01",
        session="S01",
        number=1,
        previous="2026-03-01T10-00-00_P07_S01.jsonl",
        copied=True,
        reason="no space left on device",
        dropped=2,
        dropped_samples=40,
    ),
    *BEGINNING,
    *COURSE,
    m.ConsoleAttached(console="con2", role="program", name="stimulus", sees="all", via="lab"),
    m.Command(
        command="c00013",
        verb="say",
        args={"text": "How lovely that you are here!"},
        driver="voice",
        source="key",
        tells=("condition",),
        unfilled={"text": "{greeting}"},
    ),
    m.Notice(
        level="warning",
        text="voice: it cannot say 'How lovely that you are here!'",
        driver="voice",
        tells=("request",),
    ),
    m.ExperimentReloaded(
        experiment_sha256=SHA,
        file_sha256=FILE_SHA,
        changes=["Speech: 'Bye' is new", "conditions are warm, cold, none"],
        telling=["conditions are warm, cold, none"],
    ),
    m.Checkpoint(sha256=SHA, lines=42),
    m.SessionEnd(reason="wizard", sha256=SHA),
    m.Segment(
        log="2026-03-01T10-00-00_P07_S01",
        session="S01",
        number=1,
        next_file="/mnt/stick/spill/2026-03-01T10-00-00_P07_S01.2.jsonl",
        reason="the disk is full",
    ),
    m.SpeechText(
        driver="ears",
        segment=3,
        text="Gern.",
        took_us=310_000,
        words=[m.SpokenWord(text="Gern.", began=600_000, ended=910_000, confidence=0.75)],
        confidence=0.5,
    ),
    m.SensorChanged(sensor="battery", state="ok", every_s=10.0),
    m.MotionArrived(command="c00014", driver="head", evidence="measured"),
    m.MotionInterrupted(
        command="c00015", driver="head", reason="replaced by a newer one", by="c00016"
    ),
    m.CommandMark(command="c00001", driver="voice", sort="word", text="Gott", tells=("condition",)),
    m.CommandMark(command="c00017", driver="head", sort="stroke"),
    m.Marker(text="onset", source="program", at=71_249_000, console="con2"),
    m.ActionScheduled(run="a00018", action="Hello", at=74_000_000),
    m.AddressedChanged(driver="eye", face=2, chosen="hand"),
    m.ListenerJoined(console="con3", driver="ears"),
    m.ListenerLeft(console="con3", driver="ears", duration_us=12_300_000, lost_us=40_000),
    *feature_examples("blocks", "MESSAGES"),
    m.CommandMark(command="c00019", driver="bml", sort="sync", text="n1:start"),
    m.MotionInterrupted(command="c00017", driver="head", reason="stop pressed", stopped=True),
    m.RecorderState(level="failed", lag_us=0, path="S01.jsonl", detail="full", waived=True),
    m.RecordWaived(console="con1"),
    m.Segment(
        log="2026-03-01T10-00-00_P07_S01",
        session="S01",
        number=2,
        unwritten_since=90_000_000,
        waived_at=91_000_000,
    ),
    m.Done(command="c00013", driver="voice", sent={}, latency_us=2_100, duration_us=1_800_000),
    m.Reading(sensor="loudness", value=0.25, driver="ears"),
    m.ProcessStalled(
        driver="voice",
        call="perform say",
        place="driver.py:12 in perform: time.sleep(4)",
        duration_us=4_000_000,
        cause="blocked",
    ),
    m.VerbsUnable(driver="neck", unable=["pose", "gaze"], why="torque is off"),
    m.ParticipantWithdrawn(
        last_removed=12,
        removed=8,
        removed_samples=3,
        removed_until=3_100_000,
        day="2026-05-04",
        version="0.9.0",
        condition="cold",
        trial=2,
    ),
    m.SpeechStarted(driver="ears", segment=4, began=33_100_000, own=True),
    m.SpeechEnded(driver="ears", segment=4, began=33_100_000, ended=35_000_000, own=True),
    m.SpeechText(driver="ears", segment=4, text="Guten Tag.", took_us=420_000, own=True),
    m.SpeechStarted(driver="ears", segment=5, began=35_000_000, own=False, overlap=True),
    m.SpeechEnded(
        driver="ears", segment=5, began=35_000_000, ended=36_400_000, own=False, overlap=True
    ),
    m.SpeechText(
        driver="ears",
        segment=5,
        text="Moment, wie alt ist das?",
        took_us=510_000,
        own=False,
        overlap=True,
        language="de",
        partials=3,
        revised=1,
        first_us=900_000,
    ),
    *feature_examples("lsl", "MESSAGES"),
    *feature_examples("slots", "MESSAGES"),
    *feature_examples("people", "MESSAGES"),
    *feature_examples("proposals", "PROPOSALS"),
    *feature_examples("choices", "MESSAGES"),
    *feature_examples("page", "MESSAGES"),
    *feature_examples("dictation", "MESSAGES"),
)
MESSAGES += further_examples("MESSAGES", MESSAGES)

_PANELS = [
    PanelView(
        title="Speech",
        actions=[
            ActionView(
                name="Hello",
                label="Hello",
                key="h",
                help="greet by code",
                verbs=["say", "play"],
                utterances=["Grüß Gott, {participant}!"],
                without=["eyes"],
            ),
            ActionView(name="Bye", label="Good bye", locked=True),
        ],
    ),
    PanelView(title="Drive", actions=[], locked=True, parts=["body"]),
]

REQUESTS: tuple[r.Request, ...] = (
    r.Hello(ref=1, role="wizard", name="laptop", stream="actions", take_over=True, part="voice"),
    r.Hello(
        ref=2,
        role="program",
        name="stimulus",
        protocol=r.PROTOCOL,
        sees="all",
        via="lab",
    ),
    r.Hello(ref=3, role="wizard", line="tmux"),
    r.Hello(ref=4, role="watcher", name="page", unattended=True),
    r.Beat(ref=2),
    r.Beat(ref=3, line_ok=False),
    r.AskAction(ref=4, sent_us=5_400_000_000, action="Hello", source="key", key="h", age_us=2300),
    r.AskAction(ref=5, action="Map", source="key", key="m", age_us=4_000_000, stale=True),
    r.AskVerb(
        ref=6,
        verb="gaze",
        args={"yaw": 12.5, "pitch": -3},
        on="head",
        source="palette",
        key="left",
        age_us=12_000,
        when_busy="replace",
    ),
    r.AskVerb(ref=19, verb="drive", args={"x": 0.2}, source="key", key="alt+up", stale=True),
    r.AskLetGo(ref=41, key="alt+up"),
    r.AskControls(ref=39, panel="pad", device=""),
    r.AskControls(
        ref=40,
        panel="pad",
        values={"left-bumper": 1.0, "left-stick-y": -0.5},
        device="a pad",
        take_over=True,
        pulse=81_000_000,
        since_us=420_000,
    ),
    r.AskStop(ref=7, source="key"),
    r.AskRelease(ref=8, source="key", missing=["head"]),
    *feature_examples("scripts", "REQUESTS"),
    r.AskCancel(ref=11, run="a00001"),
    r.AskEmptyQueue(ref=12),
    r.AskTakeOver(ref=13),
    r.AskSet(ref=12, participant="P08", condition="warm", trial=1),
    r.AskMarker(ref=13, text="smile"),
    r.AskNote(ref=14, text="the visitor's phone rang"),
    r.AskMistake(ref=15, run="a00001", text="too early"),
    r.AskLock(ref=16, panel="Drive", locked=False),
    *feature_examples("profiles", "REQUESTS"),
    *feature_examples("phases", "REQUESTS"),
    r.AskReload(ref=17, dry_run=True),
    r.AskKeepTyped(ref=38, dry_run=True),
    r.AskPreflight(ref=18),
    r.AskEnd(ref=19, reason="the visitor has left"),
    *feature_examples("study", "REQUESTS"),
    *feature_examples("questionnaires", "REQUESTS"),
    *feature_examples("training", "REQUESTS"),
    r.AskCheck(ref=28, check="the camera sees the whole table", ok=False, text="lamp in the way"),
    r.AskReplay(ref=29, what="seek", by_s=-5.0),
    r.AskReplay(ref=30, what="go", to="12:34"),
    r.AskPicture(ref=33, driver="eye", width=76, height=40, after=17),
    r.AskDescribe(ref=39),
    r.AskAbout(ref=44),
    r.AskPredict(ref=41, action="Hello"),
    r.AskPredict(ref=42, verb="play", args={"move": "nod"}, on="head"),
    r.AskAction(ref=43, action="Hello", at=76_000_000),
    r.AskVerb(ref=44, verb="say", args={"text": "Now"}, at=76_000_000),
    r.AskMarker(ref=40, text="onset", at=73_999_500),
    r.AskPicture(ref=34, width=640, height=480, format="sixel", rate=2.5),
    r.AskSound(ref=40, driver="ears", after=32_000),
    r.AskTalk(ref=41),
    r.AskTalk(ref=42, driver="voice", rate=16_000, data="AQIDBA==", age_us=21_000, lost_s=0.2),
    r.AskUnrecorded(ref=45),
    *feature_examples("lsl", "REQUESTS"),
    *feature_examples("slots", "REQUESTS"),
    *feature_examples("people", "REQUESTS"),
    *feature_examples("proposals", "REQUESTS"),
    *feature_examples("choices", "REQUESTS"),
    *feature_examples("page", "REQUESTS"),
    *feature_examples("dictation", "REQUESTS"),
    r.AskCancel(ref=64, asked=60),
)
REQUESTS += further_examples("REQUESTS", REQUESTS)


def messages() -> list[m.Message]:
    """The session's messages as the hub would have stamped them, 250 ms apart."""
    return [_stamped(number, message) for number, message in enumerate(MESSAGES)]


def _stamped(number: int, message: m.Message) -> m.Message:
    wall = timestamp(BEGIN + timedelta(milliseconds=250 * number))
    if isinstance(message, m.Segment):
        return msgspec.structs.replace(message, ts=wall)
    return msgspec.structs.replace(
        message, seq=number, t=250_000 * number, ts="" if codec.is_sample(message) else wall
    )


def answers() -> list[Answer]:
    """What the host says beside the stream."""
    stream = messages()
    return [
        r.Welcome(
            protocol=r.PROTOCOL,
            console="con1",
            role="wizard",
            part="voice",
            seq=4,
            t=1_100_000,
            title="Museum guide",
            log="recordings/2026-03-01T10-00-00_P07_S01.jsonl",
            panels=_PANELS,
            script=["Hello", "Map"],
            verbs={"voice": ["say"], "head": ["gaze", "play"]},
            variables=["condition", "participant"],
            conditions=["warm", "cold"],
            keyboard="us",
            drivers=["voice", "head"],
            state=[_raw(stream[0]), _raw(stream[4])],
            recent=[_raw(stream[2])],
            settings=s.WelcomeSettings(
                dead_man=3.0,
                abandon_after=600.0,
                driving="held",
                stale_after=1.5,
                profiles=["child"],
                allows={"child": s.Allowance(panels=["Speech"], hide=True)},
                outlines={
                    "panel": {"kind": "panel", "controls": ["pitch", "tempo"]},
                },
            ),
            boot_id="6ba7b810-9dad-11d1-80b4-00c04fd430c8",
            clock_us=5_326_750_000,
            robot_at="robot.local:8765",
        ),
        r.Reply(ref=4, ok=True, run="a00001"),
        r.Reply(
            ref=5, ok=False, reason="too late: the key was pressed 4.0 s ago", hint="press it again"
        ),
        r.Reply(ref=6, ok=False, reason="no participant is set", command="start"),
        r.Reply(ref=7, ok=False, reason=locked_panel("Places").reason),
        r.Reply(ref=17, ok=True, data=["Speech: 'Bye' is new"]),
        r.Reply(
            ref=18,
            ok=False,
            reason="gaze.yaw must be -180 to 180 degrees, not 200",
            run="c00018",
            ended="command.refused",
        ),
        r.Reply(ref=19, ok=False, reason="{colour} is not filled in", needs=["colour"]),
        r.Pulse(t=2_000_000),
        r.Pulse(t=3_000_000, dropped=40),
        r.Pulse(t=3_000_000, rate=0.0),
        r.Replaying(
            t=3_000_000,
            length_us=60_000_000,
            rate=4.0,
            paused=False,
            marks=[(2_000_000, "smile")],
            sorts=["marker"],
        ),
        r.Replaying(
            t=60_000_000, length_us=60_000_000, rate=1.0, paused=True, ended=True, cut_us=9_000_000
        ),
        r.PanelsChanged(
            variables=["participant"],
            stale_after=1.5,
            dead_man=3.0,
            abandon_after=600.0,
            driving="pressed",
            participant_pattern="P\\d\\d",
            title="Museum guide",
            panels=_PANELS,
            script=["Hello"],
            verbs={"voice": ["say"]},
            conditions=["warm", "cold"],
            keyboard="de",
            values={"participant": "P07", "room": "the room of the sea"},
            steps={"head": 8.0, "hip": 3.0, "drive": 0.2, "turn": 15.0},
            repairs=[ActionView(name="repair yes", label="yes", verbs=["say"])],
            profiles=["child"],
            profile="child",
            allows={"child": s.Allowance(panels=["Speech"], hide=True)},
            engagement=s.ModelLimits({"listening": 60.0}, handshake=60.0, attempts=3),
            phases=[PhaseView(name="whales", panels=["Speech"], after=["opening"], planned=120.0)],
            slots={"colour": s.SlotView(["red", "blue"], heard=True, keep="participant")},
            participant_fields={"group": ["child", "adult"]},
            sensors=["engagement", "distance"],
            study=s.StudySettings(design=s.DesignView("latin-square", within=True, trials=3)),
        ),
        PictureShown(
            ref=34,
            driver="eye",
            cameras=["eye"],
            number=18,
            t=3_100_000,
            width=2,
            height=1,
            camera_width=640,
            camera_height=480,
            format="sixel",
            data='\x1bP0;1;0q"1;1;2;1#0;2;0;100;0#0@@\x1b\\',
        ),
        PictureShown(ref=35, driver="eye", cameras=["eye"], why="eye gave no new picture"),
        SoundHeard(
            ref=40,
            driver="ears",
            microphones=["ears"],
            rate=16_000,
            end=32_002,
            age_us=18_000,
            lost=640,
            data="AQIDBA==",
        ),
        SoundHeard(ref=41, driver="ears", microphones=["ears"], why="ears sent no sound"),
        r.Reply(ref=12, ok=True, recorded=False),
    ]


def _raw(message: m.Message) -> msgspec.Raw:
    return msgspec.Raw(codec.encode(message).rstrip())


def golden() -> dict[str, bytes]:
    """What each golden file should hold."""
    return {
        "messages.jsonl": _lines(messages()),
        "requests.jsonl": _lines(REQUESTS),
        "answers.jsonl": _lines(answers()),
    }


def _lines(instances: Iterable[msgspec.Struct]) -> bytes:
    return b"".join(map(codec.encode, instances))


if __name__ == "__main__":
    GOLDEN.mkdir(exist_ok=True)
    for name, content in golden().items():
        (GOLDEN / name).write_bytes(content)
