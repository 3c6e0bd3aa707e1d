"""The processor: whether it may run at full speed."""

from __future__ import annotations

import platform
from collections import Counter
from pathlib import Path

from woz_tui.drivers.contract import Finding
from woz_tui.machine.bounded_checks import output_of

CPUS = Path("/sys/devices/system/cpu")

#: Bits of `vcgencmd get_throttled` (Raspberry Pi documentation); 16 higher: since the last start.
_THROTTLED = {
    0: "under-voltage",
    1: "frequency capped",
    2: "throttled",
    3: "soft temperature limit",
}
#: Drivers whose governor "powersave" still goes to full speed under load.
_SELF_GOVERNING = ("intel_pstate", "amd-pstate", "amd-pstate-epp")


def python_version() -> Finding:
    """Which Python this is; anything that could start this is new enough."""
    return Finding("ok", "python", f"{platform.python_version()} on {platform.machine()}")


def governor(cpus: Path = CPUS) -> list[Finding]:
    """How the processor's frequency is chosen; empty where the machine does not say."""
    governors: Counter[str] = Counter()
    slow = 0
    for file in cpus.glob("cpu[0-9]*/cpufreq/scaling_governor"):
        name = _word(file)
        governors[name] += 1
        driver = _word(file.with_name("scaling_driver"))
        slow += name == "powersave" and driver not in _SELF_GOVERNING
    if not governors:
        return []
    text = ", ".join(f"{name} on {count} cores" for name, count in sorted(governors.items()))
    if not slow:
        return [Finding("ok", "processor", text)]
    remedy = f"echo ondemand | sudo tee {cpus}/cpu*/cpufreq/scaling_governor"
    return [Finding("warning", "processor", f"{text}: never runs at full speed", remedy)]


def _word(file: Path) -> str:
    try:
        return file.read_text().strip()
    except OSError:
        return ""


def throttling() -> list[Finding]:
    """Whether a Raspberry Pi's firmware slows it down; empty on other machines."""
    answer = output_of(["vcgencmd", "get_throttled"])
    return [] if answer is None else read_throttling(answer)


def read_throttling(answer: str) -> list[Finding]:
    """What the firmware's answer (`throttled=0x50005`) means."""
    try:
        flags = int(answer.partition("=")[2], 16)
    except ValueError:
        return [Finding("info", "power", f"vcgencmd says {answer!r}")]
    now = [what for bit, what in _THROTTLED.items() if flags >> bit & 1]
    past = [what for bit, what in _THROTTLED.items() if flags >> (bit + 16) & 1]
    remedy = "use the official power supply and a short cable; cool the board"
    if now:
        return [Finding("error", "power", f"right now: {', '.join(now)}", remedy)]
    if past:
        return [Finding("warning", "power", f"since the last start: {', '.join(past)}", remedy)]
    return [Finding("ok", "power", "never throttled since the last start")]
