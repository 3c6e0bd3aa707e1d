"""The hub: stamps, records before anybody hears, and drops samples but never an ack."""

from __future__ import annotations

from collections import deque
from typing import cast

from hypothesis import given
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from woz_tui.bus.hub import Hub, Subscription
from woz_tui.protocol import codec
from woz_tui.protocol.messages import Ack, Done, End, Marker, Message, Note, Reading
from woz_tui.system.clock import ManualClock


class CallOrder:
    """Notes in one list who was told what, in order."""

    def __init__(self) -> None:
        self.entries: list[tuple[str, int]] = []
        self.lines: list[bytes] = []

    def record(self, message: Message, line: bytes) -> None:
        self.entries.append(("recorder", message.seq))
        self.lines.append(line)

    def hear(self, message: Message) -> None:
        self.entries.append(("listener", message.seq))

    def wake(self) -> None:
        self.entries.append(("subscriber", -1))


def test_messages_are_numbered_and_timed_from_the_sessions_beginning() -> None:
    clock = ManualClock()
    clock.advance(100)
    hub = Hub(clock, CallOrder().record)
    assert hub.seq == -1
    first = hub.publish(Marker(text="begin"))
    clock.advance(1.5)
    second = hub.publish(Marker(text="end"))
    assert (first.seq, first.t, first.ts) == (0, 0, "2026-03-01T10:01:40.000000Z")
    assert (second.seq, second.t, second.ts) == (1, 1_500_000, "2026-03-01T10:01:41.500000Z")
    assert hub.seq == 1


def test_the_t_axis_ignores_a_step_of_the_wall_clock() -> None:
    clock = ManualClock()
    hub = Hub(clock, CallOrder().record)
    clock.advance(1)
    clock.shift_wall(-86_400)
    assert hub.publish(Marker()).t == 1_000_000


def test_what_the_maker_wrote_into_the_stamp_is_overwritten() -> None:
    hub = Hub(ManualClock(), CallOrder().record)
    assert hub.publish(Marker(seq=99, t=99, ts="never")).seq == 0


def test_samples_carry_no_wall_clock() -> None:
    hub = Hub(ManualClock(), CallOrder().record)
    assert hub.publish(Reading(sensor="distance", value=1.0)).ts == ""


def test_the_recorder_is_first_and_gets_the_very_line_that_is_sent() -> None:
    diary = CallOrder()
    hub = Hub(ManualClock(), diary.record)
    hub.listen(diary.hear)
    subscription = hub.subscribe(10, True, diary.wake)
    stamped = hub.publish(Note(text="ümläut"))
    assert diary.entries[0] == ("recorder", 0)
    assert set(diary.entries[1:]) == {("listener", 0), ("subscriber", -1)}
    assert subscription.take_all() == diary.lines == [codec.encode(stamped)]


def test_everybody_hears_in_order_even_if_a_listener_answers() -> None:
    diary = CallOrder()
    hub = Hub(ManualClock(), diary.record)

    def answer(message: Message) -> None:
        if isinstance(message, Note):
            hub.publish(Marker(text=f"about {message.text}"))

    hub.listen(answer)
    hub.listen(diary.hear)
    subscription = hub.subscribe(10, True, diary.wake)
    hub.publish(Note(text="one"))
    hub.publish(Note(text="two"))
    assert [seq for who, seq in diary.entries if who == "recorder"] == [0, 1, 2, 3]
    assert [seq for who, seq in diary.entries if who == "listener"] == [0, 1, 2, 3]
    assert [codec.decode_message(line).seq for line in subscription.take_all()] == [0, 1, 2, 3]


def test_a_listener_is_called_with_the_kinds_that_it_names_in_order_of_listening() -> None:
    hub, heard = Hub(ManualClock(), CallOrder().record), []
    hub.listen(lambda message: heard.append(("ends", type(message))), End, Note)
    hub.listen(lambda message: heard.append(("all", type(message))))
    hub.listen(lambda message: heard.append(("others", type(message))), but=(Ack, Reading))
    done = Done(command="c1", latency_us=0, duration_us=1, sent={})
    for message in (done, Note(text="one"), Reading(sensor="distance", value=1.0)):
        hub.publish(message)
    assert heard == [
        *(("ends", Done), ("all", Done)),
        *(("ends", Note), ("all", Note), ("others", Note)),
        ("all", Reading),
    ]


def test_who_comes_or_goes_between_two_messages_of_a_kind_hears_the_second_or_only_the_first() -> (
    None
):
    diary = CallOrder()
    hub = Hub(ManualClock(), CallOrder().record)
    hub.publish(Note(text="nobody is there"))
    hub.listen(diary.hear, Note, Marker)
    hub.publish(Note(text="one"))
    hub.ignore(diary.hear, Note, Marker)
    hub.publish(Note(text="two"))
    assert diary.entries == [("listener", 1)]


def test_who_is_passed_by_for_a_while_keeps_its_place() -> None:
    hub, heard = Hub(ManualClock(), CallOrder().record), []

    def first(message: Note) -> None:
        heard.append(("first", message.text))

    def second(message: Note) -> None:
        heard.append(("second", message.text))

    hub.listen(first, Note)
    hub.listen(second, Note)
    hub.publish(Note(text="one"))
    hub.pass_by([first])
    hub.publish(Note(text="two"))
    hub.pass_by([])
    hub.publish(Note(text="three"))
    assert heard == [
        *(("first", "one"), ("second", "one")),
        ("second", "two"),
        *(("first", "three"), ("second", "three")),
    ]


def test_a_subscriber_is_woken_once_until_it_takes() -> None:
    diary = CallOrder()
    subscription = Subscription(10, True, diary.wake)
    subscription.offer(False, b"1\n")
    subscription.offer(False, b"2\n")
    assert diary.entries == [("subscriber", -1)]
    assert subscription.take_all() == [b"1\n", b"2\n"]
    assert subscription.take_all() == []
    subscription.offer(False, b"3\n")
    assert len(diary.entries) == 2


def test_after_unsubscribing_nothing_arrives() -> None:
    hub = Hub(ManualClock(), CallOrder().record)
    subscription = hub.subscribe(10, True, CallOrder().wake)
    hub.unsubscribe(subscription)
    hub.unsubscribe(subscription)
    hub.publish(Marker())
    assert subscription.take_all() == []


def test_who_wants_no_samples_gets_none_and_loses_none() -> None:
    subscription = Subscription(1, False, CallOrder().wake)
    subscription.offer(True, b"sample\n")
    assert (subscription.take_all(), subscription.dropped) == ([], 0)


def test_the_oldest_sample_makes_room() -> None:
    subscription = Subscription(3, True, CallOrder().wake)
    for sample, line in [(True, b"s1"), (False, b"a1"), (True, b"s2"), (True, b"s3")]:
        subscription.offer(sample, line)
    assert subscription.take_all() == [b"a1", b"s2", b"s3"]
    assert (subscription.dropped, subscription.overrun) == (1, False)


def test_too_many_acks_mark_the_subscription_and_lose_nothing() -> None:
    subscription = Subscription(2, True, CallOrder().wake)
    acks = [f"a{number}".encode() for number in range(5)]
    for ack in acks:
        subscription.offer(False, ack)
    assert subscription.overrun
    assert subscription.take_all() == acks


class Looked:
    """Whether a line is a sample, and how often anybody has looked."""

    looks = 0

    def __bool__(self) -> bool:
        Looked.looks += 1
        return False


def test_a_line_for_a_full_buffer_needs_no_look_at_those_that_wait() -> None:
    """A hundred listeners that never take would hold up everybody at each message."""
    subscription = Subscription(1000, True, CallOrder().wake)
    for _ in range(1000):
        subscription.offer(cast(bool, Looked()), b"ack")
    Looked.looks = 0
    subscription.offer(cast(bool, Looked()), b"one more")
    assert Looked.looks < 10


class BoundedBuffer(RuleBasedStateMachine):
    """A subscription against the plainest description of what it should hold."""

    CAPACITY = 4

    def __init__(self) -> None:
        super().__init__()
        self.woken = 0
        self.subscription = Subscription(self.CAPACITY, True, self._wake)
        self.offered = 0
        self.waiting: deque[tuple[bool, bytes]] = deque()
        self.dropped = 0

    def _wake(self) -> None:
        self.woken += 1

    @rule(sample=st.booleans())
    def offer(self, sample: bool) -> None:
        line = str(self.offered).encode()
        self.offered += 1
        self.subscription.offer(sample, line)
        self.waiting.append((sample, line))
        while len(self.waiting) > self.CAPACITY and any(is_sample for is_sample, _ in self.waiting):
            oldest = next(item for item in self.waiting if item[0])
            self.waiting.remove(oldest)
            self.dropped += 1

    @rule()
    def take(self) -> None:
        assert self.subscription.take_all() == [line for _, line in self.waiting]
        self.waiting.clear()
        self.woken = 0

    @invariant()
    def counts_agree(self) -> None:
        assert self.subscription.dropped == self.dropped
        assert self.woken <= 1
        assert bool(self.waiting) <= bool(self.woken)


TestBoundedBuffer = BoundedBuffer.TestCase


@given(st.lists(st.sampled_from(["reading", "ack"]), max_size=60), st.integers(1, 8))
def test_every_ack_reaches_a_listener_that_never_takes(kinds: list[str], capacity: int) -> None:
    diary = CallOrder()
    hub = Hub(ManualClock(), diary.record)
    subscription = hub.subscribe(capacity, True, diary.wake)
    for kind in kinds:
        hub.publish(_message(kind))
    arrived = [codec.decode_message(line) for line in subscription.take_all()]
    acks = [message.seq for message in arrived if isinstance(message, Done)]
    assert acks == [seq for seq, kind in enumerate(kinds) if kind == "ack"]
    assert [message.seq for message in arrived] == sorted(message.seq for message in arrived)
    assert len(arrived) + subscription.dropped == len(kinds) == len(diary.lines)
    assert subscription.overrun == (len(acks) > capacity)


def _message(kind: str) -> Message:
    if kind == "ack":
        return Done(command="c1", sent={}, latency_us=1, duration_us=1)
    return Reading(sensor="loudness", value=0.25)
