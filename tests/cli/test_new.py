"""`woz new`: files that are right as they are written, and none that is overwritten."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from woz_tui import cli
from woz_tui.cli import new
from woz_tui.config.experiment import Experiment
from woz_tui.config.loading import load
from woz_tui.config.new_experiment import TEMPLATES, every_line
from woz_tui.config.screen_language import use
from woz_tui.drivers import plugins
from woz_tui.features.phases.section import PHASES
from woz_tui.features.questionnaires.section import QUESTIONNAIRES

ROOT = Path(__file__).parents[2]


def run_new(path: Path, *options: str, ask: Callable[[str], str] | None = None) -> int:
    parser = argparse.ArgumentParser()
    new.add(parser)
    return new.new(parser.parse_args([str(path), *options]), plugins.installed(), ask)


def read_experiment(path: Path) -> Experiment:
    return load(path, plugins.installed())


@pytest.mark.parametrize("template", TEMPLATES)
@pytest.mark.parametrize(
    "options", [(), ("--conditions", "none"), ("--conditions", "a, b, c"), ("--free",)]
)
def test_every_template_is_right_without_a_warning(
    tmp_path: Path, template: str, options: tuple[str, ...]
) -> None:
    path = tmp_path / "e.yaml"
    assert run_new(path, "--template", template, *options) == 0
    experiment = read_experiment(path)
    if "a, b, c" not in options:  # whose sentences are to be written
        assert experiment.warnings == ()
    assert len(PHASES.of(experiment)) == 3
    keys = [action.key for panel in experiment.panels for action in panel.actions]
    assert all(keys)
    assert len({*keys}) == len(keys)
    said = path.read_text(encoding="utf-8")
    assert said.count("\n#") >= 2
    study = "--free" not in options
    assert bool(QUESTIONNAIRES.of(experiment).questionnaires) is study


def test_the_tutorial_tells_what_the_template_has(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = (ROOT / "docs" / "tutorials" / "interview.md").read_text(encoding="utf-8")
    assert "woz new talk.yaml --yes --conditions neutral,empathic\n" in page
    assert run_new(tmp_path / "talk.yaml", "--yes", "--conditions", "neutral,empathic") == 0
    told = re.findall(r"\d+ actions on .*", capsys.readouterr().out)[0].rstrip(".")
    assert f"# {told}\n" in page


SENTENCES = {
    "neutral": {line.text for line in every_line()},
    "empathic": {line.other for line in every_line() if line.other},
}


@pytest.mark.parametrize(
    "conditions",
    [
        "neutral, empathic",
        "empathic, neutral",
        "warm, cold, robotic",
        "cold, neutral",
        "polite, rude",
    ],
)
def test_a_condition_has_sentences_of_its_own_name_or_has_to_get_some(
    tmp_path: Path, conditions: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """The warm wording went to the second condition, whatever it was called."""
    path = tmp_path / "e.yaml"
    assert run_new(path, "--conditions", conditions) == 0
    experiment = read_experiment(path)
    unwritten = 0
    for panel in experiment.panels:
        for call in (call for action in panel.actions for call in action.calls):
            choice = call.choices.get("text")
            for condition, texts in choice.texts.items() if choice and choice.depends else ():
                if condition in SENTENCES:
                    assert {*texts} <= SENTENCES[condition]
                else:
                    assert all(text.startswith(f"TO WRITE for {condition},") for text in texts)
                    unwritten += 1
    assert sum("not written" in one.message for one in experiment.warnings) == unwritten
    told = f"{unwritten} sentences to write: look for TO WRITE" in capsys.readouterr().out
    assert told is bool(unwritten)
    assert bool(unwritten) is (set(conditions.split(", ")) != {*SENTENCES})


@pytest.mark.parametrize("condition", ["neutral", "empathic"])
def test_the_only_condition_has_the_sentences_of_its_name(tmp_path: Path, condition: str) -> None:
    assert run_new(tmp_path / "e.yaml", "--conditions", condition) == 0
    said = {*read_experiment(tmp_path / "e.yaml").texts[0].split('"')}
    (other,) = {*SENTENCES} - {condition}
    assert said & (SENTENCES[condition] - SENTENCES[other])


def test_sentences_to_write_hide_no_other_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_new(tmp_path / "e.yaml", "--conditions", "polite, rude") == 0
    told = capsys.readouterr().out
    assert "not written yet" not in told
    assert "the same in every condition" in told


def test_repairs_that_ignore_the_condition_are_told(tmp_path: Path) -> None:
    path = tmp_path / "e.yaml"
    assert run_new(path, "--conditions", "neutral, empathic") == 0
    assert read_experiment(path).warnings == ()
    text = path.read_text(encoding="utf-8")
    path.write_text(re.sub(r"\n  yes: .*", '\n  yes: "Yes."', text), encoding="utf-8")
    (warning,) = read_experiment(path).warnings
    assert (warning.path, warning.message.partition(":")[0]) == ("repairs", "yes")
    alike = re.sub(r'\{"neutral": (".*?"), "empathic": ".*?"\}', r"\1", path.read_text())
    path.write_text(alike, encoding="utf-8")
    assert read_experiment(path).warnings == (), "a study whose sentences are the same for all"


def test_what_is_asked_for_stands_in_it(tmp_path: Path) -> None:
    path = tmp_path / "e.yaml"
    options = ("--conditions", "cold,warm", "--language", "de", "--keyboard", "fr")
    assert run_new(path, *options, "--robot", "pepper") == 0
    experiment = read_experiment(path)
    assert experiment.conditions == ("cold", "warm")
    assert (experiment.language, experiment.keyboard) == ("de", "fr")
    assert [spec.type for spec in experiment.drivers] == ["pepper"]


def test_what_no_option_says_is_asked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "my study.yaml"
    answers = iter(["", "paper", "study", "polite, rude", "", "de"])
    asked: list[str] = []

    def ask(question: str) -> str:
        asked.append(question)
        return next(answers)

    assert run_new(path, "--language", "fr", ask=ask) == 0
    assert len(asked) == 5  # one of them twice, and no language
    experiment = read_experiment(path)
    assert experiment.conditions == ("polite", "rude")
    assert (experiment.language, experiment.keyboard) == ("fr", "us")
    out = capsys.readouterr().out
    assert "one of: study, free" in out
    assert f"woz run '{path}'" in out
    assert "no errors" in out


def test_a_file_that_is_there_is_left_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "e.yaml"
    path.write_text("mine")
    assert run_new(path) == 1
    assert path.read_text() == "mine"
    assert "is there already" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--robot", "nowhere.yaml"), "nowhere.yaml"),
        (("--robot", "camera.yaml"), "say"),
        (("--language", "xx"), "'xx' is not known"),
        (("--conditions", "a,a"), "appears twice"),
        (("--robot", "~nobody-of-this-name/a.yaml"), "home"),
    ],
)
def test_what_cannot_be_is_said_and_nothing_is_written(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    options: tuple[str, ...],
    said: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "camera.yaml").write_text("drivers: {eye: {type: rangefinder, port: /dev/x}}\n")
    before = {*tmp_path.iterdir()}
    for file in ("e.yaml", "new/folder/e.yaml"):
        assert run_new(tmp_path / file, *options) == 1
        assert said in capsys.readouterr().err
        assert {*tmp_path.iterdir()} == before


def test_what_is_in_the_way_is_named(tmp_path: Path) -> None:
    (tmp_path / "notes").write_text("a file")
    with pytest.raises(OSError, match=r"notes'$"):
        run_new(tmp_path / "notes" / "e.yaml")


def test_the_help_has_the_questions_in_their_order_and_examples(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    with pytest.raises(SystemExit, match="0"):
        cli.main(["new", "--help"])
    said = capsys.readouterr().out
    before, _, asked = said.partition("five questions:")
    options = ("--robot", "--study", "--conditions", "--language", "--keyboard")
    places = [asked.index(f"  {option} ") for option in options]
    assert places == sorted(places)
    assert "--yes" in before
    assert asked.count("(default") == len(options), "what enter takes"
    assert "woz new guide.yaml --template museum" in asked
    assert max(map(len, said.splitlines())) <= 80


def test_free_play_has_no_conditions(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_new(tmp_path / "e.yaml", "--free", "--conditions", "a,b") == 2
    assert "leave out --free" in capsys.readouterr().err


def test_a_robot_file_is_found_from_where_the_command_is_typed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.yaml").write_text("drivers: {body: {type: simulated}}\n")
    assert run_new(Path("sub/e.yaml"), "--robot", "mine.yaml") == 0
    assert "../mine.yaml" in (tmp_path / "sub" / "e.yaml").read_text()


def test_nobody_who_answers_any_more_writes_nothing(tmp_path: Path) -> None:
    def gone(question: str) -> str:
        raise EOFError

    assert run_new(tmp_path / "e.yaml", ask=gone) == 1
    assert not [*tmp_path.iterdir()]


def test_a_wrong_robot_is_asked_for_again_before_anything_else(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mute.yaml").write_text("drivers: {eye: {type: rangefinder, port: /dev/x}}\n")
    typed = iter(["reachy-mni", "mute.yaml", "reachy-mini"])
    asked: list[str] = []

    def ask(question: str) -> str:
        asked.append(question[:6])
        return next(typed, "")

    assert run_new(tmp_path / "e.yaml", ask=ask) == 0
    assert asked == ["1 of 5", "1 of 5", *(f"{number} of 5" for number in range(1, 6))]
    said = capsys.readouterr().out
    assert "there is no robot 'reachy-mni'; did you mean 'reachy-mini'?" in said
    assert "this robot cannot speak" in said
    assert "robot: reachy-mini\n" in (tmp_path / "e.yaml").read_text()


def test_an_experiment_on_the_simulated_robot_has_a_visitor(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_new(tmp_path / "e.yaml", "--yes") == 0
    assert "address" not in capsys.readouterr().out
    experiment = read_experiment(tmp_path / "e.yaml")
    assert experiment.engagement is not None
    sensors = {name for spec in experiment.drivers for name in spec.offer.sensors}
    assert {"presence", "gaze", "distance", "loudness"} <= sensors


def test_every_robot_is_offered_and_can_be_taken(tmp_path: Path) -> None:
    catalogue = plugins.installed()
    robots = [name for name in catalogue if catalogue[name].facts.robot]
    asked: list[str] = []

    def ask(question: str) -> str:
        asked.append(question)
        return ""

    assert run_new(tmp_path / "first.yaml", ask=ask) == 0
    assert {"pepper", "simulated"} <= {*robots}
    for robot in robots:
        assert robot in asked[0]
        assert run_new(tmp_path / f"{robot}.yaml", "--robot", robot) == 0
        assert [spec.type for spec in read_experiment(tmp_path / f"{robot}.yaml").drivers] == [
            robot
        ]


def test_the_file_of_a_robot_comes_along(tmp_path: Path) -> None:
    assert run_new(tmp_path / "a.yaml", "--robot", "turtlebot") == 0
    own = tmp_path / "robots" / "turtlebot.yaml"
    assert read_experiment(tmp_path / "a.yaml").files[1] == own
    own.write_text(own.read_text() + "# mine\n")
    assert run_new(tmp_path / "b.yaml", "--robot", "turtlebot") == 0
    assert own.read_text().endswith("# mine\n")
    assert run_new(tmp_path / "c.yaml", "--robot", "eyepi") == 1  # its moves are in another folder
    assert [*own.parent.iterdir()] == [own]
    assert not (tmp_path / "c.yaml").exists()


@pytest.mark.parametrize("robot", ["nao", "pepper"])
def test_a_robot_of_a_type_knows_the_gestures_of_the_template(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], robot: str
) -> None:
    path = tmp_path / "e.yaml"
    assert run_new(path, "--yes", "--robot", robot) == 0
    assert f"{tmp_path / 'robots' / robot}.yaml" in capsys.readouterr().out
    experiment = read_experiment(path)
    assert experiment.warnings == ()
    played = {
        call.args["move"] for a in experiment.actions for call in a.calls if "move" in call.args
    }
    assert played >= {"Hey_1", "Yes_1"}


def test_it_asks_in_the_language_of_the_screen(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[str] = []

    def ask(question: str) -> str:
        asked.append(question)
        return "fre" if "Spiel" in question else ""

    use("de")
    try:
        assert run_new(tmp_path / "e.yaml", ask=ask) == 0
    finally:
        use("en")
    assert [question[:7] for question in asked] == ["1 von 5", "2 von 5", "4 von 5", "5 von 5"]
    assert "oder freies Spiel" in asked[1]
    assert "Als Nächstes:\n" in capsys.readouterr().out
