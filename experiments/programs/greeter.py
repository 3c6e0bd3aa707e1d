"""Greets whoever engages with the robot: a short reactive program.

woz run experiments/guide.yaml        # in one terminal
.venv/bin/python experiments/programs/greeter.py
"""

import asyncio

from woz_tui.client import WozError, connect
from woz_tui.protocol.messages import EngagementChanged


async def main() -> None:
    async with connect(name="greeter") as woz:
        async for change in woz.messages(EngagementChanged):
            if change.was != "PersonDetected" or not change.now.startswith("Engaged"):
                continue  # engaged already: it is so again after each sentence, also after ours
            try:
                await woz.say("Hello! Shall I tell you about the whale?")
            except WozError as error:  # the stop, a lost voice, the wizard was quicker ...
                print(f"not said: {error}")


asyncio.run(main())
