"""What can be said of a command that is right by its description: by its driver, which looks at it
without being connected, and by the log, into which the file goes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from woz_tui.config import utterance_template
from woz_tui.config.condition_texts import Variables
from woz_tui.config.experiment import TextVariants
from woz_tui.config.problems import shortened, with_remedy
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.drivers.contract import UNKNOWN, Finding, Verb, Written
from woz_tui.drivers.secret_arguments import hidden
from woz_tui.protocol import markup
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Sentence

if TYPE_CHECKING:
    from woz_tui.config.robots import VerbOffer

Values = Mapping[str, str]


@dataclass(frozen=True, slots=True)
class CommandChecker:
    """Looks at commands with their variables filled in.

    Attributes:
        folder: The experiment file's.
        values: Texts of the variables, by condition; those that are not there are known in the
            session only.
    """

    folder: Path
    values: Mapping[str, Values]

    @classmethod
    def of(cls, folder: Path, variables: Variables, conditions: Sequence[str]) -> CommandChecker:
        """With the experiment's own variables."""
        always = variables.always
        each = {
            condition: {
                name: _filled(texts[condition], always)
                for name, texts in variables.by_condition.items()
                if condition in texts
            }
            for condition in conditions or ("",)
        }
        return cls(folder, {name: {**always, **depending} for name, depending in each.items()})

    def check(
        self,
        offer: VerbOffer,
        args: Mapping[str, Json],
        cursors: Mapping[str, Cursor],
        verb: Cursor,
        choices: Mapping[str, TextVariants],
    ) -> None:
        """Report what is odd about a command. `cursors`: where each argument stands."""
        if verb.report.has_too_many:
            return
        for given in self._renderings(args, choices):
            written = Written(offer.verb.name, given, self.folder)
            wrong = {
                finding.subject
                for finding in (*_findings(offer, written, verb), *_markup_left_out(offer, given))
                if _report_finding(finding, cursors.get(finding.subject, verb))
            }
            for name in hidden_arguments(offer.verb, given):
                if name not in wrong:
                    cursors.get(name, verb).error(SECRET)

    def _renderings(
        self, args: Mapping[str, Json], choices: Mapping[str, TextVariants]
    ) -> Iterator[dict[str, Json]]:
        """The arguments as conditions and variants make them, each only once."""
        found: list[dict[str, Json]] = []
        for condition, values in self.values.items():
            known = {"condition": condition}
            variants = {
                name: choice.every if choice.by else choice.of(known)
                for name, choice in choices.items()
            }
            for index in range(max(map(len, variants.values()), default=1)):
                chosen = {name: texts[index % len(texts)] for name, texts in variants.items()}
                given = {n: _rendered(value, values) for n, value in {**args, **chosen}.items()}
                if given not in found:
                    found.append(given)
                    yield given


#: Pieces of markup that one warning names.
MOST_SHOWN = 3
#: Why a file with a secret in it is refused.
SECRET = Sentence(
    "check.secret",
    "this looks like a password or another secret, and each log contains this file; remove it",
)


def _findings(offer: VerbOffer, written: Written, verb: Cursor) -> Iterable[Finding]:
    """What the driver says. Its code may be a stranger's."""
    if offer.look is None:
        return ()
    try:
        return [*offer.look(written)]
    except Exception as error:  # noqa: BLE001 - a plug-in's code; the file is not at fault
        verb.warning(
            Sentence(
                "check.check_fails",
                "{driver} fails to check this: {error!r}",
                driver=offer.driver,
                error=error,
            )
        )
        return ()


def _markup_left_out(offer: VerbOffer, given: Mapping[str, Json]) -> Iterable[Finding]:
    """Markup of a sentence that this voice cannot do."""
    if offer.verb.markup is None or not offer.verb.arguments:
        return
    name = offer.verb.arguments[0].name
    text = given.get(name)
    marks = markup.left_out(text, offer.verb.markup) if isinstance(text, str) else []
    if marks:
        shown = ", ".join(shortened(mark.written, 60) for mark in marks[:MOST_SHOWN])
        more = (
            Sentence("check.and_more", " and {number} more", number=len(marks) - MOST_SHOWN)
            if len(marks) > MOST_SHOWN
            else ""
        )
        pauses = (
            Sentence("check.pause_is_comma", " (a pause is a comma)")
            if any(mark.pause for mark in marks)
            else ""
        )
        what = Sentence(
            "check.markup_left_out",
            "the voice of {driver!r} does not know {shown}{more}: left out of the sentence{pauses}",
            driver=offer.driver,
            shown=shown,
            more=more,
            pauses=pauses,
        )
        yield Finding("warning", name, what, "")


def _report_finding(finding: Finding, cursor: Cursor) -> bool:
    """Report it, unless it has been said here already; whether it is an error."""
    message = with_remedy(finding.text, finding.remedy)
    if finding.level == "error":
        cursor.error(message)
        return True
    if finding.level == "warning" and not cursor.report.has_problem(cursor.place, finding.text):
        cursor.warning(message)
    return False


def hidden_arguments(verb: Verb | None, given: Mapping[str, Json]) -> list[str]:
    """Names of the arguments with something in them that the verb hides."""
    # A digit in its gaps fits where a name, a number or a code is meant.
    known = {
        name: value.replace(UNKNOWN, "1") if isinstance(value, str) else value
        for name, value in given.items()
    }
    shown = hidden(verb, known)
    return [name for name, value in known.items() if shown.get(name) != value]


def _rendered(value: Json, values: Values) -> Json:
    match value:
        case str():
            return _filled(value, values)
        case list():
            return [_rendered(one, values) for one in value]
        case dict():
            return {name: _rendered(one, values) for name, one in value.items()}
    return value


def _filled(text: str, values: Values) -> str:
    return utterance_template.fill(text, lambda name: values.get(name) or UNKNOWN)
