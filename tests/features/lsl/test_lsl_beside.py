"""A file with the section `lsl` has `woz lsl` run beside its session, and again when it ended."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from tests.features.companions import is_kept_running, launched
from tests.features.lsl.laboratory import needs_library, own_network
from tests.features.lsl.test_lsl_library import WITHOUT_LIBRARY
from woz_tui.client import connect
from woz_tui.features.lsl.kinds import LslLost, LslStream
from woz_tui.protocol import codec
from woz_tui.protocol.messages import Notice
from woz_tui.protocol.requests import AskEnd

pytestmark = pytest.mark.real_clock

SECTION = "lsl: {prefix: ada}"


@needs_library
async def test_it_runs_with_the_session_and_is_started_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LSLAPICFG", own_network(tmp_path)["LSLAPICFG"])
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    await is_kept_running(launched(tmp_path, SECTION), "lsl", LslStream, LslLost)


async def test_the_wizard_reads_why_it_does_not_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "pylsl.py").write_text(WITHOUT_LIBRARY)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    socket, texts = launched(tmp_path, SECTION).socket, [""]
    # Who joins is told what was said before; what comes while it joins is not told again.
    async with asyncio.timeout(60):
        while not any("`woz lsl` does not run: pylsl has no library" in text for text in texts):
            async with connect(socket) as woz:
                recent = map(codec.decode_message, woz.welcome.recent)
                texts = [line.text for line in recent if isinstance(line, Notice)]
    async with connect(socket) as woz:
        await woz.request(AskEnd())
