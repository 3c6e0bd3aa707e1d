"""`woz say TEXT [FILE]`: hear how a text sounds, without a session and without a log."""

from __future__ import annotations

import asyncio
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from woz_tui.bus.hub import Hub
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.shared_options import add_robot
from woz_tui.config.annotated_decoder import settings_from_texts
from woz_tui.config.loading import load, load_robot
from woz_tui.config.robots import is_robot_file
from woz_tui.drivers import plugins
from woz_tui.drivers.argument_check import ArgumentError, checked
from woz_tui.drivers.contract import Driver, DriverError, Scope, Verb
from woz_tui.drivers.lone_job import LOUDSPEAKER, SAY, LoneJob
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.session.driver_context import SessionDriverContext
from woz_tui.system.clock import RealClock

ERRORS = CommandErrors(ArgumentError, ValueError, who="woz say")
#: How long a robot may take to be there, in seconds.
_THERE_S = 20.0
#: What an utterance may change, as options: name -> type.
_CHANGES: Mapping[str, type] = {
    "voice": str,
    "language": str,
    "speed": int,
    "pitch": int,
    "volume": float,
}


@dataclass(frozen=True, slots=True)
class Speaker:
    """A driver that speaks."""

    name: str
    kind: type[Driver]
    settings: Any
    verb: Verb
    folder: Path


def add_speakers(parser: ArgumentParser) -> None:
    """Declare who speaks."""
    parser.add_argument(
        "experiment",
        type=Path,
        nargs="?",
        help="experiment or robot file (default: this machine's voice)",
    )
    add_robot(parser)
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="a setting of `type: speech`, without a file (repeatable)",
    )


def add(parser: ArgumentParser) -> None:
    parser.add_argument("text", help="what to say")
    add_speakers(parser)
    parser.add_argument("--on", default="", metavar="DRIVER", help="who says it (default: first)")
    for name, kind in _CHANGES.items():
        parser.add_argument(f"--{name}", type=kind, default=None, help=f"another {name}")


def run(arguments: Namespace) -> int:
    """Say it; 0 if it was heard."""
    found = {speaker.name: speaker for speaker in speakers(arguments, plugins.installed())}
    if not found:
        raise ValueError(f"no driver of {arguments.experiment} speaks")
    name = arguments.on or next(iter(found))
    if name not in found:
        raise ValueError(f"{name} does not speak; there are: {', '.join(found)}")
    changes = {name: getattr(arguments, name) for name in _CHANGES}
    wanted: dict[str, Json] = {name: one for name, one in changes.items() if one is not None}
    args = checked(found[name].verb, {"text": arguments.text, **wanted})
    return asyncio.run(_speak(found[name], args))


def speakers(arguments: Namespace, catalogue: Mapping[str, type[Driver]]) -> list[Speaker]:
    """Drivers that speak. Raises `ExperimentError`, or `ValueError` for options."""
    if arguments.experiment is None and not arguments.robot:
        kind = catalogue[LOUDSPEAKER]
        pairs = [one.partition("=") for one in arguments.set]
        settings = settings_from_texts(
            kind.Settings, {name: value for name, _, value in pairs}, Path.cwd()
        )
        verbs = kind.offer(settings).verbs
        return [
            Speaker(LOUDSPEAKER, kind, settings, verb, Path.cwd())
            for verb in verbs
            if verb.name == SAY
        ]
    if arguments.experiment is None:
        raise ValueError("--robot needs an experiment file: woz say TEXT FILE --robot NAME")
    if arguments.set:
        raise ValueError("--set is for this machine's voice; change the file instead")
    file: Path = arguments.experiment
    if is_robot_file(file) and arguments.robot:
        raise ValueError(f"{file} is a robot file, and --robot is for experiments")
    drivers = (
        load_robot(file, catalogue)
        if is_robot_file(file)
        else load(file, catalogue, robot=arguments.robot).drivers
    )
    return [
        Speaker(spec.name, catalogue[spec.type], spec.settings, verb, file.absolute().parent)
        for spec in drivers
        for verb in spec.offer.verbs
        if verb.name == SAY
    ]


async def _speak(speaker: Speaker, args: Mapping[str, Json]) -> int:
    """Open the driver, wait until it is there, and have it speak."""
    clock = RealClock()
    hub = Hub(clock, lambda message, line: None)
    moved = asyncio.Event()
    health: list[m.DriverHealth] = []

    def listen(message: m.DriverHealth) -> None:
        health.append(message)
        moved.set()

    hub.listen(listen, m.DriverHealth)
    context = SessionDriverContext(speaker.name, hub, clock, speaker.folder)
    driver = speaker.kind(speaker.name, speaker.settings, context)
    try:
        await driver.open()
        while not (health and isinstance(health[-1], m.DriverConnected)):
            moved.clear()
            async with asyncio.timeout(_THERE_S):
                await moved.wait()
        began_us = clock.now_us()
        sent = await driver.perform(LoneJob(speaker.verb.spoken(args)))
        parts = [f"{(clock.now_us() - began_us) / 1_000_000:.2f} s in all"]
        if isinstance(delay := sent.get("delay"), int | float):
            parts.append(f"{delay:.2f} s until the sound was ready")
        if isinstance(source := sent.get("source"), str):
            parts.append(f"from: {source}")
        print(", ".join(parts))
    except TimeoutError:
        last = health[-1] if health else None
        what = last.detail if last is not None else f"not there within {_THERE_S:g} s"
        return _failed(speaker, what, last.remedy if last is not None else "")
    except DriverError as error:
        return _failed(speaker, error.what, error.remedy)
    except asyncio.CancelledError:  # ctrl-c
        await driver.stop(Scope.ALL)
        raise
    finally:
        await driver.close()
    return 0


def _failed(speaker: Speaker, what: str, remedy: str) -> int:
    print(f"woz say: {speaker.name}: {what}", file=sys.stderr)
    if remedy:
        print(f"  {remedy}", file=sys.stderr)
    return 1
