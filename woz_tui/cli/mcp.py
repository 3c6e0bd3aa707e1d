"""`woz mcp`: a session's verbs as tools of the Model Context Protocol, for assistants.

The assistant starts this command and speaks with it over standard input and output.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import sys
from argparse import ArgumentParser, Namespace
from typing import Any

from woz_tui import __version__
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.session_choice import add_session_choice, joined_session
from woz_tui.client import WozError, connect
from woz_tui.client.tools import ToolCaller
from woz_tui.system.extras import install_command

ERRORS = CommandErrors(WozError)
MISSING = f"`woz mcp` needs the package `mcp`: {install_command('mcp')}"
INSTRUCTIONS = (
    "You play a social robot in an experiment with people. A human wizard watches, can stop"
    " everything at any time and sees what you do. A tool returns when the robot has done it."
)


def add(parser: ArgumentParser) -> None:
    add_session_choice(parser, "session")


def run(arguments: Namespace) -> int:
    """Serve until standard input ends."""
    try:
        import mcp  # noqa: F401, PLC0415 - an extra
    except ImportError:
        print(f"woz: {MISSING}", file=sys.stderr)
        return 1
    if arguments.access is None:
        return asyncio.run(_serve(arguments.session))
    with joined_session(arguments.access, arguments.session, "woz mcp") as session:
        return 1 if session is None else asyncio.run(_serve(str(session.path)))


class SessionTools:
    """A session's tools; one that was lost is joined again when the next tool is called.

    Args:
        session: As `client.connect` has it.
    """

    def __init__(self, session: str) -> None:
        self._session = session
        self._stack = contextlib.AsyncExitStack()
        self._caller: ToolCaller | None = None
        self._following: asyncio.Task[None] | None = None
        self._one = asyncio.Lock()

    async def caller(self) -> ToolCaller:
        """Who carries a call out. Raises `WozError` if the session cannot be joined."""
        async with self._one:
            if self._caller is None or self._following is None or self._following.done():
                await self.close()
                joining = connect(self._session, name="mcp", samples=True, sees="wizard")
                self._caller = ToolCaller(await self._stack.enter_async_context(joining))
                self._following = asyncio.create_task(self._caller.follow(), name="the session")
            return self._caller

    async def listed(self, _context: object, _asked: object) -> Any:
        """The tools, as the protocol has them."""
        import mcp_types  # noqa: PLC0415

        caller = await self.caller()
        return mcp_types.ListToolsResult(
            tools=[
                mcp_types.Tool(
                    name=tool.name,
                    description=tool.summary,
                    input_schema={**tool.schema},
                    annotations=mcp_types.ToolAnnotations(read_only_hint=tool.only_looks),
                )
                for tool in caller.tools()
            ]
        )

    async def called(self, _context: object, asked: Any) -> Any:
        """What comes of a call. One that is cancelled cuts short what it began."""
        from mcp_types import CallToolResult, TextContent  # noqa: PLC0415

        failed = False
        try:
            caller = await self.caller()
            came = json.dumps(await caller.call(asked.name, asked.arguments or {}))
        except WozError as error:
            came, failed = str(error), True
        return CallToolResult(content=[TextContent(type="text", text=came)], is_error=failed)

    async def close(self) -> None:
        """Leave the session."""
        following, self._caller, self._following = self._following, None, None
        if following is not None:
            following.cancel()
            await asyncio.gather(following, return_exceptions=True)
        await self._stack.aclose()


async def _serve(session: str) -> int:
    from mcp.server.lowlevel import Server  # noqa: PLC0415
    from mcp.server.stdio import stdio_server  # noqa: PLC0415

    tools = SessionTools(session)
    try:
        await tools.caller()
        server: Any = Server(
            "woz-tui",
            version=__version__,
            instructions=INSTRUCTIONS,
            on_list_tools=tools.listed,
            on_call_tool=tools.called,
        )
        async with stdio_server() as (reader, writer):
            options = server.create_initialization_options()
            await server.run(reader, writer, options)
    finally:
        await tools.close()
    return 0
