"""The simulated Furhat satisfies the vendor's own client, alone and beside our driver."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from furhat_realtime_api import AsyncFurhatClient, Events
from naoqi_simulator.robot_time import PacedTime
from robot_simulators.furhat import GESTURES, REQUESTS, FurhatSimulator
from woz_drivers.furhat.realtime_events import read_event

from tests.drivers.furhat.furhat_rig import SOMEBODY, connected_furhat
from woz_tui.testing import until


@asynccontextmanager
async def client(robot: FurhatSimulator, key: str | None = None) -> AsyncIterator[Any]:
    """The vendor's client; it always takes port 9000, so it is told where else."""
    made = AsyncFurhatClient("robot", key)
    made.ws_url = f"ws://{robot.address}/v1/events"
    await made.connect()
    try:
        yield made
    finally:
        await made.disconnect()


@pytest.fixture
async def robot() -> AsyncIterator[FurhatSimulator]:
    async with FurhatSimulator(PacedTime(100)) as robot:
        yield robot


def test_it_knows_every_request_of_the_client() -> None:
    sent = {name for name in vars(Events).values() if str(name).startswith("request.")}
    assert sent - {"request.auth"} <= REQUESTS


async def test_it_speaks_gestures_and_tells_its_state(robot: FurhatSimulator) -> None:
    words: list[Any] = []

    async def word(event: dict[str, Any]) -> None:
        words.append((event["index"], event["word"]))

    async with client(robot) as vendor:
        vendor.add_handler(Events.response_speak_word, word)
        ended = await vendor.request_speak_text("Hello out there", wait=True, monitor_words=True)
        assert (ended["aborted"], ended["failed"]) == (False, False)
        assert words == [(0, "Hello"), (1, "out"), (2, "there")]
        for gesture in GESTURES:
            assert await vendor.request_gesture_start(gesture, wait=True, duration=0.1)
        voice = await vendor.request_voice_config(name="Amy")
        assert voice["voice_id"].startswith("Amy")
        assert len((await vendor.request_voice_status())["voice_list"]) == 3
        await vendor.request_face_config(face_id="adult - Isabel")
        assert (await vendor.request_face_status())["face_id"] == "adult - Isabel"
        await vendor.request_led_set("#123456")
        robot.person = SOMEBODY
        [user] = (await vendor.request_users_once())["users"]
        assert user["distance"] == pytest.approx(1.2)
        assert (await vendor.request_camera_once())["image"]
        assert robot.led == "#123456"


async def test_it_listens(robot: FurhatSimulator) -> None:
    seen: list[str] = []

    async def see(event: dict[str, Any]) -> None:
        seen.append(event["type"].removeprefix("response.") + f" {event.get('text', '')}".rstrip())

    async with client(robot) as vendor:
        for name in ("listen_start", "hear_start", "hear_partial", "hear_end", "listen_end"):
            vendor.add_handler(getattr(Events, f"response_{name}"), see)
        await vendor.request_listen_start(partial=True, end_speech_timeout=0.5)
        await until(lambda: robot.listening)
        await robot.hear("yes please")
        await until(lambda: not robot.listening and len(seen) == 6)
    assert seen == [
        *("listen.start", "hear.start", "hear.partial yes", "hear.partial yes please"),
        *("hear.end yes please", "listen.end"),
    ]


async def test_sound_in_both_directions(robot: FurhatSimulator) -> None:
    async with client(robot) as vendor:
        heard = asyncio.create_task(vendor.wait_for_event(Events.response_audio_data))
        await asyncio.sleep(0)
        await vendor.request_audio_start()
        assert (await heard)["microphone"]
        await vendor.request_audio_stop()
        ended = asyncio.create_task(vendor.wait_for_event(Events.response_speak_end))
        await vendor.request_speak_audio_start(sample_rate=16000)
        await vendor.request_speak_audio_data("AAAA" * 400)
        await vendor.request_speak_audio_end()
        assert (await ended)["aborted"] is False


async def test_a_key_is_asked_for() -> None:
    async with FurhatSimulator(key="right") as robot:
        async with client(robot, "right") as vendor:
            assert await vendor.request_voice_status()
        with pytest.raises(RuntimeError):
            async with client(robot, "wrong"):
                pass


async def test_our_driver_reads_every_event_that_the_client_knows(robot: FurhatSimulator) -> None:
    known = {str(name) for name in vars(Events).values() if str(name).startswith("response.")}
    needed: dict[str, dict[str, Any]] = {
        "response.auth": {"access": True},
        "response.speak.word": {"index": 0},
        "response.hear.partial": {"text": ""},
        "response.users.data": {"users": []},
        "response.camera.data": {"image": ""},
    }
    for name in known:
        assert read_event({"type": name, **needed.get(name, {})}) is not None


async def test_both_play_one_robot(tmp_path: Path) -> None:
    async with connected_furhat(tmp_path) as rig, client(rig.robot) as vendor:
        await vendor.request_attend_user("closest")
        await vendor.request_gesture_start("Smile")
        await until(lambda: rig.robot.gesturing == ["Smile"])
        assert (await rig.do("say", text="Hello"))["text"] == "Hello"
