"""What ALMemory says about people: who is visible, how near, whether they look, whose face it is.

Nothing in here raises, whatever the robot says. Shapes are those of NAOqi 2.4 to 2.9
(doc.aldebaran.com, "naoqi/peopleperception/alpeopleperception-api", "alfacedetection-api").
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from woz_drivers.pepper.memory import item, items, number, within

VISIBLE = "PeoplePerception/VisiblePeopleList"
FACES = "FaceDetected"

#: Nobody measures farther than this; the robot's own reach is about 3.5 m.
REACH_M = 30.0
#: So many people are asked about; a robot sees a handful.
_MOST = 20
_LARGEST_ID = 2**53
#: A name is looked at up to here, in characters.
_READABLE = 1000


def distance_key(person: int) -> str:
    """Where a person's distance in metres stands."""
    return f"PeoplePerception/Person/{person}/Distance"


def looking_key(person: int) -> str:
    """Where it stands whether a person looks at the robot."""
    return f"PeoplePerception/Person/{person}/IsLookingAtRobot"


def visible(value: Any) -> tuple[int, ...] | None:
    """Ids of the people whom the robot sees now; None if the value is no list of ids."""
    if not isinstance(value, (list, tuple)):
        return None
    ids: list[int] = []
    for one in value:
        found = within(one, 0, _LARGEST_ID)
        if found is None or found != int(found):
            return None
        ids.append(int(found))
    return tuple(dict.fromkeys(ids))[:_MOST]


@dataclass(frozen=True, slots=True)
class Person:
    """Somebody visible: metres and whether they look at the robot, None where it does not say."""

    id: int
    distance: float | None
    looking: bool | None


def nearest(ids: Sequence[int], values: Mapping[str, Any]) -> Person | None:
    """The nearest of `ids` whose values were read; who has no distance comes last."""
    people = [
        Person(one, metres(values.get(distance_key(one))), looks(values.get(looking_key(one))))
        for one in ids
        if distance_key(one) in values
    ]
    return min(people, key=lambda one: one.distance or REACH_M + 1.0, default=None)


def metres(value: Any) -> float | None:
    """A person's distance, above 0."""
    return within(value, 0.0, REACH_M) or None


def looks(value: Any) -> bool | None:
    """Whether a person looks at the robot; NAOqi versions say it as a flag or as a number."""
    if isinstance(value, bool):
        return value
    share = within(value, 0.0, 1.0)
    return None if share is None else share >= 0.5


@dataclass(frozen=True, slots=True)
class Face:
    """A face: `name` is empty if nobody knows it, `score` of the recognition if there is one."""

    name: str
    score: float | None


NOBODY = Face("", None)


def face(value: Any) -> Face | None:
    """The largest face of `FaceDetected`; a `Face` without a name where there is none.

    `[]`, or `[time, [face, ..., recognised], ...]` with faces `[[0, alpha, beta, width, height],
    [id, score, name, ...]]`; in some versions the second part holds a list of such lists. The last
    entry, who has been recognised over time, is `[]`, `[4]`, `[2, [name]]` or `[3, [names]]`. None
    if the value is something else.
    """
    if value is None or value in ([], ()):
        return NOBODY
    entries = item(value, 1)
    if not isinstance(entries, (list, tuple)):
        return None
    faces = [one for one in entries if _size(one) is not None]
    if not faces:
        return None if entries else NOBODY
    known = _known(max(faces, key=lambda one: _size(one) or 0.0))
    if known is not None and not known.name and len(faces) == 1:
        return Face(_over_time(entries[-1]), known.score)
    return known


def _over_time(entry: Any) -> str:
    """Who was recognised over time, if it is one."""
    return (_name(item(entry, 1, 0)) or "") if item(entry, 0) == 2 else ""


def _size(entry: Any) -> float | None:
    """How large a face is in the picture; None for what is no face."""
    width, height = number(item(entry, 0, 3)), number(item(entry, 0, 4))
    return None if width is None or height is None else abs(width * height)


def _known(entry: Any) -> Face | None:
    extra = item(entry, 1)
    if isinstance(item(extra, 0), (list, tuple)):
        extra = item(extra, 0)
    if not items(extra):
        return NOBODY
    name = _name(item(extra, 2))
    return None if name is None else Face(name, within(item(extra, 1), 0.0, 1.0))


def _name(value: Any) -> str | None:
    if not isinstance(value, str) or len(value) > _READABLE:
        return None
    return value.strip()
