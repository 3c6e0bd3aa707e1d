from __future__ import annotations

from tests.console import scenes
from tests.console.piloting import piloted_console
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.view_models import ButtonState
from woz_tui.console.widgets.action_panels import PanelSelection, lay_out, panel_rows
from woz_tui.console.widgets.event_list import (
    ACTS,
    ALL,
    FAULTS,
    MACHINE,
    VIEWS,
    event_row,
    event_rows,
    listed_events,
)
from woz_tui.protocol import messages as m
from woz_tui.protocol.panels import ActionView, PanelView

NOW = scenes.NOW


def welcomed() -> ConsoleState:
    picture = ConsoleState()
    picture.apply([scenes.welcome()], 0)
    return picture


def test_a_marker_that_is_put_again_is_no_utterance_besides() -> None:
    """A re-run sends marks as commands."""
    picture = welcomed()
    before = len(picture.events)
    args: dict[str, m.Json] = {"text": "laughs"}
    mark = m.Command(command="c1", verb="mark", args=args, driver="session", source="replay", t=NOW)
    picture.apply([mark, m.Marker(text="laughs", t=NOW)], 0)
    assert [event.text for event in list(picture.events)[before:]] == ["Marker"]


def test_an_arrow_that_is_held_down_is_one_line() -> None:
    picture = welcomed()
    before = len(picture.events)
    for number in range(5):
        picture.apply(
            [
                m.Command(
                    command=f"c{number}", verb="nudge", args={"pitch": -5.0}, source="key", t=NOW
                ),
                m.Done(
                    command=f"c{number}",
                    driver="head",
                    sent={},
                    latency_us=1,
                    duration_us=2,
                    t=NOW + 400,
                ),
            ],
            0,
        )
    picture.apply([m.Command(command="d", verb="nudge", args={"yaw": 5}, source="key", t=NOW)], 0)
    first, second = list(picture.events)[before:]
    assert (first.text, first.times, first.run, first.mark) == ("head 5° up", 5, "c4", "done")
    assert (second.text, second.times) == ("head 5° left", 1)


def test_utterances_and_failures_keep_a_line_each() -> None:
    picture = welcomed()
    before = len(picture.events)
    for number in range(2):
        say: dict[str, m.Json] = {"text": "Yes."}
        command = m.Command(command=f"s{number}", verb="say", args=say, source="key", t=1)
        picture.apply([command], 0)
    for number in range(2):
        picture.apply(
            [
                m.Command(command=f"f{number}", verb="drive", args={}, source="key", t=NOW),
                m.Failed(command=f"f{number}", driver="base", reason="stuck", t=NOW),
            ],
            0,
        )
    assert len(picture.events) - before == 4


def test_steps_of_one_action_are_one_line_and_refusals_keep_theirs() -> None:
    actions = [
        ActionView(name="up", label="Up", key="u", verbs=["control"]),
        ActionView(name="nod", label="Nod", key="n", verbs=["play"]),
    ]
    picture = ConsoleState()
    picture.apply([scenes.welcome(shown=[PanelView(title="Body", actions=actions)])], 0)
    before = len(picture.events)
    presses = (("up", "refused"), *(("up", "done"),) * 4, ("nod", "done"), ("nod", "done"))
    for number, (action, how) in enumerate(presses):
        picture.apply(scenes.played_action(f"r{number}", action, NOW, 0.1, how=how), 0)
    lines = list(picture.events)[before:]
    assert [(event.text, event.mark, event.times) for event in lines] == [
        ("Up", "refused", 1),
        ("Up", "done", 4),
        ("Nod", "done", 1),
        ("Nod", "done", 1),
    ]
    row = event_row(lines[1], picture, PaintFrame(60, 1, NOW))
    assert "4 times" in "".join(text for text, _ in row)


def test_what_counts_after_the_mode_says_so_instead_of_a_tick() -> None:
    actions = [ActionView(name="up", label="Up", key="u", verbs=["control"])]
    panel = PanelView(title="Body", actions=actions)
    picture = ConsoleState()
    picture.apply([scenes.welcome(shown=[panel])], 0)
    *begun, ended = scenes.played_action("r1", "up", NOW, 0.1)
    done = m.Done(
        command="c-r1",
        driver="head",
        sent={"waits": "normal"},
        latency_us=1,
        duration_us=2,
        t=NOW + 500,
    )
    picture.apply([*begun, done, ended], 0)
    line = picture.events[-1]
    assert (line.mark, line.detail) == ("waits", "applies after this mode")
    frame = PaintFrame(40, 4, ended.t)
    assert picture.button_view(panel, actions[0], frame.now).state is ButtonState.WAITS
    rows = panel_rows(picture, frame, lay_out(picture.panels, 40, 4, 3), PanelSelection({}))
    assert "after mode" in "".join(text for row in rows for text, _ in row)
    picture.apply(scenes.played_action("r2", "up", ended.t, 0.1), 0)
    assert picture.events[-1].mark == "done"


def test_failures_that_nobody_has_seen_leave_room_for_what_happens() -> None:
    picture = welcomed()
    for number in range(10):
        picture.apply(
            [*scenes.played_action(f"f{number}", "Hello", NOW, 1, how="failed", reason="no")], 0
        )
    for number in range(10):
        picture.apply([m.Marker(text=f"{number}", t=NOW + number)], 0)
    lines = [(event.text, event.detail) for event in listed_events(picture, 6)]
    assert [detail for text, detail in lines if text == "Marker"] == ["9", "8", "7"]
    assert [text for text, _ in lines[3:]] == ["Hello"] * 3
    assert len(listed_events(picture, 1)) == 1
    assert listed_events(picture, 1)[0].detail == "9"


# -- what comes first ------------------------------------------------------------------------------


def rows(picture: ConsoleState, height: int = 6, view: str = ALL) -> list[str]:
    """The list as it is read."""
    found = event_rows(picture, PaintFrame(60, height, NOW), view)
    return ["".join(piece for piece, _ in row) for row in found]


def conversation() -> ConsoleState:
    """What the wizard plays, with all that machines have to say between."""
    picture = welcomed()
    picture.events.clear()
    for number in range(5):
        picture.apply(scenes.played_action(f"r{number}", f"Line {number}", NOW + number, 0.1), 0)
        for state in ("RobotSpeaks", "EngagedWithKnown"):
            engagement_changed = m.EngagementChanged(
                was="Wait", now=state, outcome="done", why="w", verdicts={}, visitor="V2", t=NOW
            )
            mode = m.ModeChanged(driver="robot", was="demo", now="normal", why="", t=NOW)
            picture.apply([engagement_changed, mode], 0)
    return picture


def test_own_acts_come_first_and_the_model_has_one_row() -> None:
    picture = conversation()
    *acts, model = rows(picture)
    assert [f"Line {number}" in act for act, number in zip(acts, (4, 3, 2, 1, 0), strict=True)] == (
        [True] * 5
    )
    assert "visitor V2, engaged" in model
    tall = rows(picture, 30)
    assert sum("visitor V2" in row for row in tall) == 1, "one row, replaced"
    assert sum("mode normal" in row for row in tall) > 0, "machines have the rows that are left"
    assert "visitor V2, engaged" in tall[-1]
    assert len(tall) == 30


def test_a_change_of_the_model_moves_no_row() -> None:
    picture = conversation()
    before = rows(picture)
    engagement_changed = m.EngagementChanged(
        was="EngagedWithKnown", now="RobotThinks", outcome="done", why="w", verdicts={}, t=NOW
    )
    picture.apply([engagement_changed], 0)
    after = rows(picture)
    assert after[:-1] == before[:-1]
    assert "waits for your answer" in after[-1]


def times(shown: list[str]) -> list[str]:
    """When each listed event happened, newest first, as it is read."""
    return [row.split()[0] for row in shown if row.strip()]


def test_rows_with_a_time_stand_in_order_of_time() -> None:
    picture = conversation()
    later = NOW + 60 * scenes.SECOND
    late = m.ModeChanged(driver="robot", was="normal", now="demo", why="", t=later)
    earlier = m.DriverLost(driver="head", detail="unplugged", t=NOW + 20 * scenes.SECOND)
    picture.apply([late, earlier], 0)
    shown = times(rows(picture, 30))
    assert shown[-1] == "model"
    assert shown[:-1] == sorted(shown[:-1], reverse=True)


def test_a_failure_whose_beginning_is_listed_no_more_has_its_place_in_time() -> None:
    picture = welcomed()
    begun = m.ActionRequested(run="r1", action="on Wait", source="engagement", t=NOW)
    failed = m.ActionFailed(run="r1", action="on Wait", reason="hangs", t=NOW + 9 * scenes.SECOND)
    marker = m.Marker(text="between", t=NOW + 5 * scenes.SECOND)
    picture.apply([begun, marker, failed], 0)
    shown = times(rows(picture, 30))
    assert "hangs" in "\n".join(rows(picture, 30))
    assert shown == sorted(shown, reverse=True)


def test_a_fault_is_in_every_view() -> None:
    picture = conversation()
    picture.apply([m.DriverLost(driver="head", detail="unplugged", t=NOW)], 0)
    picture.apply(scenes.played_action("r9", "Line 9", NOW, 0.1, how="failed", reason="stuck"), 0)
    for view in VIEWS:
        shown = "\n".join(rows(picture, 6, view))
        assert "head lost" in shown
        assert "stuck" in shown
    assert "Line 4" not in "\n".join(rows(picture, 6, FAULTS))
    machine = "\n".join(rows(picture, 9, MACHINE))
    assert "mode normal" in machine
    assert "Line 4" not in machine
    acts = "\n".join(rows(picture, 30, ACTS))
    assert "Line 4" in acts
    assert "mode normal" not in acts


async def test_a_key_turns_to_the_next_view_and_the_heading_names_it() -> None:
    async with piloted_console() as pilot:
        for view in (*VIEWS, VIEWS[0]):
            heading = pilot.text("EventList").splitlines()[0]
            assert heading.startswith(" Events ──")
            assert f"{view} · | filters" in heading
            await pilot.press("|")
    async with piloted_console(scenes.welcome(role="watcher")) as pilot:
        await pilot.press("|")
        assert VIEWS[1] in pilot.text("EventList").splitlines()[0]


def test_an_action_that_is_played_in_part_says_without_what() -> None:
    picture = welcomed()
    action_requested = m.ActionRequested(
        run="r1", action="Hello", source="key", without=["eyes"], t=NOW
    )
    picture.apply([action_requested], 0)
    assert "without eyes" in [*picture.events][-1].detail
