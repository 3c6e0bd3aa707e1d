"""The section `questionnaires`: what is asked, and when.

questionnaires:
  - title: How was the robot?
    when: end                               # end, trial, condition or hand
    scale: {low: 1, high: 7, ends: [not at all, very much]}
    items:
      - {name: pleasant, question: "How pleasant was it?"}
      - The robot understood me             # its name: the-robot-understood-me
      - {question: "Anything else?", text: true, optional: true}
"""

from __future__ import annotations

import string
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import msgspec

from woz_tui.config.annotated_decoder import read_entries
from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents, FileSurroundings
from woz_tui.config.languages import DEFAULT, Language
from woz_tui.config.reload_changes import changed_entries, section_changed
from woz_tui.config.yaml_cursor import Cursor, check_different, missing, read_filled
from woz_tui.drivers.contract import KEPT
from woz_tui.drivers.fields import Doc, Entry, NotBlank, NotEmpty, OneOf, ReadApart
from woz_tui.features.questionnaires.due import SUSPICION, WHENS
from woz_tui.features.questionnaires.item_entries import (
    NAME_PATTERN,
    ItemDefaults,
    ItemEntry,
    NameOfEntry,
    RequiredOfEntry,
    Scale,
    ScaleOfEntry,
    Text,
    in_words,
    languages_of,
    read_items,
    read_name,
    read_scale,
)
from woz_tui.features.questionnaires.questionnaire_files import QuestionnaireFiles
from woz_tui.features.questionnaires.score_entries import ScoreEntry, read_scores
from woz_tui.protocol.sentence import Sentence
from woz_tui.protocol.welcome import (
    ENGLISH,
    Questionnaire,
    QuestionnaireVersion,
    QuestionnaireWords,
)


@dataclass(frozen=True, slots=True)
class InstrumentEntry(Entry):
    """Where a questionnaire comes from."""

    what = Sentence("questionnaires.a_source", "the source of a questionnaire")
    example = "{citation: ..., terms: ...}"
    citation: Annotated[str, NotBlank(), Doc("as a paper names it")]
    link: Annotated[str, NotBlank(), Doc("where it is found")] = ""
    terms: Annotated[str, NotBlank(), Doc("under which terms its wording stands")] = ""
    read: Annotated[str, NotBlank(), Doc("what was read of these terms, and when")] = ""


@dataclass(frozen=True, slots=True)
class QuestionnaireEntry(Entry):
    """A questionnaire as a file gives it."""

    what = Sentence("questionnaires.a_questionnaire", "a questionnaire")
    example = "{title: ..., items: [...]}"
    either = ("title", "name", "file")
    file: Annotated[
        str,
        NotBlank(),
        Doc("a file with the rest (`woz new --questionnaire` copies some); what stands here holds"),
    ] = ""
    items: Annotated[
        Any, ReadApart(tuple[ItemEntry | str, ...]), NotEmpty(), Doc("questions, in this order")
    ] = ()
    name: NameOfEntry = ""
    title: Annotated[Text, NotBlank(), Doc("title")] = ""
    when: Annotated[
        str,
        OneOf(WHENS),
        Doc(
            "at the start or the end, after each trial or condition, or only when the wizard starts"
            " it"
        ),
    ] = "end"
    introduction: Annotated[Text, NotBlank(), Doc("introduction before the first item")] = ""
    stem: Annotated[Text, NotBlank(), Doc("how each question on a scale begins")] = ""
    scale: ScaleOfEntry = None
    order: Annotated[
        str, OneOf(("given", "shuffled")), Doc("whether chance decides the order of the items")
    ] = "given"
    required: RequiredOfEntry = None
    scores: Annotated[
        Any, ReadApart(dict[str, ScoreEntry]), Doc("what several items amount to, by name")
    ] = None
    role: Annotated[
        str,
        OneOf((SUSPICION,)),
        Doc("a suspicion check: the last one that is asked, and of no condition"),
    ] = ""
    instrument: Annotated[InstrumentEntry | None, Doc("where it comes from")] = None


@dataclass(frozen=True, kw_only=True)
class QuestionnaireKeys:
    """The key `questionnaires`."""

    questionnaires: Annotated[
        tuple[Questionnaire, ...],
        ReadApart(tuple[QuestionnaireEntry, ...]),
        Doc("what the participant is asked"),
    ] = ()


@dataclass(frozen=True, slots=True)
class Asked:
    """What participants are asked, and the words in which the console speaks to them."""

    questionnaires: tuple[Questionnaire, ...] = ()
    words: QuestionnaireWords = ENGLISH


# -- the section -----------------------------------------------------------------------------------

_WHENS = {
    "start": "before the first trial",
    "end": "at the end",
    "trial": "after each trial",
    "condition": "after each condition",
    "hand": "when the wizard starts it",
}


class QuestionnaireSection(FeatureSection[Asked]):
    """What the file asks of participants, and in which words."""

    def begin(self, around: FileSurroundings) -> QuestionnaireReader:
        return QuestionnaireReader(around)

    def read(self, table: Mapping[str, Cursor], file: Any, contents: FileContents) -> Asked:
        cursor = table.get("questionnaires")
        if "design" not in table:
            _without_a_design(cursor)
        return Asked(
            read_questionnaires(cursor, contents.language.code), read_words(contents.language)
        )

    def trained(self, section: Asked) -> Asked:
        """Nobody is there to be asked."""
        return Asked(words=section.words)

    def changes(self, old: Asked, new: Asked) -> Iterable[str]:
        if old.words != new.words:
            yield section_changed("words")
        before, after = ({one.name: one for one in each.questionnaires} for each in (old, new))
        yield from changed_entries(
            Sentence("reload.a_questionnaire", "questionnaire"), before, after
        )

    def study(self, section: Asked) -> Mapping[str, Any]:
        return {"questionnaires": [*section.questionnaires], "words": section.words}

    def schemas(self) -> Mapping[str, Any]:
        return {"name": {"type": "string", "pattern": f"^{NAME_PATTERN.pattern}$"}}

    def people_data(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        for each in self.of(experiment).questionnaires:
            private = [item.name for item in each.items if item.private]
            apart = f"; in no export unless asked for: {', '.join(private)}" if private else ""
            yield KEPT, f"answers to {each.name}, in the log{apart}"

    def summary(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        return ((each.name, _in_words(each)) for each in self.of(experiment).questionnaires)


QUESTIONNAIRES = QuestionnaireSection(QuestionnaireKeys, Asked())


class QuestionnaireReader(QuestionnaireSection):
    """Reads one experiment, with the files that it names."""

    def __init__(self, around: FileSurroundings) -> None:
        super().__init__(QuestionnaireKeys, Asked())
        self._files = QuestionnaireFiles(around)

    def read(self, table: Mapping[str, Cursor], file: Any, contents: FileContents) -> Asked:
        filled = self._files.filled(table.get("questionnaires"))
        return super().read(
            table if filled is None else {**table, "questionnaires": filled}, file, contents
        )


def _in_words(questionnaire: Questionnaire) -> str:
    asked = [item for item in questionnaire.items if item.asks != "page"]
    scales = dict.fromkeys(f"{i.low} to {i.high}" for i in asked if i.asks == "scale")
    texts = sum(item.text for item in asked)
    parts = [f"{_WHENS[questionnaire.when]}: {len(asked)} item{'' if len(asked) == 1 else 's'}"]
    parts += [f"scales {' and '.join(scales)}"] if scales else []
    for kind in dict.fromkeys(i.asks for i in asked if i.asks not in ("scale", "text")):
        count = sum(item.asks == kind for item in asked)
        parts.append(f"{count} {_KINDS[kind][count > 1]}")
    parts += [f"{texts} in words"] if texts else []
    parts += ["shuffled"] if questionnaire.shuffled else []
    if questionnaire.scores:
        names = ", ".join(score.name for score in questionnaire.scores)
        parts.append(f"score{'' if len(questionnaire.scores) == 1 else 's'} {names}")
    if questionnaire.versions:
        codes = [questionnaire.language, *(each.language for each in questionnaire.versions)]
        parts.append(f"in {', '.join(codes)}")
    return ", ".join(parts)


#: One item of a kind, and more of them.
_KINDS = {
    "slider": ("slider", "sliders"),
    "number": ("number", "numbers"),
    "choice": ("choice", "choices"),
    "choices": ("choice of several", "choices of several"),
    "month": ("month", "months"),
}


# -- reading ---------------------------------------------------------------------------------------


def read_questionnaires(cursor: Cursor | None, code: str = DEFAULT) -> tuple[Questionnaire, ...]:
    """All questionnaires; what is wrong with them has been reported. `code`: the language of the
    experiment.
    """
    found = [
        (entry, _questionnaire(entry, read, code))
        for entry, read in read_entries(
            cursor, Sentence("questionnaires.list", "a list of questionnaires"), QuestionnaireEntry
        )
    ]
    named = [(entry, each.name) for entry, each in found]
    check_different(
        named, Sentence("questionnaires.a_questionnaire", "a questionnaire"), ("name", "title")
    )
    return tuple(sorted((each for _, each in found), key=_asked_last))


def _asked_last(questionnaire: Questionnaire) -> bool:
    """Whether it stands behind all others: whoever was asked who was behind the robot answers
    anything else in another light.
    """
    return questionnaire.role == SUSPICION


def _questionnaire(cursor: Cursor, entry: QuestionnaireEntry, code: str) -> Questionnaire:
    table = dict(cursor.entries())
    name = read_name(cursor, "title", in_words(entry.title, code, code))
    shuffled = entry.order == "shuffled"
    scale = read_scale(table.get("scale"), entry.scale, Scale())
    defaults = ItemDefaults(scale, entry.stem, entry.required or "required", shuffled)
    if "items" not in table and "file" not in table:
        missing(
            {},
            "items",
            cursor,
            Sentence("questionnaires.in_this_order", "questions, in this order"),
        )
    items = read_items(table.get("items"), defaults, code)
    scores = read_scores(table.get("scores"), items)
    if entry.role == SUSPICION and entry.when not in ("end", "hand"):
        table["when"].error(
            Sentence(
                "questionnaires.suspicion_when", "a suspicion check is asked at the end, or by hand"
            )
        )
    languages = languages_of(cursor, [item.cursor for item in items], code)

    first, *others = (
        QuestionnaireVersion(
            language,
            in_words(entry.title, language, code) or name,
            in_words(entry.introduction, language, code),
            tuple(item.within(language, code) for item in items),
        )
        for language in languages
    )
    return Questionnaire(
        name=name,
        title=first.title,
        introduction=first.introduction,
        when=entry.when,
        items=first.items,
        shuffled=shuffled,
        language=code if others else "",
        versions=tuple(others),
        scores=scores,
        role=entry.role,
    )


def _without_a_design(cursor: Cursor | None) -> None:
    """Nobody knows when a condition's last trial is over if nobody says how many there are."""
    for entry in cursor.items() if cursor is not None else ():
        when = dict(entry.entries()).get("when")
        if when is not None and getattr(when.node, "text", "") == "condition":
            when.warning(
                Sentence(
                    "questionnaires.last_trial_unknown",
                    "without a design, the last trial of a condition is unknown; add"
                    " design: {{trials: ...}}, or start it by hand: when: hand",
                )
            )


# -- words -----------------------------------------------------------------------------------------


def read_words(language: Language) -> QuestionnaireWords:
    """What participants read of the console, in this language."""
    words: dict[str, str] = {}
    fields = QuestionnaireWords.__struct_fields__
    for section in language.section("questionnaire"):
        table = (
            section.fields(
                fields,
                Sentence("questionnaires.words_are", "words are"),
                Sentence("questionnaires.words", "words by their names"),
            )
            or {}
        )
        for name in (name for name in table if name in fields):
            text = read_filled(table[name])
            if text is not None and _fits(table[name], text, getattr(ENGLISH, name)):
                words.setdefault(name, text)
    return msgspec.structs.replace(ENGLISH, **words)


def _fits(cursor: Cursor, text: str, english: str) -> bool:
    """Whether all that stands between braces can be filled in."""
    known = {name for _, name, _, _ in string.Formatter().parse(english) if name}
    try:
        wanted = {name for _, name, _, _ in string.Formatter().parse(text) if name is not None}
    except ValueError:
        wanted = {""}
    if wanted <= known:
        return True
    allowed = ", ".join(f"{{{name}}}" for name in sorted(known)) or Sentence(
        "check.found_nothing", "nothing"
    )
    cursor.error(
        Sentence(
            "questionnaires.braces_allowed",
            "between braces may stand here: {allowed}",
            allowed=allowed,
        )
    )
    return False
