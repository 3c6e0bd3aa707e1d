"""The conversation with a face of lights, on a clock that stands still: what is sent, and when."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.led_face.conversation import (
    ANSWER_US,
    HELLO_US,
    MISSES,
    REFRESH_US,
    SILENCE_US,
    FaceLink,
    LinkState,
)
from woz_drivers.led_face.wire import FRAME, HELLO, HERE, SHOWN, WRONG, Packet, PacketReader

from tests.fakes.led_face import Board
from woz_tui.motion.body_feeds import FacePicture
from woz_tui.motion.light_frames import LightFrame, blank

pytestmark = pytest.mark.cpp

INTERVAL_US = 33_000


def wanted(number: int, brightness: float = 1.0) -> FacePicture:
    return FacePicture(LightFrame(24, (number, *[0] * 15)), brightness)


class TalkRig:
    """A talk with a board, and the time. `lose` says what happens to the next pieces sent."""

    def __init__(self) -> None:
        self.board = Board()
        self.now = 1_000_000
        self.sent: list[Packet] = []
        self.states: list[LinkState] = []
        self.deaf = self.mute = False
        self._reader = PacketReader()
        self._answers = b""
        self.talk = FaceLink(
            (24, 16),
            self._take,
            lambda: self.states.append(self.talk.state),
            interval_us=INTERVAL_US,
        )

    def _take(self, data: bytes) -> None:
        self.sent += self._reader.feed(data)
        if not self.deaf:
            self._answers += self.board.take(data)

    def step(self, picture: FacePicture, after_us: int = 0) -> None:
        """Some time passes, answers arrive, then it is the talk's turn."""
        self.now += after_us
        answers, self._answers = self._answers, b""
        if not self.mute:
            self.talk.received(answers, self.now)
        self.talk.step(picture, self.now)

    def begin(self) -> None:
        self.talk.begin(self.now)
        self.step(wanted(0))
        self.step(wanted(0))  # its answer

    def state(self) -> LinkState:
        return self.talk.state

    def count(self, kind: int) -> int:
        return sum(packet.type == kind for packet in self.sent)


@pytest.fixture
def rig() -> TalkRig:
    return TalkRig()


def test_hello_first_then_the_picture(rig: TalkRig) -> None:
    rig.talk.begin(rig.now)
    assert [packet.type for packet in rig.sent] == [HELLO]
    assert rig.state() is LinkState.ASKING
    rig.step(wanted(5))
    assert rig.state() is LinkState.TALKING
    assert rig.talk.detail == "memory, 24 x 16"
    assert rig.board.frame == wanted(5).frame


def test_a_picture_is_sent_on_a_change_and_every_second(rig: TalkRig) -> None:
    rig.begin()
    for _ in range(30):
        rig.step(wanted(0), INTERVAL_US)
    assert rig.count(FRAME) == 1
    rig.step(wanted(0), REFRESH_US)
    assert rig.count(FRAME) == 2
    rig.step(wanted(1), INTERVAL_US)
    assert rig.count(FRAME) == 3
    rig.step(wanted(1, 0.5), INTERVAL_US)
    assert rig.board.brightness == 128


def test_only_the_newest_of_many_pictures_is_sent(rig: TalkRig) -> None:
    rig.begin()
    for number in range(1, 100):
        rig.step(wanted(number), INTERVAL_US // 20)
    assert rig.count(FRAME) <= 1 + 99 // 20 + 1
    rig.step(wanted(99), INTERVAL_US)
    assert rig.board.frame == wanted(99).frame


def test_one_packet_is_under_way_at_a_time(rig: TalkRig) -> None:
    rig.begin()
    rig.mute = True
    rig.step(wanted(1), INTERVAL_US)
    sent = rig.count(FRAME)
    rig.step(wanted(2), ANSWER_US - 1)
    assert rig.count(FRAME) == sent
    rig.step(wanted(2), 1)
    assert rig.count(FRAME) == sent + 1
    assert rig.board.frame == wanted(2).frame


def test_a_lost_frame_is_sent_again_with_another_number(rig: TalkRig) -> None:
    rig.begin()
    rig.deaf = True
    rig.step(wanted(1), INTERVAL_US)
    rig.deaf = False
    rig.step(wanted(1), ANSWER_US)
    assert rig.board.frame == wanted(1).frame
    first, again = [packet for packet in rig.sent if packet.type == FRAME][-2:]
    assert first.number != again.number
    assert first.payload == again.payload


def test_an_answer_to_an_older_packet_confirms_nothing(rig: TalkRig) -> None:
    rig.begin()
    rig.mute = True
    rig.step(wanted(1), INTERVAL_US)
    under_way = rig.sent[-1]
    rig.talk.received(Packet(SHOWN, (under_way.number - 1) % 256, b"\0").encoded(), rig.now)
    assert rig.talk.shown != wanted(1)
    rig.talk.received(Packet(SHOWN, under_way.number, b"\0").encoded(), rig.now)
    assert rig.talk.shown == wanted(1)


def test_it_is_silent_after_many_misses_and_found_again(rig: TalkRig) -> None:
    rig.begin()
    rig.deaf = True
    for _ in range(MISSES + 1):
        rig.step(wanted(1), ANSWER_US)
    assert rig.state() is LinkState.SILENT
    assert rig.talk.detail == "the face does not answer any more"
    assert rig.talk.remedy
    hellos = rig.count(HELLO)
    for _ in range(10):
        rig.step(wanted(1), HELLO_US // 2)
    assert rig.count(HELLO) == hellos + 5
    rig.deaf = False
    for _ in range(3):
        rig.step(wanted(1), HELLO_US)
    assert rig.state() is LinkState.TALKING
    assert rig.board.frame == wanted(1).frame
    assert rig.states[-2:] == [LinkState.SILENT, LinkState.TALKING]


def test_a_face_that_started_anew_gets_its_picture_at_once(rig: TalkRig) -> None:
    rig.begin()
    rig.step(wanted(1), INTERVAL_US)
    rig.step(wanted(1), INTERVAL_US)
    rig.board = Board()
    rig.talk.received(rig.board.introduce(), rig.now)
    rig.step(wanted(1), INTERVAL_US)
    assert rig.board.frame == wanted(1).frame
    assert rig.states.count(LinkState.TALKING) == 1  # nobody needs to hear of it


@pytest.mark.parametrize(
    ("said", "why"),
    [
        (b"", "nothing came"),
        (b"\x05hello\0\x05world\0", "only 2 damaged packets came"),
    ],
)
def test_nobody_there(rig: TalkRig, said: bytes, why: str) -> None:
    rig.deaf = True
    rig.talk.begin(rig.now)
    rig.talk.received(said, rig.now)
    for _ in range(SILENCE_US // HELLO_US + 1):
        rig.step(wanted(1), HELLO_US)
    assert (rig.talk.state, rig.talk.detail) == (LinkState.SILENT, f"no face answers: {why}")
    assert "led_face" in rig.talk.remedy
    assert rig.count(FRAME) == 0


@pytest.mark.parametrize(
    ("here", "what"),
    [
        (b"\x02\x18\x10new", "speaks version 2 of the protocol, and this is 1"),
        (b"\x01\x10\x18turned", "wired as 16 x 24 lights, and the settings say 24 x 16"),
    ],
)
def test_another_face_gets_no_pictures(rig: TalkRig, here: bytes, what: str) -> None:
    rig.deaf = True
    rig.talk.begin(rig.now)
    for _ in range(5):
        rig.talk.received(Packet(HERE, 1, here).encoded(), rig.now)
        rig.step(wanted(1), HELLO_US)
    assert rig.state() is LinkState.STRANGE
    assert what in rig.talk.detail
    assert rig.talk.remedy
    assert rig.count(FRAME) == 0
    assert len(rig.states) == 2  # it is said once


def test_a_refused_packet_is_said_once(rig: TalkRig) -> None:
    rig.begin()
    rig.talk.received(Packet(WRONG, 2, b"\2").encoded(), rig.now)
    for _ in range(5):
        rig.step(wanted(1), HELLO_US)
    assert rig.state() is LinkState.STRANGE
    assert rig.talk.detail == "the face refused a packet: the frame has another size"
    assert rig.states == [LinkState.ASKING, LinkState.TALKING, LinkState.STRANGE]
    rig.begin()
    assert rig.talk.detail == "memory, 24 x 16"


@given(st.lists(st.binary(max_size=80), max_size=10))
def test_noise_is_no_answer(pieces: list[bytes]) -> None:
    talk_rig = TalkRig()
    talk_rig.deaf = True
    talk_rig.talk.begin(talk_rig.now)
    for piece in pieces:
        talk_rig.talk.received(piece, talk_rig.now)
        talk_rig.step(wanted(1), 1000)
    assert talk_rig.state() is LinkState.ASKING


@given(st.lists(st.tuples(st.integers(0, 9), st.booleans(), st.booleans()), max_size=60))
def test_in_the_end_the_face_shows_what_is_wanted(
    story: list[tuple[int, bool, bool]],
) -> None:
    talk_rig = TalkRig()
    talk_rig.begin()
    for (number, deaf, mute), after in zip(story, itertools.cycle((7_000, 90_000)), strict=False):
        talk_rig.deaf, talk_rig.mute = deaf, mute
        talk_rig.step(wanted(number), after)
    talk_rig.deaf = talk_rig.mute = False
    for _ in range(40):
        talk_rig.step(wanted(77), ANSWER_US)
    assert talk_rig.state() is LinkState.TALKING
    assert talk_rig.board.frame == wanted(77).frame
    assert talk_rig.talk.shown == wanted(77)


def test_nothing_wanted_is_dark(rig: TalkRig) -> None:
    rig.begin()
    rig.step(FacePicture(blank(24, 16), 0.0), INTERVAL_US)
    assert rig.board.brightness == 0


def test_half_a_packet_of_a_program_before_does_not_spoil_the_hello() -> None:
    talk_rig = TalkRig()
    talk_rig.board.take(Packet(HELLO, 9, bytes(40)).encoded()[:20])
    talk_rig.talk.begin(talk_rig.now)
    talk_rig.step(wanted(1), after_us=20_000)
    assert talk_rig.talk.state is LinkState.TALKING
    assert [packet.type for packet in talk_rig.sent] == [HELLO, FRAME]
