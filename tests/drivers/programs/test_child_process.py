"""Child processes: found, fed, killed with all that they started, never left behind."""

from __future__ import annotations

import asyncio
import contextlib
import sys
from pathlib import Path

import psutil
import pytest
from woz_drivers.programs import child_process, command_lines
from woz_drivers.programs.command_lines import ProgramMissingError

from tests.drivers.published_messages import PATIENCE_S, until
from tests.fakes.child_processes import offspring
from woz_tui.drivers.contract import DriverError


def alive(pid: int) -> bool:
    """Whether a process runs; a zombie does not."""
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


async def test_output_stdin_status_and_last_words(tmp_path: Path) -> None:
    output = bytearray()
    script = "cat; echo first >&2; printf 'progress\\rlast words \\n\\n' >&2; exit 3"
    running = await child_process.start(
        ("sh", "-c", script), tmp_path, on_output=output.extend, text="hällo\n"
    )
    assert await running.wait() == 3
    await running.end()
    assert output.decode() == "hällo\n"
    assert running.last_words == "last words"
    assert not running.running


@pytest.mark.parametrize(
    ("said", "words"),
    [
        (
            "arecord: set_params:1358: Sample format non available\\nAvailable formats:\\n- S24_3LE"
            "\\n- S32_LE\\n",
            "arecord: set_params:1358: Sample format non available; Available formats:"
            " S24_3LE, S32_LE",
        ),
        ("Traceback:\\n  File x\\nValueError: no\\n", "ValueError: no"),
        ("- one\\n- two", "one, two"),
        ("first\\n- one", "first one"),
        ("", ""),
    ],
)
async def test_last_words_that_are_a_list_are_told_whole(
    tmp_path: Path, said: str, words: str
) -> None:
    running = await child_process.start(("sh", "-c", f"printf -- '{said}' >&2"), tmp_path)
    await running.wait()
    await running.end()
    assert running.last_words == words


async def test_everything_it_started_dies_with_it(tmp_path: Path) -> None:
    said = bytearray()
    running = await child_process.start(
        ("sh", "-c", "sleep 1000 & echo $!; wait"), tmp_path, on_output=said.extend
    )
    await until(lambda: said.endswith(b"\n"))
    grandchild = int(said)
    assert alive(grandchild)
    await running.end()
    await until(lambda: not alive(grandchild))


async def test_waiting_ends_though_a_grandchild_keeps_the_pipes(tmp_path: Path) -> None:
    said = bytearray()
    running = await child_process.start(
        ("sh", "-c", "sleep 1000 & echo $!"), tmp_path, on_output=said.extend
    )
    assert await running.wait() == 0
    await running.end()
    await until(lambda: not alive(int(said)))


@pytest.mark.parametrize("command", ["exec sleep 1000", "sleep 1000; true", "sleep 1000 | cat"])
async def test_nothing_outlives_a_killed_robot_process(tmp_path: Path, command: str) -> None:
    robot = (
        "import asyncio, pathlib, sys\n"
        "from woz_drivers.programs import child_process\n"
        "async def main():\n"
        "    gone = await child_process.start(('true',), pathlib.Path())\n"
        "    await gone.end()\n"
        "    await child_process.start(('sh', '-c', sys.argv[1]), pathlib.Path())\n"
        "    print('started', flush=True)\n"
        "    await asyncio.sleep(1000)\n"
        "asyncio.run(main())\n"
    )
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-c", robot, command, stdout=asyncio.subprocess.PIPE
    )
    assert process.stdout is not None
    below: list[psutil.Process] = []
    try:
        await asyncio.wait_for(process.stdout.readline(), PATIENCE_S)

        def sleeping() -> bool:
            below[:] = offspring(process.pid)
            return bool(offspring(process.pid, named="sleep"))

        await until(sleeping)
        assert len(below) >= 2  # the guard is among them
    finally:
        process.kill()
        await process.wait()
    try:
        await until(lambda: not any(alive(one.pid) for one in below))
    finally:
        for one in below:
            with contextlib.suppress(psutil.NoSuchProcess):
                one.kill()


async def test_it_runs_in_the_folder_of_the_experiment(tmp_path: Path) -> None:
    script = tmp_path / "say.sh"
    script.write_text("#!/bin/sh\npwd\n")
    with pytest.raises(ProgramMissingError, match="not executable") as raised:
        await child_process.start(("./say.sh",), tmp_path)
    assert raised.value.remedy.startswith("chmod +x")
    script.chmod(0o700)
    said = bytearray()
    running = await child_process.start(("./say.sh",), tmp_path, on_output=said.extend)
    await running.wait()
    await running.end()
    assert said.decode().strip() == str(tmp_path)


async def test_held_output_waits(tmp_path: Path) -> None:
    said = bytearray()
    go = asyncio.Event()

    def take(data: bytes) -> None:
        said.extend(data)
        go.set()

    running = await child_process.start(("cat", "/dev/zero"), tmp_path, on_output=take)
    try:
        await go.wait()
        running.hold(True)
        for _ in range(5):  # what was read already still arrives
            await asyncio.sleep(0)
        before = len(said)
        for _ in range(50):
            await asyncio.sleep(0)
        assert len(said) == before
        running.hold(False)
        await until(lambda: len(said) > before)
    finally:
        await running.end()


async def test_what_the_system_refuses_is_a_driver_error(tmp_path: Path) -> None:
    with pytest.raises(DriverError, match="cannot be started"):
        await child_process.start(("echo", "x" * 3_000_000), tmp_path)
    with pytest.raises(DriverError, match="cannot be started"):
        await child_process.start(("echo", "a\0b"), tmp_path)


@pytest.mark.parametrize(
    ("program", "remedy"),
    [
        ("arecord", "sudo apt install alsa-utils"),
        ("parec", "sudo apt install pulseaudio-utils"),
        ("ffmpeg", "sudo apt install ffmpeg"),
        ("espeak-ng", "sudo apt install espeak-ng"),
        ("nosuch", "install nosuch, or name another program in the robot file"),
    ],
)
def test_missing_programs_name_their_package(
    program: str, remedy: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ProgramMissingError, match=f"{program} is not installed") as raised:
        command_lines.find(program, tmp_path)
    assert raised.value.remedy == remedy


def test_a_missing_path_is_named(tmp_path: Path) -> None:
    with pytest.raises(ProgramMissingError, match="does not exist"):
        command_lines.find("bin/say", tmp_path)


def test_commands_are_split_like_a_shell_would_and_run_by_none() -> None:
    assert command_lines.split("play 'a b' $HOME ; rm", "play") == (
        "play",
        "a b",
        "$HOME",
        ";",
        "rm",
    )
    assert command_lines.split(["a b", "c"], "play") == ("a b", "c")
    with pytest.raises(DriverError, match="closing quotation"):
        command_lines.split("play 'a", "play")
    with pytest.raises(DriverError, match="play is empty"):
        command_lines.split("  ", "play")


def test_placeholders_are_filled_once_and_checked() -> None:
    words = ("say", "--text={text}", "{text}", "{wav}", '{"json": 1}')
    filled = command_lines.fill(words, {"text": "-rf {wav}", "wav": "/x"})
    assert filled == ("say", "--text=-rf {wav}", " -rf {wav}", "/x", '{"json": 1}')
    assert command_lines.placeholders(words, ("text", "wav"), "speak") == {"text", "wav"}
    with pytest.raises(DriverError, match=r"speak has \{txt\}"):
        command_lines.placeholders(("{txt}",), ("text",), "speak")
