"""The timeline editor as a person uses it: keys in, a file and a screen out."""

from __future__ import annotations

import asyncio
import json
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest
from textual.pilot import Pilot

from tests.cli.test_render import CALM
from tests.fakes.terminal import FakeTerminal
from tests.host.rig import served_session
from tools import ROOT
from woz_tui.cli import main
from woz_tui.config.loading import load
from woz_tui.console.drawing.cells import Cells
from woz_tui.drivers import plugins
from woz_tui.features.move_editor.app import MoveEditorApp
from woz_tui.features.move_editor.move_file import EditedFile
from woz_tui.motion.keyframes import KeyframeMove
from woz_tui.motion.move_files import read_move
from woz_tui.motion.render_target import RenderTarget
from woz_tui.protocol.messages import Command, Stopped, StopPressed
from woz_tui.system.clock import ManualClock

Story = Callable[["EditorRig"], Awaitable[None]]


class EditorRig:
    """An editor at a terminal without one."""

    def __init__(self, folder: Path, text: str = "") -> None:
        self.robot = folder / "calm.yaml"
        self.robot.write_text(CALM, encoding="utf-8")
        self.file = folder / "yes.yaml"
        if text:
            self.file.write_text(text, encoding="utf-8")
        self.target = RenderTarget.of(self.robot, plugins.installed(), "", None)
        self.clock = ManualClock()
        self.app = MoveEditorApp(
            self.target, EditedFile(self.file, self.target.spec.settings), clock=self.clock
        )
        self.pilot: Pilot[None] | None = None

    async def press(self, *keys: str) -> None:
        assert self.pilot is not None
        await self.pilot.press(*keys)

    @property
    def text(self) -> str:
        return self.app.query_one(Cells).text

    @property
    def move(self) -> KeyframeMove:
        return self.app.edited.move

    @property
    def saved(self) -> KeyframeMove:
        return read_move(self.file, self.target.spec.settings)

    def row(self, name: str) -> str:
        return next(line for line in self.text.splitlines() if line.strip(" >").startswith(name))


def play(
    folder: Path, story: Story, text: str = "", size: tuple[int, int] = (100, 36)
) -> EditorRig:
    rig = EditorRig(folder, text)

    async def whole() -> None:
        async with rig.app.run_test(size=size) as pilot:
            rig.pilot = pilot
            await story(rig)

    asyncio.run(whole())
    return rig


PAGE = (ROOT / "docs" / "how-to" / "edit-move.md").read_text("utf-8")
#: A nod from nothing, by the keys of the page.
NOD = tuple(PAGE.partition("```text")[2].partition("```")[0].split())
WRITTEN = """
name: yes
frames:
  - {seconds: 0.4, nod: 20, pan: 10, easing: linear}
  - {seconds: 0.4, nod: 0, emotion: happy, intensity: 1}
"""


def rendered_as_previewed(
    rig: EditorRig, capsys: pytest.CaptureFixture[str]
) -> list[dict[str, float]]:
    """What is saved renders to the samples of the preview."""
    capsys.readouterr()
    assert main(["render", str(rig.file), "--robot", str(rig.robot)]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    shown = [
        {name: round(angle, 9) for name, angle in tick.joints.items()}
        for tick in rig.app.preview.ticks
    ]
    assert [line["joints"] for line in lines] == shown
    return shown


@pytest.mark.toolkit("X3")
@pytest.mark.parametrize("size", [(80, 24), (100, 36)])
def test_a_nod_from_nothing(
    tmp_path: Path, size: tuple[int, int], capsys: pytest.CaptureFixture[str]
) -> None:
    async def story(rig: EditorRig) -> None:
        assert len(NOD) == 14
        await rig.press(*NOD)
        assert rig.row("main").count("◆") == 2
        assert "saved: " in rig.text
        await rig.press("q")
        assert not rig.app.is_running

    rig = play(tmp_path, story, size=size)
    assert [(frame.at, dict(frame.roles)) for frame in rig.saved.layers[0].frames] == [
        (0.3, {"nod": 20.0}),
        (0.6, {"nod": 0.0}),
    ]
    shown = rendered_as_previewed(rig, capsys)
    assert max(pose["top"] for pose in shown) == pytest.approx(50, abs=1)


def test_a_frame_that_joints_do_not_reach_is_marked_while_it_is_made(tmp_path: Path) -> None:
    async def story(rig: EditorRig) -> None:
        await rig.press("down", "shift+right", "6", "0", "enter", "shift+right", "0", "enter")
        assert "!" in rig.row("main")
        assert "not reached" in rig.text
        assert "dotted: wanted" in rig.text
        assert "of 320 deg/s" in rig.text

    play(tmp_path, story)


@pytest.mark.toolkit("X3")
def test_everything_can_be_undone_and_done_again(tmp_path: Path) -> None:
    moves: list[KeyframeMove] = []

    async def story(rig: EditorRig) -> None:
        moves.append(rig.move)
        for keys in (
            ["right", "+"],
            ["-", "="],
            ["e"],
            [">", "}"],
            ["d"],
            ["i", "comma", "i"],
            ["m"],
            ["a"],
            ["l"],
            ["up", "v"],
            ["home", "t"],
        ):
            await rig.press(*keys)
            moves.append(rig.move)
        assert len({id(move) for move in moves}) > 8
        last = rig.move
        for _ in range(40):
            await rig.press("u")
        assert rig.move == moves[0]
        for _ in range(40):
            await rig.press("ctrl+r")
        assert rig.move == last

    play(tmp_path, story, WRITTEN)


@pytest.mark.toolkit("X3")
def test_frames_are_moved_alone_or_with_all_behind_and_never_past_another(tmp_path: Path) -> None:
    def places(rig: EditorRig) -> list[float]:
        return [frame.at for frame in rig.move.layers[0].frames]

    async def story(rig: EditorRig) -> None:
        await rig.press("right", *["greater_than_sign"] * 2)
        assert places(rig) == [0.44, 0.8]
        await rig.press("right_curly_bracket")
        assert places(rig) == [0.46, 0.82]
        await rig.press(*["greater_than_sign"] * 40)
        assert places(rig) == [0.8, 0.82]
        await rig.press("x")
        assert places(rig) == [0.82]

    play(tmp_path, story, WRITTEN)


@pytest.mark.toolkit("X3")
def test_a_frame_put_between_two_leaves_a_linear_way_as_it_was(tmp_path: Path) -> None:
    async def story(rig: EditorRig) -> None:
        before = [rig.move.at(place / 50).roles for place in range(40)]
        await rig.press("shift+right", "shift+right", "i")
        assert len(rig.move.layers[0].frames) == 3
        after = [rig.move.at(place / 50).roles for place in range(40)]
        assert [pytest.approx(pose, abs=1e-3) for pose in before] == after

    play(tmp_path, story, WRITTEN)


@pytest.mark.toolkit("X3")
def test_it_plays_by_the_clock_and_escape_stops_it_and_stays(tmp_path: Path) -> None:
    async def story(rig: EditorRig) -> None:
        assert rig.pilot is not None
        await rig.press("space")
        assert "playing" in rig.text
        rig.clock.advance(0.5)
        while rig.app.edited.place.at == 0.0:
            await rig.pilot.pause()
        assert rig.app.edited.place.at == 0.5
        await rig.press("escape")
        assert "playing" not in rig.text
        assert rig.app.is_running
        await rig.press("home", "space")
        rig.clock.advance(5)
        while "playing" in rig.text:
            await rig.pilot.pause()
        assert rig.app.edited.place.at == 0.8

    play(tmp_path, story, WRITTEN)


def test_leaving_what_is_not_saved_takes_two_presses_and_a_copy_stays(tmp_path: Path) -> None:
    async def story(rig: EditorRig) -> None:
        await rig.press("right", "+", "q")
        assert "q once more" in rig.text
        await rig.press("up", "q")
        assert rig.app.is_running
        await rig.press("q")
        assert not rig.app.is_running

    rig = play(tmp_path, story, WRITTEN)
    assert rig.file.read_text("utf-8") == WRITTEN
    copy = rig.file.with_name("yes.yaml~")
    kept = tmp_path / "kept.yaml"
    kept.write_text(copy.read_text("utf-8"), encoding="utf-8")
    assert read_move(kept, rig.target.spec.settings) == rig.move


def test_comments_are_not_lost_without_a_word(tmp_path: Path) -> None:
    text = f"# mine{WRITTEN}"

    async def story(rig: EditorRig) -> None:
        await rig.press("right", "+", "s")
        assert "comments" in rig.text
        assert rig.file.read_text("utf-8") == text
        await rig.press("s")
        assert rig.saved == rig.move

    play(tmp_path, story, text)


def test_face_and_body_are_drawn_at_the_moment(tmp_path: Path) -> None:
    async def story(rig: EditorRig) -> None:
        begin = rig.text
        await rig.press("end")
        faces = [[line[74:] for line in text.splitlines()] for text in (begin, rig.text)]
        assert faces[0] != faces[1]
        await rig.press("down", "down", "down", "down")
        assert "happy" in rig.row("emotion")
        await rig.press("home", "+")
        assert rig.move.layers[0].frames[0].intensity == 1.0  # an emotion is seen when it is chosen

    play(tmp_path, story, WRITTEN)


# -- the time line enlarged ------------------------------------------------------------------------


def test_the_time_line_is_enlarged_about_the_moment(tmp_path: Path) -> None:
    async def story(rig: EditorRig) -> None:
        ruler = rig.text.splitlines()[1]
        assert "0.5" in ruler and "1" in ruler.split()
        columns = [number for number, sign in enumerate(rig.row("main")) if sign == "◆"]
        await rig.press("right", "z", "z")
        assert "x4" in rig.text.splitlines()[1]
        assert rig.row("main").count("◆") == 1 < len(columns)  # the other one is beyond the end
        await rig.press(*["z"] * 9)
        assert "x32" in rig.text.splitlines()[1]
        await rig.press(*["Z"] * 9)
        assert rig.text.splitlines()[1] == ruler

    play(tmp_path, story, WRITTEN)


# -- takes -----------------------------------------------------------------------------------------


async def seconds_pass(rig: EditorRig, seconds: float, step: float = 0.1) -> None:
    """Time passes while somebody looks."""
    assert rig.pilot is not None
    for _ in range(round(seconds / step)):
        rig.clock.advance(step)
        rig.app.look_now()
        await rig.pilot.pause()


@pytest.mark.toolkit("X2")
@pytest.mark.parametrize("size", [(80, 24), (100, 36)])
def test_a_take_is_made_onto_a_new_layer_while_the_others_play(
    tmp_path: Path, size: tuple[int, int], capsys: pytest.CaptureFixture[str]
) -> None:
    async def story(rig: EditorRig) -> None:
        await rig.press("r")
        assert "take begins in 3.0 s" in rig.text
        assert "up/down: nod" in rig.text  # the hand's own keys
        before = rig.app.preview.at(0.4)
        await seconds_pass(rig, 3.4)
        assert "REC 0.4 s" in rig.text
        take = rig.app.take
        assert take is not None and before is not None
        # The layer that was there plays: pan and nod are under way.
        assert take.tick.joints["top"] == pytest.approx(before.joints["top"], abs=2)
        await rig.press(*["pageup"] * 4, "left")
        await seconds_pass(rig, 0.6)
        await rig.press("space")
        assert "taken as take-1" in rig.text
        assert [layer.name for layer in rig.move.layers] == ["main", "take-1"]
        assert rig.row("take-1").strip().startswith("> take-1")
        await rig.press("u")
        assert [layer.name for layer in rig.move.layers] == ["main"]
        await rig.press("ctrl+r", "s")

    rig = play(tmp_path, story, WRITTEN, size=size)
    [take] = [layer for layer in rig.saved.layers if layer.name == "take-1"]
    assert take.samples is not None
    assert any(values[-1] != 0 for values in take.samples.joints.values())
    rendered_as_previewed(rig, capsys)
    for tick in rig.app.preview.ticks:
        for name, joint in rig.target.spec.settings.joints.items():
            assert joint.min <= tick.joints[name] <= joint.max


def test_a_take_is_given_up_by_escape(tmp_path: Path) -> None:
    async def story(rig: EditorRig) -> None:
        await rig.press("r")
        await seconds_pass(rig, 3.4)
        await rig.press("down", "down", "escape")
        assert "given up" in rig.text
        assert len(rig.move.layers) == 1
        await rig.press("r", "space")
        assert "no movement" in rig.text
        assert not rig.app.edited.unsaved

    play(tmp_path, story, WRITTEN)


LONG = """
name: yes
frames:
  - {seconds: 0.5, nod: 6, easing: linear}
  - {seconds: 0.5, nod: 0, easing: linear}
  - {seconds: 0.5, nod: 6, easing: linear}
  - {seconds: 0.5, nod: 0, easing: linear}
"""


def test_acting_a_layer_again_makes_it_larger_and_keeps_its_timing(tmp_path: Path) -> None:
    async def story(rig: EditorRig) -> None:
        await rig.press("down", "f")  # the row `nod`
        await seconds_pass(rig, 3.2)
        for keys in (["down"] * 4, ["up"] * 4) * 2:  # 12 degrees, a moment late
            for key in keys:
                await rig.press(key)
                await seconds_pass(rig, 0.12, 0.06)
        await rig.press("space")
        assert "nod as you did it" in rig.text

    rig = play(tmp_path, story, LONG)
    frames = rig.move.layers[0].frames
    assert [frame.at for frame in frames] == [0.5, 1.0, 1.5, 2.0]
    heights = [frame.roles["nod"] for frame in frames]
    assert heights[0] == heights[2] == pytest.approx(12, abs=2.5)
    assert heights[1] == heights[3] == pytest.approx(0, abs=2.5)


def test_only_what_is_there_can_be_acted_again(tmp_path: Path) -> None:
    async def story(rig: EditorRig) -> None:
        await rig.press("down", "down", "f")  # lean, which no frame names
        await seconds_pass(rig, 3.2)
        await rig.press("pageup")
        await seconds_pass(rig, 0.4)
        await rig.press("space")
        assert "says nothing of lean" in rig.text
        await rig.press("l", "f")
        assert "nothing to act again" in rig.text

    play(tmp_path, story, WRITTEN)


# -- on the body of a session ----------------------------------------------------------------------

EXPERIMENT = (
    "title: T\nrobot: calm.yaml\npanels: [{title: P, actions: [{key: a, label: A, play: nod}]}]\n"
)


async def until(rig: EditorRig, holds: Callable[[], bool]) -> None:
    assert rig.pilot is not None
    async with asyncio.timeout(20):
        while not holds():
            await rig.pilot.pause(0.01)


@pytest.mark.toolkit("X3", "E4")
@pytest.mark.safety
@pytest.mark.real_clock
def test_an_edit_plays_on_the_body_of_a_session_under_its_stop(tmp_path: Path) -> None:
    rig = EditorRig(tmp_path, WRITTEN.replace("0.4", "4"))
    file = tmp_path / "e.yaml"
    file.write_text(EXPERIMENT, encoding="utf-8")
    made = load(file, plugins.installed())

    async def whole() -> None:
        async with served_session(tmp_path, made=made, catalogue=plugins.installed()) as served:
            app = MoveEditorApp(
                rig.target,
                EditedFile(rig.file, rig.target.spec.settings),
                clock=rig.clock,
                session=str(served.path),
            )
            rig.app = app
            async with app.run_test(size=(100, 36)) as pilot:
                rig.pilot = pilot
                await until(rig, lambda: "escape is its session's stop" in rig.text)
                await rig.press("right", "+")  # not saved: it plays all the same
                await rig.press("P")
                await until(rig, lambda: "plays on" in rig.text)
                begun = await served.published(
                    lambda line: isinstance(line, Command) and line.verb == "play_move"
                )
                assert isinstance(begun, Command)
                assert "nod: 20" in str(begun.args["move"]) and "pan: 11" in str(begun.args["move"])
                await served.until(lambda: served.values("setpoint.top")[-1:] > [32.0])
                await rig.press("escape")
                await until(rig, lambda: "stopped, confirmed by" in rig.text)
                assert app.is_running
                await served.published(lambda line: isinstance(line, Stopped))
                await rig.press("P")
                await until(rig, lambda: "stop is pressed" in rig.text or "release" in rig.text)
                await rig.press("R")
                await until(rig, lambda: "the stop is released" in rig.text)
                await rig.press("P")
                await until(rig, lambda: "plays on" in rig.text)
                await rig.press("q", "q")
            # What it played ends with it.
            await served.until(lambda: len(served.of(Stopped)) == 2)

    asyncio.run(whole())


@pytest.mark.safety
@pytest.mark.real_clock
async def test_escape_is_the_sessions_stop_whatever_the_editor_does(tmp_path: Path) -> None:
    rig = EditorRig(tmp_path, WRITTEN)
    file = tmp_path / "e.yaml"
    file.write_text(EXPERIMENT, encoding="utf-8")
    made = load(file, plugins.installed())
    async with served_session(tmp_path, made=made, catalogue=plugins.installed()) as served:
        module = "tests.features.move_editor.blocked_editor"
        command = [sys.executable, "-m", module, str(rig.robot), str(rig.file)]
        with FakeTerminal([*command, str(served.path), str(tmp_path)]) as terminal:
            await served.until((tmp_path / "blocked").exists)
            terminal.send(b"\x1b")
            await served.published(lambda line: isinstance(line, StopPressed))
            assert [line.source for line in served.of(StopPressed)] == ["key"]
            (tmp_path / "go").touch()
            await asyncio.to_thread(terminal.wait_text, "R releases it")
            terminal.send(b"q")
            assert await asyncio.to_thread(terminal.process.wait, 20) == 0


def test_without_a_session_it_says_how_to_play_on_a_body(tmp_path: Path) -> None:
    async def story(rig: EditorRig) -> None:
        await rig.press("P")
        assert "--session" in rig.text

    play(tmp_path, story, WRITTEN)


def test_a_session_that_is_not_there_is_told(tmp_path: Path) -> None:
    rig = EditorRig(tmp_path, WRITTEN)
    rig.app = MoveEditorApp(
        rig.target,
        EditedFile(rig.file, rig.target.spec.settings),
        session=str(tmp_path / "none.sock"),
    )

    async def whole() -> None:
        async with rig.app.run_test(size=(100, 36)) as pilot:
            rig.pilot = pilot
            await until(rig, lambda: "no body to play on" in rig.text)
            await rig.press("P")
            assert "not there" in rig.text
            await rig.press("escape")
            await until(rig, lambda: "its console has the stop" in rig.text)

    asyncio.run(whole())


def test_without_a_terminal_it_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig = EditorRig(tmp_path, WRITTEN)
    assert main(["edit-move", str(rig.file), "--robot", str(rig.robot)]) == 1
    assert "needs a terminal" in capsys.readouterr().err
    assert main(["edit-move", str(tmp_path / "a.txt"), "--robot", str(rig.robot)]) == 1
    assert "end in .yaml" in capsys.readouterr().err
