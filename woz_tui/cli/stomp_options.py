"""Options of commands that play what comes over a message broker."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

from woz_tui.bridge.stomp_connection import StompPlace

#: The usual port, and the highest one.
_PORT, _HIGHEST = 61613, 0xFFFF


def add_broker(parser: ArgumentParser) -> None:
    """Declare who we are at the broker."""
    parser.add_argument("--login", default="", help="name at the broker")
    parser.add_argument(
        "--passcode-file", type=Path, default=None, help="file with the password at the broker"
    )
    parser.add_argument(
        "--virtual-host", default="", help="the broker's virtual host (RabbitMQ: /)"
    )


def broker_place(address: str, arguments: Namespace) -> StompPlace:
    """The broker at HOST or HOST:PORT. Raises `ValueError`; `OSError` for the password's file."""
    host, _, port = address.partition(":")
    port = port or str(_PORT)
    digits = port.isascii() and port.isdigit() and len(port) <= len(str(_HIGHEST))
    if not host or not digits or not 0 < int(port) <= _HIGHEST:
        raise ValueError(f"{address!r} is no address: write HOST or HOST:PORT")
    passcode = ""
    if arguments.passcode_file is not None:
        passcode = arguments.passcode_file.read_text(encoding="utf-8").strip()
    return StompPlace(host, int(port), arguments.login, passcode, arguments.virtual_host)
