"""Sessions by hand: messages at chosen seconds, as a list or as a log.

`python -m tests.analysis.example_sessions FOLDER` writes four sessions to try reports on.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Self

import msgspec

from woz_tui.analysis import figure_counting, timeline_lanes
from woz_tui.analysis.figures import SessionFigures
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.timeline.timeline import timeline_of

SECOND = 1_000_000
STEM = "2026-03-01T10-00-00_P07_S01"


def figures_of(
    messages: Iterable[m.Message],
    options: figure_counting.FigureOptions = figure_counting.DEFAULTS,
) -> SessionFigures:
    """The figures of messages in the order of a log."""
    return figure_counting.figures_of(timeline_of(messages), options)


def timeline_drawing(messages: Iterable[m.Message]) -> timeline_lanes.TimelineDrawing:
    """What is drawn of messages in the order of a log."""
    return timeline_lanes.drawing_of(timeline_of(messages))


class ExampleSession:
    """A session being told. Each method adds lines at `seconds` and returns the teller."""

    def __init__(
        self,
        *,
        participant: str = "P07",
        condition: str = "warm",
        session: str = "S01",
        wizard: str = "W2",
        experiment: str = "experiments/guide.yaml",
        wall: str = "2026-03-01T10:00:00.000000Z",
    ) -> None:
        self.messages: list[m.Message] = []
        self._runs = 0
        self.add(
            0,
            m.SessionStart(
                session=session,
                participant=participant,
                condition=condition,
                wizard=wizard,
                software={"name": "woz-tui", "version": "0.1.0"},
                experiment=experiment,
                experiment_sha256="ab" * 32,
                seed=7,
                clock={"source": "monotonic", "unit": "us", "wall_at_t0": wall},
            ),
        )

    def add(self, seconds: float, *messages: m.Message) -> Self:
        """These lines, all at `seconds`."""
        for message in messages:
            self.messages.append(
                msgspec.structs.replace(
                    message, seq=len(self.messages), t=round(seconds * SECOND), ts=""
                )
            )
        return self

    def act(
        self,
        seconds: float,
        action: str = "Hello",
        panel: str = "Speech",
        *,
        source: str = "key",
        verb: str = "say",
        latency_ms: float = 1.0,
        took: float | None = 0.5,
        end: str = "done",
        console: str = "",
        edited: bool = False,
    ) -> Self:
        """An action of one command from its request to its end; `took` None: no end is told."""
        self._runs += 1
        run, command = f"a{self._runs:05d}", f"c{self._runs:05d}"
        action_requested = m.ActionRequested(
            run=run, action=action, panel=panel, source=source, key="h", console=console,
            edited=edited,
        )  # fmt: skip
        self.add(seconds, action_requested)
        if end == "refused":
            return self.add(seconds, m.ActionRefused(run=run, action=action, reason="locked"))
        latency = round(latency_ms * 1000)
        self.add(
            seconds,
            m.Command(
                command=command, run=run, action=action, panel=panel, verb=verb,
                args={"text": "hello"}, driver="robot", source=source,
            ),
        )  # fmt: skip
        self.add(
            seconds + latency / SECOND,
            m.Dispatched(command=command, driver="robot", latency_us=latency),
        )
        if took is None:
            return self
        duration = round(took * SECOND) - latency
        ends: dict[str, Sequence[m.Message]] = {
            "done": (
                m.Done(
                    command=command, driver="robot", sent={}, latency_us=latency,
                    duration_us=duration,
                ),
                m.ActionDone(run=run, action=action),
            ),
            "failed": (
                m.Failed(command=command, driver="robot", reason="hot"),
                m.ActionFailed(run=run, action=action, reason="hot"),
            ),
            "stopped": (
                m.Stopped(command=command, driver="robot"),
                m.ActionStopped(run=run, action=action),
            ),
        }  # fmt: skip
        return self.add(seconds + took, *ends[end])

    def state(self, seconds: float, was: str, now: str, outcome: str = "o", **more: Any) -> Self:
        """The engagement model moves."""
        return self.add(
            seconds,
            m.EngagementChanged(was=was, now=now, outcome=outcome, why="", verdicts={}, **more),
        )

    def speech(self, began: float, ended: float, segment: int = 1, *, late: float = 0.0) -> Self:
        """The visitor speaks; the line of the end comes `late` seconds after it."""
        first, last = round(began * SECOND), round(ended * SECOND)
        self.add(began, m.SpeechStarted(driver="mic", segment=segment, began=first))
        return self.add(
            ended + late, m.SpeechEnded(driver="mic", segment=segment, began=first, ended=last)
        )

    def end(self, seconds: float) -> Self:
        """The session is over."""
        return self.add(seconds, m.SessionEnd(reason="enough"))

    def lines(self) -> list[bytes]:
        """As in a log."""
        return [
            codec.encode(message) for message in sorted(self.messages, key=lambda each: each.seq)
        ]

    def written(self, folder: Path, stem: str = STEM) -> Path:
        """The log of it."""
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"{stem}.jsonl"
        path.write_bytes(b"".join(self.lines()))
        return path


def in_time(session: ExampleSession) -> list[m.Message]:
    """The messages in the order of time, as a session would have said them."""
    ordered = sorted(session.messages, key=lambda message: message.t)
    return [msgspec.structs.replace(message, seq=at) for at, message in enumerate(ordered)]


def seconds(values: Iterable[int]) -> list[float]:
    """Microseconds in seconds."""
    return [value / SECOND for value in values]


def study(folder: Path) -> list[Path]:
    """Two participants in two conditions each: four sessions with known figures.

    P01 warm: reactions 1 and 3 s; P01 cold: 2 s and a miss; P02 warm: 5 s; P02 cold: 4 s.
    """
    plan = {
        ("P01", "warm", "S01"): (1.0, 3.0),
        ("P01", "cold", "S02"): (2.0, None),
        ("P02", "warm", "S03"): (5.0,),
        ("P02", "cold", "S04"): (4.0,),
    }
    paths = []
    for number, ((who, condition, session), reactions) in enumerate(plan.items()):
        example = ExampleSession(
            participant=who, condition=condition, session=session,
            wizard="W1" if number == 0 else "W2", wall=f"2026-03-0{number + 1}T10:00:00.000000Z",
        )  # fmt: skip
        at = 10.0
        for reaction in reactions:
            example.speech(at, at + 2.0)
            if reaction is not None:
                example.act(at + 2.0 + reaction)
            at += 30.0
        example.messages.sort(key=lambda message: message.t)
        example.messages = [
            msgspec.structs.replace(message, seq=place)
            for place, message in enumerate(example.messages)
        ]
        example.end(100.0)
        stem = f"2026-03-0{number + 1}T10-00-00_{who}_{session}"
        paths.append(example.written(folder, stem))
    return paths


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    study(folder)
