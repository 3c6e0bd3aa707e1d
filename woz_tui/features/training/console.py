"""A training on the wizard's screen: the cue above the panels, verdicts, dialogs by themselves."""

from __future__ import annotations

from collections.abc import Sequence

from rich.cells import cell_len

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row, clean, fit, wrap_row
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.drawing.number_text import seconds
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.console.state.feature_notes import FeatureNotes, StudyNews
from woz_tui.console.widgets.feature_console import Board, DialogOffer, FeatureConsole
from woz_tui.features.training.history import TrainingHistory
from woz_tui.features.training.kinds import CueAnswered, CueGiven, TrainingChanged
from woz_tui.protocol.sentence import Sentence
from woz_tui.timeline.session_state import SessionState

#: Lines of the board on a low screen, and on one of so many lines or more.
_LOW, _HIGH, _TALL = 3, 5, 32
_SORTS = {
    "approach": Sentence("training.approach", "A visitor comes."),
    "silence": Sentence("training.silence", "The visitor is silent."),
    "turn-away": Sentence("training.turn_away", "The visitor turns away."),
    "leave": Sentence("training.leave", "The visitor leaves."),
}
#: What a wizard did with a cue: how it is said, and its look.
_VERDICTS = {
    "right": (Sentence("training.right", "right"), "good"),
    "wrong": (Sentence("training.wrong", "wrong"), "bad"),
    "missed": (Sentence("training.missed", "missed"), "warn"),
    "uncalled": (Sentence("training.uncalled", "no cue was waiting"), "warn"),
}
#: The same in the list of events: its mark, and how it is said.
_JUDGED = {
    "right": ("done", Sentence("training.cue_right", "Cue answered")),
    "wrong": ("failed", Sentence("training.cue_wrong", "Cue answered wrongly")),
    "missed": ("warning", Sentence("training.cue_missed", "Cue missed")),
    "uncalled": ("warning", Sentence("training.no_cue", "No cue was waiting")),
}


# -- what is kept for it -------------------------------------------------------------------------


class TrainingNotes(FeatureNotes):
    """The last cue, and what became of it."""

    hears = (CueGiven, CueAnswered)

    def __init__(self, session: SessionState) -> None:
        super().__init__(session)
        self._cue: CueGiven | None = None
        #: What became of it, or of a press without one.
        self.judged: CueAnswered | None = None

    def apply(self, message: CueGiven | CueAnswered) -> StudyNews | None:
        if isinstance(message, CueGiven):
            self._cue = message
            return None
        self.judged = message
        return StudyNews(*verdict_text(message), self.right_actions(message))

    def right_actions(self, told: CueAnswered) -> tuple[str, ...]:
        """Names of the actions that would have answered a cue that was missed or answered wrongly;
        none for others, or if nobody knows.
        """
        cue = self._cue
        wanted = cue is not None and cue.cue == told.cue and told.judged in ("wrong", "missed")
        return tuple(cue.expects) if wanted and cue is not None else ()


def verdict_text(told: CueAnswered) -> tuple[str, str]:
    """`right, 1.24 s`, with its look."""
    verdict, look = _VERDICTS.get(told.judged, (told.judged, "plain"))
    took = f", {seconds(told.reaction_us)}" if told.reaction_us >= 0 else ""
    return f"{word(verdict)}{took}", look


# -- the list of events --------------------------------------------------------------------------


def _changed(message: TrainingChanged, shown: EventContext) -> EventLine:
    if message.state == "over":
        judged = message.right + message.wrong + message.missed
        over = say(
            "training.over",
            "Training over: {right} of {count} cues right",
            one="Training over: {right} of 1 cue right",
            right=message.right,
            count=judged,
        )
        return EventLine("done", over)
    begins = (
        say(
            "training.waits",
            "Training waits for you: {count} cues",
            one="Training waits for you: 1 cue",
            count=message.planned,
        )
        if message.state == "waits"
        else say(
            "training.begins",
            "Training begins: {count} cues",
            one="Training begins: 1 cue",
            count=message.planned,
        )
    )
    return EventLine("info", begins, say("training.nothing_moves", "nothing moves"))


def _given(message: CueGiven, shown: EventContext) -> EventLine:
    return EventLine("heard", say("training.cue", "Cue: {sort}", sort=message.sort), message.text)


def _answered(message: CueAnswered, shown: EventContext) -> EventLine:
    other = say("training.judged", "Cue {judged}", judged=message.judged)
    mark, text = _JUDGED.get(message.judged, ("info", other))
    took = seconds(message.reaction_us) if message.reaction_us >= 0 else ""
    notes = shown.study.notes.of(TrainingNotes)
    names = notes.right_actions(message) if notes is not None else ()
    right = ""
    for label in map(shown.label, names):
        right = (
            say("training.or_right", "{right} or {label}", right=right, label=label)
            if right
            else say("training.was_right", "right: {label}", label=label)
        )
    return EventLine(mark, word(text), ", ".join(filter(None, (took, right))))


SENTENCES = {TrainingChanged: _changed, CueGiven: _given, CueAnswered: _answered}


# -- the board above the panels ------------------------------------------------------------------


def _lines(state: ConsoleState, height: int) -> int:
    """None outside of a training that runs."""
    training = state.session.history(TrainingHistory).training
    if training is None or training.state != "runs":
        return 0
    return _HIGH if height >= _TALL else _LOW


def _rows(state: ConsoleState, frame: PaintFrame) -> Sequence[Row]:
    """The cue that waits, in as many lines as there are beside its bar; between two of them what
    became of the last one.
    """
    cue, notes = state.session.history(TrainingHistory).cue, state.study.notes.of(TrainingNotes)
    plain = frame.glyphs.plain
    if cue is not None:
        given = cue.given
        text = f"\N{LEFT DOUBLE QUOTATION MARK}{given.text}\N{RIGHT DOUBLE QUOTATION MARK}"
        words = plain(clean(text if given.text else word(_SORTS.get(given.sort, given.sort))))
        wrapped = wrap_row(((words, "strong"),), 0, frame.width)
        lines = ["".join(piece for piece, _ in row).strip() for row in wrapped]
        room = max(1, frame.height - 1)
        said = [*lines[: room - 1], " ".join(lines[room - 1 :])]
        left = max(0, given.t + given.window_us - frame.now)
        full = round(left / max(1, given.window_us) * (frame.width // 2))
        rows = [*((line, "strong") for line in said), (frame.glyphs.bar * full, "run")]
    elif notes is not None and notes.judged is not None:
        rows = [verdict_text(notes.judged), ("", "plain")]
    else:
        rows = [(say("training.soon", "The first cue comes soon."), "muted"), ("", "plain")]
    shown: list[Row] = []
    for text, look in rows:
        line = plain(clean(text))
        if cell_len(line) > frame.width:
            line = fit(line, frame.width, frame.glyphs.ellipsis)
        shown.append(((line.center(frame.width), look),))
    return shown


# -- dialogs -------------------------------------------------------------------------------------


def _dialog(state: ConsoleState) -> str:
    """Which stands for the training as far as it is; a watcher has none."""
    training = state.session.history(TrainingHistory).training
    name = {"waits": "BeginDialog", "over": "ScoreDialog"}.get(training.state if training else "")
    return f"{__package__}.dialog:{name}" if name and state.role == "wizard" else ""


def _offer(state: ConsoleState) -> DialogOffer | None:
    training = state.session.history(TrainingHistory).training
    return DialogOffer(training, _dialog(state)) if training is not None else None


def _instead_of_trial(state: ConsoleState) -> str | None:
    """Before a training its beginning."""
    training = state.session.history(TrainingHistory).training
    return _dialog(state) if training is not None and training.state == "waits" else None


def _begins(state: ConsoleState) -> tuple[str, str] | None:
    """Where the file has trials: a training has none, since nobody takes part in it."""
    training = state.session.history(TrainingHistory).training
    if training is None or not state.session.study.between_trials:
        return None
    if training.state == "waits":
        return "trial", say("training.begins_now", "begins the training")
    return "", say("training.no_trials", "no trials in a training")


CONSOLE = FeatureConsole(
    board=Board(_lines, _rows),
    offers=_offer,
    instead={"trial": _instead_of_trial},
    begins=_begins,
)
