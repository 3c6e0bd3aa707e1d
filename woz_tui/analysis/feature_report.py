"""Tables, tiles and pictures of features in reports and exports."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

from woz_tui.analysis.feature_figures import ApartSession
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.report_table import ReportTable
from woz_tui.analysis.tables import FIGURES, TableDefinition
from woz_tui.feature import pieces
from woz_tui.timeline.episodes import CommandEpisode


class FigureTile(NamedTuple):
    """A figure in large on the page of a session."""

    title: str
    value: str
    more: str


@dataclass(frozen=True, slots=True)
class CommandPicture:
    """How a command is drawn over time: its label, and names and values of what it consists of."""

    label: str
    facts: Sequence[tuple[str, str]] = ()


@dataclass(frozen=True, slots=True)
class BehaviourTable:
    """Rows of a participant that BIDS has in a `_beh.tsv`: columns of a table, in this order.
    `levels`: what the values in a column mean, of these rows of a session.
    """

    table: TableDefinition[Any]
    columns: Sequence[str]
    levels: Callable[[SessionFigures, Sequence[Any]], Mapping[str, Mapping[str, str]]]


class GatheredTables:
    """Tables whose columns or rows are known when all sessions are."""

    def add(self, figures: SessionFigures) -> None:
        """Add a session."""

    def tables(self) -> Iterator[tuple[TableDefinition[Any], Sequence[Any]]]:
        """Each with its rows; their cells need no session any more."""
        yield from ()


class FeatureReport:
    """What a feature has in reports. Figures are those of its `FeatureFigures`.

    Attributes:
        tables: Its files among those of `woz report --csv` and `woz export`.
        about: A line on each of them for the README of an export.
        behaviour: What BIDS has of a participant's behaviour.
    """

    tables: ClassVar[tuple[TableDefinition[Any], ...]] = ()
    about: ClassVar[tuple[str, ...]] = ()
    behaviour: ClassVar[BehaviourTable | None] = None

    def gathered(self) -> GatheredTables | None:
        """Its tables that depend on all sessions, before the first; None: there are none."""
        return None

    def apart(self, sessions: Sequence[ApartSession]) -> ReportTable | None:
        """The table of its sessions in which nobody took part."""
        return None

    def session_tables(self, figures: Any) -> Iterator[ReportTable]:
        """What the report of a session shows."""
        yield from ()

    def tiles(self, figures: Any) -> Iterator[FigureTile]:
        """What the page of a session shows in large."""
        yield from ()

    def picture(self, command: CommandEpisode) -> CommandPicture | None:
        """How a command of the feature's performer is drawn; None: by its verb."""
        return None


def reports() -> Iterable[FeatureReport]:
    """Of all features."""
    return pieces("report", FeatureReport).values()


def figure_tables() -> tuple[TableDefinition[Any], ...]:
    """What is computed of a session's timeline, that of features included."""
    return (*FIGURES, *(table for each in reports() for table in each.tables))


def apart_tables(grouped: GroupedSessions) -> Iterator[ReportTable]:
    """Tables of sessions in which nobody took part."""
    for name, report in pieces("report", FeatureReport).items():
        table = report.apart(grouped.apart.get(name, ()))
        if table is not None:
            yield table


def feature_tables(figures: SessionFigures) -> Iterator[ReportTable]:
    """What features show of a session."""
    for name, report in pieces("report", FeatureReport).items():
        if name in figures.features:
            yield from report.session_tables(figures.features[name])


def feature_tiles(figures: SessionFigures) -> Iterator[FigureTile]:
    """What features show in large of a session."""
    for name, report in pieces("report", FeatureReport).items():
        if name in figures.features:
            yield from report.tiles(figures.features[name])
