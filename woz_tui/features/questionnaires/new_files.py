"""Questionnaires that come with woz-tui, as files to copy: instruments and templates of some."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import yaml

from woz_tui.cli.new_files import CopiedFile, FeatureFiles
from woz_tui.features.questionnaires.to_fill import TO_FILL

FOLDER = Path(__file__).with_name("instruments")


class InstrumentFiles(FeatureFiles):
    """Those with wording first, then templates, whose wording is their authors' alone."""

    flag = "--questionnaire"
    what = "questionnaire"
    help = "copy a questionnaire instead; without a name list them, with their terms"

    def files(self) -> Sequence[CopiedFile]:
        found = [_file(path) for path in sorted(FOLDER.glob("*.yaml"))]
        return sorted(found, key=_is_template)


INSTRUMENTS = InstrumentFiles()


def _is_template(file: CopiedFile) -> bool:
    return file.about.startswith(_TEMPLATE)


_TEMPLATE = "template"


def _file(path: Path) -> CopiedFile:
    text = path.read_text(encoding="utf-8")
    read: Mapping[str, object] = yaml.safe_load(text)
    items, source = read["items"], read["instrument"]
    assert isinstance(items, list)
    assert isinstance(source, Mapping)
    count = text.partition("\ninstrument:")[2].count(TO_FILL)
    about = f"{len([each for each in items if 'page' not in each])} items. {source['terms']}"
    then = ["Name it in the experiment: questionnaires: [{file: {file}, when: end}]"]
    then.append(f"Terms: {source['terms']}.")
    if "link" in source:
        then.append(f"Cite: {source['citation']}.")
    if count:
        about = f"{_TEMPLATE}, {about}"
        then.append(f"Its wording is missing: {count} times {TO_FILL}. Get it at {source['link']}")
    return CopiedFile(path, about, then)
