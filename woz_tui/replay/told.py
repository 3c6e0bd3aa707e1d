"""What consoles were shown, as far as a log tells that does not say so itself (schema 1)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import PurePath

from woz_tui.core import messages as m
from woz_tui.core.settings import Settings
from woz_tui.core.views import ActionView, PanelView

#: Actions of which the log does not say on which panel they are.
OTHER = "Actions"


@dataclass(slots=True)
class _Action:
    panel: str
    key: str = ""
    verbs: dict[str, None] = field(default_factory=dict)
    words: dict[str, None] = field(default_factory=dict)


@dataclass(slots=True)
class _Found:
    title: str = ""
    actions: dict[str, _Action] = field(default_factory=dict)
    drivers: dict[str, dict[str, None]] = field(default_factory=dict)
    conditions: dict[str, None] = field(default_factory=dict)
    verbs: dict[str, str] = field(default_factory=dict)

    def take(self, message: object) -> None:
        match message:
            case m.SessionStart(experiment=name, condition=condition):
                self.title = PurePath(name).stem
                self._condition(condition)
            case m.SessionChanged(condition=condition):
                self._condition(condition or "")
            case m.ActionRequested(action=name, panel=panel, key=key):
                action = self._action(name, panel)
                action.key = action.key or key
            case m.Command():
                self._command(message)
            case m.Dispatched(driver=driver, command=command) if driver:
                verb = self.verbs.get(command)
                self.drivers.setdefault(driver, {}).update({verb: None} if verb else {})
            case m.DriverHealth(driver=driver):
                self.drivers.setdefault(driver, {})

    def _condition(self, condition: str) -> None:
        if condition:
            self.conditions[condition] = None

    def _action(self, name: str, panel: str) -> _Action:
        found = self.actions.setdefault(name, _Action(panel or OTHER))
        if panel and found.panel == OTHER:
            found.panel = panel
        return found

    def _command(self, command: m.Command) -> None:
        self.verbs[command.command] = command.verb
        if command.action and not command.action.startswith("on "):
            action = self._action(command.action, command.panel)
            action.verbs[command.verb] = None
            text = command.args.get("text")
            if isinstance(text, str) and text:
                action.words[text] = None


def plan_from(messages: Iterable[object]) -> m.SessionPlan:
    """Every action that was played, panel by panel in the order in which they were first played."""
    found = _Found()
    for message in messages:
        found.take(message)
    panels: dict[str, list[ActionView]] = {}
    for name, action in found.actions.items():
        view = ActionView(
            name=name,
            label=name,
            key=action.key,
            verbs=[*action.verbs],
            utterances=[*action.words],
        )
        panels.setdefault(action.panel, []).append(view)
    return m.SessionPlan(
        title=found.title,
        panels=[PanelView(title=title, actions=actions) for title, actions in panels.items()],
        script=[],
        verbs={driver: [*verbs] for driver, verbs in found.drivers.items()},
        variables=[],
        conditions=[*found.conditions],
        keyboard="us",
        drivers=[*found.drivers],
        settings=Settings(),
    )
