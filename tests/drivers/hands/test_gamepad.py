"""A gamepad as bytes of Linux's joystick interface, and devices that come and go."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from woz_drivers.hands.device_watch import DeviceWatch
from woz_drivers.hands.gamepad import axis_names, button_names
from woz_drivers.hands.hand_device import HandDevice

from tests.drivers.published_messages import until
from tests.fakes.joystick import Joystick


class Found:
    """A watch for one path, and what it found."""

    def __init__(self, path: Path) -> None:
        self.watch = DeviceWatch([str(path)])
        self.devices: list[HandDevice] = []
        self.gone = 0
        self.troubles: list[str] = []
        self.watch.on_found = self._add
        self.watch.on_trouble = lambda what, remedy: self.troubles.append(what)

    def _add(self, device: HandDevice) -> None:
        self.devices.append(device)
        device.on_gone = self._leave

    def _leave(self) -> None:
        self.gone += 1

    async def look(self) -> None:
        await self.watch.look({"gamepad"})

    def close(self) -> None:
        for device in self.devices:
            device.close()


async def test_records_become_controls_by_name(tmp_path: Path) -> None:
    pad = Joystick(tmp_path / "js0")
    found = Found(pad.port)
    await found.look()
    [device] = found.devices
    pad.press("south", "left-bumper")
    pad.push("left-stick-y", -1)
    pad.push("right-stick-x", 0.5)
    pad.push("left-trigger", 1)
    pad.push("right-trigger", -1)
    pad.push("hat-x", -1)
    pad.push("hat-y", 1)
    wanted = {
        **{"south": 1.0, "left-bumper": 1.0, "left-stick-y": 1.0, "right-stick-x": 0.5},
        **{"left-trigger": 1.0, "left": 1.0, "down": 1.0},
    }
    await until(lambda: device.held == wanted)
    pad.let_go("south", "left-bumper")
    for name in ("left-stick-y", "right-stick-x", "hat-x", "hat-y"):
        pad.push(name, 0)
    pad.push("left-trigger", -1)
    await until(lambda: device.held == {})
    found.close()
    pad.unplug()


async def test_a_pad_that_is_pulled_out_holds_nothing_and_is_found_again(tmp_path: Path) -> None:
    pad = Joystick(tmp_path / "js0")
    found = Found(pad.port)
    await found.look()
    pad.press("south")
    await until(lambda: found.devices[0].held == {"south": 1.0})
    pad.unplug()
    await until(lambda: found.gone == 1)
    assert found.devices[0].held == {}
    await found.look()
    await found.look()
    assert len(found.troubles) == 1
    assert str(pad.port) in found.troubles[0]
    pad.plug()
    await found.look()
    pad.press("east")
    await until(lambda: found.devices[-1].held == {"east": 1.0})
    assert len(found.devices) == 2
    found.close()
    pad.unplug()


async def test_records_may_come_in_any_pieces(tmp_path: Path) -> None:
    pad = Joystick(tmp_path / "js0")
    found = Found(pad.port)
    await found.look()
    record = bytes((0, 0, 0, 0, 1, 0, 0x81, 0))
    for byte in record:
        pad.send(bytes((byte,)))
    await until(lambda: found.devices[0].held == {"south": 1.0})
    pad.send(bytes((0, 0, 0, 0, 1, 0, 0x01, 200)) + bytes((9,) * 8))
    pad.let_go("south")
    await until(lambda: found.devices[0].held == {})
    found.close()
    pad.unplug()


XBOX = (0, 1, 2, 3, 4, 5, 16, 17)
BLUETOOTH = (0, 1, 2, 5, 9, 10, 16, 17)
OLD = (0, 1, 2, 5, 16, 17)


@pytest.mark.parametrize(
    ("codes", "names"),
    [
        (XBOX, {2: "left-trigger", 3: "right-stick-x", 4: "right-stick-y", 5: "right-trigger"}),
        (
            BLUETOOTH,
            {2: "right-stick-x", 3: "right-stick-y", 4: "right-trigger", 5: "left-trigger"},
        ),
        (OLD, {2: "right-stick-x", 3: "right-stick-y"}),
        ((40, 41), {}),
    ],
)
def test_axes_are_named_by_the_codes_of_the_kernel(
    codes: tuple[int, ...], names: dict[int, Any]
) -> None:
    found = axis_names(codes)
    assert names.items() <= found.items()
    assert len(set(found.values())) == len(found)


def test_x_and_y_of_an_xbox_pad_are_where_they_are_on_the_pad() -> None:
    codes = (0x130, 0x131, 0x133, 0x134)
    assert button_names(codes, "Sony DualSense")[2] == "north"
    assert button_names(codes, "Microsoft X-Box 360 pad")[2] == "west"
    assert button_names(codes, "Logitech Gamepad F710", "xpad")[2] == "west"
