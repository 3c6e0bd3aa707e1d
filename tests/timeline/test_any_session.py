"""Whatever stands in a log: parts add up, nothing is lost, a newcomer knows the same."""

from __future__ import annotations

import tracemalloc
from collections import Counter
from itertools import pairwise
from pathlib import Path
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from tests.protocol.feature_examples import feature_examples
from tests.timeline.random_sessions import damaged, recordings, stamped, start
from woz_tui.features.delay.history import DelayHistory
from woz_tui.features.phases.history import PhaseHistory
from woz_tui.features.profiles.history import ProfileHistory
from woz_tui.log.log_reader import read
from woz_tui.protocol import messages as m
from woz_tui.protocol.kinds import message_kinds
from woz_tui.timeline.episodes import MOST_KEPT, ActionEpisode, CommandEpisode, UtteranceEpisode
from woz_tui.timeline.session_state import SessionState, all_cases
from woz_tui.timeline.timeline import Timeline, timeline_of
from woz_tui.timeline.trial_context import Context

ROOT = Path(__file__).parents[2]
LOGS = [
    *sorted((ROOT / "tests/log/golden").glob("v*/recordings/*_S01.jsonl")),
    ROOT / "recordings/sample.jsonl",
]
COURSES = st.one_of(recordings(), damaged())


def state_of(messages: list[m.Message] | list[m.Message]) -> SessionState:
    state = SessionState()
    for message in messages:
        state.apply(message)
    return state


def known_state(state: SessionState) -> dict[str, Any]:
    """What a newcomer must know."""
    study, model = state.study, state.model
    stop = state.stop
    return {
        "context": study.context,
        "study": (study.participant, study.condition, study.next_trial, study.order, study.planned),
        "over": (study.over, study.trials_left),
        "asked": [known(state) for known in feature_examples("questionnaires", "KNOWN")],
        "checks": study.checks,
        "stage": study.stage and study.stage.began,
        "trial": (study.trial and study.trial.started, study.last_started, study.last_ended),
        "break": study.in_break and study.in_break.started,
        "model": (model.present, model.on, model.state, model.since, model.visitor, model.shown),
        "engaged": model.engaged and (model.engaged.begin, model.engaged.visitor),
        "off": model.off is not None,
        "actions": {run: (each.begin, state.put_off(run)) for run, each in state.actions.items()},
        "commands": {
            key: (each.begin, each.request, each.dispatched, each.progress)
            for key, each in state.commands.items()
        },
        "stop": stop and (stop.begin, stop.confirmed, stop.missing, stop.settled),
        "drivers": (
            {name: (each.health, each.since) for name, each in state.drivers.items()},
            {name: each.begin for name, each in state.lost.items()},
        ),
        "lanes": set(state.faulted_lanes),
        "settings": (
            set(state.robots.lost),
            {
                name: (each.value, each.wanted, each.differs)
                for name, each in state.robots.of("robot").items()
                if each.differs is not None
            },
        ),
        "shown": (state.readings, state.sensors, state.modes, state.faces, state.bodies),
        "controls": {name: each.values for name, each in state.controls.items()},
        "speaking": {key: each.begin for key, each in state.speaking.items()},
        "wizard": (state.locks, state.perception),
        "delay": state.history(DelayHistory).changed,
        "profile": state.history(ProfileHistory).changed,
        "phases": state.history(PhaseHistory).begun,
        "rest": (state.consoles, state.recorder, state.start, state.end),
        "features": {kind: [*each.lines] for kind, each in state.histories.items()},
        "rerun": state.rerun and state.rerun.started,
    }  # fmt: skip


def test_every_kind_of_message_has_its_case() -> None:
    wanted = set(message_kinds())
    assert set(all_cases()) == wanted, "add it to CASES in woz_tui/timeline/session_state.py"


@given(COURSES)
def test_the_parts_of_an_episode_are_all_of_it(messages: list[m.Message]) -> None:
    timeline = timeline_of(messages)
    for episode in timeline.episodes:
        assert episode.end is not None
        assert timeline.begin <= episode.begin <= episode.end <= timeline.end
        parts = timeline.parts(episode)
        assert sum(part.end - part.begin for part in parts) == episode.duration
        assert (parts[0].begin, parts[-1].end) == (episode.begin, episode.end)
        assert all(one.end == other.begin for one, other in pairwise(parts))
        assert all(part.end > part.begin for part in parts) or not episode.duration


@given(COURSES)
def test_contexts_cover_the_log_without_a_gap(messages: list[m.Message]) -> None:
    timeline = timeline_of(messages)
    spans = timeline.spans
    if messages:
        assert (spans[0].begin, spans[-1].end) == (timeline.begin, timeline.end)
    assert all(one.end == other.begin for one, other in pairwise(spans))
    assert all(one.context != other.context for one, other in pairwise(spans))


@given(COURSES)
def test_state_spans_and_parts_have_the_same_context(messages: list[m.Message]) -> None:
    timeline = Timeline()
    found: list[tuple[int, int, Context]] = []
    for message in messages:
        timeline.apply(message)
        if timeline.state.study.begun:
            found.append((timeline.state.t, message.seq, timeline.state.context))
    timeline.finish()
    if timeline.state.study.begins_trials:  # a number that was set is that of the next trial
        found = [
            (t, seq, replace(context, trial=None) if context.run is None else context)
            for t, seq, context in found
        ]
    for t, seq, context in found:
        assert timeline.contexts.at(t, seq) == context
    for (t, _, context), (later, _, _) in pairwise(found):
        if later > t:  # it holds at the moment after the line
            plain = replace(context, stage="")  # a part may have several stages
            assert {
                replace(part.context, stage="")
                for episode in timeline.episodes
                for part in timeline.parts(episode)
                if part.begin <= t < part.end
            } <= {plain}


@given(COURSES)
def test_every_request_has_one_episode_and_one_outcome(messages: list[m.Message]) -> None:
    timeline = timeline_of(messages)
    requested = Counter(each.seq for each in messages if isinstance(each, m.ActionRequested))
    commands = [each for each in messages if isinstance(each, m.Command)]
    sent = Counter(each.seq for each in commands if not each.passing)
    assert Counter(each.seq for each in timeline.of(ActionEpisode)) == requested
    assert Counter(each.seq for each in timeline.of(CommandEpisode)) == sent
    assert timeline.state.passing == sum(each.passing for each in commands)
    for episode in timeline.episodes:
        assert episode.outcome
        if isinstance(episode, ActionEpisode | CommandEpisode):
            assert (episode.ended is None) == (episode.outcome == "open") == episode.cut


@given(recordings())
def test_a_session_that_was_recorded_has_no_end_without_a_beginning(
    messages: list[m.Message],
) -> None:
    ends = (
        *(m.ActionEnd, m.TrialEnded, m.BreakEnded, *feature_examples("questionnaires", "ENDS")),
        *(m.StopConfirmed, m.StopReleased, m.Dispatched, m.Progress),
    )
    timeline = timeline_of(messages)
    stray = [each for each in timeline.episodes if isinstance(getattr(each, "message", None), ends)]
    assert not stray


# -- a newcomer -----------------------------------------------------------------------------------


@given(COURSES, st.floats(0, 1))
def test_a_newcomer_knows_the_same(messages: list[m.Message], share: float) -> None:
    messages = stamped([(0, start()), *((each.t, each) for each in messages)])
    place = 1 + round(share * (len(messages) - 1))
    there = state_of(messages[:place])
    snapshot = there.messages()
    assert [line.seq for line in snapshot] == sorted(line.seq for line in snapshot)
    late = state_of(snapshot)
    late.t = there.t
    assert known_state(late) == known_state(there)
    assert {line.seq for line in late.messages()} <= {line.seq for line in snapshot}
    for message in messages[place:]:
        there.apply(message)
        late.apply(message)
    assert known_state(late) == known_state(there)


@given(COURSES, st.floats(0, 1))
def test_a_copy_goes_on_by_itself(messages: list[m.Message], share: float) -> None:
    place = round(share * len(messages))
    state = state_of(messages[:place])
    before, copy = known_state(state), state.copy()
    snapshot = state.messages()
    ended = [list(copy.apply(message)) for message in messages[place:]]
    assert known_state(state) == before
    assert state.messages() == snapshot
    assert [list(state.apply(message)) for message in messages[place:]] == ended
    assert known_state(state) == known_state(copy)


# -- logs -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("log", LOGS, ids=[str(log.relative_to(ROOT)) for log in LOGS])
def test_logs_of_every_schema_have_a_timeline(log: Path) -> None:
    spill = log.parents[1] / "spill"
    lines = [line.message for line in read(log, places=[spill]) if line.message is not None]
    timeline = timeline_of(lines)
    assert timeline.state.start is not None
    assert {each.kind for each in timeline.episodes} > {"action", "command", "state", "utterance"}
    assert {each.outcome for each in timeline.of(CommandEpisode)} >= {"done", "stopped"}
    snapshot = timeline.state.messages()
    assert known_state(state_of(snapshot))["engaged"] == known_state(timeline.state)["engaged"]
    assert len(snapshot) < len(lines) / 2


# -- bounds ---------------------------------------------------------------------------------------


def test_memory_is_bounded_whatever_never_ends() -> None:
    state, size = SessionState(), 0
    ended = 0
    for number in range(MOST_KEPT + 1000):
        name, seq = f"n{number}", 20 * number
        for at, message in enumerate(
            (
                m.ActionRequested(run=name, action="a", source="key"),
                m.Command(command=name, verb="say", args={}, source="key"),
                m.Command(command=f"p{number}", verb="control", args={}, source="midi"),
                m.StopPressed(source="key"),
                m.DriverLost(driver=name),
                m.Reading(sensor=name, value=1.0),
                m.SpeechStarted(driver="mic", segment=number, began=0),
                m.ConsoleAttached(console=name, role="wizard"),
                m.PreflightChecked(check=name, level="ok", source="wizard"),
            )
        ):
            done = state.apply(msgspec.structs.replace(message, seq=seq + at, t=seq))
            ended += sum(isinstance(each, ActionEpisode) and each.end is not None for each in done)
        if number == MOST_KEPT:
            size = len(state.messages())
    assert len(state.messages()) <= size + 1
    assert len(state.actions) == MOST_KEPT
    assert ended == 1000, "what makes way has ended"


@pytest.mark.parametrize("t", [-5, -(2**62), 2**62, 2**63 - 1])
def test_a_time_that_no_clock_can_have_said_counts_as_now(t: int) -> None:
    messages = stamped([(0, start()), (5, m.Note(text="a")), (t, m.Note(text="b"))])
    timeline = timeline_of(messages)
    assert [each.begin for each in timeline.episodes] == [5, 5]


def test_an_utterance_is_one_episode_whatever_comes_of_it() -> None:
    speech: list[m.Message] = [
        m.SpeechStarted(driver="mic", segment=1, began=0),
        m.DriverLost(driver="mic"),
        m.SpeechEnded(driver="mic", segment=1, began=0, ended=3),
        m.SpeechText(driver="mic", segment=1, text="hello"),
    ]
    timeline = timeline_of(stamped([(5 + at, message) for at, message in enumerate(speech)]))
    spoken = timeline.of(UtteranceEpisode)
    assert [(each.begin, each.end, each.outcome, each.cut) for each in spoken] == [
        (5, 5, "done", False)
    ]
    assert spoken[0].text is not None


def test_what_never_ends_costs_as_much_as_it_is_however_often_the_condition_changes() -> None:
    lines: list[tuple[int, m.Message]] = []
    for number in range(600):
        condition = ("warm", "cold")[number % 2]
        lines.append((number, m.SessionChanged(condition=condition)))
        lines.append((number, m.ActionRequested(run=f"a{number}", action="Hello", source="key")))
    course = stamped([(0, start()), *lines])
    tracemalloc.start()
    timeline = timeline_of(course)
    held_bytes, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert held_bytes < 4_000_000
    assert len(timeline.parts(timeline.of(ActionEpisode)[0])) == 599
