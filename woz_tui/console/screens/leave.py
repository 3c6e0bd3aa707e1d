"""Leaving: end the session, leave it running, or stay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pkgutil import resolve_name

from textual.content import Content
from textual.widgets import OptionList

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row
from woz_tui.console.screens.choice import ChoiceDialog, ListChoice
from woz_tui.console.screens.dialog import plain, refusal_text
from woz_tui.console.screens.typed import typed_sentences
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.feature_console import EndAnswer, EndQuestion, FeatureConsole
from woz_tui.feature import answers_of, pieces
from woz_tui.log.file_names import gets_participant
from woz_tui.protocol.requests import AskKeepTyped, Reply
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.text_cleaning import lasting

#: Names of what is open: who takes part, the typed sentences.
_WHO, _TYPED = "participant", "typed"
#: Under which name the answers are kept while the dialog is closed.
_DRAFT = "LeaveDialog "
#: What becomes of a session without a participant, once anything has been played, and before that.
_NOBODY = {
    True: [
        Sentence(
            "leave.nobody_counts",
            "No participant was given: reports count the session as one without a code",
        )
    ],
    False: [
        Sentence("leave.nobody_log", "No participant was given: the log has no code"),
        Sentence("leave.nobody_first", "No participant was given: give it first"),
    ],
}


@dataclass(slots=True)
class OpenQuestion:
    """Something that is open at the end: a sentence for each answer, the usual one first. What was
    answered before stands under `key` among the drafts.
    """

    key: str
    sentences: Sequence[str]
    answer: int = 0


class LeaveDialog(ChoiceDialog):
    """Stay is the first choice, so that enter after a slip does no harm. Below the end stands what
    is open, with what becomes of it: enter there takes the next answer.
    """

    heading: str = Sentence("leave.heading", "Leave")
    hint = Sentence("leave.hint", "arrows choose · enter · ctrl+q stays")

    def on_mount(self) -> None:
        """Say how an answer is changed, if anything is open."""
        super().on_mount()
        if self._questions:
            self.show_hint(
                say(
                    "leave.hint_answers",
                    "arrows choose · enter: do it, or the next answer · ctrl+q stays",
                )
            )

    def lines(self) -> list[Row]:
        """Where the log is, and what would be cut off."""
        log = self.state.log
        where = log or say("leave.no_log", "none")
        rows: list[Row] = [((f"{say('leave.log', 'log:')} ", "muted"), (where, "plain"))]
        if self.state.role == "watcher":  # the end is not offered
            return rows
        warning = self.glyphs.warning
        cut: list[Row] = [((f"{warning} {told}", "warn"),) for told in cut_off(self.state)]
        if gets_participant(log):
            code = say(
                "leave.code_added", "The participant's code is added to the file name at the end."
            )
            rows.append(((code, "muted"),))
        return [*rows, *cut]

    def choices(self) -> Sequence[ListChoice]:
        """Stay, leave it running, end it; then what is open."""
        stay = ListChoice(plain(say("leave.stay", "Stay")))
        leaves = [say("leave.running", "Leave the session running (woz attach brings you back)")]
        if after := self.state.settings.abandon_after:
            ends = say(
                "leave.ends_itself",
                "it ends by itself after {time} without a console (abandon_after)",
                time=lasting(after),
            )
            leaves.append(f"  {ends}")
        leave = ListChoice(Content("\n".join(leaves)), self._leave_running)
        self._questions = self._open_questions()
        if self.state.role == "watcher":
            return [stay, leave]
        ends = say("leave.end", "End the session: the robot rests, the log is finished")
        end = ListChoice(Content(ends), self._end)
        found = [stay, leave, end]
        for each in self._questions:
            line = plain(f"  {self.glyphs.middle} {each.sentences[each.answer]}")
            found.append(ListChoice(line, partial(self._answer, each), stays=True))
        return found

    def _leave_running(self) -> None:
        self.console_app.exit("detached")

    # -- what is open ---------------------------------------------------------------------------

    def _open_questions(self) -> list[OpenQuestion]:
        """With the answers that were given before."""
        if self.state.role == "watcher":
            return []
        found = list[OpenQuestion]()
        if self._lacks_participant():
            # Whatever comes before the first code is nobody's: later it would take all away.
            found.append(self._open(_WHO, *map(word, _NOBODY[self._has_begun()])))
        self._of_features, trial_done = dict[str, EndQuestion](), False
        for name, console in pieces("console", FeatureConsole).items():
            if console.at_end is None:
                continue
            for each in answers_of(name, console.at_end, self.state, trial_done):
                opened = self._open(each.key, *(answer.sentence for answer in each.answers))
                self._of_features[each.key] = each
                trial_done = trial_done or each.answers[opened.answer].ends_trial
                found.append(opened)
        if count := len(typed_sentences(self.state)):
            log_only = say(
                "leave.typed_log",
                "{count} typed sentences: in the log only",
                one="{count} typed sentence: in the log only",
                count=count,
            )
            copied = say(
                "leave.typed_copy",
                "{count} typed sentences: also into a copy of your file",
                one="{count} typed sentence: also into a copy of your file",
                count=count,
            )
            found.append(self._open(_TYPED, log_only, copied))
        return found

    def _lacks_participant(self) -> bool:
        """Whether the file is a study's, and nobody has said who takes part. In a training and in a
        re-run nobody does.
        """
        session = self.state.session
        settings = session.study.settings
        is_study = self.state.plan.conditions or settings.design or settings.questionnaires
        return bool(is_study) and not session.study.participant and not session.apart

    def _has_begun(self) -> bool:
        """Whether anything of the session would be somebody's: a trial, or an action."""
        study = self.state.session.study
        trial = study.trial is not None or study.last_started is not None
        return trial or any(event.run for event in self.state.events)

    def _open(self, key: str, *sentences: str) -> OpenQuestion:
        before = int(self.requests.drafts.get(self._draft(key), 0))
        return OpenQuestion(key, sentences, before % len(sentences))

    def _draft(self, key: str) -> str:
        """Under which name an answer is kept: another participant or trial begins anew."""
        study = self.state.session.study
        begin = study.trial.begin if study.trial is not None else 0
        return f"{_DRAFT}{key} {study.participant} {begin}"

    def _answer(self, question: OpenQuestion) -> None:
        """What is open takes its next answer, with which other things may be open."""
        self.requests.drafts[self._draft(question.key)] = str(question.answer + 1)
        self._offers = self.choices()
        for choices in self.query("#choices").results(OptionList):
            here = choices.highlighted
            choices.clear_options()
            choices.add_options([offer.text for offer in self._offers])
            choices.highlighted = here

    # -- the end ----------------------------------------------------------------------------------

    def _end(self) -> None:
        """Do what was answered, then end. Behind what is seen to first, or once there is a
        participant, this dialog comes again.
        """
        answers = {each.key: each.answer for each in self._questions}
        if answers.get(_WHO):
            self.requests.leaving = True
            self.console_app.do("start")
            return
        for chosen in self._chosen(answers):
            if chosen.ends_trial and chosen.request is not None:
                self.requests.ask(chosen.request, partial(self._trial_done, answers))
                return
        self._go_on(answers)

    def _chosen(self, answers: Mapping[str, int]) -> list[EndAnswer]:
        """What becomes of that which features have open."""
        return [
            self._of_features[key].answers[answer]
            for key, answer in answers.items()
            if key in self._of_features
        ]

    def _trial_done(self, answers: Mapping[str, int], reply: Reply) -> None:
        self.requests.refused(reply)
        if reply.ok:
            self._go_on(answers)

    def _go_on(self, answers: Mapping[str, int]) -> None:
        for chosen in self._chosen(answers):
            if chosen.request is not None and not chosen.ends_trial:
                # Seen to before the end, which is asked again behind it where that is here.
                self.requests.ask(chosen.request, partial(self._seen_to, chosen))
                return
        if answers.get(_TYPED):
            self.requests.ask(AskKeepTyped(), self._kept)
        else:
            self.requests.end_session()

    def _seen_to(self, chosen: EndAnswer, reply: Reply) -> None:
        self.requests.refused(reply)
        if reply.ok and chosen.opens:
            self.requests.leaving = True
            self.console_app.open_dialog(resolve_name(chosen.opens)())

    def _kept(self, reply: Reply) -> None:
        """The copy is written, or not: then the session goes on, and says why."""
        if not reply.ok:
            self.requests.drafts.pop(self._draft(_TYPED), None)
            wrong = say(
                "leave.not_kept",
                "{why}. The session goes on; the sentences are in the log",
                why=refusal_text(reply),
            )
            self.console_app.news(wrong, "warn")
            return
        data = reply.data if isinstance(reply.data, dict) else {}
        self.requests.typed_copy = str(data.get("file", ""))
        self.requests.end_session()


def cut_off(state: ConsoleState) -> list[str]:
    """What the end of the session would cut off or leave out and no answer changes."""
    found: list[str] = []
    for name, console in pieces("console", FeatureConsole).items():
        if console.cut_off is not None:
            found += answers_of(name, console.cut_off, state)
    return found
