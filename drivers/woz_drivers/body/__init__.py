"""A body: joints with roles, a face, a personality; moved by an engine, for servos or for nobody.

`driver` takes verbs and speaks asyncio; `ticker` is the thread that keeps the rate; `loop` is what
it does at each tick (engine, feeds); `publishing` tells what came of it; `lateness` counts how
punctual it was. Where servos follow, they are another driver with `follows: <this one>`.
"""

from woz_drivers.body.driver import Body
from woz_drivers.body.settings import BodySettings

__all__ = ["Body", "BodySettings"]
