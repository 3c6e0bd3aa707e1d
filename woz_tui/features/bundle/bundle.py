"""Writes the folder: first the published copies of the logs, then everything else out of them, so
that nothing can stand in it that was withheld from the copies.
"""

from __future__ import annotations

import csv
import hashlib
import json
import re
import shutil
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path

from woz_tui.analysis.figure_files import write_figures
from woz_tui.analysis.html.report_page import writing
from woz_tui.analysis.methods_section import paragraphs
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.session_reading import ReportExtras, read_report
from woz_tui.analysis.study_figures import Studies
from woz_tui.config.about_file import About, missing_in
from woz_tui.export.export_run import export
from woz_tui.export.exporter import ExportOptions
from woz_tui.export.log_sources import LogSource, UniqueNames, read_session
from woz_tui.export.output_folder import README, OutputFolder, new_folder
from woz_tui.features.bundle import (
    codebook,
    deposit_texts,
    preregistration,
    reading_scripts,
    riek,
    transcripts,
)
from woz_tui.features.bundle.codebook import Variable, items_of
from woz_tui.features.bundle.data_tables import (
    DataTables,
    columns_of,
    table_file,
    variables_measured,
)
from woz_tui.features.bundle.participant_codes import SHORTEST, drawn_codes
from woz_tui.features.bundle.registered_study import registered_study
from woz_tui.features.bundle.session_copies import (
    PlayedFile,
    PublishedLine,
    StudyMaterials,
    copy_sessions,
)
from woz_tui.features.bundle.transcripts import TRANSCRIPTS
from woz_tui.features.bundle.withheld_texts import WithheldTexts, words_among
from woz_tui.log.file_names import media_folder
from woz_tui.log.log_reader import files_of
from woz_tui.log.withdrawals import withdrawn_codes
from woz_tui.sensing.visitor_records import VisitorFileError
from woz_tui.system.text_cleaning import cell

MANIFEST, TODO = "MANIFEST.sha256", "TODO.md"
_LOGS = "data/logs"
_MEDIA = "data/media"
#: What is made of the researcher's files, which may name codes (`P01 ... P99`).
_OWN = ("materials/", "documentation/preregistration.md", "documentation/deviations.md")


class BundleError(Exception):
    """The bundle cannot be made; `remedy` says what to do."""

    def __init__(self, what: str, remedy: str) -> None:
        super().__init__(f"{what} ({remedy})")
        self.what = what
        self.remedy = remedy


@dataclass(frozen=True, slots=True, kw_only=True)
class BundleOptions:
    """What a bundle is to have.

    Attributes:
        about: What no log knows.
        registered: The experiment file as it was registered; None: as it was played first.
        recode: Draw new codes for participants.
        media: Sound and pictures, too.
        transcripts: What people said, too, without these `names` and those of visitors.
        samples: Values of sensors as a table, too.
        public: Texts that may stand in it although they were withheld.
    """

    about: About
    registered: Path | None = None
    recode: bool = False
    media: bool = False
    transcripts: bool = False
    names: Sequence[str] = ()
    samples: bool = False
    public: Sequence[str] = ()


@dataclass(slots=True)
class BundleResult:
    """What was written: `missing` sentences are in its list of what is to be done."""

    sessions: int = 0
    participants: int = 0
    files: int = 0
    missing: list[str] = field(default_factory=list)


def write_bundle(
    sources: Sequence[LogSource], out: Path, options: BundleOptions, *, force: bool = False
) -> BundleResult:
    """Write the new folder `out`, in whole or not at all.

    Raises:
        BundleError: It may not be made so.
        ExportError: `out` is in the way.
        OSError: Something cannot be read or written.
    """
    if options.media and "media" not in options.about.share:
        raise BundleError(
            "sound and pictures may be shared only if participants agreed",
            "write share: [media] into about.yaml, or leave --media out",
        )
    if options.transcripts and "transcripts" not in options.about.share:
        raise BundleError(
            "what people said may be shared only if participants agreed",
            "write share: [transcripts] into about.yaml, or leave --with transcripts out",
        )
    for source in sources:
        if any(path.resolve().is_relative_to(out.resolve()) for path in source.files.paths):
            raise BundleError(f"{source.log.name} lies in {out} itself", "name another with --out")
    materials = StudyMaterials()
    for source in sources:
        materials.read(source)
    if options.recode:
        _refuse_words(materials, options.public)
    with new_folder(out, force=force) as folder:
        return _Bundle(folder, options, materials).write(sources)


def _refuse_words(materials: StudyMaterials, public: Sequence[str]) -> None:
    """Of codes that are words, too, nobody could say where they stand for a participant."""
    codes = [code for code in materials.codes if len(code) >= SHORTEST and code not in public]
    for code in words_among(codes, materials.words)[:1]:
        raise BundleError(
            f"nothing was written: the participant's code {code!r} is a word of logs, tables or"
            " pages, too, and nobody could tell whether it is a code there",
            f"with --public {code} it is drawn anew where a code stands, and stays a word elsewhere"
            "; or leave --recode out",
        )


def _name_of_copy(copied: tuple[LogSource, Path]) -> str:
    return copied[1].name


class _Bundle:
    def __init__(
        self, folder: OutputFolder, options: BundleOptions, materials: StudyMaterials
    ) -> None:
        self._folder = folder
        self._options = options
        self._about = options.about
        self._materials = materials
        self._codes = drawn_codes(materials.codes) if options.recode else {}
        public = options.public
        self._withheld = WithheldTexts(
            codes=frozenset(
                code for code in self._codes if len(code) >= SHORTEST and code not in public
            )
        )
        versions = materials.questionnaires.values()
        self._items: list[Variable] = items_of(each for known in versions for each in known)
        title = materials.plan.title if materials.plan is not None else ""
        self._title = self._about.title or title or "Sessions with a wizard"
        self._study = re.sub(r"[^A-Za-z0-9]", "", self._title)[:40] or "woz"
        self._to_do: list[str] = []

    def write(self, sources: Sequence[LogSource]) -> BundleResult:
        published = PublishedLine(self._codes, self._withheld, self._options.public)
        copies = copy_sessions(sources, self._folder, _LOGS, published)
        if self._codes:  # the order of days would lead from new codes to old ones
            copies.sort(key=_name_of_copy)
        self._copy_media(copies)
        logs = [LogSource(files_of(copy, [])) for _, copy in copies]
        self._tables(logs, [source for source, _ in copies])
        self._bids(logs)
        self._results(logs, sources)
        self._materials_files()
        self._preregistration()
        self._scripts()
        self._rest()
        self._refuse_withheld()
        self._manifest()
        missing = [f"about.yaml: {name} ({doc})" for name, doc in missing_in(self._about)]
        return BundleResult(
            len(sources),
            len(self._materials.codes),
            len(self._folder.names()),
            [*missing, *self._to_do],
        )

    def _copy_media(self, copies: Sequence[tuple[LogSource, Path]]) -> None:
        """Names of files are numbers: those of the recorder have no code, but others might."""
        if not self._options.media:
            return
        for source, copy in copies:
            place = media_folder(source.log)
            found = sorted(path for path in place.rglob("*") if path.is_file())
            for number, path in enumerate(found, 1):
                name = f"{_MEDIA}/{copy.stem}/{number:04}{path.suffix.lower()}"
                with path.open("rb") as original, self._folder.binary(name) as written:
                    shutil.copyfileobj(original, written)

    def _tables(self, logs: Sequence[LogSource], originals: Sequence[LogSource]) -> None:
        tables = DataTables(self._folder, self._study, self._items, self._options.samples)
        with closing(tables):
            sessions = []
            for source in logs:
                session = read_session(source)
                session.figures = replace(session.figures, stem=session.name)
                sessions.append(session.figures.session)
                tables.add(session, source)
            package = tables.finish()
        if self._options.transcripts:
            self._transcripts(originals, sessions)
            about = "What people said, as a program understood it; names that were known are out."
            told = tables.resource(TRANSCRIPTS, about, transcripts.COLUMNS)
            package = {**package, "resources": [*package["resources"], told]}
        package = {**package, "title": self._title}
        if self._about.licence:
            package["licenses"] = [{"name": self._about.licence}]
        variables = [*self._items, *columns_of(package)]
        self._write("datapackage.json", json.dumps(package, indent=2, ensure_ascii=False) + "\n")
        self._write("codebook.csv", codebook.as_csv(variables))
        self._write("codebook.md", codebook.as_markdown(variables))
        measured = variables_measured(package)
        self._write(
            "dataset_description.json",
            deposit_texts.description(self._title, self._about, measured),
        )

    def _transcripts(self, originals: Sequence[LogSource], sessions: Sequence[str]) -> None:
        folders = {folder for each in originals for folder in each.folders}
        try:
            visitors = [*transcripts.visitors_named(folders)]
        except VisitorFileError as error:
            raise BundleError(str(error), "names of visitors could not be taken out") from error
        names, count = transcripts.KnownNames([*self._options.names, *visitors]), 0
        with self._folder.text(table_file(self._study, TRANSCRIPTS)) as file:
            writer = csv.writer(file, lineterminator="\r\n")
            writer.writerow([each.name for each in transcripts.COLUMNS])
            for source, session in zip(originals, sessions, strict=True):
                for row in transcripts.transcript(source, names, self._codes, session):
                    writer.writerow([cell(value) for value in row])
                    count += 1
        self._write("documentation/transcripts.md", transcripts.as_markdown(names, count))
        if not self._options.names:
            self._to_do.append(
                "transcripts: no list of names was given (--names FILE); only those of visitors"
                " were taken out"
            )

    def _bids(self, logs: Sequence[LogSource]) -> None:
        out = self._folder.path / "documentation" / "bids"
        for _ in export(logs, "bids", out, ExportOptions(redact=True, sound=False)):
            pass
        place = out / "dataset_description.json"
        described = json.loads(place.read_text(encoding="utf-8")) | {"Name": self._title}
        if self._about.authors:
            described["Authors"] = [each.name for each in self._about.authors]
        if self._about.licence:
            described["License"] = self._about.licence
        place.write_text(json.dumps(described, indent=2, ensure_ascii=False) + "\n", "utf-8")

    def _results(self, logs: Sequence[LogSource], sources: Sequence[LogSource]) -> None:
        """The report, figures, and the texts that are made of the same facts."""
        grouped, studies, folder = GroupedSessions(), Studies(), self._folder.path / "results"
        folder.mkdir(mode=0o700)
        extras = ReportExtras(timeline=True)
        page_path = folder / "report.html"
        with writing(page_path, grouped, len(logs)) as page:
            for source in logs:
                report = read_report(source.log, extras=extras, places=[])
                grouped.add(report.figures)
                studies.add(report.figures)
                page.add(report)
        write_figures(folder / "figures", grouped)
        found = next(iter(studies.found.values()), None)
        told = paragraphs(found, self._about) if found is not None else []
        if len(studies.found) > 1:
            self._to_do.append(
                "these are sessions of several experiments: make a bundle for each, since the"
                " methods text is of the first"
            )
        text = "".join(f"\n## {each.head}\n\n{' '.join(each.sentences)}\n" for each in told)
        self._write("documentation/methods.md", f"# Method\n{text}")
        criteria = riek.criteria(told, self._about, self._materials.plan)
        self._write("documentation/riek.csv", riek.as_csv(criteria))
        self._write("documentation/riek.md", riek.as_markdown(criteria))
        withdrew = len(withdrawn_codes({folder for each in sources for folder in each.folders}))
        if withdrew:
            words = f"{withdrew} withdrew; nothing of them is here.\n"
            self._write("documentation/withdrawals.md", words)

    def _materials_files(self) -> None:
        names = UniqueNames()
        for number, version in enumerate(reversed(self._materials.versions.values())):
            inside = "materials" if not number else f"materials/versions/{version.sha256[:8]}"
            for name, text in version.files.items():
                place = names.unique(f"{inside}/{_safe(name)}")
                self._write(place, text)
            for name in version.left_out:
                self._to_do.append(f"materials: {_safe(name)} was too large for the log; add it")
        if not self._materials.versions:
            self._to_do.append("materials: no log has the experiment file; add it")

    def _registered(self) -> PlayedFile | None:
        path = self._options.registered
        if path is not None:
            return PlayedFile({path.name: path.read_text(encoding="utf-8")})
        return next(iter(self._materials.versions.values()), None)

    def _preregistration(self) -> None:
        registered = self._registered()
        if registered is None:
            return
        plan = self._materials.plans.get(registered.sha256, self._materials.plan)
        study = registered_study(registered, self._options.registered, plan)
        text = preregistration.preregistration(registered, study, self._about)
        self._write("documentation/preregistration.md", text)
        if preregistration.GAP in text:
            self._to_do.append(f"documentation/preregistration.md: fill in {preregistration.GAP}")
        versions = self._materials.versions.values()
        changes = preregistration.deviations(registered, versions, self._materials.sessions)
        self._write("documentation/deviations.md", changes)

    def _scripts(self) -> None:
        self._write("analysis/read.py", reading_scripts.python_script(self._study, self._items))
        self._write("analysis/read.R", reading_scripts.r_script(self._study, self._items))
        self._write("analysis/read.sps", reading_scripts.spss_script(self._study, self._items))

    def _rest(self) -> None:
        self._write("LICENSE", deposit_texts.licence(self._about))
        self._write("CHANGES.md", "# Changes\n\n1. First deposit.\n")
        if cited := deposit_texts.citation(self._title, self._about):
            self._write("CITATION.cff", cited)
        missing = missing_in(self._about)
        if missing or self._to_do:
            self._write(TODO, deposit_texts.to_do(missing, self._to_do))
        text = deposit_texts.readme(
            self._title,
            self._about,
            recoded=bool(self._codes),
            media=self._options.media,
            transcripts=self._options.transcripts,
            files=[README, MANIFEST, *self._folder.names()],
        )
        self._write(README, text)

    def _refuse_withheld(self) -> None:
        known = [*self._materials.own_texts(), *self._options.public, *self._about_texts()]
        chosen = table_file(self._study, TRANSCRIPTS) if self._options.transcripts else ""
        found = self._withheld.found_in(self._folder.path, known, chosen)
        found += self._withheld.codes_in(self._folder.path, _OWN)
        if found:
            places = "\n".join(f"  {name}: {text}" for name, text in found[:10])
            raise BundleError(
                f"nothing was written: texts that were withheld stand in it:\n{places}\n",
                "if one of them is nobody's word, allow it with --public TEXT",
            )

    def _about_texts(self) -> Iterator[str]:
        yield deposit_texts.description(self._title, self._about, [])
        yield deposit_texts.readme(
            self._title, self._about, recoded=True, media=True, transcripts=True, files=[]
        )
        yield riek.as_markdown(riek.criteria([], self._about, None))

    def _manifest(self) -> None:
        lines = []
        for name in sorted(self._folder.names()):
            with (self._folder.path / name).open("rb") as file:
                lines.append(f"{hashlib.file_digest(file, 'sha256').hexdigest()}  {name}\n")
        self._write(MANIFEST, "".join(lines))

    def _write(self, name: str, text: str) -> None:
        self._folder.write(name, text)


def _safe(name: str) -> str:
    """A name inside the folder. What lies elsewhere than the experiment is named by its own folder
    alone, as `robots/simulated.yaml`: the rest tells of the lab's computer.
    """
    parts = name.replace("\\", "/").split("/")
    inside = [part for part in parts if part not in ("", ".", "..", "~")]
    elsewhere = parts[0] in ("", "..", "~") or parts[0].endswith(":")
    return "/".join(inside[-2:] if elsewhere else inside) or "file"
