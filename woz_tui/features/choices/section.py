"""The section `choices`: what a participant can be offered on a page.

choices:
  - name: colour
    question: Which colour do you like best?
    options:
      - {text: Red, plays: Red it is}
      - {text: Blue, picture: media/blue.png}
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Annotated, Any

from woz_tui.config.action_names import check_actions
from woz_tui.config.annotated_decoder import read_entries
from woz_tui.config.experiment import Call, Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents
from woz_tui.config.problems import quoted
from woz_tui.config.reload_changes import changed_entries
from woz_tui.config.session_verbs import own_verb
from woz_tui.config.yaml_cursor import Cursor, check_different
from woz_tui.drivers.contract import DECIDES, KEPT, Argument
from woz_tui.drivers.fields import Doc, Entry, NotBlank, NotEmpty, Path, ReadApart
from woz_tui.protocol.sentence import Sentence

#: In place of a choice's name: what is offered is taken away.
OFF = "off"
#: Buttons that a small screen can have.
MOST_OPTIONS = 12
#: Files that browsers show as pictures, with their types, and bytes of one.
PICTURES = {
    ".png": "image/png",
    ".jpg": "image/jpeg",
    ".jpeg": "image/jpeg",
    ".gif": "image/gif",
    ".svg": "image/svg+xml",
    ".webp": "image/webp",
}
MOST_BYTES = 4_000_000

#: Offers a choice.
CHOICE_VERB = own_verb(
    "choice",
    "offer the participant a choice on the page (`woz page`)",
    (Argument("name", "text", "a choice of the file; off: take it away", required=True),),
    lane="choice",
    brief=True,
)


@dataclass(frozen=True, slots=True)
class Option(Entry):
    """A button, with a picture above its words where there is one."""

    what = Sentence("choices.an_option", "an option")
    example = "{text: Red}"
    text: Annotated[str, NotBlank(), Doc("what stands on the button, and in the log")]
    picture: Annotated[
        str, Path(must_exist=True), Doc("a picture on the button, relative to this file")
    ] = ""
    plays: Annotated[str, Doc("the name of an action that is played when this is chosen")] = ""


@dataclass(frozen=True, slots=True)
class Choice(Entry):
    """What a participant is offered: a question, and a button for each option."""

    what = Sentence("choices.a_choice", "a choice")
    example = "{name: colour, options: [{text: Red}, {text: Blue}]}"
    name: Annotated[str, NotBlank(), Doc("what actions and logs call it")]
    options: Annotated[tuple[Option, ...], NotEmpty(), Doc("its buttons, twelve at the most")]
    question: Annotated[str, Doc("what stands above the buttons")] = ""


@dataclass(frozen=True, kw_only=True)
class ChoiceKeys:
    """The key `choices`."""

    choices: Annotated[
        tuple[Choice, ...],
        ReadApart(),
        NotEmpty(),
        Doc("what the participant can be offered on the page (`choice: NAME`)"),
    ] = ()


class ChoiceSection(FeatureSection[tuple[Choice, ...]]):
    """Choices by name."""

    verbs = (CHOICE_VERB,)

    def read(
        self, table: Mapping[str, Cursor], file: Any, contents: FileContents
    ) -> tuple[Choice, ...]:
        found = [
            *read_entries(
                table.get("choices"), Sentence("choices.list", "a list of choices"), Choice
            )
        ]
        check_different(
            [(entry, choice.name) for entry, choice in found],
            Sentence("choices.a_choice", "a choice"),
            ("name",),
        )
        for entry, choice in found:
            keys = dict(entry.entries())
            if choice.name == OFF:
                keys["name"].error(
                    Sentence(
                        "choices.reserved",
                        "{word} takes a choice away; choose another name",
                        word=OFF,
                    )
                )
            if len(choice.options) > MOST_OPTIONS:
                keys["options"].error(
                    Sentence(
                        "choices.too_many",
                        "has {number}; {most} are the most",
                        number=len(choice.options),
                        most=MOST_OPTIONS,
                    )
                )
            options = [*zip(keys["options"].items(), choice.options, strict=False)]
            check_different(
                [(each, option.text) for each, option in options],
                Sentence("choices.an_option", "an option"),
                ("text",),
            )
            for each, option in options:
                _check_option(dict(each.entries()), option, contents)
        return tuple(choice for _, choice in found)

    def check(self, experiment: Experiment, table: Mapping[str, Cursor]) -> None:
        names = [choice.name for choice in self.of(experiment)]
        for call in _offering(experiment):
            for name in _names(call):
                if name not in (*names, OFF) and "{" not in name:
                    cursor = next(iter(table.values()))
                    near = cursor.report.hint(
                        name, names, or_list=Sentence("choices.choices_are", "choices are")
                    )
                    told = Sentence(
                        "choices.no_such_choice",
                        "there is no choice {name}{near}",
                        name=quoted(name),
                        near=near,
                    )
                    cursor.report.error(call.place, cursor.path, told)

    def called(self, experiment: Experiment, name: str) -> Choice | None:
        """The choice of this name."""
        return next((each for each in self.of(experiment) if each.name == name), None)

    def changes(self, old: tuple[Choice, ...], new: tuple[Choice, ...]) -> Iterable[str]:
        before, after = ({each.name: each for each in some} for some in (old, new))
        return changed_entries(Sentence("reload.a_choice", "choice"), before, after)

    def people_data(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        for choice in self.of(experiment):
            yield KEPT, f"what participants choose of {choice.name}, in the log"
            if plays := [each.plays for each in choice.options if each.plays]:
                yield DECIDES, f"participants, by what they choose: {', '.join(plays)}"

    def summary(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        for choice in self.of(experiment):
            options = (
                quoted(each.text) + (f" (plays {quoted(each.plays)})" if each.plays else "")
                for each in choice.options
            )
            yield f"choice {choice.name}", ", ".join(options)


def _check_option(keys: Mapping[str, Cursor], option: Option, contents: FileContents) -> None:
    check_actions(keys.get("plays"), contents.actions)
    file = FilePath(option.picture)
    if option.picture and file.suffix.lower() not in PICTURES:
        known = ", ".join(sorted(PICTURES))
        keys["picture"].error(
            Sentence(
                "choices.no_picture",
                "{name} is no picture for a browser; there are {known}",
                name=file.name,
                known=known,
            )
        )
    elif option.picture and file.is_file() and file.stat().st_size > MOST_BYTES:
        keys["picture"].error(
            Sentence(
                "choices.picture_too_large",
                "{name} has more than {most} MB",
                name=file.name,
                most=MOST_BYTES // 1_000_000,
            )
        )


def _offering(experiment: Experiment) -> Iterable[Call]:
    every = (*experiment.actions, *experiment.beside_panels)
    return (call for action in every for call in action.calls if call.verb == CHOICE_VERB.name)


def _names(call: Call) -> Iterable[str]:
    chosen = call.choices["name"].every if "name" in call.choices else (call.args.get("name"),)
    return (name for name in chosen if isinstance(name, str))


CHOICES = ChoiceSection(ChoiceKeys, ())
