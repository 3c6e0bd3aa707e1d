"""The study as consoles are told of it: `settings["study"]` of the welcome (docs/protocol.md)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from woz_tui.core.messages import Json
from woz_tui.experiment.shape import Experiment
from woz_tui.experiment.study import Design, Item, Questionnaire, Shaping
from woz_tui.timeline.study import StudyState


def study_settings(experiment: Experiment) -> dict[str, Json]:
    """What the file says; what became of it is in the stream's messages."""
    study = experiment.study
    return {
        "design": _design(study.design) if study.design is not None else None,
        "blind": dict(study.design.blind) if study.design is not None else {},
        "questionnaires": [_questionnaire(each) for each in study.questionnaires],
        "preflight": [*study.preflight],
        "perception": {"hide": [*study.perception.hide], "blur": [*study.perception.blur]},
        "shaping": _shaping(study.shaping) if study.shaping is not None else None,
        "by_condition": {name: dict(texts) for name, texts in experiment.by_condition.items()},
    }


def study_snapshot(settings: Mapping[str, Any], study: StudyState) -> dict[str, Json]:
    """The file's part, and what holds now: the list with its ticks, the order, what is due.

    Args:
        settings: What the file says, or `settings["study"]` of a log's `session.plan`, which may
            come from another version; its preflight list may have ticks.
        study: What holds now.
    """
    listed = settings.get("preflight")
    checks = [
        str(each.get("check", "")) if isinstance(each, Mapping) else str(each)
        for each in (listed if isinstance(listed, list) else ())
    ]
    return {
        **settings,
        "preflight": [{"check": check, "ok": study.ticked(check)} for check in checks],
        "assigned": [*study.order],
        "planned": study.planned,
        "trial": study.next_trial,
        "running": study.trial is not None,
        "on_break": study.in_break is not None,
        "due": [due.questionnaire for due in study.due],
    }


def _design(design: Design) -> dict[str, Json]:
    return {"order": design.order, "within": design.within, "trials": design.trials}


def _questionnaire(questionnaire: Questionnaire) -> dict[str, Json]:
    return {
        "name": questionnaire.name,
        "title": questionnaire.title,
        "introduction": questionnaire.introduction,
        "when": questionnaire.when,
        "items": [*map(item_view, questionnaire.items)],
    }


def item_view(item: Item) -> dict[str, Any]:
    """An item as in `questionnaire.started`: a scale's points and ends, or `text`."""
    seen: dict[str, Any] = {"name": item.name, "question": item.question}
    if item.text:
        seen["text"] = True
    else:
        seen |= {"low": item.low, "high": item.high, "ends": [*item.ends]}
    return {**seen, "optional": True} if item.optional else seen


def _shaping(shaping: Shaping) -> dict[str, Json]:
    return {"floor": shaping.floor, "jitter": shaping.jitter, "cues": [*shaping.cues]}
