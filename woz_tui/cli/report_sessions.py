"""Many sessions on the terminal: one table by participant and condition, one by condition."""

from __future__ import annotations

from woz_tui.analysis import report_tables as tables
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.participants import excluded_sentence
from woz_tui.analysis.text_format import counted
from woz_tui.cli.report_layout import ReportPage, fitted


def show(page: ReportPage, grouped: GroupedSessions) -> None:
    """Print the tables of all experiments."""
    for experiment in grouped.experiments:
        rows = grouped.of(experiment)
        people = len({row.participant for row in rows if row.participant and row.counted})
        size = counted(grouped.sessions_of(experiment), "session")
        size += f", {counted(people, 'participant')}"
        page.head(f"{experiment or 'experiment not recorded'}: {size}")
        versions = grouped.versions(experiment)
        if versions > 1:
            page.trouble(f"the experiment file had {versions} versions in these sessions")
        made = page.table(tables.condition_rows(rows))
        page.console.print(fitted(made, page.width)[0])  # those figures for which there is room
        left = excluded_sentence((row.participant, row.counted) for row in rows)
        if left:
            page.trouble(left)
        page.put(page.block(tables.condition_totals(grouped.totals(experiment))))
        page.put(page.block(tables.item_totals(grouped.items(experiment))))
    page.put(page.block(tables.trainings(grouped)))
    if grouped.reruns:
        page.say()
        page.trouble(f"re-runs are not counted as sessions: {', '.join(grouped.reruns)}")
    if grouped.damaged:
        page.head("Logs that are not whole")
    for who, sentences in grouped.damaged:
        page.trouble(f"{who}: {'; '.join(sentences)}")
