"""A file with the section `lsl` has `woz lsl` run beside its session, and again when it ended."""

from __future__ import annotations

import asyncio
from pathlib import Path

import psutil
import pytest

from tests.config.reading import HEAD, HELLO, panel
from tests.features.lsl.laboratory import needs_library, own_network
from tests.features.lsl.test_lsl_library import WITHOUT_LIBRARY
from woz_tui.client import WozClient, connect
from woz_tui.console.link.host_start import Launch, RobotProcess
from woz_tui.features.lsl.kinds import LslLost, LslStream
from woz_tui.protocol import codec
from woz_tui.protocol.messages import Notice
from woz_tui.protocol.requests import AskEnd

pytestmark = pytest.mark.real_clock


def launched(folder: Path) -> RobotProcess:
    file = folder / "study.yaml"
    file.write_text(panel(HELLO, head=f"{HEAD}lsl: {{prefix: ada}}\n"))
    return Launch([str(file), "--recordings", str(folder / "recordings")]).wait()


@pytest.fixture
def host(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RobotProcess:
    """The session of a file with the section."""
    monkeypatch.setenv("LSLAPICFG", own_network(tmp_path)["LSLAPICFG"])
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    return launched(tmp_path)


async def sent(woz: WozClient, *, again: bool = False) -> None:
    """Until the session's streams are there; `again`: after they were lost."""
    lost = not again
    async with asyncio.timeout(60):
        async for message in woz.messages(LslLost, LslStream, held=not again):
            lost = lost or isinstance(message, LslLost)
            if lost and isinstance(message, LslStream) and message.stream == "ada-events":
                return


def sender(host: RobotProcess) -> psutil.Process:
    """The process of `woz lsl`."""
    children = psutil.Process(host.pid).children()
    (found,) = [each for each in children if "lsl" in each.cmdline()]
    return found


@needs_library
async def test_it_runs_with_the_session_and_is_started_again(host: RobotProcess) -> None:
    async with connect(host.socket) as woz:
        await sent(woz)
        back = asyncio.create_task(sent(woz, again=True))
        await asyncio.sleep(0)  # it listens
        sender(host).kill()
        await back
        last = sender(host)
        await woz.request(AskEnd())
    await asyncio.to_thread(last.wait, 20)


async def test_the_wizard_reads_why_it_does_not_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "pylsl.py").write_text(WITHOUT_LIBRARY)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    host = launched(tmp_path)
    async with connect(host.socket) as woz, asyncio.timeout(60):
        later = woz.messages(Notice)
        recent = [codec.decode_message(line) for line in woz.welcome.recent]
        notices = [line for line in recent if isinstance(line, Notice)]
        text = notices[-1].text if notices else (await anext(later)).text
        assert "`woz lsl` does not run: pylsl has no library liblsl" in text
        await woz.request(AskEnd())
