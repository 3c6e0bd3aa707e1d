"""ALAudioDevice: how loud it is, and sound for clients."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.visitor import SimulatedPerson
from naoqi_simulator.world import SimulatedWorld

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Samples = NDArray[np.int16]

#: Samples a channel of one block, by rate: 85 ms, as the robot sends them.
BLOCKS = {16_000: 1365, 48_000: 4096}
ALL_CHANNELS = 0
#: What the loudspeakers play, in Hz, and the longest buffer.
OUTPUT_RATES = (16_000, 22_050, 44_100, 48_000)
MOST_FRAMES = 16_384


@dataclass(frozen=True, slots=True)
class _Wish:
    """What a client wants: Hz, and 0 for all four microphones or 1 to 4 for one of them."""

    rate: int = 48_000
    channels: int = ALL_CHANNELS


class AudioDevice(Service):
    """The microphones and the loudspeakers."""

    name = "ALAudioDevice"

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__()
        self._world = world
        self._measuring = False
        self._wishes: dict[str, _Wish] = {}
        self._sending: dict[str, asyncio.Task[None]] = {}
        self.volume = 70
        self._parameters = {"outputSampleRate": 48_000, "inputBufferSize": 16_384}
        #: The left channel of what clients had played, as it came; and how often it was flushed.
        self._played = bytearray()
        self._flushed = 0

    @offers("enableEnergyComputation()v")
    def enable_energy(self) -> None:
        """Measure from now on."""
        self._measuring = True

    @offers("disableEnergyComputation()v")
    def disable_energy(self) -> None:
        """Measure no more: every energy is 0."""
        self._measuring = False

    @offers("getFrontMicEnergy()f")
    def get_front(self) -> float:
        """0 to about 10000."""
        if not self._measuring:
            return 0.0
        return energy(self._world.person(), self._world.time.now())

    @offers("getRearMicEnergy()f")
    def get_rear(self) -> float:
        """Half of what comes from the front."""
        return self.get_front() / 2

    @offers("getLeftMicEnergy()f")
    def get_left(self) -> float:
        """As the front."""
        return self.get_front()

    @offers("getRightMicEnergy()f")
    def get_right(self) -> float:
        """As the front."""
        return self.get_front()

    @offers("setOutputVolume(i)v")
    def set_output_volume(self, percent: int) -> None:
        """Of the loudspeakers."""
        if not 0 <= percent <= 100:
            raise CallRefusedError(
                "ALAudioDevice::setOutputVolume\n\tvolume must be within [0, 100]"
            )
        self.volume = percent

    @offers("getOutputVolume()i")
    def get_output_volume(self) -> int:
        """Of the loudspeakers, in percent."""
        return self.volume

    @offers("setParameter(si)v")
    def set_parameter(self, name: str, value: int) -> None:
        """Of the loudspeakers: their rate."""
        if name not in self._parameters or (
            name == "outputSampleRate" and value not in OUTPUT_RATES
        ):
            raise CallRefusedError(f"ALAudioDevice::setParameter\n\tinvalid parameter {name}")
        self._parameters[name] = value

    @offers("getParameter(s)i")
    def get_parameter(self, name: str) -> int:
        """-1 for one that there is not."""
        return self._parameters.get(name, -1)

    @offers("sendRemoteBufferToOutput(im)b")
    def send_remote_buffer(self, frames: int, sound: object) -> bool:
        """Play 16-bit stereo samples; False for what is none."""
        data = bytes(sound) if isinstance(sound, bytes | bytearray) else b""
        if not 0 < frames <= MOST_FRAMES or len(data) != 4 * frames:
            return False
        self._played += b"".join(data[at : at + 2] for at in range(0, len(data), 4))
        return True

    @offers("flushAudioOutputs()v")
    def flush(self) -> None:
        """Play nothing of what has not been heard yet."""
        self._flushed += 1

    def output(self) -> dict[str, object]:
        """What clients had played: samples in hexadecimal, rate, flushes."""
        rate = self._parameters["outputSampleRate"]
        return {"rate": rate, "played": self._played.hex(), "flushed": self._flushed}

    @offers("setClientPreferences(siii)v")
    def set_client_preferences(self, who: str, rate: int, channels: int, planes: int) -> None:
        """Before subscribing: 48000 with all channels (0), or 16000 with one (1 to 4).

        What NAOqi does not document is taken as it does: 48000 with one channel is sent as such.
        """
        if rate not in BLOCKS or not 0 <= channels <= 4 or planes not in (0, 1):
            raise CallRefusedError("ALAudioDevice::setClientPreferences\n\tinvalid preferences")
        self._wishes[who] = _Wish(rate, channels)

    @offers("subscribe(s)v")
    def subscribe(self, who: str) -> None:
        """Call `processRemote` of the client's service of this name with every block."""
        if who not in self._sending:
            self._sending[who] = asyncio.ensure_future(self._send(who))

    @offers("unsubscribe(s)v")
    def unsubscribe(self, who: str) -> None:
        task = self._sending.pop(who, None)
        if task is None:
            raise CallRefusedError(f"ALAudioDevice::unsubscribe\n\t{who} is not subscribed")
        task.cancel()

    def subscribers(self) -> list[str]:
        return list(self._sending)

    async def _send(self, who: str) -> None:
        wish = self._wishes.get(who, _Wish())
        samples = BLOCKS[wish.rate]
        channels = 4 if wish.channels == ALL_CHANNELS else 1
        begin = self._world.time.now()
        try:
            while True:
                due = begin + samples / wish.rate
                await self._world.time.sleep(due - self._world.time.now())
                echo = Echo(self._world.options.echo, self._world.spoke)
                sound = block(self._world.person(), begin, samples, wish.rate, channels, echo=echo)
                stamp = [int(begin), int(begin % 1 * 1e6)]
                if self._world.clients is None:
                    raise LookupError("nobody can be called from here")
                await self._world.clients.call(
                    *(who, "processRemote", channels, samples, stamp, sound.tobytes())
                )
                # A client that is too slow loses sound, as on the robot; time does not wait.
                begin = max(due, self._world.time.now() - samples / wish.rate)
        except (LookupError, ConnectionError, RuntimeError) as error:
            self._world.note(f"sound for {who}: {error}")
            self._sending.pop(who, None)


# -- what the microphones hear: noise, the visitor's voice when they talk, and the robot's own -----

#: getFrontMicEnergy counts like this in a quiet room, and with somebody talking a metre away.
QUIET, LOUD = 250.0, 4000.0
HIGHEST = 10_000.0
#: Hz of the simulated voice, and how often a second it gets louder and softer: syllables.
PITCH_HZ, SYLLABLES_HZ = 160.0, 4.0
#: The same of the robot's, its loudness at its own microphones with an echo of 1, and how long it
#: takes to get there, in seconds.
OWN_HZ, OWN_SYLLABLES_HZ, OWN_LOUD, OWN_LATE_S = 110.0, 5.0, 12_000.0, 0.1


def energy(person: SimulatedPerson | None, now: float) -> float:
    """Of the front microphone, 0 to about 10000."""
    # A room is never quite the same from one moment to the next.
    noise = QUIET * (1.0 + 0.3 * math.sin(now * 7.3) * math.sin(now * 1.1))
    if person is None or not person.talking:
        return noise
    syllable = 0.4 + 0.6 * abs(math.sin(math.pi * SYLLABLES_HZ * now))
    return min(HIGHEST, noise + LOUD * syllable / max(0.4, person.distance))


@dataclass(frozen=True, slots=True)
class Echo:
    """The share of its loudness at which the robot hears itself, and when it spoke, in seconds."""

    share: float = 0.0
    spoke: Sequence[tuple[float, float | None]] = ()


def block(
    person: SimulatedPerson | None,
    begin: float,
    samples: int,
    rate: int,
    channels: int,
    *,
    echo: Echo = Echo(),
) -> Samples:
    """Sound of `samples` a channel from a time on, interleaved; the same for the same time."""
    import numpy as np  # noqa: PLC0415 - most robots are not listened to, and start sooner

    times = begin + np.arange(samples) / rate
    noise = np.random.default_rng(round(begin * 1000)).normal(0.0, 60.0, samples)
    sound = noise
    if person is not None and person.talking:
        sound = sound + 6000.0 / max(0.4, person.distance) * _voice(times, PITCH_HZ, SYLLABLES_HZ)
    heard = times - OWN_LATE_S
    for began, ended in echo.spoke:
        if echo.share and heard[-1] >= began and (ended is None or heard[0] < ended):
            own = OWN_LOUD * echo.share * _voice(times, OWN_HZ, OWN_SYLLABLES_HZ)
            last = np.inf if ended is None else ended
            sound = sound + own * ((heard >= began) & (heard < last))
    mono = np.clip(sound, -32768, 32767).astype("<i2")
    return np.repeat(mono, channels)


def _voice(times: NDArray[np.float64], pitch_hz: float, syllables_hz: float) -> Any:
    import numpy as np  # noqa: PLC0415 - as above

    voice = sum(np.sin(2 * np.pi * pitch_hz * n * times) / n for n in range(1, 6))
    return voice * np.abs(np.sin(np.pi * syllables_hz * times)) / 2
