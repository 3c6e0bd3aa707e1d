"""The road a browser's button takes: a Flask route that calls NAOqi.

    python benchmarks/programs/flask_route.py ADDRESS POLLS

Prints its port. POST /volume/VALUE calls `ALTextToSpeech.setVolume(VALUE)` and answers when that
has returned. `POLLS` a second it reads eight states of the robot, as an interface does that shows
them.
"""

from __future__ import annotations

import os
import sys
import threading
import time
from typing import Any

os.environ["QI_LOG_LEVEL"] = "0"

import logging

import flask
import qi
from werkzeug.serving import WSGIRequestHandler, make_server

STATES = (
    ("ALTextToSpeech", "getVolume", ()),
    ("ALAutonomousLife", "getState", ()),
    ("ALBasicAwareness", "isEnabled", ()),
    ("ALAutonomousBlinking", "isEnabled", ()),
    ("ALListeningMovement", "isEnabled", ()),
    ("ALSpeakingMovement", "isEnabled", ()),
    ("ALMotion", "getBreathEnabled", ("Head",)),
    ("ALMotion", "robotIsWakeUp", ()),
)


def poll(session: Any, polls: float) -> None:
    """Read all states, `polls` times a second, for ever."""
    services = {name: session.service(name) for name, _, _ in STATES}
    while True:
        for name, method, args in STATES:
            getattr(services[name], method)(*args)
        time.sleep(1 / polls)


def main() -> None:
    """Serve until killed."""
    address, polls = sys.argv[1], float(sys.argv[2])
    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    session = qi.Session()
    session.connect(address)
    speech = session.service("ALTextToSpeech")
    if polls:
        threading.Thread(target=poll, args=(session, polls), daemon=True).start()
    app = flask.Flask("robot")

    @app.post("/volume/<float:value>")
    def volume(value: float) -> str:
        speech.setVolume(value)
        return "ok"

    WSGIRequestHandler.protocol_version = "HTTP/1.1"  # connections stay open, as browsers like them
    server = make_server("127.0.0.1", 0, app, threaded=True)
    print(server.port, flush=True)
    server.serve_forever()


if __name__ == "__main__":
    main()
