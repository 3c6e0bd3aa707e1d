"""What `woz doctor` looks at for a feature."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from woz_tui.drivers.contract import Finding


@dataclass(frozen=True, slots=True)
class FeatureChecks:
    """What a feature needs of the machine. `examine` looks and changes nothing."""

    examine: Callable[[], Iterable[Finding]]
