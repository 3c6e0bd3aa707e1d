"""`woz bridge`: play what a planner sends on the topics of a robot's own ROS software."""

from __future__ import annotations

import asyncio
from argparse import ArgumentParser, Namespace
from functools import partial

from woz_tui.bridge.stomp_bridge import StompBridge
from woz_tui.bridge.stomp_connection import StompError
from woz_tui.bridge.topic_table import load_table
from woz_tui.cli.argument_types import file_or_word
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.stomp_options import add_broker, broker_place
from woz_tui.client import WozError, connect

ERRORS = CommandErrors(StompError, ValueError, WozError)


def add(parser: ArgumentParser) -> None:
    parser.add_argument(
        "--stomp", required=True, metavar="HOST[:PORT]", help="the message broker (STOMP 1.2)"
    )
    parser.add_argument("--session", default="", help="session code (default: the only one)")
    parser.add_argument(
        "--topics",
        type=file_or_word,
        default="eyepi",
        metavar="FILE",
        help="table of topics, and what their messages stand for (default: EyePi's)",
    )
    add_broker(parser)


def run(arguments: Namespace) -> int:
    """Serve until ctrl+c."""
    return asyncio.run(_bridge(arguments))


async def _bridge(arguments: Namespace) -> int:
    table = load_table(arguments.topics)
    place = broker_place(arguments.stomp, arguments)
    async with connect(arguments.session, name="bridge", samples=True) as client:
        await StompBridge(client, place, table, partial(print, flush=True)).run()
    print("woz: the session has ended")
    return 0
