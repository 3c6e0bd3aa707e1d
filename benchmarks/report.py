"""What a report of many sessions costs, and its page and exports, beside reading lines as JSON:
seconds, memory, and processor time as a ratio to `woz report`.

    python benchmarks/report.py [--sessions 100] [--short] [--quick]

Sessions of 20 to 60 minutes are written: requests, commands and their ends, engagement, speech,
marks and notes, and a file of samples beside each, which only a page opens. `--short`: copies of
`recordings/sample.jsonl` instead, a minute with four sensors. Each way runs in a process of its
own, in turns, so that all meet the same machine and the highest memory is its own. The floor is
`json.loads` on every line of actions, and nothing done with it.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from benchmarks.figures import machine, percentile, table, verdict
from woz_tui.config.engagement_words import STATES
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

#: Seconds that a report of a hundred sessions may take.
GOAL_S = 5.0
#: Megabytes that every way may take, however many sessions there are; of the main page, and how
#: many times the processor time of `woz report` a way may take.
GOAL_MB, GOAL_PAGE_MB = 64, 5.0
GOAL_RATIOS = {"woz report --html": 3.5, "woz report again": 0.6}
SECOND = 1_000_000
TURNS = 5
HERE = Path(__file__).resolve()
CONDITIONS = ("cold", "warm")


@dataclass(frozen=True)
class Run:
    """One process: seconds from its start to its end, of the processor, highest memory in MB."""

    seconds: float
    cpu: float
    megabytes: float


def write_sessions(folder: Path, count: int) -> int:
    """Sessions of two for each participant; how many lines of actions they have together."""
    total = 0
    for number in range(count):
        chance = random.Random(number)
        who, condition = f"P{number // 2 + 1:03d}", CONDITIONS[number % 2]
        stem = f"2026-03-{number % 28 + 1:02d}T{number % 24:02d}-00-00_{who}_S{number + 1:03d}"
        lines = list(_session(chance, who, condition, f"S{number + 1:03d}", stem[:19]))
        stamped = [
            msgspec.structs.replace(message, seq=seq, ts="2026-03-01T10:00:00.000000Z")
            for seq, message in enumerate(sorted(lines, key=lambda message: message.t))
        ]
        (folder / f"{stem}.jsonl").write_bytes(b"".join(map(codec.encode, stamped)))
        sample = m.Reading(seq=len(lines), t=1, sensor="distance", value=1.5, unit="m")
        (folder / f"{stem}.samples.jsonl").write_bytes(codec.encode(sample) * 1000)
        total += len(lines)
    return total


def write_copies(folder: Path, count: int) -> int:
    """The same of copies of the sample."""
    sample = HERE.parents[1] / "recordings" / "sample.jsonl"
    first, _, rest = sample.read_bytes().partition(b"\n")
    begin = codec.decode_message(first)
    assert isinstance(begin, m.SessionStart)
    samples = sample.with_suffix(".samples.jsonl").read_bytes()
    for number in range(count):
        who, session = f"P{number + 1:03d}", f"S{number + 1:03d}"
        stem = f"2026-03-01T10-00-00_{who}_{session}"
        condition = CONDITIONS[number % 2]
        own = msgspec.structs.replace(begin, participant=who, session=session, condition=condition)
        (folder / f"{stem}.jsonl").write_bytes(codec.encode(own) + rest)
        (folder / f"{stem}.samples.jsonl").write_bytes(samples)
    return count * (rest.count(b"\n") + 1)


def _session(
    chance: random.Random, who: str, condition: str, session: str, wall: str
) -> Iterator[m.Message]:
    yield m.SessionStart(
        t=0, session=session, participant=who, condition=condition, wizard="W1",
        software={"name": "woz-tui", "version": "0"}, experiment="bench.yaml",
        experiment_sha256="00", seed=1, clock={"wall_at_t0": wall},
    )  # fmt: skip
    yield m.EngagementAdopted(t=0, settings={"start": "run"})
    end = chance.randint(20, 60) * 60 * SECOND
    yield from _acts(chance, end)
    yield from _visitor(chance, end)
    for t in range(0, end, 10 * SECOND):
        yield m.Checkpoint(t=t, sha256="0" * 64, lines=t // SECOND)
    for t in range(0, end, 30 * SECOND):
        yield m.ClockTie(t=t, wall="2026-03-01T10:00:00.000000Z")
    yield m.SessionEnd(t=end, reason="ended")


def _acts(chance: random.Random, end: int) -> Iterator[m.Message]:
    t, number = 0, 0
    while (t := t + round(chance.expovariate(1 / 6) * SECOND) + SECOND) < end:
        number += 1
        run, command = f"a{number:05d}", f"c{number:05d}"
        action = f"Action {chance.randint(1, 30)}"
        yield m.ActionRequested(t=t, run=run, action=action, panel="Speech", source="key", key="a")
        yield m.Command(
            t=t, command=command, run=run, action=action, panel="Speech", verb="say",
            args={"text": "Hello, and welcome to the exhibition."}, driver="voice", source="key",
        )  # fmt: skip
        latency, duration = chance.randint(200, 9000), chance.randint(300_000, 3_000_000)
        yield m.Dispatched(t=t + latency, command=command, driver="voice", latency_us=latency)
        done = t + latency + duration
        yield m.Done(
            t=done, command=command, driver="voice", latency_us=latency, duration_us=duration,
            sent={"text": "Hello, and welcome to the exhibition."},
        )  # fmt: skip
        yield m.ActionDone(t=done, run=run, action=action)
        if chance.random() < 0.02:
            yield m.Mistake(t=done, run=run, action=action)


def _visitor(chance: random.Random, end: int) -> Iterator[m.Message]:
    t, segment, state = 0, 0, STATES[0]
    while (t := t + chance.randint(3, 20) * SECOND) < end:
        now = chance.choice([each for each in STATES if each != state])
        yield m.EngagementChanged(t=t, was=state, now=now, outcome="o", why="", verdicts={})
        state = now
        if chance.random() < 0.5:
            segment += 1
            began, ended = t - 2 * SECOND, t
            yield m.SpeechStarted(t=began, driver="mic", segment=segment, began=began)
            yield m.SpeechEnded(t=t, driver="mic", segment=segment, began=began, ended=ended)


# -- ways -----------------------------------------------------------------------------------------


def floor(folder: Path) -> None:
    """Every line of actions as JSON."""
    for path in folder.glob("*.jsonl"):
        if not path.name.endswith(".samples.jsonl"):
            with path.open("rb") as file:
                for line in file:
                    json.loads(line)


REPORT = "woz report"


def ways(folder: Path) -> dict[str, list[str]]:
    """By name, the program that is timed."""
    woz, out = [sys.executable, "-m", "woz_tui"], folder.parent / f"{folder.name}-out"
    report = [*woz, "report", str(folder)]
    export = [*woz, "export", str(folder)]
    return {
        "json.loads on every line": [sys.executable, str(HERE), "--floor", str(folder)],
        REPORT: [*report, "--anew"],
        "woz report again": report,
        "woz report --csv": [*report, "--anew", "--csv", str(out / "csv")],
        "woz report --json": [*report, "--anew", "--json"],
        "woz report --html": [*report, "--html", str(page_of(folder)), "--sessions", "beside"],
        "woz methods": [*woz, "methods", str(folder), "--anew"],
        "woz export --to csv": [*export, "--to", "csv", "--out", str(out / "export-csv")],
        "woz export --to bids": [*export, "--to", "bids", "--out", str(out / "export-bids")],
    }


def page_of(folder: Path) -> Path:
    """The page that is written of it."""
    return folder.parent / f"{folder.name}-out" / "page.html"


def timed(command: Sequence[str]) -> Run:
    """Run a program; its output is thrown away."""
    begun = time.perf_counter()
    process = subprocess.Popen(
        command, cwd=HERE.parents[1], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    )
    assert process.stderr is not None
    said = process.stderr.read()
    process.stderr.close()
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    took = time.perf_counter() - begun
    if process.returncode:
        raise RuntimeError(f"{' '.join(command)} failed: {said.decode()}")
    return Run(took, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024)


def measured(folder: Path, turns: int) -> dict[str, list[Run]]:
    """Each way so many times, in turns."""
    found: dict[str, list[Run]] = {name: [] for name in ways(folder)}
    for _ in range(turns):
        out = page_of(folder).parent
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir()
        for name, command in ways(folder).items():
            found[name].append(timed(command))
    return found


def _seconds(runs: Sequence[Run]) -> float:
    return percentile([run.seconds for run in runs], 0.5)


def _cpu(runs: Sequence[Run]) -> float:
    return percentile([run.cpu for run in runs], 0.5)


def _memory(runs: Sequence[Run]) -> float:
    return max(run.megabytes for run in runs)


def _verdict(way: str, runs: Sequence[Run], report: float) -> str:
    """What a way may take, and whether it does."""
    goals = [f"<= {GOAL_MB} MB {verdict(_memory(runs), GOAL_MB)}"]
    if way in GOAL_RATIOS:
        goals.append(f"<= {GOAL_RATIOS[way]:g} x {verdict(_cpu(runs) / report, GOAL_RATIOS[way])}")
    elif way in (REPORT, "woz report --csv", "woz methods"):
        goals.append(f"<= {GOAL_S:g} s {verdict(_seconds(runs), GOAL_S)}")
    return "floor" if way.startswith("json") else ", ".join(goals)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sessions", type=int, default=100, help="how many are reported")
    parser.add_argument("--short", action="store_true", help="copies of the sample, of a minute")
    parser.add_argument("--quick", action="store_true", help="a few sessions: does it run at all?")
    parser.add_argument("--floor", type=Path, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.floor:
        floor(arguments.floor)
        return
    count = 6 if arguments.quick else arguments.sessions
    turns = 1 if arguments.quick else TURNS
    write = write_copies if arguments.short else write_sessions
    with tempfile.TemporaryDirectory(prefix="woz-bench-") as name:
        os.environ["XDG_CACHE_HOME"] = str(Path(name) / "cache")
        few, many = Path(name) / "few", Path(name) / "many"
        for folder in (few, many):
            folder.mkdir()
        write(few, max(2, count // 10))
        lines = write(many, count)
        small, found = measured(few, 1), measured(many, turns)
        page_mb = page_of(many).stat().st_size / 1e6
    least, report = _seconds(found["json.loads on every line"]), _cpu(found[REPORT])
    rows = [
        [
            way,
            f"{_seconds(runs):.2f}",
            f"{_seconds(runs) / least:.1f} x",
            f"{_cpu(runs):.2f}",
            f"{_cpu(runs) / report:.1f} x",
            f"{_memory(runs):.0f}",
            f"{_memory(small[way]):.0f}",
            _verdict(way, runs, report),
        ]
        for way, runs in found.items()
    ]
    head = [
        *("a process from start to end", "seconds", "by floor", "CPU s", "by report", "MB"),
        *("MB of a tenth", "goals"),
    ]
    table(f"{count} sessions, {lines} lines of actions, median of {turns}", head, rows)
    page = f"{page_mb:.1f} MB, goal {GOAL_PAGE_MB:g}: {verdict(page_mb, GOAL_PAGE_MB)}"
    print(f"  main page {page}")
    print(machine())


if __name__ == "__main__":
    main()
