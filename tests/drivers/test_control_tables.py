"""The control tables against the published ones, written down here a second time."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.dynamixel import control_tables
from woz_drivers.dynamixel.control_tables import Register

from tests.fakes.servo_motor import KINDS

#: name: address, size - ROBOTIS e-Manual, XL330-M288 and XM430-W350, Control Table of RAM Area.
X = {
    "return_delay": (9, 1),
    "drive_mode": (10, 1),
    "operating_mode": (11, 1),
    "high_limit": (48, 4),
    "low_limit": (52, 4),
    "torque": (64, 1),
    "alarm": (70, 1),
    "watchdog": (98, 1),
    "startup": (60, 1),
    "speed_limit": (112, 4),
    "goal": (116, 4),
    "load": (126, 2),
    "present": (132, 4),
    "voltage": (144, 2),
    "temperature": (146, 1),
}
#: The same of MX-28 (protocol 1), RX-64 and AX-12A.
OLD = {
    "return_delay": (5, 1),
    "low_limit": (6, 2),
    "high_limit": (8, 2),
    "torque": (24, 1),
    "goal": (30, 2),
    "speed_limit": (32, 2),
    "present": (36, 2),
    "load": (40, 2),
    "voltage": (42, 1),
    "temperature": (43, 1),
}
#: Model numbers: e-Manual, "Model Number" of each control table.
NUMBERS = {
    "XL330-M077": 1190,
    "XL330-M288": 1200,
    "XC330-T181": 1210,
    "XC330-T288": 1220,
    "XC330-M181": 1230,
    "XC330-M288": 1240,
    "XL430-W250": 1060,
    "2XL430-W250": 1090,
    "XC430-W150": 1070,
    "XC430-W240": 1080,
    "XM430-W350": 1020,
    "XM430-W210": 1030,
    "XM540-W270": 1120,
    "XM540-W150": 1130,
    "MX-28": 29,
    "MX-64": 310,
    "MX-106": 320,
    "AX-12A": 12,
    "AX-18A": 18,
    "RX-24F": 24,
    "RX-28": 28,
    "RX-64": 64,
}


@pytest.mark.parametrize(
    ("table", "published"), [(control_tables.X_SERIES, X), (control_tables.PROTOCOL_1, OLD)]
)
def test_addresses(
    table: control_tables.ControlTable, published: dict[str, tuple[int, int]]
) -> None:
    for name, (address, size) in published.items():
        register = getattr(table, name)
        assert (register.address, register.size) == (address, size), name
    absent = {"alarm", "watchdog", "startup", "operating_mode", "drive_mode"} - set(published)
    assert all(getattr(table, name) is None for name in absent)


def test_model_numbers() -> None:
    assert {model.name: model.number for model in control_tables.MODELS} == NUMBERS


def test_models_are_found_by_number_and_by_name() -> None:
    for model in control_tables.MODELS:
        assert control_tables.by_number(model.table.protocol, model.number) is model
        assert control_tables.by_name(model.name.lower()) is model
    assert control_tables.by_name("XL330-M288-T") is control_tables.by_number(2, 1200)
    assert control_tables.by_number(1, 1200) is None
    assert control_tables.by_name("XL330") is None


def test_the_emulator_agrees() -> None:
    for name, (protocol, number, counts, travel) in KINDS.items():
        model = control_tables.by_name(name)
        assert model is not None
        assert (model.table.protocol, model.number) == (protocol, number)
        assert (model.steps, model.travel) == (counts, travel)


def test_units() -> None:
    xl330 = control_tables.by_name("XL330-M288")
    ax12 = control_tables.by_name("AX-12A")
    assert xl330 is not None and ax12 is not None
    assert xl330.degrees_per_step == pytest.approx(0.088, abs=1e-3)  # 0.088 deg a pulse
    assert xl330.speed_unit == pytest.approx(0.229 * 6)  # 0.229 rev/min a count
    assert ax12.degrees_per_step == pytest.approx(0.29, abs=0.005)  # 0.29 deg a count
    assert (xl330.centre, ax12.centre) == (2048, 512)


def test_blocks_cover_what_is_cut_out_of_them() -> None:
    assert control_tables.X_SERIES.status_block() == Register(64, 35)
    assert control_tables.X_SERIES.sensor_block() == Register(126, 21)
    assert control_tables.PROTOCOL_1.status_block() == Register(24, 14)
    assert control_tables.PROTOCOL_1.sensor_block() == Register(40, 4)


def test_alarms_have_names() -> None:
    assert control_tables.alarms(control_tables.X_SERIES, 0x25) == [
        "input voltage out of range",
        "overheated",
        "overload",
    ]
    # Bits that speak of the packet, not of the hardware, are no alarm.
    assert control_tables.alarms(control_tables.PROTOCOL_1, 0x5A) == []


@given(st.sampled_from([1, 2, 4]), st.booleans(), st.data())
def test_registers_round_trip(size: int, signed: bool, data: st.DataObject) -> None:
    register = Register(100, size, signed)
    half = 1 << (8 * size - 1)
    low, high = (-half, half - 1) if signed else (0, 2 * half - 1)
    value = data.draw(st.integers(low, high))
    assert register.decode(register.encode(value)) == value


def test_a_register_refuses_the_wrong_number_of_bytes() -> None:
    with pytest.raises(ValueError, match="3 bytes"):
        Register(116, 4).decode(b"\0\0\0")
    with pytest.raises(OverflowError):
        Register(30, 2).encode(70_000)
