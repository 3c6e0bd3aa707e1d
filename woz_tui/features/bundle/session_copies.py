"""Copies of logs as they can be published, and what the researcher's own files say in them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec

from woz_tui.export.jsonl import LogCopy
from woz_tui.export.log_sources import LogSource, UniqueNames, shown_line
from woz_tui.export.output_folder import OutputFolder
from woz_tui.features.bundle.participant_codes import codes_in, recoded, words_in
from woz_tui.features.bundle.withheld_texts import WithheldTexts
from woz_tui.log.damage import Damage
from woz_tui.log.log_reader import LogLine
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import Questionnaire

_encoder = msgspec.json.Encoder()


@dataclass(frozen=True, slots=True)
class PlayedFile:
    """A version of the experiment as sessions played it: its files by name, itself first."""

    files: Mapping[str, str]
    left_out: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Of the experiment file."""
        return next(iter(self.files), "")

    @property
    def sha256(self) -> str:
        """Of its own text, as `sha256sum` says it."""
        return hashlib.sha256(self.files.get(self.name, "").encode()).hexdigest()


@dataclass(slots=True)
class StudyMaterials:
    """What the logs hold of the researcher's: files, plans, and the codes of who took part.

    Attributes:
        codes: Of participants.
        words: Names and short texts of the logs that are no codes.
        versions: Each version of the files, in the order in which they were played, with how many
            sessions began with it.
        plan: What the last session showed.
        plans: What the first session showed that was played with a version, by its hash.
        questionnaires: By name, each version of it in the order in which they were played.
    """

    codes: set[str] = field(default_factory=set)
    words: set[str] = field(default_factory=set)
    versions: dict[str, PlayedFile] = field(default_factory=dict)
    sessions: dict[str, int] = field(default_factory=dict)
    plan: m.SessionPlan | None = None
    plans: dict[str, m.SessionPlan] = field(default_factory=dict)
    questionnaires: dict[str, list[Questionnaire]] = field(default_factory=dict)

    def read(self, source: LogSource) -> None:
        """Add one session."""
        first, playing = True, ""
        for line in source.lines(Damage()):
            self.codes |= codes_in(line.fields)
            self.words.update(word for word in words_in(line.fields) if word.isalpha())
            match line.message:
                case m.ExperimentFiles(files=files, left_out=left_out) if files:
                    played = PlayedFile(files, tuple(left_out))
                    self.versions.setdefault(played.sha256, played)
                    count = self.sessions.get(played.sha256, 0)
                    self.sessions[played.sha256] = count + first
                    first, playing = False, played.sha256
                case m.SessionPlan(settings=settings) as plan:
                    self.plan = plan
                    self.plans.setdefault(playing, plan)
                    for each in settings.study.questionnaires:
                        known = self.questionnaires.setdefault(each.name, [])
                        if each not in known:
                            known.append(each)

    @property
    def last(self) -> PlayedFile | None:
        """The version that was played last."""
        return next(reversed(self.versions.values()), None)

    def asked(self) -> frozenset[str]:
        """Every text in which something was asked."""
        asked = [each for known in self.questionnaires.values() for each in known]
        texts = {text for each in asked for text in _texts(each)}
        if self.plan is not None:
            texts.add(self.plan.title)
        return frozenset(texts - {""})

    def own_texts(self) -> Iterator[str]:
        """All texts that are the researcher's own."""
        yield from self.asked()
        if self.plan is not None:
            study = self.plan.settings.study
            yield from _texts([study.by_condition, study.blind])
        for each in self.versions.values():
            yield from each.files
            yield from each.files.values()


def _texts(value: Any) -> Iterator[str]:
    match msgspec.to_builtins(value):
        case str() as text:
            yield text
        case dict() as table:
            for name, each in table.items():
                yield name
                yield from _texts(each)
        case list() | tuple() as items:
            for each in items:
                yield from _texts(each)


class PublishedLine:
    """Makes the published form of lines: redacted, without private answers, with the new `codes`
    if there are any; those of `public` may be words elsewhere. `withheld` collects what goes.
    """

    def __init__(
        self, codes: Mapping[str, str], withheld: WithheldTexts, public: Sequence[str] = ()
    ) -> None:
        self._codes = codes
        self._public = public
        self._withheld = withheld

    def __call__(self, line: LogLine) -> LogLine:
        fields = dict(shown_line(line, redact=True).fields)
        robot = line.fields.get("robot")
        if line.kind == "session.start" and isinstance(robot, str):
            fields["robot"] = robot.replace("\\", "/").rpartition("/")[2]
        if line.kind == "session.plan" and "title" in fields:
            fields["title"] = line.fields["title"]  # the experiment file's
        if self._codes:
            fields = recoded(fields, self._codes, self._public)
        if line.kind != "experiment.files":  # the researcher's, and in the materials
            self._withheld.add(line.fields, fields)
        if self._codes and line.kind == "session.start":
            fields["seed"] = 0  # whoever tries all codes with it finds the one of a shuffled order
        raw = _encoder.encode(fields)
        try:
            message = codec.decode_message(raw)
        except codec.WireError:
            message = None
        return LogLine(line.seq, line.t, "", line.kind, fields, raw, message)


def copy_sessions(
    sources: Iterable[LogSource], folder: OutputFolder, inside: str, published: PublishedLine
) -> list[tuple[LogSource, Path]]:
    """Write a copy of each log to `inside` the folder; each source with its copy."""
    names, copies = UniqueNames(), []
    for source in sources:
        name = names.unique(_name(source, published))
        place = f"{inside}/{name}.jsonl"
        actions, samples = folder.binary(place), folder.binary(f"{inside}/{name}.samples.jsonl")
        with actions, samples:
            copy = LogCopy(actions, samples, published, redacted=True)
            for line in source.everything(Damage()):
                copy.add(line)
        copies.append((source, folder.path / place))
    return copies


def _name(source: LogSource, published: PublishedLine) -> str:
    """Of whom and which session, without the day."""
    for line in source.lines(Damage()):
        fields: Mapping[str, Any] = published(line).fields
        words: Sequence[Any] = (fields.get("participant"), fields.get("session"))
        if line.kind in ("session.start", "session.changed") and fields.get("participant"):
            plain = ["".join(c for c in str(each) if c.isalnum()) for each in words if each]
            return "_".join(filter(None, plain)) or "session"
    return "session"
