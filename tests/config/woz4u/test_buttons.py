"""The lists of a WoZ4U file: what each of their items comes to."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.woz4u.reading import (
    does,
    messages,
    panel,
    problems,
    read_experiment,
    settings,
    titles,
)
from woz_tui.config import utterance_template
from woz_tui.config.experiment import Experiment


def spoken_texts(experiment: Experiment) -> list[str]:
    """What the robot says in the end: templates filled in."""
    return [
        utterance_template.fill(args["text"], lambda name: f"<{name}>")
        for action in panel(experiment, "Speech").actions
        for verb, args in does(action)
        if verb == "say"
    ]


@pytest.mark.woz4u("animated_speech", "title", "tooltip", "key_comb")
def test_a_text_with_tags(tmp_path: Path) -> None:
    text = r"""animated_speech:
  - title: Greeting
    string: "Hello! ^start(animations/Stand/Gestures/Hey_1) \\vct=130\\ Welcome. \\pau=400\\"
    tooltip: "Waves &amp; greets"
    key_comb: ["ctrl", "1"]
"""
    (action,) = panel(read_experiment(tmp_path, text), "Speech").actions
    assert problems(tmp_path, text) == []
    assert (action.label, action.help, action.key) == ("Greeting", "Waves & greets", "ctrl+1")
    hello = r"Hello! ^start(animations/Stand/Gestures/Hey_1) \vct=130\ Welcome. \pau=400" + "\\"
    assert does(action) == [("say", {"text": hello})]
    assert (action.place.line, action.place.column) == (3, 5)


@pytest.mark.woz4u("animated_speech")
@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("It&apos;s me", "It's me"),
        ("&quot;Hi&quot; &amp; &lt;bye&gt;", '"Hi" & <bye>'),
        ("caf&eacute; &#233; &#xE9; &#8364;", "café é é €"),
        ("&amp;apos;", "&apos;"),
        ("R&D; AT&T", "R&D; AT&T"),
        ("50 % & more", "50 % & more"),
        ("Grüße # an & alle", "Grüße # an & alle"),
        ("call me {name}", "call me {name}"),
        ("{{x}} } {", "{{x}} } {"),
        ("&#123;participant&#125;", "{participant}"),
    ],
)
def test_the_robot_says_what_was_meant(tmp_path: Path, written: str, said: str) -> None:
    text = f"animated_speech:\n  - {{title: A, string: '{written}'}}\n"
    assert spoken_texts(read_experiment(tmp_path, text)) == [said]


@pytest.mark.parametrize("entity", ["&foo;", "&#0;", "&#xD800;", "&#1;", "&notit;"])
def test_what_is_no_entity_stays_with_a_warning(tmp_path: Path, entity: str) -> None:
    text = f"animated_speech:\n  - {{title: A, string: 'x {entity} y'}}\n"
    assert spoken_texts(read_experiment(tmp_path, text)) == [f"x {entity} y"]
    assert messages(tmp_path, text) == [
        f"warning: animated_speech[0].string: '{entity}': no HTML entity; it stays"
    ]


@pytest.mark.woz4u("animated_speech")
def test_a_text_file_is_read_out(tmp_path: Path) -> None:
    (tmp_path / "tales").mkdir()
    (tmp_path / "tales" / "fox.txt").write_text("Once upon a time", encoding="utf-8")
    text = "animated_speech:\n  - {title: Tale, string: tales/fox.txt}\n"
    assert does(read_experiment(tmp_path, text).action("Tale")) == [
        ("read", {"file": "tales/fox.txt"})
    ]
    assert problems(tmp_path, text) == []
    assert messages(tmp_path, text.replace("fox", "wolf")) == [
        "warning: animated_speech[0].string: there is no file 'tales/wolf.txt'"
    ]


def test_a_long_text_that_ends_like_a_file_is_said(tmp_path: Path) -> None:
    words = "Please open the file " * 20 + "readme.txt"
    text = f"animated_speech:\n  - {{title: A, string: {words}}}\n"
    assert spoken_texts(read_experiment(tmp_path, text)) == [words]
    assert messages(tmp_path, text) == [
        "warning: animated_speech[0].string: ends in .txt, but this is not a file name; it"
        " is spoken as text"
    ]


@pytest.mark.woz4u("gestures")
def test_gestures(tmp_path: Path) -> None:
    text = """gestures:
  -
    title: "Yes"
    gesture: "animations/Stand/Gestures/Yes_1"
    tooltip: "nods"
    key_comb: ["shift", "1"]
  - gesture: animations/Stand/Gestures/No_1
"""
    yes, no = panel(read_experiment(tmp_path, text), "Gestures").actions
    assert does(yes) == [("play", {"move": "animations/Stand/Gestures/Yes_1"})]
    assert (yes.label, yes.help, yes.key) == ("Yes", "nods", "!")
    assert no.label == "No_1"
    assert messages(tmp_path, text) == [
        "warning: gestures[1]: without 'title' its button is called 'No_1'"
    ]


@pytest.mark.woz4u("tablet_root_location", "tablet_items", "is_default_img")
def test_the_tablet(tmp_path: Path) -> None:
    (tmp_path / "static" / "items").mkdir(parents=True)
    for name in ("map.png", "film.mp4"):
        (tmp_path / "static" / "items" / name).write_bytes(b"x")
    text = """tablet_root_location: static/items/
tablet_items:
  - {title: Film, file_name: film.mp4, is_default_img: False}
  - {title: Map, file_name: map.png, is_default_img: True}
  - {title: Far film, file_name: "http://example.org/film.mp4"}
  - {title: Far picture, file_name: "https://example.org/picture.jpg"}
  - {title: Page, file_name: https://example.org/}
"""
    experiment = read_experiment(tmp_path, text)
    assert problems(tmp_path, text) == []
    found = [does(action)[0][1] for action in panel(experiment, "Tablet").actions]
    assert found == [
        {"file": "static/items/film.mp4"},
        {"file": "static/items/map.png"},
        {"file": "http://example.org/film.mp4"},
        {"file": "https://example.org/picture.jpg"},
        {"file": "https://example.org/"},
        {"what": "default"},
    ]
    tablet = settings(experiment).tablet
    assert (tablet.root, tablet.default) == ("static/items/", "static/items/map.png")


@pytest.mark.woz4u("is_default_img")
def test_of_two_defaults_of_the_tablet_the_first_is_shown(tmp_path: Path) -> None:
    text = """tablet_items:
  - {title: A, file_name: "http://a.example/a.png", is_default_img: yes}
  - {title: B, file_name: "http://a.example/b.png", is_default_img: "true"}
"""
    assert settings(read_experiment(tmp_path, text)).tablet.default == "http://a.example/a.png"
    assert messages(tmp_path, text) == [
        "warning: tablet_items[1].is_default_img: an item above is the default already; that one"
        " is shown"
    ]


@pytest.mark.woz4u("tablet_items")
def test_a_missing_picture_is_told_at_its_line(tmp_path: Path) -> None:
    text = "tablet_items:\n  - title: Map\n    file_name: map.png\n"
    assert problems(tmp_path, text) == [
        "4:5: warning: tablet_items[0].file_name: there is no file 'map.png'"
    ]


@pytest.mark.woz4u("audio_files", "volume")
def test_sounds_are_as_loud_as_speech(tmp_path: Path) -> None:
    text = "audio_files:\n  - {title: Bell, location: /home/nao/bell.wav, key_comb: [b]}\n"
    bell = read_experiment(tmp_path, text).action("Bell")
    assert does(bell) == [("sound", {"file": "/home/nao/bell.wav"})]
    bell = read_experiment(tmp_path, f"{text}volume: 0.4\n").action("Bell")
    assert does(bell) == [("sound", {"file": "/home/nao/bell.wav", "volume": 0.4})]


@pytest.mark.woz4u("colors", "is_default")
def test_colours_of_the_eyes(tmp_path: Path) -> None:
    text = """colors:
  - {title: Red, red: 1.0, green: 0, blue: 0, key_comb: ["c", "r"]}
  - {title: Orange, red: 1.0, green: 0.7, blue: 0, is_default: True}
  - {title: Pale, red: "0.5", green: 0.5, blue: 1}
"""
    experiment = read_experiment(tmp_path, text)
    assert problems(tmp_path, text) == []
    assert [does(action) for action in panel(experiment, "Eyes").actions] == [
        [("eyes", {"color": code, "seconds": 0.5})] for code in ("#ff0000", "#ffb200", "#8080ff")
    ]
    assert settings(experiment).eyes == "#ffb200"


@pytest.mark.woz4u("colors", "is_default")
def test_odd_colours(tmp_path: Path) -> None:
    text = """colors:
  - {title: Bytes, red: 255, green: 128, blue: 0, is_default: true}
  - {title: Half, red: -1, green: much, is_default: true}
"""
    experiment = read_experiment(tmp_path, text)
    codes = [does(action)[0][1]["color"] for action in panel(experiment, "Eyes").actions]
    assert codes == ["#ff8000", "#000000"]
    assert settings(experiment).eyes == "#000000"
    assert sorted(messages(tmp_path, text)) == [
        "warning: colors[0].red: red, green and blue go from 0 to 1; these are read as 0 to 255",
        "warning: colors[1].green: expected a number, not 'much'; there is no green in it",
        "warning: colors[1].is_default: a colour above is the default, too; the eyes come to this"
        " one",
        "warning: colors[1].red: below 0; there is no red in it",
        "warning: colors[1]: without 'blue' there is no blue in it",
    ]


@pytest.mark.woz4u("rasta_anim", "random_anim", "rotate_anim")
def test_animations_of_the_eyes(tmp_path: Path) -> None:
    text = """rasta_anim: {duration: 3, key_comb: [e, a]}
random_anim: {duration: "6", key_comb: [e, b]}
rotate_anim: {duration: 4.5, key_comb: [e, c]}
colors:
  - {title: Red, red: 1, green: 0, blue: 0}
  - {title: Blue, red: 0, green: 0, blue: 1}
"""
    actions = panel(read_experiment(tmp_path, text), "Eye animations").actions
    assert [(action.label, action.key) for action in actions] == [
        ("Rasta", "e a"),
        ("Random", "e b"),
        ("Rotate Red", "e c"),
        ("Rotate Blue", ""),
    ]
    assert [does(action)[0][1] for action in actions] == [
        {"kind": "rasta", "seconds": 3.0},
        {"kind": "random", "seconds": 6.0},
        {"kind": "rotate", "seconds": 4.5, "color": "#ff0000"},
        {"kind": "rotate", "seconds": 4.5, "color": "#0000ff"},
    ]


@pytest.mark.woz4u("rotate_anim")
def test_without_colours_the_eyes_rotate_in_white(tmp_path: Path) -> None:
    action = read_experiment(tmp_path, "rotate_anim: {duration: }\n").action("Rotate")
    assert does(action) == [("eyes_animation", {"kind": "rotate", "color": "#ffffff"})]


@pytest.mark.woz4u("title")
def test_titles_that_occur_twice(tmp_path: Path) -> None:
    text = """animated_speech:
  - {title: "Yes", string: Yes}
  - {title: "Yes", string: Of course}
  - {title: Yes (Speech), string: Sure}
  - {title: "Yes", string: Indeed}
gestures:
  - {title: "Yes", gesture: a/Yes_1}
  - {title: Rest, gesture: a/Rest_1}
"""
    experiment = read_experiment(tmp_path, text)
    assert problems(tmp_path, text) == []
    labels = [action.label for action in panel(experiment, "Speech").actions]
    assert labels == ["Yes", "Yes", "Yes (Speech)", "Yes"]
    names = [action.name for shown in experiment.panels for action in shown.actions]
    assert names[:6] == ["Yes", "Yes (Speech 2)", "Yes (Speech)", "Yes (Speech 3)",
                         "Yes (Gestures)", "Rest"]  # fmt: skip
    assert "Rest (Movement)" in names
    assert len(names) == len(set(names))


def test_many_equal_titles(tmp_path: Path) -> None:
    lines = "".join(f"  - {{title: A, gesture: a{number}}}\n" for number in range(500))
    actions = panel(read_experiment(tmp_path, f"gestures:\n{lines}"), "Gestures").actions
    assert actions[-1].name == "A (Gestures 499)"
    assert len({action.name for action in actions}) == 500


def test_items_that_do_nothing_are_left_out(tmp_path: Path) -> None:
    text = """animated_speech:
  - {title: Silent, string: ""}
  -
gestures:
  - {title: Nothing, key_comb: [n]}
tablet_items:
  title: Alone
  file_name: http://a.example/
"""
    assert titles(read_experiment(tmp_path, text)) == ["Tablet", "Movement", "Autonomy"]
    assert messages(tmp_path, text) == [
        "warning: animated_speech[0].string: without 'string' there is nothing to say; it is left"
        " out",
        "warning: animated_speech[1]: a value is missing here; it is left out",
        "warning: gestures[0]: without 'gesture' there is nothing to play; it is left out",
        "warning: tablet_items: expected a list; this one entry is read as a list of one",
    ]


def test_items_that_make_no_sense_are_errors(tmp_path: Path) -> None:
    text = """animated_speech: Hello
gestures:
  - wave
  - {title: Wave, gesture: [Hey_1]}
"""
    assert problems(tmp_path, text) == [
        "2:1: animated_speech: expected a list of entries such as {title: Hello, string: 'Hello!',"
        " key_comb: [h]}, not 'Hello'",
        "4:5: gestures[0]: expected an entry such as {title: Hello, gesture:"
        " animations/Stand/Gestures/Hey_1}, not 'wave'",
        "5:19: gestures[1].gesture: expected text, not a list",
    ]


def test_braces_in_paths_are_no_variables(tmp_path: Path) -> None:
    (tmp_path / "{a}.txt").write_text("x", encoding="utf-8")
    text = """animated_speech: [{title: A, string: "{a}.txt"}]
gestures: [{title: B, gesture: "{b}"}]
tablet_items: [{title: C, file_name: "http://a.example/{c}"}]
audio_files: [{title: D, location: "/{d}.wav"}]
"""
    experiment = read_experiment(tmp_path, text)
    paths = [next(iter(does(experiment.action(name))[0][1].values())) for name in "ABCD"]
    filled = [utterance_template.fill(path, lambda name: f"<{name}>") for path in paths]
    assert filled == ["{a}.txt", "{b}", "http://a.example/{c}", "/{d}.wav"]


def test_a_title_is_on_one_line_and_decoded(tmp_path: Path) -> None:
    text = 'animated_speech:\n  - {title: "It&apos;s\\n me\\t\\0", string: a}\n'
    (action,) = panel(read_experiment(tmp_path, text), "Speech").actions
    assert action.label == "It's me"
