"""Logs of sessions, written message by message at the times a test says, and their reports."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from tests.protocol.feature_examples import feature_examples
from woz_tui.analysis.session_reading import ReportExtras, SessionReport, read_report
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

SHA = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"
#: Text that would do harm if it became markup, script, or the end of the page's data.
HOSTILE = (
    "<script>window.hacked=1</script>",
    "</script><script>window.hacked=2</script>",
    '"><img src=x onerror="window.hacked=3">',
    "<!--<script>window.hacked=4",
    "'-window.hacked=5-' \u2028\u2029 \\u003c &lt;b&gt; ${7*7} $title",
    "\u202e right to left \u2067 and \u0000 nothing \u0007",
)


@dataclass
class SessionLogBuilder:
    """A log in the making, called after `code`, by default the session's. Times are seconds since
    the session began.
    """

    participant: str = "P07"
    condition: str = "warm"
    session: str = "S01"
    code: str = ""
    told: list[tuple[float, m.Message]] = field(default_factory=list)
    runs: int = 0

    def tell(self, at: float, *messages: m.Message) -> None:
        """These messages at that time."""
        self.told += [(at, message) for message in messages]

    def act(
        self,
        at: float,
        action: str,
        panel: str,
        seconds: float,
        *,
        end: str = "done",
        say: str = "",
    ) -> str:
        """An action with one command, from its request to its end; its run."""
        self.runs += 1
        run, command = f"a{self.runs:05}", f"c{self.runs:05}"
        action_requested = m.ActionRequested(
            run=run, action=action, panel=panel, source="key", key="h"
        )
        order = m.Command(
            command=command,
            run=run,
            action=action,
            panel=panel,
            verb="say" if say else "play",
            args={"text": say} if say else {"move": action},
            driver="voice",
            source="key",
        )
        self.tell(at, action_requested, order)
        if end != "refused":
            self.tell(at + 0.012, m.Dispatched(command=command, driver="voice", latency_us=12_000))
        self.tell(at + seconds, *_ends(end, run, command, action, seconds))
        return run

    def speech(self, segment: int, began: float, ended: float, text: str) -> None:
        """What the visitor says."""
        us, end_us = round(began * 1e6), round(ended * 1e6)
        self.tell(began, m.SpeechStarted(driver="ear", segment=segment, began=us))
        self.tell(ended, m.SpeechEnded(driver="ear", segment=segment, began=us, ended=end_us))
        self.tell(ended + 0.2, m.SpeechText(driver="ear", segment=segment, text=text))

    def states(self, *moves: tuple[float, str]) -> None:
        """The engagement model enters these states."""
        was = "Wait"
        for at, now in moves:
            self.tell(
                at,
                m.EngagementChanged(was=was, now=now, outcome="moves", why="near", verdicts={}),
            )
            was = now

    def write(self, folder: Path) -> Path:
        """The log's file of actions; samples go to theirs."""
        stem = f"2026-03-01T10-00-00_{self.participant}_{self.code or self.session}"
        actions, samples = bytearray(), bytearray()
        begin = (0.0, _start(self))
        for seq, (at, message) in enumerate([begin, *sorted(self.told, key=lambda one: one[0])]):
            t = round(at * 1e6)
            stamped = msgspec.structs.replace(message, seq=seq, t=t)
            if codec.is_sample(message):
                samples += codec.encode(stamped)
            else:
                ts = f"2026-03-01T10:{int(at) // 60 % 60:02}:{at % 60:09.6f}Z"
                actions += codec.encode(msgspec.structs.replace(stamped, ts=ts))
        path = folder / f"{stem}.jsonl"
        path.write_bytes(actions)
        if samples:
            (folder / f"{stem}.samples.jsonl").write_bytes(samples)
        return path

    def report(self, folder: Path) -> SessionReport:
        """What is found out about it."""
        return read_report(self.write(folder), extras=ReportExtras(timeline=True, curves=True))


def _start(story: SessionLogBuilder) -> m.SessionStart:
    return m.SessionStart(
        session=story.session,
        participant=story.participant,
        condition=story.condition,
        wizard="W2",
        software={"name": "woz-tui", "version": "0.1.0"},
        experiment="museum.yaml",
        experiment_sha256=SHA,
        seed=7,
        clock={"source": "monotonic", "unit": "us", "wall_at_t0": "2026-03-01T10:00:00.000000Z"},
    )


def _ends(end: str, run: str, command: str, action: str, seconds: float) -> Sequence[m.Message]:
    if end == "failed":
        reason = "the port does not answer"
        return (
            m.Failed(command=command, driver="voice", reason=reason),
            m.ActionFailed(run=run, action=action, reason=reason),
        )
    if end == "refused":
        return (
            m.Refused(command=command, driver="voice", code="busy", reason="it is busy"),
            m.ActionRefused(run=run, action=action, reason="it is busy"),
        )
    if end == "stopped":
        return (
            m.Stopped(command=command, driver="voice", reason="stopped"),
            m.ActionStopped(run=run, action=action, reason="the stop was pressed"),
        )
    done = m.Done(
        command=command,
        driver="voice",
        sent={},
        latency_us=12_000,
        duration_us=round(seconds * 1e6) - 12_000,
    )
    return (done, m.ActionDone(run=run, action=action))


def ordinary(
    participant: str = "P07", condition: str = "warm", session: str = "S01", shift: float = 0.0
) -> SessionLogBuilder:
    """Two minutes in which most of what can happen does; `shift` delays the wizard's answers."""
    builder = SessionLogBuilder(participant, condition, session)
    builder.tell(1, m.DriverConnected(driver="voice"), m.DriverConnected(driver="head"))
    builder.tell(2, m.TrialStarted(trial=1, condition=condition, planned=2))
    builder.states(
        (5, "PersonDetected"), (9, "EngagedWithKnown"), (50, "Wait"), (70, "EngagedWithKnown")
    )
    builder.tell(
        110,
        m.EngagementChanged(
            was="EngagedWithKnown", now="Wait", outcome="left", why="", verdicts={}
        ),
    )
    builder.speech(1, 10, 12, "How long is the whale?")
    builder.speech(2, 30, 33, "And how heavy?")
    builder.act(10 + shift, "Hello", "Speech", 2.5, say="Hello, I am the guide.")
    mistake = builder.act(13 + shift, "Whale", "Speech", 4, say="The whale is 18 metres long.")
    builder.act(14 + shift, "Nod", "Body", 1.5)
    builder.act(34 + shift, "Point", "Body", 3, end="failed", say="Look there.")
    builder.act(40 + shift, "Dance", "Body", 5, end="refused")
    builder.act(80 + shift, "Bye", "Speech", 6, end="stopped", say="Good bye.")
    builder.tell(20, m.Mistake(run=mistake, action="Whale", text="too early"))
    builder.tell(25, m.Marker(text="laughs", source="key"), m.Note(text="hesitates before the map"))
    builder.tell(55, m.TrialEnded(trial=1, outcome="done"), m.BreakStarted(text="a glass of water"))
    builder.tell(65, m.BreakEnded(), m.TrialStarted(trial=2, condition=condition))
    builder.tell(86 + shift, m.StopPressed(source="key", scope="all"))
    builder.tell(
        86.1 + shift, m.StopConfirmed(confirmed=["head"], missing=["voice"], elapsed_us=100_000)
    )
    builder.tell(92 + shift, m.StopReleased(source="wizard"))
    builder.tell(95, m.DriverLost(driver="head", detail="unplugged"))
    builder.tell(101, m.DriverConnected(driver="head"))
    builder.tell(
        102, m.SettingsShown(driver="head", values={"volume": 0.8}, wanted={"volume": 0.6})
    )
    builder.tell(112, m.SettingsShown(driver="head", values={"volume": 0.6}))
    builder.tell(115, m.TrialEnded(trial=2, outcome="aborted", text="the phone rang"))
    _ask(builder, 116)
    for place in range(240):
        at = place / 2
        builder.tell(at, m.reading("distance", 1 + (at % 40) / 20, driver="belly", unit="m"))
        builder.tell(at, m.reading("loudness", 0.4 if 10 <= at <= 12 else 0.02, driver="ear"))
    builder.tell(120, m.SessionEnd(reason="wizard", sha256=""))
    return builder


def _ask(builder: SessionLogBuilder, at: float) -> None:
    scale = {"name": "friendly", "question": "It was friendly.", "low": 1, "high": 7}
    for asked in feature_examples("questionnaires", "ASKED"):
        builder.tell(at, *asked("robot", "The robot", scale, trial=2, value=6.0))


def hostile() -> SessionLogBuilder:
    """A session in which everything that can be typed or said is an attack."""
    builder = SessionLogBuilder("P66", HOSTILE[0], HOSTILE[1], "S66")
    builder.tell(1, m.DriverLost(driver=HOSTILE[2], detail=HOSTILE[3]))
    builder.states((2, HOSTILE[4]), (4, HOSTILE[0]))
    for place, text in enumerate(HOSTILE):
        at = 5.0 + place
        builder.tell(at, m.Note(text=text), m.Marker(text=text, source=text))
        run = builder.act(at, text, text, 0.5, say=text)
        builder.tell(at + 0.6, m.Mistake(run=run, action=text, text=text))
        builder.speech(place + 1, at, at + 0.3, text)
        builder.tell(at, m.StopPressed(source=text, scope=text), m.StopReleased(source=text))
        item = {"name": text, "question": text, "text": True}
        for asked in feature_examples("questionnaires", "ASKED"):
            builder.tell(at, *asked(text, text, item, text=text))
        builder.tell(
            at,
            m.TrialStarted(trial=place, condition=text),
            m.PerceptionChanged(hidden=[text], blurred=[text]),
        )
        wicked: dict[str, m.Json] = {text: text}
        builder.tell(
            at, m.SettingsShown(driver=text, values=wicked, wanted=wicked, conflicts=[text])
        )
        builder.tell(at + 0.7, m.TrialEnded(trial=place, outcome=text, text=text))
    builder.tell(20, m.reading("distance", 1.0, driver=HOSTILE[0], unit=HOSTILE[2]))
    builder.tell(21, m.SessionEnd(reason=HOSTILE[1], sha256=""))
    return builder
