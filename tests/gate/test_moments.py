"""When the gate is asked: by every press and every command, by no stop."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

import pytest

from tests.host.rig import served_session
from tests.session.rig import SessionRig
from woz_tui.gate.questions import RequestOrigin

pytestmark = pytest.mark.safety


@contextmanager
def asked() -> Iterator[list[str]]:
    """Whoever asks the gate meanwhile, by the function that does."""
    found: list[str] = []

    def note(frame: FrameType, event: str, _: object) -> None:
        code, before = frame.f_code, frame.f_back
        here = code.co_filename.endswith("gate/table.py") and code.co_name == "why_not"
        if event == "call" and here and before is not None:
            found.append(before.f_code.co_qualname)

    sys.setprofile(note)
    try:
        yield found
    finally:
        sys.setprofile(None)


async def test_a_stop_its_confirmation_and_the_end_of_driving_never_ask(tmp_path: Path) -> None:
    async with served_session(tmp_path) as place:
        peer = await place.connect()
        await peer.hello()
        place.session.bus.unwatched = ""
        await peer.ask("verb", verb="drive", args={"x": 1.0}, on="robot")
        with asked() as found:
            place.session.bus.halt_driving("the wizard's console does not respond")
            assert (await peer.ask("stop"))["ok"]
            await peer.kind("stop.confirmed")
        assert found == []
        with asked() as found:
            assert not (await peer.ask("action", action="Hello"))["ok"]
        assert found == ["RequestHandlers.answer", "Session.play"]


def test_a_press_its_command_and_what_waited_ask(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        script = RequestOrigin("script", "space", "con1")
        command = ["Bus.submit", "Bus._why_not_dispatched"]
        with asked() as found:
            rig.session.play("Hello", script)
        assert found == ["Session.play", *command]
        with asked() as found:
            rig.session.play("Hello", script)
            await asyncio.sleep(2)  # the first one is over, and the second one's turn has come
        assert found == ["Session.play", *command, "Session._why_no_action"]

    SessionRig(tmp_path).run(scenario)
