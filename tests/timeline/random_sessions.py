"""Sessions at random: such as the robot process would have recorded, and damaged ones."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any

import msgspec
from hypothesis import strategies as st

from tests.protocol.examples import messages as examples
from tests.protocol.feature_examples import feature_examples
from woz_tui.config.engagement_words import STATES
from woz_tui.features.delay.kinds import ActionHeld, ShapingChanged
from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.features.profiles.kinds import ProfileChanged
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import StudySettings, WelcomeSettings

SECOND = 1_000_000
#: What makes messages of questionnaires, where there are any.
_ASKED = feature_examples("questionnaires", "MAKERS")
#: `settings.study` of what consoles are shown.
STUDY = msgspec.convert({
    "design": {"order": "latin-square", "within": True, "trials": 2},
    "questionnaires": [
        {"name": "each", "when": "trial"},
        {"name": "ux", "when": "condition"},
        {"name": "last", "when": "end"},
        {"name": "whenever", "when": "hand"},
    ],
    "preflight": [{"check": "door"}, {"check": "table"}],
    "blind": {},
}, StudySettings)  # fmt: skip


def start(participant: str = "P01", condition: str = "warm") -> m.SessionStart:
    """The first line of a log."""
    return m.SessionStart(
        session="S01", participant=participant, condition=condition, wizard="W1",
        software={"name": "woz-tui"}, experiment="guide.yaml", experiment_sha256="ab" * 32,
        seed=1, clock={"source": "monotonic", "wall_at_t0": "2026-03-01T10:00:00.000000Z"},
    )  # fmt: skip


def plan(**settings: Any) -> m.SessionPlan:
    """What consoles are shown."""
    return m.SessionPlan(
        title="Guide", panels=[], script=[], verbs={}, variables=[], conditions=["warm", "cold"],
        keyboard="us", drivers=["robot"], settings=WelcomeSettings(study=STUDY, **settings),
    )  # fmt: skip


def stamped(course: Sequence[tuple[int, m.Message]]) -> list[m.Message]:
    """Messages with the time (microseconds) at which each came, numbered in their order."""
    return [
        msgspec.structs.replace(message, seq=seq, t=t) for seq, (t, message) in enumerate(course)
    ]


def timed(*course: tuple[float, m.Message]) -> list[m.Message]:
    """The same with the time in seconds."""
    return stamped([(round(seconds * SECOND), message) for seconds, message in course])


class Recording:
    """Messages as the robot process publishes them: what begins ends, one trial at a time, ids
    are new. What happens next is drawn by `chance`.
    """

    def __init__(self, chance: random.Random) -> None:
        self._chance = chance
        self._t = 0
        self._course: list[tuple[int, m.Message]] = []
        self._count = 0
        self._participant, self._condition = "P01", "warm"
        self._number, self._trial = 1, 0
        self._in_break = self._begins_trials = False
        self._designed = chance.random() < 0.7
        self._asked = ""
        self._state = STATES[0]
        self._present = self._off = self._stopped = False
        self._lost: set[str] = set()
        self._speech = 0
        self._speaking = False
        #: Actions under way, and their commands that are.
        self._runs: dict[str, list[str]] = {}
        #: Commands that no driver has begun, and their drivers.
        self._waiting: dict[str, str] = {}
        #: The driver of each command.
        self._drivers: dict[str, str] = {}
        #: Runs that are a command without an action.
        self._direct: set[str] = set()
        self._say(start())
        self._say(plan())
        if chance.random() < 0.8:
            self._adopt()

    def messages(self, steps: int) -> list[m.Message]:
        """The session after so many steps."""
        for _ in range(steps):
            if self._chance.random() < 0.7:
                self._t += self._chance.choice([1, 400, 20_000, SECOND, 7 * SECOND])
            self._chance.choice(_STEPS)(self)
        self._t += self._chance.choice([0, SECOND])
        self._say(m.ClockTie(wall="x"))
        return stamped(self._course)

    def _say(self, message: Any) -> None:
        self._course.append((self._t, message))

    def _id(self) -> str:
        self._count += 1
        return f"i{self._count:05d}"

    # -- actions ----------------------------------------------------------------------------------

    def act(self) -> None:
        run, source = self._id(), self._chance.choice(["key", "script", "engagement"])
        edited = source == "script" and self._count % 3 == 0
        self._say(
            m.ActionRequested(run=run, action="Hello", panel="Speech", source=source, edited=edited)
        )
        if self._stopped:
            self._say(m.ActionRefused(run=run, action="Hello", reason="stopped"))
            return
        if self._chance.random() < 0.2:
            action_held = ActionHeld(
                run=run, action="Hello", sort="speech", cued=self._t, until=self._t + SECOND
            )
            self._say(action_held)
        self._runs[run] = []
        for _ in range(self._chance.randint(1, 2)):
            self._command(run, source)

    def direct(self) -> None:
        if not self._stopped:
            self._direct.add(self._command("", "key"))

    def _command(self, run: str, source: str) -> str:
        command, driver = self._id(), self._chance.choice(["robot", "robot", "session"])
        args: dict[str, m.Json] = {"text": "hello"}
        self._say(
            m.Command(command=command, run=run, verb="say", args=args, driver=driver, source=source)
        )
        self._runs.setdefault(run or command, []).append(command)
        self._drivers[command] = driver
        self._waiting[command] = driver
        if self._chance.random() < 0.8:
            self._dispatch(command)
            if self._chance.random() < 0.6:
                self._say(m.Progress(command=command, driver=driver, expected_us=SECOND))
        return command

    def _dispatch(self, command: str) -> None:
        driver = self._waiting.pop(command, None)
        if driver is not None:
            self._t += 1000
            self._say(m.Dispatched(command=command, driver=driver, latency_us=1000))

    def end_run(self) -> None:
        if self._runs:
            run = self._chance.choice([*self._runs])
            self._end_run(run, self._chance.choice(["done", "done", "failed", "stopped"]))

    def _end_run(self, run: str, how: str) -> None:
        for command in self._runs.pop(run):
            driver = self._drivers[command]
            ends: dict[str, m.Message] = {
                "done": m.Done(
                    command=command, driver=driver, sent={}, latency_us=1000, duration_us=SECOND
                ),
                "failed": m.Failed(command=command, driver=driver, reason="hot"),
                "stopped": m.Stopped(command=command, driver=driver, reason="stop"),
            }
            if how != "stopped":
                self._dispatch(command)
            self._say(ends[how])
        if run not in self._direct:
            kinds = {"done": m.ActionDone, "failed": m.ActionFailed, "stopped": m.ActionStopped}
            self._say(kinds[how](run=run, action="Hello"))

    def knob(self) -> None:
        command = self._id()
        args: dict[str, m.Json] = {"yaw": 1}
        self._say(m.Command(command=command, verb="control", args=args, source="midi"))
        self._say(m.Dispatched(command=command, driver="robot", latency_us=10))
        self._say(m.Superseded(command=command, by="another"))

    def mistake(self) -> None:
        acts = [each.run for _, each in self._course if isinstance(each, m.ActionRequested)]
        if acts:
            self._say(m.Mistake(run=self._chance.choice(acts), action="Hello"))

    def mark(self) -> None:
        self._say(self._chance.choice([m.Marker(text="smile"), m.Note(text="rain")]))

    # -- the study --------------------------------------------------------------------------------

    def somebody(self) -> None:
        if self._trial or self._asked:
            return
        self._participant = self._chance.choice(["P01", "P02", "P03"])
        self._number = 1
        if self._designed:
            self._begins_trials = True
            order = self._chance.choice([["warm", "cold"], ["cold", "warm"]])
            self._condition = order[0]
            self._say(
                m.SessionChanged(participant=self._participant, condition=self._condition, trial=1)
            )
            over = self._chance.choice([None, [], [1, 3]])
            self._say(
                m.ConditionsAssigned(
                    participant=self._participant, order=order, method="hand", over=over
                )
            )
        else:
            self._say(m.SessionChanged(participant=self._participant))

    def condition(self) -> None:
        self._condition = self._chance.choice(["warm", "cold"])
        self._say(m.SessionChanged(condition=self._condition))

    def number(self) -> None:
        if not self._trial:
            self._number = self._chance.randint(0, 4)
            self._say(m.SessionChanged(trial=self._number))

    def trial(self) -> None:
        if not self._designed or self._asked:
            return
        if self._in_break:
            self.pause()
        if not self._trial:
            self._trial, self._begins_trials = 1, True
            self._say(m.TrialStarted(trial=self._number, condition=self._condition, planned=4))
            return
        outcome = self._chance.choice(["done", "done", "aborted", "excluded"])
        self._say(m.TrialEnded(trial=self._number, outcome=outcome))
        self._trial = 0
        self._number += outcome != "aborted"

    def pause(self) -> None:
        if self._begins_trials:  # before, reports have it belong to the number that was set
            self._in_break = not self._in_break
            self._say(m.BreakStarted(text="tea") if self._in_break else m.BreakEnded())

    def ask(self) -> None:
        if self._asked:
            name, self._asked = self._asked, ""
            reason = self._chance.choice(["done", "declined", "left"])
            self._tell_asked("ended", name, reason)
        else:
            self._asked = self._chance.choice(["each", "ux", "last", "whenever"])
            self._tell_asked("started", self._asked)

    def answer(self) -> None:
        if self._asked:
            self._tell_asked("answered", self._asked, self._chance.choice("ab"))

    def _tell_asked(self, what: str, *about: str) -> None:
        for made in _ASKED:
            self._say(made[what](*about))

    def tick(self) -> None:
        check, level = self._chance.choice(["door", "table"]), self._chance.choice(["ok", "error"])
        self._say(m.PreflightChecked(check=check, level=level, source="wizard"))

    def shape(self) -> None:
        hidden = self._chance.choice([[], ["distance"]])
        choices: list[m.Message] = [
            m.PerceptionChanged(hidden=hidden, blurred=[]),
            ShapingChanged(floor_us=SECOND, jitter_us=0, cues=["speech"]),
            ProfileChanged(profile=self._chance.choice(["child", "adult", ""])),
            m.PanelLocked(panel="Drive", locked=self._chance.random() < 0.5),
            *feature_examples("scripts", "HALTED"),
            *feature_examples("scripts", "MOVED"),
            PhaseChanged(
                phase=self._chance.choice(["opening", "whales", "closing", ""]),
                source=self._chance.choice(["key", "trial", "session", "reload"]),
            ),
        ]
        self._say(self._chance.choice(choices))

    # -- robot and visitor ------------------------------------------------------------------------

    def stop(self) -> None:
        if self._stopped:
            self._say(m.StopReleased(source="key"))
        else:
            self._say(m.StopPressed(source="key"))
            for run in list(self._runs):
                self._end_run(run, "stopped")
            self._t += 20_000
            self._say(m.StopConfirmed(confirmed=["robot"], missing=[], elapsed_us=20_000))
        self._stopped = not self._stopped

    def driver(self) -> None:
        name = self._chance.choice(["robot", "mic"])
        if name in self._lost:
            self._lost.discard(name)
            self._say(m.DriverConnected(driver=name))
        else:
            self._lost.add(name)
            self._say(self._chance.choice([m.DriverLost, m.DriverFaulted])(driver=name))
            if name == "mic" and self._speaking:
                self._end_speech()

    def lane(self) -> None:
        faulted = m.LaneFaulted(driver="robot", lane="body", command="c")
        self._say(self._chance.choice([faulted, m.LaneRecovered(driver="robot", lane="body")]))

    def settings(self) -> None:
        if "robot" in self._lost:
            return
        values: dict[str, m.Json] = {"volume": self._chance.choice([0.3, 0.7]), "eyes": "on"}
        wanted: dict[str, m.Json] = self._chance.choice([{}, {"volume": 0.5}])
        conflicts = self._chance.choice([[], ["Awareness is off."]])
        self._say(
            m.SettingsShown(driver="robot", values=values, wanted=wanted, conflicts=conflicts)
        )

    def model(self) -> None:
        if not self._present:
            return
        was, self._state = self._state, self._chance.choice(STATES)
        visitor = self._chance.choice(["", "V01"])
        self._say(
            m.EngagementChanged(
                was=was, now=self._state, outcome="o", why="", verdicts={}, visitor=visitor
            )
        )

    def switch(self) -> None:
        if not self._present or self._chance.random() < 0.2:
            self._adopt()
        else:
            self._off = not self._off
            sent: dict[str, m.Json] = {"run": "off" if self._off else "run"}
            done = m.Done(command="x", driver="engagement", sent=sent, latency_us=0, duration_us=0)
            self._say(done)

    def _adopt(self) -> None:
        gone = self._present and self._chance.random() < 0.3
        begin = self._chance.choice(["run", "run", "off"])
        if gone:
            self._present = False
        elif not self._present:
            self._present, self._state, self._off = True, STATES[0], begin == "off"
        self._say(m.EngagementAdopted(settings={} if gone else {"start": begin}))

    def speak(self) -> None:
        if "mic" in self._lost:
            return
        if self._speaking:
            self._end_speech()
            if self._chance.random() < 0.7:
                self._say(m.SpeechText(driver="mic", segment=self._speech, text="hm"))
        else:
            self._speech, self._speaking = self._speech + 1, True
            self._began = max(0, self._t - self._chance.choice([0, 300_000]))
            self._say(m.SpeechStarted(driver="mic", segment=self._speech, began=self._began))

    def _end_speech(self) -> None:
        self._speaking = False
        ended = max(self._began, self._t - self._chance.choice([0, 50_000]))
        self._say(m.SpeechEnded(driver="mic", segment=self._speech, began=self._began, ended=ended))

    def sense(self) -> None:
        value = self._chance.random()
        choices: list[m.Message] = [
            m.Reading(sensor="distance", value=value, driver="robot"),
            m.SensorChanged(sensor="distance", state=self._chance.choice(["stale", "ok"])),
            m.FaceShown(driver="robot", width=1, rows="0", emotion="", intensity=value),
            m.BodyChanged(driver="robot", values={"tempo": value}),
            m.ControlsMoved(driver="panel", values={self._chance.choice("ab"): 3}),
            m.ModeChanged(driver="robot", was="normal", now="demo"),
            m.RecorderState(level="ok", lag_us=1, path="x"),
        ]
        self._say(self._chance.choice(choices))

    def console(self) -> None:
        name = self._chance.choice(["con1", "con2"])
        attached = m.ConsoleAttached(console=name, role="wizard")
        self._say(
            self._chance.choice([attached, m.ConsoleLost(console=name, role="wizard", why="left")])
        )


_STEPS = [
    *(Recording.act, Recording.act, Recording.direct, Recording.end_run, Recording.end_run),
    *(Recording.knob, Recording.mistake, Recording.mark, Recording.somebody, Recording.condition),
    *(Recording.number, Recording.trial, Recording.trial, Recording.pause, Recording.ask),
    *(Recording.answer, Recording.tick, Recording.shape, Recording.stop, Recording.driver),
    *(Recording.lane, Recording.settings, Recording.model, Recording.model, Recording.switch),
    *(Recording.speak, Recording.sense, Recording.console),
]


@st.composite
def recordings(draw: st.DrawFn, most: int = 80) -> list[m.Message]:
    """A session as it would have been recorded."""
    steps = draw(st.integers(0, most))
    return Recording(random.Random(draw(st.integers(0, 2**32)))).messages(steps)


@st.composite
def damaged(draw: st.DrawFn) -> list[m.Message]:
    """The same with lines missing, doubled, late, out of order or from anywhere."""
    course = [(message.t, message) for message in draw(recordings())]
    others = draw(st.lists(st.sampled_from(examples()), max_size=20))
    course += [(draw(st.integers(-1, 10**8)), message) for message in others]
    chance = random.Random(draw(st.integers(0, 2**32)))
    match draw(st.sampled_from(["drop", "shuffle", "double", "swap"])):
        case "drop":
            course = [each for each in course if chance.random() < 0.7]
        case "shuffle":
            chance.shuffle(course)
        case "double":
            course = [each for one in course for each in [one] * chance.choice([1, 1, 2])]
        case "swap":
            course.sort(key=lambda each: each[0] + chance.randint(0, SECOND))
    if draw(st.booleans()) and course:
        course.insert(chance.randrange(len(course)), (draw(st.integers(-(2**63), 2**63)), _TIE))
    return stamped(course)


_TIE = m.ClockTie(wall="x")
