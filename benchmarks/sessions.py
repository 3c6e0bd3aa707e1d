"""What the benchmarks share: programs on pseudo-terminals, journals with times, figures."""

from __future__ import annotations

import contextlib
import fcntl
import os
import pty
import select
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).parent
KEYS = "abcdefghijklmnopqrstuvwxyz"


def percentile(values: Sequence[float], share: float) -> float:
    """The value below which `share` (0..1) of `values` lie, by the nearest rank."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


class Terminal:
    """A program on a pseudo-terminal whose output is read and counted all the time."""

    def __init__(
        self, command: Sequence[str], *, rows: int = 50, columns: int = 160, **environ: str
    ) -> None:
        self.master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        environment = {**os.environ, "TERM": "xterm-256color", "LANG": "C.UTF-8", **environ}
        for name in ("TMUX", "NO_COLOR", "STY"):
            environment.pop(name, None)
        self.started_ns = time.monotonic_ns()
        self.process = subprocess.Popen(
            command, stdin=slave, stdout=slave, stderr=slave, env=environment,
            start_new_session=True,
        )  # fmt: skip
        os.close(slave)
        self.bytes = 0
        self.tail = b""
        self.first_ns: dict[bytes, int] = {}
        self._wanted: list[bytes] = []
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        while not self._over.is_set():
            if not select.select([self.master], [], [], 0.2)[0]:
                continue
            try:
                data = os.read(self.master, 1 << 16)
            except OSError:
                return
            if not data:
                return
            now = time.monotonic_ns()
            self.bytes += len(data)
            self.tail = (self.tail + data)[-20_000:]
            self._answer(data)
            for wanted in self._wanted:
                if wanted in self.tail:
                    self.first_ns.setdefault(wanted, now)

    def _answer(self, data: bytes) -> None:
        """Answer what a real terminal answers: where the cursor is, what it is."""
        if b"\x1b[?6n" in data:
            os.write(self.master, b"\x1b[?1;1R")
        elif b"\x1b[6n" in data:
            os.write(self.master, b"\x1b[1;1R")
        if b"\x1b[c" in data:
            os.write(self.master, b"\x1b[?62;22c")

    def wait_for(self, text: bytes, seconds: float = 30.0) -> float:
        """Seconds from the start until `text` came; fails loudly."""
        self._wanted.append(text)
        until = time.monotonic() + seconds
        while text not in self.first_ns:
            if text in self.tail:
                self.first_ns.setdefault(text, time.monotonic_ns())
            if time.monotonic() > until:
                raise TimeoutError(f"{text!r} never came; last output: {self.tail[-2000:]!r}")
            time.sleep(0.005)
        return (self.first_ns[text] - self.started_ns) / 1e9

    def press(self, data: bytes) -> int:
        """Send bytes; the moment just before, in nanoseconds."""
        now = time.monotonic_ns()
        os.write(self.master, data)
        return now

    def close(self) -> None:
        """End it, whatever it does."""
        self._over.set()
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        with contextlib.suppress(OSError):
            os.close(self.master)


@dataclass
class Journal:
    """Lines of `<nanoseconds> <what>` that another process appends."""

    path: Path
    _offset: int = 0
    lines: list[tuple[int, str]] = field(default_factory=list)

    def count(self) -> int:
        """How many lines there are now."""
        if self.path.exists():
            data = self.path.read_bytes()
            end = data.rfind(b"\n") + 1
            for line in data[self._offset : end].splitlines():
                stamp, _, what = line.decode().partition(" ")
                self.lines.append((int(stamp), what))
            self._offset = end
        return len(self.lines)

    def wait(self, count: int, seconds: float = 10.0) -> bool:
        """Whether there are `count` lines within `seconds`."""
        until = time.monotonic() + seconds
        while self.count() < count:
            if time.monotonic() > until:
                return False
            time.sleep(0.001)
        return True


@dataclass
class Bench:
    """A folder with an experiment on the probe driver."""

    folder: Path
    load: bool = False

    @property
    def journal(self) -> Journal:
        return Journal(self.folder / "journal")

    def experiment(self) -> Path:
        """26 actions on the letters."""
        actions = "\n".join(
            f'      - {{key: {key}, label: "Action {key.upper()}", say: "{key}"}}' for key in KEYS
        )
        path = self.folder / "bench.yaml"
        path.write_text(
            "title: Bench\n"
            "robot:\n  name: bench\n  drivers:\n    probe:\n      type: probe\n"
            f"      journal: {self.folder / 'journal'}\n"
            f"      load: {str(self.load).lower()}\n"
            f"panels:\n  - title: Letters\n    actions:\n{actions}\n"
        )
        return path

    def environ(self) -> dict[str, str]:
        """Finds the probe driver and keeps sockets out of the way."""
        return {
            "PYTHONPATH": str(HERE / "probe"),
            "WOZ_SOCKET": str(self.folder / "s"),
        }

    def run_command(self) -> list[str]:
        """`woz run` on it."""
        return [
            sys.executable, "-m", "woz_tui", "run", str(self.experiment()),
            "--participant", "P01", "--recordings", str(self.folder / "recordings"),
        ]  # fmt: skip


@contextlib.contextmanager
def bench(load: bool = False) -> Iterator[Bench]:
    """A `Bench` whose folder and robot process are gone afterwards."""
    with tempfile.TemporaryDirectory(prefix="woz-bench-") as name:
        made = Bench(Path(name), load)
        try:
            yield made
        finally:
            subprocess.run(["pkill", "-9", "-f", f"woz_tui host {name}"], check=False)
