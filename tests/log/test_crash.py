"""Real processes, really killed, on real limits of the operating system."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.log.recorder_rig import STEM, until
from woz_tui.log.log_reader import Damage, read

pytestmark = pytest.mark.safety

ROOT = Path(__file__).parents[2]
ROUNDS = 30


def test_kill_9_loses_no_line_that_was_acknowledged(tmp_path: Path) -> None:
    chance = random.Random(9)
    with subprocess.Popen(
        [sys.executable, "-m", "tests.log.writer", str(tmp_path)],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as process:
        assert process.stdin
        assert process.stdout
        for index in range(ROUNDS):
            stem = f"{STEM}x{index}"
            process.stdin.write(f"{stem}\n".encode())
            process.stdin.flush()
            child = int(process.stdout.readline().split()[1])
            for _ in range(chance.randrange(300)):
                process.stdout.readline()
            os.kill(child, signal.SIGKILL)
            told = list(iter(process.stdout.readline, b"dead\n"))
            last = int(told[-1]) if told else -1
            check(tmp_path / f"{stem}.jsonl", last)
        process.stdin.close()
        assert process.wait(20) == 0


def test_what_is_acknowledged_after_the_log_was_deleted_survives_kill_9(tmp_path: Path) -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "tests.log.writer", str(tmp_path)],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as process:
        assert process.stdin
        assert process.stdout
        process.stdin.write(f"{STEM}\n".encode())
        process.stdin.flush()
        child = int(process.stdout.readline().split()[1])
        for _ in range(300):
            process.stdout.readline()
        (tmp_path / f"{STEM}.jsonl").unlink()
        # What was acknowledged by now may still stand in the pipe: this line tells where it ends,
        # but for one action, which may have been written between it and the deletion.
        asked = json.loads((tmp_path / f"{STEM}.samples.jsonl").read_bytes().splitlines()[-1])
        second = tmp_path / "spill" / f"{STEM}.2.jsonl"
        until(second.exists, "the second folder")
        last = int(process.stdout.readline())
        while last < asked["seq"] + 20:
            last = int(process.stdout.readline())
        os.kill(child, signal.SIGKILL)
        process.stdin.close()
        told = [int(line) for line in process.stdout if line != b"dead\n"]
        last = max([last, *told])
    found = {line.seq for line in read(second, places=[tmp_path])}
    assert found >= set(range(asked["seq"] + 2, last + 1))


def check(path: Path, last: int) -> None:
    damage = Damage()
    numbers = [line.seq for line in read(path, damage, places=[])]
    assert numbers[: last + 1] == list(range(last + 1))
    assert numbers == list(range(len(numbers))), "whole up to where it was killed"
    assert damage.damaged == 0


def test_files_that_may_not_grow_any_further(tmp_path: Path) -> None:
    process = subprocess.run(
        [sys.executable, "-m", "tests.log.limited_writer", str(tmp_path), STEM, "120"],
        cwd=ROOT,
        timeout=100,
        check=False,
    )
    assert process.returncode == 0
    files = sorted(tmp_path.rglob("*.jsonl"))
    assert len({file.parent for file in files}) == 2
    damage = Damage()
    found = [line.fields["text"] for line in read(files[0], damage, places=[tmp_path / "spill"])]
    assert found == [f"note {number}" for number in range(120)]
    assert damage.skipped == 0
