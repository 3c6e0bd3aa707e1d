"""The sections `suggest` and `programs`: what is proposed to the wizard.

suggest: {logs: true}
programs: {mcp: propose, greeter: {play: [gaze]}}
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from woz_tui.config.annotated_decoder import Invalid, read_value
from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents
from woz_tui.config.problems import quoted
from woz_tui.config.reload_changes import changed_entries, changed_settings
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.config.yaml_nodes import MappingNode
from woz_tui.drivers.contract import DECIDES, KEPT, LEAVES
from woz_tui.drivers.fields import Doc, NotBlank, OneOf, Pattern, Range, ReadApart, Seconds
from woz_tui.features.proposals.addresses import host_of, is_local
from woz_tui.features.proposals.halves import ALL, HALF
from woz_tui.features.proposals.rights import (
    ACTIONS,
    ONLY_PROPOSES,
    PLAY,
    PROPOSE,
    ProgramRights,
)
from woz_tui.protocol.envelope import Json
from woz_tui.protocol.sentence import Sentence

#: How `woz mcp` calls itself.
MCP = "mcp"


@dataclass(frozen=True, slots=True)
class ModelSettings:
    """A model that `woz suggest` asks for sentences, at any address that has chat completions."""

    url: Annotated[
        str,
        Pattern(r"https?://.+", Sentence("proposals.address", "begins with http:// or https://")),
        Doc("the address before /chat/completions"),
    ] = "http://127.0.0.1:8080/v1"
    name: Annotated[str, Doc("the model that is asked for; empty: the server's own")] = ""
    prompt: Annotated[str, NotBlank(), Doc("what the model is told before the dialogue")] = (
        "You help a person who speaks for a robot. Suggest what the robot could answer: two short"
        " sentences to choose from, each on a line of its own, and nothing else."
    )
    temperature: Annotated[float, Range(0, 2), Doc("0: the likeliest words")] = 0.0
    seed: Annotated[int, Doc("asks for the same answer again, which no server promises")] = 1
    max_tokens: Annotated[int, Range(8, 400), Doc("length of an answer at the most")] = 80


@dataclass(frozen=True, slots=True)
class SuggestKeysOfFile:
    """What is proposed to the wizard. A file without the section has none of it."""

    logs: Annotated[
        bool, Doc("actions that earlier sessions make likely are named with their own keys")
    ] = False
    model: Annotated[
        ModelSettings | None, Doc("a language model that `woz suggest` asks for sentences")
    ] = None
    trials: Annotated[
        str,
        OneOf((ALL, HALF)),
        Doc(
            "half: in half of the trials, drawn by chance, nothing is offered, so that it can be"
            " compared"
        ),
    ] = ALL
    wrong: Annotated[
        float,
        Range(0, 1),
        Doc("in `woz train`: the share of lists of likely actions that are wrong on purpose"),
    ] = 0.2
    after: Annotated[
        float, Seconds(0, 10), Doc("nothing is proposed sooner after the visitor has spoken")
    ] = 1.0
    within: Annotated[
        float, Seconds(2, 60), Doc("a request of a program that only proposes waits so long")
    ] = 10.0


@dataclass(frozen=True, kw_only=True)
class ProposalKeys:
    """The keys `suggest` and `programs`."""

    suggest: Annotated[
        SuggestKeysOfFile | None, Doc("what is proposed to the wizard, who may take it")
    ] = None
    programs: Annotated[
        Any,
        ReadApart("programs"),
        Doc("programs by name: play, or propose, where the wizard has to approve what they do"),
    ] = None


@dataclass(frozen=True, slots=True)
class Proposals:
    """What a file says of proposals. `programs`: their rights by name."""

    suggest: SuggestKeysOfFile = SuggestKeysOfFile()
    programs: Mapping[str, ProgramRights] = field(default_factory=dict)

    @property
    def proposing(self) -> list[str]:
        """Names of programs that propose something."""
        return [name for name, rights in self.programs.items() if rights.proposes]


class ProposalSection(FeatureSection[Proposals | None]):
    """Both keys, or None where the file has neither."""

    def read(
        self, table: Mapping[str, Cursor], file: ProposalKeys, contents: FileContents
    ) -> Proposals | None:
        cursor = table.get("programs")
        if cursor is None and "suggest" not in table:
            return None
        entries = (
            cursor.table(Sentence("proposals.programs_by_name", "a mapping of programs by name"))
            if cursor is not None
            else None
        )
        programs = {
            name: rights
            for name, entry in (entries or {}).items()
            if (rights := _rights(entry, contents)) is not None
        }
        suggest = file.suggest or SuggestKeysOfFile()
        if suggest.model is not None and not is_local(suggest.model.url):
            table["suggest"].warning(
                Sentence(
                    "proposals.sent_away",
                    "what visitors say is sent to {host}; say so in their consent, or"
                    " serve a model on a computer of your own",
                    host=host_of(suggest.model.url),
                )
            )
        return Proposals(suggest, {MCP: ONLY_PROPOSES, **programs})

    def changes(self, old: Proposals | None, new: Proposals | None) -> Iterable[str]:
        was, now = (each.programs if each is not None else {} for each in (old, new))
        suggest = changed_settings(
            "suggest",
            old.suggest if old is not None else None,
            new.suggest if new is not None else None,
        )
        if old is None or new is None:
            # Only what stands in the file came or went with the section.
            was, now = ({n: each for n, each in m.items() if n != MCP} for m in (was, now))
            given = old or new
            if given is not None and given.suggest == SuggestKeysOfFile() and (was or now):
                suggest = ()
        return (*suggest, *changed_entries(Sentence("reload.a_program", "program"), was, now))

    def people_data(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        section = self.of(experiment)
        if section is None:
            told = "programs that join (`woz mcp` too), by themselves; `programs:` changes that"
            yield DECIDES, told
            return
        if (model := section.suggest.model) is not None:
            sent = "its prompt and the last turns of the dialogue, each time a visitor has spoken"
            if is_local(model.url):
                yield LEAVES, f"not for the model of `woz suggest`, which is at {model.url}"
            else:
                yield LEAVES, f"to {host_of(model.url)}, by `woz suggest`: {sent}"
            yield KEPT, "each request to the model and its whole answer, in the log"
            yield DECIDES, "a wizard, of each sentence of the model, before it is said"
        if section.suggest.logs:
            told = "acts of earlier sessions with numbers in place of words, in the user's cache"
            yield KEPT, told
        for name, rights in section.programs.items():
            yield DECIDES, _who_decides(name, rights, section.suggest.within)
        yield DECIDES, "other programs that join, by themselves"

    def summary(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        section = self.of(experiment)
        if section is not None and section.suggest.model is not None:
            yield "suggest", f"`woz suggest` asks a model at {section.suggest.model.url}"
        if section is not None and section.suggest.logs:
            yield "suggest", "names likely actions, learnt from earlier sessions of this title"
        if section is not None and section.suggest.trials == HALF:
            yield "suggest", "nothing is offered in half of the trials, drawn by chance"
        for name, rights in section.programs.items() if section is not None else ():
            does = "plays without being asked"
            if rights.plays is not None:
                alone = f", but for {', '.join(rights.plays)}" if rights.plays else ""
                does = f"waits until the wizard approves what it does{alone}"
            yield f"program {name}", does

    def as_json(self, experiment: Experiment) -> Mapping[str, Json]:
        section = self.of(experiment)
        if section is None:
            return {}
        return {"programs": {n: each.proposes for n, each in section.programs.items()}}

    def schemas(self) -> Mapping[str, Any]:
        names = {"type": "array", "items": {"type": "string"}}
        return {
            "programs": {
                "type": "object",
                "additionalProperties": {
                    "anyOf": [
                        {"enum": [PLAY, PROPOSE]},
                        {
                            "type": "object",
                            "properties": {PLAY: names},
                            "additionalProperties": False,
                            "description": "verbs (and `actions`) that it plays by itself",
                        },
                    ]
                },
            }
        }


def _who_decides(name: str, rights: ProgramRights, within: float) -> str:
    if rights.plays is None:
        return f"{name}, by itself: nobody approves what it does"
    alone = f"; {', '.join(rights.plays)} it plays by itself" if rights.plays else ""
    return f"a wizard, of what {name} asks for; no answer within {within:g} s is a no{alone}"


def _rights(cursor: Cursor, contents: FileContents) -> ProgramRights | None:
    if not isinstance(cursor.node, MappingNode):
        word = read_value(cursor, str, (OneOf((PLAY, PROPOSE)),))
        return None if isinstance(word, Invalid) else ProgramRights(None if word == PLAY else ())
    table = (
        cursor.fields(
            (PLAY,),
            Sentence("proposals.program_has", "a program has"),
            Sentence("proposals.rights", "play, propose, or {{play: [gaze]}}"),
        )
        or {}
    )
    listed = table.get(PLAY)
    named = read_value(listed, tuple[str, ...]) if listed is not None else ()
    if isinstance(named, Invalid):
        return None
    known = [ACTIONS, *dict.fromkeys(verb.name for verb in contents.verbs)]
    for name in named:
        if name not in known and contents.complete and listed is not None:
            near = listed.report.hint(name, known, or_list=Sentence("check.there_are", "there are"))
            listed.error(
                Sentence(
                    "check.no_driver_offers",
                    "no driver offers {verb}{near}",
                    verb=quoted(name),
                    near=near,
                )
            )
    return ProgramRights(named)


PROPOSALS = ProposalSection(ProposalKeys, None)
