"""What is repeated of a log, what is not and why, and what becomes of damage."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.replay.rerun_rig import record_session, write_log
from tests.replay.test_rerun import tour
from tests.session.rig import ScriptedDriver, experiment
from woz_tui.drivers.contract import Offer
from woz_tui.log.log_reader import read
from woz_tui.protocol import messages as m
from woz_tui.replay.rerun_plan import UNFIT, RerunPlan, fitted, plan_of, unfit_steps

START = m.SessionStart(
    session="S07",
    participant="P07",
    condition="warm",
    wizard="W2",
    software={},
    experiment="made.yaml",
    experiment_sha256="0" * 64,
    seed=11,
    clock={},
)
LOG = "2026-03-01T10-00-00_P07_S07.jsonl"
Timed = tuple[float, m.Message]


def command(
    name: str = "c1", verb: str = "say", driver: str = "robot", **more: object
) -> m.Command:
    args = more.pop("args", {"text": "Hello"})
    fields = {"source": "key", **more}
    return m.Command(command=name, verb=verb, driver=driver, args=args, **fields)  # type: ignore[arg-type]


def dispatched(name: str = "c1") -> m.Dispatched:
    return m.Dispatched(command=name, driver="robot", latency_us=100)


def done_message(name: str = "c1", latency_us: int = 100) -> m.Done:
    return m.Done(
        command=name, driver="robot", sent={}, latency_us=latency_us, duration_us=1_000_000
    )


def plan(tmp_path: Path, *messages: Timed) -> RerunPlan:
    return plan_of(write_log(tmp_path / LOG, [(0, START), *messages]))


END = m.SessionEnd(reason="wizard")


def test_a_command_is_repeated_at_the_moment_at_which_it_began(tmp_path: Path) -> None:
    rerun_plan = plan(tmp_path, (1, command()), (3, dispatched()), (4, done_message()), (5, END))
    (step,) = rerun_plan.sent
    assert (step.at, step.cut, step.end, rerun_plan.start) == (3_000_000, -1, "done", 3_000_000)
    assert (rerun_plan.name, rerun_plan.session, rerun_plan.seed, rerun_plan.ended) == (
        LOG[:-6],
        "S07",
        11,
        True,
    )
    assert rerun_plan.drivers == ("robot",)
    assert rerun_plan.sha256 == hashlib.sha256((tmp_path / LOG).read_bytes()).hexdigest()


@pytest.mark.parametrize(
    ("asked", "course", "why"),
    [
        (command(), [m.Refused(command="c1", code="busy", reason="it is busy")], "it is busy"),
        (command(), [m.Refused(command="c1", code="late")], "refused in the log: late"),
        (command(), [dispatched(), m.Refused(command="c1", code="args", reason="no")], "no"),
        (
            command(),
            [m.Superseded(command="c1", by="c2")],
            "never began: it was replaced",
        ),
        (command(), [m.Stopped(command="c1", reason="stop pressed")], "never began: stop pressed"),
        (command(), [], "never began: the log ends"),
        (command(verb="set", driver="session"), [dispatched(), done_message()], "recorded session"),
        (
            command(verb="lock", driver="session"),
            [dispatched(), done_message()],
            "recorded session",
        ),
        (
            command(verb="toggle", driver="engagement"),
            [dispatched(), done_message()],
            "engagement model",
        ),
        (command(verb="bml", driver="bml"), [dispatched(), done_message()], "command by command"),
        (command(verb="learn_face"), [dispatched(), done_message()], "person who is there now"),
        (command(verb="face_consent"), [dispatched(), done_message()], "person who is there now"),
        (command(verb="sound", source="body"), [dispatched(), done_message()], "body requests it"),
    ],
)
def test_what_is_left_out_and_why(
    tmp_path: Path, asked: m.Command, course: list[m.Message], why: str
) -> None:
    rerun_plan = plan(tmp_path, (1, asked), *((2.0, message) for message in course), (5, END))
    (step,) = rerun_plan.steps
    assert why in step.skip
    assert not rerun_plan.sent


@pytest.mark.parametrize("source", ["key", "script", "palette", "midi", "program", "engagement"])
@pytest.mark.parametrize(("verb", "driver"), [("say", "robot"), ("mark", "session")])
def test_what_is_repeated_whoever_asked(
    tmp_path: Path, source: str, verb: str, driver: str
) -> None:
    asked = command(verb=verb, driver=driver, source=source)
    assert (
        len(plan(tmp_path, (1, asked), (1, dispatched()), (2, done_message()), (5, END)).sent) == 1
    )


def test_a_failed_command_and_one_beyond_its_time_are_tried_again(tmp_path: Path) -> None:
    for end in (m.Failed(command="c1", reason="lost"), m.TimedOut(command="c1", reason="slow")):
        (step,) = plan(tmp_path, (1, command()), (1, dispatched()), (2, end), (5, END)).sent
        assert step.cut == -1


def test_markers_of_the_wizard_are_kept_and_the_sessions_own_are_not(tmp_path: Path) -> None:
    marks = [m.Marker(text=source, source=source) for source in ("key", "preflight", "action")]
    rerun_plan = plan(tmp_path, *((float(n), mark) for n, mark in enumerate(marks, 1)), (5, END))
    assert [mark.text for mark in rerun_plan.marks] == ["key"]


def test_samples_are_not_read(tmp_path: Path) -> None:
    (tmp_path / LOG.replace(".jsonl", ".samples.jsonl")).write_text("no JSON at all\n" * 3)
    rerun_plan = plan(tmp_path, (1, command()), (1, dispatched()), (2, done_message()), (5, END))
    assert not rerun_plan.damage


# -- damage ---------------------------------------------------------------------------------------


def test_a_command_whose_request_is_lost_is_named(tmp_path: Path) -> None:
    rerun_plan = plan(tmp_path, (1, dispatched("c9")), (2, done_message("c9")), (5, END))
    (step,) = rerun_plan.skipped
    assert step.command.command == "c9"
    assert "unknown" in step.skip


def test_where_the_line_of_the_beginning_is_lost_the_end_tells_it(tmp_path: Path) -> None:
    (step,) = plan(tmp_path, (1, command()), (4, done_message(latency_us=250_000)), (5, END)).sent
    assert step.at == 1_250_000


def test_a_command_without_an_end_ends_with_the_stop_that_was_pressed(tmp_path: Path) -> None:
    """The line that said that the stop had cut it short may be just the damaged one."""
    rerun_plan = plan(
        tmp_path,
        (1, command()),
        (1, dispatched()),
        (2, m.StopPressed(source="key")),
        (3, m.StopReleased(source="key")),
        (9, END),
    )
    assert rerun_plan.sent[0].cut == 2_000_000
    assert rerun_plan.stops == 1


def test_a_command_without_an_end_ends_with_the_log(tmp_path: Path) -> None:
    rerun_plan = plan(
        tmp_path, (1, command()), (1, dispatched()), (7, m.Note(text="the last line"))
    )
    assert rerun_plan.sent[0].cut == 7_000_000
    assert not rerun_plan.ended


@pytest.mark.parametrize("wrong", [1 << 60, 0])
def test_a_time_that_cannot_be_true_moves_nothing(tmp_path: Path, wrong: int) -> None:
    """One flipped bit, and the robot would wait for years."""
    messages: list[Timed] = [
        (1, command()),
        (1, dispatched()),
        (2, done_message()),
        (3, command("c2")),
        (wrong / 1_000_000, dispatched("c2")),
        (4, done_message("c2")),
        (5, END),
    ]
    rerun_plan = plan(tmp_path, *messages)
    assert rerun_plan.duration == pytest.approx(2_000_000, abs=1_000_000)
    assert [step.command.command for step in rerun_plan.sent] == ["c1", "c2"]


def test_damage_is_told(tmp_path: Path) -> None:
    path = write_log(
        tmp_path / LOG, [(0, START), (1, command()), (1, dispatched()), (2, done_message())]
    )
    path.write_bytes(path.read_bytes().replace(b'"command.requested"', b'"command.reque\xff"'))
    rerun_plan = plan_of(path)
    assert any("damaged" in sentence for sentence in rerun_plan.damage)
    assert not rerun_plan.sent


@given(data=st.data())
def test_no_damage_raises_or_loses_a_command_silently(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    folder = tmp_path_factory.mktemp("damage")
    lines = _whole_log(folder).read_bytes().splitlines(keepends=True)
    kept = data.draw(st.lists(st.booleans(), min_size=len(lines), max_size=len(lines)))
    place = data.draw(st.integers(0, 3000))
    rest = bytearray(b"".join(line for line, keep in zip(lines, kept, strict=True) if keep))
    if rest:
        rest[place % len(rest)] ^= data.draw(st.integers(0, 255))
    path = folder / LOG
    path.write_bytes(rest)
    rerun_plan = plan_of(path)
    left = [line.message for line in read(path, samples=False)]
    told = {each.command for each in left if isinstance(each, m.Command | m.Dispatched | m.End)}
    assert {step.command.command for step in rerun_plan.steps} == told
    assert rerun_plan.damage or len(left) == sum(kept)
    now = fitted(rerun_plan, experiment(folder))
    assert all(step.skip or step.command.verb in ("say", "play", "mark") for step in now.steps)
    assert [step.at for step in rerun_plan.steps] == sorted(step.at for step in rerun_plan.steps)
    assert all(step.cut == -1 or step.cut >= step.at for step in rerun_plan.sent)


_CACHE: list[Path] = []


def _whole_log(folder: Path) -> Path:
    if not _CACHE:
        _CACHE.append(record_session(folder / "whole", tour))
    return _CACHE[0]


# -- the robot of now -----------------------------------------------------------------------------


@pytest.fixture
def made(tmp_path: Path) -> RerunPlan:
    return plan_of(record_session(tmp_path, tour))


def test_the_same_robot_can_do_all_of_it(made: RerunPlan, tmp_path: Path) -> None:
    assert not unfit_steps(fitted(made, experiment(tmp_path)))


def test_a_missing_driver_is_named_with_those_that_are_there(
    made: RerunPlan, tmp_path: Path
) -> None:
    other = experiment(tmp_path, drivers=("left", "right"))
    now = fitted(made, other)
    assert {step.command.verb for step in now.sent} == {"mark"}
    assert "there is no driver 'robot' (there is left, right)" in unfit_steps(now)[0].skip


def test_what_was_left_out_anyway_keeps_its_reason(tmp_path: Path) -> None:
    refused = m.Refused(command="c1", driver="robot", code="busy", reason="busy")
    rerun_plan = plan(tmp_path, (1, command()), (1, refused), (9, END))
    now = fitted(rerun_plan, experiment(tmp_path, drivers=("left", "right")))
    assert [step.skip for step in now.steps] == ["refused in the log: busy"]


def test_a_missing_verb_and_a_wrong_argument_are_named(made: RerunPlan, tmp_path: Path) -> None:
    whole = experiment(tmp_path)
    say, play, _ = ScriptedDriver.offer(None).verbs
    now = replace(say, arguments=(replace(say.arguments[0], choices=("Hello P07",)),))
    for verbs, why in (((now,), "does not offer 'play'"), ((now, play), "must be one of Hello")):
        robot = replace(whole.drivers[0], offer=Offer(verbs=verbs))
        reasons = [
            step.skip for step in unfit_steps(fitted(made, replace(whole, drivers=(robot,))))
        ]
        assert any(why in reason for reason in reasons)
        assert all(reason.startswith(UNFIT) for reason in reasons)


def test_drives_are_known(tmp_path: Path) -> None:
    asked = command(verb="drive", args={"x": 1.0})
    rerun_plan = plan(tmp_path, (1, asked), (1, dispatched()), (2, done_message()), (5, END))
    assert [step.drives for step in fitted(rerun_plan, experiment(tmp_path)).sent] == [True]
