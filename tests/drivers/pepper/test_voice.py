"""The voice over the wire: what arrives at the robot, when it ends, how it is set."""

from __future__ import annotations

from pathlib import Path

import pytest
from woz_drivers.naoqi_robot.settings import VoiceSettings

from tests.drivers.pepper.robot_rig import RobotRig, connected_robot
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
async def test_texts_arrive_unharmed_by_either_way(robot_rig: RobotRig) -> None:
    for text in HARD_TEXTS:
        assert (await robot_rig.do("say", text=text))["text"] == text
        await robot_rig.do("say", text=text, plain=True)
    expected = [(text,) for text in HARD_TEXTS]
    assert await robot_rig.calls("ALAnimatedSpeech.say") == expected
    assert await robot_rig.calls("ALTextToSpeech.say") == expected


@pytest.mark.naoqi("ALTextToSpeech/TextDone")
async def test_say_ends_when_the_robot_has_finished_speaking(robot_rig: RobotRig) -> None:
    text = "This is a sentence that takes the robot a while to say. " * 3
    await robot_rig.do("say", text=text)
    assert not await _speaking(robot_rig)
    last = (await robot_rig.robot.get("said"))[-1]
    assert (last["text"].strip(), last["whole"]) == (text.strip(), True)
    (expected,) = robot_rig.jobs[-1].announced
    assert expected == pytest.approx(len(text.strip()) / 14)
    done = await robot_rig.do("naoqi", call="ALMemory.getData", args='["ALTextToSpeech/TextDone"]')
    assert done["result"] == 1


async def test_the_expected_time_follows_the_speed(robot_rig: RobotRig) -> None:
    await robot_rig.do("speech_speed", percent=200)
    await robot_rig.do("say", text="x" * 28)
    assert robot_rig.jobs[-1].announced == [1.0]
    await robot_rig.do("speech_speed", percent=100)


async def test_a_cancelled_sentence_ends_on_the_robot_and_spares_the_next_one(
    robot_rig: RobotRig,
) -> None:
    job = robot_rig.begin("say", text="A very long story. " * 100)
    await robot_rig.robot.until(lambda: _says(robot_rig, "A very long story"))
    await robot_rig.cancel(job)
    await robot_rig.do("say", text="Something else.")
    cut, whole = (await robot_rig.robot.get("said"))[-2:]
    assert (cut["whole"], whole["whole"]) == (False, True)
    assert whole["text"].strip() == "Something else."


async def test_the_next_sentence_waits_until_the_end_of_the_last_one_has_arrived(
    robot_rig: RobotRig,
) -> None:
    job = robot_rig.begin("say", text="A very long story. " * 100)
    await robot_rig.robot.until(lambda: _says(robot_rig, "A very long story"))
    await robot_rig.robot.fault("slow:300")
    await robot_rig.cancel(job)
    (ended,) = await robot_rig.robot.called("ALTextToSpeech.stopAll")
    await robot_rig.robot.fault("none")
    await robot_rig.do("say", text="Later.")
    begun = (await robot_rig.robot.trace("ALAnimatedSpeech.say"))[-1]
    # The answer to the end took 0.3 s, and only then was the next one sent.
    assert begun.at_ns - ended.at_ns > 250_000_000


async def test_nothing_is_not_said(robot_rig: RobotRig) -> None:
    with pytest.raises(RejectedError, match="nothing to say"):
        await robot_rig.do("say", text=" \n")


async def test_wrong_tags_are_told_and_still_sent(robot_rig: RobotRig) -> None:
    text = r"\vct=500\High \nope=1\ and so on"
    await robot_rig.do("say", text=text)
    assert await robot_rig.calls("ALAnimatedSpeech.say") == [(text,)]
    assert len(robot_rig.notices) == 2
    assert "50 to 200 %" in robot_rig.notices[0]
    assert r"\nope=1" in robot_rig.notices[1]


@pytest.mark.naoqi("tag.rspd", "tag.vct", "tag.vol", "tag.pau", "tag.rst", "tag.run")
async def test_tags_reach_the_voice_and_move_the_body(robot_rig: RobotRig) -> None:
    await robot_rig.do(
        "say",
        text=r"\rspd=50\\vct=150\\vol=50\slow \pau=100\ \rst\ "
        "^run(animations/Stand/Gestures/No_1) normal",
    )
    slow, normal = (await robot_rig.robot.get("said"))[-2:]
    assert (slow["rspd"], slow["vct"], slow["vol"]) == (50, 150, 50)
    assert (normal["rspd"], normal["vct"]) == (100, 100)
    assert (await robot_rig.robot.get("animations"))[-1] == "animations/Stand/Gestures/No_1"


@pytest.mark.naoqi("tag.start", "tag.wait", "tag.stop")
async def test_animations_in_a_sentence_begin_end_and_are_waited_for(robot_rig: RobotRig) -> None:
    whole, cut = (f"animations/Stand/Gestures/{name}" for name in ("Me_1", "Please_1"))
    await robot_rig.do(
        "say",
        text=f"^start({whole}) Me, ^wait({whole}) and ^start({cut}) you, ^stop({cut}) that is all.",
    )
    assert robot_rig.notices == []
    done = await robot_rig.robot.get("animations")
    assert whole in done
    assert cut not in done


# -- reading out ---------------------------------------------------------------------------------


@pytest.mark.woz4u("animated_speech")
async def test_a_file_is_read_out_paragraph_by_paragraph(robot_rig: RobotRig) -> None:
    (robot_rig.folder / "story.txt").write_bytes(
        "Es war\neinmal.\r\n\r\nEin König & Søn.\n".encode("latin-1")
    )
    sent = await robot_rig.do("read", file="story.txt")
    assert sent["paragraphs"] == 2
    assert await robot_rig.calls("ALAnimatedSpeech.say") == [
        ("Es war einmal.",),
        ("Ein König & Søn.",),
    ]
    first, second = robot_rig.jobs[-1].announced
    assert first > second > 0


async def test_reading_can_be_cut_short_between_and_within_paragraphs(robot_rig: RobotRig) -> None:
    (robot_rig.folder / "long.txt").write_text("\n\n".join(["A long paragraph. " * 12] * 20))
    job = robot_rig.begin("read", file="long.txt", plain=True)
    await robot_rig.robot.called("ALTextToSpeech.say", 2)
    await robot_rig.cancel(job)
    await robot_rig.robot.called("ALTextToSpeech.stopAll")
    await robot_rig.do("say", text="Done.")
    assert len(await robot_rig.calls("ALTextToSpeech.say")) < 20
    assert not await _speaking(robot_rig)


@pytest.mark.parametrize("content", [None, "", " \n\n"])
async def test_files_without_a_text_are_refused(robot_rig: RobotRig, content: str | None) -> None:
    if content is not None:
        (robot_rig.folder / "it.txt").write_text(content)
    name = "none.txt" if content is None else "it.txt"
    with pytest.raises(RejectedError, match=name):
        await robot_rig.do("read", file=name)


# -- how it sounds -------------------------------------------------------------------------------


@pytest.mark.naoqi("ALTextToSpeech.setVolume", "ALTextToSpeech.getVolume")
@pytest.mark.naoqi("ALTextToSpeech.setParameter", "ALTextToSpeech.getParameter")
async def test_settings_of_the_voice_are_set_and_read_back(robot_rig: RobotRig) -> None:
    await robot_rig.do("volume", level=0.35)
    await robot_rig.do("speech_speed", percent=150)
    await robot_rig.do("speech_pitch", pitch=1.5)
    await robot_rig.shows(speech_pitch=1.5, volume=0.35, speech_speed=150)
    await robot_rig.do("speech_pitch", pitch=0)
    await robot_rig.shows(speech_pitch=0)
    for refused in ({"pitch": 0.5}, {"pitch": 5}):
        with pytest.raises(RejectedError):
            await robot_rig.do("speech_pitch", **refused)


@pytest.mark.woz4u("volume", "voice_speed", "voice_pitch")
async def test_the_files_voice_is_set_on_connect(tmp_path: Path) -> None:
    async with connected_robot(
        tmp_path, voice=VoiceSettings(volume=0.2, speed=80, pitch=1.2)
    ) as rig:
        asked = {"volume": 0.2, "speech_speed": 80, "speech_pitch": 1.2}
        await rig.tells(
            lambda settings_shown: (
                asked.items() <= settings_shown.values.items() and not settings_shown.wanted
            )
        )


async def test_a_sentence_ends_as_lost_when_the_robot_dies(tmp_path: Path) -> None:
    async with connected_robot(tmp_path) as rig:
        job = rig.begin("say", text="A very long story. " * 100)
        await rig.robot.called("ALAnimatedSpeech.say")
        rig.robot.kill()
        with pytest.raises(DeviceLostError):
            await job
        await rig.tells(lambda settings_shown: "volume" not in settings_shown.values)


async def _says(rig: RobotRig, text: str) -> bool:
    said = await rig.robot.get("said")
    return bool(said) and said[-1]["text"].startswith(text) and await _speaking(rig)


async def _speaking(rig: RobotRig) -> bool:
    return any(kind == "speech" for kind, *_ in await rig.robot.get("going"))
