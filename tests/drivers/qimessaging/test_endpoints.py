"""Where a service is looked for."""

from __future__ import annotations

from qimessaging.endpoints import ServiceInfo, reachable, shares_socket

DIRECTORY = ServiceInfo(
    "ServiceDirectory", 1, "pepper", 1, ("tcp://127.0.0.1:9559", "tcp://10.0.0.5:9559"), "0"
)


def _service(*endpoints: str, machine: str = "pepper") -> ServiceInfo:
    return ServiceInfo("ALTabletService", 40, machine, 2, endpoints, "x")


def _tried(service: ServiceInfo, peer: str, *, tls: bool = False) -> list[str]:
    return [str(each) for each in reachable(service, peer, tls)]


def test_the_directorys_socket_serves_what_says_so() -> None:
    assert shares_socket(_service("qi:ServiceDirectory", "tcp://10.9.9.9:1"), DIRECTORY)
    assert shares_socket(_service("tcp://10.0.0.5:9559"), DIRECTORY)
    assert not shares_socket(_service("tcp://10.0.0.5:9600"), DIRECTORY)
    assert not shares_socket(_service("tcp://127.0.0.1:9559", machine="laptop"), DIRECTORY)
    assert not shares_socket(_service("qi:Other"), DIRECTORY)


def test_the_robots_own_address_comes_first() -> None:
    service = _service("tcp://127.0.0.1:40", "tcp://198.18.0.1:40", "tcp://10.0.0.5:40")

    assert _tried(service, "10.0.0.5") == ["tcp://10.0.0.5:40", "tcp://198.18.0.1:40"]


def test_loopback_is_tried_only_on_the_machine_itself() -> None:
    service = _service("tcp://10.0.0.5:40", "tcp://127.0.0.1:40")

    assert _tried(service, "127.0.0.1") == ["tcp://127.0.0.1:40", "tcp://10.0.0.5:40"]
    # From elsewhere the port may still be open at the address that is known.
    assert _tried(_service("tcp://127.0.0.1:40"), "10.0.0.5") == ["tcp://10.0.0.5:40"]


def test_tls_is_left_out_where_it_cannot_be_spoken() -> None:
    service = _service("tcps://10.0.0.5:41", "tcp://10.0.0.5:40", "qi:ALMemory", "junk", "tcp://:x")

    assert _tried(service, "10.0.0.5") == ["tcp://10.0.0.5:40"]
    assert set(_tried(service, "10.0.0.5", tls=True)) == {
        "tcps://10.0.0.5:41",
        "tcp://10.0.0.5:40",
    }


def test_version_6_addresses_are_written_in_brackets() -> None:
    assert _tried(_service("tcp://[fd00::5]:40"), "fd00::5") == ["tcp://[fd00::5]:40"]


def test_old_directories_tell_no_identity() -> None:
    old = ServiceInfo.of(("Thing", 2, "pepper", 7, ["tcp://10.0.0.5:9559"], "x"))

    assert (old.identity, old.endpoints) == ("", ("tcp://10.0.0.5:9559",))
