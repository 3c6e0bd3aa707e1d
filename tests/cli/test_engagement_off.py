"""Time in which a model is switched off, or is not there, in a comparison: it is in no state."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.analysis.example_sessions import ExampleSession, figures_of, in_time
from tests.replay.rerun_rig import write_log
from tests.replay.test_rerun_plan import LOG, START
from woz_tui import cli
from woz_tui.analysis.engagement_comparison import engaged_share
from woz_tui.analysis.engagement_rerun import RecordedModel, rerun
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_json import settings_to_json
from woz_tui.log.log_reader import Damage
from woz_tui.protocol import messages as m
from woz_tui.sensing.engagement_model import Transition

Timed = tuple[float, m.Message]
ADOPTED = m.EngagementAdopted(settings=settings_to_json(EngagementSettings()))
GONE = m.EngagementAdopted(settings={})


def switched(at: float, run: str) -> list[Timed]:
    name = f"c{at}"
    command = m.Command(
        command=name, verb="engagement", args={"run": run}, driver="engagement", source="key"
    )
    done = m.Done(command=name, driver="engagement", sent={"run": run}, latency_us=0, duration_us=0)
    return [(at, command), (at, done)]


def engagement_changed(at: float, was: str, now: str) -> Timed:
    return at, m.EngagementChanged(was=was, now=now, outcome="x", why="", verdicts={})


def visit(*more: Timed) -> list[Timed]:
    """Engaged from 20 to 70 of 100 seconds, as the log says."""
    course = [
        engagement_changed(20, "Wait", "EngagedWithUnknown"),
        *more,
        engagement_changed(70, "EngagedWithUnknown", "Wait"),
        (100, m.SessionEnd(reason="wizard")),
    ]
    return sorted(course, key=lambda each: each[0])


def run_comparison(
    folder: Path, capsys: pytest.CaptureFixture[str], *messages: Timed
) -> tuple[dict[str, m.Json], str]:
    path = write_log(folder / LOG, [(0, START), *messages])
    assert cli.main(["engagement", str(path), "--compare"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    figures = rerun(path, None, Damage())
    assert figures.end == 100_000_000
    assert cli.main(["engagement", str(path), "--compare", "--json"]) == 0
    return json.loads(capsys.readouterr().out)["summary"], text


def test_time_off_is_counted_apart(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    off = [*switched(40, "off"), *switched(60, "run")]
    figures, text = run_comparison(tmp_path, capsys, (0, ADOPTED), *visit(*off))
    assert figures["engaged_recorded"] == 30 / 80
    assert (figures["off_recorded"], figures["off_computed"]) == (20.0, 20.0)
    assert "model off or missing: 20.0 s recorded, 20.0 s computed" in text
    assert "37.5% of the time recorded" in text


def test_nothing_is_said_of_a_model_that_was_never_off(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    figures, text = run_comparison(tmp_path, capsys, (0, ADOPTED), *visit())
    assert (figures["engaged_recorded"], figures["off_recorded"]) == (0.5, 0.0)
    assert "model off or missing" not in text


def test_one_that_is_gone_begins_anew(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    course = [
        (0.0, ADOPTED),
        engagement_changed(20, "Wait", "EngagedWithUnknown"),
        (40.0, GONE),
        (50.0, ADOPTED),
        (100.0, m.SessionEnd(reason="wizard")),
    ]
    figures, _ = run_comparison(tmp_path, capsys, *course)
    assert (figures["engaged_recorded"], figures["off_recorded"]) == (round(20 / 90, 4), 10.0)


def test_one_that_is_never_on_has_no_share(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    start = m.EngagementAdopted(settings=settings_to_json(EngagementSettings(start="off")))
    figures, text = run_comparison(
        tmp_path, capsys, (0, start), (100, m.SessionEnd(reason="wizard"))
    )
    assert figures["engaged_recorded"] is None
    assert figures["engaged_computed"] is None
    assert "engaged: ? of the time" in text


STATES = st.sampled_from(["Wait", "PersonDetected", "EngagedWithUnknown", "UserSpeaks"])
STEPS = st.one_of(
    STATES,
    st.sampled_from([ADOPTED, GONE, m.EngagementAdopted(settings={"start": "off"})]),
    st.sampled_from(["run", "hold", "off"]).map(lambda run: switched(0, run)[1][1]),
)


@given(st.lists(st.tuples(st.integers(1, 20), STEPS), max_size=12))
def test_the_share_is_the_reports(steps: list[tuple[int, str | m.Message]]) -> None:
    """Whatever a log tells, both rooms read it alike."""
    session = ExampleSession().add(0, ADOPTED)
    at, state = 0, "Wait"
    for pause, what in steps:
        at += pause
        if not isinstance(what, str):
            session.add(at, what)
            if isinstance(what, m.EngagementAdopted):
                state = state if what.settings and state else "Wait" if what.settings else ""
        elif state:  # where no model is, nothing moves
            session.state(at, state, what)
            state = what
    messages = in_time(session.end(at + 5))
    then = RecordedModel(present=False, on=True)
    path: list[Transition] = []
    for message in messages:
        then.apply(message)
        if isinstance(message, m.EngagementChanged):
            path.append(Transition(message.t, message.was, message.now, "", "", {}, "", False))
    end = messages[-1].t
    then.off.close(end)
    share = engaged_share(path, end, then.off)
    expected = figures_of(messages).whole.engagement.share
    assert share == pytest.approx(expected)
