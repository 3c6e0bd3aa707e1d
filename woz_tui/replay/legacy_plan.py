"""Rebuilds from the actions of an old log (schema 1) what its consoles were shown."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import PurePath

from woz_tui.protocol import messages as m
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.protocol.welcome import WelcomeSettings
from woz_tui.timeline.episodes import (
    ActionEpisode,
    CommandEpisode,
    LostDriverEpisode,
    MomentEpisode,
)
from woz_tui.timeline.timeline import Timeline

#: Actions of which the log does not say on which panel they are.
OTHER = "Actions"


@dataclass(slots=True)
class _Shown:
    """An action as it was played: its panel and key, what its commands did and said."""

    panel: str = OTHER
    key: str = ""
    verbs: dict[str, None] = field(default_factory=dict)
    words: dict[str, None] = field(default_factory=dict)


def plan_from(messages: Iterable[object]) -> m.SessionPlan:
    """Every action that was played, panel by panel in the order in which they were first played."""
    timeline = Timeline(passing=True)
    for message in messages:
        if isinstance(message, m.Message):
            timeline.apply(message)
    timeline.finish()
    played: dict[str, _Shown] = {}
    drivers: dict[str, dict[str, None]] = {}
    for episode in timeline.episodes:
        match episode:
            case ActionEpisode(request=request):
                _play(played, request.action, request.panel, request.key)
            case CommandEpisode(request=request):
                if episode.dispatched is not None and episode.dispatched.driver:
                    drivers.setdefault(episode.dispatched.driver, {})[request.verb] = None
                if request.action and not request.action.startswith("on "):
                    shown = _play(played, request.action, request.panel)
                    shown.verbs[request.verb] = None
                    text = request.args.get("text")
                    if isinstance(text, str) and text:
                        shown.words[text] = None
            case LostDriverEpisode(lost=health) | MomentEpisode(message=m.DriverHealth() as health):
                drivers.setdefault(health.driver, {})
    panels: dict[str, list[ActionView]] = {}
    for name, shown in played.items():
        view = ActionView(
            name=name,
            label=name,
            key=shown.key,
            verbs=[*shown.verbs],
            utterances=[*shown.words],
        )
        panels.setdefault(shown.panel, []).append(view)
    start = timeline.state.start
    conditions = dict.fromkeys(span.context.condition for span in timeline.spans)
    return m.SessionPlan(
        title=PurePath(start.experiment).stem if start is not None else "",
        panels=[PanelView(title=title, actions=actions) for title, actions in panels.items()],
        script=[],
        verbs={driver: [*verbs] for driver, verbs in drivers.items()},
        variables=[],
        conditions=[condition for condition in conditions if condition],
        keyboard="us",
        drivers=[*drivers],
        settings=WelcomeSettings(),
    )


def _play(played: dict[str, _Shown], name: str, panel: str, key: str = "") -> _Shown:
    shown = played.setdefault(name, _Shown())
    if panel and shown.panel == OTHER:
        shown.panel = panel
    shown.key = shown.key or key
    return shown
