"""Offers proposals, holds what programs only propose, and ends each set exactly once."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

from msgspec.structs import replace

from woz_tui.config.experiment import Experiment
from woz_tui.drivers.contract import Finding
from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.features.proposals.clean_text import (
    LONGEST,
    MOST,
    cleaned,
    texts_of,
    without_variables,
)
from woz_tui.features.proposals.gate import ApprovalFact
from woz_tui.features.proposals.halves import HALF, is_offered
from woz_tui.features.proposals.history import ProposalHistory
from woz_tui.features.proposals.kinds import (
    AskDismiss,
    AskModelState,
    AskModelTold,
    AskPropose,
    AskShown,
    AskTake,
    ProposedItem,
    SuggestAsked,
    SuggestGone,
    SuggestModel,
    SuggestOffered,
    SuggestRanked,
    SuggestRehearsed,
    SuggestSettings,
    SuggestShown,
    SuggestState,
    SuggestTaken,
    SuggestTrial,
)
from woz_tui.features.proposals.likely_acts import LikelyActs
from woz_tui.features.proposals.marks import LastSentences
from woz_tui.features.proposals.model_state import LOOK, WHY, is_too_slow
from woz_tui.features.proposals.ranker import Ranked
from woz_tui.features.proposals.rights import ACTIONS, HANDS, ProgramRights
from woz_tui.features.proposals.section import (
    PROPOSALS,
    ModelSettings,
    Proposals,
    SuggestKeysOfFile,
)
from woz_tui.features.training.history import TrainingHistory
from woz_tui.features.training.kinds import MISSED, VOID, CueAnswered, CueGiven
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.action_messages import BY_PERSON
from woz_tui.protocol.envelope import Message
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session_features import Client, Decide, FeatureSession, SessionFeature
from woz_tui.timeline.episodes import Episode, TrialEpisode

if TYPE_CHECKING:
    from woz_tui.features.proposals.rehearsal import RehearsedActs

#: In this time after a set came a key may still mean what stood there before, in microseconds.
SETTLE_US = 300_000
#: What a program that only proposes may ask for without anybody's approval: it moves nothing.
ALWAYS = (
    *(r.AskDescribe, r.AskPredict, r.AskMarker, r.AskNote, r.AskCancel, r.AskLetGo, r.AskStop),
    *(r.AskPreflight, r.AskAbout, r.Beat, AskDismiss, AskPropose, AskModelTold, AskModelState),
)
#: What is said to a program whose set ended so.
_ENDS: Mapping[str, tuple[str, str]] = {
    "stop": (
        Sentence("proposals.stop_pressed", "the stop was pressed"),
        Sentence("proposals.wizard_releases", "the wizard releases it"),
    ),
    "dismissed": (Sentence("proposals.declined", "the wizard declined it"), ""),
    "reloaded": (
        Sentence("proposals.reloaded", "the experiment file was read again"),
        Sentence("proposals.ask_again", "ask again"),
    ),
    "end": (Sentence("session.ends", "the session ends"), ""),
}


@dataclass
class _OpenSet:
    """A set that is offered. `request` and `decide`: of a program that waits for its end."""

    offered: SuggestOffered
    console: str
    since: int
    timer: asyncio.TimerHandle | None = None
    request: r.AskVerb | r.AskAction | None = None
    decide: Decide | None = None
    #: Items that stood on a screen, with the console.
    shown: set[tuple[str, str]] = field(default_factory=set)

    def item(self, name: str) -> ProposedItem:
        """Raises `RequestError` if there is none of that id."""
        for item in self.offered.items:
            if item.id == name:
                return item
        raise RequestError(
            Sentence("proposals.no_item", "the proposal has no item {name!r}", name=name)
        )


class ProposalsInSession(SessionFeature):
    """All sets of a session."""

    requests = (AskTake, AskDismiss, AskPropose, AskModelTold, AskModelState, AskShown)

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        self._section = PROPOSALS.of(session.experiment)
        self._open: dict[str, _OpenSet] = {}
        self._count = 0
        #: The connection of which something happens now because the wizard approved it.
        self._approved = ""
        #: Of what was approved and has not ended, by its run: the connection, and what it is.
        self._waiting: dict[str, tuple[str, str]] = {}
        self._likely = LikelyActs(session, self._offer_learnt)
        #: Of a training.
        self._rehearsed: RehearsedActs | None = None
        #: Whether an item is being taken: what is played then is no other act.
        self._taking = False
        #: Whether nothing is offered in this trial.
        self._quiet = False
        #: The connection of the program that tells how it stands with the model.
        self._suggest = ""
        #: Presses of which it is not known yet whether they are refused, by run, and whether an
        #: item was taken with them.
        self._pressed: dict[str, tuple[m.ActionRequested, bool]] = {}

    def idle(self) -> bool:
        return self._section is None and not (self._open or self._waiting or self._quiet)

    def begin(self) -> None:
        if self._section is not None:
            self._tell(self._section)
            self._likely.begin(self._section.suggest)

    def adopt(self, experiment: Experiment) -> None:
        if self._rehearsed is not None:
            self._rehearsed.cancel()
        self._end_all("reloaded")
        self._section, before = PROPOSALS.of(experiment), self._section
        if self._section != before:
            self._tell(self._section)
        suggest = self._section.suggest if self._section is not None else SuggestKeysOfFile()
        self._likely.begin(suggest)

    def _tell(self, section: Proposals | None) -> None:
        programs = section.proposing if section is not None else []
        sources: list[str] = []
        after = 0.0
        if section is not None:
            sources = [*(["logs"] if section.suggest.logs else []), "program"]
            after = section.suggest.after
            if (model := section.suggest.model) is not None:
                sources.append("model")
                self._tell_model(model)
        self.session.hub.publish(
            SuggestSettings(sources=sources, programs=programs, after_us=round(after * 1e6))
        )

    def _tell_model(self, model: ModelSettings) -> None:
        sampling: dict[str, float] = {
            "temperature": model.temperature,
            "seed": model.seed,
            "max_tokens": model.max_tokens,
        }
        self.session.hub.publish(
            SuggestModel(url=model.url, name=model.name, sampling=sampling, prompt=model.prompt)
        )

    def close(self) -> None:
        self._likely.close()
        if self._rehearsed is not None:
            self._rehearsed.cancel()
        self._end_all("end")

    def lose(self, console: str) -> None:
        if console == self._suggest:
            self._suggest = ""
            if not self.session.ended:
                self.session.hub.publish(SuggestState(how="gone"))
        for name, each in [*self._open.items()]:
            if each.console == console:
                self._go(name, "withdrawn")

    def fact(self) -> ApprovalFact | None:
        section = self._section
        if section is None:
            return None
        rights = {
            console: found
            for console in self.session.state.consoles
            if (found := self._rights(console)) is not None
        }
        return ApprovalFact(rights, self._approved, [*self._waiting.values()])

    def _rights(self, console: str) -> ProgramRights | None:
        """Of a program that proposes something."""
        attached = self.session.state.consoles.get(console)
        if self._section is None or attached is None or attached.role != "program":
            return None
        found = self._section.programs.get(attached.name)
        return found if found is not None and found.proposes else None

    # -- what programs ask for ---------------------------------------------------------------------

    def defer(self, request: r.Request, client: Client, decide: Decide) -> bool:
        rights = self._rights(client.console)
        if rights is None or isinstance(request, ALWAYS):
            return False
        match request:
            case r.AskVerb(verb=verb) if not rights.asks(verb):
                return False
            case r.AskVerb(verb=verb, args=args, on=on, when_busy=busy):
                item = ProposedItem("1", verb=verb, args={**args}, on=on, when_busy=busy)
                if isinstance(text := args.get("text"), str):
                    item = replace(item, text=text)
                self._hold(client, request, item, decide)
            case r.AskAction() if not rights.asks(ACTIONS):
                return False
            case r.AskAction(action=action, slots=slots, when_busy=busy):
                if self.session.experiment.action(action) is None:
                    raise RequestError(
                        Sentence(
                            "gate.no_action",
                            "there is no action {action!r}",
                            action=action,
                        )
                    )
                item = ProposedItem("1", action=action, args={**slots}, when_busy=busy)
                self._hold(client, request, item, decide)
            case _:
                raise RequestError(
                    Sentence(
                        "proposals.verbs_and_actions",
                        "this program only proposes: it can ask for verbs and actions,"
                        " nothing else",
                    )
                )
        return True

    def _hold(
        self, client: Client, request: r.AskVerb | r.AskAction, item: ProposedItem, decide: Decide
    ) -> None:
        """Until the wizard approves it. What stands there is what will be said."""
        if self.session.state.stop is not None:
            raise RequestError(
                Sentence("gate.stopped", "the stop is pressed"),
                Sentence("proposals.wizard_releases", "the wizard releases it"),
            )
        if request.at:
            raise RequestError(
                Sentence(
                    "proposals.not_later",
                    "what has to be approved cannot be asked for a later moment",
                )
            )
        if client.tells:
            raise RequestError(
                Sentence(
                    "proposals.cannot_approve",
                    "the wizard, who does not know everything, cannot approve it",
                ),
                Sentence("proposals.join_as_wizard", "join with sees='wizard', as `woz mcp` does"),
            )
        if any(each.console == client.console and each.decide for each in self._open.values()):
            raise RequestError(
                Sentence(
                    "proposals.still_waits",
                    "what this program asked for before still waits for the wizard",
                ),
                Sentence("proposals.wait", "wait for that"),
            )
        texts = [item.text, item.on, *texts_of(item.args)]
        if any(cleaned(text) != text or len(text) > LONGEST for text in texts):
            raise RequestError(
                Sentence(
                    "proposals.text_form",
                    "a text that is to be approved has one line of {longest} characters at the"
                    " most, and no characters that nobody can see",
                    longest=LONGEST,
                )
            )
        assert self._section is not None
        if item.text:
            item = self._marked(item)
        held = self._offer("program", client, [item], self._section.suggest.within, approval=True)
        held.request, held.decide = request, decide

    def withdraw(self, console: str, ref: int) -> None:
        for name, each in [*self._open.items()]:
            if each.console == console and each.request is not None and each.request.ref == ref:
                self._go(name, "withdrawn")

    # -- requests ----------------------------------------------------------------------------------

    def carry_out(
        self,
        request: AskTake | AskDismiss | AskPropose | AskModelTold | AskModelState | AskShown,
        client: Client,
    ) -> str:
        if isinstance(request, AskModelTold | AskModelState):
            self._log_model(request, client)
            return ""
        if isinstance(request, AskPropose):
            self._propose(request, client)
            return ""
        if client.role != "wizard":
            raise RequestError(
                Sentence("proposals.only_wizards", "only a wizard takes what is proposed")
            )
        if isinstance(request, AskShown):
            self._show(request, client)
            return ""
        if (found := self._open.get(request.set)) is None:
            raise RequestError(
                Sentence("proposals.gone", "this proposal has gone"),
                Sentence("proposals.look", "look at what is offered now"),
            )
        if isinstance(request, AskDismiss):
            self._go(request.set, "dismissed")
            return ""
        if client.stale:
            raise RequestError(
                Sentence("proposals.not_taken", "not taken ({stale})", stale=client.stale),
                Sentence("gate.again", "press it again"),
            )
        if self.session.hub.now() - found.since < SETTLE_US:
            raise RequestError(
                Sentence("proposals.just_came", "not taken: the proposal had only just come"),
                Sentence("gate.again", "press it again"),
            )
        return self._take(request, client, found)

    def _show(self, request: AskShown, client: Client) -> None:
        """Once for each item and console; what has gone meanwhile nobody asks about."""
        if (found := self._open.get(request.set)) is None:
            return
        there = [item.id for item in found.offered.items if item.id in request.items]
        new = [item for item in there if (item, client.console) not in found.shown]
        if new:
            found.shown.update((item, client.console) for item in new)
            after = self.session.hub.now() - found.since
            shown = SuggestShown(set=request.set, items=new, after_us=after, console=client.console)
            self.session.hub.publish(shown)

    def _log_model(self, request: AskModelTold | AskModelState, client: Client) -> None:
        """What a model was asked is in the log, whatever comes of it; a failure is told once."""
        if client.role != "program" or self._section is None:
            raise RequestError(
                Sentence(
                    "proposals.only_programs",
                    "only a program can tell what it asked a model",
                )
            )
        kind: type[SuggestAsked | SuggestState] = SuggestState
        if isinstance(request, AskModelTold):
            kind = SuggestAsked
        own = Message.__struct_fields__
        fields = [name for name in kind.__struct_fields__ if name not in own]
        before = self.session.state.history(ProposalHistory).model_state
        self.session.hub.publish(kind(**{name: getattr(request, name) for name in fields}))
        if isinstance(request, AskModelTold):
            return
        self._suggest = client.console
        if request.how == "failing" and (before is None or before.how != "failing"):
            text = Sentence(
                "proposals.no_model",
                "The model does not answer ({why}): no sentences are proposed for a while",
                why=WHY.get(request.why, request.why),
            )
            self.session.hub.publish(m.Notice(level="warning", text=text, remedy=LOOK))

    def findings(self) -> Sequence[Finding]:
        """Whether a model that the file names is asked, and answers in time."""
        if self._section is None or self._section.suggest.model is None:
            return ()
        told = self.session.state.history(ProposalHistory).model_state
        match told.how if told is not None else "gone":
            case "gone":
                text = Sentence(
                    "proposals.not_running", "`woz suggest` does not run: no sentences of a model"
                )
                return [
                    Finding(
                        "warning", "suggest", text, f"woz suggest {self.session.identity.session}"
                    )
                ]
            case "loading":
                text = Sentence("proposals.is_loading", "the model is loading")
                return [Finding("info", "suggest", text)]
            case "failing" | "dropped":
                assert told is not None
                return [Finding("warning", "suggest", WHY.get(told.why, told.why), LOOK)]
        assert told is not None
        text = Sentence(
            "proposals.answers",
            "{model} answers: its first word after {seconds:.2f} s",
            model=told.model or Sentence("proposals.the_model", "the model"),
            seconds=told.first_us / 1e6,
        )
        return [Finding("warning" if is_too_slow(told.first_us) else "ok", "suggest", text)]

    def _propose(self, request: AskPropose, client: Client) -> None:
        if client.role != "program" or self._section is None:
            raise RequestError(
                Sentence(
                    "proposals.needs_section",
                    "programs propose, where the experiment file has suggest: or programs:",
                )
            )
        items: list[ProposedItem] = []
        for text in map(cleaned, request.texts):
            if not text or len(text) > LONGEST:
                raise RequestError(
                    Sentence(
                        "proposals.text_length",
                        "a proposed text has 1 to {longest} characters",
                        longest=LONGEST,
                    )
                )
            item = ProposedItem(str(len(items) + 1), text=text)
            # A number would tell what the sentence is that somebody may not read.
            items.append(item if client.tells else self._marked(item))
        for action in request.actions:
            if self.session.experiment.action(action) is None:
                raise RequestError(
                    Sentence(
                        "gate.no_action",
                        "there is no action {action!r}",
                        action=action,
                    )
                )
            items.append(ProposedItem(str(len(items) + 1), action=action))
        if not 0 < len(items) <= MOST:
            raise RequestError(
                Sentence("proposals.items", "a proposal has 1 to {most} items", most=MOST)
            )
        if self.session.state.stop is not None:
            raise RequestError(
                Sentence("gate.stopped", "the stop is pressed"),
                Sentence("proposals.wizard_releases", "the wizard releases it"),
            )
        if self._quiet:
            raise RequestError(
                Sentence("proposals.quiet_trial", "in this trial nothing is proposed"),
                Sentence("proposals.trials_half", "the file says trials: half"),
            )
        for name, each in [*self._open.items()]:
            if each.console == client.console and each.decide is None:
                self._go(name, "superseded")
        self._offer(
            request.source, client, items, min(60.0, max(1.0, request.within)), cue=request.cue
        )

    def _marked(self, item: ProposedItem) -> ProposedItem:
        """With what it would be after the last sentences of the trial, said or to be said."""
        text, last, state = item.text, LastSentences(), self.session.state
        begun = state.study.last_started
        coming = [each.request for each in state.commands.values() if each.dispatched is None]
        for each in (*(said.request for said in state.spoken), *coming):
            sentence = each.args.get("text")
            in_trial = begun is None or each.seq > begun.seq
            if each.verb == "say" and isinstance(sentence, str) and in_trial and not each.tells:
                last.say(sentence)
        return replace(
            item, likeness=last.likeness(text), asking=last.asking(text), marks=last.marks(text)
        )

    def _offer(
        self,
        source: str,
        client: Client,
        items: list[ProposedItem],
        within: float,
        *,
        approval: bool = False,
        cue: str = "",
    ) -> _OpenSet:
        self._count += 1
        now, attached = self.session.hub.now(), self.session.state.consoles.get(client.console)
        offered = SuggestOffered(
            set=f"s{self._count:05}",
            source=source,
            who=attached.name if attached is not None else "",
            approval=approval,
            items=items,
            cue=cue,
            until=now + round(within * 1e6),
            tells=client.tells,
        )
        loop = asyncio.get_running_loop()
        timer = loop.call_later(within, partial(self._go, offered.set, "expired"))
        found = self._open[offered.set] = _OpenSet(offered, client.console, now, timer)
        self.session.hub.publish(offered)
        return found

    def _offer_learnt(self, ranked: Sequence[Ranked], cue: str) -> None:
        """Not in a training, whose lists are planned."""
        if self.session.state.history(TrainingHistory).training is None:
            self._offer_likely(ranked, cue)

    def _offer_likely(self, ranked: Sequence[Ranked], cue: str) -> None:
        """What earlier sessions make likely, in place of what they made likely before."""
        if self.session.ended or self.session.state.stop is not None or self._quiet:
            return
        for name, each in [*self._open.items()]:
            if each.offered.source == "logs":
                self._go(name, "superseded")
        self._count += 1
        offered = SuggestOffered(
            set=f"s{self._count:05}",
            source="logs",
            items=[ProposedItem(str(i), action=one.action) for i, one in enumerate(ranked, 1)],
            cue=cue,
        )
        self._open[offered.set] = _OpenSet(offered, "", self.session.hub.now())
        self.session.hub.publish(offered)
        self.session.hub.publish(
            SuggestRanked(
                set=offered.set,
                reasons=[one.reason for one in ranked],
                scores=[round(one.share, 3) for one in ranked],
            )
        )

    # -- the end of a set --------------------------------------------------------------------------

    def _take(self, request: AskTake, client: Client, found: _OpenSet) -> str:
        item = found.item(request.item)
        text = cleaned(request.text)
        if text and not item.text:
            raise RequestError(
                Sentence("proposals.only_sentences", "only a sentence can be changed")
            )
        edited = bool(text) and text != item.text
        self._close(request.set)
        self._taking = True
        try:
            run = self._carry_out(request, client, found, item, text if edited else item.text)
        except RequestError:
            self.session.hub.publish(SuggestGone(set=request.set, how="refused"))
            raise
        finally:
            self._taking = False
        self.session.hub.publish(
            SuggestTaken(
                set=request.set,
                item=item.id,
                how="edited" if edited else "key",
                run=run,
                after_us=self.session.hub.now() - found.since,
                text=text if edited else "",
                tells=(*found.offered.tells, *(client.tells if edited else ())),
            )
        )
        return run

    def _carry_out(
        self, request: AskTake, client: Client, found: _OpenSet, item: ProposedItem, text: str
    ) -> str:
        origin = RequestOrigin("key", request.key, client.console)
        if found.decide is not None:
            return self._approve(found, text)
        if item.action:
            return self.session.play(item.action, origin)
        return self.session.send("say", {"text": text}, "", origin, tells=found.offered.tells)

    def _approve(self, found: _OpenSet, text: str) -> str:
        """With exactly these arguments; what forbids it now forbids it."""
        asked = found.request
        assert asked is not None
        assert found.decide is not None
        asked = replace(asked, sent_us=0, age_us=0, stale=False)
        if isinstance(asked, r.AskVerb):
            args = {**asked.args, "text": text} if text else asked.args
            kept = {name: without_variables(value) for name, value in args.items()}
            asked = replace(asked, args=kept)
        self._approved = found.console
        try:
            reply = found.decide(asked)
        finally:
            self._approved = ""
        if not reply.ok:
            raise RequestError(reply.reason, reply.hint)
        if reply.run:
            name = asked.verb if isinstance(asked, r.AskVerb) else asked.action
            self._waiting[reply.run] = found.console, name
        return reply.run

    def _ended(self, message: m.ActionEnd | m.End) -> None:
        run = message.run if isinstance(message, m.ActionEnd) else message.command
        self._waiting.pop(run, None)

    def _close(self, name: str) -> _OpenSet | None:
        found = self._open.pop(name, None)
        if found is not None and found.timer is not None:
            found.timer.cancel()
        return found

    def _go(self, name: str, why: str) -> None:
        """End a set of which nothing was taken, and tell a program that waits."""
        if (found := self._close(name)) is None:
            return
        self.session.hub.publish(SuggestGone(set=name, how=why))
        if found.decide is None or why == "withdrawn":
            return
        reason, hint = _ENDS.get(why, (why, ""))
        if why == "expired":
            assert self._section is not None
            within = self._section.suggest.within
            reason = Sentence(
                "proposals.unapproved_in_time",
                "nobody approved it within {within:g} s",
                within=within,
            )
            hint = Sentence("proposals.ask_wizard", "ask the wizard, or try another one")
        if isinstance(found.request, r.AskVerb) and found.request.verb == "say":
            text = Sentence("session.not_said", "not said: {reason}", reason=reason)
        else:
            text = Sentence("proposals.not_done", "not done: {reason}", reason=reason)
        found.decide(RequestError(text, hint))

    def _end_all(self, why: str) -> None:
        for name in [*self._open]:
            self._go(name, why)

    def _end_offers(self, why: str) -> None:
        """All sets for which no program waits."""
        for name, each in [*self._open.items()]:
            if each.decide is None:
                self._go(name, why)

    # -- what happens ------------------------------------------------------------------------------

    def _stopped(self, message: m.StopPressed) -> None:
        if message.scope == "all":
            self._end_all("stop")

    def _acted(self, message: m.ActionRequested) -> None:
        """A person pressed something; a refusal follows at once, if there is one."""
        if message.source in HANDS:
            self._pressed[message.run] = message, self._taking
            asyncio.get_running_loop().call_soon(self._played, message.run)

    def _refused(self, message: m.ActionRefused) -> None:
        """What was refused was no act, also where that comes late."""
        if self._pressed.pop(message.run, None) is None:
            self._likely.forget(message.run)

    def _played(self, run: str) -> None:
        """It was accepted: perhaps what was proposed, by its own key."""
        if run not in self._pressed:
            return
        message, taken = self._pressed.pop(run)
        self._likely.act(message)
        if taken:
            return
        for name, each in [*self._open.items()]:
            if each.decide is not None or each.since > message.t:
                continue
            item = next((one for one in each.offered.items if one.action == message.action), None)
            if item is None:
                self._go(name, "other_act")
                continue
            self._close(name)
            self.session.hub.publish(
                SuggestTaken(
                    set=name,
                    item=item.id,
                    how="own_key",
                    run=run,
                    after_us=message.t - each.since,
                    console=message.console,
                    tells=each.offered.tells,
                )
            )

    def _sent(self, message: m.Command) -> None:
        """A sentence that a person typed is another act."""
        if not (self._taking or message.run) and message.source in BY_PERSON:
            self._end_offers("other_act")

    def _heard(self, message: m.SpeechText) -> None:
        """What was proposed answers what was said before."""
        if message.text and not message.own:
            self._end_offers("superseded")
            self._likely.hear(message)

    def _mistaken(self, message: m.Mistake) -> None:
        self._likely.forget(message.run)

    def _trained(self, message: CueGiven) -> None:
        """A cue of a training."""
        section = self._section
        if section is None or not section.suggest.logs:
            return
        # Most sessions are no training.
        from woz_tui.features.proposals.rehearsal import RehearsedActs, rehearsed  # noqa: PLC0415

        found = rehearsed(
            message, self.session.experiment, section.suggest.wrong, self.session.identity.seed
        )
        told = SuggestRehearsed(cue=message.cue, items=[*found.actions], fits=found.right)
        self.session.hub.publish(told)
        if self._rehearsed is None:
            self._rehearsed = RehearsedActs(self._offer_likely)
        self._rehearsed.give(message, found, section.suggest.after)

    def _judged(self, message: CueAnswered) -> None:
        """What answered it ends the list itself, as an act."""
        if self._rehearsed is not None:
            self._rehearsed.cancel()
        if message.judged in (MISSED, VOID):
            self._end_offers("expired" if message.judged == MISSED else "moved_on")

    def _moved_on(self, message: Any) -> None:
        self._end_offers("moved_on")
        if isinstance(message, TrialEpisode):
            self._quiet = False
            if message.end is None:
                self._draw(message.started)
                self._likely.begin_anew()

    def _draw(self, trial: m.TrialStarted) -> None:
        """Whether something is offered in the trial that begins."""
        section = self._section
        if section is None or section.suggest.trials != HALF:
            return
        identity = self.session.identity
        offered = is_offered(trial.trial, identity.participant, identity.seed)
        self._quiet = not offered
        self.session.hub.publish(SuggestTrial(trial=trial.trial, offered=offered))

    hears: ClassVar[Mapping[type[m.Message], Any]] = {
        m.StopPressed: _stopped,
        m.ActionEnd: _ended,
        m.ActionRefused: _refused,
        m.End: _ended,
        m.ActionRequested: _acted,
        m.Command: _sent,
        m.SpeechText: _heard,
        m.Mistake: _mistaken,
        PhaseChanged: _moved_on,
        CueGiven: _trained,
        CueAnswered: _judged,
    }
    follows: ClassVar[Mapping[type[Episode], Any]] = {TrialEpisode: _moved_on}
