"""The tablet's server, asked by a real HTTP client and by whatever else comes along."""

from __future__ import annotations

import errno
import http.client
import os
import socket
import threading
import urllib.request
from collections.abc import Callable, Iterator
from http import HTTPStatus
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from woz_drivers.naoqi_robot.served_files import MOST, TYPES, ByteRange, FileServer, byte_range

from woz_tui.drivers.contract import DriverError

BODY = bytes(range(256)) * 1000
HOST = "127.0.0.1"
PATIENCE_S = 20.0


@pytest.fixture
def troubles() -> list[str]:
    return []


@pytest.fixture
def server(troubles: list[str]) -> Iterator[FileServer]:
    file_server = FileServer(HOST, 0, troubles.append)
    yield file_server
    file_server.close()
    assert troubles == []


@pytest.fixture
def film(tmp_path: Path) -> Path:
    path = tmp_path / "film.mp4"
    path.write_bytes(BODY)
    return path


def ask(
    url: str, method: str = "GET", **headers: str
) -> tuple[int, http.client.HTTPMessage, bytes]:
    """One request by the standard library's client."""
    split = urlsplit(url)
    assert split.hostname is not None
    line = http.client.HTTPConnection(split.hostname, split.port, timeout=PATIENCE_S)
    try:
        line.request(
            method, split.path, headers={k.replace("_", "-"): v for k, v in headers.items()}
        )
        answer = line.getresponse()
        return answer.status, answer.headers, answer.read()
    finally:
        line.close()


def had(url: str) -> bytes:
    """What an address gives; nothing where the server hangs up."""
    try:
        return ask(url)[2]
    except (http.client.HTTPException, ConnectionError):
        return b""


def raw(port: int, request: bytes) -> bytes:
    """Bytes in, bytes out, until the server hangs up."""
    with socket.create_connection((HOST, port), timeout=PATIENCE_S) as line:
        line.sendall(request)
        if b"\r\n\r\n" not in request:
            line.shutdown(socket.SHUT_WR)  # else it waits for the rest
        came = b""
        try:
            while piece := line.recv(1 << 16):
                came += piece
        except ConnectionError:
            pass
        return came


def threads() -> set[str]:
    return {one.name for one in threading.enumerate() if one.name.startswith("robot files")}


def until(holds: Callable[[], bool]) -> None:
    """Return when it holds."""
    waited = threading.Event()
    for _ in range(2000):
        if holds():
            return
        waited.wait(0.01)
    raise AssertionError("never")


def test_a_listed_file_is_had_as_it_is(server: FileServer, film: Path) -> None:
    url = server.list_file(film)
    with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(url) as answer:
        assert answer.read() == BODY
        assert answer.headers["Content-Type"] == "video/mp4"
        assert answer.headers["Content-Length"] == str(len(BODY))
        assert answer.headers["Accept-Ranges"] == "bytes"
        assert answer.headers["Server"] is None
    assert "film" not in url
    assert server.list_file(film) == url


@pytest.mark.parametrize("suffix", sorted(TYPES))
def test_every_kind_has_its_type(server: FileServer, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"x{suffix.upper()}"
    path.write_bytes(b"x")
    status, headers, body = ask(server.list_file(path))
    assert (status, headers["Content-Type"], body) == (200, TYPES[suffix], b"x")


def test_head_tells_the_same_without_the_bytes(server: FileServer, film: Path) -> None:
    url = server.list_file(film)
    status, headers, body = ask(url, "HEAD")
    assert (status, body) == (200, b"")
    assert dict(headers) == dict(ask(url)[1])


@pytest.mark.parametrize(
    ("wish", "start", "end"),
    [
        ("bytes=0-99", 0, 100),
        ("bytes=100-", 100, len(BODY)),
        ("bytes=-10", len(BODY) - 10, len(BODY)),
        ("bytes=255990-999999", 255_990, len(BODY)),
        ("bytes=0-0", 0, 1),
    ],
)
def test_a_player_gets_the_part_it_asks_for(
    server: FileServer, film: Path, wish: str, start: int, end: int
) -> None:
    status, headers, body = ask(server.list_file(film), Range=wish)
    assert status == HTTPStatus.PARTIAL_CONTENT
    assert body == BODY[start:end]
    assert headers["Content-Range"] == f"bytes {start}-{end - 1}/{len(BODY)}"


@pytest.mark.parametrize("wish", ["bytes=256000-", "bytes=999999-9999999", "bytes=-0"])
def test_bytes_that_are_not_there_are_no_answer(server: FileServer, film: Path, wish: str) -> None:
    status, headers, body = ask(server.list_file(film), Range=wish)
    assert (status, body) == (416, b"")
    assert headers["Content-Range"] == f"bytes */{len(BODY)}"


@pytest.mark.parametrize(
    "wish",
    ["lines=0-1", "bytes=5-2", "bytes=0-1,3-4", "bytes=-", "bytes=a-b", f"bytes=0-{'9' * 99}"],
)
def test_a_wish_that_is_not_understood_gets_all(server: FileServer, film: Path, wish: str) -> None:
    assert ask(server.list_file(film), Range=wish)[::2] == (200, BODY)


def test_a_part_of_something_else_than_before_gets_all(server: FileServer, film: Path) -> None:
    assert ask(server.list_file(film), Range="bytes=0-9", If_Range='"x"')[::2] == (200, BODY)


@given(st.text(alphabet="bytes=0123456789-, ", max_size=30), st.integers(0, 1000))
@example("bytes=0-", 0)
@example("bytes=-5", 3)
def test_every_range_lies_within_the_file(wish: str, size: int) -> None:
    found = byte_range(wish, size)
    if found is not None:
        assert 0 <= found.start <= found.end <= size == found.size
        assert found.start < found.end or found == ByteRange(0, 0, 0)


def test_a_page_is_had_like_a_file(server: FileServer) -> None:
    status, headers, body = ask(server.list_page("<p>ä</p>"))
    assert (status, body) == (200, "<p>ä</p>".encode())
    assert headers["Content-Type"] == "text/html; charset=utf-8"


def test_a_file_is_what_it_is_when_it_is_asked_for(server: FileServer, film: Path) -> None:
    url = server.list_file(film)
    film.write_bytes(b"another one")
    assert ask(url)[2] == b"another one"
    film.unlink()
    assert ask(url)[0] == HTTPStatus.NOT_FOUND


def test_a_link_is_followed_when_it_is_listed_and_never_afterwards(
    server: FileServer, film: Path, tmp_path: Path
) -> None:
    secret, link = tmp_path / "secret", tmp_path / "link.png"
    secret.write_bytes(b"secret")
    link.symlink_to(film)
    url = server.list_file(link)
    link.unlink()
    link.symlink_to(secret)
    assert ask(url)[2] == BODY
    film.unlink()
    film.symlink_to(secret)
    assert ask(url)[::2] == (404, b"")


def test_neither_a_folder_nor_a_pipe_is_served(
    server: FileServer, film: Path, tmp_path: Path
) -> None:
    url = server.list_file(film)
    film.unlink()
    os.mkfifo(film)
    assert ask(url)[0] == HTTPStatus.NOT_FOUND
    film.unlink()
    film.mkdir()
    assert ask(url)[0] == HTTPStatus.NOT_FOUND
    with pytest.raises(DriverError, match="is no file"):
        server.list_file(tmp_path)


def test_what_cannot_be_read_is_told_when_it_is_listed(server: FileServer, tmp_path: Path) -> None:
    with pytest.raises(DriverError, match="cannot be served: No such file"):
        server.list_file(tmp_path / "missing.png")
    circle = tmp_path / "circle.png"
    circle.symlink_to(circle)
    with pytest.raises(DriverError, match="cannot be served"):
        server.list_file(circle)


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT"])
def test_nothing_but_looking_is_possible(server: FileServer, film: Path, method: str) -> None:
    status, _, body = ask(server.list_file(film), method)
    assert (status, body) == (501, b"")


def test_folders_and_guesses_are_not_found(server: FileServer, film: Path) -> None:
    path = urlsplit(server.list_file(film)).path
    token = path.split("/")[1]
    guesses = ["/", f"/{token}", f"/{token}/", f"/{token}/film.mp4", f"/{token}/1.mp4", "/0.mp4"]
    guesses += [f"{path}/", f"/x{path}", path.upper(), f"/{token}/../{token}/0.mp4", f"/{film}"]
    guesses += [f"/{token}/..%2f..%2fetc/passwd", f"/{token}/%2e%2e/{token}/0.mp4", f"{path}%00"]
    for guess in guesses:
        answer = raw(server.port, f"GET {guess} HTTP/1.1\r\nHost: x\r\n\r\n".encode())
        assert answer.startswith(b"HTTP/1.1 404 ") or answer.startswith(b"HTTP/1.0 404 "), guess
        assert BODY[:64] not in answer
    assert len(token) >= 20


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.binary(max_size=200)
    | st.lists(
        st.sampled_from(
            [
                "..",
                ".",
                "",
                "~",
                "etc",
                "passwd",
                "secret",
                "%2e%2e",
                "%2f",
                "0.mp4",
                "\\",
                "\0",
                "ü",
            ]
        ),
        max_size=8,
    ).map(lambda steps: f"GET /{'/'.join(steps)} HTTP/1.1\r\n\r\n".encode())
)
@example(b"")
@example(b"GET / HTTP/9.9\r\n\r\n")
@example(b"GET /" + b"x" * 70_000 + b" HTTP/1.1\r\n\r\n")
@example(b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * 200 + b"\r\n")
@example(b"GET / HTTP/1.1\r\nx: " + b"y" * 70_000 + b"\r\n\r\n")
def test_whatever_is_asked_nothing_that_was_not_listed_comes_out(
    server: FileServer, tmp_path: Path, request_bytes: bytes
) -> None:
    (tmp_path / "secret").write_bytes(b"SECRET")
    server.list_file(tmp_path / "secret")
    answer = raw(server.port, request_bytes)
    assert b"SECRET" not in answer
    assert b"root:" not in answer
    assert b"Traceback" not in answer
    assert b"Python" not in answer
    assert not answer or answer.startswith(b"HTTP/1.") or request_bytes[:4] == b"GET "


def test_a_token_is_never_the_same(server: FileServer, film: Path) -> None:
    other = FileServer(HOST, 0, pytest.fail)
    try:
        assert urlsplit(other.list_file(film)).path != urlsplit(server.list_file(film)).path
    finally:
        other.close()


def test_a_taken_port_is_told_with_a_remedy(server: FileServer) -> None:
    with pytest.raises(DriverError, match=f"port {server.port}: Address already in use") as raised:
        FileServer(HOST, server.port, pytest.fail)
    assert "tablet.port" in raised.value.remedy


@pytest.mark.parametrize(
    ("host", "words"), [("192.0.2.1", "Cannot assign"), ("robot.local", "is no address")]
)
def test_an_address_of_somebody_else_is_told(host: str, words: str) -> None:
    with pytest.raises(DriverError, match=words) as raised:
        FileServer(host, 0, pytest.fail)
    assert "tablet.address" in raised.value.remedy


def test_a_client_that_says_nothing_is_shown_out(film: Path, troubles: list[str]) -> None:
    server = FileServer(HOST, 0, troubles.append, patience=0.2)
    try:
        with socket.create_connection((HOST, server.port), timeout=PATIENCE_S) as slow:
            slow.sendall(b"GET / HT")
            assert slow.recv(100) == b""
        until(lambda: had(server.list_file(film)) == BODY)
    finally:
        server.close()
    assert troubles == []


def test_a_client_that_says_a_letter_now_and_then_is_shown_out_too() -> None:
    server = FileServer(HOST, 0, pytest.fail, patience=0.3)
    try:
        with socket.create_connection((HOST, server.port), timeout=PATIENCE_S) as slow:
            slow.settimeout(0.05)
            for _ in range(400):
                try:
                    slow.sendall(b"x")
                    if slow.recv(100) == b"":
                        break
                except TimeoutError:
                    continue
                except ConnectionError:
                    break
            else:
                pytest.fail("it may go on for ever")
    finally:
        server.close()


def test_a_long_film_is_sent_to_its_end(server: FileServer, tmp_path: Path) -> None:
    path = tmp_path / "long.mp4"
    path.write_bytes(bytes(32 << 20))  # more than lies between two sockets
    split = urlsplit(server.list_file(path))
    line = http.client.HTTPConnection(HOST, server.port, timeout=PATIENCE_S)
    line.request("GET", split.path)
    answer = line.getresponse()
    assert ask(server.list_page("page"))[2] == b"page"  # meanwhile
    assert len(answer.read()) == 32 << 20
    line.close()


def test_who_asks_for_a_film_and_takes_nothing_of_it_keeps_no_place(
    tmp_path: Path, troubles: list[str]
) -> None:
    path = tmp_path / "long.mp4"
    path.write_bytes(bytes(32 << 20))
    server = FileServer(HOST, 0, troubles.append, patience=0.3)
    request = f"GET {urlsplit(server.list_file(path)).path} HTTP/1.1\r\nHost: x\r\n\r\n".encode()
    held = [socket.create_connection((HOST, server.port), timeout=PATIENCE_S) for _ in range(MOST)]
    try:
        for one in held:
            one.sendall(request)
        assert had(server.list_page("page")) == b""
        until(lambda: had(server.list_page("page")) == b"page")
    finally:
        for one in held:
            one.close()
        server.close()
    assert troubles == []


def test_more_clients_than_places_are_sent_away_and_places_come_back(
    server: FileServer, film: Path
) -> None:
    url = server.list_file(film)
    held = [socket.create_connection((HOST, server.port), timeout=PATIENCE_S) for _ in range(MOST)]
    with pytest.raises((http.client.HTTPException, ConnectionError)):
        ask(url)
    for one in held:
        one.close()

    until(lambda: had(url) == BODY)


def test_closing_hangs_up_and_leaves_no_thread(
    film: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    server = FileServer(HOST, 0, pytest.fail, patience=3600.0)
    with socket.create_connection((HOST, server.port), timeout=PATIENCE_S) as idle:
        ask(server.list_file(film))  # who came before is let in by then
        server.close()
        assert idle.recv(10) == b""
    until(lambda: threads() == set())
    with pytest.raises(OSError) as raised:
        socket.create_connection((HOST, server.port), timeout=1).close()
    assert raised.value.errno == errno.ECONNREFUSED
    assert capfd.readouterr() == ("", "")
