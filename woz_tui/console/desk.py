"""What the wizard can do beside playing actions: each key of the console, each dialog's request."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from woz_tui.console.engagement.hand import Order, is_offered, request
from woz_tui.console.feed import GONE
from woz_tui.console.robot.steps import ArrowSteps
from woz_tui.core import requests as r
from woz_tui.core.messages import Json
from woz_tui.core.pictures import PictureShown

if TYPE_CHECKING:
    from woz_tui.console.app import Console
    from woz_tui.console.screens.dialog import Dialog

#: Called in the console's own thread with the reply to a request, with a picture.
OnReply = Callable[[r.Reply], None]
OnPicture = Callable[[PictureShown], None]
#: Utterances typed in this sitting, for the history of `/`.
HISTORY = 100


class Desk:
    """Requests with their replies, drafts of dialogs, and one method for each of its keys.

    Dialogs are imported when they are first opened: the first painting does not wait for them.
    """

    def __init__(self, console: Console) -> None:
        self._console = console
        self._waiting: dict[int, OnReply] = {}
        self._watching: dict[int, OnPicture] = {}
        self._ending = False
        self.drafts: dict[str, str] = {}
        self.said: list[str] = []
        self.moved: list[str] = []
        self.arrows = ArrowSteps(console.keyboard)

    # -- requests ---------------------------------------------------------------------------

    def ask(self, request: r.AnyRequest, on_reply: OnReply | None = None) -> None:
        """Send a request; without `on_reply` a refusal is shown above the hints."""
        if self._console.picture.lost:
            gone = r.Reply(ref=0, ok=False, reason=GONE)
            self._console.call_later(on_reply or self.refused, gone)
            return
        ref = self._console.feed.ask(request)
        self._waiting[ref] = on_reply or self.refused

    def ask_picture(self, request: r.AskPicture, show: OnPicture, refused: OnReply) -> None:
        """Ask for a camera's picture: it comes in a reply's place."""
        ref = self._console.feed.ask(request)
        self._waiting[ref], self._watching[ref] = refused, show

    def pictured(self, shown: PictureShown) -> None:
        """A picture came."""
        self._waiting.pop(shown.ref, None)
        show = self._watching.pop(shown.ref, None)
        if show is not None:
            show(shown)

    def replied(self, reply: r.Reply) -> None:
        """A reply came; those to keys pressed in the input thread have no waiting dialog."""
        self._watching.pop(reply.ref, None)
        told = self._console.picture.blind.reply(reply)
        self._waiting.pop(reply.ref, self.refused)(told)

    def forget(self) -> None:
        """The connection is gone: no reply will come any more."""
        waiting, self._waiting = self._waiting, {}
        self._watching.clear()
        for ref, on_reply in waiting.items():
            on_reply(r.Reply(ref=ref, ok=False, reason=GONE))
        if self._ending:
            self._console.exit("ended")

    def refused(self, reply: r.Reply) -> None:
        """Show above the hints why something was not done."""
        if not reply.ok:
            hint = f" ({reply.hint})" if reply.hint else ""
            self._console.news(f"{reply.reason}{hint}", "warn")

    def play(self, action: str) -> None:
        """Play an action that was found by typing."""
        self.ask(r.AskAction(action=action, source="palette"))

    def say(self, text: str, on: str) -> None:
        """Say a typed utterance."""
        self.said = [*(old for old in self.said if old != text), text][-HISTORY:]
        self.ask(r.AskVerb(verb="say", args={"text": text}, on=on, source="key", key="/"))

    def move(self, name: str, on: str) -> None:
        """Play a typed animation."""
        self.moved = [*(old for old in self.moved if old != name), name][-HISTORY:]
        args: dict[str, Json] = {"move": name}
        self.ask(r.AskVerb(verb="play", args=args, on=on, source="key", key=self.key_of("move")))

    def key_of(self, name: str) -> str:
        """The key by which one of the console's own is pressed here; empty: it has none."""
        found = self._console.keymap.builtins.get(name)
        return found.press if found is not None else ""

    def end_session(self) -> None:
        """End the session; the console goes when the robot process has gone.

        Until then the robot may move to its rest pose, and the stop is still needed.
        """
        self.ask(r.AskEnd(reason="wizard"), self._end_answered)

    def _end_answered(self, reply: r.Reply) -> None:
        self._ending = reply.ok
        if reply.ok:
            self._console.news("ending the session: the robot takes its rest pose", "warn")
        else:
            self.refused(reply)

    # -- keys -------------------------------------------------------------------------------

    def do(self, what: str) -> None:
        """Carry out one of the console's keys by its id; those of the keyboard alone do nothing."""
        method = getattr(self, f"do_{what.removesuffix('_too')}", None)
        if method is not None:
            method()

    def do_say(self) -> None:
        """Type and say."""
        from woz_tui.console.screens.say import SayDialog  # noqa: PLC0415

        self._open(SayDialog())

    def do_find(self) -> None:
        """Find any action."""
        from woz_tui.console.screens.find import FindDialog  # noqa: PLC0415

        self._open(FindDialog())

    def do_note(self) -> None:
        """Write a note."""
        from woz_tui.console.screens.note import NoteDialog  # noqa: PLC0415

        self._open(NoteDialog())

    def do_mistake(self) -> None:
        """Choose the run that was a mistake."""
        from woz_tui.console.screens.mistake import MistakeDialog  # noqa: PLC0415

        self._open(MistakeDialog())

    def do_failures(self) -> None:
        """Show failures; on a lost connection, what can be done."""
        if self._console.picture.lost:
            self.open_lost()
            return
        if not self._console.picture.unseen():
            self._console.news("nothing has failed that you have not seen")
            return
        from woz_tui.console.screens.failures import FailuresDialog  # noqa: PLC0415

        self._open(FailuresDialog())

    def do_help(self) -> None:
        """Show all keys."""
        from woz_tui.console.screens.help import HelpDialog  # noqa: PLC0415

        self._open(HelpDialog())

    def do_start(self) -> None:
        """Choose participant and condition."""
        from woz_tui.console.screens.start import StartDialog  # noqa: PLC0415

        self._open(StartDialog())

    def do_trial(self) -> None:
        """Begin or end a trial or a break, ask a questionnaire."""
        from woz_tui.console.screens.trial import TrialDialog  # noqa: PLC0415

        self._open(TrialDialog())

    def do_questionnaire(self) -> None:
        """Ask on where the questionnaire under way stands."""
        from woz_tui.console.screens.questionnaire import QuestionnaireDialog  # noqa: PLC0415

        self._open(QuestionnaireDialog())

    def offer(self, questionnaire: str, otherwise: Callable[[], None] | None = None) -> None:
        """A questionnaire is due: now, or later; `otherwise`: what comes instead of asking it."""
        from woz_tui.console.screens.trial import OfferDialog  # noqa: PLC0415

        self._open(OfferDialog(questionnaire, otherwise))

    def trial_over(self, reply: r.Reply) -> None:
        """A trial is over: what is to be asked now is offered."""
        if not reply.ok:
            self.refused(reply)
        else:
            self.offer_due()

    def offer_due(self) -> None:
        """Offer what is to be asked now, if anything is and nothing is being asked."""
        study = self._console.picture.study
        if study.due and study.asked is None:
            self.offer(study.due[0])

    def do_preflight(self) -> None:
        """Run the checks."""
        from woz_tui.console.screens.preflight import PreflightDialog  # noqa: PLC0415

        self._open(PreflightDialog())

    def do_reload(self) -> None:
        """Compare the experiment file with the session's."""
        from woz_tui.console.screens.reload import ReloadDialog  # noqa: PLC0415

        self._open(ReloadDialog())

    def do_drivers(self) -> None:
        """Show the drivers' health."""
        from woz_tui.console.screens.drivers import DriversDialog  # noqa: PLC0415

        self._open(DriversDialog())

    def do_body(self) -> None:
        """Show a body in full size."""
        from woz_tui.console.screens.body import BodyDialog  # noqa: PLC0415

        self._open(BodyDialog())

    def do_knobs(self) -> None:
        """Show the MIDI panel."""
        from woz_tui.console.screens.knobs import KnobsDialog  # noqa: PLC0415

        self._open(KnobsDialog())

    def do_robot(self) -> None:
        """Show a robot's settings, and change them."""
        from woz_tui.console.screens.robot import RobotDialog  # noqa: PLC0415

        self._open(RobotDialog())

    def do_move(self) -> None:
        """Type and play an animation."""
        from woz_tui.console.screens.move import MoveDialog, players  # noqa: PLC0415

        if players(self._console.picture):
            self._open(MoveDialog())
        else:
            self._console.news("no driver of this session plays animations")

    def do_camera(self) -> None:
        """Show what the robot's camera sees."""
        from woz_tui.console.screens.camera import CameraDialog  # noqa: PLC0415

        self._open(CameraDialog())

    def do_engagement(self) -> None:
        """Show the engagement model."""
        from woz_tui.console.screens.engagement import EngagementDialog  # noqa: PLC0415

        self._open(EngagementDialog())

    def steer(self, order: Order, key: str = "") -> None:
        """The wizard's hand on the engagement model; some orders ask for more first."""
        from woz_tui.console.screens.orders import asked  # noqa: PLC0415

        engaged = self._console.picture.engaged
        if not is_offered(engaged, self._console.picture.verbs):
            self._console.news("this session has no engagement model")
            return
        dialog = asked(order, engaged, key)
        if dialog is not None:
            self._open(dialog)
        else:
            self.ask(request(order, engaged, key))

    def do_profile(self) -> None:
        """Choose what may be used."""
        from woz_tui.console.screens.profile import ProfileDialog  # noqa: PLC0415

        self._open(ProfileDialog())

    def do_leave(self) -> None:
        """End the session, leave it running, or stay."""
        from woz_tui.console.screens.leave import LeaveDialog  # noqa: PLC0415

        self._open(LeaveDialog())

    def open_lost(self) -> None:
        """The robot process is gone: say so and offer what can be done."""
        from woz_tui.console.screens.lost import EndedDialog, LostDialog  # noqa: PLC0415

        if not self._ending:
            self._open(EndedDialog() if self._console.picture.ended else LostDialog())

    def close_lost(self) -> None:
        """The robot process is back: nothing to choose any more."""
        from woz_tui.console.screens.lost import LostDialog  # noqa: PLC0415

        if isinstance(self._console.dialog, LostDialog):
            self._console.close_dialog()

    def _open(self, dialog: Dialog) -> None:
        self._console.open_dialog(dialog)

    def do_panel_next(self) -> None:
        """The next panel."""
        self._console.walk(1)

    def do_panel_back(self) -> None:
        """The panel before."""
        self._console.walk(-1)

    def do_script_on(self) -> None:
        """One line on without playing."""
        self._script(1)

    def do_script_back(self) -> None:
        """One line back without playing."""
        self._script(-1)

    def _script(self, by: int) -> None:
        picture = self._console.picture
        to = picture.position + by
        if 0 <= to <= len(picture.script):
            self.ask(r.AskScript(play=False, to=to))

    def do_cut(self) -> None:
        """Cut the last run short."""
        active = self._console.picture.runs.active
        if not active:
            self._console.news("nothing is being played")
            return
        self.ask(r.AskCancel(run=next(reversed(active))))

    def do_redraw(self) -> None:
        """Paint every cell again."""
        self._console.refresh(layout=True)

    def do_dark(self) -> None:
        """Dark colours."""
        self._console.theme = "woz-dark"

    def do_light(self) -> None:
        """Light colours."""
        self._console.theme = "woz-light"

    def do_sixteen(self) -> None:
        """The terminal's own colours."""
        self._console.theme = "woz-16"
