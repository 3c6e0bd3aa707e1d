"""Writes every file that comes from the code: pages, their tables, schemas, the states' diagram.

    python -m tools.generated

A test compares each with what the code gives today.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from tools import (
    ROOT,
    completions,
    driver_settings,
    emotion_sounds,
    engagement_diagram,
    experiment_reference,
    keymap_reference,
    log_reference,
    modes_page,
    pepper_coverage,
    protocol_reference,
    redaction_lists,
    replaced,
    screen_sentences,
    tables_reference,
    toolkit_coverage,
)
from tools.driver_settings import bundled
from woz_tui.cli import completion
from woz_tui.cli.safe_streams import json_text
from woz_tui.config import robot_descriptions
from woz_tui.config.json_schema import experiment_schema, included_schema, robot_schema
from woz_tui.motion.move_schema import move_schema
from woz_tui.motion.render_target import inputs_table


def _schema(make: Callable[[], Mapping[str, Any]], _: str) -> str:
    return f"{json_text(make(), indent=2)}\n"


def _completion(shell: str, _: str) -> str:
    return completions.script(shell)


#: Path in the repository -> what gives the file's text, from the text it has.
FILES: Mapping[str, Callable[[str], str]] = {
    "docs/explanation/engagement.md": engagement_diagram.refreshed,
    "docs/how-to/emotion-sounds.md": emotion_sounds.refreshed,
    "docs/how-to/keymap.md": keymap_reference.refreshed,
    "docs/how-to/render.md": lambda page: replaced(page, "inputs", inputs_table()),
    "docs/how-to/robots.md": lambda page: replaced(
        page, "robots", robot_descriptions.markdown(bundled())
    ),
    "docs/images/engagement-states.svg": lambda _: engagement_diagram.svg(),
    "docs/reference/experiment-file.md": lambda _: experiment_reference.page(),
    "woz_tui/languages/screen/en.yaml": screen_sentences.english_file,
    "docs/reference/modes.md": lambda _: f"{modes_page.markdown()}\n",
    "docs/reference/pepper-coverage.md": lambda _: pepper_coverage.page(),
    "docs/reference/protocol-fields.md": lambda _: protocol_reference.page(),
    "docs/reference/protocol.schema.json": partial(_schema, protocol_reference.schema),
    "docs/reference/redaction.md": redaction_lists.refreshed,
    "docs/reference/session-log.md": log_reference.refreshed,
    "docs/reference/tables.md": tables_reference.refreshed,
    "docs/reference/toolkit-coverage.md": lambda _: toolkit_coverage.page(),
    "experiments/schema/experiment.schema.json": partial(
        _schema, lambda: experiment_schema(bundled())
    ),
    "experiments/schema/midi.schema.json": partial(
        _schema, lambda: included_schema(bundled()["midi"], "map")
    ),
    "experiments/schema/move.schema.json": partial(_schema, move_schema),
    "experiments/schema/robot.schema.json": partial(_schema, lambda: robot_schema(bundled())),
    **{
        str((completion.FOLDER / f"woz.{shell}").relative_to(ROOT)): partial(_completion, shell)
        for shell in completion.SHELLS
    },
    **{
        str(path.relative_to(ROOT)): partial(driver_settings.refreshed, name)
        for name, path in driver_settings.pages().items()
    },
}


def text_of(path: str) -> str:
    """The file's text now; empty if there is none yet."""
    file = ROOT / path
    return file.read_text(encoding="utf-8") if file.exists() else ""


if __name__ == "__main__":
    for name, refreshed in FILES.items():
        (ROOT / name).write_text(refreshed(text_of(name)), encoding="utf-8")
