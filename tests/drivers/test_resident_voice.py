"""A voice that stays loaded: a good one, and one that dies, hangs, babbles or answers late."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import msgspec
import pytest
from woz_drivers.speech import doctor, synthesis
from woz_drivers.speech.driver import Speech
from woz_drivers.speech.settings import SpeechSettings
from woz_drivers.speech.text_parts import goes_on, spoken_parts

from tests.drivers.published_messages import BusJob, until
from tests.drivers.resident_programs import ROOT, command, processes
from tests.drivers.speech_rig import SpeechRig, desk_in, say, say_arguments
from tests.fakes.sound import journal_entries
from woz_tui.drivers.contract import DriverError, Probe, Scope
from woz_tui.protocol.messages import (
    DriverConnected,
    DriverFaulted,
    DriverHealth,
    DriverLost,
    Notice,
    Reading,
)


@pytest.fixture
async def rig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[SpeechRig]:
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    async with desk_in(tmp_path) as speech_rig:
        yield speech_rig


@pytest.fixture
def journal(tmp_path: Path) -> Path:
    return tmp_path / "resident"


async def open_speech(
    speech_rig: SpeechRig, journal: Path, *behaviours: str, **settings: Any
) -> Speech:
    voice = command(journal, *behaviours)
    return await speech_rig.open(synthesise="", resident_voice=voice, **settings)


async def test_it_is_loaded_once_and_speaks_with_the_voice_of_each_action(
    rig: SpeechRig, journal: Path
) -> None:
    driver = await open_speech(rig, journal, "ok")
    first = await driver.perform(say("Hello there."))
    second = await driver.perform(
        BusJob("say", {"text": "Guten Tag.", "language": "de", "speed": 90, "voice": "eva"})
    )
    again = await driver.perform(say("Hello there."))
    assert (first["source"], first["words"]) == ("synthesised", [["hello", 0.0, 0.05]])
    assert (second["source"], second["seconds"]) == ("synthesised", 0.1)
    assert (again["source"], again["words"]) == ("cache", first["words"])
    assert len(journal_entries(journal, "start")) == 1
    assert rig.published.states("synthesiser") == ["loading", "ready"]
    delays = [one.value for one in rig.published.all(Reading) if one.sensor == "synthesiser"]
    assert delays == [pytest.approx(sent["delay"], abs=0.01) for sent in (first, second)]
    asked = [
        [line[name] for name in ("text", "voice", "language", "speed", "pitch")]
        for line in journal_entries(journal, "request")
    ]
    assert asked == [["Hello there.", "", "", 160, 50], ["Guten Tag.", "eva", "de", 90, 50]]
    assert len(rig.journal_entries("played")) == 3


@pytest.mark.parametrize("behaviour", ["twice", "late", "nonsense", "parts", "raw"])
async def test_what_is_no_answer_is_passed_over(
    behaviour: str, rig: SpeechRig, journal: Path
) -> None:
    driver = await open_speech(rig, journal, behaviour)
    for text in ("One", "Two"):
        assert (await driver.perform(say(text)))["seconds"] == 0.1
    assert len(journal_entries(journal, "start")) == 1


@pytest.mark.parametrize(
    ("behaviour", "what"),
    [
        ("die", "out of memory"),
        ("endless", "more than 1 MiB"),
        ("error", "no such voice"),
        ("wrong", "wrong answer"),
        ("silent", "wrote no sound"),
    ],
)
async def test_a_sentence_that_fails_says_why_and_the_next_one_is_spoken(
    behaviour: str, what: str, rig: SpeechRig, journal: Path
) -> None:
    driver = await open_speech(rig, journal, behaviour, "ok")
    with pytest.raises(DriverError, match=what):
        await driver.perform(say("One"))
    assert (await driver.perform(say("Two")))["seconds"] == 0.1


async def test_one_that_hangs_is_started_again(
    rig: SpeechRig, journal: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(synthesis, "_SYNTHESIS_S", 1.0)
    driver = await open_speech(rig, journal, "hang", "ok")
    with pytest.raises(DriverError, match="did not answer"):
        await driver.perform(say("One"))
    monkeypatch.undo()
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    assert (await driver.perform(say("Two")))["seconds"] == 0.1
    assert len(processes(journal)) == 1


async def test_its_temporary_files_go_with_it(rig: SpeechRig, journal: Path) -> None:
    driver = await open_speech(rig, journal, "die", "ok")
    with pytest.raises(DriverError, match="out of memory"):
        await driver.perform(say("One"))
    await driver.perform(say("Two"))
    dead, running = (Path(str(line["temporary"])) for line in journal_entries(journal, "start"))
    assert not dead.exists()
    assert running.exists()
    await driver.close()
    assert not running.exists()
    assert not running.parent.exists()


async def test_without_a_place_for_temporary_files_it_says_so_and_comes_when_there_is_one(
    rig: SpeechRig, journal: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "temporary"
    monkeypatch.setattr("tempfile.tempdir", str(place))
    driver = await open_speech(rig, journal, "ok")
    with pytest.raises(DriverError, match=str(place)) as raised:
        await driver.perform(say("One"))
    assert "TMPDIR" in raised.value.remedy
    place.mkdir()
    await rig.published.state("synthesiser", "ready")
    assert (await driver.perform(say("Two")))["seconds"] == 0.1


async def test_its_death_is_the_drivers_health_until_it_is_back(
    rig: SpeechRig, journal: Path
) -> None:
    driver = await open_speech(rig, journal, "ok")
    await driver.perform(say("One"))
    (running,) = processes(journal)
    running.kill()
    faulted = await rig.published.first(DriverFaulted)
    assert str(journal) in faulted.remedy, "it names the command"
    await rig.published.first(DriverConnected, after=1)
    assert (await driver.perform(say("Two")))["seconds"] == 0.1


async def test_a_player_that_failed_is_told_until_it_plays_whatever_the_voice_does(
    rig: SpeechRig, journal: Path, tmp_path: Path
) -> None:
    card = tmp_path / "card"
    player = f"test -e {card} || {{ echo no such device >&2; exit 1; }}"
    driver = await open_speech(rig, journal, "ok", play=("sh", "-c", player, "{wav}"))
    with pytest.raises(DriverError, match="no such device"):
        await driver.perform(say("One"))
    (running,) = processes(journal)
    running.kill()
    await rig.published.until(lambda: "stale" in rig.published.states("synthesiser"))
    await rig.published.state("synthesiser", "ready")
    assert isinstance(health := rig.published.all(DriverHealth)[-1], DriverFaulted)
    assert "no such device" in health.detail
    card.touch()
    await driver.perform(say("One"))
    assert isinstance(rig.published.all(DriverHealth)[-1], DriverConnected)


async def test_a_player_that_was_missing_for_a_while_is_found_again(
    rig: SpeechRig, journal: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_drivers.speech.driver._LOOK_S", 0.05)
    player = tmp_path / "player"
    player.write_text("#!/bin/sh\n")
    player.chmod(0o700)
    driver = await open_speech(rig, journal, "ok", play=(str(player), "{wav}"))
    await rig.published.state("synthesiser", "ready")
    player.rename(tmp_path / "away")
    (running,) = processes(journal)
    running.kill()
    await rig.published.until(lambda: "stale" in rig.published.states("synthesiser"))
    await rig.published.state("synthesiser", "ready")
    assert isinstance(rig.published.all(DriverHealth)[-1], DriverLost)
    (tmp_path / "away").rename(player)
    await rig.published.until(
        lambda: isinstance(rig.published.all(DriverHealth)[-1], DriverConnected)
    )
    await driver.perform(say("One"))


async def test_what_cannot_be_prepared_is_prepared_when_it_is_back(
    rig: SpeechRig, journal: Path
) -> None:
    driver = await open_speech(rig, journal, "ok", "die", "ok")
    await driver.prepare_say(say_arguments("One", "Two", "Three"))
    (notice,) = rig.published.all(Notice)
    assert "not prepared" in notice.text

    def ready() -> list[str]:
        return [one.text for one in rig.published.all(Reading) if one.sensor == "prepared"]

    await rig.published.until(lambda: "3 of 3" in ready())
    assert [line["text"] for line in journal_entries(journal, "request")] == [
        "One",
        "Two",
        "Two",
        "Three",
    ]
    assert (await driver.perform(say("Three")))["source"] == "cache"


async def test_a_typed_sentence_waits_for_one_prepared_sentence_at_most(
    rig: SpeechRig, journal: Path, tmp_path: Path
) -> None:
    driver = await open_speech(rig, journal, "slow", "ok")
    preparing = asyncio.ensure_future(driver.prepare_say(say_arguments("One", "Two", "Three")))
    typed = asyncio.ensure_future(driver.perform(say("Typed")))
    await asyncio.sleep(0)
    (tmp_path / "loaded").touch()
    await asyncio.gather(preparing, typed)
    texts = [line["text"] for line in journal_entries(journal, "request")]
    assert texts.index("Typed") <= 1


async def test_a_typed_text_is_heard_before_its_second_sentence_is_made(
    rig: SpeechRig, journal: Path
) -> None:
    driver = await open_speech(rig, journal, "ok", "hang")
    speaking = asyncio.ensure_future(driver.perform(say("One more. Then another. The end.")))
    await until(lambda: len(rig.journal_entries("played")) == 1)
    await until(lambda: len(journal_entries(journal, "request")) == 2)
    await driver.stop(Scope.ALL)
    with contextlib.suppress(asyncio.CancelledError):
        await speaking
    assert speaking.cancelled()
    asked = [str(line["text"]) for line in journal_entries(journal, "request")]
    assert asked == ["One more.", "Then another."]


PHRASES = "No, I cannot do that now because my left arm is tired after the day in the laboratory."


@pytest.mark.parametrize(
    "parted",
    [
        "Hello.",
        "Yes, I can.|Why not?",
        "Ask Dr. Who here, Anna.|He knows 3.5 things.",
        "Welcome to the museum,|picture one is the one I like.|Yes, that one over there.",
        "No, I cannot do that now|because my left arm is tired after the day in the laboratory.",
        "Donaudampfschifffahrtskapitän|ist ein langes Wort.",
        "Great big green elephants|never drive tractors.",
        "Incomprehensibilities!",
    ],
)
def test_in_which_parts_a_typed_text_is_made(parted: str) -> None:
    text = parted.replace("|", " ")
    assert spoken_parts(text, 25, lambda letters: 4 * letters) == parted.split("|")
    assert not goes_on(parted)


def test_parts_grow_as_fast_as_they_are_spoken() -> None:
    assert len(spoken_parts(PHRASES, 25, lambda letters: letters + 5)) == 3
    assert spoken_parts(PHRASES, 300, lambda letters: letters) == [PHRASES]
    assert len(spoken_parts(f"{PHRASES} {PHRASES}", 25, lambda letters: 1000)) == 3


async def test_a_voice_that_is_quick_makes_a_sentence_as_a_whole(
    rig: SpeechRig, journal: Path
) -> None:
    settings = rig.settings(synthesise="", resident_voice=command(journal, "ok"))
    voice, choice = synthesis.SpeechSynthesis(settings, rig.folder), settings.choice()
    before = voice.parts(PHRASES, choice)
    assert len(before) > 1, "nobody knows how fast it is"
    for number in range(200):  # as many as a busy machine needs
        another = f"{PHRASES[:-1]} {number}."
        if voice.parts(another, choice) == [another]:
            break
        await voice.utterance(f"A sentence that says how fast it is, number {number}.", choice)
    else:
        pytest.fail("it cuts for a quick voice, too")
    assert voice.parts(PHRASES, choice) == before, "as it was predicted"
    await voice.close()


async def test_within_a_sentence_nobody_pauses(rig: SpeechRig, journal: Path) -> None:
    settings = rig.settings(synthesise="", resident_voice=command(journal, "pause"))
    voice, choice = synthesis.SpeechSynthesis(settings, rig.folder), settings.choice()
    parts = ["Welcome to the museum", "where I am,", "which is mine."]
    made = [await voice.part(parts, number, choice) for number in range(3)]
    assert [round(each.sound.seconds, 2) for each in made] == [0.13, 0.3, 0.3]
    assert (await voice.utterance(parts[0], choice)).sound.seconds == pytest.approx(0.3)
    await voice.close()


async def test_its_sentences_are_one_utterance_and_a_prepared_one_is_made_whole(
    rig: SpeechRig, journal: Path
) -> None:
    driver = await open_speech(rig, journal, "ok")
    whole = "Who is Dr. Who? One more."
    job = say(whole)
    sent = await driver.perform(job)
    assert job.announced == [pytest.approx(0.16), pytest.approx(0.1)], "both, then the rest"
    assert (sent["text"], sent["seconds"], sent["source"]) == (whole, 0.2, "synthesised")
    heard = msgspec.convert(sent["words"], list[tuple[str, float, float]])
    assert [word for word, _, _ in heard] == ["hello", "hello"]
    assert heard[0][1] == 0.0
    assert heard[1][1] >= 0.1, "when the second sentence was heard"
    await driver.prepare_say(say_arguments(whole))
    assert (await driver.perform(say(whole)))["source"] == "cache"
    asked = [line["text"] for line in journal_entries(journal, "request")]
    assert asked == ["Who is Dr. Who?", "One more.", whole]
    assert len(rig.journal_entries("played")) == 3


async def test_a_sentence_with_pauses_is_cut_within_what_is_said_between_them(
    rig: SpeechRig, journal: Path
) -> None:
    driver = await open_speech(rig, journal, "ok")
    museum = "In this museum I am the one who knows about the old pictures and about the clocks."
    text = f"\\pau=500\\ {museum} \\pau=250\\ Come in."
    sent = await driver.perform(say(text))
    asked = [str(line["text"]) for line in journal_entries(journal, "request")]
    assert len(asked) > 2
    assert " ".join(asked[:-1]) == museum and asked[-1] == "Come in."
    assert sent["text"] == f"{museum} Come in."
    assert sent["seconds"] == pytest.approx(0.75 + 0.1 * len(asked))
    await driver.prepare_say(say_arguments(f"{museum} \\pau=100\\ Come in."))
    assert (await driver.perform(say(f"{museum} \\pau=300\\ Come in.")))["source"] == "cache"
    assert len(rig.journal_entries("played")) == len(asked) + 2


async def test_the_stop_does_not_cost_its_loading(rig: SpeechRig, journal: Path) -> None:
    driver = await open_speech(rig, journal, "slow", "ok")
    speaking = asyncio.ensure_future(driver.perform(say("One")))
    await asyncio.sleep(0)
    await driver.stop(Scope.ALL)
    with contextlib.suppress(asyncio.CancelledError):
        await speaking
    assert speaking.cancelled()
    journal.with_name("loaded").touch()
    assert (await driver.perform(say("Two")))["seconds"] == 0.1
    assert len(journal_entries(journal, "start")) == 1


async def test_one_that_does_not_come_up_fails_at_once_and_leaves_recordings(
    rig: SpeechRig, journal: Path
) -> None:
    rig.wav("hello.wav", 0.2)
    driver = await open_speech(rig, journal, "unloadable", recordings={"Hello": "hello.wav"})
    with pytest.raises(DriverError, match="no model"):
        await driver.perform(say("Something else"))
    assert (await driver.perform(say("Hello")))["source"] == "recording"


async def test_doctor_says_a_word_with_it(rig: SpeechRig, journal: Path) -> None:
    for behaviour, level in (("ok", "ok"), ("unloadable", "error")):
        voice = command(journal, behaviour)
        settings = rig.settings(synthesise="", resident_voice=voice, cache=str(rig.folder / level))
        finding, *_ = await Speech.examine(Probe("voice", settings, rig.folder))
        assert finding.level == level
        await until(lambda: processes(journal) == [])


async def test_doctor_does_not_call_slow_loading_an_error(
    rig: SpeechRig, journal: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "_PATIENCE_S", 0.2)
    settings = rig.settings(synthesise="", resident_voice=command(journal, "slow"))
    finding, *_ = await Speech.examine(Probe("voice", settings, rig.folder))
    assert finding.level == "warning"
    assert processes(journal) == []


@pytest.mark.parametrize(
    ("settings", "name"),
    [
        ({"resident_voice": "a", "synthesise": "b"}, "synthesise"),
        ({"resident_voice": "a {text}"}, "resident_voice"),
        ({"resident_voice": "a", "speak": "b"}, "speak"),
    ],
)
def test_settings_that_contradict_each_other(settings: dict[str, Any], name: str) -> None:
    assert [found for found, _ in SpeechSettings(**settings).problems()] == [name]
