"""Texts that YAML reads as something else, and what their writers are told."""

from __future__ import annotations

import errno
from pathlib import Path
from typing import NoReturn

import pytest

from tests.config.reading import HEAD, ROBOT, errors, read_experiment

START = f"{HEAD}panels:\n  - title: Any time\n    actions:\n"
COMMENT = "is a comment and no part of the text: put the text in quotes"


def block(text: str) -> str:
    """A file whose line 8 says `text`."""
    return f"{START}      - key: a\n        label: Wait please\n        say: {text}\n"


def flow(text: str) -> str:
    """A file whose line 6 says `text` within braces, and that goes on."""
    action = f"{{key: a, label: Wait please, say: {text}}}"
    return f"{START}      - {action}\n      - {{label: B, say: B}}\n"


def warnings(folder: Path, text: str) -> list[str]:
    found = read_experiment(folder, text).warnings
    return [str(one).removeprefix(f"{folder / 'experiment.yaml'}:") for one in found]


def test_a_comment_that_cuts_a_text_off_is_told(tmp_path: Path) -> None:
    (told,) = warnings(tmp_path, block("Please take ticket #3, then wait at desk #2."))
    assert told.startswith(
        "8:9: warning: Any time > Wait please > say: '#3, then wait at desk #2.'"
    )
    assert COMMENT in told


@pytest.mark.parametrize(
    "text", ["Hello # a comment", "Hello #", "'Ticket #3'", "C#4", "Hello ## x"]
)
def test_what_is_no_such_comment(tmp_path: Path, text: str) -> None:
    assert warnings(tmp_path, block(text)) == []


def test_a_value_that_is_a_comment_altogether_says_so_in_its_error(tmp_path: Path) -> None:
    (told,) = errors(tmp_path, block("#ff0000"))
    assert told.startswith("8:9: Any time > Wait please > say: needs 'text'")
    assert f"'#ff0000' {COMMENT}" in told


@pytest.mark.parametrize(
    ("text", "place", "sentence"),
    [
        (
            block("{participant}, nice to see you"),
            "8:27",
            "no text can begin with {: put the text in",
        ),
        (
            block("{participant} is here"),
            "8:28",
            "no text can begin with {: put the text in quotes",
        ),
        (block("[laughs] hi"), "8:23", "no text can begin with [: put the text in quotes"),
        (block("[laughs hi"), "9:1", "if 'say' is a text, put the text in quotes"),
        (block("Note: be kind"), "8:18", "text with a colon in it: put the text in quotes"),
        (
            block('"Hi" she said'),
            "8:19",
            "the text goes on behind its quotes: put the text in quotes",
        ),
        (
            flow("Note: be kind"),
            "6:47",
            "a comma is missing before 'Note', or put the text in quotes",
        ),
        (flow("Hi help: x"), "6:50", "a comma is missing before 'help', or put the text in quotes"),
        (flow("Ticket #3"), "7:7", f"'#3}}' {COMMENT}"),
    ],
)
def test_what_yaml_cannot_read_is_to_be_put_in_quotes(
    tmp_path: Path, text: str, place: str, sentence: str
) -> None:
    (told,) = errors(tmp_path, text)
    assert told.startswith(f"{place}: YAML: ")
    assert sentence in told


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (block("{participant}"), "if this belongs to a text, put the text in quotes"),
        (block("[laughs]"), "if a text begins with a bracket, put the text in quotes"),
        (flow("Well, hello"), "if this belongs to a text, put the text in quotes"),
        (flow("“Well, hello”"), "curly quotes are part of the text"),
    ],
)
def test_what_yaml_reads_as_something_else_is_to_be_put_in_quotes(
    tmp_path: Path, text: str, sentence: str
) -> None:
    assert any(sentence in told for told in errors(tmp_path, text))


@pytest.mark.parametrize("text", ["“Hi”", "„Hallo“", "\u2018Hi\u2019", "Hi, “you”"])
def test_curly_quotes_are_told(tmp_path: Path, text: str) -> None:
    (told,) = warnings(tmp_path, block(text))
    assert told.startswith("8:9: warning: Any time > Wait please > say: curly quotes are part")


def test_an_apostrophe_of_a_word_processor_is_none(tmp_path: Path) -> None:
    assert warnings(tmp_path, block("I don\u2019t know")) == []


def test_a_key_in_curly_quotes_is_told_where_it_is_no_key(tmp_path: Path) -> None:
    (told,) = errors(tmp_path, block("Hi").replace("key: a", "key: “a”"))
    assert told.startswith(
        "6:9: Any time > Wait please > key: '“a”' is not a key; curly quotes are"
    )


def test_a_place_without_names_is_its_path(tmp_path: Path) -> None:
    found = errors(tmp_path, f"{START}      - {{sya: Hi, key: a}}\n")
    assert any(": panels[0].actions[0].sya: unknown" in f": {told}" for told in found)


def sounds(folder: Path, *files: str) -> list[str]:
    """What is said of actions that play these files."""
    lines = "".join(f"      - {{label: '{n}', sound: '{file}'}}\n" for n, file in enumerate(files))
    text = f"{ROBOT}panels:\n  - title: Any time\n    actions:\n{lines}"
    return [told.partition("sound: ")[2] for told in warnings(folder, text)]


def test_a_file_of_another_spelling_is_suggested(tmp_path: Path) -> None:
    (tmp_path / "Sounds").mkdir()
    (tmp_path / "Sounds" / "Gong.WAV").write_bytes(b"RIFF\x25\0\0\0WAVEdata\1\0\0\0\0")
    assert sounds(tmp_path, "sounds/gong.wav", "Sounds\\Gong.WAV", "Sounds/Gonk.WAV") == [
        "there is no file 'sounds/gong.wav'; did you mean 'Sounds/Gong.WAV'?",
        "there is no file 'Sounds\\\\Gong.WAV'; did you mean 'Sounds/Gong.WAV'?",
        "there is no file 'Sounds/Gonk.WAV'; did you mean 'Sounds/Gong.WAV'?",
    ]
    assert sounds(tmp_path, "Sounds/bell.wav", "C:\\me\\x.wav", "file:///x.wav") == [
        "there is no file 'Sounds/bell.wav'",
        "there is no file 'C:\\\\me\\\\x.wav'; this is a path of Windows; name it from the"
        " experiment's folder",
        "there is no file 'file:///x.wav'; write the path alone, without file://",
    ]


def test_a_file_that_is_near_to_a_whole_path_is_suggested_with_its_whole_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "study").mkdir()
    (tmp_path / "Gong.WAV").write_bytes(b"RIFF\x25\0\0\0WAVEdata\1\0\0\0\0")
    assert sounds(tmp_path / "study", f"{tmp_path}/gong.wav", "~/gong.wav") == [
        f"there is no file '{tmp_path}/gong.wav'; did you mean '{tmp_path}/Gong.WAV'?",
        "there is no file '~/gong.wav'; did you mean '~/Gong.WAV'?",
    ]
    assert sounds(tmp_path, "/gong.wav") == ["there is no file '/gong.wav'"]


def test_a_file_that_may_not_be_read_is_warned_of(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.wav").write_bytes(b"RIFF")

    def forbidden(path: Path) -> NoReturn:
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    opened = Path.open
    monkeypatch.setattr(
        Path,
        "open",
        lambda path, *args, **named: (
            forbidden(path) if path.suffix == ".wav" else opened(path, *args, **named)
        ),
    )
    assert sounds(tmp_path, "a.wav") == ["'a.wav': cannot be read: Permission denied"]
    exists = Path.exists
    monkeypatch.setattr(
        Path, "exists", lambda path: forbidden(path) if path.name == "b.wav" else exists(path)
    )
    assert sounds(tmp_path, "b.wav") == ["'b.wav' cannot be read: Permission denied"]


def test_a_file_that_is_not_what_its_name_says_is_told(tmp_path: Path) -> None:
    (tmp_path / "empty.wav").touch()
    (tmp_path / "song.wav").write_bytes(b"ID3\x04" + bytes(100))
    (tmp_path / "page.mp3").write_bytes(b"<!DOCTYPE html><html>404</html>")
    (tmp_path / "text.wav").write_bytes(b"Sorry, not found")
    (tmp_path / "mute.wav").write_bytes(b"RIFF\x24\0\0\0WAVEfmt " + bytes(20) + b"data\0\0\0\0")
    (tmp_path / "good.mp3").write_bytes(b"\xff\xfb" + bytes(100))
    names = ("empty.wav", "song.wav", "page.mp3", "text.wav", "mute.wav", "good.mp3")
    assert sounds(tmp_path, *names) == [
        "'empty.wav': the file is empty",
        "'song.wav': this is an MP3 file, whatever its name says",
        "'page.mp3': this is a web page, whatever its name says",
        "'text.wav': this is no WAV file, whatever its name says",
        "'mute.wav': there is no sound in it",
    ]
