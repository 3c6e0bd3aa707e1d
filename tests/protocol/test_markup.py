"""The table of markup in sentences: what is taken out for whom, and what is left."""

from __future__ import annotations

import pytest

from woz_tui.protocol import markup

PEPPER = ("tags", "gestures")
PLAIN: tuple[str, ...] = ()


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("Hello you", "Hello you"),
        ("  as it is \n", "  as it is \n"),
        (
            r"^start(animations/Stand/Gestures/Hey_1) Hello \pau=500\ you "
            "^wait(animations/Stand/Gestures/Hey_1)",
            "Hello you",
        ),
        ("\\rspd=80\\ Slowly", "Slowly"),
        ("\\pau=500 you", "you"),
        ("^start(animations/Stand/Hey_1 you", "you"),
        ("<speak>Good <break time='1s'/> day</speak>", "Good day"),
        ("<speak>Q &amp; A</speak>", "Q & A"),
        ("<emphasis level='strong'>Good</emphasis>.", "Good."),
        ("So<break/>long <break/>.", "So long."),
        ('<prosody rate="80%">Slow</prosody>', "Slow"),
        (r"C:\Users\me and 3^run(2)", r"C:\Users\me and 3"),
        ("a < b and c > d, <b>x</b>, 2^3", "a < b and c > d, <b>x</b>, 2^3"),
    ],
)
def test_a_sentence_without_its_markup(text: str, sentence: str) -> None:
    assert markup.sentence(text) == sentence


@pytest.mark.parametrize(
    ("text", "can", "heard"),
    [
        (r"^start(a/b) Hello \pau=500\ you", PEPPER, r"^start(a/b) Hello \pau=500\ you"),
        (r"^start(a/b) Hello \pau=500\ you", PLAIN, "Hello, you"),
        (r"^start(a/b) Hello \pau=500\ you", ("pause",), r"Hello \pau=500\ you"),
        (r"Hello. \pau=500\ You \pau=9\ ", PLAIN, "Hello. You"),
        (r"Hello \pau=0\ you", PLAIN, "Hello you"),
        ("<speak>Good <break time='1s'/> day</speak>", PEPPER, "Good \\pau=1000\\ day"),
        ("<speak>Good <break time='1s'/> day</speak>", PLAIN, "Good, day"),
        (r"Good \pau=250\ day", ("ssml",), 'Good <break time="250ms"/> day'),
        ("<break strength='x-strong'/>", ("pause",), "\\pau=1000\\"),
        ('<prosody rate="slow">Slow</prosody> on', PEPPER, r"\rspd=75\Slow\rst\ on"),
        ('<prosody rate="slow">Slow</prosody> on', ("pause",), "Slow on"),
        (r"\rspd=80\ Slow \rst\ on", ("speed",), r"\rspd=80\ Slow \rst\ on"),
    ],
)
def test_what_a_voice_gets(text: str, can: tuple[str, ...], heard: str) -> None:
    assert markup.for_voice(text, can) == heard


@pytest.mark.parametrize(
    ("text", "can", "left_out"),
    [
        (r"^start(a/b) Hello \pau=500\ you \vol=50\ x", PEPPER, []),
        (
            r"^start(a/b) Hello \pau=500\ you \vol=50\ x",
            PLAIN,
            ["^start(a/b)", "\\pau=500\\", "\\vol=50\\"],
        ),
        (r"^start(a/b) Hello \pau=500\ you", ("pause",), ["^start(a/b)"]),
        ("<speak><emphasis>Good</emphasis></speak>", PEPPER, ["<emphasis>"]),
        ("<speak>Good</speak>", PLAIN, []),
    ],
)
def test_what_a_voice_cannot_do(text: str, can: tuple[str, ...], left_out: list[str]) -> None:
    assert [mark.written for mark in markup.left_out(text, can)] == left_out


def test_pieces_between_pauses() -> None:
    text = r"One \pau=500\ two <break time='250ms'/>"
    assert markup.pieces(text) == [("One", 0.5), ("two", 0.25), ("", 0.0)]
    assert markup.pieces("One") == [("One", 0.0)]


def test_signs_alone_are_no_piece() -> None:
    text = r"\pau=100\ ... \pau=200\ One \pau=300\ ! \pau=400\ two"
    assert markup.pieces(text) == [
        *(("", 0.1), ("", 0.2), ("... One !", 0.3), ("", 0.4), ("two", 0.0))
    ]
    assert markup.pieces(r"... \pau=100\ !") == [("...", 0.1), ("!", 0.0)]


@pytest.mark.parametrize("text", ["\\pau=", "^run(", "<break ", '<prosody rate="', "<speak", "^"])
def test_a_text_of_nothing_but_beginnings_is_read_at_once(text: str) -> None:
    """In a time that grows with the text's length: with its square this takes minutes."""
    assert markup.sentence("Hello " + text * 20_000).startswith("Hello")
