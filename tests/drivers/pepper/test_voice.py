"""The voice over the wire: what arrives at the robot, when it ends, how it is set."""

from __future__ import annotations

from pathlib import Path

import pytest
from woz_drivers.naoqi_robot.naoqi_settings import VoiceSettings

from tests.drivers.pepper.played import Played, played
from woz_tui.drivers.contract import DeviceLostError, RejectedError

pytestmark = pytest.mark.asyncio(loop_scope="module")
#: What is in here is so of both.
KINDS = ("pepper", "nao")


#: What a web form or a template may lose or change.
HARD_TEXTS = (
    "AT&T &amp; &apos;you&apos; #1 100 % {participant} {} \"quoted\" 'single' <b>bold</b>",
    "Zoë fährt für 5 € nach Łódź. 日本語もOK 🙂",
    "Line one.\nLine two.\tTabbed.\r\nThree.",
    r"back\slash \\ and \rspd=80\slow\rst\ ^run(animations/Stand/Gestures/Yes_1) end",
    "^ $HOME `id` ; rm -rf / | ~ * ?",
)


@pytest.mark.naoqi("ALAnimatedSpeech.say", "ALTextToSpeech.say")
async def test_texts_arrive_unharmed_by_either_way(it: Played) -> None:
    for text in HARD_TEXTS:
        assert (await it.do("say", text=text))["text"] == text
        await it.do("say", text=text, plain=True)
    expected = [(text,) for text in HARD_TEXTS]
    assert await it.calls("ALAnimatedSpeech.say") == expected
    assert await it.calls("ALTextToSpeech.say") == expected


@pytest.mark.naoqi("ALTextToSpeech/TextDone")
async def test_say_ends_when_the_robot_has_finished_speaking(it: Played) -> None:
    text = "This is a sentence that takes the robot a while to say. " * 3
    await it.do("say", text=text)
    assert not await _speaking(it)
    last = (await it.robot.get("said"))[-1]
    assert (last["text"].strip(), last["whole"]) == (text.strip(), True)
    (expected,) = it.jobs[-1].announced
    assert expected == pytest.approx(len(text.strip()) / 14)
    done = await it.do("naoqi", call="ALMemory.getData", args='["ALTextToSpeech/TextDone"]')
    assert done["result"] == 1


async def test_the_expected_time_follows_the_speed(it: Played) -> None:
    await it.do("speech_speed", percent=200)
    await it.do("say", text="x" * 28)
    assert it.jobs[-1].announced == [1.0]
    await it.do("speech_speed", percent=100)


async def test_a_cancelled_sentence_ends_on_the_robot_and_spares_the_next_one(it: Played) -> None:
    job = it.begin("say", text="A very long story. " * 100)
    await it.robot.until(lambda: _says(it, "A very long story"))
    await it.cancel(job)
    await it.do("say", text="Something else.")
    cut, whole = (await it.robot.get("said"))[-2:]
    assert (cut["whole"], whole["whole"]) == (False, True)
    assert whole["text"].strip() == "Something else."


async def test_the_next_sentence_waits_until_the_end_of_the_last_one_has_arrived(
    it: Played,
) -> None:
    job = it.begin("say", text="A very long story. " * 100)
    await it.robot.until(lambda: _says(it, "A very long story"))
    await it.robot.fault("slow:300")
    await it.cancel(job)
    (ended,) = await it.robot.called("ALTextToSpeech.stopAll")
    await it.robot.fault("none")
    await it.do("say", text="Later.")
    begun = (await it.robot.trace("ALAnimatedSpeech.say"))[-1]
    # The answer to the end took 0.3 s, and only then was the next one sent.
    assert begun.at_ns - ended.at_ns > 250_000_000


async def test_nothing_is_not_said(it: Played) -> None:
    with pytest.raises(RejectedError, match="nothing to say"):
        await it.do("say", text=" \n")


async def test_wrong_tags_are_told_and_still_sent(it: Played) -> None:
    text = r"\vct=500\High \nope=1\ and so on"
    await it.do("say", text=text)
    assert await it.calls("ALAnimatedSpeech.say") == [(text,)]
    assert len(it.notices) == 2
    assert "50 to 200 %" in it.notices[0]
    assert r"\nope=1" in it.notices[1]


@pytest.mark.naoqi("tag.rspd", "tag.vct", "tag.vol", "tag.pau", "tag.rst", "tag.run")
async def test_tags_reach_the_voice_and_move_the_body(it: Played) -> None:
    await it.do(
        "say",
        text=r"\rspd=50\\vct=150\\vol=50\slow \pau=100\ \rst\ "
        "^run(animations/Stand/Gestures/No_1) normal",
    )
    slow, normal = (await it.robot.get("said"))[-2:]
    assert (slow["rspd"], slow["vct"], slow["vol"]) == (50, 150, 50)
    assert (normal["rspd"], normal["vct"]) == (100, 100)
    assert (await it.robot.get("animations"))[-1] == "animations/Stand/Gestures/No_1"


@pytest.mark.naoqi("tag.start", "tag.wait", "tag.stop")
async def test_animations_in_a_sentence_begin_end_and_are_waited_for(it: Played) -> None:
    whole, cut = (f"animations/Stand/Gestures/{name}" for name in ("Me_1", "Please_1"))
    await it.do(
        "say",
        text=f"^start({whole}) Me, ^wait({whole}) and ^start({cut}) you, ^stop({cut}) that is all.",
    )
    assert it.notices == []
    done = await it.robot.get("animations")
    assert whole in done
    assert cut not in done


# -- reading out ---------------------------------------------------------------------------------


@pytest.mark.woz4u("animated_speech")
async def test_a_file_is_read_out_paragraph_by_paragraph(it: Played) -> None:
    (it.folder / "story.txt").write_bytes(
        "Es war\neinmal.\r\n\r\nEin König & Søn.\n".encode("latin-1")
    )
    sent = await it.do("read", file="story.txt")
    assert sent["paragraphs"] == 2
    assert await it.calls("ALAnimatedSpeech.say") == [("Es war einmal.",), ("Ein König & Søn.",)]
    first, second = it.jobs[-1].announced
    assert first > second > 0


async def test_reading_can_be_cut_short_between_and_within_paragraphs(it: Played) -> None:
    (it.folder / "long.txt").write_text("\n\n".join(["A long paragraph. " * 12] * 20))
    job = it.begin("read", file="long.txt", plain=True)
    await it.robot.called("ALTextToSpeech.say", 2)
    await it.cancel(job)
    await it.robot.called("ALTextToSpeech.stopAll")
    await it.do("say", text="Done.")
    assert len(await it.calls("ALTextToSpeech.say")) < 20
    assert not await _speaking(it)


@pytest.mark.parametrize("content", [None, "", " \n\n"])
async def test_files_without_a_text_are_refused(it: Played, content: str | None) -> None:
    if content is not None:
        (it.folder / "it.txt").write_text(content)
    name = "none.txt" if content is None else "it.txt"
    with pytest.raises(RejectedError, match=name):
        await it.do("read", file=name)


# -- how it sounds -------------------------------------------------------------------------------


@pytest.mark.naoqi("ALTextToSpeech.setVolume", "ALTextToSpeech.getVolume")
@pytest.mark.naoqi("ALTextToSpeech.setParameter", "ALTextToSpeech.getParameter")
async def test_settings_of_the_voice_are_set_and_read_back(it: Played) -> None:
    await it.do("volume", level=0.35)
    await it.do("speech_speed", percent=150)
    await it.do("speech_pitch", pitch=1.5)
    await it.shows(speech_pitch=1.5, volume=0.35, speech_speed=150)
    await it.do("speech_pitch", pitch=0)
    await it.shows(speech_pitch=0)
    for refused in ({"pitch": 0.5}, {"pitch": 5}):
        with pytest.raises(RejectedError):
            await it.do("speech_pitch", **refused)


@pytest.mark.woz4u("volume", "voice_speed", "voice_pitch")
async def test_the_files_voice_is_set_on_connect(tmp_path: Path) -> None:
    async with played(tmp_path, voice=VoiceSettings(volume=0.2, speed=80, pitch=1.2)) as it:
        asked = {"volume": 0.2, "speech_speed": 80, "speech_pitch": 1.2}
        await it.tells(lambda shown: asked.items() <= shown.values.items() and not shown.wanted)


async def test_a_sentence_ends_as_lost_when_the_robot_dies(tmp_path: Path) -> None:
    async with played(tmp_path) as it:
        job = it.begin("say", text="A very long story. " * 100)
        await it.robot.called("ALAnimatedSpeech.say")
        it.robot.kill()
        with pytest.raises(DeviceLostError):
            await job
        await it.tells(lambda shown: "volume" not in shown.values)


async def _says(it: Played, text: str) -> bool:
    said = await it.robot.get("said")
    return bool(said) and said[-1]["text"].startswith(text) and await _speaking(it)


async def _speaking(it: Played) -> bool:
    return any(kind == "speech" for kind, *_ in await it.robot.get("going"))
