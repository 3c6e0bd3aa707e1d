"""A session with a study around it, and earlier logs of the same experiment."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec

from tests.session.rig import SessionRig, action, call, experiment, together
from woz_tui.config.experiment import Experiment
from woz_tui.config.study import PerceptionLimits, Study
from woz_tui.features.study.design import Design
from woz_tui.features.study.in_session import TrialController
from woz_tui.features.study.section import DESIGN
from woz_tui.log.disk import LogDisk
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import WelcomeSettings
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session import Session

PLANNED = Design(trials=2, blind={"warm": "A", "cold": "B"})
STUDY = Study(
    preflight=("the door is shut", "the camera sees the table"),
    perception=PerceptionLimits(("distance",), ("transcript",)),
)
#: What no feature says of an experiment.
NO_FEATURES: Mapping[object, Any] = {}
GREETING = {"warm": "Hello {participant}!", "cold": "Hello."}


def study_experiment(
    tmp_path: Path,
    study: Study = STUDY,
    sections: Mapping[object, Any] = NO_FEATURES,
    design: Design | None = PLANNED,
) -> Experiment:
    """The experiment of the rig with this study, and an action that differs by condition."""
    made = experiment(tmp_path)
    speech, *rest = made.panels
    greet = action("Greet", together(call("say", text="{greeting} I am in the {place}.")))
    return replace(
        made,
        panels=(replace(speech, actions=(*speech.actions, greet)), *rest),
        by_condition={"greeting": GREETING},
        study=study,
        sections={**made.sections, DESIGN: design, **sections},
    )


def trial_control(session: Session) -> TrialController:
    """What begins and ends the session's trials."""
    return session.features.of(TrialController)


def renamed(tmp_path: Path) -> Experiment:
    """The same, in which the condition `warm` is called `friendly`."""
    design = Design(trials=2, blind={"friendly": "A", "cold": "B"})
    return replace(
        study_experiment(tmp_path, design=design),
        conditions=("friendly", "cold"),
        by_condition={"greeting": {"friendly": "Hi!", "cold": "Hello."}},
    )


def on_stage(
    tmp_path: Path,
    scenario: Callable[[SessionRig], Awaitable[None]],
    study: Study = STUDY,
    identity: SessionIdentity | None = None,
    *,
    disk: LogDisk | None = None,
    sections: Mapping[object, Any] = NO_FEATURES,
    design: Design | None = PLANNED,
) -> SessionRig:
    """Plays the scenario in virtual time, then ends the session."""
    made = study_experiment(tmp_path, study, sections, design)
    rig = SessionRig(tmp_path, identity=identity or SessionIdentity(), made=made, disk=disk)
    return rig.run(scenario, 1)


def short_messages(rig: SessionRig, *kinds: type[m.Message]) -> list[str]:
    """Messages of these kinds in short: the kind's tag and what it is about."""
    return [_short(line) for line in rig.of(*kinds)]


def _short(line: m.Message) -> str:
    about = [
        getattr(line, name)
        for name in ("trial", "condition", "outcome", "questionnaire", "item", "reason")
        if hasattr(line, name)
    ]
    return " ".join([str(line.__struct_config__.tag), *(str(each) for each in about if each != "")])


def log(folder: Path, name: str, lines: Iterable[m.Message], *, title: str | None = None) -> Path:
    """An action file with these lines, numbered, a `session.plan` with `title` among them."""
    folder.mkdir(exist_ok=True)
    path = folder / f"{name}.jsonl"
    plan = [m.SessionPlan(
        title=title, panels=[], script=[], verbs={}, variables=[], conditions=[], keyboard="us",
        drivers=[], settings=WelcomeSettings(),
    )] if title is not None else []  # fmt: skip
    start = m.SessionStart(
        session="S01", participant="", experiment="made.yaml", experiment_sha256="0" * 64,
        condition="", wizard="", software={}, seed=0, clock={},
    )  # fmt: skip
    written = [
        msgspec.structs.replace(line, seq=number, t=number * 1000)
        for number, line in enumerate([start, *plan, *lines])
    ]
    path.write_bytes(b"".join(map(codec.encode, written)))
    return path


def had(
    participant: str,
    order: Sequence[str],
    outcomes: str = "",
    *,
    row: int = -1,
    method: str = "latin-square",
) -> list[m.Message]:
    """What a participant's session leaves: `outcomes` has a letter for each trial, d, a or e."""
    lines: list[m.Message] = [
        m.SessionChanged(participant=participant),
        m.ConditionsAssigned(participant=participant, order=[*order], method=method, row=row),
    ]
    trial = 1
    for letter in outcomes:
        outcome = {"d": "done", "a": "aborted", "e": "excluded"}[letter]
        lines += [m.TrialStarted(trial=trial), m.TrialEnded(trial=trial, outcome=outcome)]
        trial += outcome != "aborted"
    return lines
