"""What `woz doctor` says of a body: what it is made of, and which of its move files are wrong."""

from __future__ import annotations

from woz_drivers.body.settings import BodySettings
from woz_tui.drivers.contract import Finding, Probe


def examine(probe: Probe) -> list[Finding]:
    """There is no hardware of its own to look at."""
    settings: BodySettings = probe.settings
    known = settings.repertoire
    findings = [
        Finding(
            "ok",
            probe.name,
            f"{len(settings.joints)} joints ({', '.join(settings.joints)}),"
            f" {len(known.moves)} moves, {len(settings.personalities)} personalities",
        )
    ]
    findings += [
        Finding("warning" if problem.warning else "error", probe.name, str(problem))
        for problem in known.folder.problems
    ]
    if not settings.servos:
        findings.append(
            Finding(
                "info",
                probe.name,
                "moves no servos: it is only shown in the console",
                "name the driver of the servos in `servos`",
            )
        )
    return findings
