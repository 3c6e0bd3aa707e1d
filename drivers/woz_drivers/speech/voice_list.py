"""Voices of the synthesisers of this machine: espeak-ng, flite, festival, Piper's models."""

from __future__ import annotations

import asyncio
import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from woz_drivers.programs import child_process
from woz_tui.drivers.contract import DriverError, VoiceFound

#: How long a program may take for its list, in seconds.
_LIST_S = 8.0


def piper_folders(folder: Path) -> tuple[Path, ...]:
    """Where Piper's models are looked for: an experiment's `folder`, and the user's data folder."""
    data = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return (folder, folder / "voices", Path(data) / "piper-voices")


def piper_models(folders: Sequence[Path]) -> Mapping[str, Path]:
    """Names of the models `NAME.onnx` (with `NAME.onnx.json`) in these folders, and their files."""
    found: dict[str, Path] = {}
    for folder in folders:
        for path in sorted(folder.glob("*.onnx")):
            if path.with_name(f"{path.name}.json").is_file():
                found.setdefault(path.stem, path.absolute())
    return found


async def voices(folder: Path) -> list[VoiceFound]:
    """All voices; what a program does not tell in time is left out."""
    found: list[VoiceFound] = []
    for program, words, read in (
        ("espeak-ng", ("espeak-ng", "--voices"), _espeak_voices),
        ("flite", ("flite", "-lv"), _flite_voices),
        ("festival", ("festival", "--batch", "(print (voice.list))"), _festival_voices),
    ):
        if shutil.which(program) is not None:
            found += [VoiceFound(program, *one) for one in read(await _output(words, folder))]
    models = piper_models(piper_folders(folder))
    return [
        *found,
        *(
            VoiceFound("piper", name, name.partition("-")[0], str(at))
            for name, at in models.items()
        ),
    ]


async def _output(words: Sequence[str], folder: Path) -> str:
    """What a program prints; nothing if it cannot be run."""
    collected = bytearray()
    try:
        child = await child_process.start(words, folder, on_output=collected.extend)
    except DriverError:
        return ""
    try:
        async with asyncio.timeout(_LIST_S):
            await child.wait()
            await child.output_ended()
    except TimeoutError:
        return ""
    finally:
        await child.end()
    return collected.decode("utf-8", "replace")


def _espeak_voices(output: str) -> Iterator[tuple[str, str, str]]:
    """`Pty Language Age/Gender VoiceName File ...` after a heading."""
    for line in output.splitlines()[1:]:
        words = line.split()
        if len(words) >= 4:
            yield words[1], words[1], words[3].replace("_", " ")


def _flite_voices(output: str) -> Iterator[tuple[str, str, str]]:
    """`Voices available: kal awb_time ...`."""
    for name in output.partition(":")[2].split():
        yield name, "en", ""


def _festival_voices(output: str) -> Iterator[tuple[str, str, str]]:
    """`(kal_diphone rab_diphone)`."""
    for name in output.strip().strip("()").split():
        yield name, "", ""
