"""Blocks are put in time: what can be is, what cannot is named with the constraint."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.features.blocks.bml_block import (
    MOST_BEHAVIOURS,
    MOST_CONSTRAINTS,
    SYNC_POINTS,
    Behaviour,
    BmlError,
    SyncRef,
    read_block,
)
from woz_tui.features.blocks.bml_schedule import (
    BehaviourTiming,
    BlockSchedule,
    schedule,
    speech_timing,
    typical_timing,
)
from woz_tui.features.blocks.time_network import EPSILON, TimeNetwork

XML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b1">{}</bml>'


def block_schedule(inner: str, speech_s: float = 2.0) -> BlockSchedule:
    """The schedule of a block; a speech takes so long, a head 1 s, all else 2 s."""

    def predict(behaviour: Behaviour) -> BehaviourTiming:
        if behaviour.kind == "speech":
            return speech_timing(behaviour, speech_s)
        seconds = 1.0 if behaviour.kind == "head" else 2.0
        points = behaviour.points
        return BehaviourTiming(
            {point: seconds * at / (len(points) - 1) for at, point in enumerate(points)}
        )

    return schedule(read_block(XML.format(inner.replace("{}", ""))), predict)


SPEECH = '<speech id="s" {}><text>One two <sync id="m"/>three four.</text></speech>'
NOD = '<head id="n" lexeme="NOD" {}/>'


@pytest.mark.parametrize(
    ("inner", "expected"),
    [
        (NOD, {"n:start": 0, "n:end": 1}),
        (NOD.format('start="4"'), {"n:start": 4, "n:end": 5}),
        (NOD.format('end="9"'), {"n:start": 8, "n:end": 9}),
        (NOD.format('start="2" end="8"'), {"n:start": 2, "n:stroke": 5, "n:end": 8}),
        (NOD.format('stroke="0"'), {"n:start": 0, "n:stroke": 0}),
        (
            SPEECH.format('start="6"') + NOD.format('start="s:m" end="9"'),
            {"s:start": 6, "s:m": 6.842105, "n:start": 6.842105, "n:end": 9, "s:end": 8},
        ),
        (  # whichever comes first in the file
            NOD.format('start="s:end + 0.5"') + SPEECH.format(""),
            {"n:start": 2.5},
        ),
        (
            SPEECH.format("")
            + NOD
            + '<constraint id="c"><synchronize ref="s:m"><sync ref="n:stroke"/></synchronize>'
            "</constraint>",
            {"n:stroke": 0.842105, "s:start": 0},
        ),
        (
            SPEECH.format("")
            + NOD
            + '<constraint id="c"><synchronize><sync ref="s:m"/><sync ref="10"/></synchronize>'
            "</constraint>",
            {"s:m": 10, "s:start": 9.157895},
        ),
        (
            SPEECH.format("")
            + NOD
            + '<constraint id="c"><after ref="s:end"><sync ref="n:start"/></after></constraint>',
            {"n:start": 2},
        ),
        (
            SPEECH.format('start="3"')
            + NOD.format('start="1"')
            + '<constraint id="c"><before ref="s:start"><sync ref="n:end"/></before></constraint>',
            {"n:end": 2},
        ),
        (
            '<wait id="w" start="1" end="5"/>' + NOD.format('start="w:end-1"'),
            {"w:end": 5, "n:start": 4},
        ),
        ('<gaze id="g" target="x" ready="2"/>', {"g:ready": 2}),
    ],
)
def test_what_the_block_says_holds(inner: str, expected: dict[str, float]) -> None:
    found = block_schedule(inner)
    assert not found.warnings
    times = {f"{name}:{point}": time for (name, point), time in found.times.items()}
    assert {name: times[name] for name in expected} == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize(
    ("inner", "kind", "words"),
    [
        (NOD.format('start="3" end="2"'), "IMPOSSIBLE_TO_SCHEDULE", 'end="2"'),
        (SPEECH.format('start="0" end="1"'), "IMPOSSIBLE_TO_SCHEDULE", "takes 2.00 s"),
        (NOD.format('start="x:end"'), "PARSING_FAILURE", "x:end"),
        (NOD.format('start="soon"'), "PARSING_FAILURE", "soon"),
        ('<head id="n"/>', "PARSING_FAILURE", "lexeme"),
        (
            '<speech id="s"><text>a'
            + "".join(f'<sync id="m{number}"/> a' for number in range(1000))
            + "</text></speech>",
            "PARSING_FAILURE",
            "marks",
        ),
        ("<dance/>", "BEHAVIOR_TYPE_NOT_SUPPORTED", "dance"),
        (NOD.format('start="bml:end"'), "PARSING_FAILURE", "there is no bml:end"),
        (
            '<gaze id="n" target="x" start="1" end="9"/><gaze id="o" target="y" start="1"/>',
            "IMPOSSIBLE_TO_SCHEDULE",
            "same time",
        ),
    ],
)
def test_what_cannot_be_is_left_out_and_named_and_ends_a_block_that_requires_it(
    inner: str, kind: str, words: str
) -> None:
    rest = '<faceLexeme id="rest" lexeme="SMILE"/>'
    found = block_schedule(inner + rest)
    assert ("rest", "start") in found.times
    assert [warning.kind for warning in found.warnings] == [kind]
    assert words in found.warnings[0].text
    with pytest.raises(BmlError, match=words.replace("(", r"\(")):
        block_schedule(f"<required>{inner}</required>{rest}")


@pytest.mark.parametrize("why", ['start="x:end"', 'start="9" end="8"', 'start="b0:x:end"'])
def test_what_hangs_on_something_left_out_is_not_played_at_a_wrong_time(why: str) -> None:
    found = block_schedule(NOD.format(why) + '<head id="o" lexeme="NOD" start="n:end"/>')
    assert not found.times
    assert [warning.about for warning in found.warnings] == [("n",), ("o",)]


@pytest.mark.parametrize(
    ("hands", "left"),
    [
        (("LEFT_HAND", "RIGHT_HAND"), "ab"),
        (("LEFT_HAND", "LEFT_HAND"), "a"),
        (("LEFT_HAND", "BOTH_HANDS"), "a"),
        (("", "RIGHT_HAND"), "ab"),
        (("", "BOTH_HANDS"), "a"),
    ],
)
def test_gestures_of_one_hand_do_not_overlap(hands: tuple[str, str], left: str) -> None:
    first, second = (
        f'<gesture id="{name}" lexeme="BEAT" mode="{hand}" start="1"/>'
        for name, hand in zip("ab", hands, strict=True)
    )
    assert {each.id for each in block_schedule(first + second).block.behaviours} == {*left}
    if len(left) == 1:  # what is required comes before what is wished
        found = block_schedule(first + f"<required>{second}</required>")
        assert {each.id for each in found.block.behaviours} == {"b"}
        with pytest.raises(BmlError, match="same time"):
            block_schedule(f"<required>{first}{second}</required>")


WAITS = [f'<wait id="w{number}" start="w{(number + 1) % 200}:end"/>' for number in range(200)]


@pytest.mark.parametrize(
    ("inner", "words"),
    [
        ('<wait id="{}"/>' * (MOST_BEHAVIOURS + 1), "behaviours"),
        (
            '<wait id="w"/><constraint>'
            + '<after ref="1"><sync ref="w:end"/></after>' * (MOST_CONSTRAINTS + 1)
            + "</constraint>",
            "constraints",
        ),
        ("".join(WAITS), "depends on each other"),
    ],
)
def test_a_block_that_would_take_long_is_refused(inner: str, words: str) -> None:
    ids = itertools.count()
    inner = re.sub(r"\{\}", lambda _: f"i{next(ids)}", inner)
    with pytest.raises(BmlError, match=words):
        schedule(read_block(XML.format("{}").replace("{}", inner)))


@pytest.mark.parametrize("time", ["86401", "1e9", "9" * 400, "w:end + 1" + "0" * 400, "-1e400"])
def test_a_time_farther_away_than_a_day_is_none(time: str) -> None:
    found = block_schedule('<wait id="w"/>' + NOD.format(f'start="{time}"'))
    assert [(each.kind, each.about) for each in found.warnings] == [("PARSING_FAILURE", ("n",))]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<bml/>", "id"),
        ("<bml", "no XML"),
        ("<html id='x'/>", "begins with"),
        ("<bml id='x' composition='SOON'/>", "composition"),
        ("<!DOCTYPE x [<!ENTITY a 'b'>]><bml id='x'/>", "remove it"),
        ("<bml id='\ud800'/>", "no XML"),
    ],
)
def test_a_block_that_is_none_is_told(text: str, words: str) -> None:
    with pytest.raises(BmlError, match=words):
        read_block(text)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "ISO-8859-1", "nonsense"])
def test_a_text_is_what_it_is_whatever_encoding_it_declares(encoding: str) -> None:
    said = '<speech id="s"><text>f\u00fcr</text></speech>'
    declared = f'\ufeff<?xml version="1.0" encoding="{encoding}"?>{XML.format(said)}'
    assert read_block(declared).behaviours[0].text == "f\u00fcr"


@pytest.mark.parametrize(("written", "made"), [("3", 3), ("0", 1), ("-1", 1), ("9" * 5000, 20)])
def test_a_movement_is_repeated_at_most_twenty_times(written: str, made: int) -> None:
    [behaviour] = read_block(XML.format(NOD.format(f'repetition="{written}"'))).behaviours
    assert behaviour.repetitions == made


def test_what_is_required_comes_before_what_is_wished() -> None:
    at = '<constraint><synchronize ref="w:end"><sync ref="{}"/></synchronize></constraint>'
    found = block_schedule(f'<wait id="w"/>{at.format(3)}<required>{at.format(5)}</required>')
    assert found.times["w", "end"] == 5
    assert ["w:end = 3" in warning.text for warning in found.warnings] == [True]


def test_a_behaviour_of_another_block_is_not_one_of_this_name() -> None:
    inner = '<wait id="a" start="9" end="8"/>' + NOD.format('start="z:a:end"')
    found = schedule(
        read_block(XML.format(inner)), elsewhere={SyncRef("a", "end", 0.0, "z"): 4.0}.get
    )
    assert found.times["n", "start"] == 4


def test_other_blocks_times_count() -> None:
    block = read_block(XML.format(NOD.format('start="b0:s:end+1"')))
    other = {SyncRef("s", "end", 1.0, "b0"): 3.0}
    assert schedule(block, elsewhere=other.get).times["n", "start"] == 4.0
    assert schedule(block).warnings


# -- the network -------------------------------------------------------------------------------

Relation = tuple[int, int, int, bool]
RELATIONS = st.lists(
    st.tuples(st.integers(0, 5), st.integers(0, 5), st.integers(-6, 6), st.booleans()), max_size=24
)


def possible(relations: list[Relation]) -> bool:
    """Whether all can hold, decided by the shortest ways between all moments."""
    far = [[0.0 if a == b else float("inf") for b in range(7)] for a in range(7)]
    for moment in range(6):
        far[moment + 1][0] = 0.0  # not before zero
    for first, second, apart, exact in relations:
        a, b = first + 1, second + 1
        far[b][a] = min(far[b][a], -apart)
        if exact:
            far[a][b] = min(far[a][b], apart)
    for through, a, b in itertools.product(range(7), repeat=3):
        far[a][b] = min(far[a][b], far[a][through] + far[through][b])
    return all(far[moment][moment] >= 0 for moment in range(7))


@given(relations=RELATIONS)
def test_a_relation_is_taken_exactly_if_it_can_hold(relations: list[Relation]) -> None:
    network, kept = TimeNetwork(), list[Relation]()
    for moment in range(6):
        network.add_moment(moment)
    for relation in relations:
        first, second, apart, exact = relation
        add: Callable[..., list[str] | None] = network.same if exact else network.at_least
        label = f"{len(kept)}"
        conflict = add(first, second, apart, label)
        assert bool(conflict) is not possible([*kept, relation])
        if not conflict:
            kept.append(relation)
    times = network.earliest()
    for first, second, apart, exact in kept:
        between = times[second] - times[first]
        assert between >= apart - 10 * EPSILON
        assert not exact or between <= apart + 10 * EPSILON
    assert all(time >= 0 for time in times.values())


@given(relations=RELATIONS)
def test_no_earlier_time_would_do(relations: list[Relation]) -> None:
    network = TimeNetwork()
    for moment in range(6):
        network.add_moment(moment)
    for first, second, apart, exact in relations:
        (network.same if exact else network.at_least)(first, second, apart, "")
    for each, time in network.earliest().items():
        least, _ = network.room("zero", each)
        assert time == pytest.approx(least, abs=1e-4)


NAMES = st.sampled_from(["a", "b", "c"])
POINTS = st.sampled_from(["start", "stroke", "end"])
TIMES = st.one_of(
    st.integers(0, 9).map(str),
    st.tuples(NAMES, POINTS, st.integers(-3, 3)).map(lambda it: f"{it[0]}:{it[1]}{it[2]:+d}"),
)


@given(
    heads=st.lists(st.dictionaries(POINTS, TIMES, max_size=3), min_size=1, max_size=3),
    required=st.booleans(),
)
def test_every_block_is_scheduled_as_it_says_or_refused(
    heads: list[dict[str, str]], required: bool
) -> None:
    inner = "".join(
        f'<faceFacs id="{name}" au="1" '.replace("faceFacs", "gesture").replace("au", "lexeme")
        + " ".join(f'{point}="{time}"' for point, time in points.items())
        + "/>"
        for name, points in zip("abc", heads, strict=False)
    )
    try:
        found = block_schedule(f"<required>{inner}</required>" if required else inner)
    except BmlError:
        assert required
        return
    for constraint in found.block.constraints:
        first, second = (
            found.times.get((ref.behaviour, ref.point), 0.0) + ref.offset
            for ref in (constraint.first, constraint.second)
        )
        assert first == pytest.approx(second, abs=1e-4)
    for behaviour in found.block.behaviours:
        times = [found.times[behaviour.id, point] for point in SYNC_POINTS[behaviour.kind]]
        assert times == sorted(times)
        assert times[0] >= 0


@dataclass(frozen=True)
class Wanted:
    """A sync attribute of the behaviour `owner`, or a constraint element without one."""

    kind: str
    first: str
    second: str
    required: bool
    owner: str = ""

    def element(self) -> str:
        """Of one without an owner."""
        inner = f'<{self.kind} ref="{self.first}"><sync ref="{self.second}"/></{self.kind}>'
        return self.wrapped(f"<constraint>{inner}</constraint>")

    def label(self) -> str:
        """How a warning names one without an owner."""
        if self.kind == "synchronize":
            return f"{self.first} = {self.second}"
        return f"{self.second} {self.kind} {self.first}"

    def wrapped(self, inner: str) -> str:
        return f"<required>{inner}</required>" if self.required else inner

    def holds(self) -> list[tuple[Point, Point, float]]:
        """As limits: the second is at most so long after the first."""
        (first, one), (second, other) = _point(self.first), _point(self.second)
        before, after = (first, second, one - other), (second, first, other - one)
        return {"before": [before], "after": [after]}.get(self.kind, [before, after])


Point = tuple[str, str]
#: Behaviours that share nothing, with how long the speech takes.
KINDS = {"a": "wait", "b": "faceFacs", "c": "faceLexeme", "s": "speech"}
ELEMENTS = {
    "a": '<wait id="a" {}/>',
    "b": '<faceFacs id="b" au="1" {}/>',
    "c": '<faceLexeme id="c" lexeme="SMILE" {}/>',
    "s": '<speech id="s" {}><text>Hello.</text></speech>',
}
SPEECH_S = 2.0
#: Blocks whose times are known; `y` has ended before.
ELSEWHERE: dict[tuple[str, ...], float] = {("z", "a", "end"): 4.0, ("y", "a", "end"): -2.0}


def _point(text: str) -> tuple[Point, float]:
    """The moment and the offset of `3`, `a:end-2`, `z:a:end+1`."""
    if ":" not in text:
        return ("", "start"), float(text)
    sign = next((each for each in "+-" if each in text), "")
    name, _, number = text.partition(sign) if sign else (text, "", "0")
    offset = float(sign + number)
    parts = (*name.split(":"),)
    if len(parts) == 3:
        return ("", "start"), ELSEWHERE[parts] + offset
    return (parts[0], parts[1]), offset


def _elsewhere(ref: SyncRef) -> float | None:
    return ELSEWHERE.get((ref.block, ref.behaviour, ref.point))


def _possible(names: Iterable[str], wanted: Iterable[Wanted]) -> bool:
    """Whether all that is wanted can be, with the order of each behaviour's points."""
    ways: dict[tuple[Point, Point], float] = {}

    def limit(first: Point, second: Point, seconds: float) -> None:
        ways[first, second] = min(ways.get((first, second), float("inf")), seconds)

    points: list[Point] = [("", "start")]
    for name in names:
        own = [(name, point) for point in SYNC_POINTS[KINDS[name]]]
        for first, second in itertools.pairwise([("", "start"), *own]):
            limit(second, first, 0.0)
        if name == "s":
            limit(("s", "start"), ("s", "end"), SPEECH_S)
            limit(("s", "end"), ("s", "start"), -SPEECH_S)
        points += own
    for each in wanted:
        for first, second, seconds in each.holds():
            limit(first, second, seconds)
    for through, first, second in itertools.product(points, repeat=3):
        way = ways.get((first, through), float("inf")) + ways.get((through, second), float("inf"))
        limit(first, second, way)
    return all(ways.get((point, point), 0.0) > -1e-9 for point in points)


OFFSETS = st.integers(-3, 3).map(lambda seconds: f"{seconds:+d}" if seconds else "")
REFS = st.one_of(
    st.integers(0, 9).map(str),
    st.tuples(
        st.sampled_from(
            [f"{name}:{point}" for name, kind in KINDS.items() for point in SYNC_POINTS[kind]]
        ),
        OFFSETS,
    ).map("".join),
    st.tuples(st.sampled_from(["z:a:end", "y:a:end"]), OFFSETS).map("".join),
)
OWNED = st.sampled_from(
    [(name, point) for name, kind in KINDS.items() for point in SYNC_POINTS[kind]]
)
ATTRIBUTES = st.dictionaries(OWNED, REFS, max_size=5)
CONSTRAINTS = st.lists(
    st.builds(
        Wanted,
        st.sampled_from(["synchronize", "before", "after"]),
        REFS,
        REFS,
        st.booleans(),
    ),
    max_size=5,
)


def _scheduled(
    attributes: dict[Point, str], required: set[str], more: list[Wanted]
) -> BlockSchedule:
    inner = ""
    for name, element in ELEMENTS.items():
        own = " ".join(
            f'{point}="{ref}"' for (who, point), ref in attributes.items() if who == name
        )
        text = element.format(own)
        inner += f"<required>{text}</required>" if name in required else text
    inner += "".join(each.element() for each in more)
    return schedule(
        read_block(XML.format(inner)),
        lambda behaviour: (
            speech_timing(behaviour, SPEECH_S)
            if behaviour.kind == "speech"
            else typical_timing(behaviour)
        ),
        _elsewhere,
    )


@given(attributes=ATTRIBUTES, required=st.sets(st.sampled_from("abcs")), more=CONSTRAINTS)
def test_what_can_be_is_scheduled_and_what_cannot_is_named_with_what_it_conflicts_with(
    attributes: dict[Point, str], required: set[str], more: list[Wanted]
) -> None:
    own = [
        Wanted("synchronize", f"{name}:{point}", ref, name in required, name)
        for (name, point), ref in attributes.items()
    ]
    wanted = [*own, *more]
    try:
        found = _scheduled(attributes, required, more)
    except BmlError:
        # Something required cannot be, or hangs on what cannot.
        assert any(each.required for each in wanted)
        assert not _possible("abcs", wanted)
        return
    left = {behaviour.id for behaviour in found.block.behaviours}
    assert required <= left
    if _possible("abcs", wanted):
        assert not found.warnings
        assert left == {*"abcs"}
    else:
        assert {warning.kind for warning in found.warnings} == {"IMPOSSIBLE_TO_SCHEDULE"}
    out = {name for warning in found.warnings for name in warning.about}
    assert out == {*"abcs"} - left
    times = {("", "start"): 0.0, **found.times}
    texts = "".join(warning.text for warning in found.warnings)
    for each in wanted:
        names = {each.owner, _point(each.first)[0][0], _point(each.second)[0][0]} - {""}
        if not names <= left:
            continue
        fits = all(
            times[second] - times[first] <= seconds + 1e-4
            for first, second, seconds in each.holds()
        )
        # What is required holds; another constraint holds or is named.
        assert fits or (not each.required and not each.owner and each.label() in texts)
    for name in left:
        spans = [times[name, point] for point in SYNC_POINTS[KINDS[name]]]
        assert spans == sorted(spans)
        assert spans[0] >= 0
    assert "s" not in left or times["s", "end"] - times["s", "start"] == pytest.approx(SPEECH_S)


@given(more=CONSTRAINTS)
def test_as_many_constraints_hold_as_can_in_their_order_required_ones_first(
    more: list[Wanted],
) -> None:
    kept: list[Wanted] = []
    for each in sorted(more, key=lambda each: not each.required):
        if _possible("abcs", [*kept, each]):
            kept.append(each)
        elif each.required:
            with pytest.raises(BmlError, match="cannot be"):
                _scheduled({}, set(), more)
            return
    found = _scheduled({}, set(), more)
    assert len(found.block.constraints) == len(kept)
    assert len(found.warnings) == len(more) - len(kept)
    times = {("", "start"): 0.0, **found.times}
    for each in kept:
        for first, second, seconds in each.holds():
            assert times[second] - times[first] <= seconds + 1e-4


@pytest.mark.hypothesis
@given(text=st.text(st.characters(), max_size=300))
def test_whatever_comes_is_a_block_or_refused(text: str) -> None:
    try:
        schedule(read_block(text))
    except BmlError as error:
        assert str(error)


@pytest.mark.hypothesis
@given(
    names=st.lists(
        st.sampled_from([*SYNC_POINTS, "required", "constraint", "synchronize", "sync", "text"]),
        max_size=8,
    ),
    values=st.lists(st.text(max_size=12), max_size=8),
)
def test_whatever_elements_come_nothing_else_is_raised(names: list[str], values: list[str]) -> None:
    from xml.sax.saxutils import quoteattr  # noqa: PLC0415

    inner = "".join(
        f"<{name} id={quoteattr(value)} ref={quoteattr(value)} start={quoteattr(value)}/>"
        for name, value in zip(names, values, strict=False)
    )
    try:
        schedule(read_block(XML.format(inner)))
    except BmlError as error:
        assert str(error)
