"""What the benchmarks run: programs on pseudo-terminals, sessions, journals with times."""

from __future__ import annotations

import bisect
import contextlib
import fcntl
import json
import os
import random
import re
import select
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import psutil

HERE = Path(__file__).parent
ROOT = HERE.parent
PROGRAMS = HERE / "programs"
KEYS = "abcdefghijklmnopqrstuvwxyz"
#: Seconds that a started session is left alone before anything is measured.
SETTLE_S = 2.0
#: Seconds between two presses, drawn at random so that they fall into every phase of a painting.
GAPS_S = (0.02, 0.07)

# As on a wizard's machine: without it each start compiles a hundred files, which takes as long as
# everything else.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

#: What a plain terminal answers: where the cursor is, how it is, what it is.
_ANSWERS = {
    b"\x1b[6n": b"\x1b[1;1R",
    b"\x1b[?6n": b"\x1b[?1;1R",
    b"\x1b[5n": b"\x1b[0n",
    b"\x1b[c": b"\x1b[?62;22c",
}
_QUESTION = re.compile(rb"\x1b\[\??[56]?[nc]")
#: A question may be cut by the end of a read.
_TORN = 5


class Terminal:
    """A program on a pseudo-terminal whose output is read and counted all the time."""

    def __init__(
        self,
        command: Sequence[str],
        environ: Mapping[str, str] | None = None,
        *,
        rows: int = 50,
        columns: int = 160,
    ) -> None:
        self.master, slave = os.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        environment = {**os.environ, "TERM": "xterm-256color", "LANG": "C.UTF-8"}
        environment |= environ or {}
        for name in ("TMUX", "NO_COLOR", "STY", "LC_ALL", "COLORTERM"):
            environment.pop(name, None)
        self.started_ns = time.monotonic_ns()
        self.process = subprocess.Popen(
            command, stdin=slave, stdout=slave, stderr=slave, env=environment, cwd=ROOT,
            start_new_session=True,
        )  # fmt: skip
        os.close(slave)
        self.bytes = 0
        self.tail = b""
        self._asked = b""
        self._wanted: dict[bytes, int] = {}
        self._news = threading.Condition()
        self._over = False
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def __enter__(self) -> Terminal:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def _read(self) -> None:
        while not self._over:
            if not select.select([self.master], [], [], 0.2)[0]:
                continue
            try:
                data = os.read(self.master, 1 << 16)
            except OSError:
                return
            now = time.monotonic_ns()
            self._answer(data)
            with self._news:
                self.bytes += len(data)
                self.tail = (self.tail + data)[-20_000:]
                for wanted, since in self._wanted.items():
                    if not since and wanted in self.tail:
                        self._wanted[wanted] = now
                        self._news.notify_all()

    def _answer(self, data: bytes) -> None:
        """Answer what a real terminal answers."""
        asked = self._asked + data
        end = 0
        for found in _QUESTION.finditer(asked):
            end = found.end()
            if found[0] in _ANSWERS:
                os.write(self.master, _ANSWERS[found[0]])
        self._asked = asked[max(end, len(asked) - _TORN) :]

    def want(self, text: bytes) -> None:
        """Note when `text` comes; ask for it before it can."""
        with self._news:
            self._wanted.setdefault(text, time.monotonic_ns() if text in self.tail else 0)

    def wait_for(self, text: bytes, seconds: float = 30.0) -> float:
        """Seconds from the start until `text` came; fails with what came instead."""
        self.want(text)
        with self._news:
            if not self._news.wait_for(lambda: self._wanted[text] > 0, seconds):
                raise TimeoutError(f"{text!r} never came; last output: {self.tail[-2000:]!r}")
            return (self._wanted[text] - self.started_ns) / 1e9

    def press(self, data: bytes) -> int:
        """Send bytes; the moment just before, in nanoseconds."""
        now = time.monotonic_ns()
        os.write(self.master, data)
        return now

    def robot(self) -> psutil.Process:
        """The robot process that `woz run` has started."""
        return psutil.Process(self.process.pid).children()[0]

    def close(self) -> None:
        """End the program and whatever it has started."""
        started: list[psutil.Process] = []
        with contextlib.suppress(psutil.NoSuchProcess):
            started = psutil.Process(self.process.pid).children(recursive=True)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        for process in started:
            with contextlib.suppress(psutil.NoSuchProcess):
                process.kill()
        psutil.wait_procs(started, timeout=5.0)
        self._over = True
        self._thread.join()
        os.close(self.master)


@dataclass(frozen=True)
class Entry:
    """Something that another process noted: when (CLOCK_MONOTONIC, ns) and what."""

    ns: int
    what: str


def entries(path: Path) -> list[Entry]:
    """All whole lines `<nanoseconds> <what>` of a journal, oldest first."""
    data = path.read_bytes() if path.exists() else b""
    lines = data[: data.rfind(b"\n") + 1].decode().splitlines()
    return [Entry(int(line.split(" ")[0]), line.partition(" ")[2]) for line in lines]


def matched(presses: Sequence[Entry], noted: Sequence[Entry]) -> tuple[list[float], int]:
    """Milliseconds from each press to its note; and how many presses had none.

    A note belongs to a press if it says the same and comes before the next press of that kind.
    """
    took: list[float] = []
    for what in {press.what for press in presses}:
        begun = [press.ns for press in presses if press.what == what]
        times = [note.ns for note in noted if note.what == what]
        for begin, end in zip(begun, [*begun[1:], sys.maxsize], strict=True):
            at = bisect.bisect_left(times, begin)
            if at < len(times) and times[at] < end:
                took.append((times[at] - begin) / 1e6)
    return took, len(presses) - len(took)


@dataclass
class Bench:
    """A folder with an experiment on the probe driver."""

    folder: Path
    load: bool = False

    @property
    def journal(self) -> Path:
        """Where the probe notes its calls."""
        return self.folder / "journal"

    def experiment(self) -> Path:
        """26 actions on the letters."""
        actions = "\n".join(
            f'      - {{key: {key}, label: "Action {key.upper()}", say: "{key}"}}' for key in KEYS
        )
        return self.written(
            "  drivers:\n    probe:\n      type: probe\n"
            f"      journal: {self.journal}\n"
            f"      load: {str(self.load).lower()}\n",
            actions,
        )

    def written(self, drivers: str, actions: str) -> Path:
        """An experiment file of one panel."""
        path = self.folder / "bench.yaml"
        path.write_text(
            f"title: Bench\nrobot:\n  name: bench\n{drivers}"
            f"panels:\n  - title: Letters\n    actions:\n{actions}\n"
        )
        return path

    def environ(self) -> dict[str, str]:
        """Finds the probe driver and keeps sockets out of the way."""
        path = [str(HERE / "probe"), *filter(None, [os.environ.get("PYTHONPATH")])]
        return {"PYTHONPATH": os.pathsep.join(path), "WOZ_SOCKET": str(self.folder / "s")}

    def options(self) -> list[str]:
        """Of `woz run`, `woz host` and `woz demo`."""
        return ["--participant", "P01", "--recordings", str(self.folder / "recordings")]

    def run_command(self, experiment: Path | None = None) -> list[str]:
        """`woz run` on an experiment, by default on the probe's."""
        return woz("run", str(experiment or self.experiment()), *self.options())

    def host_command(self) -> list[str]:
        """`woz host`, which says in one line when it is ready."""
        return woz("host", str(self.experiment()), *self.options(), "--announce")


def woz(*arguments: str) -> list[str]:
    """The command `woz`."""
    return [sys.executable, "-m", "woz_tui", *arguments]


@contextlib.contextmanager
def bench(load: bool = False) -> Iterator[Bench]:
    """A `Bench` whose folder is gone afterwards."""
    with tempfile.TemporaryDirectory(prefix="woz-bench-", ignore_cleanup_errors=True) as name:
        yield Bench(Path(name), load)


@contextlib.contextmanager
def session(it: Bench, command: Sequence[str] = (), settle: float = SETTLE_S) -> Iterator[Terminal]:
    """`woz run` on the bench, settled and ready for keys."""
    with Terminal(command or it.run_command(), it.environ()) as console:
        console.wait_for(b"Action A")
        time.sleep(settle)
        yield console


@contextlib.contextmanager
def floor(it: Bench, through: int = 0) -> Iterator[tuple[Terminal, Path]]:
    """The least that a program on a terminal can do with a key: note it. With its journal.

    With `through=1` it is a second program that notes it, behind a Unix socket.
    """
    journal = it.folder / f"floor{through}"
    command = [sys.executable, str(PROGRAMS / "bare_reader.py"), str(journal)]
    with Terminal([*command, *(["--second"] if through else [])]) as program:
        program.wait_for(b"ready")
        yield program, journal


@contextlib.contextmanager
def host(it: Bench) -> Iterator[Path]:
    """A robot process without a console; gives its socket."""
    process = subprocess.Popen(
        it.host_command(), cwd=ROOT, env={**os.environ, **it.environ()},
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        assert process.stdout is not None
        yield Path(json.loads(process.stdout.readline())["socket"])
    finally:
        process.kill()
        process.wait()
        if process.stdout is not None:
            process.stdout.close()


class Gaps:
    """Waits of random length, the same ones in every run."""

    def __init__(self, seed: int = 1) -> None:
        self._random = random.Random(seed)

    def rest(self, least: float = GAPS_S[0], most: float = GAPS_S[1]) -> None:
        """Wait between `least` and `most` seconds."""
        time.sleep(self._random.uniform(least, most))
