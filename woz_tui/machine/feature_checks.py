"""What `woz doctor` looks at for a feature."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from woz_tui.drivers.contract import Finding


def _nothing(_: object) -> Iterable[Finding]:
    return ()


@dataclass(frozen=True, slots=True)
class FeatureChecks:
    """What a feature needs. `examine` looks at the machine, `of_file` at what an experiment (a
    `config.experiment.Experiment`) needs beside; both change nothing.
    """

    examine: Callable[[], Iterable[Finding]] = tuple
    of_file: Callable[[Any], Iterable[Finding]] = _nothing
