"""A camera's pictures over the robot process's own socket."""

from __future__ import annotations

import asyncio
import base64
import zlib
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.host.rig import Peer, ServedSession, served_session
from tests.session.rig import WAIT_S
from woz_tui.protocol.camera_pictures import PICTURE, WATCHED, CameraWatched, Picture

RED, BLUE = (200, 10, 10), (10, 10, 200)


@pytest.fixture
async def host(tmp_path: Path) -> AsyncIterator[ServedSession]:
    async with served_session(tmp_path) as place:
        yield place


def give(
    host: ServedSession, colour: tuple[int, int, int] = RED, width: int = 64, height: int = 48
) -> int:
    """The driver `robot` has a camera, and it takes a picture; its time."""
    now = host.session.clock.now_us()
    rgb = bytes(colour) * (width * height)
    host.session.feeds.feed("robot", PICTURE).put(Picture(now, width, height, rgb))
    return host.session.hub.t(now)


def wish(host: ServedSession) -> CameraWatched:
    value = host.session.feeds.feed("robot", WATCHED).latest().value
    assert isinstance(value, CameraWatched)
    return value


async def ask_for_picture(peer: Peer, **fields: Any) -> dict[str, Any]:
    """Ask for a picture; the answer, whatever it is."""
    ref = len(peer.seen) + 500
    await peer.say(kind="picture", ref=ref, **fields)
    return await peer.until(
        lambda line: line["kind"] in ("picture", "reply") and line["ref"] == ref
    )


def pixels(line: dict[str, Any]) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    rgb = zlib.decompress(base64.b64decode(line["data"]))
    return np.frombuffer(rgb, np.uint8).reshape(line["height"], line["width"], 3)


@pytest.mark.parametrize("role", ["wizard", "watcher"])
async def test_who_sees_the_robot_sees_its_pictures(host: ServedSession, role: str) -> None:
    taken = give(host)
    peer = await host.connect()
    await peer.hello(role)
    line = await ask_for_picture(peer, width=16, height=99)
    assert line["kind"] == "picture"
    assert (line["driver"], line["cameras"]) == ("robot", ["robot"])
    assert (line["width"], line["height"]) == (16, 12)
    assert (line["camera_width"], line["camera_height"]) == (64, 48)
    assert (line["number"], line["t"]) == (1, taken)
    assert (pixels(line) == RED).all()


@pytest.mark.parametrize("role", ["participant", "program"])
async def test_nobody_else_does(host: ServedSession, role: str) -> None:
    give(host)
    peer = await host.connect()
    await peer.hello(role)
    line = await ask_for_picture(peer)
    assert (line["kind"], line.get("ok")) == ("reply", False)
    assert line["reason"]
    assert host.session.feeds.feed("robot", WATCHED).latest().serial == 0, "no camera was woken"


async def test_the_same_picture_is_not_given_twice(
    host: ServedSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_tui.host.picture_service.WAIT_S", WAIT_S)
    give(host)
    peer = await host.connect()
    await peer.hello("wizard")
    first = await ask_for_picture(peer)
    waiting = asyncio.ensure_future(ask_for_picture(peer, after=first["number"]))
    await asyncio.sleep(0.1)
    assert not waiting.done()
    give(host, BLUE)
    second = await asyncio.wait_for(waiting, WAIT_S)
    assert second["number"] == 2
    assert (pixels(second) == BLUE).all()


async def test_after_a_second_it_says_that_there_is_none(host: ServedSession) -> None:
    give(host)
    peer = await host.connect()
    await peer.hello("wizard")
    line = await ask_for_picture(peer, after=1)
    assert line["kind"] == "picture"
    assert "data" not in line
    assert line["why"] == "robot sent no new picture within 1 s"


async def test_the_camera_hears_what_all_who_watch_want(
    host: ServedSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_tui.host.picture_service.WATCHED_S", 60.0)
    give(host)
    one, other = await host.connect(), await host.connect()
    await one.hello("wizard")
    await other.hello("watcher")
    before = host.session.clock.now_us()
    await ask_for_picture(one, width=600, rate=2.0)
    await ask_for_picture(other, width=100, rate=8.0)
    assert (wish(host).width, wish(host).rate) == (600, 8.0)
    await ask_for_picture(one, width=600, rate=2.0)
    assert (wish(host).width, wish(host).rate) == (600, 8.0)
    now = host.session.clock.now_us()
    assert before + 60_000_000 < wish(host).until_us <= now + 60_000_000


async def test_who_watches_no_longer_wants_nothing(
    host: ServedSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_tui.host.picture_service.WATCHED_S", 0.02)
    give(host)
    one, other = await host.connect(), await host.connect()
    await one.hello("wizard")
    await other.hello("watcher")
    await ask_for_picture(one, width=600, rate=8.0)
    until_us = wish(host).until_us
    while host.session.clock.now_us() <= until_us:  # noqa: ASYNC110 - nobody tells
        await asyncio.sleep(0.005)
    await ask_for_picture(other, width=100, rate=2.0)
    assert (wish(host).width, wish(host).rate) == (100, 2.0)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"driver": "nobody"}, "no driver 'nobody'"),
        ({"width": 0}, "1 x 1"),
        ({"height": 5000}, "1920 x 1920"),
        ({"rate": 0.0}, "rate"),
        ({"rate": 1000.0}, "rate"),
    ],
)
async def test_wishes_that_cannot_be(
    host: ServedSession, fields: dict[str, Any], words: str
) -> None:
    give(host)
    peer = await host.connect()
    await peer.hello("wizard")
    line = await ask_for_picture(peer, **fields)
    assert (line["kind"], line.get("ok")) == ("reply", False)
    assert words in line["reason"]


async def test_a_session_without_a_camera_says_so(host: ServedSession) -> None:
    peer = await host.connect()
    await peer.hello("wizard")
    line = await ask_for_picture(peer)
    assert line["reason"] == "no driver of this session has a camera"
    assert "`eye: {type: camera}`" in line["hint"], "what to write; not only where it is explained"


async def test_one_picture_at_a_time(host: ServedSession, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("woz_tui.host.picture_service.WAIT_S", WAIT_S)
    give(host)
    peer = await host.connect()
    await peer.hello("wizard")
    await peer.say(kind="picture", ref=1, after=1)
    line = await ask_for_picture(peer, after=1)
    assert line["reason"] == "the previous picture has not arrived yet"
    give(host, BLUE)
    assert (await peer.kind("picture"))["ref"] == 1
    assert (await ask_for_picture(peer))["kind"] == "picture"


async def test_a_picture_that_is_none_is_told(host: ServedSession) -> None:
    feed = host.session.feeds.feed("robot", PICTURE)
    feed.put(Picture(host.session.clock.now_us(), 64, 48, b"too short"))
    peer = await host.connect()
    await peer.hello("wizard")
    line = await ask_for_picture(peer)
    assert (line["kind"], line.get("ok")) == ("reply", False)
    assert "64 x 48" in line["reason"]
    give(host)
    assert (await ask_for_picture(peer))["kind"] == "picture"


async def test_pictures_are_neither_in_the_log_nor_on_the_stream(host: ServedSession) -> None:
    give(host)
    peer, other = await host.connect(), await host.connect()
    await other.hello("watcher")
    await peer.hello("wizard")
    seq = host.session.hub.seq
    for _ in range(3):
        await ask_for_picture(peer)
    assert host.session.hub.seq == seq
    await other.say(kind="marker", ref=7)
    await other.kind("marker")
    assert "picture" not in {line["kind"] for line in other.seen}


async def test_who_leaves_in_the_middle_disturbs_nobody(host: ServedSession) -> None:
    give(host)
    peer, other = await host.connect(), await host.connect()
    await peer.hello("watcher")
    await other.hello("wizard")
    await peer.say(kind="picture", ref=1, after=1)
    peer.leave()
    assert (await ask_for_picture(other))["kind"] == "picture"
