"""What repositories ask of a data set: README, LICENSE, CITATION.cff, metadata of Psych-DS, and the
list of what is still to be done.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from woz_tui import __version__
from woz_tui.analysis.csv_package import GUARDED
from woz_tui.config.about_file import About
from woz_tui.export.output_folder import SIGN, files_section

_CC = {
    "CC-BY-4.0": "https://creativecommons.org/licenses/by/4.0/",
    "CC0-1.0": "https://creativecommons.org/publicdomain/zero/1.0/",
    "CC-BY-SA-4.0": "https://creativecommons.org/licenses/by-sa/4.0/",
    "CC-BY-NC-4.0": "https://creativecommons.org/licenses/by-nc/4.0/",
}
_WITHHELD = (
    "Logs are redacted: what people said, typed or wrote was replaced by `[redacted]`, dates and "
    "sound were left out. What the experiment file asks and calls things stayed. "
)
_RECODED = (
    "Participants have codes that were drawn by chance for this bundle; there is no key to them "
    "in it."
)
_FOLDERS = """\
* `codebook.md`, `codebook.csv`: what each variable means, from the experiment file
* `data/`: tables (CSV); `data/logs/`: the redacted logs of which they are made
* `materials/`: the experiment and robot files as they were played; instruments in them keep the
  terms of their authors
* `documentation/`: methods text, criteria for studies with a wizard, preregistration and what was
  played otherwise, the same data as BIDS
* `analysis/`: scripts that read the tables in R, Python and SPSS
* `results/`: the report, and figures each with its table
* `MANIFEST.sha256`: `sha256sum -c MANIFEST.sha256` compares every file"""


def readme(
    title: str,
    about: About,
    *,
    recoded: bool,
    media: bool,
    transcripts: bool,
    files: Iterable[str],
) -> str:
    """The README; its first line is that of an export, so that `--force` may replace the folder."""
    parts = [
        f"{SIGN} {__version__}",
        f"## {title}",
        about.description,
        _by(about),
        _WITHHELD + (_RECODED if recoded else "Participants have the codes of the lab."),
        "Sound is here because participants agreed to it." if media else "",
        "What people said is in the table of transcripts, because participants agreed to it; what"
        " was done to it says documentation/transcripts.md."
        if transcripts
        else "",
        "## What is where",
        _FOLDERS,
        "## Reading the tables",
        f"CSV as in RFC 4180: UTF-8, commas, CR LF at the end of a row. An empty cell: there is no "
        f"such value. {GUARDED}",
        files_section(files),
    ]
    return "\n\n".join(filter(None, parts))


def _by(about: About) -> str:
    lines = [
        *(
            f"* {each.name}{f', {each.affiliation}' * bool(each.affiliation)}"
            for each in about.authors
        ),
        f"* Contact: {about.contact}" if about.contact else "",
        f"* Where and when: {', '.join(filter(None, (about.place, about.dates)))}"
        if about.place or about.dates
        else "",
        f"* Funding: {about.funding}" if about.funding else "",
        f"* Approved by: {', '.join(filter(None, (about.ethics.board, about.ethics.number)))}"
        if about.ethics.board or about.ethics.number
        else "",
        f"* Article: {about.article}" if about.article else "",
        f"* Preregistration: {about.preregistration}" if about.preregistration else "",
    ]
    return "\n".join(filter(None, lines))


def licence(about: About) -> str:
    """Who may do what: never one licence over everything."""
    if not about.licence:
        return (
            "No licence was chosen: all rights reserved until `licence` is in about.yaml and the"
            " bundle is made anew.\n"
        )
    address = _CC.get(about.licence, f"https://spdx.org/licenses/{about.licence}.html")
    owners = ", ".join(each.name for each in about.authors) or "the authors"
    return (
        f"data/, documentation/, results/, codebook: {about.licence}, {address}\n"
        f"    by {owners}\n"
        "analysis/: MIT, https://spdx.org/licenses/MIT.html\n"
        "materials/: instruments keep the terms of their authors; ask them before you pass their"
        " wording on\n"
    )


def citation(title: str, about: About) -> str | None:
    """CITATION.cff; None without authors, as the format wants one. A text of JSON is one of
    YAML, too.
    """
    if not about.authors:
        return None
    lines = [
        "cff-version: 1.2.0",
        "type: dataset",
        f"message: {_yaml('If you use these data, please cite them as below.')}",
        f"title: {_yaml(title)}",
        "authors:",
    ]
    for each in about.authors:
        given, _, family = each.name.rpartition(" ")
        lines.append(f"  - family-names: {_yaml(family)}")
        lines += [f"    given-names: {_yaml(given)}"] if given else []
        lines += [f"    affiliation: {_yaml(each.affiliation)}"] if each.affiliation else []
        lines += [f"    orcid: {_yaml(f'https://orcid.org/{each.orcid}')}"] if each.orcid else []
    lines += [f"abstract: {_yaml(about.description)}"] if about.description else []
    lines += [f"doi: {_yaml(_doi(about.identifier))}"] if _is_doi(about.identifier) else []
    lines += [f"license: {about.licence}"] if about.licence else []
    if about.keywords:
        lines += ["keywords:", *(f"  - {_yaml(word)}" for word in about.keywords)]
    return "\n".join(lines) + "\n"


def _yaml(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _doi(identifier: str) -> str:
    return identifier.removeprefix("https://doi.org/").removeprefix("doi:")


def _is_doi(identifier: str) -> bool:
    return _doi(identifier).startswith("10.")


def description(title: str, about: About, variables: Sequence[Mapping[str, Any]]) -> str:
    """dataset_description.json, as Psych-DS wants it: a Dataset of schema.org."""
    found = {
        "@context": "https://schema.org/",
        "@type": "Dataset",
        "name": title,
        "description": about.description
        or f"Sessions of an experiment in which a wizard played a robot: {title}.",
        "author": [*map(_person, about.authors)],
        "license": about.licence and f"https://spdx.org/licenses/{about.licence}.html",
        "keywords": [*about.keywords],
        "inLanguage": about.language,
        "identifier": about.identifier,
        "funder": about.funding,
        "citation": about.article,
        "locationCreated": about.place,
        "variableMeasured": [*variables],
    }
    said = {name: value for name, value in found.items() if value}
    return json.dumps(said, indent=2, ensure_ascii=False) + "\n"


def _person(each: Any) -> dict[str, str]:
    person = {"@type": "Person", "name": each.name}
    if each.orcid:
        person["@id"] = f"https://orcid.org/{each.orcid}"
    if each.affiliation:
        person["affiliation"] = each.affiliation
    return person


def to_do(missing: Iterable[tuple[str, str]], others: Iterable[str]) -> str:
    """TODO.md: what is missing, each with the remedy."""
    return "\n".join(_to_do([*missing], [*others])) + "\n"


def _to_do(missing: Sequence[tuple[str, str]], others: Sequence[str]) -> Iterator[str]:
    yield "# Still to be done"
    if missing:
        yield from ("", "Missing in about.yaml:", "")
        yield from (f"- [ ] `{name}`: {doc}" for name, doc in missing)
    if others:
        yield from ("", "Besides:", "")
        yield from (f"- [ ] {each}" for each in others)
