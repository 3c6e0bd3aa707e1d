"""Inputs for `woz render`: scripts, session logs, and what may be wrong with them."""

from __future__ import annotations

import itertools
import json
import tracemalloc
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.cli.test_render import CALM
from woz_tui.cli import main
from woz_tui.cli.input_lines import input_lines
from woz_tui.console.drawing.curves import Curve, chart, time_axis
from woz_tui.motion.input_script import read_inputs
from woz_tui.motion.rendering import LONGEST_S


@pytest.fixture
def calm(tmp_path: Path) -> Path:
    """A robot that neither breathes nor blinks."""
    file = tmp_path / "calm.yaml"
    file.write_text(CALM, encoding="utf-8")
    return file


def write_inputs(folder: Path, *lines: object) -> Path:
    """A file of inputs."""
    file = folder / "inputs.jsonl"
    file.write_text(
        "".join((line if isinstance(line, str) else json.dumps(line)) + "\n" for line in lines)
    )
    return file


@pytest.mark.parametrize(
    ("line", "wrong"),
    [
        ("{", "no JSON"),
        ("[1]", "expected an object in braces, not [1]"),
        ('{"t":0}{"t":1}', "no JSON"),
        ('{"t":0}', None),
        ('{"t":0,"yaw":1}', '"input" is missing'),
        ('{"t":0,"input":"gase"}', "no input is called 'gase'; did you mean 'gaze'?"),
        ('{"input":"gaze"}', '"t" is a number of seconds from 0 up, not null'),
        ('{"t":-1,"input":"gaze"}', '"t" is a number of seconds from 0 up, not -1'),
        ('{"t":NaN,"input":"gaze"}', "no JSON: NaN is no number in JSON"),
        ('{"t":1e999,"input":"gaze"}', '"t" is a number'),
        ('{"t":true,"input":"gaze"}', '"t" is a number'),
        ('{"t":0.1,"input":"gaze","hand":"left"}', '"hand" is wizard or program, not "left"'),
        ('{"t":0.1,"input":"gaze"}', "t 0.1 lies before 0.5, which stands above"),
        ('{"kind":"command.requested","driver":"body","verb":"play","t":"x","args":{}}', '"t" is'),
        ('{"kind":"command.requested","driver":"body","verb":"play","t":1}', '"args" is'),
    ],
)
def test_wrong_lines_are_told_with_their_place_and_nothing_is_printed(
    capsys: pytest.CaptureFixture[str], calm: Path, line: str, wrong: str | None
) -> None:
    file = write_inputs(calm.parent, {"t": 0.5, "input": "blink"}, line)
    code = main(["render", str(calm), "idle", "--seconds", "1", "--inputs", str(file)])
    out, err = capsys.readouterr()
    if wrong is None:
        assert code == 0
        return
    assert (code, out) == (2, "")
    assert f"{file}:2: " in err
    assert wrong in err


def test_lenient_leaves_wrong_lines_out(capsys: pytest.CaptureFixture[str], calm: Path) -> None:
    pose = {"t": 0, "input": "pose", "joints": {"pitch": 20}}
    file = write_inputs(calm.parent, "nonsense", pose)
    assert main(["render", str(calm), "idle", "--lenient", "--inputs", str(file)]) == 0
    out, err = capsys.readouterr()
    assert f"{file}:1: no JSON" in err
    assert json.loads(out.splitlines()[-1])["joints"]["pitch"] == pytest.approx(20)


@pytest.mark.toolkit("R4", "M2")
def test_refused_inputs_are_told_with_their_time_and_the_rest_goes_on(
    capsys: pytest.CaptureFixture[str], calm: Path
) -> None:
    file = write_inputs(
        calm.parent,
        {"t": 0.1, "input": "gaze", "yaw": "left"},
        '{"t":0.2,"input":"pose","joints":{"pitch":1e999}}',
        {"t": 0.3, "input": "mode", "mode": "demo"},
        {"t": 0.4, "input": "play", "move": "nod"},
        {"t": 0.5, "input": "stop"},
        {"t": 0.6, "input": "pose", "joints": {"pitch": 20}, "seconds": 0.2},
    )
    assert main(["render", str(calm), "idle", "--inputs", str(file)]) == 0
    out, err = capsys.readouterr()
    assert f"at 0.100 s: {file}:1: gaze refused" in err
    assert f"at 0.400 s: {file}:4: play refused" in err
    assert json.loads(out.splitlines()[-1])["joints"]["pitch"] == pytest.approx(20)


def test_the_stop_freezes_and_the_release_lets_it_stir_again(
    capsys: pytest.CaptureFixture[str], calm: Path
) -> None:
    file = write_inputs(
        calm.parent,
        {"t": 0, "input": "pose", "joints": {"pitch": 50}, "seconds": 2},
        {"t": 1, "input": "freeze"},
        {"t": 1.5, "input": "pose", "joints": {"pitch": 0}},
        {"t": 2, "input": "resume"},
    )
    assert main(["render", str(calm), "idle", "--inputs", str(file), "--seconds", "3"]) == 0
    out, err = capsys.readouterr()
    at = {line["t"]: line["joints"]["pitch"] for line in map(json.loads, out.splitlines())}
    assert at[1.02] == pytest.approx(25, abs=0.5)
    assert at[1.02] == at[1.98] == at[3.0]
    assert "the robot stands still" in err


@pytest.mark.toolkit("O4", "M1")
def test_what_is_seen_turns_the_head(capsys: pytest.CaptureFixture[str], calm: Path) -> None:
    seen = [
        {"t": index / 10, "input": "seen", "x": 0.5, "y": 0.0, "size": 0.02} for index in range(10)
    ]
    file = write_inputs(calm.parent, *seen)
    assert main(["render", str(calm), "tracking", "--inputs", str(file), "--seconds", "1"]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert lines[0]["mode"] == "normal"
    assert lines[-1]["mode"] == "tracking"
    assert lines[-1]["joints"]["pitch"] < -1  # to its right


@pytest.mark.toolkit("U1")
def test_a_session_is_rendered_again_from_its_log(
    capsys: pytest.CaptureFixture[str], calm: Path
) -> None:
    def asked(command: str, t: float, verb: str, **args: object) -> dict[str, object]:
        return {
            **{"kind": "command.requested", "seq": 1, "t": round(t * 1e6), "command": command},
            **{"verb": verb, "args": args, "driver": "body", "source": "key"},
        }

    def said(kind: str, t: float, command: str) -> dict[str, object]:
        return {"kind": f"command.{kind}", "t": round(t * 1e6), "command": command}

    file = write_inputs(
        calm.parent,
        {"kind": "session.start", "t": 0, "session": "S01"},
        asked("c1", 0.2, "pose", joints={"pitch": 40}, seconds=1),
        said("dispatched", 0.3, "c1"),
        asked("c2", 0.5, "pose", joints={"pitch": -80}, seconds=1),
        said("refused", 0.5, "c2"),
        {**asked("c3", 0.6, "say", text="Hello"), "driver": "voice"},
        asked("c4", 1.5, "emotion", emotion="happy", intensity=1),
        said("dispatched", 1.5, "c4"),
        said("done", 1.6, "c4"),
    )
    assert main(["render", str(calm), "idle", "--inputs", str(file)]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    lines = {line["t"]: line for line in map(json.loads, out.splitlines())}
    assert lines[0.8]["joints"]["pitch"] == pytest.approx(20, abs=1e-4)
    assert lines[1.3]["joints"]["pitch"] == pytest.approx(40, abs=1e-4)
    assert [*lines.values()][-1]["emotion"] == "happy"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nood"], "did you mean 'nod'?"),
        (["nod", "--body", "boddy"], "did you mean 'body'?"),
        (["nod", "--inputs", "/nowhere/at/all"], "no such file"),
        ([], "woz render FILE NAME"),
    ],
)
def test_what_is_wrong_is_said_and_2_returned(
    capsys: pytest.CaptureFixture[str], calm: Path, words: list[str], said: str
) -> None:
    assert main(["render", str(calm), *words]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert said in err


@pytest.mark.toolkit("R6")
@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("min: -90", "min: 95", ":6:"),
        ("speed: 250", "speed: 0", ":7:"),
        ("pitch: {axis: z,", "pitch: {axis: up,", ":6:"),
        ("top: {axis", "middle: {axis", ":8:"),
        ("type: body", "type: boddy", "did you mean 'body'?"),
        ("drivers:", "[", ""),
    ],
)
def test_a_wrong_robot_file_is_told_with_its_line(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, before: str, after: str, said: str
) -> None:
    file = tmp_path / "wrong.yaml"
    file.write_text(CALM.replace(before, after, 1), encoding="utf-8")
    assert main(["render", str(file), "nod"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert f"{file}:" in err
    assert said in err


@pytest.mark.toolkit("L4", "L5", "R4")
def test_what_is_taken_but_not_as_it_was_meant_is_told(
    capsys: pytest.CaptureFixture[str], calm: Path, tmp_path: Path
) -> None:
    script = write_inputs(
        tmp_path,
        {"t": 0, "input": "gaze", "x": -1, "y": 0, "z": 0.3},
        {"t": 1, "input": "pose", "joints": {"pitch": 90}, "seconds": 0.05},
        {"t": 2, "input": "joints", "joints": {"pitch": 1, "nose": 2}},
    )
    assert main(["render", str(calm), "idle", "--inputs", str(script)]) == 0
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 3
    assert "inputs.jsonl:1: gaze: out of reach, it looks " in told[0]
    assert "inputs.jsonl:2: pose: too soon, it arrives " in told[1]
    assert "inputs.jsonl:3: joints: left out nose: no such joint" in told[2]


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
def test_a_file_from_windows_is_read_like_any_other(
    capsys: pytest.CaptureFixture[str], calm: Path, tmp_path: Path, ending: str
) -> None:
    script = tmp_path / "windows.jsonl"
    lines = ['{"t":0,"input":"blink"}', '{"t":0.5,"input":"pose","joints":{"pitch":9}}', ""]
    script.write_bytes(b"\xef\xbb\xbf" + ending.join(lines).encode())
    assert main(["render", str(calm), "idle", "--inputs", str(script)]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert json.loads(out.splitlines()[-1])["joints"]["pitch"] == pytest.approx(9)


@pytest.mark.parametrize("value", ["a", True, [], {}, 1.5, -1.5, 1e300])
def test_what_no_camera_can_see_is_told_and_changes_nothing(
    capsys: pytest.CaptureFixture[str], calm: Path, tmp_path: Path, value: object
) -> None:
    script = write_inputs(tmp_path, {"t": 0.5, "input": "seen", "x": value, "y": 0, "size": 0.1})
    assert main(["render", str(calm), "tracking", "--inputs", str(script)]) == 0
    out, err = capsys.readouterr()
    assert "inputs.jsonl:1: seen refused: x must be -1 to 1, or null, not " in err
    assert main(["render", str(calm), "tracking"]) == 0
    assert capsys.readouterr().out == out


# -- curves and documents -----------------------------------------------------------------------


def test_a_rising_line_rises_from_the_lower_left_to_the_upper_right() -> None:
    lines = chart(Curve("pan", [-90, 90], -90, 90), 28, 4)
    assert lines[0].strip() == "pan"
    assert lines[1].startswith("    90°┤")
    assert lines[-1].startswith("   -90°┤")
    assert lines[1][-1] != " "
    assert lines[-1][8] != " "
    assert lines[1][8] == " "
    assert {len(line) for line in lines[1:]} == {28}


@pytest.mark.parametrize("values", [[], [5.0], [1e9, -1e9], [0.0] * 1000])
@pytest.mark.parametrize("width", [1, 20, 300])
def test_any_curve_fits_its_place(values: list[float], width: int) -> None:
    lines = chart(Curve("x", values, -1, 1), width, 3)
    assert len(lines) == 4
    assert len({len(line) for line in lines[1:]}) == 1
    assert all(len(line) <= max(width, 16) for line in (*lines, time_axis(9.5, width)[0]))


@given(st.floats(1e-4, 1e5), st.integers(20, 300))
def test_the_time_axis_has_round_times_within_what_is_drawn(seconds: float, width: int) -> None:
    ruler, labels = time_axis(seconds, width)
    times = [float(word) for word in labels.strip().removesuffix("s").split()]
    assert times[0] == 0.0
    assert times[-1] <= seconds * (1 + 1e-6)
    assert ruler.count("┬") == len(times)
    steps = {round(after - before, 9) for before, after in itertools.pairwise(times)}
    assert len(steps) <= 1
    assert all(f"{step:e}"[0] in "125" for step in steps)


def test_the_plot_goes_through_a_pipe_without_colours(
    capsys: pytest.CaptureFixture[str], calm: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "72")
    assert main(["render", str(calm), "nod", "--plot"]) == 0
    out = capsys.readouterr().out
    assert "\x1b" not in out
    assert max(map(len, out.splitlines())) <= 72
    assert all(text in out for text in ("pitch", "middle", "top", "90°", "-90°", "┬"))


def test_it_lists_the_inputs_that_there_are(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["render", "--help-inputs"]) == 0
    assert "| `seen` |" in capsys.readouterr().out


def test_a_large_file_is_read_line_by_line(tmp_path: Path) -> None:
    """Of a session's log few lines are inputs of a body."""
    file = tmp_path / "session.jsonl"
    other = json.dumps({"kind": "note", "t": 1, "text": "x" * 1000}) + "\n"
    pose = {"t": 0, "input": "pose", "joints": {"pitch": 20}}
    file.write_text("\ufeff" + other * 8_000 + json.dumps(pose) + "\n" + "x" * 9_000_000)
    complaints: list[str] = []
    tracemalloc.start()
    try:
        read = read_inputs(input_lines(str(file)), ("pose",), "body", complaints.append)
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert [one.place for one in read] == [f"{file}:8001"]
    assert [complaint.split(": ")[0] for complaint in complaints] == [f"{file}:8002"]
    assert most < 8_000_000


@pytest.mark.parametrize("odd", ["[1]", "{}", "7", "null"])
def test_a_log_whose_commands_have_no_names_is_told_or_read(
    capsys: pytest.CaptureFixture[str], calm: Path, odd: str
) -> None:
    kinds = ("requested", "dispatched", "refused")
    file = write_inputs(
        calm.parent, *(f'{{"kind":"command.{kind}","t":1,"command":{odd}}}' for kind in kinds)
    )
    assert main(["render", str(calm), "idle", "--inputs", str(file), "--seconds", "0"]) == 0
    assert "Traceback" not in capsys.readouterr().err


def test_text_that_is_no_utf_8_is_told_with_its_place(
    capsys: pytest.CaptureFixture[str], calm: Path
) -> None:
    file = write_inputs(calm.parent, {"t": 0, "input": "blink"})
    file.write_bytes(file.read_bytes() + b'{"t":0,"input":"\xff"}\n')
    assert main(["render", str(calm), "idle", "--inputs", str(file)]) == 2
    assert f"{file}:2: no UTF-8" in capsys.readouterr().err


def test_a_damaged_time_far_away_does_not_make_a_mode_last_for_ever(
    capsys: pytest.CaptureFixture[str], calm: Path
) -> None:
    file = write_inputs(calm.parent, {"t": 1e12, "input": "blink"})
    words = ["render", str(calm), "tracking", "--rate", "1", "--inputs", str(file)]
    assert main(words) == 0
    out, err = capsys.readouterr()
    assert len(out.splitlines()) <= LONGEST_S + 1
    assert "--seconds" in err


def test_a_log_that_went_on_in_a_second_folder_is_rendered_whole(
    capsys: pytest.CaptureFixture[str], calm: Path
) -> None:
    def asked(command: str, pitch: float, t: float) -> str:
        return json.dumps(
            {
                **{"kind": "command.requested", "seq": 1, "t": round(t * 1e6), "command": command},
                **{"verb": "pose", "args": {"joints": {"pitch": pitch}}, "driver": "body"},
            }
        )

    stem = "2026-03-01T10-00-00_P07_S01"
    spill = calm.parent / "spill"
    spill.mkdir()
    first = calm.parent / f"{stem}.jsonl"
    start = {"kind": "session.start", "seq": 0, "t": 0, "ts": "", "spill": ["spill"]}
    first.write_text(json.dumps(start) + "\n" + asked("c1", 5, 0) + "\n")
    head = json.dumps({"kind": "segment", "log": stem, "session": "S01", "number": 2})
    (spill / f"{stem}.2.jsonl").write_text(head + "\n" + asked("c2", 20, 0.5) + "\n")
    assert main(["render", str(calm), "idle", "--inputs", str(first)]) == 0
    last = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert last["joints"]["pitch"] == pytest.approx(20)


def test_what_was_wanted_is_dotted_where_something_else_came_out() -> None:
    sent, wanted = [0.0, 10.0, 20.0, 30.0] * 3, [0.0, 40.0, 80.0, 30.0] * 3
    plain = chart(Curve("pan", sent, -90, 90), 40, 6)
    dotted = chart(Curve("pan", sent, -90, 90, wanted=wanted), 40, 6)
    assert plain == chart(Curve("pan", sent, -90, 90, wanted=sent), 40, 6)
    assert plain != dotted
    assert len(plain[1].strip()) < len(dotted[1].strip())
