"""What the experiment around the robot leaves in a log: one of each, for both golden files."""

from __future__ import annotations

from tests.protocol.feature_examples import feature_examples
from woz_tui.protocol import messages as m
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.protocol.welcome import WelcomeSettings

SHA = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"
FILE_SHA = "6eb54c6d4926a7f0cd56a7d6b1b4d60e1b8e8d2c4a4cbb2c9a8b8cb0a2f4f7f1"

#: What a log says of itself, right after its first line.
BEGINNING: tuple[m.Message, ...] = (
    m.ExperimentFiles(
        experiment_sha256=SHA,
        files={"museum.yaml": "title: Museum guide\nrobot: simulated\n"},
        left_out=["moves/dance.json"],
        files_sha256={"museum.yaml": FILE_SHA, "moves/dance.json": SHA},
    ),
    m.SessionPlan(
        title="Museum guide",
        panels=[PanelView(title="Speech", actions=[ActionView(name="Hello", label="Hello")])],
        script=["Hello"],
        verbs={"voice": ["say"]},
        variables=["participant"],
        conditions=["warm", "cold"],
        keyboard="us",
        drivers=["voice"],
        simulated=["voice"],
        settings=WelcomeSettings(dead_man=3.0),
    ),
    m.PreflightChecked(check="head", level="ok", detail="3 servos", source="robot"),
    m.PreflightChecked(check="the camera sees the whole table", level="ok", source="wizard"),
    m.ConditionsAssigned(
        participant="P07",
        order=["warm", "cold"],
        method="latin-square",
        row=0,
        why="row 0 was given 3 times, row 1 4 times",
        trials=2,
        over=[1],
    ),
    *feature_examples("delay", "SETTINGS"),
    m.PerceptionChanged(hidden=["distance"], blurred=["transcript"]),
)

#: The course of a trial, a training, a re-run.
COURSE: tuple[m.Message, ...] = (
    m.TrialStarted(trial=1, condition="warm", planned=4),
    *feature_examples("delay", "HELD"),
    *feature_examples("training", "CUES"),
    m.TrialEnded(trial=1, outcome="done", text="the phone rang once"),
    m.BreakStarted(text="a glass of water"),
    m.BreakEnded(text="five minutes"),
    *feature_examples("questionnaires", "MESSAGES"),
    *feature_examples("training", "COURSE"),
    m.RerunStarted(
        original="2026-02-27T10-00-00_P03_S03.jsonl",
        original_session="S03",
        original_sha256=SHA,
        commands=2,
    ),
    m.RerunSent(command="c00012", original_command="c00004", due=20_000_000, late_us=310),
    m.RerunSkipped(original_command="c00005", reason="it was refused: the stop was pressed"),
    m.RerunEnded(reason="done", sent_again=1, skipped_commands=1, late_p50_us=310, late_max_us=310),
)
