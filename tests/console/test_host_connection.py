from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.fakes.host import WAIT_S, FakeHost, stops
from woz_tui.console.input.keyboard import Keyboard
from woz_tui.console.link.host_connection import WAITING_LIMIT, HostConnection
from woz_tui.console.link.message_feed import Incoming, Loss, LostPart
from woz_tui.protocol import codec
from woz_tui.protocol.messages import Marker, Notice, SessionEnd
from woz_tui.protocol.requests import (
    AskAction,
    AskEnd,
    AskMarker,
    AskNote,
    AskStop,
    Beat,
    Hello,
    Pulse,
    Reply,
    Request,
    Welcome,
)
from woz_tui.protocol.welcome import WelcomeSettings
from woz_tui.system import session_sockets
from woz_tui.system.clock import ManualClock, boot_id

REFUSED = Reply(ref=1, ok=False, reason="no part", hint="there are a")


class Deliveries:
    """Everything a link delivers."""

    def __init__(self) -> None:
        self.messages: list[Incoming] = []
        self.lost: list[Loss] = []
        self._changed = threading.Condition()

    def on_messages(self, batch: list[Incoming]) -> None:
        with self._changed:
            self.messages += batch
            self._changed.notify_all()

    def on_lost(self, loss: Loss) -> None:
        with self._changed:
            self.lost.append(loss)
            self._changed.notify_all()

    def until(self, true: Callable[[], bool]) -> None:
        with self._changed:
            assert self._changed.wait_for(true, WAIT_S), (self.messages, self.lost)

    def until_heard(self, kind: type, count: int = 1) -> None:
        self.until(lambda: sum(isinstance(m, kind) for m in self.messages) >= count)


@pytest.fixture
def host(tmp_path: Path) -> Iterator[FakeHost]:
    with FakeHost(tmp_path / "host.sock", keys={"h": "Hello"}) as fake:
        yield fake


@pytest.fixture
def deliveries() -> Deliveries:
    return Deliveries()


@pytest.fixture
def link(host: FakeHost, deliveries: Deliveries) -> Iterator[HostConnection]:
    host_connection = HostConnection(host.path, name="test")
    host_connection.start(deliveries.on_messages, deliveries.on_lost)
    yield host_connection
    host_connection.close()


def test_it_says_hello_first_and_is_welcomed(
    host: FakeHost, link: HostConnection, deliveries: Deliveries
) -> None:
    deliveries.until_heard(Welcome)

    assert isinstance(host.heard[0].request, Hello)
    assert host.heard[0].request.name == "test"
    assert isinstance(deliveries.messages[0], Welcome)


def test_nobody_listens(tmp_path: Path, deliveries: Deliveries) -> None:
    with pytest.raises(ConnectionError, match="woz run"):
        HostConnection(tmp_path / "nothing.sock").start(deliveries.on_messages, deliveries.on_lost)


def test_each_request_has_its_own_ref_which_the_reply_repeats(
    host: FakeHost, link: HostConnection, deliveries: Deliveries
) -> None:
    refs = [link.ask(AskAction(action="Hello")), link.ask(AskMarker())]
    deliveries.until_heard(Reply, 2)

    assert len(set(refs)) == 2
    assert [reply.ref for reply in deliveries.messages if isinstance(reply, Reply)] == refs


def test_requests_of_many_threads_arrive_whole_and_in_each_threads_order(
    host: FakeHost, link: HostConnection
) -> None:
    def ask(name: str) -> None:
        for number in range(50):
            link.ask(AskNote(text=f"{name}{number}"))

    threads = [threading.Thread(target=ask, args=(name,)) for name in "abcd"]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    host.wait(AskNote, 200)

    said = [note.text for note in host.all(AskNote)]
    for name in "abcd":
        assert [text for text in said if text[0] == name] == [f"{name}{n}" for n in range(50)]


def test_the_feed_has_the_age_at_which_the_experiment_refuses_keys(
    host: FakeHost, deliveries: Deliveries
) -> None:
    host.settings = WelcomeSettings(stale_after=0.7)
    link = HostConnection(host.path)
    link.start(deliveries.on_messages, deliveries.on_lost)
    deliveries.until_heard(Welcome)

    assert link.stale_after_s == 0.7
    link.close()


def test_beats_say_whether_the_line_is_good(host: FakeHost, link: HostConnection) -> None:
    assert host.wait(Beat).line_ok

    link.line_ok = False

    host.until(lambda: not host.all(Beat)[-1].line_ok, "a beat with a bad line")


def test_messages_come_decoded_and_in_order(
    host: FakeHost, link: HostConnection, deliveries: Deliveries
) -> None:
    deliveries.until_heard(Welcome)
    host.say(Marker(text="one"), Marker(text="two"))
    deliveries.until_heard(Marker, 2)

    assert [m.text for m in deliveries.messages if isinstance(m, Marker)] == ["one", "two"]


def test_a_kind_of_tomorrow_is_a_dict_and_rubbish_is_told(
    host: FakeHost, link: HostConnection, deliveries: Deliveries
) -> None:
    deliveries.until_heard(Welcome)
    host.say_bytes(b'{"kind":"tomorrow","x":1}\nrubbish\n')
    deliveries.until_heard(Notice)

    assert {"kind": "tomorrow", "x": 1} in deliveries.messages


def test_a_host_that_closes_is_lost_and_found_again(
    host: FakeHost, link: HostConnection, deliveries: Deliveries
) -> None:
    deliveries.until_heard(Welcome)
    host.drop()
    deliveries.until(lambda: bool(deliveries.lost))
    deliveries.until_heard(Welcome, 2)

    link.ask(AskMarker(text="back"))

    assert host.wait(AskMarker).text == "back"
    assert [loss.part for loss in deliveries.lost] == [LostPart.PROCESS]


def test_whoever_took_over_does_not_take_over_again_when_coming_back(
    host: FakeHost, deliveries: Deliveries
) -> None:
    link = HostConnection(host.path, take_over=True)
    link.start(deliveries.on_messages, deliveries.on_lost)
    host.wait(Hello)
    host.drop()
    host.wait(Hello, 2)
    link.close()

    assert [hello.take_over for hello in host.all(Hello)] == [True, False]


def test_a_silent_host_is_lost(host: FakeHost, deliveries: Deliveries) -> None:
    link = HostConnection(host.path, silence_s=0.5)
    link.start(deliveries.on_messages, deliveries.on_lost)
    deliveries.until_heard(Pulse)

    host.silent = True
    deliveries.until(lambda: bool(deliveries.lost))
    link.close()

    assert deliveries.lost[0].part is LostPart.ANSWER


def test_behind_a_network_it_is_the_line_that_is_lost(
    host: FakeHost, deliveries: Deliveries
) -> None:
    host.robot_at = "robot.local:8765"
    link = HostConnection(host.path)
    link.start(deliveries.on_messages, deliveries.on_lost)
    deliveries.until_heard(Welcome)
    host.stop_listening()
    host.drop()
    deliveries.until(lambda: bool(deliveries.lost))
    link.close()
    assert deliveries.lost[0].part is LostPart.LINE


def test_what_becomes_known_of_a_loss_is_told_again_and_once(
    host: FakeHost, deliveries: Deliveries
) -> None:
    known = [Loss("cut off", LostPart.LINE)]
    link = HostConnection(host.path, explain=lambda loss: known[-1])
    link.start(deliveries.on_messages, deliveries.on_lost)
    deliveries.until_heard(Welcome)
    host.stop_listening()
    host.drop()
    deliveries.until(lambda: bool(deliveries.lost))
    known.append(Loss("no session listens there"))
    deliveries.until(lambda: len(deliveries.lost) == 2)
    link.close()
    assert deliveries.lost == known


def test_after_the_end_of_the_session_nobody_looks_for_it(
    host: FakeHost, link: HostConnection, deliveries: Deliveries
) -> None:
    deliveries.until_heard(Welcome)
    host.say(SessionEnd(reason="wizard"))
    deliveries.until_heard(SessionEnd)
    host.drop()
    deliveries.until(lambda: bool(deliveries.lost))

    assert [loss.why for loss in deliveries.lost] == ["the session has ended"]
    host.until(lambda: len(host.closed) == 1, "the connection's end")
    assert len(host.all(Hello)) == 1


def test_on_a_lost_link_asking_does_nothing_and_the_stop_still_tries(
    host: FakeHost, link: HostConnection, deliveries: Deliveries
) -> None:
    deliveries.until_heard(Welcome)
    host.stop_listening()
    host.drop()
    deliveries.until(lambda: bool(deliveries.lost))

    link.ask(AskMarker(text="nowhere"))
    host.listen()
    link.ask(AskStop(source="escape"))

    assert host.wait(AskStop).source == "escape"
    assert host.all(AskMarker) == []


@pytest.mark.parametrize("same", [True, False])
def test_requests_are_stamped_where_the_host_has_the_same_clock(
    host: FakeHost, deliveries: Deliveries, same: bool
) -> None:
    host.boot_id = boot_id() if same else "another-machine"
    clock = ManualClock()
    clock.advance(7)
    clock.sleep(3)
    link = HostConnection(host.path, clock=clock)
    link.start(deliveries.on_messages, deliveries.on_lost)
    deliveries.until_heard(Welcome)
    link.ask(AskAction(action="Hello"))
    link.ask(AskStop())
    link.close()
    stamp = 10_000_000 if same else 0
    assert (host.wait(AskAction).sent_us, host.wait(AskStop).sent_us) == (stamp, stamp)


def test_a_key_that_waits_in_this_process_is_sent_with_the_moment_at_which_its_age_was_known(
    host: FakeHost, deliveries: Deliveries
) -> None:
    """The process may be frozen between the two."""
    host.boot_id, clock = boot_id(), ManualClock()
    clock.advance(7)
    link = HostConnection(host.path, clock=clock)
    link.start(deliveries.on_messages, deliveries.on_lost)
    deliveries.until_heard(Welcome)
    keyboard = Keyboard(link, clock)
    keyboard.bind({"h": "Hello"}, {})
    known_us = clock.boot_us()
    clock.advance(1.6)
    assert keyboard.arrive("h", age_us=5, at_us=known_us)
    link.close()
    asked = host.wait(AskAction)
    assert (asked.sent_us, asked.age_us) == (known_us, 5)


def test_a_host_that_is_found_again_gets_only_stops_until_it_speaks(
    host: FakeHost, deliveries: Deliveries
) -> None:
    link = HostConnection(host.path, silence_s=2.0)
    link.start(deliveries.on_messages, deliveries.on_lost)
    deliveries.until_heard(Welcome)
    host.frozen = True  # it neither reads nor speaks, but the kernel takes connections for it
    deliveries.until(lambda: bool(deliveries.lost))
    link.ask(AskAction(action="Hello"))
    link.ask(AskStop(source="escape"))
    host.frozen = False
    deliveries.until_heard(Welcome, 2)
    link.ask(AskAction(action="Bye"))
    assert host.wait(AskStop).source == "escape"
    assert host.wait(AskAction).action == "Bye"
    link.close()


def test_what_was_asked_before_leaving_arrives(
    host: FakeHost, link: HostConnection, deliveries: Deliveries
) -> None:
    deliveries.until_heard(Welcome)
    link.ask(AskEnd())
    link.close()
    link.close()

    host.wait(AskEnd)
    host.until(lambda: bool(host.closed), "the connection's end")
    assert deliveries.lost == []


def test_a_host_that_does_not_read_blocks_nobody_and_the_stop_overtakes(
    host: FakeHost, link: HostConnection, deliveries: Deliveries
) -> None:
    deliveries.until_heard(Welcome)
    host.frozen = True
    for _ in range(WAITING_LIMIT // 2):
        link.ask(AskNote(text="x" * 2000))
    link.ask(AskStop(source="escape"))
    host.frozen = False
    host.wait(AskNote, WAITING_LIMIT // 2)
    host.wait(AskStop, 2)

    connections = {heard.connection for heard in host.heard if isinstance(heard.request, AskStop)}
    assert len(connections) == 2, "one way of its own, one in the queue"
    assert stops(host) == ["escape", "escape"]


def test_a_host_that_never_reads_is_given_up(
    host: FakeHost, link: HostConnection, deliveries: Deliveries
) -> None:
    deliveries.until_heard(Welcome)
    host.frozen = True
    for _ in range(WAITING_LIMIT * 2):
        link.ask(AskNote(text="x" * 2000))
    deliveries.until(lambda: bool(deliveries.lost))
    host.frozen = False


@contextlib.contextmanager
def answering(path: Path, *answers: Pulse | Reply) -> Iterator[list[Request]]:
    """A host that gives one answer to each connection; yields what each of them says first."""

    def serve() -> None:
        for answer in answers:
            connection, _ = listener.accept()
            with connection:
                asked.append(codec.decode_request(connection.recv(4096).partition(b"\n")[0]))
                connection.sendall(codec.encode(answer))
                with contextlib.suppress(ConnectionError):
                    connection.recv(1)

    asked: list[Request] = []
    with session_sockets.bind(path) as listener:
        listener.setblocking(True)
        threading.Thread(target=serve, daemon=True).start()
        yield asked


@pytest.mark.parametrize("known", [True, False])
def test_a_part_that_the_experiment_does_not_have_opens_no_screen(
    tmp_path: Path, known: bool
) -> None:
    path = tmp_path / "host.sock"
    with answering(path, Pulse(t=1) if known else REFUSED) as asked:
        link = HostConnection(path, part="voice")
        if known:
            link.connect()
        else:
            with pytest.raises(ConnectionError, match="no part: there are a"):
                link.connect()
        assert isinstance(asked[0], Hello)
        assert asked[0].part == "voice"


def test_a_role_that_another_machine_refuses_opens_no_screen(tmp_path: Path) -> None:
    path = tmp_path / "host.sock"
    with answering(path, REFUSED):
        link = HostConnection(path, explain=lambda loss: loss)
        with pytest.raises(ConnectionError, match="no part: there are a"):
            link.connect()


def test_who_is_refused_on_the_way_is_told_why(tmp_path: Path) -> None:
    path, delivered = tmp_path / "host.sock", Deliveries()
    with answering(path, REFUSED):
        link = HostConnection(path)
        link.start(delivered.on_messages, delivered.on_lost)
        delivered.until(lambda: bool(delivered.lost))
        assert "no part: there are a" in delivered.lost[0].why
        assert delivered.lost[0].part is LostPart.ANSWER
        link.close()
