"""Sections with names of a study's own, and files of the program's first versions."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.woz4u.reading import (
    converted_text,
    does,
    keys,
    messages,
    panel,
    problems,
    read_experiment,
    settings,
    titles,
)
from woz_tui.config.experiment import Experiment

OWN = """opening:
  - {title: Greet, string: "Hello, shall we build?", tooltip: first, key_comb: [ctrl, g]}
  - {title: Pity, string: That is a pity.}
closing:
  - {title: Bye, string: Goodbye}
"""


def does_of(experiment: Experiment, title: str) -> list[tuple[str, object]]:
    """What the buttons of a panel do, each with its label."""
    return [(action.label, does(action)) for action in panel(experiment, title).actions]


def test_a_list_of_titles_and_strings_is_a_panel_of_its_name(tmp_path: Path) -> None:
    experiment = read_experiment(tmp_path, OWN)
    assert problems(tmp_path, OWN) == []
    assert titles(experiment)[:2] == ["opening", "closing"]
    assert does_of(experiment, "opening") == [
        ("Greet", [("say", {"text": "Hello, shall we build?"})]),
        ("Pity", [("say", {"text": "That is a pity."})]),
    ]
    assert keys(experiment)["Greet"] == "ctrl+g"
    assert panel(experiment, "closing").place.line == 5


def test_its_lock_locks_it_and_nothing_else(tmp_path: Path) -> None:
    locks = "lock_opening: 'true'\nlock_closing_section: 'false'\n"
    experiment = read_experiment(tmp_path, locks + OWN)
    assert problems(tmp_path, locks + OWN) == []
    assert (panel(experiment, "opening").locked, panel(experiment, "closing").locked) == (
        True,
        False,
    )
    assert panel(experiment, "opening").covers == ()


def test_numbered_locks_are_those_of_the_sentences_in_their_order(tmp_path: Path) -> None:
    locks = "lock_anim_speech_section_1: 'false'\nlock_anim_speech_section_2: 'true'\n"
    experiment = read_experiment(tmp_path, locks + OWN)
    assert problems(tmp_path, locks + OWN) == []
    assert (panel(experiment, "opening").locked, panel(experiment, "closing").locked) == (
        False,
        True,
    )


def test_a_lock_that_locks_nothing_is_an_error_unless_it_is_open(tmp_path: Path) -> None:
    text = "lock_anim_speech_section_3: 'true'\n" + OWN
    assert problems(tmp_path, text) == [
        "2:1: lock_anim_speech_section_3: this locks nothing: no section of the file belongs to it"
    ]
    (open_one,) = messages(tmp_path, text.replace("true", "false"))
    assert open_one.startswith("warning: lock_anim_speech_section_3: this key is not used")


def test_entries_of_own_sections_are_known_by_what_they_have(tmp_path: Path) -> None:
    text = """all of it:
  - {title: Wave, gesture: animations/Stand/Gestures/Hey_1}
  - {title: Bell, location: /home/nao/bell.wav}
  - {title: Page, file_name: "http://a.example/"}
  - {title: Both, string: Look here, gesture: animations/Stand/Gestures/Hey_1}
  - Only a sentence
"""
    assert problems(tmp_path, text) == []
    assert does_of(read_experiment(tmp_path, text), "all of it") == [
        ("Wave", [("play", {"move": "animations/Stand/Gestures/Hey_1"})]),
        ("Bell", [("sound", {"file": "/home/nao/bell.wav"})]),
        ("Page", [("screen", {"file": "http://a.example/"})]),
        (
            "Both",
            [
                ("say", {"text": "Look here"}),
                ("play", {"move": "animations/Stand/Gestures/Hey_1"}),
            ],
        ),
        ("Only a sentence", [("say", {"text": "Only a sentence"})]),
    ]


def test_a_section_beside_one_of_woz4us_keeps_its_name_apart(tmp_path: Path) -> None:
    text = "animated_speech: [{title: A, string: One}]\nSpeech: [{title: B, string: Two}]\n"
    assert titles(read_experiment(tmp_path, text))[:2] == ["Speech", "Speech (own)"]


@pytest.mark.parametrize(
    ("text", "path", "lost"),
    [
        ("talk: [{title: A, sentence: One more}, {title: B, sentence: Two}]", "talk", "2 entries"),
        ("talk: [{title: A, string: One}, 17]", "talk", "1 entry"),
        ("talk: {first: One sentence, other: {more: Two of them}, n: 3}", "talk", "2 entries"),
        ("gestures: [{title: A, gesture: a/b}, {title: B, animation: a/b}]", "gestures", "1 entry"),
        ("animated_speech: [{title: A, strng: Hello}]", "animated_speech", "1 entry"),
        ("codes: [1, 2, 3]", "codes", "3 entries"),
    ],
)
def test_what_would_be_lost_is_an_error_with_its_number(
    tmp_path: Path, text: str, path: str, lost: str
) -> None:
    (problem,) = messages(tmp_path, f"{text}\n")
    assert problem.startswith(f"{path}: {lost} of this would be lost: give each a title")


def test_an_entry_that_says_nothing_loses_nothing(tmp_path: Path) -> None:
    (problem,) = messages(tmp_path, "gestures: [{title: A}]\n")
    assert problem.startswith("warning: gestures[0]: without 'gesture' there is nothing to play")


def test_a_misspelt_section_says_which_one_may_be_meant(tmp_path: Path) -> None:
    text = "gestres: [{title: A, gesture: a/b}]\n"
    assert messages(tmp_path, text) == [
        "warning: gestres: becomes a panel of this name; did you mean 'gestures'?"
    ]


def test_a_file_of_the_first_version(tmp_path: Path) -> None:
    (tmp_path / "map.png").write_bytes(b"")
    text = """messages:
  - {short: Hello, full_text: Hello you}
  - {title: Bye, message: Goodbye}
images:
  - {title: Map, file_name: map.png}
audio_files:
  - {title: Bell, url: "https://a.example/bell.wav"}
led_settings: {color: {red: 0, green: 1.0, blue: 0}}
"""
    experiment = read_experiment(tmp_path, text, start="")
    assert does_of(experiment, "Speech") == [
        ("Hello", [("say", {"text": "Hello you"})]),
        ("Bye", [("say", {"text": "Goodbye"})]),
    ]
    assert does_of(experiment, "Tablet")[0] == ("Map", [("screen", {"file": "map.png"})])
    assert does_of(experiment, "Sounds") == [
        ("Bell", [("sound", {"file": "https://a.example/bell.wav"})])
    ]
    assert settings(experiment).eyes == "#00ff00"
    assert [message for message in messages(tmp_path, text) if "now called" in message] == [
        "warning: messages: this key is now called 'animated_speech'; it is read as that",
        "warning: images: this key is now called 'tablet_items'; it is read as that",
    ]


def test_messages_beside_animated_speech_are_a_panel_of_their_own(tmp_path: Path) -> None:
    text = """messages: [{short: A, full_text: One}]
animated_speech: [{title: B, string: Two}]
"""
    experiment = read_experiment(tmp_path, text)
    assert titles(experiment)[:2] == ["Speech", "messages"]
    assert does_of(experiment, "messages") == [("A", [("say", {"text": "One"})])]


def test_gestures_whose_path_is_called_string(tmp_path: Path) -> None:
    text = """gestures:
  - {title: Wave, string: animations/Stand/Gestures/Hey_1}
  - {title: Say, string: This is a sentence}
"""
    assert problems(tmp_path, text) == []
    assert does_of(read_experiment(tmp_path, text), "Gestures") == [
        ("Wave", [("play", {"move": "animations/Stand/Gestures/Hey_1"})]),
        ("Say", [("say", {"text": "This is a sentence"})]),
    ]


def test_a_long_sentence_that_stands_alone_has_its_beginning_as_title(tmp_path: Path) -> None:
    text = "sentences:\n  - Do you want to see the pictures that we painted yesterday?\n"
    (action,) = panel(read_experiment(tmp_path, text), "sentences").actions
    assert action.label == "Do you want to see the pictures that..."
    assert does(action)[0][1] == {
        "text": "Do you want to see the pictures that we painted yesterday?"
    }


def test_the_converted_file_has_the_panels_too(tmp_path: Path) -> None:
    path = tmp_path / "config.yaml"
    path.write_text(f"pepper_ips: [simulated]\n{OWN}", encoding="utf-8")
    text = converted_text(path)
    assert 'title: "opening"' in text or "title: opening" in text
    assert "Hello, shall we build?" in text
    assert "covers" not in text.partition("opening")[2].partition("closing")[0]
