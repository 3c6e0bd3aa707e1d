"""What a robot file may say about a body, beside its shape."""

from __future__ import annotations

import pathlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated

from woz_tui.drivers.contract import REST_WAIT_S
from woz_tui.drivers.fields import Doc, Path, Range, Seconds, Sibling
from woz_tui.motion.body_shape import BodyShape, pose_problems
from woz_tui.motion.body_verbs import CONTROLS
from woz_tui.motion.builtin_moves import BUILT_IN
from woz_tui.motion.easing import PEAK_SPEEDS
from woz_tui.motion.move_files import NAME, NAME_RULE, MoveFolder, read_folder
from woz_tui.motion.move_types import Move

#: Servos stand so long after the body until their torque goes off, in seconds.
_SETTLING_S = 1.0

# -- repertoire -----------------------------------------------------------------------------------
# The moves that a body can play: those built in, and those of its folder.


@dataclass(frozen=True, slots=True)
class Repertoire:
    """Moves by name, and what the folder holds, with all that is wrong with its files."""

    moves: Mapping[str, Move]
    folder: MoveFolder


def repertoire(folder: str, shape: BodyShape) -> Repertoire:
    """The built-in moves, and those of the files in `folder` (empty: none).

    A file's move takes the place of the built-in one of that name: a body's own way to nod.
    """
    there = folder and pathlib.Path(folder).is_dir()
    found = read_folder(pathlib.Path(folder), shape) if there else MoveFolder({}, ())
    return Repertoire({**BUILT_IN, **found.moves}, found)


def move_changes(old: Mapping[str, Move], new: Mapping[str, Move]) -> Iterator[str]:
    """What became of a body's moves, in words."""
    for name, move in new.items():
        if name not in old:
            yield f"move {name!r} is new"
        elif move != old[name]:
            yield f"move {name!r} changed"
    yield from (f"move {name!r} was removed" for name in old if name not in new)


# --------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class BodySettings(BodyShape):
    """A body and what it works with."""

    rate: Annotated[float, Range(20, 200, "Hz"), Doc("setpoints a second")] = 50.0
    moves: Annotated[
        str, Path(), Doc("folder of move files; the built-in moves are always there")
    ] = ""
    poses: Annotated[dict[str, dict[str, float]], Doc("named poses: joint names and degrees")] = (
        field(default_factory=dict)
    )
    rest: Annotated[
        dict[str, float], Doc("rest pose: angles by joint; other joints go to their home angle")
    ] = field(default_factory=dict)
    rest_time: Annotated[float, Seconds(0.1, 8), Doc("time for the movement to the rest pose")] = (
        3.0
    )
    servos: Annotated[
        str, Sibling(), Doc("driver that moves the joints; empty: none, only shown on the screen")
    ] = ""
    camera: Annotated[str, Sibling(), Doc("camera for object tracking; empty: none")] = ""
    voice: Annotated[
        str, Sibling(), Doc("voice as loud as which the mouth is open; empty: no mouth moves")
    ] = ""
    seed: Annotated[int, Range(0, 2**31), Doc("seed of blinks and other random movements")] = 1

    def problems(self) -> list[tuple[str, str]]:
        """What does not fit together: pairs of a setting's path and a sentence."""
        found = [*BodyShape.problems(self), *self._joint_names()]
        poses = {f"poses.{name}": pose for name, pose in self.poses.items()}
        for path, pose in {**poses, "rest": self.rest}.items():
            found += pose_problems(path, pose, self.joints)
        # Move files name joints, so they are read only where the joints are right.
        return found or [*self._name_problems()]

    def warnings(self) -> list[tuple[str, str]]:
        """Joints whose servos let go before they are at rest."""
        found = []
        for name, angle in self.rest_pose.items() if self.servos else ():
            joint = self.joints[name]
            way = max(joint.max - angle, angle - joint.min)
            seconds = way * PEAK_SPEEDS[self.easing] / joint.speed
            if seconds > REST_WAIT_S - _SETTLING_S:
                text = (
                    f"its way to the rest pose may take {seconds:.0f} s; the torque goes off"
                    f" after {REST_WAIT_S:g} s"
                )
                found.append((f"joints.{name}.speed", text))
        return found

    def included(self) -> MoveFolder:
        """The move files, which belong to the experiment as its other files do."""
        return self.repertoire.folder

    def _joint_names(self) -> Iterator[tuple[str, str]]:
        """Readings, controls and move files name joints, each in its own way."""
        for name in self.joints:
            if not NAME.fullmatch(name):
                yield f"joints.{name}", NAME_RULE
            elif name in CONTROLS:
                yield (
                    f"joints.{name}",
                    f"every body has a control {name!r}; choose another name for the joint",
                )
        for name in self.controls:
            if not NAME.fullmatch(name):
                yield f"controls.{name}", NAME_RULE
            elif name in CONTROLS:
                yield f"controls.{name}", f"every body has a control {name!r} already"

    def _name_problems(self) -> Iterator[tuple[str, str]]:
        if self.moves and not pathlib.Path(self.moves).is_dir():
            yield "moves", f"there is no folder {pathlib.Path(self.moves).name!r}"
        known = self.repertoire
        for name in self.poses:
            if name in known.moves:
                yield (
                    f"poses.{name}",
                    f"{name!r} names a move as well; `play` could not tell them apart",
                )

    @property
    def repertoire(self) -> Repertoire:
        """The moves it can play: built-in ones and those of the folder, read now."""
        return repertoire(self.moves, self)

    @property
    def playable(self) -> tuple[str, ...]:
        """Everything that `play` takes."""
        return (*self.repertoire.moves, *self.poses)

    @property
    def rest_pose(self) -> Mapping[str, float]:
        """Where every joint goes when the robot is left alone."""
        return {name: self.rest.get(name, joint.home) for name, joint in self.joints.items()}
