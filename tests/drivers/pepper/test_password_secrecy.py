"""A password that somebody sends or writes where it does not belong: nobody gets to see it."""

from __future__ import annotations

import json
import logging
from pathlib import Path

import pytest
from woz_drivers.pepper import Pepper

from tests.host.rig import served_session
from woz_tui.config.loading import load
from woz_tui.protocol.messages import Json

CATALOGUE = {"pepper": Pepper}
#: A password with all that sentences and templates trip over.
PASSWORD = "Hush{x}/Hush@Hush:Hush!"
ADDRESS = f"tcps://nao:{PASSWORD}@10.0.0.1:9503"
SHOWN = "tcps://nao:***@10.0.0.1:9503"

EXPERIMENT = """\
title: Nobody there
robot: {drivers: {pepper: {type: pepper, robots: [], connect: false}}}
panels: [{title: A, actions: [{label: Hello, say: Hello}]}]
"""


def write_file(folder: Path, text: str) -> Path:
    file = folder / "experiment.yaml"
    file.write_text(text)
    return file


@pytest.mark.parametrize(
    "args",
    [
        {"robot": ADDRESS},
        {"robot": ADDRESS, "address": ADDRESS},
        {"adress": ADDRESS},
        {"robot": [ADDRESS, {"deep": ADDRESS, ADDRESS: 1}]},
        {ADDRESS: "robot"},
    ],
)
async def test_neither_the_log_nor_any_message_has_what_a_program_sends(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, args: dict[str, Json]
) -> None:
    caplog.set_level(logging.DEBUG)
    experiment = load(write_file(tmp_path, EXPERIMENT), CATALOGUE)
    async with served_session(tmp_path, made=experiment, catalogue=CATALOGUE) as host:
        watcher, program = await host.connect(), await host.connect()
        await watcher.hello(role="watcher")
        await program.hello()
        reply = await program.ask("verb", verb="connect", args=args)
        end = await watcher.kind("command.refused")
        assert end["command"] == reply["run"]
        odd = await program.ask("verb", verb="connect", args=args, on="nobody")
        assert odd["ok"] is False
        (asked,) = [one for one in watcher.seen if one["kind"] == "command.requested"]
        assert "nao:***" in json.dumps(asked["args"])
        if args == {"robot": ADDRESS}:
            assert asked["args"] == {"robot": SHOWN}
            assert "must not stand in an address" in end["reason"]
            assert "WOZ_PEPPER_PASSWORD" in end["remedy"]
        late = await host.connect()
        await late.hello()
        said = json.dumps([*watcher.seen, *program.seen, *late.seen])
    files = [file for file in (tmp_path / "recordings").rglob("*") if file.is_file()]
    log = b"".join(file.read_bytes() for file in files)
    assert b'"command.requested"' in log
    assert b"Hush" not in log
    assert "Hush" not in said + caplog.text


async def test_an_address_without_one_is_recorded_as_it_is(tmp_path: Path) -> None:
    experiment = load(write_file(tmp_path, EXPERIMENT), CATALOGUE)
    async with served_session(tmp_path, made=experiment, catalogue=CATALOGUE) as host:
        program = await host.connect()
        await program.hello()
        await program.ask("verb", verb="connect", args={"robot": "tcps://nao@127.0.0.1:1"})
        (asked,) = [one for one in program.seen if one["kind"] == "command.requested"]
        assert asked["args"] == {"robot": "tcps://nao@127.0.0.1:1"}
