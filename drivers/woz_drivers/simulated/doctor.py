"""Findings of `woz doctor` about the settings of a simulated robot."""

from __future__ import annotations

from woz_drivers.simulated import verbs
from woz_drivers.simulated.settings import SimulatedSettings
from woz_drivers.simulated.verbs import roles
from woz_tui.drivers.contract import Finding, Probe


def examine(probe: Probe) -> list[Finding]:
    """Nothing can be missing."""
    settings: SimulatedSettings = probe.settings
    findings = [Finding("ok", probe.name, f"simulated, {len(settings.joints)} joints")]
    if not {"yaw", "pitch"} & roles(settings).keys():
        findings.append(
            Finding(
                "info",
                probe.name,
                "it has no head joint, so `gaze` and `nudge` are not offered",
                "name one in yaw_joint or pitch_joint",
            )
        )
    if settings.faults:
        findings.append(
            Finding(
                "warning",
                probe.name,
                f"{len(settings.faults)} faults are planned for it",
                "take `faults` out of the robot file to end that",
            )
        )
    for fault in settings.faults:
        parts = verbs.breakable(settings, fault.kind)
        if fault.part and fault.part not in parts:
            findings.append(
                Finding(
                    "error",
                    probe.name,
                    f"the planned fault {fault.kind!r} names a part {fault.part!r} that is"
                    " not there",
                    f"choose from {', '.join(parts)}" if parts else "leave `part` out",
                )
            )
    return findings
