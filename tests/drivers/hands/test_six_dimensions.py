"""6-D mice, Wii Remotes and motion sensors, as bytes of sockets, event devices and serial ports."""

from __future__ import annotations

import fcntl
import math
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.hands import gamepad, spacemouse
from woz_drivers.hands.device_watch import DeviceWatch
from woz_drivers.hands.gamepad import Gamepad
from woz_drivers.hands.hand_device import HandDevice
from woz_drivers.hands.imu import angles_between, sample_of
from woz_drivers.lines.line_decoder import LineError

from tests.drivers.published_messages import until
from tests.fakes.event_devices import ABS, KEY, REL, EventDevicePort, InputDevices
from tests.fakes.joystick import Joystick
from tests.fakes.plugged_device import PluggedDevice
from tests.fakes.spacenavd import FakeSpacenavd
from woz_tui.drivers.contract import DeviceLostError


class Watched:
    """A watch, what it found, lost and could not open."""

    def __init__(self, *wanted: Path) -> None:
        self._watch = DeviceWatch([str(path) for path in wanted])
        self.devices: list[HandDevice] = []
        self.gone: list[HandDevice] = []
        self.troubles: list[str] = []
        self._watch.on_found = self._add
        self._watch.on_trouble = lambda what, remedy: self.troubles.append(f"{what}; {remedy}")

    def _add(self, device: HandDevice) -> None:
        self.devices.append(device)
        device.on_gone = lambda: self.gone.append(device)

    async def look(self, *kinds: str) -> HandDevice:
        """Look once; the newest device."""
        await self._watch.look(kinds)
        return self.devices[-1]

    async def look_in_vain(self, *kinds: str) -> None:
        found = len(self.devices)
        await self._watch.look(kinds)
        assert len(self.devices) == found

    def close(self) -> None:
        for device in self.devices:
            device.close()


@pytest.fixture
def nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[InputDevices]:
    """No device but those of the test."""
    devices = InputDevices(tmp_path, monkeypatch)
    yield devices
    devices.unplug()


def axes(device: HandDevice) -> list[float]:
    return [round(device.held.get(name, 0.0), 2) for name in AXES]


AXES = ("push-x", "push-y", "push-z", "turn-x", "turn-y", "turn-z")


# -- a 6-D mouse by spacenavd ----------------------------------------------------------------------


@pytest.mark.toolkit("X4")
async def test_spacenavd_tells_six_axes_and_the_buttons(
    tmp_path: Path, nothing_else: InputDevices
) -> None:
    daemon = FakeSpacenavd(tmp_path / "spnav.sock")
    watched = Watched(daemon.path)
    device = await watched.look("spacemouse")
    daemon.push(500, -250, 125, 0, 50, -900)
    daemon.button(1, down=True)
    await until(lambda: "button-2" in device.held)
    assert axes(device) == [1.0, -0.5, 0.25, 0.0, 0.1, -1.0]
    daemon.push()
    daemon.button(1, down=False)
    daemon.button(200, down=True)  # no mouse has it
    daemon.send(struct.pack("=8i", 3, 9, 9, 9, 9, 9, 9, 9))  # a newer kind of record
    daemon.button(0, down=True)
    await until(lambda: device.held == {"button-1": 1.0})
    watched.close()
    daemon.close()


async def test_a_spacenavd_that_ends_holds_nothing_and_is_found_again(
    tmp_path: Path, nothing_else: InputDevices
) -> None:
    daemon = FakeSpacenavd(tmp_path / "spnav.sock")
    watched = Watched(daemon.path)
    device = await watched.look("spacemouse")
    daemon.push(500)
    await until(lambda: axes(device)[0] == 1.0)
    daemon.close()
    await until(lambda: watched.gone == [device])
    assert device.held == {}
    await watched.look_in_vain("spacemouse")
    await watched.look_in_vain("spacemouse")
    [trouble] = watched.troubles
    assert "spacenavd" in trouble
    assert "restart" in trouble
    daemon.path.unlink()
    daemon.start()
    assert await watched.look("spacemouse") is not device
    watched.close()
    daemon.close()


async def test_what_spacenavd_reads_is_not_read_twice(
    tmp_path: Path, nothing_else: InputDevices, monkeypatch: pytest.MonkeyPatch
) -> None:
    nothing_else.plug("3Dconnexion SpaceNavigator")
    daemon = FakeSpacenavd(tmp_path / "spnav.sock")
    monkeypatch.setattr(spacemouse, "SOCKETS", (daemon.path,))
    watched = Watched()
    await watched.look("spacemouse")
    assert [device.path for device in watched.devices] == [str(daemon.path)]
    watched.close()
    daemon.close()


# -- the same by the kernel ------------------------------------------------------------------------


async def test_an_older_mouse_that_says_nothing_at_rest_comes_to_rest(
    nothing_else: InputDevices,
) -> None:
    mouse = nothing_else.plug("3Dconnexion SpaceNavigator")
    watched = Watched()
    device = await watched.look("spacemouse", "wii-remote")
    assert (device.kind, device.name) == ("spacemouse", "3Dconnexion SpaceNavigator")
    seen: list[list[float]] = []
    device.on_change = lambda: seen.append(axes(device))
    # x to the right, y away from the hand, z up: as spacenavd turns the kernel's axes.
    mouse.say((REL, 0, 350), (REL, 1, -175), (REL, 2, -350), (REL, 5, 70), (KEY, 0x101, 1))
    await until(lambda: [1.0, 1.0, 0.5, 0.0, -0.2, 0.0] in seen)
    await until(lambda: device.held == {"button-2": 1.0})
    watched.close()


async def test_a_newer_mouse_says_its_ends_and_stays_where_it_is_held(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    devices = InputDevices(tmp_path, monkeypatch, dict.fromkeys(range(6), (-500, 500)))
    mouse = devices.plug("3Dconnexion SpaceMouse Compact")
    watched = Watched()
    device = await watched.look("spacemouse")
    mouse.say((ABS, 0, 500), (ABS, 3, -250), (KEY, 0x100, 1))
    await until(lambda: "button-1" in device.held)
    assert axes(device) == [1.0, 0.0, 0.0, -0.5, 0.0, 0.0]
    mouse.say((ABS, 0, 0), (ABS, 3, 0), (KEY, 0x100, 0))
    await until(lambda: device.held == {})
    mouse.say((ABS, 0, 500), (0, 3, 0))  # the kernel has lost records
    mouse.say((KEY, 0x101, 1))
    await until(lambda: device.held == {"button-2": 1.0})
    devices.unplug()
    await until(lambda: watched.gone == [device])
    watched.close()


@pytest.mark.parametrize("name", ["3Dconnexion CadMouse", "AT Translated Set 2 keyboard", ""])
async def test_other_devices_are_left_alone(nothing_else: InputDevices, name: str) -> None:
    nothing_else.plug(name)
    await Watched().look_in_vain("spacemouse", "wii-remote")


# -- what is no gamepad ----------------------------------------------------------------------------


def kernel_device(name: str, axis_codes: bytes, buttons: tuple[int, ...]) -> Any:
    """What the joystick interface says of a device."""

    def ioctl(fd: int, request: int, argument: Any = 0, *_: Any) -> Any:
        return {
            0x80006A13 | 128 << 16: name.encode().ljust(128, b"\0"),
            0x80016A11: bytes((len(axis_codes),)),
            0x80016A12: bytes((len(buttons),)),
            0x80406A32: axis_codes.ljust(64, b"\0"),
            0x84006A34: struct.pack("<512H", *buttons, *(0,) * (512 - len(buttons))),
        }[request]

    return ioctl


@pytest.mark.parametrize(
    "thing",
    [
        ("3Dconnexion SpaceMouse Pro", range(6), (0x100, 0x101), "device: spacemouse"),
        ("Nintendo Wii Remote Accelerometer", range(3, 6), (), "device: wii-remote"),
        ("Nintendo Wii Remote", range(0), (0x130, 0x131), "device: wii-remote"),
        ("ACME Six Axis Thing", range(6), (0x100, 0x101), "none of its buttons"),
    ],
)
async def test_what_is_no_gamepad_is_refused_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, thing: tuple[str, range, tuple[int, ...], str]
) -> None:
    name, axis_codes, buttons, remedy = thing
    device = Joystick(tmp_path / "js0")
    monkeypatch.setattr(gamepad, "DEV", tmp_path)
    monkeypatch.setattr(fcntl, "ioctl", kernel_device(name, bytes(axis_codes), buttons))
    watched = Watched(device.port)
    await watched.look_in_vain("gamepad")
    await watched.look_in_vain("gamepad")
    [trouble] = watched.troubles
    assert f"{name} is no gamepad" in trouble
    assert remedy in trouble
    device.unplug()


@pytest.mark.parametrize(
    ("name", "buttons"),
    [
        ("Microsoft X-Box 360 pad", (0x130, 0x131)),
        ("Nintendo Wii Remote Pro Controller", (0x130, 0x131)),
        ("Logitech Extreme 3D", (0x120, 0x121)),
    ],
)
async def test_gamepads_and_joysticks_are_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, buttons: tuple[int, ...]
) -> None:
    pad = Joystick(tmp_path / "js0")
    monkeypatch.setattr(fcntl, "ioctl", kernel_device(name, bytes((0, 1)), buttons))
    device = Gamepad(str(pad.port))
    assert device.name == name
    pad.push("left-stick-x", 1)
    await until(lambda: device.held == {"left-stick-x": 1.0})
    device.close()
    pad.unplug()


# -- a Wii Remote ----------------------------------------------------------------------------------


def lean(sensor: EventDevicePort, roll: float, pitch: float) -> None:
    """Held so, in degrees; 100 is 1 g."""
    along = 100 * math.cos(math.radians(pitch))
    x, z = along * math.sin(math.radians(roll)), along * math.cos(math.radians(roll))
    y = 100 * math.sin(math.radians(pitch))
    sensor.say((ABS, 3, round(x)), (ABS, 4, round(y)), (ABS, 5, round(z)))


@pytest.mark.toolkit("X4")
async def test_a_wii_remote_has_buttons_and_is_tilted(nothing_else: InputDevices) -> None:
    buttons = nothing_else.plug("Nintendo Wii Remote", "left")
    nothing_else.plug("Nintendo Wii Remote Accelerometer", "another")
    sensor = nothing_else.plug("Nintendo Wii Remote Accelerometer", "left")
    nothing_else.plug("Nintendo Wii Remote IR", "left")
    watched = Watched()
    device = await watched.look("wii-remote")
    assert [device.path] == [str(buttons.port)]
    buttons.say((KEY, 0x131, 1), (KEY, 103, 1))
    lean(sensor, 45, 0)
    await until(lambda: device.held == {"b": 1.0, "up": 1.0, "tilt-x": 0.5})
    sensor.say((ABS, 3, 5), (ABS, 4, 5), (ABS, 5, 5))  # thrown: where down is, nobody knows
    lean(sensor, 0, -45)
    await until(lambda: device.held == {"b": 1.0, "up": 1.0, "tilt-y": -0.5})
    sensor.unplug()
    await until(lambda: watched.gone == [device])
    assert device.held == {}
    watched.close()


# -- a motion sensor by lines ----------------------------------------------------------------------


@pytest.mark.toolkit("X4")
async def test_a_sensor_turns_from_where_its_clutch_was_pressed(tmp_path: Path) -> None:
    sensor = PluggedDevice(tmp_path / "ttyUSB0")
    watched = Watched(sensor.port)
    device = await watched.look("imu")
    seen: list[dict[str, float]] = []
    device.on_change = lambda: seen.append(dict(device.held))
    sensor.send(b"half a li\n0 0 120 up\n")
    sensor.send(b"0 0 120 down\n0,0,165,down\n")
    await until(lambda: {"clutch": 1.0, "turn-z": 0.5} in seen)
    sensor.send(b"0 0 165 up\r\n")
    await until(lambda: device.held == {})
    # Let go and pressed anew, there is the middle.
    sensor.send(b"nonsense\n0 0 165 down\n0 0 120 down\n")
    await until(lambda: {"clutch": 1.0, "turn-z": -0.5} in seen)
    await until(lambda: device.held == {})  # it says nothing any more
    sensor.unplug()
    await until(lambda: watched.gone == [device])
    watched.close()


async def test_a_port_that_is_not_there_is_named_once(tmp_path: Path) -> None:
    watched = Watched(tmp_path / "ttyUSB0@57600")
    await watched.look_in_vain("imu")
    await watched.look_in_vain("imu")
    [trouble] = watched.troubles
    assert "ttyUSB0 is not there" in trouble


@pytest.mark.parametrize(
    ("start", "end", "turned"),
    [
        ("0 0 0", "90 0 0", (90, 0, 0)),
        ("0 0 0", "0 -30 0", (0, -30, 0)),
        ("0 0 170", "0 0 -170", (0, 0, 20)),
        ("1 0 0 0", "0.7071 0 0 0.7071", (0, 0, 90)),
        ("1 0 0 0", "-1.4142 0 0 -1.4142", (0, 0, 90)),
    ],
)
def test_degrees_and_quaternions_say_the_same(
    start: str, end: str, turned: tuple[float, ...]
) -> None:
    between = angles_between(sample_of(start.encode()).turned, sample_of(end.encode()).turned)
    assert between == pytest.approx(turned, abs=0.01)


@pytest.mark.parametrize("line", [b"", b"1 2", b"1 2 3 4 5", b"nan 0 0", b"0 0 0 0", b"a b c down"])
def test_what_says_no_turn_is_refused(line: bytes) -> None:
    with pytest.raises(LineError, match="no turn"):
        sample_of(line)


def test_a_device_without_permission_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(DeviceLostError, match="cannot be opened"):
        Gamepad(str(tmp_path / "js7"))
