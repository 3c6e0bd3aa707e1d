"""Counts a study's answers once more, from the lines of its logs as JSON: nothing of woz-tui is
used, so that its tables can be compared with it.
"""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from statistics import mean, stdev
from typing import Any

Values = Mapping[str, float]


@dataclass
class Round:
    """A questionnaire put to somebody once; `condition` is empty where it is about none. `counts`:
    it is not about trials that were all left out.
    """

    participant: str
    condition: str
    questionnaire: str
    asked: list[str]
    answers: dict[str, dict[str, Any]] = field(default_factory=dict)
    scores: dict[str, float] = field(default_factory=dict)
    reason: str = ""
    counts: bool = True


def rounds(folder: Path) -> Iterator[Round]:
    """All rounds of all logs."""
    for log in sorted(folder.glob("*.jsonl")):
        if ".samples." not in log.name:
            with log.open(encoding="utf-8") as file:
                yield from _rounds([json.loads(line) for line in file])


def _rounds(lines: Iterable[Mapping[str, Any]]) -> Iterator[Round]:
    who, condition, now = "", "", None
    done: set[str] = set()
    plans: dict[str, Mapping[str, Any]] = {}
    for line in lines:
        kind = line["kind"]
        if kind in ("session.start", "session.changed"):
            who = line.get("participant") or who
        elif kind == "session.plan":
            asked = line["settings"]["study"]["questionnaires"]
            plans = {each["name"]: each for each in asked}
        elif kind == "trial.started":
            condition = line["condition"]
        elif kind == "trial.ended" and line["outcome"] == "done":
            done.add(condition)
        elif kind == "questionnaire.started":
            about = condition if line.get("trial", -1) > 0 else ""
            names = [each["name"] for each in line["items"] if each.get("kind") != "page"]
            now = Round(who, about, line["questionnaire"], names)
            now.counts = not about or about in done
        elif kind == "questionnaire.answered" and now is not None:
            now.answers[line["item"]] = dict(line)
        elif kind == "questionnaire.ended" and now is not None:
            now.reason = line["reason"]
            now.scores = dict(_scores(now, plans[now.questionnaire]))
            yield now
            now = None


def _scores(one: Round, plan: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    items = {each["name"]: each for each in plan["items"]}
    for score in plan.get("scores", ()):
        found = []
        for place, name in enumerate(score["items"]):
            value = one.answers.get(name, {}).get("value")
            if value is not None:
                low, high = items[name].get("low", 1), items[name].get("high", 7)
                turned = place % 2 if score["how"] == "sus" else name in score.get("reverse", ())
                found.append(low + high - value if turned else value)
        if len(score["items"]) - len(found) > score.get("missing", 0) or not found:
            continue
        sus = score["how"] == "sus"
        yield score["name"], sum(each - 1 for each in found) * 2.5 if sus else mean(found)


def by_participant(found: Iterable[Round], questionnaire: str, name: str) -> dict[str, Values]:
    """Condition -> participant -> an item's answer or a score."""
    told: dict[str, dict[str, float]] = {}
    for each in found:
        if each.questionnaire != questionnaire or not each.counts:
            continue
        value = each.scores.get(name, each.answers.get(name, {}).get("value"))
        if value is not None:
            told.setdefault(each.condition, {})[each.participant] = value
    return {**told}


def paired(first: Values, second: Values) -> tuple[int, float, float]:
    """How many have both, the mean of what the second has more, and half of its 95 % interval."""
    differences = [second[who] - first[who] for who in first if who in second]
    count = len(differences)
    half = _t(count - 1) * stdev(differences) / math.sqrt(count)
    return count, mean(differences), half


def _t(degrees: int) -> float:
    """The 97.5 % quantile of Student's t, by halving and Simpson's rule."""
    scale = math.gamma((degrees + 1) / 2) / math.sqrt(degrees * math.pi) / math.gamma(degrees / 2)

    def between(end: float, steps: int = 2000) -> float:
        width = end / steps
        heights = [
            (1 + (n * width) ** 2 / degrees) ** (-(degrees + 1) / 2) for n in range(steps + 1)
        ]
        inner = 4 * sum(heights[1:-1:2]) + 2 * sum(heights[2:-1:2])
        return float(scale * width / 3 * (heights[0] + inner + heights[-1]))

    low, high = 0.0, 200.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if between(middle) < 0.475 else (low, middle)
    return low


def differences(recordings: Path, tables: Path, figures: Path) -> Iterator[str]:
    """What the tables of `woz export --to csv` and the figures of `woz report --figures` have
    otherwise; nothing, if all is as it is here.
    """
    found = [*rounds(recordings)]
    yield from _of_answers(found, tables)
    yield from _of_scores(found, tables)
    yield from _of_figures(found, figures)


def _read(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _differ(what: str, here: object, there: object) -> Iterator[str]:
    if here != there:
        yield f"{what}: {here} here, {there} in the table"


def _of_answers(found: Iterable[Round], tables: Path) -> Iterator[str]:
    here: dict[tuple[str, ...], tuple[str, ...]] = {}
    for one in found:
        for name in one.asked:
            told = one.answers.get(name)
            key: tuple[str, ...] = (one.participant, one.condition, one.questionnaire, name)
            if told is None:
                here[key] = ("", "", "", "not_shown" if one.reason == "done" else one.reason)
            elif told.get("skipped"):
                here[key] = ("", "", "", told.get("reason") or "skipped")
            else:
                ticked = ";".join(map(str, told.get("ticked", ())))
                value = "" if told.get("value") is None else f"{told['value']:g}"
                here[key] = (value, ticked, told.get("text", ""), "")
    there: dict[tuple[str, ...], tuple[str, ...]] = {
        tuple(row[name] for name in ("participant", "condition", "questionnaire", "item")): tuple(
            row[name] for name in ("value", "choices", "text", "missing")
        )
        for row in _read(tables / "questionnaires.csv")
    }
    for key in here.keys() | there.keys():
        guarded = tuple(each.removeprefix("'") for each in there.get(key, ("no row",)))
        yield from _differ(" ".join(key), here.get(key), guarded)


def _of_scores(found: Iterable[Round], tables: Path) -> Iterator[str]:
    here: dict[tuple[str, ...], float] = {
        (one.participant, one.condition, one.questionnaire, name): round(value, 6)
        for one in found
        for name, value in one.scores.items()
    }
    there = {
        tuple(row[name] for name in ("participant", "condition", "questionnaire", "score")): round(
            float(row["value"]), 6
        )
        for row in _read(tables / "questionnaire_scores.csv")
        if row["value"]
    }
    for key in here.keys() | there.keys():
        yield from _differ(" ".join(key), here.get(key), there.get(key))


def _of_figures(found: Iterable[Round], figures: Path) -> Iterator[str]:
    all_rounds = [*found]
    for path in sorted(figures.glob("*.*.csv")):
        questionnaire, name = path.stem.split(".", 1)
        told = by_participant(all_rounds, questionnaire, name)
        rows = {row["condition"]: row for row in _read(path)}
        for condition, values in told.items():
            row = rows[condition]
            yield from _differ(f"{path.stem} {condition} n", str(len(values)), row["n"])
            middle = round(mean(values.values()), 6)
            if row["mean"]:
                yield from _differ(
                    f"{path.stem} {condition} mean", middle, round(float(row["mean"]), 6)
                )
            else:
                values_here = sorted(f"{value:g}" for value in values.values())
                yield from _differ(path.stem, values_here, sorted(row["values"].split()))
        pair = rows.get("warm - sober (paired)")
        if pair is not None and pair["interval_low"]:  # of fewer than three there is none
            count, middle, half = paired(told["sober"], told["warm"])
            yield from _differ(f"{path.stem} pairs", str(count), pair["interval_n"])
            for name_of, value in (
                ("interval_mean", middle),
                ("interval_low", middle - half),
                ("interval_high", middle + half),
            ):
                near = math.isclose(value, float(pair[name_of]), abs_tol=1e-6)
                yield from _differ(f"{path.stem} {name_of}", True, near)
