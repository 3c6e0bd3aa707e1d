"""faster-whisper as a transcriber that stays loaded (extra `whisper`).

`python -m woz_drivers.microphone.whisper_transcriber --model tiny.en` speaks the lines that
docs/how-to/speech-programs.md describes. The model is a folder, or a name of faster-whisper's list,
which is fetched from its hub when it is used for the first time.
"""

from __future__ import annotations

import argparse
import importlib
import json
import math
import os
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

PACKAGE = "faster_whisper"
#: What it raises of its hub, its run time and its files.
_ERRORS = (OSError, RuntimeError, ValueError)


def main() -> None:
    """Load the model, then answer line by line."""
    options = _parser().parse_args()
    answers = _own_output()
    try:
        # Imported here: it is an extra.
        package = importlib.import_module(PACKAGE)
    except ImportError:
        # Any Python may run this program: it needs nothing of woz-tui.
        pip = f"{shlex.quote(sys.executable)} -m pip install faster-whisper"
        sys.exit(f"faster-whisper is not installed: {pip}")
    try:
        model = package.WhisperModel(
            options.model, device="cpu", compute_type="int8", cpu_threads=options.threads
        )
    except _ERRORS as error:
        sys.exit(f"the model {options.model} cannot be loaded: {error}")
    answers.write({"ready": True, "name": f"faster-whisper {Path(options.model).name}"})
    for line in sys.stdin:
        request = json.loads(line)
        try:
            for answer in transcripts(model, request, options.beam):
                answers.write({"id": request["id"], **answer})
        except _ERRORS as error:  # the next segment may be better
            answers.write({"id": request["id"], "error": f"{type(error).__name__}: {error}"})


def transcripts(model: Any, request: dict[str, Any], beam: int) -> Iterator[dict[str, Any]]:
    """The text so far after each part of it, then the whole with its words."""
    parts, about = model.transcribe(
        request["file"],
        language=request.get("language"),
        beam_size=beam,
        temperature=0.0,
        condition_on_previous_text=False,
        word_timestamps=True,
    )
    text, words, log_probabilities = "", [], []
    for part in parts:
        if text:
            yield {"text": text, "final": False}
        text = f"{text} {part.text.strip()}".strip()
        log_probabilities.append(part.avg_logprob)
        words += [
            {
                "word": word.word.strip(),
                "begin": round(float(word.start), 3),
                "end": round(float(word.end), 3),
                "confidence": round(float(word.probability), 3),
            }
            for word in part.words or ()
        ]
    mean = sum(log_probabilities) / len(log_probabilities) if log_probabilities else None
    confidence = None if mean is None else round(math.exp(min(0.0, mean)), 3)
    language = getattr(about, "language", None) or ""
    yield {"text": text, "words": words, "confidence": confidence, "language": language}


class _Answers:
    """Writes answers as lines."""

    def __init__(self, descriptor: int) -> None:
        self._file = os.fdopen(descriptor, "w", encoding="utf-8")

    def write(self, answer: dict[str, Any]) -> None:
        self._file.write(json.dumps(answer) + "\n")
        self._file.flush()


def _own_output() -> _Answers:
    """Standard output for answers alone: what libraries print goes to standard error."""
    descriptor = os.dup(1)
    os.dup2(2, 1)
    return _Answers(descriptor)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description="A transcriber that stays loaded.")
    parser.add_argument("--model", default="tiny.en", help="folder or name of the model")
    parser.add_argument("--threads", type=int, default=1, help="processor cores it may use")
    parser.add_argument("--beam", type=int, default=1, help="larger: slower, perhaps better")
    return parser


if __name__ == "__main__":
    main()
