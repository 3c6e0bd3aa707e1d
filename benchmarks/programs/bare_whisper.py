"""The bare library: loads faster-whisper's model once, then prints milliseconds for each file.

`bare_whisper.py MODEL`, files on standard input; runs in an environment that has the library.
"""

from __future__ import annotations

import importlib
import sys
import time

package = importlib.import_module("faster_whisper")
model = package.WhisperModel(sys.argv[1], device="cpu", compute_type="int8", cpu_threads=1)
sys.stdout.write("ready\n")
sys.stdout.flush()
for line in sys.stdin:
    began = time.perf_counter()
    parts, _ = model.transcribe(
        line.strip(),
        beam_size=1,
        temperature=0.0,
        condition_on_previous_text=False,
        word_timestamps=True,
    )
    words = sum(len(part.words or ()) for part in parts)
    sys.stdout.write(f"{(time.perf_counter() - began) * 1000} {words}\n")
    sys.stdout.flush()
