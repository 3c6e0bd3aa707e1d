"""What visitors mean: names out of sentences, yes and no, in five languages."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.sensing.answer_parsing import LANGUAGES, LONGEST, NameAnswer, NameAnswerParser

ANSWERS = NameAnswerParser(("yes", "yeah", "right", "ok"), ("no", "nope", "wrong"))


@pytest.mark.parametrize(
    ("said", "name"),
    [
        ("Anna", "Anna"),
        ("anna.", "Anna"),
        ("Anna Maria Rossi", "Anna Maria Rossi"),
        ("My name is Anna.", "Anna"),
        ("my name's O\u2019Brien!", "O'Brien"),
        ("I'm Anna", "Anna"),
        ("I am Anna and I'm from Rome", "Anna"),
        ("Hello, my name is, uh, Bob", "Bob"),
        ("I am called Will", "Will"),
        ("Call me Al, please", "Al"),
        ("It's Anna", "Anna"),
        ("Anna is my name", "Anna"),
        ("Anna, nice to meet you", "Anna"),
        ("Ok, Anna", "Anna"),
        ("yes, my name is Anna", "Anna"),
        ("well, let me think, Anna", "Anna"),
        ("My name is Anna what is yours", "Anna"),
        ("P07", "P07"),
        ("Ich heiße Anna", "Anna"),
        ("ich heisse anna maria", "Anna Maria"),
        ("Hallo, ich bin die Anna aus Wien", "Anna"),
        ("Mein Name ist Jürgen", "Jürgen"),
        ("Mi chiamo Anna, piacere", "Anna"),
        ("Ciao, sono Anna", "Anna"),
        ("Je m'appelle Jean-Luc", "Jean-Luc"),
        ("appelez moi Anna", "Anna"),
        ("Me llamo José", "José"),
        ("hola, soy ana", "Ana"),
        ("Can", "Can"),
        ("Ben", "Ben"),
        ("李雷", "李雷"),
    ],
)
def test_a_name_is_taken_out_of_what_is_said(said: str, name: str) -> None:
    assert ANSWERS.read(said).name == name


@pytest.mark.parametrize(
    "said",
    [
        *("", "   ", "...", "?!"),
        *("ok", "OK!", "Okay.", "yes", "No.", "sí", "genau"),
        *("hello", "uh", "sorry?", "what did you say?", "Was?", "come?", "I am fine", "it's me"),
        *("my name is", "my name is not important", "Das ist mein Name", "ich bin müde und hier"),
        *("the quick brown fox jumps over", "nice to meet you too", "x " * LONGEST),
        *("Thank you, goodbye!", "Bye bye", "Tschüss!", "Auf Wiedersehen", "Arrivederci"),
        *("Au revoir", "Adiós, hasta luego"),
    ],
)
def test_what_holds_no_name(said: str) -> None:
    answer = ANSWERS.read(said)
    assert not answer.name and not answer.declined
    assert answer.why


@pytest.mark.parametrize(
    "said", ["I'd rather not.", "I don't want to tell you", "Das sage ich nicht", "no quiero"]
)
def test_nobody_must_give_a_name(said: str) -> None:
    assert ANSWERS.read(said).declined
    assert ANSWERS.read(said, "Anna").declined


@pytest.mark.parametrize(
    "said",
    [
        *(
            "yes",
            "YES!",
            "Yeah.",
            "yEs, it is",
            "Yes it is.",
            "That's right!",
            "right",
            "ok",
            "O.K.",
        ),
        *("Anna", "I'm Anna", "my name is anna", "yes, my name is Anna", "Anna, yes", "OK Anna"),
        *("ja", "Ja, genau", "stimmt", "sì", "SI", "esatto", "oui", "c'est ça", "sí", "of course"),
        *("that is correct", "it is", "yep that's me", "uh, yes"),
    ],
)
def test_yes(said: str) -> None:
    assert ANSWERS.read(said, "Anna") == NameAnswer(yes=True)


@pytest.mark.parametrize(
    ("said", "name"),
    [
        ("no", ""),
        ("Nope.", ""),
        ("no thanks", ""),
        ("no problem", ""),
        ("that's not right", ""),
        ("I am not Anna", ""),
        ("not quite", ""),
        ("it is not", ""),
        ("stimmt nicht", ""),
        ("no, Bob", "Bob"),
        ("No my name is Bob", "Bob"),
        ("no no it's Bob", "Bob"),
        ("No, not Anna, Bob", "Bob"),
        ("no not anna bob", "Bob"),
        ("nein, ich heiße Bob", "Bob"),
        ("Nein, nicht Anna sondern Bob", "Bob"),
        ("non, je m'appelle Bob", "Bob"),
        ("no, Hanna", "Hanna"),
        ("yes, I'm Bob", "Bob"),
    ],
)
def test_no_and_what_instead(said: str, name: str) -> None:
    answer = ANSWERS.read(said, "Anna")
    assert (answer.no, answer.yes, answer.name) == (True, False, name)


def test_another_name_without_a_no() -> None:
    assert ANSWERS.read("Bob", "Anna").name == "Bob"
    assert ANSWERS.read("I'm Bob", "Anna").name == "Bob"


@pytest.mark.parametrize("said", ["yes but no", "right, that's wrong", "", "banana " * 6, "hello"])
def test_what_is_neither_yes_nor_no(said: str) -> None:
    answer = ANSWERS.read(said, "Anna")
    assert (answer.yes, answer.no, answer.name) == (False, False, "")


def test_an_experiment_has_words_of_its_own() -> None:
    answers = NameAnswerParser(("aye, that be me", ""), ("Nay",))
    assert answers.read("Aye that be me!", "Anna").yes
    assert answers.read("nay", "Anna").no
    assert answers.read("aye", "Anna").name == "Aye"


def test_a_name_that_means_yes_elsewhere_is_repeated_not_taken_for_a_yes() -> None:
    assert ANSWERS.read("My name is Klar").name == "Klar"
    assert ANSWERS.read("my name is Vale", "Anna") == NameAnswer(name="Vale", no=True)


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_phrase_of_the_table_does_what_it_is_there_for(language: str) -> None:
    phrases = LANGUAGES[language]
    for phrase in (*phrases.before, *phrases.copulas, *phrases.opening):
        assert ANSWERS.read(f"{phrase} Zebulon").name == "Zebulon", phrase
    for phrase in phrases.after:
        assert ANSWERS.read(f"Zebulon {phrase}").name == "Zebulon", phrase
    for phrase in phrases.yes:
        assert ANSWERS.read(phrase.upper(), "Zebulon").yes, phrase
    for phrase in (*phrases.no, *phrases.negations):
        assert ANSWERS.read(phrase.upper(), "Zebulon").no, phrase
    for phrase in phrases.declines:
        assert ANSWERS.read(phrase).declined, phrase
    for word in (*phrases.never, *phrases.ends, *phrases.fillers):
        assert not ANSWERS.read(word).name, word
    for word in phrases.ends:
        assert ANSWERS.read(f"Zebulon {word} Beeblebrox").name == "Zebulon", word
    for filler in phrases.fillers:
        assert ANSWERS.read(f"{filler} Zebulon").name == "Zebulon", filler


@given(st.text(), st.sampled_from(["", "Anna", "Bob\u0301"]))
def test_whatever_is_heard_is_understood_somehow(said: str, asked: str) -> None:
    answer = ANSWERS.read(said, asked)
    assert not (answer.yes and (answer.no or answer.name or answer.declined))
    assert not answer.yes or asked


PIECES = sorted({word for one in LANGUAGES.values() for table in (one.yes, one.no, one.never)
                 for word in table} | {"Anna", "Bob", ",", "."})  # fmt: skip


@given(st.lists(st.sampled_from(PIECES), max_size=8))
def test_a_yes_is_never_seen_where_a_no_is_said(words: list[str]) -> None:
    answer = ANSWERS.read(" ".join([*words, "no"]), "Anna")
    assert not answer.yes
