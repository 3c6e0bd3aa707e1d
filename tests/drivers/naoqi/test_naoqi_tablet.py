"""ALTabletService, ALAudioPlayer, ALAudioRecorder."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from naoqi_simulator.sounds import RobotDisk
from naoqi_simulator.world import SimulatedWorld, SimulatorOptions
from woz_drivers.sound.wav import Wav, parse

from tests.drivers.naoqi.robot_callers import HandTime, RobotCallError, SimulatedRobotRig
from tests.fakes.naoqi import PATIENCE_S

BEEP = "/home/nao/sounds/beep.wav"
FLAGS = [1, 1, 1, 1]
PAGE = b'<html><body><img src="a.png"><video><source src="/missing.mp4"></video></body></html>'
SOUND = Wav("S16_LE", 8000, 1, bytes(32_000)).to_bytes()
FILES = {
    "/a.wav": ("audio/wav", SOUND),
    "/a.png": ("image/png", b"\x89PNG..."),
    "/page.html": ("text/html", PAGE),
    "/film.mp4": ("video/mp4", b"film"),
}


class Pages(BaseHTTPRequestHandler):
    #: While it is not set, everybody waits.
    answers = threading.Event()

    def do_GET(self) -> None:
        self.answers.wait(PATIENCE_S)
        kind, content = FILES.get(self.path, ("", b""))
        self.send_response(200 if kind else 404)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - as the base class
        pass


@pytest.fixture
def site() -> Iterator[str]:
    """An address below which there are FILES."""
    Pages.answers.set()
    server = ThreadingHTTPServer(("127.0.0.1", 0), Pages)
    thread = threading.Thread(target=server.serve_forever, args=(0.01,))
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    thread.join()
    server.server_close()


async def fetched(rig: SimulatedRobotRig, number: int) -> list[tuple[str, int]]:
    async def enough() -> bool:
        return len(await rig.robot.get("tablet.fetched")) >= number

    await rig.robot.until(enough)
    return [(one["url"], one["status"]) for one in await rig.robot.get("tablet.fetched")]


@pytest.mark.parametrize("method", ["showWebview", "showImage", "loadUrl", "preLoadImage"])
async def test_it_fetches_what_it_shows(rig: SimulatedRobotRig, site: str, method: str) -> None:
    assert await rig.call(f"ALTabletService.{method}", f"{site}/a.png") is True
    assert await fetched(rig, 1) == [(f"{site}/a.png", 200)]


async def test_of_a_page_it_fetches_what_is_in_it(rig: SimulatedRobotRig, site: str) -> None:
    finished = await rig.hear("ALTabletService", "onPageFinished")
    await rig.call("ALTabletService.showWebview", f"{site}/page.html")
    await finished(1)
    addresses = [("/page.html", 200), ("/a.png", 200), ("/missing.mp4", 404)]
    assert await fetched(rig, 3) == [(site + path, status) for path, status in addresses]
    assert "missing.mp4" in str(await rig.robot.get("notes"))


@pytest.mark.parametrize(
    ("address", "status"), [("/nothing.png", 404), ("http://127.0.0.1:9/x.png", 0), ("x.png", 0)]
)
async def test_a_wrong_address_is_seen(
    rig: SimulatedRobotRig, site: str, address: str, status: int
) -> None:
    url = site + address if address.startswith("/") else address
    failed = await rig.hear("ALTabletService", "onLoadPageError")
    await rig.call("ALTabletService.showWebview", url)
    ((code, words, of),) = await failed(1)
    assert (code, of) == (status, url)
    assert words
    tablet = await rig.robot.get("tablet")
    assert (tablet["status"], tablet["error"]) == (status, words)


async def test_hiding_brings_the_default_back(rig: SimulatedRobotRig, site: str) -> None:
    await rig.call("ALTabletService.showWebview", f"{site}/a.png")
    assert (await rig.robot.get("tablet"))["shows"] == "webview"
    await rig.call("ALTabletService.hideWebview")
    assert (await rig.robot.get("tablet"))["shows"] == "default"


async def test_a_video_ends_and_says_so(rig: SimulatedRobotRig, site: str) -> None:
    await rig.robot.set("tablet.video_seconds", 4)
    started = await rig.hear("ALTabletService", "videoStarted")
    finished = await rig.hear("ALTabletService", "videoFinished")
    await rig.call("ALTabletService.playVideo", f"{site}/film.mp4")
    await started(1)
    await rig.time.advance(3.9)
    assert (await rig.robot.get("tablet"))["shows"] == "video"
    assert await rig.call("ALTabletService.getVideoLength") == 4000
    await rig.time.advance(0.2)
    assert await finished(1) == [()]
    assert (await rig.robot.get("tablet"))["shows"] == "default"


async def test_a_stopped_video_does_not_finish(rig: SimulatedRobotRig, site: str) -> None:
    started = await rig.hear("ALTabletService", "videoStarted")
    await rig.call("ALTabletService.playVideo", f"{site}/film.mp4")
    await started(1)
    assert await rig.call("ALTabletService.stopVideo") is True
    assert await rig.robot.get("going") == []
    assert await rig.call("ALTabletService.stopVideo") is False


async def test_a_video_that_is_hidden_while_it_loads_never_starts(
    rig: SimulatedRobotRig, site: str
) -> None:
    started = await rig.hear("ALTabletService", "videoStarted")
    loaded = await rig.hear("ALTabletService", "onPageFinished")
    Pages.answers.clear()
    await rig.call("ALTabletService.playVideo", f"{site}/film.mp4")
    await rig.call("ALTabletService.hideWebview")
    Pages.answers.set()
    await loaded(1)
    await rig.call("ALSystem.robotName")
    assert await started(0) == []
    assert await rig.robot.get("going") == []


async def test_touches_reach_who_listens(rig: SimulatedRobotRig) -> None:
    ratio = await rig.hear("ALTabletService", "onTouchDownRatio")
    up = await rig.hear("ALTabletService", "onTouchUp")
    await rig.robot.touch(0.25, 0.5)
    ((x, y, _page),) = await ratio(1)
    assert (x, y) == (0.25, 0.5)
    assert await up(1) == [(320.0, 400.0)]


async def test_wifi_is_switched(rig: SimulatedRobotRig) -> None:
    await rig.call("ALTabletService.disableWifi")
    assert await rig.call("ALTabletService.getWifiStatus") == "DISCONNECTED"
    await rig.call("ALTabletService.enableWifi")
    assert await rig.call("ALTabletService.getWifiStatus") == "CONNECTED"


async def test_a_sound_lasts_its_length(rig: SimulatedRobotRig) -> None:
    number = await rig.call("ALAudioPlayer.loadFile", BEEP)
    length = await rig.call("ALAudioPlayer.getFileLength", number)
    task = await rig.begin("ALAudioPlayer.play", number, kind="sound")
    await rig.time.advance(length - 0.1)
    assert await rig.pending(task)
    await rig.time.advance(0.2)
    await rig.done(task)


async def test_sounds_are_stopped(rig: SimulatedRobotRig) -> None:
    number = await rig.call("ALAudioPlayer.loadFile", BEEP)
    task = await rig.begin("ALAudioPlayer.play", number, kind="sound")
    await rig.call("ALAudioPlayer.stopAll")
    await rig.done(task)


async def test_files_are_loaded_and_unloaded(rig: SimulatedRobotRig) -> None:
    numbers = [await rig.call("ALAudioPlayer.loadFile", BEEP) for _ in range(2)]
    assert await rig.call("ALAudioPlayer.getLoadedFilesIds") == [str(one) for one in numbers]
    await rig.call("ALAudioPlayer.setVolume", numbers[0], 0.5)
    loaded = await rig.robot.get("sounds.loaded")
    assert [(one["id"], one["volume"]) for one in loaded] == [(numbers[0], 0.5), (numbers[1], 1.0)]
    await rig.call("ALAudioPlayer.unloadAllFiles")
    assert await rig.call("ALAudioPlayer.getLoadedFilesIds") == []
    with pytest.raises(RobotCallError, match="no file"):
        await rig.call("ALAudioPlayer.play", numbers[0])


async def test_an_unknown_file_is_refused(rig: SimulatedRobotRig) -> None:
    with pytest.raises(RobotCallError, match=r"nothing\.wav"):
        await rig.call("ALAudioPlayer.loadFile", "/nothing.wav")


async def test_a_recording_is_a_real_file_and_can_be_played(
    rig: SimulatedRobotRig, tmp_path: Path
) -> None:
    path = "/home/nao/recordings/one.wav"
    record = "ALAudioRecorder.startMicrophonesRecording"
    await rig.call(record, path, "wav", 16_000, FLAGS)
    assert await rig.robot.get("recording") == path
    with pytest.raises(RobotCallError, match="already"):
        await rig.call(record, path, "wav", 16_000, FLAGS)
    await rig.time.advance(2.5)
    await rig.call("ALAudioRecorder.stopMicrophonesRecording")
    sound = parse((tmp_path / path.lstrip("/")).read_bytes())
    assert (sound.rate, sound.channels) == (16_000, 4)
    assert sound.seconds == pytest.approx(2.5)
    number = await rig.call("ALAudioPlayer.loadFile", path)
    assert await rig.call("ALAudioPlayer.getFileLength", number) == pytest.approx(2.5)


async def test_a_sound_at_an_address_is_fetched_and_lasts_its_length(
    rig: SimulatedRobotRig, site: str
) -> None:
    task = await rig.begin("ALAudioPlayer.playWebStream", f"{site}/a.wav", 0.5, 0.0, kind="sound")
    await rig.time.advance(1.9)
    assert await rig.pending(task)
    await rig.time.advance(0.2)
    await rig.done(task)
    with pytest.raises(RobotCallError, match="404"):
        await rig.call("ALAudioPlayer.playWebStream", f"{site}/none.wav", 0.5, 0.0)


def test_without_a_folder_of_its_own_it_leaves_this_machine_alone(tmp_path: Path) -> None:
    here = tmp_path / "here.wav"
    here.write_bytes(SOUND)
    disk = RobotDisk(SimulatedWorld(HandTime(), SimulatorOptions(visitors=False)))
    assert disk.seconds(str(here)) is None
    disk.write(str(tmp_path / "recorded.wav"), SOUND)
    assert disk.seconds(str(tmp_path / "recorded.wav")) == pytest.approx(2.0)
    assert [one.name for one in tmp_path.iterdir()] == ["here.wav"]


@pytest.mark.parametrize(
    ("args", "why"),
    [
        (("/x.wav", "wav", 22_050, FLAGS), "rate"),
        (("/x.wav", "mp3", 16_000, FLAGS), "type"),
        (("/x.wav", "wav", 16_000, [0, 0, 0, 0]), "channels"),
    ],
)
async def test_wrong_recordings_are_refused(
    rig: SimulatedRobotRig, args: tuple[object, ...], why: str
) -> None:
    with pytest.raises(RobotCallError, match=why):
        await rig.call("ALAudioRecorder.startMicrophonesRecording", *args)
    with pytest.raises(RobotCallError, match="not recording"):
        await rig.call("ALAudioRecorder.stopMicrophonesRecording")
