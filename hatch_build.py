"""What wheel and sdist say of themselves; called by hatchling when it builds them."""

from __future__ import annotations

import json
import re
import runpy
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface

#: A link or picture of Markdown that leads into the repository, or to a heading of the page.
_LINK = re.compile(r"(!?)\[([^]]*)\]\((?![a-z]+:)([^)]*)\)")


class IndexPage(MetadataHookInterface):
    """README.md as the package index shows it, where no path of the repository leads anywhere."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Write the page, with links to the repository if `project.urls` has its address."""
        root = Path(self.root)
        version = runpy.run_path(str(root / "woz_tui/__init__.py"))["__version__"]
        address = metadata.get("urls", {}).get("Repository", "")
        text = (root / "README.md").read_text(encoding="utf-8")
        shown = _LINK.sub(partial(_on_index, address and f"{address}/%s/v{version}/"), text)
        metadata["readme"] = {"content-type": "text/markdown", "text": shown}


def _on_index(place: str, link: re.Match[str]) -> str:
    """The link with the whole address, or else its words alone; without one there is no picture."""
    picture, words, path = link.groups()
    if path.startswith("#"):  # headings have no names there
        path = f"README.md{path}"
    if place:
        return f"{picture}[{words}]({place % ('raw' if picture else 'blob')}{path})"
    return "" if picture else words


class SourceHook(BuildHookInterface[Any]):
    """Of which commit a package is.

    An editable install asks git itself; an sdist, from which a wheel is made, has the file.
    """

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
