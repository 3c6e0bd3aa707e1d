"""Ports, disk, clock and processor, from file trees as Linux shows them."""

from __future__ import annotations

import threading
from datetime import UTC, datetime
from pathlib import Path

import pytest

from woz_tui.drivers.contract import Finding
from woz_tui.machine import machine_checks
from woz_tui.machine.machine_checks import bounded
from woz_tui.machine.program_output import output_of

# -- no check may hang or raise -----------------------------------------------------------------


def test_a_check_that_hangs_becomes_an_error() -> None:
    forever = threading.Event()

    def hang() -> list[Finding]:
        forever.wait()
        return []

    [finding] = bounded("network disk", hang, 0.01)
    forever.set()
    assert (finding.level, finding.subject) == ("error", "network disk")
    assert "0.01 s" in finding.text


@pytest.mark.parametrize("error", [ZeroDivisionError("by zero"), SystemExit(3), OSError(5, "EIO")])
def test_a_check_that_raises_becomes_an_error(error: BaseException) -> None:
    def fail() -> list[Finding]:
        raise error

    [finding] = bounded("driver", fail)
    assert finding.level == "error"
    assert type(error).__name__ in finding.text


def test_what_a_check_finds_is_passed_on() -> None:
    found = [Finding("ok", "a", "b"), Finding("info", "c", "d")]
    assert bounded("check", lambda: found) == found


def test_a_commands_output_or_nothing() -> None:
    assert output_of(["printf", " 4 \n"]) == "4"
    assert output_of(["false"]) is None
    assert output_of(["no-such-program-anywhere"]) is None
    assert output_of(["sleep", "60"], 0.01) is None


# -- ports --------------------------------------------------------------------------------------


def test_ports_are_found_by_id(tmp_path: Path) -> None:
    by_id = tmp_path / "serial" / "by-id"
    by_id.mkdir(parents=True)
    (tmp_path / "ttyUSB0").touch()
    (by_id / "usb-FTDI_U2D2-if00").symlink_to("../../ttyUSB0")
    (by_id / "usb-Arduino-if00").symlink_to("../../ttyACM0")
    gone, there = machine_checks.serial_ports(tmp_path)
    assert (gone.level, gone.subject) == ("warning", "usb-Arduino-if00")
    assert there == Finding("ok", "usb-FTDI_U2D2-if00", str(tmp_path / "ttyUSB0"))


def test_no_port_is_worth_a_line(tmp_path: Path) -> None:
    assert [finding.level for finding in machine_checks.serial_ports(tmp_path)] == ["info"]


def test_latency_timers_say_what_they_cost(tmp_path: Path) -> None:
    for port, text in {"ttyUSB0": "16\n", "ttyUSB1": "1\n", "ttyUSB2": "?\n"}.items():
        (tmp_path / port).mkdir()
        (tmp_path / port / "latency_timer").write_text(text)
    slow, fast = machine_checks.latency_timers(tmp_path)
    assert slow.level == "warning"
    assert "62 reads a second" in slow.text
    assert str(tmp_path / "ttyUSB0" / "latency_timer") in slow.remedy
    assert (fast.level, fast.subject) == ("ok", "latency of ttyUSB1")


def test_the_serial_group_is_judged_for_whoever_runs_this() -> None:
    [finding] = machine_checks.serial_group()
    assert finding.subject == "serial access"
    assert (finding.level == "warning") == bool(finding.remedy)


# -- disk ---------------------------------------------------------------------------------------


def test_syncs_are_measured_and_leave_nothing_behind(tmp_path: Path) -> None:
    finding = machine_checks.sync_time(tmp_path, writes=3)
    assert "written to disk in" in finding.text
    assert list(tmp_path.iterdir()) == []


def test_a_folder_still_to_be_made_is_measured_above(tmp_path: Path) -> None:
    later = tmp_path / "study" / "recordings"
    assert machine_checks.nearest(later) == tmp_path
    assert "written to disk" in machine_checks.sync_time(later, writes=1).text
    assert not later.exists()


def test_a_place_that_takes_no_file_is_an_error() -> None:
    finding = machine_checks.sync_time(Path("/proc"), writes=1)
    assert (finding.level, finding.subject) == ("error", "recordings")
    assert "--recordings" in finding.remedy


def test_free_room_is_told(tmp_path: Path) -> None:
    finding = machine_checks.free_space(tmp_path / "recordings")
    assert "GB free" in finding.text


def test_no_free_room_is_an_error() -> None:
    assert machine_checks.free_space(Path("/proc")).level == "error"


# -- clocks -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("year", "level"), [(1970, "error"), (2024, "error"), (2026, "ok"), (2106, "error")]
)
def test_an_impossible_year_is_an_error(year: int, level: str) -> None:
    finding = machine_checks.calendar(datetime(year, 5, 1, 9, 30, tzinfo=UTC))
    assert finding.level == level
    assert f"{year}-05-01 09:30 UTC" in finding.text


def test_this_machines_clocks_are_judged() -> None:
    assert machine_checks.monotonic_clock().level in {"ok", "warning"}
    assert machine_checks.synchronised().subject == "time server"


# -- processor ----------------------------------------------------------------------------------


def cpu(root: Path, number: int, governor: str, driver: str) -> None:
    folder = root / f"cpu{number}" / "cpufreq"
    folder.mkdir(parents=True)
    (folder / "scaling_governor").write_text(f"{governor}\n")
    (folder / "scaling_driver").write_text(f"{driver}\n")


@pytest.mark.parametrize(
    ("governor", "driver", "level"),
    [
        ("ondemand", "cpufreq-dt", "ok"),
        ("powersave", "cpufreq-dt", "warning"),
        ("powersave", "intel_pstate", "ok"),
        ("performance", "acpi-cpufreq", "ok"),
    ],
)
def test_a_processor_kept_slow_is_noticed(
    tmp_path: Path, governor: str, driver: str, level: str
) -> None:
    for number in range(4):
        cpu(tmp_path, number, governor, driver)
    [finding] = machine_checks.governor(tmp_path)
    assert finding.level == level
    assert f"{governor} on 4 cores" in finding.text


def test_a_machine_that_does_not_say_has_no_line(tmp_path: Path) -> None:
    assert machine_checks.governor(tmp_path) == []


@pytest.mark.parametrize(
    ("answer", "level", "words"),
    [
        ("throttled=0x0", "ok", "never"),
        ("throttled=0x50000", "warning", "since the last start: under-voltage, throttled"),
        ("throttled=0x50005", "error", "right now: under-voltage, throttled"),
        ("throttled=0x80008", "error", "soft temperature limit"),
        ("error=1 error_msg='Command not registered'", "info", "not registered"),
    ],
)
def test_a_raspberry_pis_firmware_is_understood(answer: str, level: str, words: str) -> None:
    [finding] = machine_checks.read_throttling(answer)
    assert finding.level == level
    assert words in finding.text
