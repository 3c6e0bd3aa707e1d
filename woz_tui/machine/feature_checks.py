"""What `woz doctor` looks at for a feature, and at features of others."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from woz_tui.drivers.contract import Finding
from woz_tui.feature import features, left_out


def _nothing(_: object) -> Iterable[Finding]:
    return ()


@dataclass(frozen=True, slots=True)
class FeatureChecks:
    """What a feature needs. `examine` looks at the machine, `of_file` at what an experiment (a
    `config.experiment.Experiment`) needs beside; both change nothing.
    """

    examine: Callable[[], Iterable[Finding]] = tuple
    of_file: Callable[[Any], Iterable[Finding]] = _nothing


def of_others() -> Iterator[Finding]:
    """Each feature that somebody else has installed, and what of it cannot be loaded."""
    remedy = "mend its package, or uninstall it"
    known = features()
    for name, why in left_out().items():
        if name not in known:
            yield Finding("error", f"feature {name}", why, remedy)
    for name, feature in known.items():
        package = type(feature).__module__
        if package.startswith("woz_tui."):
            continue
        missing = [*feature.missing()]
        for what in missing:
            yield Finding("error", f"feature {name}", what, remedy)
        if not missing:
            yield Finding("ok", f"feature {name}", f"of the package {package.partition('.')[0]}")
