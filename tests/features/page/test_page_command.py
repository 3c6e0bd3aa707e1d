"""`woz page`: where it listens, what it prints, and that it needs nothing of the robot's."""

from __future__ import annotations

import asyncio
import re
import sys
from pathlib import Path

import aiohttp
import pytest

from tests.host.rig import served_session
from tests.session.rig import WAIT_S
from woz_tui.cli import main


@pytest.mark.parametrize(
    ("options", "needed"),
    [
        (["--at", "0.0.0.0:8080"], "--plain allows that, --certificate encrypts"),
        (["--at", "robot.local:8080"], "--plain allows that"),
        (["--at", "8080"], "'8080' is no address"),
        (["--at", ":1", "--certificate", "a.pem"], "--certificate and --key belong together"),
        (["--certificate", "no.pem", "--key", "no.key"], "no.pem: "),
        (["nobody"], "no session is running at "),
    ],
)
def test_what_would_be_open_to_everybody_has_to_be_said(
    options: list[str], needed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["page", *options]) == 1
    assert needed in capsys.readouterr().err


async def test_it_prints_an_address_for_each_and_leaves_when_told(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "woz_tui", "page", str(host.path), "--at", "127.0.0.1:0"),
            stdout=asyncio.subprocess.PIPE,
        )
        assert process.stdout is not None
        said = [await asyncio.wait_for(process.stdout.readline(), WAIT_S) for _ in range(4)]
        text = b"".join(said).decode()
        assert re.search(
            r"^For a class: +http://127\.0\.0\.1:\d+/ with the code \d{6}$", text, re.M
        )
        assert "Nothing there plays or stops the robot." in text
        for role, path in (("To watch", "/watch"), ("The participant", "/answer")):
            address = re.search(rf"^{role}: +(http\S+)$", text, re.M)
            assert address is not None
            async with aiohttp.ClientSession() as http, http.get(address[1]) as response:
                assert f'url={path}"' in await response.text()
        process.terminate()
        assert await asyncio.wait_for(process.wait(), WAIT_S) == 0
