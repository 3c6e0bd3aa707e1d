"""What a wizard is likely to play next, as earlier sessions and this one tell."""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from collections.abc import Callable, Mapping, Sequence

from woz_tui.config.experiment import Action
from woz_tui.features.proposals.ranker import Moment, Ranked, Ranker, words_of
from woz_tui.features.proposals.section import SuggestKeysOfFile
from woz_tui.features.scripts.history import ScriptHistory
from woz_tui.features.scripts.section import SCRIPT
from woz_tui.protocol import messages as m
from woz_tui.session.session_features import FeatureSession
from woz_tui.system.tasks import TaskSet

log = logging.getLogger(__name__)

#: Actions that are offered, if each is at least so likely.
SHOWN, LEAST = 3, 0.05
#: Acts and words of the visitor that are kept, of a trial that has more.
MOST_TURNS = 400


class LikelyActs:
    """Offers likely actions behind each act, and some time after the visitor has spoken.

    Args:
        session: What goes on.
        offer: Called with the likeliest actions, and the words that they answer.
    """

    def __init__(
        self, session: FeatureSession, offer: Callable[[Sequence[Ranked], str], None]
    ) -> None:
        self._session, self._offer = session, offer
        self._ranker: Ranker | None = None
        self._settings = SuggestKeysOfFile()
        #: What people played in this trial and what the visitor said in it, also while nothing
        #: likely was offered.
        self._turns: deque[m.ActionRequested | m.SpeechText] = deque(maxlen=MOST_TURNS)
        #: The acts behind which something was offered last.
        self._seen: Sequence[str] = ()
        self._timer: asyncio.TimerHandle | None = None
        self._tasks = TaskSet("earlier sessions")

    def begin(self, settings: SuggestKeysOfFile) -> None:
        """The file says so from now on: read the earlier sessions in a thread."""
        self._tasks.cancel()  # what is being read is of the file as it was
        self._wait(None)
        self._settings, self._ranker = settings, None
        if settings.logs:
            self._tasks.start(self._learn())

    def close(self) -> None:
        """Offer nothing more."""
        self._tasks.cancel()
        self._wait(None)
        self._settings = SuggestKeysOfFile()

    async def _learn(self) -> None:
        from woz_tui.features.proposals import earlier_acts  # noqa: PLC0415 - only where it is used

        session = self._session
        scripts = SCRIPT.all_of(session.experiment)
        about = {action.name: _about(action) for action in session.experiment.actions}
        folders, title = session.logs, session.experiment.title
        file = session.experiment.path.name

        def learnt() -> Ranker:
            ranker = Ranker(about, scripts)
            earlier = earlier_acts.earlier_acts(folders, title, file)
            for acts in earlier.sessions:
                ranker.learn(acts)
            ranker.calibrate(earlier.sessions)
            return ranker

        try:
            self._ranker = await asyncio.to_thread(learnt)
        except Exception:
            log.exception("earlier sessions were not read")
            return
        self._wait(self._settings.after if self._heard() else 0)

    # -- what happens ----------------------------------------------------------------------------

    def act(self, message: m.ActionRequested) -> None:
        """A wizard played something."""
        self._turns.append(message)
        self._wait(0)

    def forget(self, run: str) -> None:
        """It was refused, or a mistake, and no act: the visitor still waits."""
        for turn in tuple(self._turns):
            if isinstance(turn, m.ActionRequested) and turn.run == run:
                self._turns.remove(turn)
        if self._acts() != self._seen:
            self._wait(0)

    def hear(self, message: m.SpeechText) -> None:
        """The visitor said something."""
        self._turns.append(message)
        if self._heard():
            self._wait(self._settings.after)

    def begin_anew(self) -> None:
        """A trial begins."""
        self._turns.clear()
        self._wait(0)

    def _wait(self, seconds: float | None) -> None:
        if self._timer is not None:
            self._timer.cancel()
        self._timer = None
        if seconds is not None and self._ranker is not None:
            self._timer = asyncio.get_running_loop().call_later(seconds, self.propose)

    def propose(self) -> None:
        """Offer what is likely now, if anything is."""
        self._timer = None
        session = self._session
        if self._ranker is None or session.ended or session.state.study.between_trials:
            return
        allowed = {
            action.name
            for panel in session.experiment.panels
            if not session.locked.get(panel.title, False)
            for action in panel.actions
            if not action.locked
        }
        self._seen = self._acts()
        ranked = self._ranker.rank(self._moment(), allowed)[:SHOWN]
        likely = [one for one in ranked if one.share >= LEAST]
        if likely:
            heard = self._heard()
            self._offer(likely, f"{heard[-1].driver}/{heard[-1].segment}" if heard else "")

    def _acts(self) -> list[str]:
        """What people played in this trial."""
        return [turn.action for turn in self._turns if isinstance(turn, m.ActionRequested)]

    def _heard(self) -> Sequence[m.SpeechText]:
        """The visitor's words since the last act. Where the wizard must not read them, they count
        for nothing.
        """
        perception = self._session.state.study.settings.perception
        if "transcript" in (*perception.hide, *perception.blur):
            return ()
        heard: list[m.SpeechText] = []
        for turn in reversed(self._turns):
            if not isinstance(turn, m.SpeechText):
                break
            heard.insert(0, turn)
        return heard

    def _moment(self) -> Moment:
        session = self._session
        state = session.state
        phase = state.study.stage.label if state.study.stage is not None else ""
        scripts: Mapping[str, Sequence[str]] = SCRIPT.all_of(session.experiment)
        name = phase if phase in scripts else ""
        moved = state.history(ScriptHistory).moved.get(name)
        acts = self._acts()
        heard = [word for line in self._heard() for word in words_of(line.text)]
        return Moment(
            before=acts[-2:],
            phase=phase,
            heard=tuple(heard) if self._heard() else None,
            played=frozenset(acts),
            script=scripts.get(name, ()),
            position=moved.position if moved is not None else 0,
        )


def _about(action: Action) -> list[str]:
    """What an action is about: its label and all that it may say, in whatever condition."""
    said = [
        text
        for call in action.calls
        if call.verb == "say"
        for text in (
            *call.args.values(),
            *(x for each in call.choices.values() for x in each.every),
        )
        if isinstance(text, str)
    ]
    return [action.label, *said]
