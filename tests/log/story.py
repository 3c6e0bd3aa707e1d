"""A short session in which every kind of message occurs, recorded by the real hub and recorder.

It makes the golden log of the present schema:

    python -m tests.log.story

writes it anew after a wanted change. Golden logs of older schemas are never written again.
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from tests.log.bench import Bench, until
from tests.protocol.study_examples import BEGINNING, COURSE
from woz_tui.protocol import messages as m
from woz_tui.system.clock import timestamp

GOLDEN = Path(__file__).parent / "golden" / f"v{m.SCHEMA}"
SHA = "0123456789abcdef" * 4


def tell(folder: Path) -> None:
    """Record the story into `folder`/recordings and, after the disk is full, `folder`/spill."""
    it = Bench(folder).begin()
    try:
        for message in _morning():
            _say(it, message)
        _checkpoint(it)
        it.synced()
        it.disk.faults[it.home] = "full"
        _say(it, m.Note(text="the disk is full from here on"))
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        for message in _afternoon():
            _say(it, message)
            it.synced()
        _checkpoint(it)
        _say(it, m.SessionEnd(reason="wizard", sha256=it.recorder.digest()[0]))
    finally:
        it.recorder.close()


def _say(it: Bench, message: m.AnyMessage) -> None:
    it.clock.advance(0.25)
    it.hub.publish(message)


def _checkpoint(it: Bench) -> None:
    digest, lines = it.recorder.digest()
    _say(it, m.Checkpoint(sha256=digest, lines=lines))
    _say(it, m.ClockTie(wall=timestamp(it.clock.wall())))


def _morning() -> list[m.AnyMessage]:
    """Start, drivers, visitor, and one of each way an action can end."""
    return [
        m.SessionStart(
            session="S01",
            participant="P07",
            condition="warm",
            wizard="W2",
            software={"name": "woz-tui", "version": "0.1.0"},
            experiment="guide.yaml",
            experiment_sha256=SHA,
            seed=7,
            clock={
                "source": "monotonic",
                "unit": "us",
                "wall_at_t0": "2026-03-01T10:00:00.000000Z",
            },
        ),
        *BEGINNING,
        m.DriverConnecting(driver="head", detail="/dev/ttyUSB0"),
        m.DriverConnected(driver="head", detail="3 servos"),
        m.ConsoleAttached(console="k1", role="wizard"),
        m.RecorderState(level="ok", lag_us=4_100, path="recordings/S01.jsonl"),
        m.reading("distance", 2.5, driver="belly", unit="m", raw=250.0),
        m.reading("distance", float("nan"), driver="belly", unit="m", raw=65_535.0),
        m.reading("identity", None, text="P07", driver="camera"),
        m.SensorChanged(sensor="distance", state="stale", was="ok", why="no value for 1 s"),
        m.EngagementAdopted(settings={"samples": 8, "threshold": 0.5, "start_up": "zero-fill"}),
        m.EngagementChanged(
            was="EngagedWithUnknown",
            now="Handshake",
            outcome="handshake",
            why="to be introduced",
            verdicts={"presence": 1, "gaze": 1, "distance": None, "identity": "Unknown"},
        ),
        m.VisitorChanged(visitor="V012", what="met", about={"address": "formal"}),
        m.EngagementShown(
            state="Handshake",
            since=2_500_000,
            trail=["EngagedWithUnknown", "Handshake"],
            signs={
                "presence": m.SignShown(
                    raw=1.0, verdict=1, count=8, needed=4, places=8, filter="fifo"
                ),
                "distance": m.SignShown(needed=4, places=8, filter="median", stale=True),
            },
            run="run",
            uses=["presence", "gaze"],
            social_distance=1.3,
            engaged=True,
            attempt=1,
        ),
        m.SpeechStarted(driver="microphone", segment=1, began=2_900_000),
        m.SpeechEnded(
            driver="microphone",
            segment=1,
            began=2_900_000,
            ended=4_100_000,
            file="S01.media/speech-0001.wav",
            loudest=0.31,
        ),
        m.SpeechText(driver="microphone", segment=1, text="my name is not told", took_us=700_000),
        m.ActionRequested(run="r1", action="Hello", panel="Speech", source="key", key="h"),
        m.Command(
            command="c1",
            run="r1",
            action="Hello",
            panel="Speech",
            verb="say",
            args={"text": "Hello, nice to see you: ça va?"},
            driver="voice",
            source="key",
            key="h",
            deadline_us=9_000_000,
        ),
        m.Dispatched(command="c1", driver="voice", latency_us=223),
        m.Progress(command="c1", driver="voice", expected_us=1_500_000),
        m.Done(
            command="c1",
            driver="voice",
            sent={"text": "Hello, nice to see you: ça va?"},
            latency_us=223,
            duration_us=1_554_211,
        ),
        m.ActionDone(run="r1", action="Hello"),
        m.ActionRequested(run="r2", action="Nod", source="script", console="k1"),
        m.Command(
            command="c2",
            run="r2",
            verb="pose",
            args={"joints": {"pitch": -80.0}, "seconds": 0.5},
            source="script",
            limit_s=5.0,
            when_busy="replace",
        ),
        m.Failed(command="c2", driver="head", reason="servo 2 is hot", remedy="let it cool"),
        m.ActionFailed(run="r2", action="Nod", reason="servo 2 is hot"),
        m.DriverFaulted(driver="head", detail="pitch", remedy="let it cool"),
        m.Command(command="c3", verb="home", args={}, driver="head", source="program"),
        m.TimedOut(command="c3", driver="head", reason="longer than 30 s"),
        m.LaneFaulted(driver="head", lane="body", command="c3"),
        m.LaneRecovered(driver="head", lane="body"),
        m.Mistake(run="r2", action="Nod", text="wrong key"),
        m.Marker(text="visitor laughs"),
        m.Note(text="a child has joined"),
        m.ScriptMoved(position=1),
        m.PhaseChanged(phase="opening", planned_us=120_000_000),
        m.ActionsFilled(
            actions={
                "Hello": [
                    [m.FilledCall(verb="say", args={"text": "Hello P07."}, driver="robot")],
                    0.5,
                ]
            }
        ),
        m.PanelLocked(panel="Emotion", locked=True),
        m.ModeChanged(driver="head", was="normal", now="demo", why="nobody near"),
        m.SessionChanged(condition="cold", trial=2),
        m.FaceShown(
            driver="body",
            width=8,
            rows="00 3c 7e 66 66 7e 3c 00",
            emotion="happy",
            intensity=0.75,
            brightness=0.5,
        ),
        m.BodyChanged(driver="body", values={"mode": "normal", "tempo": 2.133, "breathing": True}),
        m.ControlsMoved(
            driver="panel",
            values={"pitch": 66, "tempo": 3},
            waiting=["tempo"],
            targets={"tempo": 40},
            lit=["happy"],
        ),
        m.SettingsShown(
            driver="pepper",
            values={"state": "interactive", "volume": 0.7, "blinking": True, "tablet": None},
            wanted={"state": "solitary"},
            conflicts=["Awareness is off, so engagement has nothing to follow."],
        ),
        m.ProfileChanged(profile="child", source="palette"),
    ]


def _afternoon() -> list[m.AnyMessage]:
    """The stop, what it ends, and the way home."""
    return [
        m.reading("loudness", 0.25, driver="microphone"),
        m.ActionRequested(run="r3", action="Wander", source="key", key="w"),
        m.Command(command="c4", run="r3", verb="drive", args={"x": 1.0}, source="key"),
        m.Command(command="c5", verb="gaze", args={"yaw": 10.0}, source="key"),
        m.Superseded(command="c5", by="c6"),
        m.Command(command="c6", verb="gaze", args={"yaw": 12.0}, source="key"),
        m.StopPressed(source="key"),
        m.Stopped(command="c4", driver="base", reason="stop"),
        m.Refused(command="c6", code="stopped", reason="the stop is pressed"),
        m.ActionStopped(run="r3", action="Wander", reason="stop"),
        m.StopConfirmed(
            confirmed=["head"],
            missing=["base", "pepper"],
            elapsed_us=500_000,
            parts={"pepper": ["speech", "motion"]},
            missing_parts={"pepper": ["tablet"]},
        ),
        m.StopReleased(source="key"),
        m.ActionRequested(run="r4", action="Nod", source="key", key="n"),
        m.ActionRefused(run="r4", action="Nod", reason="the panel is locked"),
        m.ActionRequested(run="r5", action="Tell", source="key", key="t"),
        m.ActionRequested(run="r6", action="Hello", source="key", key="h"),
        m.ActionSuperseded(run="r5", action="Tell", reason='replaced by "Hello"', by="r6"),
        m.ActionDone(run="r6", action="Hello"),
        m.DriverLost(driver="base", detail="no answer", remedy="check the cable"),
        m.Notice(level="warning", text="base is gone", remedy="check the cable"),
        m.ExperimentReloaded(experiment_sha256=SHA, changes=["panels[0]: one action more"]),
        m.MotionArrived(command="c00001", driver="head"),
        m.MotionInterrupted(command="c00002", driver="head", reason="stop pressed"),
        m.CommandMark(command="c00001", driver="voice", sort="word", text="Hello"),
        m.ActionScheduled(run="r4", action="Nod", at=60_000_000),
        m.AddressedChanged(driver="eye", face=2, chosen="hand"),
        m.ListenerJoined(console="k3", driver="head"),
        m.ListenerLeft(console="k3", driver="head", duration_us=5_200_000, lost_us=80_000),
        m.BlockPlanned(
            command="c00001",
            driver="bml",
            block="bml1",
            begin=61_000_000,
            duration_us=2_500_000,
            behaviours=[m.PlannedBehaviour(id="n1", sort="head", points={"start": 0})],
        ),
        m.BlockTrouble(
            command="c00001",
            driver="bml",
            block="bml1",
            problem=m.BlockProblem(sort="NO_SUCH_TARGET", text="where is moon?", about="g1"),
        ),
        m.RecordWaived(console="k1"),
        *COURSE,
        m.ConsoleLost(console="k1", role="wizard", why="left"),
    ]


def write_anew() -> None:
    """Replace the golden log of the present schema."""
    with tempfile.TemporaryDirectory() as folder:
        tell(Path(folder))
        shutil.rmtree(GOLDEN, ignore_errors=True)
        shutil.copytree(folder, GOLDEN)


if __name__ == "__main__":
    write_anew()
