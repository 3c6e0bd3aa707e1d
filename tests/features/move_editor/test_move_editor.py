"""The timeline editor as a person uses it: keys in, a file and a screen out."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest
from textual.pilot import Pilot

from tests.cli.test_render import CALM
from woz_tui.cli import main
from woz_tui.console.drawing.cells import Cells
from woz_tui.drivers import plugins
from woz_tui.features.move_editor.app import MoveEditorApp
from woz_tui.features.move_editor.move_file import EditedFile
from woz_tui.motion.keyframes import KeyframeMove
from woz_tui.motion.move_files import read_move
from woz_tui.motion.render_target import RenderTarget
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


#: A nod from nothing: down to the row `nod`, 20 degrees at 0.3 s, back at 0.6 s.
NOD = (
    *("down", "shift+right", "shift+right", "shift+right", "2", "0", "enter"),
    *("shift+right", "shift+right", "shift+right", "0", "enter"),
)
WRITTEN = """
name: yes
frames:
  - {seconds: 0.4, nod: 20, pan: 10, easing: linear}
  - {seconds: 0.4, nod: 0, emotion: happy, intensity: 1}
"""


@pytest.mark.parametrize("size", [(80, 24), (100, 36)])
def test_a_nod_from_nothing(
    tmp_path: Path, size: tuple[int, int], capsys: pytest.CaptureFixture[str]
) -> None:
    async def story(rig: EditorRig) -> None:
        await rig.press(*NOD)
        assert rig.row("main").count("◆") == 2
        await rig.press("s")
        assert "saved: " in rig.text
        await rig.press("q")
        assert not rig.app.is_running

    rig = play(tmp_path, story, size=size)
    assert [(frame.at, dict(frame.roles)) for frame in rig.saved.layers[0].frames] == [
        (0.3, {"nod": 20.0}),
        (0.6, {"nod": 0.0}),
    ]
    # What is saved renders to the samples of the preview.
    assert main(["render", str(rig.file), "--robot", str(rig.robot)]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    shown = [
        {name: round(angle, 9) for name, angle in tick.joints.items()}
        for tick in rig.app.preview.ticks
    ]
    assert [line["joints"] for line in lines] == shown
    assert max(pose["top"] for pose in shown) == pytest.approx(50, abs=1)


def test_a_frame_that_joints_do_not_reach_is_marked_while_it_is_made(tmp_path: Path) -> None:
    async def story(rig: EditorRig) -> None:
        await rig.press("down", "shift+right", "6", "0", "enter", "shift+right", "0", "enter")
        assert "!" in rig.row("main")
        assert "not reached" in rig.text
        assert "dotted: wanted" in rig.text
        assert "of 320 deg/s" in rig.text

    play(tmp_path, story)


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


def test_a_frame_put_between_two_leaves_a_linear_way_as_it_was(tmp_path: Path) -> None:
    async def story(rig: EditorRig) -> None:
        before = [rig.move.at(place / 50).roles for place in range(40)]
        await rig.press("shift+right", "shift+right", "i")
        assert len(rig.move.layers[0].frames) == 3
        after = [rig.move.at(place / 50).roles for place in range(40)]
        assert [pytest.approx(pose, abs=1e-3) for pose in before] == after

    play(tmp_path, story, WRITTEN)


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


def test_without_a_terminal_it_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig = EditorRig(tmp_path, WRITTEN)
    assert main(["edit-move", str(rig.file), "--robot", str(rig.robot)]) == 1
    assert "needs a terminal" in capsys.readouterr().err
    assert main(["edit-move", str(tmp_path / "a.txt"), "--robot", str(rig.robot)]) == 1
    assert "end in .yaml" in capsys.readouterr().err
