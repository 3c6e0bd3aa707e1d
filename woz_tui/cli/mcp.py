"""`woz mcp`: a session's verbs as tools of the Model Context Protocol, for assistants.

The assistant starts this command and speaks with it over standard input and output.
"""

from __future__ import annotations

import asyncio
import json
import sys
from argparse import ArgumentParser, Namespace
from typing import Any

from woz_tui import __version__
from woz_tui.cli.error_sentences import with_error_sentences
from woz_tui.client import WozError, connect
from woz_tui.client.tools import Tool, ToolCaller
from woz_tui.system.tasks import end_tasks

MISSING = "`woz mcp` needs the package `mcp`: pip install 'woz-tui[mcp]'"
INSTRUCTIONS = (
    "You play a social robot in an experiment with people. A human wizard watches, can stop"
    " everything at any time and sees what you do. A tool returns when the robot has done it."
)


def add(parser: ArgumentParser) -> None:
    """Declare the command's options."""
    parser.add_argument(
        "session", nargs="?", default="", help="session code (default: the only one)"
    )


def run(arguments: Namespace) -> int:
    """Serve until standard input ends."""
    try:
        import mcp  # noqa: F401, PLC0415 - an extra
    except ImportError:
        print(f"woz: {MISSING}", file=sys.stderr)
        return 1
    return with_error_sentences(lambda: asyncio.run(_serve(arguments.session)), WozError)


async def _serve(session: str) -> int:
    from mcp.server.lowlevel import Server  # noqa: PLC0415
    from mcp.server.stdio import stdio_server  # noqa: PLC0415

    async with connect(session, name="mcp", samples=True, sees="wizard") as client:
        caller = ToolCaller(client)
        following = asyncio.create_task(caller.follow())
        server: Any = Server(
            "woz-tui",
            version=__version__,
            instructions=INSTRUCTIONS,
            on_list_tools=lambda context, asked: _listed(caller),
            on_call_tool=lambda context, asked: _called(caller, asked),
        )
        try:
            async with stdio_server() as (reader, writer):
                options = server.create_initialization_options()
                await server.run(reader, writer, options)
        finally:
            await end_tasks(following)
    return 0


async def _listed(caller: ToolCaller) -> Any:
    from mcp_types import ListToolsResult  # noqa: PLC0415

    return ListToolsResult(tools=[_tool(tool) for tool in caller.tools()])


def _tool(tool: Tool) -> Any:
    import mcp_types  # noqa: PLC0415

    return mcp_types.Tool(
        name=tool.name,
        description=tool.summary,
        input_schema={**tool.schema},
        annotations=mcp_types.ToolAnnotations(read_only_hint=tool.only_looks),
    )


async def _called(caller: ToolCaller, asked: Any) -> Any:
    """A call that is cancelled cuts short what it began."""
    from mcp_types import CallToolResult, TextContent  # noqa: PLC0415

    failed = False
    try:
        came = json.dumps(await caller.call(asked.name, asked.arguments or {}))
    except WozError as error:
        came, failed = str(error), True
    return CallToolResult(content=[TextContent(type="text", text=came)], is_error=failed)
