"""The languages of the screen: nothing lacks, nothing is lost, English where it fails."""

from __future__ import annotations

import string
from argparse import ArgumentParser
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from tools.screen_sentences import SentencesError, sentences
from woz_tui.cli.shared_options import add_language
from woz_tui.config import screen_language
from woz_tui.config.screen_language import (
    catalogue,
    choose,
    follow,
    of_environment,
    say,
    shipped,
    use,
    word,
    worded,
)
from woz_tui.config.yaml_cursor import range_text
from woz_tui.drivers.fields import Range
from woz_tui.export.redaction import redacted
from woz_tui.gate.facts import Facts, console_of
from woz_tui.gate.questions import PlayAction, RequestOrigin
from woz_tui.gate.table import locked_panel, why_not
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.sentence import Sentence
from woz_tui.protocol.welcome import StudySettings
from woz_tui.session.redactor import Redactor

#: Languages that lack nothing.
WHOLE = ("de",)
#: What is said alike of one in every language, or of many alone.
ALIKE = ("bus.queue_full", "gate.many_wait", "host.no_voice_piece", "say.more")
#: A line of a small terminal.
COLUMNS = 80


@pytest.fixture(autouse=True)
def english_again() -> Iterator[None]:
    yield
    choose("")
    use("en")


def _filled_in(text: str) -> dict[str, str]:
    """What stands between braces, and in which form."""
    parts = string.Formatter().parse(text)
    return {name: f"{form}!{how}" for _, name, form, how in parts if name is not None}


@pytest.mark.parametrize("code", WHOLE)
def test_a_whole_language_lacks_no_sentence_and_has_no_other(code: str) -> None:
    assert {*catalogue(code)} == {*sentences()}


def _other_values(name: str, text: str, english: Mapping[str, str]) -> bool:
    """Whether a translation has not the values of its English, or there is no such sentence: in the
    form for one `count` may stand or not, and all else is as in the other form.
    """
    if name not in english:
        return True
    of_many, is_one = english.get(name.removesuffix("_one"), ""), name.endswith("_one")
    if is_one and "count" in _filled_in(of_many):
        wanted, there = _filled_in(of_many), _filled_in(text)
        return {**wanted, "count": ""} != {**there, "count": ""}
    return _filled_in(text) != _filled_in(english[name])


@pytest.mark.parametrize("code", [code for code in shipped() if code != "en"])
def test_no_translation_loses_a_value(code: str) -> None:
    english = sentences()
    assert not {
        name for name, text in catalogue(code).items() if _other_values(name, text, english)
    }


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("queue.waits", "{count} warten"),
        ("queue.waits", "{count} warten bis {Zeit}"),
        ("queue.waits", "{count} warten bis {time:.1f}"),
        ("queue.waits_one", "eins wartet"),
        ("queue.waits_one", "{number} wartet bis {time}"),
        ("queue.only_one", "eine"),
        ("queue.unknown", "das gibt es nicht"),
    ],
)
def test_a_value_that_is_lost_is_found(name: str, text: str) -> None:
    english = {
        "queue.waits": "{count} wait until {time}",
        "queue.waits_one": "1 waits until {time}",
        "queue.only": "some",
        "queue.only_one": "one of {names}",
    }
    assert _other_values(name, text, english)
    assert not any(_other_values(each, english[each], english) for each in english)
    assert not _other_values("queue.waits_one", "{count} wartet bis {time}", english)


def test_what_is_counted_has_a_form_for_one() -> None:
    english = sentences()
    counted = {name for name, text in english.items() if "count" in _filled_in(text)}
    alike = {name for name in counted if not name.endswith("_one") and f"{name}_one" not in english}
    assert alike == {*ALIKE}


def _too_long(text: str, english: str) -> bool:
    """Whether it needs more room than there is where its English stands: half as much again, and
    ten cells for a word that is short in English.
    """
    return len(text) > len(english) * 1.5 + 10


@pytest.mark.parametrize("code", [code for code in shipped() if code != "en"])
def test_what_has_room_in_english_has_room(code: str) -> None:
    english = sentences()
    assert not {
        name: text
        for name, text in catalogue(code).items()
        if name in english and _too_long(text, english[name])
    }


@pytest.mark.parametrize("name", ["panels.queued", "stop.releases", "hint.find", "dialog.closes"])
def test_a_line_that_fills_a_small_terminal_is_too_long_for_a_word(name: str) -> None:
    assert _too_long(f"{catalogue('de')[name]} ".ljust(COLUMNS, "x"), sentences()[name])


def test_a_sentence_is_its_english_and_knows_how_to_be_worded() -> None:
    refusal = locked_panel("Speech")
    assert refusal.reason == "the panel 'Speech' is locked"
    use("de")
    assert word(refusal.reason) == "die Gruppe 'Speech' ist gesperrt"
    assert word(refusal.remedy) == "'Speech entsperren' suchen"


def test_a_sentence_within_a_sentence_is_worded_too() -> None:
    inner = locked_panel("Speech", Sentence("phases.within", "in the phase {phase}", phase="Tour"))
    use("de")
    assert word(inner.reason) == "die Gruppe 'Speech' ist gesperrt in der Phase Tour"


def test_code_and_values_come_with_the_message_and_are_worded_there() -> None:
    missing = why_not(Facts(), PlayAction("Wave", None, RequestOrigin("key", "w", "con1")))
    assert missing is not None
    late = Sentence("gate.undone", "{undone} ({why})", undone=missing.reason, why="late")
    sent = m.Notice(level="warning", text=late, remedy="ask the engineer")
    line = codec.encode(sent)
    came = codec.decode_message(line)
    assert isinstance(came, m.Notice)
    assert (came.text, came.remedy) == ("there is no action 'Wave' (late)", "ask the engineer")
    assert came.wording["text"].code == "gate.undone"
    assert codec.encode(came) == line
    assert worded(came) is came, "in English nothing is done"
    use("de")
    german = worded(came)
    assert german.text == "es gibt keine Aktion 'Wave' (late)"
    assert german.remedy == "ask the engineer", "what has no code stays"


def test_lines_of_an_answer_are_worded_and_what_is_hidden_has_no_code() -> None:
    said = [locked_panel("Speech").reason, "guide.yaml", {"count": 1}]
    came = codec.decode_incoming(codec.encode(r.Reply(ref=1, ok=True, data=said)))
    assert isinstance(came, r.Reply)
    assert came.data == ["the panel 'Speech' is locked", "guide.yaml", {"count": 1}]
    assert set(came.wording) == {"data.0"}
    use("de")
    assert worded(came).data == ["die Gruppe 'Speech' ist gesperrt", "guide.yaml", {"count": 1}]
    blind = Redactor(StudySettings(blind={"warm": "A"}))
    seen = blind.reply(r.Reply(ref=1, ok=True, data=said), {str(said[0]): "guide.yaml:3:1"})
    hidden = codec.decode_incoming(codec.encode(seen))
    assert isinstance(hidden, r.Reply)
    assert isinstance(hidden.data, list)
    assert hidden.data[0] == "guide.yaml:3:1"
    assert not hidden.wording


def test_a_longer_text_of_it_is_a_plain_text() -> None:
    line = codec.encode(m.Notice(level="info", text=f"so: {locked_panel('A').reason}"))
    assert b"wording" not in line


def test_the_count_decides_the_form(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        screen_language,
        "_used",
        {"queue.waits": "{count} warten", "queue.waits_one": "eins wartet"},
    )
    said = [say("queue.waits", "{count} wait", one="one waits", count=count) for count in (1, 2)]
    assert said == ["eins wartet", "2 warten"]
    monkeypatch.setattr(screen_language, "_used", {})
    said = [say("queue.waits", "{count} wait", one="one waits", count=count) for count in (1, 2)]
    assert said == ["one waits", "2 wait"]


@pytest.mark.parametrize(
    "wrong", ["{other}", "{count", "{count:q}", "{count.x.y}", "{}", "{count!z}"]
)
def test_what_cannot_be_filled_in_is_english(monkeypatch: pytest.MonkeyPatch, wrong: str) -> None:
    monkeypatch.setattr(screen_language, "_used", {"queue.waits": wrong})
    assert say("queue.waits", "{count} wait", count=2) == "2 wait"


def test_an_experiments_language_counts_unless_somebody_chose_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("LANG", "en_GB.UTF-8")

    def said() -> str:
        return word(locked_panel("A").reason)

    english, german = "the panel 'A' is locked", "die Gruppe 'A' ist gesperrt"
    choose("")
    assert said() == english
    follow("tlh")
    assert said() == english
    follow("de")
    assert said() == german
    follow("en")  # also of files that name no language
    assert said() == german
    choose("en")
    follow("de")
    assert said() == english


def test_a_language_that_is_not_there_is_english() -> None:
    use("tlh")
    assert word(locked_panel("A").reason) == "the panel 'A' is locked"


@pytest.mark.parametrize(
    ("variables", "code"),
    [
        ({"LANG": "de_AT.UTF-8"}, "de"),
        ({"LANG": "de_DE.UTF-8", "LC_MESSAGES": "en_GB.UTF-8"}, "en"),
        ({"LANG": "en_GB.UTF-8", "LC_ALL": "de"}, "de"),
        ({"LC_ALL": "", "LANG": "de_CH"}, "de"),
        ({"LANG": "C.UTF-8"}, "en"),
        ({"LANG": "POSIX"}, "en"),
        ({"LANG": "tlh_QO"}, "en"),
        ({}, "en"),
    ],
)
def test_the_terminal_says_its_language(variables: dict[str, str], code: str) -> None:
    assert of_environment(variables) == code


def test_nothing_of_it_is_left_where_words_are_taken_out() -> None:
    line = codec.encode(m.Notice(level="info", text=locked_panel("Anna's panel").reason))
    kept = redacted(codec.decode_unknown(line))
    assert "Anna" not in repr(kept) and "wording" in kept


@pytest.mark.parametrize("code", ["gate.no", "gate.off", "gate", "gate.a.b", "Gate.x"])
def test_a_code_that_a_language_file_cannot_name_is_none(code: str, tmp_path: Path) -> None:
    (tmp_path / "woz_tui").mkdir()
    text = f"from {Sentence.__module__} import Sentence\n\nSAID = Sentence({code!r}, 'stop')\n"
    (tmp_path / "woz_tui" / "said.py").write_text(text)
    with pytest.raises(SentencesError, match="no text in YAML"):
        sentences(tmp_path)


def test_why_driving_ended_is_worded_too() -> None:
    gone = Sentence("host.no_response", "{part} does not respond", part=console_of(""))
    came = codec.decode_message(codec.encode(m.StopPressed(source=gone, scope="drive")))
    use("de")
    assert worded(came).source == "die Konsole der Versuchsleitung antwortet nicht"  # type: ignore[attr-defined]
    assert worded(m.StopPressed(source="key")).source == "key"


@pytest.fixture
def klingon(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The file of a language that somebody brings."""
    monkeypatch.setattr(screen_language, "FOLDER", tmp_path)
    catalogue.cache_clear()
    yield tmp_path / "tlh.yaml"
    catalogue.cache_clear()


def test_what_is_no_text_in_a_file_is_english(klingon: Path) -> None:
    klingon.write_text('app:\n  dark: no\n  light: 3\n  or: " ghap "\nqueue:\n42:\n  a: b\n')
    use("tlh")
    said = [say("app.dark", "dark"), say("app.light", "light"), say("app.or", " or ")]
    assert said == ["dark", "light", " ghap "]


def test_a_file_that_is_no_yaml_says_where_to_whoever_asks_for_it(
    klingon: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    klingon.write_text("app:\n  dark: Hurgh\n  light: wov: qar\n")
    parser = ArgumentParser()
    add_language(parser)
    with pytest.raises(SystemExit):
        parser.parse_args(["--language", "tlh"])
    told = capsys.readouterr().err
    assert "tlh.yaml" in told
    assert "line 3" in told
    use("tlh")  # as the experiment's language
    assert say("app.dark", "dark") == "dark"


def test_a_range_has_its_unit_in_the_language_in_use() -> None:
    use("de")
    assert word(range_text(Range(-30, 40, "degrees"))) == "-30 bis 40 Grad"
    assert word(range_text(Range(0, 5, "m"))) == "0 bis 5 m"
    assert range_text(Range(-30, 40, "degrees")) == "-30 to 40 degrees"
