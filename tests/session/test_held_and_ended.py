"""What a feature holds, and what was ended meanwhile, never begins."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from tests.session.rig import SessionRig, call
from woz_tui.config.experiment import Action
from woz_tui.drivers.contract import Verb
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.session.action_runner import ActionRunner
from woz_tui.session.action_texts import GivenValues

KEY = RequestOrigin("key", "h")


class Forgetful:
    """Holds everything, and forgets nothing that it is to drop."""

    def __init__(self) -> None:
        self.begins: list[Callable[[], object]] = []

    def hold(
        self, run: str, name: str, source: str, verbs: Sequence[Verb], begin: Callable[[], object]
    ) -> bool:
        self.begins.append(begin)
        return True

    def drop(self, run: str) -> None: ...

    def filled(self, run: str, action: Action, given: GivenValues) -> None: ...


def test_what_was_stopped_does_not_begin_whatever_a_feature_does(tmp_path: Path) -> None:
    async def scene(rig: SessionRig) -> None:
        session, holds = rig.session, Forgetful()
        runner = ActionRunner(session.hub, session.bus, session.texts, 0.0, holds)
        hello = session.experiment.action("Hello")
        assert hello is not None
        runner.play(hello, KEY)
        runner.send(call("say", text="typed"), KEY)
        runner.stop_waiting("stop pressed")
        assert len(holds.begins) == 2
        for begin in holds.begins:
            begin()

    rig = SessionRig(tmp_path).run(scene, 2)
    assert {"say", "play"}.isdisjoint(verb for verb, _ in rig.driver().calls)
    assert rig.kinds(m.ActionEnd, m.End) == ["Refused", "ActionStopped"]
