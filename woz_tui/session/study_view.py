"""The study as consoles are told of it: `settings["study"]` of the welcome (docs/protocol.md)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from woz_tui.core.messages import Json
from woz_tui.experiment.shape import Experiment
from woz_tui.experiment.study import Design, Item, Questionnaire, Shaping

if TYPE_CHECKING:
    from woz_tui.session.progress import Progress


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


def standing(progress: Progress) -> dict[str, Json]:
    """The file's part, and how things stand: the list with its ticks, the order, what is due."""
    checks: Any = progress.told["preflight"]
    running = progress.running
    return {
        **progress.told,
        "preflight": [{"check": check, "ok": progress.ticked(check)} for check in checks],
        "assigned": [*progress.order],
        "planned": progress.planned,
        "trial": progress.trial,
        "running": running is not None,
        "on_break": progress.on_break,
        "due": [due.questionnaire for due in progress.due],
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
