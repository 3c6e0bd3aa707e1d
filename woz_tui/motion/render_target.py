"""What is to be rendered: a body out of a file, and the score that a name stands for."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from woz_tui.config.experiment import Action, DriverSpec, Experiment, ParallelCalls
from woz_tui.config.loading import load, load_robot
from woz_tui.config.problems import hint, listed
from woz_tui.config.robots import is_robot_file
from woz_tui.drivers.contract import Argument, Driver, RejectedError
from woz_tui.motion.body_shape import BodyShape, FaceShape
from woz_tui.motion.body_verbs import BRIEF, body_verbs
from woz_tui.motion.engine import Engine
from woz_tui.motion.keyframes import KeyframeMove
from woz_tui.motion.modes import Mode
from woz_tui.motion.rendering import (
    CUT_OFF,
    LONGEST_S,
    Input,
    RenderedDriver,
    RenderScript,
    Step,
    Tell,
)

#: Inputs that are no verb of a body.
BEYOND = (
    ("seen", "`x`, `y` (-1..1, null: nothing is seen), `size` (0..1)", "what the camera sees"),
    ("stop", "", "ends all movement and returns to the mode normal"),
    ("freeze", "", "the emergency stop: stands still until `resume`"),
    ("resume", "", "the emergency stop is released"),
)


def inputs_table() -> str:
    """A table of all inputs in Markdown."""
    shape = BodyShape(joints={}, face=FaceShape())
    rows = [
        (verb.name, ", ".join(map(_argument, verb.arguments)), verb.summary)
        for verb in body_verbs(shape, ())
    ]
    head = ["| input | arguments | what it does |", "|---|---|---|"]
    return "\n".join(
        [*head, *(f"| `{name}` | {what} | {why} |" for name, what, why in (*rows, *BEYOND))]
    )


def _argument(argument: Argument) -> str:
    parts = [argument.kind if argument.kind != "choice" else ""]
    if argument.kind == "choice":
        parts = [" ".join(filter(None, argument.choices))] if argument.name != "move" else ["text"]
    if argument.range is not None:
        parts.append(str(argument.range))
    if not argument.required:
        parts.append("optional")
    return f"`{argument.name}` ({', '.join(filter(None, parts))})"


# --------------------------------------------------------------------------------------------------

IDLE = "idle"
#: Seconds of `idle` and of the modes that do not end by themselves.
IDLE_S = 10.0
#: How many smoothing time constants until nothing moves any more.
SETTLED = 6.0
#: Modes by what `NAME` says; normal is `idle`.
MODES = tuple(mode.value for mode in Mode if mode is not Mode.NORMAL)


class RenderError(Exception):
    """What was asked for cannot be rendered; the text says why, and what could be."""


@dataclass(frozen=True, slots=True)
class RenderTarget:
    """One body of a file, ready to be rendered."""

    spec: DriverSpec
    driver: type[RenderedDriver]
    experiment: Experiment | None
    engine: Engine
    #: A move that is played beside those of the body; None: there is none.
    added: KeyframeMove | None = None

    @classmethod
    def of(
        cls, file: Path, catalogue: Mapping[str, type[Driver]], body: str, seed: int | None
    ) -> RenderTarget:
        """The body called `body` (empty: the only one) of an experiment or a robot file.

        Raises `ExperimentError` for what is wrong with the file, `RenderError` for the body.
        """
        experiment = None if is_robot_file(file) else load(file, catalogue)
        drivers = load_robot(file, catalogue) if experiment is None else experiment.drivers
        bodies = {
            spec.name: (spec, driver)
            for spec in drivers
            if issubclass(driver := catalogue[spec.type], RenderedDriver)
        }
        spec, driver = bodies[_chosen(bodies, body, file)]
        return cls(spec, driver, experiment, driver.engine(spec.settings, seed=seed))

    def with_move(self, move: KeyframeMove) -> RenderTarget:
        """The same body, which can play this move, too; it takes the place of one of its name."""
        self.engine.set_moves({**self.spec.settings.repertoire.moves, move.name: move})
        return replace(self, added=move)

    def keyframes(self, name: str) -> KeyframeMove | None:
        """The move that is played as `name`, if it is made of frames."""
        if self.added is not None and name == self.added.name:
            return self.added
        move = self.spec.settings.repertoire.moves.get(name) if name in self.playable else None
        return move if isinstance(move, KeyframeMove) else None

    @property
    def body(self) -> str:
        return self.spec.name

    @property
    def verbs(self) -> tuple[str, ...]:
        """What the body can be asked for."""
        return tuple(verb.name for verb in self.spec.offer.verbs)

    @property
    def limits(self) -> dict[str, tuple[float, float]]:
        """Lowest and highest angle by joint, in degrees."""
        joints = self.spec.settings.joints
        return {name: (joint.min, joint.max) for name, joint in joints.items()}

    @property
    def settle(self) -> float:
        """Seconds after which a pose is held again, once what moved is over."""
        shape = self.spec.settings
        smoothing: float = shape.personality.smoothing
        return max(float(shape.crossfade), SETTLED * smoothing)

    def translated(self, one: Input) -> Input:
        """An input as the engine knows it: names of poses are the driver's own affair."""
        try:
            verb, args = self.driver.translated(self.spec.settings, one.verb, one.args)
        except RejectedError:
            return one  # the engine will say what is wrong with it, at its time
        return replace(one, verb=verb, args=args)

    def score(
        self, name: str, inputs: list[Input], tell: Tell
    ) -> tuple[RenderScript, float | None]:
        """What `name` stands for, and how long it lasts if it does not end by itself.

        A mode, `idle`, something to play or an action, in this order. Raises `RenderError` with
        all names for any other.
        """
        last = inputs[-1].t + 1.0 if inputs else 0.0
        action = self.experiment.action(name) if self.experiment is not None else None
        seconds: float | None = None
        steps: list[Step] = []
        if name == IDLE:
            seconds = None if inputs else IDLE_S
        elif name in MODES:
            steps = [(self._input("mode", {"mode": name}),)]
            if name != Mode.DEMO.value:
                seconds = min(max(IDLE_S, last), LONGEST_S)
                if last > seconds:
                    tell(seconds, CUT_OFF)
        elif name in self.playable or self.keyframes(name) is not None:
            steps = [(self._input("play", {"move": name}),)]
        elif action is not None:
            steps = [*self._steps(action, tell)]
        else:
            raise self._unknown(name)
        awaited = frozenset(v.name for v in self.spec.offer.verbs if not v.stream) - BRIEF
        return RenderScript(steps, inputs, awaited), seconds

    @property
    def playable(self) -> tuple[str, ...]:
        """Everything that `play` takes."""
        for verb in self.spec.offer.verbs:
            if verb.name == "play":
                return verb.arguments[0].choices
        return ()

    def _input(self, verb: str, args: Mapping[str, Any]) -> Input:
        return self.translated(Input(0.0, verb, args))

    def _steps(self, action: Action, tell: Tell) -> Iterable[Step]:
        left_out: dict[str, None] = {}
        for step in action.steps:
            if not isinstance(step, ParallelCalls):
                yield step.seconds
                continue
            mine = [call for call in step.calls if call.driver == self.body]
            left_out.update({f"{c.verb} ({c.driver})": None for c in step.calls if c not in mine})
            yield tuple(self._input(call.verb, call.args) for call in mine)
        if left_out:
            tell(0.0, f"left out, because {self.body} cannot do it: {', '.join(left_out)}")

    def _unknown(self, name: str) -> RenderError:
        actions = (
            [each.name for panel in self.experiment.panels for each in panel.actions]
            if self.experiment is not None
            else []
        )
        known = [*self.playable, *MODES, IDLE, *actions]
        text = f"{self.body} has nothing called {name!r}{hint(name, known)}"
        text += f"\n  moves and poses: {', '.join(self.playable)}"
        text += f"\n  modes: {', '.join((*MODES, IDLE))}"
        if actions:
            text += f"\n  actions: {', '.join(actions)}"
        return RenderError(text)


def _chosen(bodies: Collection[str], body: str, file: Path) -> str:
    if not bodies:
        raise RenderError(f"{file}: no driver of it is a body (type: body)")
    if body:
        found = [name for name in bodies if name == body or name.startswith(f"{body}.")]
        if len(found) == 1:
            return found[0]
        raise RenderError(
            f"{file}: no body is called {body!r}{hint(body, bodies)}; there are {listed(bodies)}"
        )
    if len(bodies) > 1:
        raise RenderError(f"{file}: which body? --body {' or --body '.join(bodies)}")
    return next(iter(bodies))
