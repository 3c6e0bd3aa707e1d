"""What there is to say of every kind of robot that is installed, for whoever chooses one."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from woz_tui.config.bundled_files import robot_files
from woz_tui.config.experiment import DriverSpec
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.json_schema import sample_settings
from woz_tui.config.loading import load_robot
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import SHOWN, Driver, DriverFacts, Offer, PassiveDriver
from woz_tui.drivers.robot_verbs import COMMON_VERBS
from woz_tui.protocol.action_messages import EVIDENCE
from woz_tui.protocol.messages import Json

#: What is told of a robot beside its common verbs.
_FACTS = ("own verbs", "sensors", "stop", "tested", "simulated", "needs")

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class RobotDescription:
    """A driver's type with what it offers, or a robot file of a type that offers nothing without
    one; `files`: robot files that use it, by name.

    Verbs and sensors are those that it has without any setting; where it needs some, those of the
    first robot file, or of made-up settings (`sample`).
    """

    kind: str
    driver: type[Driver]
    offer: Offer
    files: tuple[str, ...] = ()
    sample: bool = False

    @property
    def declared(self) -> bool:
        """Whether robot files say what it offers, each something else."""
        return bool(self.files and not self.offer.verbs and not self.offer.sensors)

    @property
    def facts(self) -> DriverFacts:
        """What its class says of it."""
        return self.driver.facts

    @property
    def tested(self) -> str:
        """What its tests show with a device."""
        shown = (word for word in SHOWN if word in self.facts.shown)
        return ", ".join(shown) or "with no device"

    def facts_shown(self) -> Iterator[tuple[str, str]]:
        """Word and sentence of each thing to be told."""
        names = [verb.name for verb in self.offer.verbs]
        common = [name for name in COMMON_VERBS if name in names]
        own = [name for name in dict.fromkeys(names) if name not in COMMON_VERBS]
        nothing = "those of its robot file" if self.declared else "none"
        yield "verbs", ", ".join(common) or ("" if own else nothing)
        yield "own verbs", ", ".join(own)
        for kind in reversed(EVIDENCE):
            yield kind, ", ".join(verb.name for verb in self.offer.verbs if verb.evidence == kind)
        yield "sensors", ", ".join(self.offer.sensors) or nothing
        passive = issubclass(self.driver, PassiveDriver)
        yield "stop", self.facts.stop or ("nothing to stop" if passive else "not said")
        yield "tested", self.tested
        yield "simulated", self.facts.simulated or "no"
        yield "needs", self.facts.needs
        yield "files", ", ".join(self.files)
        yield "page", self.facts.page

    def as_json(self) -> dict[str, Json]:
        return {
            "summary": self.driver.summary,
            "robot": self.facts.robot,
            "verbs": [verb.name for verb in self.offer.verbs],
            "evidence": {verb.name: verb.evidence for verb in self.offer.verbs},
            "sensors": [*self.offer.sensors],
            "stop": self.facts.stop,
            "passive": issubclass(self.driver, PassiveDriver),
            "shown": [*self.facts.shown],
            "simulated": self.facts.simulated,
            "needs": self.facts.needs,
            "files": [*self.files],
            "page": self.facts.page,
        }


def descriptions(
    catalogue: Mapping[str, type[Driver]],
    folder: Path | None,
    tell: Callable[[str], object] = log.warning,
) -> dict[str, RobotDescription]:
    """All types, whole robots first; robot files are those that an experiment in `folder` finds.
    `tell` hears of drivers whose code fails.
    """
    used: dict[str, dict[str, DriverSpec]] = {}
    for name, file in robot_files(folder).items():
        with contextlib.suppress(ExperimentError):
            for spec in load_robot(file, catalogue):
                used.setdefault(spec.type, {}).setdefault(name, spec)
    found: list[RobotDescription] = []
    for name in sorted(catalogue):
        try:
            found += _described(name, catalogue[name], used.get(name, {}))
        except plugins.PluginError as error:
            tell(str(error))
        except Exception as error:  # noqa: BLE001 - a plug-in's code
            tell(f"the driver {name!r} fails: {error!r}")
    return {each.kind: each for each in sorted(found, key=lambda each: not each.facts.robot)}


def _described(
    name: str, driver: type[Driver], used: Mapping[str, DriverSpec]
) -> list[RobotDescription]:
    """Raises whatever the driver's code raises with made-up settings."""
    files = tuple(used)
    with contextlib.suppress(Exception):  # it needs settings; which, only its own code knows
        found = RobotDescription(name, driver, driver.offer(driver.Settings()), files)
        if not found.declared:
            return [found]
        own = [RobotDescription(file, driver, spec.offer, (file,)) for file, spec in used.items()]
        return [found, *own]
    if used:
        first = next(iter(used.values()))
        return [RobotDescription(name, driver, first.offer, files)]
    offered = driver.offer(sample_settings(driver.Settings))
    return [RobotDescription(name, driver, offered, files, sample=True)]


def markdown(catalogue: Mapping[str, type[Driver]]) -> str:
    """The whole robots as tables of Markdown: who offers which common verb, and the rest."""
    every = descriptions(catalogue, None).values()
    found = [each for each in every if each.facts.robot and not each.declared]
    offered = [{verb.name: verb.evidence for verb in each.offer.verbs} for each in found]
    verbs = [
        (f"`{verb}`", *(known.get(verb, "-") or "yes" for known in offered))
        for verb in COMMON_VERBS
        if any(verb in known for known in offered)
    ]
    rest = []
    for each in found:
        facts = dict(each.facts_shown())
        page = f"../../{each.facts.page}".replace("../../docs/how-to/", "")  # as seen from there
        name = f"[`{each.kind}`]({page})"
        rest.append((name, *(facts[word] or "-" for word in _FACTS)))
    return f"{_table(['verb', *(f'`{each.kind}`' for each in found)], verbs)}\n\n" + _table(
        ["robot", *_FACTS], rest
    )


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    lines = [f"| {' | '.join(row)} |" for row in (head, *rows)]
    return "\n".join([lines[0], "|---" * (lines[0].count(" | ") + 1) + "|", *lines[1:]])
