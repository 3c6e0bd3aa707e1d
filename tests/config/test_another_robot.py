"""An experiment that another robot plays than the one that its file names."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.catalogue import CATALOGUE
from tests.config.reading import ROBOT, panel
from woz_tui.config.bundled_files import robot_files
from woz_tui.config.experiment import Experiment, ParallelCalls
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers import plugins

#: As `ROBOT`, with other names: its head is called neck, its joints yaw and nick.
OTHER = """
moves: {yes: nod}
joints: {pan: yaw, tilt: nick}
drivers:
  neck: {type: head, port: /dev/y, joints: {yaw: {id: 1, max: 15}, nick: {id: 2}}}
"""


def read_experiment(folder: Path, text: str, robot: str, **files: str) -> Experiment:
    (folder / "robots").mkdir(exist_ok=True)
    for name, content in files.items():
        (folder / "robots" / f"{name}.yaml").write_text(content)
    path = folder / "experiment.yaml"
    path.write_text(text)
    return load(path, CATALOGUE, robot=robot)


def problems(folder: Path, text: str, robot: str, **files: str) -> str:
    with pytest.raises(ExperimentError) as raised:
        read_experiment(folder, text, robot, **files)
    return str(raised.value)


def test_its_driver_gets_the_calls_under_its_own_names(tmp_path: Path) -> None:
    text = panel(
        "{label: A, play: shake, speed: 2}",
        "{label: B, pose: {pan: 10, tilt: 20}, seconds: 2}",
        "{label: C, poses: [{pan: -5, seconds: 1}]}",
        head=ROBOT,
    )
    experiment = read_experiment(tmp_path, text, "other", other=OTHER)
    assert [spec.name for spec in experiment.drivers] == ["neck"]
    calls = [(call.driver, call.verb, call.args) for a in experiment.actions for call in a.calls]
    assert calls == [
        ("neck", "play", {"move": "shake", "speed": 2.0}),
        ("neck", "pose", {"joints": {"yaw": 10.0, "nick": 20.0}, "seconds": 2.0}),
        ("neck", "poses", {"poses": [{"joints": {"yaw": -5.0}, "seconds": 1.0}]}),
    ]
    assert experiment.warnings == ()
    assert [path.name for path in experiment.files] == ["experiment.yaml", "other.yaml"]


def test_a_robot_files_own_names_count_in_its_own_experiments_too(tmp_path: Path) -> None:
    (tmp_path / "other.yaml").write_text(OTHER)
    text = panel("{label: A, play: yes}", head="title: T\nrobot: other.yaml\n")
    (call,) = read_experiment(tmp_path, text, "").panels[0].actions[0].calls
    assert call.args == {"move": "nod"}


@pytest.mark.parametrize(
    ("action", "left", "what", "why"),
    [
        ("say: Hi, play: nod", ["play"], "say", "not offered"),
        ("pose: {pan: 80}", [], "pose", "80 is out of range"),
        ("repeat: 3", [], "repeat", "neck: it has no mouth"),
    ],
)
def test_what_it_cannot_do_is_left_out_with_the_place_and_the_reason(
    tmp_path: Path, action: str, left: list[str], what: str, why: str
) -> None:
    text = panel(f"{{label: A, {action}}}", head=ROBOT)
    experiment = read_experiment(tmp_path, text, "other", other=OTHER)
    (found,) = experiment.panels[0].actions
    assert [call.verb for call in found.calls] == left
    (missing,) = found.left_out
    assert missing.what == what
    assert why in missing.why
    (warning,) = experiment.warnings
    assert warning.path.startswith(f"panels[0].actions[0].{what}")
    assert warning.place.line == text.count("\n", 0, text.index("label: A")) + 1
    assert "other" in warning.message


def test_an_argument_that_it_does_not_take_is_left_out_alone(tmp_path: Path) -> None:
    robot = "drivers: {robot: {type: simulated}}"
    text = panel("{label: A, say: {text: Hi, volume: 0.5}, speed: 1}", head=ROBOT)
    (action,) = read_experiment(tmp_path, text, "plain", plain=robot).panels[0].actions
    assert [call.args for call in action.calls] == [{"text": "Hi"}]
    assert [each.what for each in action.left_out] == ["say.speed", "say.volume"]


def test_other_steps_and_what_the_session_does_stay(tmp_path: Path) -> None:
    text = panel("{label: A, steps: [{say: Hi}, {wait: 1}, {play: nod, mark: x}]}", head=ROBOT)
    (action,) = read_experiment(tmp_path, text, "other", other=OTHER).panels[0].actions
    steps = [
        [call.verb for call in step.calls] if isinstance(step, ParallelCalls) else step.seconds
        for step in action.steps
    ]
    assert steps == [[], 1.0, ["play", "mark"]]


def test_a_mistake_of_the_file_is_an_error_all_the_same(tmp_path: Path) -> None:
    text = panel("{label: A, plya: nod}", "{label: B, pose: {pam: 1}}", head=ROBOT)
    said = problems(tmp_path, text, "other", other=OTHER)
    assert "did you mean 'play'?" in said
    assert "pam" in said


def test_what_a_driver_says_of_a_verb_that_it_lacks_is_told(tmp_path: Path) -> None:
    alone = ROBOT.replace("    voice: {type: voice}\n", "")
    text = panel("{label: A, repeat: {times: 2}}", head=alone)
    assert "no driver offers it; head: it has no mouth" in problems(tmp_path, text, "")


def test_a_type_that_needs_no_settings_is_a_robot(tmp_path: Path) -> None:
    text = panel("{label: A, say: Hi}", head=ROBOT)
    experiment = read_experiment(tmp_path, text, "voice")
    assert [(spec.name, spec.type) for spec in experiment.drivers] == [("robot", "voice")]
    assert experiment.robot == "voice"


def test_the_file_beside_the_experiment_comes_first(tmp_path: Path) -> None:
    text = panel("{label: A, say: Hi}", head=ROBOT)
    assert "pepper" in robot_files(tmp_path)
    mine = "drivers: {mine: {type: voice}}"
    experiment = read_experiment(tmp_path, text, "pepper", pepper=mine)
    assert [spec.name for spec in experiment.drivers] == ["mine"]
    path = str(tmp_path / "robots" / "pepper.yaml")
    assert load(tmp_path / "experiment.yaml", CATALOGUE, robot=path).robot == path


def test_who_cannot_play_it_is_said_at_the_experiments_robot(tmp_path: Path) -> None:
    text = panel("{label: A, say: Hi}", head=ROBOT)
    assert "experiment.yaml:2:1: robot: there is no robot 'otherr'; did you mean 'other'?" in (
        problems(tmp_path, text, "otherr", other=OTHER)
    )
    assert "no such file" in problems(tmp_path, text, "robots/nowhere.yaml")
    assert "bad.yaml:1:" in problems(tmp_path, text, "bad", bad="drivers: {a: {type: none}}")
    several = text.replace("robot:\n", "robots:\n  left:\n").replace("\n  dr", "\n    dr")
    several = several.replace("\n    head:", "\n      head:").replace("\n    v", "\n      v")
    assert "several robots" in problems(tmp_path, several, "other")


def test_two_drivers_that_could_do_it_are_an_error(tmp_path: Path) -> None:
    two = "drivers: {a: {type: voice}, b: {type: voice}}"
    text = panel("{label: A, say: Hi}", head=ROBOT)
    assert "a and b of two both offer 'say'" in problems(tmp_path, text, "two", two=two)
    same = two.replace("b:", "voice:")
    (call,) = read_experiment(tmp_path, text, "two", two=same).panels[0].actions[0].calls
    assert call.driver == "voice"


def test_sensors_that_it_does_not_have_are_no_error(tmp_path: Path) -> None:
    head = (
        "title: T\nrobot: {drivers: {eye: {type: camera, sees: [presence, near]},"
        " voice: {type: voice}}}\nsensors: [presence]\n"
        "engagement: {signs: [presence], presence: {sensor: near}}\n"
    )
    text = panel("{label: A, say: Hi}", head=head)
    experiment = read_experiment(tmp_path, text, "other", other=OTHER)
    assert any("near" in str(warning) for warning in experiment.warnings)


def test_a_repair_that_says_more_than_the_other_robot_can_is_said_without_it(
    tmp_path: Path,
) -> None:
    repairs = "repairs: {filler: {text: Hm, speed: 1}}\n"
    experiment = read_experiment(
        tmp_path,
        panel("{label: A, say: Hi}", head=ROBOT) + repairs,
        "plain",
        plain="drivers: {robot: {type: simulated}}",
    )
    filler = experiment.action("repair filler")
    assert filler is not None
    assert [call.args for call in filler.calls] == [{"text": "Hm"}]
    assert [each.what for each in filler.left_out] == ["say.speed"]


@pytest.mark.parametrize("play", ["play: nod", "play: {move: nod}"])
def test_a_move_that_its_driver_warns_of_is_left_out(tmp_path: Path, play: str) -> None:
    path = tmp_path / "experiment.yaml"
    path.write_text(panel(f"{{label: A, say: Hi, {play}}}", head="title: T\nrobot: simulated\n"))
    nao = tmp_path / "plain.yaml"
    nao.write_text("drivers: {nao: {type: nao, address: 192.168.1.21}}")
    action = load(path, plugins.installed(), robot=str(nao)).actions[0]
    assert [call.verb for call in action.calls] == ["say"]
    assert [each.what for each in action.left_out] == ["play"]
    assert "there is no animation 'nod'" in action.left_out[0].why
    nao.write_text(f"moves: {{nod: Yes_1}}\n{nao.read_text()}")
    action = load(path, plugins.installed(), robot=str(nao)).actions[0]
    assert [call.verb for call in action.calls] == ["say", "play"]
    assert action.left_out == []


@pytest.mark.parametrize("robot", [*robot_files(None), "furhat", "nao", "pepper", "reachy-mini"])
def test_a_robot_has_one_name_in_a_file_and_on_the_command_line(tmp_path: Path, robot: str) -> None:
    def drivers(own: str, other: str) -> list[tuple[str, object]]:
        path = tmp_path / "e.yaml"
        path.write_text(panel("{label: A, note: Hi}", head=f"title: T\nrobot: {own}\n"))
        read = load(path, plugins.installed(), robot=other)
        return [(spec.type, spec.settings) for spec in read.drivers]

    assert drivers(robot, "") == drivers("simulated", robot)


def test_the_word_simulated_is_a_robot_with_a_visitor(tmp_path: Path) -> None:
    path = tmp_path / "e.yaml"
    path.write_text(panel("{label: A, say: Hi}", head="title: T\nrobot: simulated\n"))
    sensors = {
        name for spec in load(path, plugins.installed()).drivers for name in spec.offer.sensors
    }
    assert {"presence", "gaze", "distance", "loudness"} <= sensors


def test_a_wrong_name_in_a_file_is_said_with_the_near_one(tmp_path: Path) -> None:
    text = panel("{label: A, say: Hi}", head="title: T\nrobot: reachy-mni\n")
    said = problems(tmp_path, text, "")
    assert "there is no robot 'reachy-mni'; did you mean 'reachy-mini'?" in said


def test_several_robots_are_named_the_same_way(tmp_path: Path) -> None:
    path = tmp_path / "e.yaml"
    robots = "robots: {a: reachy-mini, b: simulated}"
    path.write_text(panel("{label: A, note: Hi}", head=f"title: T\n{robots}\n"))
    names = [spec.name for spec in load(path, plugins.installed()).drivers]
    assert names == ["a.reachy", "b.robot"]
