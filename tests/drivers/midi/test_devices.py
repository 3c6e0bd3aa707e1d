"""Finding devices, and what `woz doctor` says of them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from woz_drivers.midi import devices
from woz_drivers.midi.devices import MidiDevice
from woz_drivers.midi.doctor import examine
from woz_drivers.midi.panel_maps import PanelMap
from woz_drivers.midi.settings import MidiSettings

from woz_tui.drivers.contract import DeviceLostError

CARDS = """\
 0 [PCH            ]: HDA-Intel - HDA Intel PCH
                      HDA Intel PCH at 0xf7f10000 irq 30
 1 [nanoKONTROL2   ]: USB-Audio - nanoKONTROL2
                      KORG INC. nanoKONTROL2 at usb-0000:00:14.0-2, full speed
 2 [LPD8           ]: USB-Audio - Akai LPD8 mk2
                      Akai LPD8 at usb-0000:00:14.0-3, full speed
"""


@pytest.fixture
def system(tmp_path: Path) -> tuple[Path, Path]:
    """Stand-ins for /dev/snd and /proc/asound."""
    dev, proc = tmp_path / "snd", tmp_path / "asound"
    dev.mkdir()
    proc.mkdir()
    (proc / "cards").write_text(CARDS, encoding="utf-8")
    for name in ("controlC0", "midiC2D0", "midiC1D0", "midiC10D1"):
        (dev / name).write_bytes(b"")
    return dev, proc


def test_devices_are_known_by_their_cards(system: tuple[Path, Path]) -> None:
    dev, _ = system
    assert devices.present_devices(*system) == [
        MidiDevice(str(dev / "midiC1D0"), "nanoKONTROL2", "nanoKONTROL2"),
        MidiDevice(str(dev / "midiC2D0"), "LPD8", "Akai LPD8 mk2"),
        MidiDevice(str(dev / "midiC10D1"), "card 10", ""),
    ]


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        *(("nanokontrol2", "midiC1D0"), ("LPD8", "midiC2D0"), ("akai lpd8", "midiC2D0")),
        *(("", "midiC1D0"), ("card 10", "midiC10D1")),
    ],
)
def test_a_device_by_its_name(system: tuple[Path, Path], wanted: str, found: str) -> None:
    assert devices.paths_of(wanted, Path("/"), *system)[0] == str(system[0] / found)


def test_a_device_by_its_path_and_one_that_is_not_there(system: tuple[Path, Path]) -> None:
    assert devices.paths_of("./a", Path("/x"), *system) == ["/x/a"]
    assert devices.paths_of("/dev/snd/b", Path("/x"), *system) == ["/dev/snd/b"]
    with pytest.raises(DeviceLostError) as raised:
        devices.open_one("BCF2000", Path("/"), *system)
    assert raised.value.what == "no MIDI device is called 'BCF2000'"
    assert "plugged in now: nanoKONTROL2 (" in raised.value.remedy
    assert devices.present_devices(Path("/nowhere"), Path("/nowhere")) == []


def test_of_two_panels_of_one_make_the_free_one_is_taken(system: tuple[Path, Path]) -> None:
    dev, proc = system
    second = " 3 [nanoKONTROL2_1 ]: USB-Audio - nanoKONTROL2\n                      KORG\n"
    (proc / "cards").write_text(CARDS + second, encoding="utf-8")
    (dev / "midiC3D0").write_bytes(b"")
    both = [str(dev / "midiC1D0"), str(dev / "midiC3D0")]
    assert devices.paths_of("nanoKONTROL2", Path("/"), *system) == both
    assert devices.paths_of("nanoKONTROL2_1", Path("/"), *system) == both[1:]
    (dev / "midiC1D0").unlink()
    (dev / "midiC1D0").symlink_to("gone")  # listed, but it cannot be opened
    path, fd, _ = devices.open_one("nanoKONTROL2", Path("/"), *system)
    os.close(fd)
    assert path == both[1]


def test_doctor_tells_devices_the_one_that_is_used_and_free_controls(
    system: tuple[Path, Path], tmp_path: Path
) -> None:
    found = examine("panel", MidiSettings(map="thesis"), tmp_path, *system)
    assert [finding.level for finding in found] == ["info", "info", "info", "ok", "info"]
    assert "midiC1D0 can be opened; its lights cannot be switched" in found[3].text
    assert found[4].text.startswith("31 controls do something; free: knob-5, knob-6, knob-7,")


def test_doctor_tells_what_is_missing(system: tuple[Path, Path], tmp_path: Path) -> None:
    settings = MidiSettings(map=PanelMap(), device="BCF2000")
    found = examine("panel", settings, tmp_path, *system)
    assert [(finding.level, finding.text) for finding in found[3:]] == [
        ("error", "no MIDI device is called 'BCF2000'"),
        ("warning", "no control does anything"),
    ]


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (2, "x is not there"),
        (13, "no permission to open x"),
        (16, "x is in use by another program"),
        (5, "x is not there"),
        (22, "x cannot be opened: Invalid argument"),
    ],
)
def test_why_a_device_cannot_be_opened(number: int, text: str) -> None:
    error = devices.open_error("x", OSError(number, os.strerror(number)))
    assert error.what == text
    assert error.remedy
