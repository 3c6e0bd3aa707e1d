"""A transcriber or a voice that stays loaded, as a script that behaves well or badly.

`resident.py JOURNAL BEHAVIOUR...`: the n-th request, counted over all runs, gets the n-th
behaviour, the last one for ever. Each start, with a temporary file that it leaves, and each request
is a line of the file JOURNAL.

    ok          a transcript, or a WAV file for a request with a text
    die         ends without an answer
    hang        never answers
    twice       answers twice
    late        answers the request before, and then this one
    nonsense    prints what is no answer, and then answers
    babble      prints what is no answer, and nothing else
    wrong       answers with values of the wrong kind
    error       says why it has no answer
    endless     begins a line that never ends
    long        answers with a line of 900 kB
    language    says in which language it understood
    parts       tells the text so far before the text
    pause       a voice that is silent for 0.2 s at the end
    raw         a voice that writes raw sound
    silent      a voice that writes nothing
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
import time
import wave
from pathlib import Path

from tests.fakes.sound import RATE, journal_entries, square


def _tell(journal: Path, **what: object) -> None:
    with journal.open("a") as file:
        file.write(json.dumps(what) + "\n")


def _write(line: object, end: str = "\n") -> None:
    sys.stdout.write((line if isinstance(line, str) else json.dumps(line)) + end)
    sys.stdout.flush()


def _answer(journal: Path, request: dict[str, object], pause: float) -> dict[str, object]:
    if "text" not in request:
        size = Path(str(request["file"])).stat().st_size
        words = [{"word": "hello", "begin": 0.1, "end": 0.3, "confidence": 0.5}]
        return {"id": request["id"], "text": f"hello {size}", "words": words, "confidence": 0.75}
    with wave.open(str(request["wav"]), "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate(RATE)
        out.writeframesraw(square(0.1, 0.5) + bytes(2 * round(pause * RATE)))
    return {"id": request["id"], "words": [{"word": "hello", "begin": 0.0, "end": 0.05}]}


def _behave(behaviour: str, journal: Path, request: dict[str, object]) -> None:
    answer = _answer(journal, request, 0.2 if behaviour == "pause" else 0.0)
    number = int(str(request["id"]))
    match behaviour:
        case "die":
            sys.exit("out of memory")
        case "hang" | "babble":
            if behaviour == "babble":
                _write("Segment 1 of 1")
            while True:
                time.sleep(60)
        case "twice":
            _write(answer)
            _write({**answer, "text": "again"})
        case "late":
            _write({**answer, "id": number - 1, "text": "too late"})
            _write(answer)
        case "nonsense":
            wrong = ("Loading ...", "[1, 2]", "[" * 5000, '{"id": "x"}', '{"id": 1', "\xff\x00", "")
            _write("\n".join((*wrong, json.dumps(answer))))
        case "wrong":
            _write({"id": number, "text": 7, "words": "no"})
        case "error":
            _write({"id": number, "error": "no such voice"})
        case "endless":
            while True:
                _write("x" * 65536, end="")
        case "long":
            _write({**answer, "text": "x " * 450_000})
        case "language":
            _write({**answer, "language": "de"})
        case "parts":
            _write({"id": number, "text": "hel", "final": False})
            _write(answer)
        case _:
            _write({**answer, **_sound(behaviour, request)})


def _sound(behaviour: str, request: dict[str, object]) -> dict[str, object]:
    """What a voice writes instead of a WAV file, and what it adds to the answer."""
    if behaviour not in ("raw", "silent"):
        return {}
    raw = behaviour == "raw"
    Path(str(request["wav"])).write_bytes(square(0.1, 0.5) if raw else b"")
    return {"rate": RATE} if raw else {}


def main() -> None:
    journal, behaviours = Path(sys.argv[1]), sys.argv[2:]
    handle, temporary = tempfile.mkstemp()
    os.close(handle)
    _tell(journal, do="start", temporary=temporary)
    if "unloadable" in behaviours:
        sys.exit("no model")
    while "slow" in behaviours and not journal.with_name("loaded").exists():
        time.sleep(0.01)
    _write({"ready": True, "name": "fake"})
    for line in sys.stdin:
        request = json.loads(line)
        count = len(journal_entries(journal, "request"))
        _tell(journal, do="request", **request)
        usable = [one for one in behaviours if one != "slow"]
        _behave(usable[min(count, len(usable) - 1)], journal, request)


if __name__ == "__main__":
    main()
