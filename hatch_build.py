"""Writes into wheel and sdist of which commit they are; called by hatchling when it builds them."""

from __future__ import annotations

import json
import runpy
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class SourceHook(BuildHookInterface[Any]):
    """An editable install asks git itself; an sdist, from which a wheel is made, has the file."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the file, if git knows the commit."""
        root = Path(self.root)
        provenance = runpy.run_path(str(root / "woz_tui/system/provenance.py"))
        inside = f"woz_tui/{provenance['SOURCE_FILE']}"
        found = provenance["source"]()
        if version == "editable" or not found or (root / inside).exists():
            return
        self._made = tempfile.TemporaryDirectory()
        file = Path(self._made.name) / "source.json"
        file.write_text(json.dumps(found), encoding="utf-8")
        build_data["force_include"][str(file)] = inside
