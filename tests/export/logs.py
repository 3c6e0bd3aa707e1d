"""Logs for the tests: messages written as a recorder would, and sessions at random."""

from __future__ import annotations

import hashlib
import wave
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path

import msgspec
from hypothesis import strategies as st

from tests.protocol.feature_examples import feature_examples
from woz_tui.export.event_model import ExportSession
from woz_tui.export.log_sources import find_sources, read_session
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.system.clock import timestamp

SHA = "0123456789abcdef" * 4
BEGIN = datetime(2026, 3, 1, 10, tzinfo=UTC)
STEM = "2026-03-01T10-00-00_P07_S01"
#: Seconds since the session's start, and what was said then.
Timed = tuple[float, m.Message]


def start(participant: str = "P07", session: str = "S01", **others: object) -> m.SessionStart:
    """The first line of a log."""
    fields: dict[str, object] = {
        "session": session,
        "participant": participant,
        "condition": "warm",
        "wizard": "W2",
        "software": {"name": "woz-tui", "version": "0.1.0"},
        "experiment": "experiments/museum guide.yaml",
        "experiment_sha256": SHA,
        "seed": 7,
        "clock": {"source": "monotonic", "wall_at_t0": "2026-03-01T10:00:00.000000Z"},
    }
    return m.SessionStart(**(fields | others))  # type: ignore[arg-type]


def write(folder: Path, course: Iterable[Timed], stem: str = STEM, *, ended: bool = True) -> Path:
    """A whole log with its two files; `ended` adds the last line, with its sum."""
    folder.mkdir(parents=True, exist_ok=True)
    log, samples = folder / f"{stem}.jsonl", folder / f"{stem}.samples.jsonl"
    actions, others = bytearray(), bytearray()
    begin = datetime.strptime(f"{stem[:19]}Z", "%Y-%m-%dT%H-%M-%S%z")
    seq, t = -1, 0
    for seq, (seconds, message) in enumerate(course):
        t = round(seconds * 1_000_000)
        ts = (
            ""
            if codec.is_sample(message)
            else timestamp(begin + timedelta(seconds=min(seconds, 1e9)))
        )
        line = codec.encode(msgspec.structs.replace(message, seq=seq, t=t, ts=ts))
        (others if codec.is_sample(message) else actions).extend(line)
    if ended:
        end = m.SessionEnd(reason="wizard", sha256=hashlib.sha256(actions).hexdigest())
        actions += codec.encode(msgspec.structs.replace(end, seq=seq + 1, t=t))
    log.write_bytes(actions)
    samples.write_bytes(others)
    return log


def session_of(folder: Path, course: Iterable[Timed], *, redact: bool = False) -> ExportSession:
    """The session that comes out of such a log."""
    return read_session(find_sources([write(folder, course)])[0][0], redact=redact)


def speak(folder: Path, name: str, seconds: float, level: int = 1000, rate: int = 8000) -> Path:
    """A file of sound: one channel, every sample `level`."""
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(rate)
        file.writeframes(level.to_bytes(2, "little", signed=True) * round(seconds * rate))
    return path


def visit() -> list[Timed]:
    """A short visit in which something of every sort happens."""
    say: dict[str, m.Json] = {"text": 'Hello, "dear"\tvisitor!\nÇa va? <&>'}
    return [
        (0, start()),
        (0.5, m.TrialStarted(trial=1, condition="cold", planned=2)),
        (
            1,
            m.EngagementChanged(was="Idle", now="Engaged", outcome="came", why="near", verdicts={}),
        ),
        (1.2, m.reading("distance", 1.25, unit="m", driver="range")),
        (1.3, m.reading("distance", None, unit="m")),
        (1.4, m.reading("identity", None, text="V012")),
        (2, m.ActionRequested(run="r1", action="Hello", panel="Speech", source="key", key="h")),
        (
            2.001,
            m.Command(command="c1", run="r1", action="Hello", verb="say", args=say, source="key"),
        ),
        (2.011, m.Dispatched(command="c1", driver="voice", latency_us=10_000)),
        (3.5, m.Done(command="c1", sent=say, latency_us=10_000, duration_us=1_489_000)),
        (3.5, m.ActionDone(run="r1", action="Hello")),
        (3.6, m.SpeechStarted(driver="ears", segment=1, began=3_550_000)),
        (5, m.SpeechEnded(driver="ears", segment=1, began=3_550_000, ended=4_900_000)),
        (5.6, m.SpeechText(driver="ears", segment=1, text="What is this?", took_us=700_000)),
        (6, m.ActionRequested(run="r2", action="Nod", panel="Gestures", source="script")),
        (6, m.ActionRefused(run="r2", action="Nod", reason="locked")),
        (6.1, m.Mistake(run="r1", action="Hello", text="too early")),
        (6.2, m.Marker(text="=1+1")),
        (6.2, m.Marker(text="smile")),
        (6.3, m.Note(text="a child\r\nhas joined")),
        (7, m.StopPressed(source="key")),
        (7.5, m.StopConfirmed(confirmed=["voice"], missing=[], elapsed_us=500_000)),
        (8, m.StopReleased(source="key")),
        (8.5, m.TrialEnded(trial=1, outcome="done")),
        *feature_examples("questionnaires", "VISIT"),
        (11, m.ActionRequested(run="r3", action="Dance", panel="Gestures", source="key")),
    ]


# -- at random --------------------------------------------------------------------------------

#: Control characters, quotes and line ends more often than chance would have them.
WORDS = st.one_of(
    st.text(max_size=12),
    st.text(
        st.sampled_from("\x00\x01\x0b\x1f\x7f\x85\ufffe\t\r\n\"'=&<>]\\ aé😀\u202e"), max_size=8
    ),
)
_RUNS = st.sampled_from(["r1", "r2", "r3"])
_NAMES = st.sampled_from(["Hello", "Nod", "=Sum", ""])
_PANELS = st.sampled_from(["", "Speech", "a\nb", "Speech-2", 'the "right" one'])
_SETTINGS = st.dictionaries(
    st.sampled_from(["volume", "eyes", "=1+1"]), st.one_of(st.none(), st.booleans(), WORDS)
)

MESSAGES: Sequence[st.SearchStrategy[m.Message]] = (
    st.builds(m.ActionRequested, run=_RUNS, action=_NAMES, panel=_PANELS, source=st.just("key")),
    st.builds(m.ActionDone, run=_RUNS, action=_NAMES),
    st.builds(m.ActionStopped, run=_RUNS, action=_NAMES, reason=WORDS),
    st.builds(
        m.Command,
        command=_RUNS,
        run=_RUNS,
        verb=st.sampled_from(["say", "play"]),
        args=st.fixed_dictionaries({"text": WORDS}),
        source=st.just("key"),
    ),
    st.builds(m.Dispatched, command=_RUNS, latency_us=st.integers(0, 100_000)),
    st.builds(m.Failed, command=_RUNS, reason=WORDS),
    st.builds(
        m.EngagementChanged,
        was=st.sampled_from("AB"),
        now=st.sampled_from("AB"),
        outcome=st.just("went"),
        why=WORDS,
        verdicts=st.just({}),
    ),
    st.builds(
        m.SpeechEnded,
        driver=st.just("ears"),
        segment=st.integers(1, 3),
        began=st.integers(-1000, 5_000_000),
        ended=st.integers(0, 5_000_000),
    ),
    st.builds(m.SpeechText, driver=st.just("ears"), segment=st.integers(1, 4), text=WORDS),
    st.builds(m.TrialStarted, trial=st.integers(1, 3)),
    st.builds(m.TrialEnded, trial=st.integers(1, 3), outcome=st.just("done"), text=WORDS),
    st.builds(m.BreakStarted, text=WORDS),
    st.builds(m.StopPressed, source=st.just("key")),
    st.builds(m.StopReleased, source=st.just("key")),
    st.builds(m.Marker, text=WORDS),
    st.builds(m.Note, text=WORDS),
    st.builds(m.Mistake, run=_RUNS, text=WORDS),
    st.builds(m.DriverLost, driver=st.just("head"), detail=WORDS),
    st.builds(m.DriverConnected, driver=st.just("head")),
    st.builds(
        m.SettingsShown,
        driver=st.just("head"),
        values=_SETTINGS,
        wanted=_SETTINGS,
        conflicts=st.lists(WORDS, max_size=2),
    ),
    st.builds(m.SessionChanged, participant=st.sampled_from(["P07", "P08"])),
    *(
        st.builds(
            answered,
            questionnaire=st.just("robot"),
            item=st.sampled_from(["a", "b"]),
            question=WORDS,
            value=st.one_of(st.none(), st.floats(allow_nan=False, allow_infinity=False)),
            text=WORDS,
        )
        for answered in feature_examples("questionnaires", "ANSWERED")
    ),
)
#: Moments some of which are the same, in any distance.
_STEPS = st.sampled_from([0.0, 0.0, 0.000001, 0.0004, 0.02, 0.5, 3.0])


@st.composite
def courses(draw: st.DrawFn) -> list[Timed]:
    """A session at random: anything may be missing, anything may come twice."""
    course: list[Timed] = [(0.0, start())] if draw(st.booleans()) else []
    now = 0.0
    for message in draw(st.lists(st.one_of(MESSAGES), min_size=1, max_size=25)):
        now += draw(_STEPS)
        course.append((now, message))
    return course
