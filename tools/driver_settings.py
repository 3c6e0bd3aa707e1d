"""The tables of settings in the drivers' pages, out of the settings' annotations."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from tools import ROOT
from woz_tui.config.settings_table import settings_rows
from woz_tui.drivers.contract import Driver
from woz_tui.drivers.plugins import installed

DRIVERS = ROOT / "drivers" / "woz_drivers"
_TABLE = re.compile(r"^\| setting \|.*?\n(?!\|)", re.M | re.S)
_HEAD = "| setting | default | |\n|---|---|---|\n"


def bundled() -> dict[str, type[Driver]]:
    """Our own drivers, whatever else is installed on this machine."""
    catalogue = installed()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return {name: catalogue[name] for name in project["entry-points"]["woz_tui.drivers"]}


def pages() -> dict[str, Path]:
    """The page of each driver, by type."""
    return {name: DRIVERS / name.replace("-", "_") / "README.md" for name in bundled()}


def refreshed(name: str, text: str) -> str:
    """The page of a driver with the table of today."""
    rows = "".join(
        f"| `{setting}` | {default} | {meaning} |\n"
        for setting, default, meaning in settings_rows(installed()[name].Settings)
    )
    return _TABLE.sub(lambda _: _HEAD + rows, text, count=1)
