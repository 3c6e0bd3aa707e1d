"""Draws the console's pictures for the documentation: `python -m tools.screenshots [folder]`.

The real app runs without a terminal. What it shows comes from the demo experiment, played in
virtual time (`demo_session`), or from a scene where the picture needs what the demo does not have:
a driver that does not confirm a stop, a failure nobody has seen. Both are always the same.
"""

from __future__ import annotations

import asyncio
import os
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import msgspec

from tests.console import bodies, scenes, study_scene
from tests.console.scripted_feed import ScriptedFeed
from tests.features.questionnaires import scene
from tools import EXPERIMENTS, IMAGES, demo_session
from woz_tui.config.loading import load
from woz_tui.config.screen_language import use
from woz_tui.console.app import Console
from woz_tui.console.drawing.glyphs import ASCII, UNICODE
from woz_tui.console.drawing.theme import Appearance
from woz_tui.console.input.keyboard import Keyboard
from woz_tui.console.link.message_feed import MessageFeed
from woz_tui.console.replay.app import ReplayConsole
from woz_tui.console.replay.commands import ReplayKeyboard
from woz_tui.drivers import plugins
from woz_tui.features.dictation.kinds import Dictated, DictationListens
from woz_tui.features.move_editor.app import MoveEditorApp
from woz_tui.features.move_editor.move_file import EditedFile
from woz_tui.features.proposals.kinds import ProposedItem, SuggestOffered, SuggestSettings
from woz_tui.features.study.condition_proposal import propose
from woz_tui.features.study.kinds import AskProposal
from woz_tui.features.study.section import DESIGN
from woz_tui.host.experiment_view import ExperimentView, plan_for_log
from woz_tui.log.log_index import LogIndex
from woz_tui.motion.render_target import RenderTarget
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import Reply, Request, Welcome
from woz_tui.replay.opened_log import IndexedSamples
from woz_tui.replay.player import ReplayPlayer, ReplayStart
from woz_tui.replay.recording import Recording
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session import Session
from woz_tui.system.clock import ManualClock


@dataclass(frozen=True)
class Shot:
    """One picture: its name and size, the scene, the look, keys pressed before it is taken, and the
    language of the screen.
    """

    name: str
    width: int
    height: int
    feed: Callable[[], MessageFeed]
    look: Appearance = field(default_factory=lambda: Appearance(UNICODE))
    keys: tuple[str, ...] = ()
    colours: bool = True
    language: str = "en"


def demo() -> ScriptedFeed:
    """In the middle of the demo."""
    feed = ScriptedFeed()
    feed.round_trip_us = 23_000
    feed.begin_with(demo_session.demo(demo_session.WORKING))
    return feed


def eyepi() -> ScriptedFeed:
    """EyePi on its way to a point at its left."""
    return _told(demo_session.demo(demo_session.EYEPI, demo_session.EYEPI_MOMENT, "eyepi"))


def show() -> ScriptedFeed:
    """Two robots in the middle of their show."""
    return _told(demo_session.demo(demo_session.SHOW, demo_session.SHOW_MOMENT, "show"))


def guide() -> ScriptedFeed:
    """The guide by itself: it thinks, the visitor waits."""
    moment, who = demo_session.GUIDE_MOMENT, demo_session.ALONE
    return _told(demo_session.demo((), moment, "guide", who=who))


def interview() -> ScriptedFeed:
    """The wizard answers what nobody foresaw."""
    steps, moment = demo_session.INTERVIEW[:5], demo_session.INTERVIEW_MOMENT
    return _told(demo_session.demo(steps, moment, "interview", who=demo_session.TALKING))


def proposing() -> ScriptedFeed:
    """The same with a model that proposes what to say."""
    steps, moment = demo_session.INTERVIEW[:5], demo_session.INTERVIEW_MOMENT
    first = demo_session.demo(steps, moment, "interview", who=demo_session.TALKING)
    sentences = ("I would like to hear more about your kitchen.", "What did you cook there?")
    items = [ProposedItem(str(place), text=text) for place, text in enumerate(sentences)]
    offered = SuggestOffered(
        set="s1", source="model", who="suggest", items=items, until=first.t + 14_000_000
    )
    return _told(first, SuggestSettings(sources=["model"]), offered)


def dictating() -> ScriptedFeed:
    """The field that listens."""
    attached = m.ConsoleAttached(console="p1", role="program", name="dictate")
    first = demo_session.demo(demo_session.WORKING)
    text = Dictated(dictation=1, text="That is the heart of a blue whale")
    return _told(first, attached, DictationListens(on=True, console=first.console), text)


def _told(first: Welcome, *messages: m.Message) -> ScriptedFeed:
    feed = ScriptedFeed()
    feed.round_trip_us = 23_000
    stamped = (
        msgspec.structs.replace(message, seq=10**6 + place, t=first.t)
        for place, message in enumerate(messages)
    )
    feed.begin_with(first, *stamped)
    return feed


def replayed() -> MessageFeed:
    """The demo's log, 52.8 s after it began: two gongs, one of which still sounds."""
    folder = tempfile.TemporaryDirectory()
    demo_session.demo(demo_session.STOPPED, watch=_shown, log=Path(folder.name))
    index = LogIndex.open(next(Path(folder.name).glob("recordings/made.jsonl")))
    recording = Recording(index.actions, IndexedSamples(index))
    feed = _Still(
        ReplayPlayer(recording, ReplayStart(at_us=52_800_000, paused=True), demo_session.LOG)
    )
    feed.kept = (folder, index)  # the samples are read while it is played
    return feed


def _shown(session: Session) -> None:
    session.hub.publish(plan_for_log(ExperimentView.of(session)))


class _Still(ScriptedFeed):
    """A replay without a thread, at one moment."""

    kept: tuple[object, ...] = ()

    def __init__(self, player: ReplayPlayer) -> None:
        super().__init__()
        self._player = player
        self.begin_with(*player.begin(0))

    def ask(self, request: Request) -> int:
        """Answer at once."""
        self.deliver(*self._player.ask(request, 0))
        return 0


def knobs() -> ScriptedFeed:
    """A panel in use: two of its controls wait for take-over."""
    places = {"knob-1": 64, "knob-2": 88, "knob-3": 20, "knob-4": 110, "knob-8": 70}
    places |= {"slider-1": 41, "slider-2": 77, "slider-3": 64, "slider-5": 90, "slider-6": 100}
    moved = bodies.controls_moved(
        {**places, "slider-7": 112},
        {"knob-4": 0, "slider-1": 101},
        ("button-8", "cycle"),
    )
    return _told(bodies.welcome([*bodies.alive(), moved]))


def questionnaire() -> ScriptedFeed:
    """In the middle of a questionnaire."""
    return _told(
        study_scene.welcome(
            scene.questionnaire_started(), scene.questionnaire_answered("pleasant", 6.0)
        )
    )


def trial() -> ScriptedFeed:
    """A trial under way, with blind conditions and some things kept from the wizard."""
    kept: dict[str, m.Json] = {"hide": ["loudness"], "blur": ["distance", "transcript"]}
    told = study_scene.study_description(blind=study_scene.LABELS, perception=kept)
    state = [*scenes.sensors(), m.SessionChanged(condition="cold", t=0), study_scene.trial()]
    return _told(study_scene.welcome(*state, study=told, recent=scenes.history()))


def working() -> ScriptedFeed:
    """In the middle of another session."""
    feed = ScriptedFeed()
    feed.round_trip_us = 23_000
    first = scenes.welcome(
        state=[*scenes.healthy(), *scenes.sensors()],
        recent=[*scenes.history(), *scenes.speaking()],
    )
    feed.begin_with(first)
    return feed


def stopped() -> ScriptedFeed:
    """The stop is pressed; one driver did not confirm, another one is lost."""
    feed = working()
    first = scenes.welcome(
        state=[
            *scenes.healthy(),
            *scenes.sensors(),
            m.DriverLost(driver="face", detail="the port is gone", t=scenes.NOW - 2_000_000),
            m.StopPressed(source="key", t=scenes.NOW - 900_000),
            m.StopConfirmed(
                confirmed=["head", "voice"], missing=["face"], elapsed_us=500_000, t=scenes.NOW
            ),
        ],
        recent=scenes.history(),
    )
    feed.begin_with(first)
    return feed


def german(steps: tuple[demo_session.Step, ...], who: SessionIdentity) -> ScriptedFeed:
    """A German study after these steps."""
    file, moment = demo_session.GERMAN_FILE, demo_session.GERMAN_MOMENT
    return _told(demo_session.demo(steps, moment, file, who=who))


GERMAN = partial(german, demo_session.GERMAN, demo_session.NAMED)
GERMAN_STOPPED = partial(german, demo_session.GERMAN_STOPPED, demo_session.NAMED)
GERMAN_ASKED = partial(german, demo_session.GERMAN_ASKED, demo_session.NAMED)


def german_begin() -> ScriptedFeed:
    """Nobody has been entered yet; whoever is gets what the design proposes."""
    feed = german(demo_session.GERMAN_BEGIN, demo_session.UNNAMED)
    made = load(demo_session.GERMAN_FILE, demo_session.catalogue())
    design = DESIGN.of(made)
    assert design is not None
    data = propose("P07", design, made.conditions, []).data()
    feed.answers[AskProposal] = lambda asked, ref: Reply(ref=ref, ok=True, data=data)
    return feed


#: What is drawn of the German screen: key, scene, and keys that are pressed.
GERMAN_SCENES: Mapping[str, tuple[Callable[[], MessageFeed], tuple[str, ...]]] = {
    "main": (GERMAN, ()),
    "participant": (german_begin, ("ctrl+t", "P", "0", "7")),
    "stop": (GERMAN_STOPPED, ()),
    "questionnaire": (GERMAN_ASKED, ("*", "q")),
    "help": (GERMAN, ("?",)),
}
SIZES = ((80, 24), (160, 50))
SHOTS = (
    Shot("console-80x24", 80, 24, demo),
    Shot("console-160x50", 160, 50, demo),
    Shot("console-100x36", 100, 36, demo),
    Shot("interview", 80, 24, interview),
    Shot("interview-160x50", 160, 50, interview),
    Shot("interview-light", 80, 24, interview, Appearance(UNICODE, "woz-light")),
    Shot("eyepi", 160, 50, eyepi),
    Shot("eyepi-small", 80, 24, eyepi),
    Shot("eyepi-body", 80, 24, eyepi, keys=(";",)),
    Shot("two-robots", 160, 50, show),
    Shot("guide", 160, 50, guide),
    Shot("engagement", 100, 36, guide, keys=("=",)),
    Shot("knobs", 80, 24, knobs, keys=("+",)),
    Shot("replay", 100, 36, replayed),
    Shot("replay-small", 80, 24, replayed),
    Shot("replay-go", 80, 24, replayed, keys=("g",)),
    Shot("stop", 80, 24, stopped),
    Shot("help", 80, 24, demo, keys=("?",)),
    Shot("questionnaire", 80, 24, questionnaire, keys=("*", "q", "8")),
    Shot("trial", 80, 24, trial, keys=("*",)),
    Shot("slots", 80, 24, interview, keys=("1", "r")),
    Shot("proposals", 80, 24, proposing),
    Shot("dictation", 80, 24, dictating, keys=("insert",)),
    Shot("say", 80, 24, demo, keys=("/", "P", "l", "e")),
    Shot("find", 100, 36, working, keys=(":", "p", "o", "i")),
    Shot("light", 80, 24, demo, Appearance(UNICODE, "woz-light")),
    Shot("no-colour", 80, 24, working, Appearance(UNICODE, "woz-16"), colours=False),
    Shot("linux-console", 80, 24, working, Appearance(ASCII, "woz-16")),
    *(
        Shot(f"german-{name}-{width}x{height}", width, height, feed, keys=keys, language="de")
        for name, (feed, keys) in GERMAN_SCENES.items()
        for width, height in SIZES
    ),
)


async def shoot(shot: Shot, feed: MessageFeed, folder: Path) -> Path:
    """Run the app, press the keys, write the picture."""
    os.environ.pop("NO_COLOR", None)
    if not shot.colours:
        os.environ["NO_COLOR"] = "1"
    use(shot.language)
    clock = ManualClock()
    if isinstance(feed, _Still):
        console: Console = ReplayConsole(feed, ReplayKeyboard(feed), look=shot.look, clock=clock)
    else:
        console = Console(feed, Keyboard(feed), look=shot.look, clock=clock)
    async with console.run_test(size=(shot.width, shot.height)) as pilot:
        await pilot.pause()
        for key in shot.keys:
            await pilot.press(key)
        await pilot.pause()
        if isinstance(feed, _Still):
            clock.advance(10)  # what it says at the beginning is gone
        console.paint()
        await pilot.pause()
        path = folder / f"{shot.name}.svg"
        drawn = console.export_screenshot(title="woz")
        # Browsers keep the blanks at a text's edges as it is; other viewers only if told to.
        drawn = drawn.replace("<text ", '<text xml:space="preserve" ')
        path.write_text(drawn, encoding="utf-8")
    return path


#: Pictures of `woz edit-move`: a new move with the keys of docs/how-to/edit-move.md, and one of the
#: examples.
EDITED = (
    (
        "editor-80x24",
        (80, 24),
        None,
        (
            *("down", *["shift+right"] * 3, "2", "0", "enter"),
            *(*["shift+right"] * 3, "0", "enter", "left"),
        ),
    ),
    ("editor-100x36", (100, 36), EXPERIMENTS / "moves" / "greet.yaml", ("right", "right", "down")),
)


async def shoot_editor(
    name: str, size: tuple[int, int], move: Path | None, keys: tuple[str, ...], folder: Path
) -> None:
    """Run the editor, press the keys, write the picture."""
    os.environ.pop("NO_COLOR", None)
    robot = EXPERIMENTS / "robots" / "eyepi.yaml"
    target = RenderTarget.of(robot, plugins.installed(), "", None)
    with tempfile.TemporaryDirectory() as scratch:
        file = move or Path(scratch) / "yes.yaml"
        app = MoveEditorApp(target, EditedFile(file, target.spec.settings), clock=ManualClock())
        async with app.run_test(size=size) as pilot:
            await pilot.press(*keys)
            await pilot.pause()
            drawn = app.export_screenshot(title="woz edit-move")
    drawn = drawn.replace("<text ", '<text xml:space="preserve" ')
    (folder / f"{name}.svg").write_text(drawn, encoding="utf-8")


def main() -> None:
    """Draw all pictures, or those named after the folder."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else IMAGES
    folder.mkdir(parents=True, exist_ok=True)
    wanted = set(sys.argv[2:])
    for shot in SHOTS:
        if not wanted or shot.name in wanted:
            asyncio.run(shoot(shot, shot.feed(), folder))
    for name, size, move, keys in EDITED:
        if not wanted or name in wanted:
            asyncio.run(shoot_editor(name, size, move, keys, folder))


if __name__ == "__main__":
    main()
