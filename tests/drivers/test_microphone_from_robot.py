"""`from:` the microphone of another driver of the same robot, without a program."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from woz_drivers.microphone.driver import Microphone
from woz_drivers.microphone.robot_ears import at_rate
from woz_drivers.microphone.settings import MicrophoneSettings
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.microphones import microphone_opener
from tests.drivers.published_messages import PublishedMessages, until
from tests.fakes.sound import square
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Health, HealthStatement, OtherDriver, Probe
from woz_tui.drivers.feeds import HEALTH
from woz_tui.drivers.plugins import installed
from woz_tui.drivers.sound_feeds import LISTENED, SOUND, SoundListened, SoundWindow
from woz_tui.protocol.messages import DriverConnected, DriverLost, SpeechEnded, SpeechStarted
from woz_tui.system.clock import ManualClock

EAR: dict[str, Any] = {"threshold": 0.1, "hang_over": 0.1, "pre_roll": 0.06}
RATE = 16_000


class PepperEars:
    """What the driver `pepper` has for a microphone that takes its sound."""

    def __init__(self, clock: ManualClock, published: PublishedMessages, rate: int = RATE) -> None:
        self.clock, self.published = clock, published
        self._window = SoundWindow(published.context.feed(SOUND, of="pepper"), rate)

    @property
    def wish(self) -> SoundListened | None:
        """For how long it is asked for sound."""
        value = self.published.context.feed(LISTENED, of="pepper").latest().value
        return value if isinstance(value, SoundListened) else None

    async def send(self, pcm: bytes) -> None:
        """Some sound, as it comes from the robot; returns when it was taken."""
        self.clock.advance(len(pcm) / 2 / self._window.rate)
        before = len(self.published.values("loudness"))
        self._window.add(pcm, self.clock.now_us())
        await self.published.until(lambda: len(self.published.values("loudness")) > before)

    def is_(self, health: Health, detail: str, remedy: str = "") -> None:
        statement = HealthStatement(health, detail, remedy)
        self.published.context.feed(HEALTH, of="pepper").put(statement)


Hear = Callable[..., Awaitable[PepperEars]]


@pytest.fixture
async def hear(tmp_path: Path) -> AsyncIterator[Hear]:
    clock = ManualClock()
    async with microphone_opener(tmp_path) as some:

        async def opened(rate: int = RATE, **settings: Any) -> PepperEars:
            _, published = await some.open(clock, "ears", from_="pepper", **{**EAR, **settings})
            ears = PepperEars(clock, published, rate)
            await until(lambda: ears.wish is not None)
            return ears

        yield opened


async def test_speech_is_found_in_the_robots_sound(hear: Hear) -> None:
    ears = await hear()
    assert ears.wish is not None
    assert ears.wish.until_us > ears.clock.now_us() + 2_000_000
    for level in (0.01, 0.5, 0.5, 0.01, 0.01):
        await ears.send(square(0.1, level))
    ended = await ears.published.first(SpeechEnded)
    assert (await ears.published.first(DriverConnected)).detail == (
        "pepper, 16000 Hz, S16_LE, 1 channel"
    )
    assert ended.ended - ended.began == pytest.approx(360_000, abs=40_000)


async def test_somebody_who_listens_longer_is_not_cut_short(hear: Hear) -> None:
    ears = await hear()
    longer = SoundListened(ears.clock.now_us() + 60_000_000)
    ears.published.context.feed(LISTENED, of="pepper").put(longer)
    await ears.send(square(0.1, 0.01))
    assert ears.wish == longer


async def test_it_is_lost_and_comes_back_with_the_robot(hear: Hear) -> None:
    ears = await hear()
    await ears.send(square(0.2, 0.5))
    await ears.published.first(SpeechStarted)
    ears.is_(Health.LOST, "no answer for 3 s", "look at its lights")
    lost = await ears.published.first(DriverLost)
    assert (lost.detail, lost.remedy) == ("pepper: no answer for 3 s", "look at its lights")
    ended = await ears.published.first(SpeechEnded)
    assert "no answer for 3 s" in ended.detail
    ears.is_(Health.CONNECTED, "it is back")
    await ears.send(square(0.2, 0.01))
    await ears.published.first(DriverConnected, after=1)


async def test_a_robot_that_sends_nothing_is_told_of(hear: Hear) -> None:
    ears = await hear()
    await ears.send(square(0.1, 0.01))
    ears.clock.advance(1.5)
    await ears.published.state("loudness", "stale")
    ears.clock.advance(5.0)
    lost = await ears.published.first(DriverLost)
    assert lost.detail == "pepper sends no sound"
    assert "woz listen --on pepper" in lost.remedy


async def test_what_was_lost_on_the_way_is_silence(hear: Hear) -> None:
    """A stretch that the feed could not hold: what comes after it keeps its time."""
    ears = await hear()
    await ears.send(square(0.2, 0.5))
    window = SoundWindow(ears.published.context.feed(SOUND, of="pepper"), RATE)
    window.add(bytes(2 * RATE), 0)  # a second that nobody took: more than a feed holds
    await ears.send(square(0.1, 0.01))
    ended = await ears.published.first(SpeechEnded)
    assert ended.detail == ""


async def test_another_rate_is_made_to_fit(hear: Hear) -> None:
    ears = await hear(rate=48_000)
    tone = np.sin(np.arange(4800) * 2 * np.pi * 200 / 48_000) * 16_000
    await ears.send(tone.astype("<i2").tobytes())
    await ears.published.first(SpeechStarted)
    assert len(at_rate(tone.astype("<i2").tobytes(), 48_000, RATE)) == 2 * 1600


def test_what_is_a_programs_is_told_by_its_name() -> None:
    settings = MicrophoneSettings(
        from_="pepper", command="x", device="hw:1", rate=8000, format="U8", channels=2
    )
    assert [name for name, _ in settings.problems()] == [
        *("command", "device", "rate", "format", "channels")
    ]


@pytest.mark.parametrize(
    ("ears", "place", "words"),
    [
        ("{type: microphone, from: pepper, rate: 48000}", "7:44", "leave rate out"),
        ("{type: microphone, from: peper}", "7:30", "no other driver called"),
        ("{type: microphone, from: reachy}", "7:30", "microphones are heard by a driver"),
    ],
)
def test_woz_check_says_where(tmp_path: Path, ears: str, place: str, words: str) -> None:
    path = tmp_path / "guide.yaml"
    path.write_text(f"""title: Guide
robot:
  drivers:
    pepper: {{type: pepper, robots: [simulated]}}
    reachy: {{type: reachy-mini}}
    # whose sound it is
    ears: {ears}
panels: [{{title: P, actions: [{{key: a, label: Hello, say: Hello, on: pepper}}]}}]
""")
    with pytest.raises(ExperimentError) as raised:
        load(path, installed())
    found = {f"{one.place.line}:{one.place.column}": one.message for one in raised.value.problems}
    assert words in found[place]


async def test_woz_doctor_listens_through_the_robot(tmp_path: Path) -> None:
    """Its own connection, for a second; the simulated one sends sound in real time."""
    catalogue = installed()
    settings = PepperSettings(robots=("simulated",))
    others = {"pepper": OtherDriver(catalogue["pepper"], settings)}
    probe = Probe("ears", MicrophoneSettings(from_="pepper"), tmp_path, others)
    (finding,) = await Microphone.examine(probe)
    assert finding.text.startswith("pepper: RMS 0.0")
    assert finding.level in ("ok", "warning"), "a visitor may speak"


async def test_woz_doctor_says_what_it_cannot_hear(tmp_path: Path) -> None:
    catalogue = installed()
    settings = MicrophoneSettings(from_="furhat")
    probe = Probe("ears", settings, tmp_path, {"furhat": OtherDriver(catalogue["furhat"], None)})
    (finding,) = await Microphone.examine(probe)
    assert (finding.level, finding.text) == (
        *("info", "the sound of furhat comes in a session alone"),
    )
    gone = PepperSettings(robots=("127.0.0.1:1",))
    others = {"furhat": OtherDriver(catalogue["pepper"], gone)}
    (finding,) = await Microphone.examine(Probe("ears", settings, tmp_path, others))
    assert finding.level == "error"
    assert "127.0.0.1:1" in finding.text


def test_it_offers_what_a_microphone_offers() -> None:
    offer = Microphone.offer(MicrophoneSettings(from_="pepper"))
    assert [verb.name for verb in offer.verbs] == ["listen_room"]
