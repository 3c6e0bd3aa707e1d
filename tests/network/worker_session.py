"""A session with a worker in a process of its own, which lifts until this program is killed.

python -m tests.network.worker_session FOLDER
"""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path

from tests.network.worker import WorkerSettings, driver_process, worker
from woz_tui.drivers.contract import Health
from woz_tui.testing import PlainJob, RecordingContext, until


async def _live(folder: Path) -> None:
    context = RecordingContext(folder)
    arm = worker(driver_process(folder, arm=WorkerSettings()), context)
    await arm.open()
    await until(lambda: context.healths[-1][0] is Health.CONNECTED, 60)
    job = PlainJob("lift")
    lifting = asyncio.create_task(arm.perform(job))
    await until(lambda: bool(job.marks), 60)
    (folder / "lifts").touch()
    await lifting


if __name__ == "__main__":
    asyncio.run(_live(Path(sys.argv[1])))
