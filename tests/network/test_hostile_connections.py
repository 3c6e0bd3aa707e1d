"""The door of a served driver, with somebody at it who means harm. `make fuzz`: 100,000 frames."""

from __future__ import annotations

import asyncio
import contextlib
import random
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.example_counts import many
from tests.network.hostile_frames import HostileFrames
from tests.network.other_computer import PLACE, Pair, pair
from woz_tui.drivers.contract import DeviceLostError
from woz_tui.network import remote_driver as remote_side
from woz_tui.network.driver_line import from_key, to_key
from woz_tui.network.zenoh_line import connect
from woz_tui.testing import PlainJob, until

#: Of one example.
FRAMES = 100
#: What a conversation may begin anew in, in seconds.
PATIENCE_S = 30.0


async def plays_on(two: Pair) -> None:
    """The session plays the driver, whatever was sent before."""

    async def waved() -> bool:
        with contextlib.suppress(DeviceLostError):
            return await two.remote.perform(PlainJob("wave")) == {"waved": 1}
        await asyncio.sleep(0.02)
        return False

    async with asyncio.timeout(PATIENCE_S):
        while not await waved():
            pass


async def attack(two: Pair, seed: int) -> None:
    """Another program on the line sends frames for both sides."""
    line = await asyncio.to_thread(connect, two.router.listen, None)
    frames = HostileFrames(seed, two.remote._bound, two.remote._epoch)
    for _ in range(FRAMES // 2):
        line.send(to_key(PLACE, "arm"), frames.to_driver())
        line.send(from_key(PLACE, "arm"), frames.from_driver())
    await asyncio.to_thread(line.close)
    await plays_on(two)


@settings(max_examples=many(5, 200))
@given(seed=st.integers(0, 2**32))
def test_hostile_frames_move_nothing_and_the_session_plays_on(seed: int) -> None:
    async def run() -> None:
        with tempfile.TemporaryDirectory() as folder:
            async with pair(Path(folder)) as two:
                await attack(two, seed)
                arm = two.arm
                assert {verb for verb, _ in arm.calls} == {"wave"}
                assert not two.context.asks or {ask.what for ask in two.context.asks} == {"release"}

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(remote_side, "LATE_S", 10.0)
        asyncio.run(run())


@pytest.mark.usefixtures("patient_network")
async def test_bytes_of_another_protocol_at_the_port_change_nothing(tmp_path: Path) -> None:
    dice = random.Random(3)
    async with pair(tmp_path) as two:
        host, port = two.router.listen.removeprefix("tcp://").split(":")
        for _ in range(20):
            _, writer = await asyncio.open_connection(host, int(port))
            writer.write(
                dice.choice([b"GET / HTTP/1.1\r\n\r\n", b"\xff" * 70_000, dice.randbytes(300)])
            )
            writer.close()
        lifting = asyncio.create_task(two.remote.perform(PlainJob("lift", {"kg": 2.0})))
        await until(lambda: "lift" in two.arm.under_way)
        lifting.cancel()
        await asyncio.gather(lifting, return_exceptions=True)
