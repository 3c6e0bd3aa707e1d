"""How soon a robot speaks and understands: programs for each sentence, and ones that stay loaded.

    python benchmarks/voices.py [--sentences 12] [--quick]

*Ready* is the time from a text to its sound, or from the end of a sound to its text. *First sound*
is the time from `say` to the start of the player, which writes down when it runs; its floor is the
start of the same player without us. What a busy machine adds to a time is not in the time that the
program has used a processor. Piper and faster-whisper are measured where `make peers` has
installed them (`.ci/peers --install piper`, `.ci/peers --install whisper`): as a program started
for each sentence, as the bare program or library that stays loaded (the floor), and through
`resident_voice` and `resident_transcriber`. All in turns, in the same run.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import psutil
from woz_drivers.microphone import whisper_transcriber
from woz_drivers.microphone.transcriber import Transcript
from woz_drivers.programs.resident_program import ResidentProgram
from woz_drivers.speech import piper_voice
from woz_drivers.speech.driver import Speech
from woz_drivers.speech.settings import SpeechSettings
from woz_drivers.speech.synthesis import SpeechSynthesis

from benchmarks.figures import Spread, machine, table, verdict
from woz_tui.bus.hub import Hub
from woz_tui.drivers.contract import DriverError
from woz_tui.protocol.messages import Json
from woz_tui.session.driver_context import SessionDriverContext
from woz_tui.system.clock import RealClock

ROOT = Path(__file__).parents[1]
PEERS = ROOT / ".venv" / "peers"
PIPER, WHISPER = PEERS / "piper", PEERS / "whisper"
VOICE = "en_US-joe-medium"
#: Two words make every sentence, and every beginning of one, new.
SENTENCE = "{} from the old museum are what I like best of all these things."
COMMA = "{} are in here, and what I like best of them all is blue."
TWO = "{} are in this room. What I like best of them is over there."
LONG = (
    "{} that stand on the left of this very large room are what I like best of all the things"
    " that are shown here today."
)
WORDS = (
    *("lanterns", "feathers", "bottles", "kettles", "blankets", "cabinets", "mirrors", "buttons"),
    *("carpets", "daggers", "engines", "flutes", "goblets", "helmets", "inkpots", "jackets"),
)
#: Milliseconds to the first sound, on a core of a server: of a prepared and of a typed sentence.
GOALS = {
    "prepared": 30.0,
    "typed": 300.0,
    "typed, with a comma": 300.0,
    "typed, two sentences": 300.0,
    "typed, 24 words": 300.0,
}
FIRST_PART = "piper: bare, its first part"
#: How many times the bare resident program a resident voice or transcriber may take.
OVER_BARE = 1.5


@dataclass
class _Say:
    """A job."""

    args: Mapping[str, Any]
    command: str = "c1"
    verb: str = "say"
    source: str = "key"
    expected: list[float] = field(default_factory=list)

    def expects(self, seconds: float) -> None:
        self.expected.append(seconds)

    def goes_on(self) -> Callable[[str], None]:
        return lambda why: None

    def mark(self, sort: str, text: str = "") -> None: ...

    def evidence(self, kind: str) -> None: ...


class Clocked:
    """Milliseconds by name."""

    def __init__(self) -> None:
        self.values: dict[str, list[float]] = {}

    async def time(self, name: str, work: Callable[[], Awaitable[object]]) -> None:
        began = time.perf_counter()
        await work()
        self.add(name, (time.perf_counter() - began) * 1000)

    def add(self, name: str, milliseconds: float) -> None:
        self.values.setdefault(name, []).append(milliseconds)

    def row(self, name: str, floor: str, goal: float | None = None) -> list[str]:
        spread, under = Spread.of(self.values[name]), Spread.of(self.values[floor])
        ratio = spread.p50 / under.p50
        judged = "" if goal is None else verdict(spread.p50, goal)
        return [
            name,
            f"{spread.p50:.1f}",
            f"{spread.worst:.1f}",
            "floor" if name == floor else f"{ratio:.2f}",
            judged if goal is not None or name == floor else "",
        ]


class BareLines:
    """A program that stays loaded, asked without us: a line in, the next line that fits out."""

    def __init__(self, words: list[str], fits: str, first: str = "") -> None:
        self._process = subprocess.Popen(
            words,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self._fits = re.compile(fits)
        if first:
            self._until(first)

    def ask(self, line: str) -> str:
        assert self._process.stdin is not None
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()
        return self._until(self._fits)

    def _until(self, fits: str | re.Pattern[str]) -> str:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            if re.search(fits, line):
                return line
        raise RuntimeError("the bare program ended")

    @property
    def processor_ms(self) -> float:
        """How long it has used a processor so far."""
        times = psutil.Process(self._process.pid).cpu_times()
        return (times.user + times.system) * 1000

    def end(self) -> None:
        self._process.kill()
        self._process.wait()


def player(folder: Path) -> tuple[str, ...]:
    """A player that writes down when it runs, in nanoseconds, and plays nothing."""
    folder.mkdir(exist_ok=True)
    script = folder / "player"
    script.write_text(f'#!/bin/sh\ndate +%s%N >>"{folder}/played"\n')
    script.chmod(0o700)
    (folder / "played").touch()
    return (str(script), "{wav}")


def starts(folder: Path) -> list[int]:
    """When it ran, each time."""
    return [*map(int, (folder / "played").read_text().split())]


@contextlib.asynccontextmanager
async def loudspeaker(folder: Path, **settings: Any) -> AsyncIterator[Speech]:
    clock = RealClock()
    context = SessionDriverContext("voice", Hub(clock, lambda message, line: None), clock, folder)
    made = SpeechSettings(play=player(folder), cache=str(folder / "cache"), **settings)
    driver = Speech("voice", made, context)
    await driver.open()
    try:
        yield driver
    finally:
        await driver.close()


def ran_for(words: list[str], text: str = "") -> float:
    """Milliseconds that a program takes."""
    began = time.perf_counter()
    subprocess.run(words, input=text, text=True, check=True, capture_output=True)
    return (time.perf_counter() - began) * 1000


def player_alone(folder: Path) -> float:
    """Milliseconds until the player runs."""
    began = time.time_ns()
    subprocess.run([str(folder / "player")], check=True)
    return (starts(folder)[-1] - began) / 1e6


async def first_sounds(
    clocked: Clocked, engine: str, folder: Path, count: int, settings: Mapping[str, Any]
) -> None:
    """From `say` to the player, prepared and typed, beside the player alone."""
    async with loudspeaker(folder, **settings) as driver:
        prepared: list[Mapping[str, Json]] = [
            {"text": SENTENCE.format(f"Old {word}")} for word in WORDS[:count]
        ]
        await driver.prepare_say(prepared)
        for number, args in enumerate(prepared):
            clocked.add("the player alone", player_alone(folder))
            word = WORDS[number]
            for name, said in (
                ("prepared", args),
                ("typed", {"text": SENTENCE.format(f"Great {word}")}),
                ("typed, with a comma", {"text": COMMA.format(f"Red {word}")}),
                ("typed, two sentences", {"text": TWO.format(f"Green {word}")}),
                ("typed, 24 words", {"text": LONG.format(f"Black {word}")}),
            ):
                began, before = time.time_ns(), len(starts(folder))
                with contextlib.suppress(DriverError):  # the player ends before a sound would
                    await driver.perform(_Say(said))
                clocked.add(f"{engine}: {name}", (starts(folder)[before] - began) / 1e6)


def piper_settings() -> dict[str, Any]:
    voices = ("--voices", str(PIPER / "voices"), "--model", VOICE)
    piper = ("--piper", str(PIPER / "bin" / "piper"))
    return {"resident_voice": (sys.executable, "-m", piper_voice.__name__, *piper, *voices)}


async def piper(clocked: Clocked, folder: Path, count: int) -> list[Path]:
    """Sentences by Piper, three ways; the sounds."""
    model = str(PIPER / "voices" / f"{VOICE}.onnx")
    command = [str(PIPER / "bin" / "piper"), "-m", model]
    bare = BareLines([*command, "-d", str(folder / "bare")], r"\.wav")
    bare.ask("Yes.")
    settings = SpeechSettings(cache=str(folder / "piper-cache"), **piper_settings())
    resident = SpeechSynthesis(settings, folder)
    await resident.utterance("Yes.")
    sounds = []
    for number in range(count):
        text = SENTENCE.format(f"New {WORDS[number]}")
        if number < max(2, count // 4):
            cold = [*command, "-f", str(folder / "cold.wav")]
            clocked.add("piper: started for each", ran_for(cold, text))
        for name, said in (
            ("piper: bare, loaded", text),
            (FIRST_PART, resident.parts(text, resident.choice({}))[0]),
        ):
            began, used = time.perf_counter(), bare.processor_ms
            bare.ask(said)
            clocked.add(name, (time.perf_counter() - began) * 1000)
            clocked.add(f"{name} (processor)", bare.processor_ms - used)
        began = time.perf_counter()
        made = await resident.utterance(text)
        clocked.add("piper: resident_voice", (time.perf_counter() - began) * 1000)
        sounds += [made.path] if made.path is not None else []
    bare.end()
    await resident.close()
    return sounds


async def whisper(clocked: Clocked, folder: Path, sounds: list[Path]) -> None:
    """The texts of sounds, three ways."""
    python, model = str(WHISPER / "bin" / "python"), str(WHISPER / "model")
    bare_words = [python, str(ROOT / "benchmarks" / "programs" / "bare_whisper.py"), model]
    bare = BareLines(bare_words, r"^[\d.]+ \d+", "ready")
    resident = ResidentProgram(
        (python, whisper_transcriber.__file__, "--model", model), folder, humble=False
    )
    bare.ask(str(sounds[0]))
    await resident.ask({"file": str(sounds[0])}, Transcript, 60.0)
    for number, sound in enumerate(sounds):
        if number < max(2, len(sounds) // 4):
            began = time.perf_counter()
            cold = BareLines(bare_words, r"^[\d.]+ \d+", "ready")
            cold.ask(str(sound))
            clocked.add("whisper: started for each", (time.perf_counter() - began) * 1000)
            cold.end()
        clocked.add("whisper: bare, loaded", float(bare.ask(str(sound)).split()[0]))
        began = time.perf_counter()
        await resident.ask({"file": str(sound)}, Transcript, 60.0)
        clocked.add("whisper: resident_transcriber", (time.perf_counter() - began) * 1000)
    bare.end()
    await resident.close()


async def measure(folder: Path, count: int, peers: bool) -> None:
    clocked, missing = Clocked(), []
    await first_sounds(clocked, "espeak-ng", folder / "espeak", count, {})
    sounds: list[Path] = []
    if peers and (PIPER / ".installed").exists():
        await first_sounds(clocked, "piper", folder / "piper", count, piper_settings())
        sounds = await piper(clocked, folder, count)
    else:
        missing.append("piper")
    if sounds and (WHISPER / ".installed").exists():
        await whisper(clocked, folder, sounds)
    else:
        missing.append("whisper")

    alone = "the player alone"
    table(
        "First sound after `say` (ms)",
        ["", "p50", "worst", "x floor", "goal"],
        [
            clocked.row(alone, alone),
            *(
                clocked.row(f"{engine}: {name}", alone, GOALS[name])
                for engine in ("espeak-ng", "piper")
                for name in GOALS
                if f"{engine}: {name}" in clocked.values
            ),
        ],
    )
    rows = []
    for engine, ours in (("piper", "resident_voice"), ("whisper", "resident_transcriber")):
        floor = f"{engine}: bare, loaded"
        if floor in clocked.values:
            rows += [clocked.row(f"{engine}: started for each", floor), clocked.row(floor, floor)]
            ratio = Spread.of(clocked.values[f"{engine}: {ours}"]).p50
            under = Spread.of(clocked.values[floor]).p50
            rows.append(clocked.row(f"{engine}: {ours}", floor))
            rows[-1][-1] = verdict(ratio / under, OVER_BARE)
            for name in (FIRST_PART, f"{floor} (processor)", f"{FIRST_PART} (processor)"):
                rows += [clocked.row(name, floor)] if engine == "piper" else []
    if rows:
        table("A sentence of 14 words is ready (ms)", ["", "p50", "worst", "x floor", "goal"], rows)
    for one in missing:
        print(f"\nwithout {one}: .ci/peers --install {one}")
    print(f"\n{machine()}")


def main() -> None:
    """Measure; print tables."""
    parser = argparse.ArgumentParser(description="How soon a robot speaks and understands.")
    parser.add_argument("--sentences", type=int, default=12, choices=range(3, len(WORDS) + 1))
    parser.add_argument("--quick", action="store_true", help="three sentences, espeak-ng alone")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="woz-bench-") as name:
        asyncio.run(
            measure(Path(name), 3 if options.quick else options.sentences, not options.quick)
        )


if __name__ == "__main__":
    main()
