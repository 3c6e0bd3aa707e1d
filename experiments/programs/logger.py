"""Writes what is said and marked into a table while the session runs, until it ends.

.venv/bin/python experiments/programs/logger.py > said.csv
"""

import csv
import sys

from woz_tui.client.blocking import connect
from woz_tui.protocol.messages import Command, Marker

table = csv.writer(sys.stdout)
table.writerow(("seconds", "what", "text", "source"))
with connect(name="logger") as woz:
    for message in woz.messages():
        match message:
            case Command(verb="say", args=args, t=t, source=source):
                table.writerow((f"{t / 1e6:.3f}", "said", args["text"], source))
            case Marker(text=text, t=t, at=at, source=source):
                moment = at if at >= 0 else t
                table.writerow((f"{moment / 1e6:.3f}", "marker", text, source))
        sys.stdout.flush()
