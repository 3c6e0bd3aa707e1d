"""A block of BML 1.0 as a planner sent it: behaviours, and what has to happen at which time.

Source of names and defaults: BML 1.0 (bml-initiative.org), core. What is not of the core, or cannot
be read, is reported and left out; a block that cannot be used at all raises `BmlError`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final, Literal
from xml.etree import ElementTree as Xml

from woz_tui.bridge.xml_elements import parse_xml

NAMESPACE: Final = "http://www.bml-initiative.org/bml/bml-1.0"
#: More behaviours and constraints than these are refused.
MOST_BEHAVIOURS: Final = 200
MOST_CONSTRAINTS: Final = 2000
#: A speech with more marks is refused.
MOST_MARKS: Final = 500
#: A reason is told in so many characters.
MOST_SHOWN: Final = 400
#: A time that is farther away is none, in seconds: a day.
FARTHEST_S: Final = 86_400.0

_STROKES = ("start", "ready", "strokeStart", "stroke", "strokeEnd", "relax", "end")
_HELD = ("start", "ready", "relax", "end")
_FACE = ("start", "attackPeak", "relax", "end")
_PLAIN = ("start", "end")
#: Behaviour -> its sync points, in their order. A speech has its own marks between the two.
SYNC_POINTS: Final[Mapping[str, tuple[str, ...]]] = {
    **dict.fromkeys(("gesture", "head", "pointing", "headDirectionShift"), _STROKES),
    **dict.fromkeys(("gaze", "posture", "locomotion"), _HELD),
    **dict.fromkeys(("faceLexeme", "faceFacs", "face", "faceShift"), _FACE),
    **dict.fromkeys(("speech", "gazeShift", "postureShift", "wait"), _PLAIN),
    **{"eyePiGaze": _HELD, "EyePiGazeShift": _PLAIN, "directRosMessage": _PLAIN},
}
#: The namespace of EyePi's extension, and what is of it.
EYEPI: Final = "http://hmi.ewi.utwente.nl/eyepiengine"
EYEPI_BEHAVIOURS: Final = frozenset({"eyePiGaze", "EyePiGazeShift", "directRosMessage"})
#: Attributes without which a behaviour says nothing.
REQUIRED_ATTRIBUTES: Final[Mapping[str, tuple[str, ...]]] = {
    **dict.fromkeys(("gesture", "head", "faceLexeme"), ("lexeme",)),
    **dict.fromkeys(("pointing", "headDirectionShift", "gaze", "gazeShift"), ("target",)),
    "locomotion": ("target",),
    "faceFacs": ("au",),
    "directRosMessage": ("topic",),
}
#: What a warning is about, as feedback calls it.
WarningKind = Literal[
    "PARSING_FAILURE",
    "NO_SUCH_TARGET",
    "IMPOSSIBLE_TO_SCHEDULE",
    "BEHAVIOR_TYPE_NOT_SUPPORTED",
    "CUSTOM_ATTRIBUTE_NOT_SUPPORTED",
]
Composition = Literal["MERGE", "APPEND", "REPLACE", "APPEND-AFTER"]

#: A mark's name, which is an attribute in feedback.
_MARK = re.compile(r"^[A-Za-z_][\w.-]*$", re.ASCII)
_TAKEN = ("id", "start", "end", "xmlns")
_OFFSET = re.compile(r"^(.*?)\s*([+-])\s*(\d+(?:\.\d*)?|\.\d+)$", re.DOTALL)
_NUMBER = re.compile(r"^[+-]?(\d+(\.\d*)?|\.\d+)(e[+-]?\d+)?$", re.IGNORECASE)


def _shortened(text: str) -> str:
    """What a person reads at once: names and times of a planner can be of any length."""
    return text if len(text) <= MOST_SHOWN else f"{text[: MOST_SHOWN - 4]} ..."


class BmlError(Exception):
    """The block cannot be used; the text says why. `block`: its id, if it has one."""

    def __init__(self, reason: str, block: str = "") -> None:
        super().__init__(_shortened(reason))
        self.block = block


@dataclass(frozen=True, slots=True)
class BmlWarning:
    """What was left out, and why. `about`: ids of behaviours and constraints."""

    kind: WarningKind
    text: str
    about: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "text", _shortened(self.text))


@dataclass(frozen=True, slots=True)
class SyncRef:
    """A moment: a sync point of a behaviour and an offset in seconds.

    Without a behaviour it counts from the block's start. `block`: another block's; empty: this.
    """

    behaviour: str = ""
    point: str = "start"
    offset: float = 0.0
    block: str = ""

    @classmethod
    def read(cls, text: str, block: str) -> SyncRef:
        """From `1.5`, `speech1:start`, `bml2:nod1:stroke + 0.5`. Raises `ValueError`."""
        text = text.strip()
        if _NUMBER.match(text):
            return cls(offset=_seconds(text))
        offset = 0.0
        if found := _OFFSET.match(text):
            text, sign, number = found.groups()
            offset = _seconds(sign + number)
        words = [word.strip() for word in text.split(":")]
        if len(words) > 2 and words[-1].isdigit():  # a repetition's stroke: `nod1:stroke:2`
            words[-2:] = [f"{words[-2]}:{words[-1]}"]
        if not all(words) or not 2 <= len(words) <= 3:
            raise ValueError(f"{text!r} is no time: write 1.5 or behaviour:point + 1.5")
        *other, behaviour, point = words
        if behaviour == "bml" or (behaviour == block and not other):
            behaviour = ""
        return cls(behaviour, point, offset, "" if not other or other[0] == block else other[0])

    @property
    def own(self) -> str:
        """The behaviour, if it is one of this block."""
        return "" if self.block else self.behaviour

    def __str__(self) -> str:
        offset = f"{self.offset:+g}" if self.offset else ""
        if not self.behaviour:
            return f"{self.offset:g}" if not self.block else f"{self.block}:start{offset}"
        parts = (self.block, self.behaviour, self.point)
        return ":".join(part for part in parts if part) + offset


def _seconds(text: str) -> float:
    seconds = float(text)
    if not abs(seconds) <= FARTHEST_S:
        raise ValueError(f"{text[:20]!r} is farther away than a day")
    return seconds


@dataclass(frozen=True, slots=True)
class TimeConstraint:
    """`first` is at the same time as `second`, or not later. `where`: how the file says it.

    `owner`: the behaviour that asks for it; empty: a constraint element does.
    """

    kind: Literal["same", "not-later"]
    first: SyncRef
    second: SyncRef
    where: str
    owner: str = ""
    required: bool = False


@dataclass(frozen=True, slots=True)
class Behaviour:
    """One behaviour. `attributes` without id and sync points.

    Of a speech `text` is what is said, and `marks` are its sync points: name -> how many characters
    are said before it; of a message of ROS it is the message as XML. `inner` are the elements
    inside others (a pose of a shift), by name.
    """

    kind: str
    id: str
    attributes: Mapping[str, str] = field(default_factory=dict)
    text: str = ""
    marks: Mapping[str, int] = field(default_factory=dict)
    inner: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    required: bool = False

    @property
    def points(self) -> tuple[str, ...]:
        """Its sync points in their order, with a speech's marks and a repetition's strokes."""
        if self.kind == "speech":
            return ("start", *sorted(self.marks, key=lambda mark: self.marks[mark]), "end")
        return SYNC_POINTS[self.kind]

    @property
    def repetitions(self) -> int:
        """How often a movement is made, 1 to 20."""
        text = self.attributes.get("repetition", "1")
        return int(min(20, max(1, float(text)))) if text.isascii() and text.isdigit() else 1


@dataclass(frozen=True, slots=True)
class BmlBlock:
    """One block. `after`: the blocks that an APPEND-AFTER waits for."""

    id: str
    composition: Composition = "MERGE"
    after: tuple[str, ...] = ()
    character: str = ""
    behaviours: tuple[Behaviour, ...] = ()
    constraints: tuple[TimeConstraint, ...] = ()
    warnings: tuple[BmlWarning, ...] = ()


def read_block(text: str) -> BmlBlock:
    """The block that `text` holds. Raises `BmlError`."""
    try:
        root = parse_xml(text, "a block")
    except ValueError as error:
        raise BmlError(str(error)) from error
    return _BlockReader(root).block()


class _BlockReader:
    def __init__(self, root: Xml.Element) -> None:
        self._root = root
        self._id = root.get("id", "").strip()
        self._behaviours: dict[str, Behaviour] = {}
        self._constraints: list[TimeConstraint] = []
        self._warnings: list[BmlWarning] = []

    def block(self) -> BmlBlock:
        if _name(self._root) != "bml":
            raise BmlError(f"a block begins with <bml>, not <{self._root.tag}>")
        if not self._id:
            raise BmlError("the block has no id")
        composition, after = self._composition()
        for element, required in self._elements():
            if _name(element) == "constraint":
                self._constraint(element, required)
            else:
                self._behaviour(element, required)
            if len(self._behaviours) > MOST_BEHAVIOURS:
                raise BmlError(f"a block has at most {MOST_BEHAVIOURS} behaviours", self._id)
            if len(self._constraints) > MOST_CONSTRAINTS:
                raise BmlError(f"a block has at most {MOST_CONSTRAINTS} constraints", self._id)
        self._check_references()
        return BmlBlock(
            self._id,
            composition,
            after,
            self._root.get("character", ""),
            tuple(self._behaviours.values()),
            tuple(self._constraints),
            tuple(self._warnings),
        )

    def _composition(self) -> tuple[Composition, tuple[str, ...]]:
        word = self._root.get("composition", "MERGE").strip().upper()
        written = self._root.get("composition", "").strip()
        if found := re.fullmatch(r"APPEND-AFTER\s*\(([^()]*)\)", written, re.IGNORECASE):
            return "APPEND-AFTER", tuple(re.split(r"[,\s]+", found[1].strip()))
        match word:
            case "MERGE" | "APPEND" | "REPLACE":
                return word, ()
        raise BmlError(
            f"composition {word!r} is unknown: MERGE, APPEND, REPLACE, APPEND-AFTER(ids)", self._id
        )

    def _elements(self) -> Iterator[tuple[Xml.Element, bool]]:
        for element in self._root:
            if _name(element) == "required":
                yield from ((inner, True) for inner in element)
            else:
                yield element, False

    # -- behaviours ------------------------------------------------------------------------------

    def _behaviour(self, element: Xml.Element, required: bool) -> None:
        kind, name = _name(element), element.get("id", "").strip()
        problem = self._problem(element, kind, name)
        if problem is not None:
            if required:
                raise BmlError(problem.text, self._id)
            self._warnings.append(problem)
            return
        attributes = {key: value for key, value in element.attrib.items() if key != "id"}
        text, marks = _speech(element) if kind == "speech" else ("", {})
        if kind == "directRosMessage":
            try:
                text = "".join(Xml.tostring(each, "unicode") for each in element)
            except RecursionError:
                raise BmlError(f"{name}: its message is nested too deeply", self._id) from None
        inner = {_name(each): dict(each.attrib) for each in element if kind != "speech"}
        behaviour = Behaviour(kind, name, attributes, text, marks, inner, required)
        try:
            timed = [
                TimeConstraint(
                    "same",
                    SyncRef(name, point),
                    SyncRef.read(attributes[point], self._id),
                    f'{name}: {point}="{attributes[point]}"',
                    name,
                    required,
                )
                for point in SYNC_POINTS[kind]
                if point in attributes
            ]
        except ValueError as error:
            if required:
                raise BmlError(f"{name}: {error}", self._id) from error
            self._warnings.append(BmlWarning("PARSING_FAILURE", f"{name}: {error}", (name,)))
            return
        self._behaviours[name] = behaviour
        self._constraints += timed

    def _problem(self, element: Xml.Element, kind: str, name: str) -> BmlWarning | None:
        about = (name,) if name else ()
        if kind not in SYNC_POINTS:
            shown = name or kind
            text = f"{shown}: <{kind}> is no behaviour of BML 1.0's core"
            return BmlWarning("BEHAVIOR_TYPE_NOT_SUPPORTED", text, about)
        if not name:
            return BmlWarning("PARSING_FAILURE", f"a <{kind}> has no id")
        if name in self._behaviours:
            return BmlWarning("PARSING_FAILURE", f"{name}: a second behaviour has this id", about)
        missing = [key for key in REQUIRED_ATTRIBUTES.get(kind, ()) if not element.get(key)]
        if missing:
            return BmlWarning("PARSING_FAILURE", f"{name}: {missing[0]} is missing", about)
        if kind == "speech":
            said, marks = _speech(element)
            if not said:
                return BmlWarning("PARSING_FAILURE", f"{name}: there is nothing to say", about)
            if len(marks) > MOST_MARKS:
                text = f"{name}: a speech has at most {MOST_MARKS} marks"
                return BmlWarning("PARSING_FAILURE", text, about)
        return None

    # -- constraints -----------------------------------------------------------------------------

    def _constraint(self, element: Xml.Element, required: bool) -> None:
        name = element.get("id", "").strip() or "constraint"
        try:
            for inner in element:
                self._constraints += _relations(inner, name, self._id, required)
        except ValueError as error:
            if required:
                raise BmlError(f"{name}: {error}", self._id) from error
            self._warnings.append(BmlWarning("PARSING_FAILURE", f"{name}: {error}", (name,)))

    def _check_references(self) -> None:
        """What refers to nothing is left out with its constraint; required ones end the block."""
        kept = []
        for constraint in self._constraints:
            wrong = [ref for ref in (constraint.first, constraint.second) if not self._exists(ref)]
            if not wrong:
                kept.append(constraint)
                continue
            text = f"{constraint.where}: there is no {wrong[0].behaviour or 'bml'}:{wrong[0].point}"
            if constraint.required:
                raise BmlError(text, self._id)
            about = (constraint.owner,) if constraint.owner else ()
            self._warnings.append(BmlWarning("PARSING_FAILURE", text, about))
            if constraint.owner:  # when it is to happen is not known
                self._behaviours.pop(constraint.owner, None)
        gone = len(kept) + 1
        while len(kept) < gone:  # what depends on a behaviour that was left out
            gone = len(kept)
            lost = [
                each
                for each in kept
                if not (self._exists(each.first) and self._exists(each.second))
            ]
            for constraint in lost:
                if constraint.owner in self._behaviours:
                    self._behaviours.pop(constraint.owner)
                    text = f"{constraint.where}: this was left out"
                    self._warnings.append(BmlWarning("PARSING_FAILURE", text, (constraint.owner,)))
            kept = [each for each in kept if each not in lost]
        self._constraints = kept

    def _exists(self, ref: SyncRef) -> bool:
        if ref.block:  # whether it is there is seen when the block is put in time
            return True
        if not ref.behaviour:
            return ref.point == "start"
        behaviour = self._behaviours.get(ref.behaviour)
        return behaviour is not None and ref.point.partition(":")[0] in behaviour.points


def _relations(
    element: Xml.Element, name: str, block: str, required: bool
) -> Iterator[TimeConstraint]:
    """What one `synchronize`, `before` or `after` says. Raises `ValueError`."""
    kind = _name(element)
    if kind not in ("synchronize", "before", "after"):
        raise ValueError(f"<{kind}> is no constraint: synchronize, before, after")
    texts = [element.get("ref"), *(each.get("ref") for each in element if _name(each) == "sync")]
    if kind != "synchronize" and texts[0] is None:
        raise ValueError(f"<{kind}> needs a ref")
    refs = [SyncRef.read(text, block) for text in texts if text is not None]
    if len(refs) < 2:
        raise ValueError(f"<{kind}> needs a ref and what it is compared with")
    first = refs[0]
    for other in refs[1:]:
        match kind:
            case "synchronize":
                where = f"{name}: {first} = {other}"
                yield TimeConstraint("same", first, other, where, "", required)
            case "before":
                where = f"{name}: {other} before {first}"
                yield TimeConstraint("not-later", other, first, where, "", required)
            case _:
                where = f"{name}: {other} after {first}"
                yield TimeConstraint("not-later", first, other, where, "", required)


def _speech(element: Xml.Element) -> tuple[str, dict[str, int]]:
    """What is said, without needless blanks, and where its marks are."""
    marks: dict[str, int] = {}
    said = ""
    text = next((each for each in element if _name(each) == "text"), None)
    if text is None:
        return "", {}
    for piece, mark in _pieces(text):
        words = re.sub(r"\s+", " ", piece)
        said += words.lstrip() if not said or said.endswith(" ") else words
        if _MARK.match(mark) and mark not in _TAKEN:
            marks[mark] = len(said)
    return said.strip(), marks


def _pieces(text: Xml.Element) -> Iterator[tuple[str, str]]:
    """Text, and the mark behind it."""
    before = text.text or ""
    for element in text:
        if _name(element) == "sync":
            yield before, element.get("id", "").strip()
            before = element.tail or ""
        else:  # emphasis and the like: what it holds is said
            before += "".join(element.itertext()) + (element.tail or "")
    yield before, ""


def _name(element: Xml.Element) -> str:
    """Its name; with the namespace where that is another's."""
    namespace, _, name = str(element.tag).rpartition("}")
    own = namespace == f"{{{EYEPI}" and name in EYEPI_BEHAVIOURS
    return name if own or namespace in ("", f"{{{NAMESPACE}") else f"{namespace[1:]}:{name}"
