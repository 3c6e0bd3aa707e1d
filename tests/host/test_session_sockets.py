"""The socket's file: whose it is, and what happens when somebody takes it away."""

from __future__ import annotations

import shutil
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import Peer, ServedSession, served_session
from woz_tui.cli import main
from woz_tui.cli.session_choice import find_session
from woz_tui.config.experiment import Experiment
from woz_tui.config.problems import ProblemReport
from woz_tui.drivers.plugins import PluginError
from woz_tui.protocol.sentence import Sentence
from woz_tui.system import session_sockets
from woz_tui.system.session_sockets import SessionSocketError, answers, bind, folder, inode


async def back(host: ServedSession, peer: Peer) -> None:
    """The socket is there again with one of the next pulses; some may have come before."""
    for _ in range(20):
        await peer.kind("pulse")
        if inode(host.path) is not None:
            return
    raise AssertionError("it never came back")


async def greeted(host: ServedSession) -> None:
    peer = await host.connect()
    assert (await peer.hello())["title"] == "Made by hand"
    peer.leave()


async def test_a_socket_that_was_removed_is_there_again(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        before = await host.connect()
        await before.hello()
        host.path.unlink()
        await back(host, before)
        await greeted(host)
        assert (await before.ask("marker"))["ok"]
    assert not host.path.exists()


async def test_a_logout_takes_the_folder_and_the_next_login_brings_it_back(tmp_path: Path) -> None:
    runtime = tmp_path / "1000"
    runtime.mkdir()
    async with served_session(tmp_path, path=runtime / "woz" / "S01.sock") as host:
        before = await host.connect()
        await before.hello()
        shutil.rmtree(runtime)
        for _ in range(3):  # there is no place to bind at
            await before.kind("pulse")
        runtime.mkdir()
        await back(host, before)
        await greeted(host)


async def test_a_socket_of_somebody_else_is_left_alone(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        host.path.unlink()
        other = bind(host.path)
    assert host.path.is_socket()
    other.close()


@pytest.mark.parametrize("kind", ["file", "folder"])
def test_only_sockets_are_replaced(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "thesis"
    path.write_text("all my work") if kind == "file" else path.mkdir()
    with pytest.raises(SessionSocketError, match="not a socket; remove it"):
        bind(path)
    assert path.exists()


def test_a_crowd_at_the_door_does_not_look_like_a_dead_process(tmp_path: Path) -> None:
    path = tmp_path / "s"
    with bind(path) as listener:
        crowd = []
        while True:
            waiting = socket.socket(socket.AF_UNIX)
            waiting.setblocking(False)
            crowd.append(waiting)
            try:
                waiting.connect(str(path))
            except BlockingIOError:
                break
        assert answers(path)
        for waiting in crowd:
            waiting.close()
        assert listener.fileno() >= 0


@pytest.mark.parametrize(
    ("request_", "reason"),
    [
        ({"kind": "hello", "role": "program", "stream": "samples"}, "no stream 'samples'"),
        ({"kind": "action", "action": "Hello", "when_busy": "Replace"}, "Invalid enum value"),
    ],
)
async def test_misspelt_words_are_no_defaults(
    tmp_path: Path, request_: dict[str, str], reason: str
) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        await peer.say(**request_)
        assert reason in (await peer.kind("reply"))["reason"]


async def test_a_reload_that_fails_in_an_unforeseen_way_is_answered(tmp_path: Path) -> None:
    def load() -> Experiment:
        raise PluginError("the driver 'arm' cannot be loaded")

    async with served_session(tmp_path, load=load) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        reply = await peer.ask("reload")
        assert "'arm' cannot be loaded" in reply["reason"]
        assert not reply["ok"]


async def reload_refused(folder: Path, report: ProblemReport) -> tuple[dict[str, Any], str]:
    """What a reload is answered that finds these problems, and the name of the session's file."""

    def load() -> Experiment:
        report.raise_errors()
        raise AssertionError

    async with served_session(folder, load=load) as host:
        peer = await host.connect()
        await peer.hello(stream="nothing")
        return await peer.ask("reload"), host.session.experiment.path.name


async def test_a_reload_of_a_broken_file_says_which_file_to_check(tmp_path: Path) -> None:
    report = ProblemReport()
    report.error_at("panels", "oh")
    reply, file = await reload_refused(tmp_path, report)
    assert file in reply["hint"]
    assert len(reply["data"]) == 1


async def test_what_is_wrong_with_the_file_has_a_code_for_programs(tmp_path: Path) -> None:
    report = ProblemReport()
    report.error_at(
        "panels", Sentence("check.no_panel", "there is no panel {name}{near}", name="'A'", near="")
    )
    report.error_at("robot", "the driver's own words")
    reply, _ = await reload_refused(tmp_path, report)
    assert [line.rpartition(": ")[2] for line in reply["data"]] == [
        "there is no panel 'A'",
        "the driver's own words",
    ]
    first, second = (reply["wording"][f"data.{at}"] for at in range(2))
    assert first["code"] == second["code"] == "check.error"
    assert first["values"]["message"]["code"] == "check.no_panel"
    assert second["values"]["message"] == "the driver's own words"


# -- what may be in the place of a folder ----------------------------------------------------------


def a_file(place: Path) -> None:
    place.write_text("")


def a_dangling_link(place: Path) -> None:
    place.symlink_to("nowhere")


def a_link_to_a_folder(place: Path) -> None:
    (place.parent / "elsewhere").mkdir()
    place.symlink_to("elsewhere")


@pytest.mark.parametrize("lay", [a_file, a_dangling_link, a_link_to_a_folder])
def test_what_is_no_folder_in_the_runtime_folders_place_is_named_with_a_remedy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lay: Callable[[Path], None]
) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    lay(tmp_path / "woz")
    with pytest.raises(SessionSocketError) as caught:
        folder()
    assert str(tmp_path / "woz") in str(caught.value)
    assert "remove it" in str(caught.value)


@pytest.mark.parametrize("lay", [a_file, a_dangling_link])
def test_what_is_no_folder_above_a_socket_is_named_with_a_remedy(
    tmp_path: Path, lay: Callable[[Path], None]
) -> None:
    lay(tmp_path / "woz")
    with pytest.raises(SessionSocketError) as caught:
        bind(tmp_path / "woz" / "S01.sock")
    assert str(tmp_path / "woz") in str(caught.value)
    assert "WOZ_SOCKET" in str(caught.value)


@pytest.mark.parametrize("lay", [a_file, a_dangling_link, Path.mkdir])
def test_what_is_no_socket_in_its_place_is_left_there(
    tmp_path: Path, lay: Callable[[Path], None]
) -> None:
    place = tmp_path / "S01.sock"
    lay(place)
    with pytest.raises(SessionSocketError) as caught:
        bind(place)
    assert str(place) in str(caught.value)
    assert "WOZ_SOCKET" in str(caught.value)
    assert inode(place) is not None


@pytest.mark.parametrize(
    "name", ["../../X", "x/y", "/X", "..", ".X", "", "a\nb", "a\0b", "a\x1b[2J"]
)
def test_no_name_leads_out_of_the_folder(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    name: str,
) -> None:
    monkeypatch.delenv("WOZ_SOCKET", raising=False)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "run" / "user"))
    (tmp_path / "run" / "user").mkdir(parents=True)
    with pytest.raises(SessionSocketError, match="cannot be called"):
        session_sockets.socket_path(name)
    if name and "\0" not in name:
        demo = str(Path(__file__).parents[2] / "experiments" / "demo.yaml")
        logs = str(tmp_path / "recordings")
        assert main(["host", demo, "--name", name, "--recordings", logs]) != 0
        assert "cannot be called" in capsys.readouterr().err
    if name and "/" not in name and "\0" not in name:
        assert find_session(name, "woz listen") is None
        assert "cannot be called" in capsys.readouterr().err
    assert [path for path in tmp_path.rglob("*") if not path.is_dir()] in (
        [],
        [tmp_path / "run" / "user" / "woz" / "starting.lock"],
    )


@pytest.mark.parametrize("name", ["S07", "Übung 3", "a.b", "S07@robot.local-2"])
def test_other_names_are_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.delenv("WOZ_SOCKET", raising=False)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    assert session_sockets.socket_path(name) == tmp_path / "woz" / f"{name}.sock"
