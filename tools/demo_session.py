"""Experiments on robots without hardware, played in virtual time: always the same sessions.

Session, bus, log and driver are the real ones; only the clock is not, so that minutes pass at once
and every drawing shows the same moment.
"""

from __future__ import annotations

import asyncio
import contextlib
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec
from woz_drivers.simulated.driver import RobotTime, SimulatedRobot
from woz_drivers.simulated.settings import SimulatedSettings

from tests.drivers.body.rig import SteppedBody
from tests.session.rig import SessionRig
from tools import EXPERIMENTS
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Driver, DriverContext
from woz_tui.features.phases.in_session import PhaseController
from woz_tui.features.questionnaires.in_session import QuestionnaireController
from woz_tui.features.questionnaires.kinds import AskAnswer
from woz_tui.features.scripts.in_session import ScriptController
from woz_tui.features.study.in_session import TrialController
from woz_tui.gate.questions import RequestOrigin
from woz_tui.host.experiment_view import ExperimentView, plan_of
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.requests import PROTOCOL, Welcome
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session import Session

LOG = "recordings/2026-03-01T10-00-00_P07_S01.jsonl"
KEY = RequestOrigin("key", "", "con1")
#: How far the log lags behind in the picture; the real figure depends on the disk.
LAG_US = 4_000

#: A step of the session: seconds after its start, and what the wizard does then.
Step = tuple[float, Callable[[Session], object]]


class _LoopPace(RobotTime):
    """The loop's own time."""

    def now(self) -> float:
        return asyncio.get_running_loop().time()


class _Robot(SimulatedRobot):
    """The simulated robot on the loop's time."""

    def __init__(self, name: str, settings: SimulatedSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context, pace=_LoopPace())


def catalogue() -> dict[str, type[Driver]]:
    """Drivers without hardware, on the loop's time."""
    return {"simulated": _Robot, "body": SteppedBody}


def play(name: str) -> Callable[[Session], object]:
    """The action's key; what is refused is in the log."""

    def press(session: Session) -> None:
        with contextlib.suppress(RequestError):
            session.play(name, KEY)

    return press


def space(session: Session) -> object:
    """The script's next line."""
    script = session.features.of(ScriptController)
    return script.play_next(RequestOrigin("script", "space", "con1"))


WORKING: tuple[Step, ...] = (
    (12.0, space),
    (13.0, space),
    (17.0, space),
    (19.0, play("Happy")),
    (26.0, play("Yes")),
    (31.0, lambda session: session.mark("", "key")),
    (38.0, play("Repeat")),
    (41.0, lambda session: session.mistake("", "")),
    (47.0, lambda session: session.note("hesitates before the map")),
    (52.0, play("Gong")),
    (52.5, play("Gong")),
    (58.0, space),
    (60.4, play("Look about")),
)
#: The moment that is drawn, in seconds.
MOMENT = 61.2
STOPPED: tuple[Step, ...] = (*WORKING, (MOMENT - 0.1, lambda session: session.stop("key")))

#: EyePi by hand: it points while the wizard has just said something.
EYEPI: tuple[Step, ...] = (
    (3.0, play("Upbeat")),
    (5.0, play("Hello")),
    (9.0, play("Happy")),
    (12.0, play("Dance")),
    (18.0, play("Amazed")),
    (20.0, lambda session: session.mark("", "key")),
    (24.0, play("Yes")),
    (29.0, play("Happy")),
    (29.6, play("Point left")),
)
EYEPI_MOMENT = 30.1
SHOW: tuple[Step, ...] = tuple((at, space) for at in (1.0, 4.0, 10.0, 15.5, 21.0, 24.0))
#: Joy breaks down before Grim.
SHOW_MOMENT = 30.6


def ticked(session: Session) -> None:
    """Everything on the preflight list has been seen to."""
    for item in session.state.study.settings.preflight:
        session.tick(item.check, ok=True, text="", source="wizard")


def assigned(session: Session) -> None:
    """The participant gets the conditions as the design proposes them."""
    study = session.features.of(TrialController)
    study.assign("P07", [*study.propose("P07").order])


def asked(session: Session) -> None:
    """The study's questionnaire is begun, and its first question answered."""
    questionnaires = session.features.of(QuestionnaireController)
    questionnaires.begin_or_end("eindruck", "begin", "wizard", given="self")
    questionnaires.answer(AskAnswer(questionnaire="eindruck", item="angenehm", value=6))


#: A German study: the guide shows the whale in the first trial.
GERMAN_FILE = Path(__file__).with_name("german_session.yaml")
GERMAN: tuple[Step, ...] = (
    (0.5, assigned),
    (1.0, lambda session: session.features.of(TrialController).trial("begin", "")),
    (3.0, space),
    (9.0, space),
    (16.0, play("froh")),
    (18.0, space),
    (27.0, lambda session: session.mark("", "key")),
    (29.0, play("Ja")),
    (30.0, lambda session: session.note("zögert vor der Karte")),
    (32.0, play("repair filler")),
    (36.0, space),
    (37.8, play("Umsehen")),
)
GERMAN_MOMENT = 38.6
GERMAN_STOPPED: tuple[Step, ...] = (
    *GERMAN,
    (GERMAN_MOMENT - 0.1, lambda session: session.stop("key")),
)
GERMAN_ASKED: tuple[Step, ...] = (*GERMAN[:-2], (GERMAN_MOMENT - 1, asked))
GERMAN_BEGIN: tuple[Step, ...] = ((1.0, play("Umsehen")), (20.0, play("Nicken")))

#: An interview: the participant asks something at 26 s that no line answers.
INTERVIEW: tuple[Step, ...] = (
    (0.5, ticked),
    (1.0, lambda session: session.features.of(TrialController).trial("begin", "")),
    (3.0, lambda session: session.features.of(PhaseController).go_on("Home", KEY)),
    (15.0, space),
    (27.5, play("repair dont_know")),
    (32.0, space),
)
INTERVIEW_MOMENT = 28.4

#: The guide by itself: a visitor has asked something, the robot thinks.
GUIDE_MOMENT = 171.4
WARM = SessionIdentity(participant="P07", condition="warm", wizard="W2", seed=7)
TALKING = SessionIdentity(participant="P01", condition="empathic", wizard="W2", seed=7)
NAMED = SessionIdentity(participant="P07", wizard="W2", seed=7)
UNNAMED = SessionIdentity(wizard="W2", seed=7)
ALONE = SessionIdentity(participant="G01", condition="alone", wizard="W2", seed=7)


def demo(
    steps: tuple[Step, ...],
    moment: float = MOMENT,
    experiment: str | Path = "demo",
    watch: Callable[[Session], None] = lambda session: None,
    who: SessionIdentity = WARM,
    *,
    log: Path | None = None,
) -> Welcome:
    """What a console is told that attaches at `moment`; `watch` gets the session as it begins, and
    its log stays in the folder `log`, in `recordings`.
    """
    told: list[Welcome] = []

    async def scenario(rig: SessionRig) -> None:
        session, loop = rig.session, asyncio.get_running_loop()
        watch(session)
        session.hub.publish(m.ConsoleAttached(console="con1", role="wizard"))
        session.bus.unwatched = ""
        for at, act in steps:
            await asyncio.sleep(at - loop.time())
            act(session)
        await asyncio.sleep(moment - loop.time())
        told.append(welcome(session))
        await session.close("drawn", rest=False)

    drivers = catalogue()
    file = EXPERIMENTS / f"{experiment}.yaml" if isinstance(experiment, str) else experiment
    made = load(file, drivers)
    with tempfile.TemporaryDirectory() as folder:
        SessionRig(log or Path(folder), (), who, drivers, made).run(scenario)
    return told[0]


def welcome(session: Session) -> Welcome:
    """What a console is told that attaches now."""
    plan = plan_of(ExperimentView.of(session))
    return Welcome(
        protocol=PROTOCOL,
        console="con1",
        role="wizard",
        seq=session.hub.seq,
        t=session.hub.now(),
        title=plan.title,
        log=LOG,
        panels=plan.panels,
        script=plan.script,
        verbs=plan.verbs,
        variables=plan.variables,
        conditions=plan.conditions,
        keyboard=plan.keyboard,
        drivers=plan.drivers,
        state=_raw([*session.state.messages(plan=False), _log(session)]),
        recent=_raw(session.recent.lines),
        settings=plan.settings,
    )


def _log(session: Session) -> m.Message:
    return m.RecorderState(level="ok", lag_us=LAG_US, path=LOG, t=session.hub.now())


def _raw(lines: Sequence[m.Message]) -> list[msgspec.Raw]:
    return [msgspec.Raw(codec.encode(line).rstrip()) for line in lines]
