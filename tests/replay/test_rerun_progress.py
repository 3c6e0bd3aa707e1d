"""The lines of a re-run without a console."""

from __future__ import annotations

import pytest

from woz_tui.analysis.text_format import exact_clock
from woz_tui.protocol import messages as m
from woz_tui.replay.rerun_progress import RerunLines


def lines(progress: RerunLines, *messages: m.Message) -> list[str]:
    return [line.strip() for message in messages for line in progress.lines(message)]


def test_each_command_has_a_line_with_its_lateness_and_streams_have_none() -> None:
    progress = RerunLines(frozenset({("robot", "gaze")}))
    told = lines(
        progress,
        m.RerunStarted(original="x", original_session="S01", commands=2, t=1_000_000),
        m.Command(command="c1", verb="say", args={"text": "Hi"}, driver="robot", source="replay"),
        m.RerunSent(command="c1", original_command="c9", due=2_500_000, late_us=700),
        m.Command(command="c2", verb="gaze", args={}, driver="robot", source="replay"),
        m.RerunSent(command="c2", original_command="c8", due=2_600_000, late_us=900),
        m.Done(command="c1", sent={}, latency_us=1, duration_us=1),
        m.Failed(command="c2", reason="pulled", t=3_000_000),
        m.RerunSkipped(original_command="c7", reason="refused then", t=3_500_000),
    )
    assert told == [
        "2 commands of x",
        "0:01.500  robot.say text Hi  (0.7 ms late)",
        "0:02.000  robot.gaze failed: pulled",
        "0:02.500  c7 is left out: refused then",
    ]
    assert progress.failed == 1


def test_other_peoples_commands_are_none_of_it() -> None:
    progress = RerunLines()
    own = m.Command(command="c1", verb="say", args={}, driver="robot", source="key")
    assert lines(progress, own, m.Failed(command="c1", reason="pulled")) == []
    assert progress.failed == 0


@pytest.mark.parametrize(
    ("us", "said"), [(0, "0:00.000"), (-1500, "-0:00.002"), (62_345_000, "1:02.345")]
)
def test_times_are_read_easily(us: int, said: str) -> None:
    assert exact_clock(us) == said
