"""Piper as a voice that stays loaded.

`python -m woz_drivers.speech.piper_voice --model en_US-joe-medium` speaks the lines that
docs/how-to/speech-programs.md describes. Piper itself (GPL-3) runs as a program of its own, one for
each voice and speed that is in use, and is never imported.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import re
import shutil
import subprocess
import sys
import tempfile
from collections import OrderedDict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from woz_drivers.speech.voice_list import piper_folders, piper_models
from woz_tui.system.extras import install_command

#: So many Piper programs stay loaded, each with one voice at one speed.
_MOST = 3
#: The voice's own speed, in words a minute as the setting `speed` has it.
_USUAL_SPEED = 160


class PiperProgram:
    """One Piper with one model at one speed; it writes each line that it reads into a file."""

    def __init__(self, command: Sequence[str], model: Path, speed: int, folder: Path) -> None:
        self._folder = folder
        scale = f"{_USUAL_SPEED / speed:.3f}"
        words = (*command, "-m", str(model), "--length-scale", scale, "--output-dir", str(folder))
        self._last = ""
        self._written = re.compile(re.escape(str(folder)) + r"/\S+\.wav")
        self._process = subprocess.Popen(
            words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )

    def speak(self, text: str) -> Path:
        """The file with the sound of `text`. Raises `OSError` with what Piper said at last."""
        process = self._process
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(" ".join(text.split()).encode() + b"\n")
            process.stdin.flush()
        except BrokenPipeError:
            pass  # it has ended; its last words tell why
        for line in process.stdout:
            written = line.decode("utf-8", "replace").strip()
            self._last = written or self._last
            if found := self._written.search(written):
                return Path(found[0])
        raise OSError(f"piper ended: {self._last or process.wait()}")

    def end(self) -> None:
        """End it."""
        self._process.kill()
        self._process.wait()


class PiperVoices:
    """Finds models and keeps Piper programs loaded."""

    def __init__(self, command: Sequence[str], default: str, folders: Sequence[Path]) -> None:
        self._command = command
        self._default = default
        self._folders = folders
        self._scratch = tempfile.TemporaryDirectory(prefix="woz-piper-")
        self._running: OrderedDict[tuple[Path, int], PiperProgram] = OrderedDict()

    def speak(self, request: dict[str, Any]) -> None:
        """Write the sound of a request to its file. Raises `OSError` or `ValueError`."""
        voice, language = str(request.get("voice", "")), str(request.get("language", ""))
        model = self.model(voice, language)
        key = (model, int(request.get("speed", _USUAL_SPEED)))
        program = self._running.pop(key, None)
        if program is None:
            folder = Path(tempfile.mkdtemp(dir=self._scratch.name))
            program = PiperProgram(self._command, *key, folder)
        try:
            made = program.speak(str(request["text"]))
        except BaseException:
            program.end()
            raise
        self._running[key] = program
        while len(self._running) > _MOST:
            self._running.popitem(last=False)[1].end()
        shutil.move(made, request["wav"])

    def model(self, voice: str, language: str) -> Path:
        """The model of that name, else the first of that language, else the usual one. Raises
        `ValueError` if there is none.
        """
        wanted = language.replace("-", "_").lower()
        usual = Path(self._default).stem.lower().startswith(wanted)
        name = voice or (self._default if usual else "")
        if name.endswith(".onnx") and Path(name).is_file():
            return Path(name)
        models = piper_models(self._folders)
        if name in models:
            return models[name]
        fitting = [path for one, path in models.items() if one.lower().startswith(wanted)]
        if fitting and not name:
            return fitting[0]
        there = ", ".join(models) or "none"
        raise ValueError(f"there is no voice {name or language!r}; there are: {there}")


def piper_command() -> tuple[str, ...]:
    """How Piper is started: the program, or the package beside us; () if there is none."""
    if importlib.util.find_spec("piper") is not None:
        return (sys.executable, "-m", "piper")
    found = shutil.which("piper")
    return (found,) if found else ()


def main() -> None:
    """Load the usual voice, then answer line by line."""
    options = _parser().parse_args()
    command = tuple(options.piper.split()) if options.piper else piper_command()
    if not command:
        sys.exit(f"piper is not installed: {install_command('piper')}, or give --piper PROGRAM")
    voices = PiperVoices(command, options.model, (*options.voices, *piper_folders(Path())))
    with tempfile.TemporaryDirectory(prefix="woz-piper-") as folder:
        try:
            voices.speak({"text": "Yes.", "wav": f"{folder}/first.wav"})
        except (OSError, ValueError) as error:
            sys.exit(str(error))
    _write({"ready": True, "name": f"piper {Path(options.model).stem}"})
    for line in sys.stdin:
        request = json.loads(line)
        try:
            voices.speak(request)
            _write({"id": request["id"]})
        except (OSError, ValueError) as error:
            _write({"id": request["id"], "error": str(error)})


def _write(answer: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description="Piper as a voice that stays loaded.")
    parser.add_argument("--model", default="", help="usual voice: a file NAME.onnx, or its name")
    parser.add_argument(
        "--voices", type=Path, action="append", default=[], help="folder with models (repeatable)"
    )
    parser.add_argument("--piper", default="", help="the program (default: the installed one)")
    return parser


if __name__ == "__main__":
    main()
