"""A study with what goes wrong in one: all tables agree, and with a computation of its own.

Sessions are real ones in virtual time: some are killed, a code comes late or is corrected, folders
are merged, a log is renamed, somebody withdraws.
`python -m tests.analysis.test_study_tables 24` plays another size.
"""

from __future__ import annotations

import asyncio
import csv
import json
import random
import shutil
import statistics
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from typing import Any

from tests.features.questionnaires.rig import due as due_in
from tests.features.questionnaires.rig import questionnaires, study_experiment
from tests.session.rig import SessionRig
from tests.session.study_rig import trial_control
from woz_tui.cli import main
from woz_tui.features.questionnaires.kinds import AskAnswer
from woz_tui.gate.questions import RequestOrigin
from woz_tui.host.experiment_view import ExperimentView, plan_for_log
from woz_tui.log.file_names import name_after
from woz_tui.session.participant_identity import SessionIdentity

KEY = RequestOrigin("key", "h", "con1")
#: Main figure of the report -> what the computation of its own calls it.
FIGURES = {"trials": "trials", "wizard_actions": "actions", "mistakes": "mistakes"}
SCALES = ("each.hard", "ux.pleasant")
#: Whoever withdraws when all is done; there are copies of the log.
WITHDRAWN = "P04"


def play_study(folder: Path, participants: int, seed: int) -> None:
    """The logs of a study in `folder`, with what people leave there."""
    chance = random.Random(seed)
    recordings = folder / "recordings"
    recordings.mkdir()
    logs = []
    for number in range(1, participants + 1):
        place = folder / f"made{number}"
        place.mkdir()
        log = play_session(place, f"P{number:02}", f"S{number:02}", chance)
        if number % 6 == 0:  # killed: the last line is torn
            data = log.read_bytes()
            log.write_bytes(data[: chance.randrange(len(data) // 2, len(data) - 10)])
        for file in log.parent.glob("*.jsonl"):
            shutil.move(file, recordings / file.name)
        logs.append(recordings / log.name)
        if number % 5 == 0:
            name_after(logs[-1], f"P{number:02}")
            logs[-1] = next(recordings.glob(f"*_S{number:02}.jsonl"))
    (recordings / "second computer").mkdir()
    for log in logs[::4]:
        shutil.copy(log, log.with_name(f"{log.stem} (1).jsonl"))
    for log in logs[::3]:
        shutil.copy(log, recordings / "second computer")
    withdrawing = ["--code", WITHDRAWN, "--withdraw", "--yes"]
    with redirect_stdout(StringIO()):
        assert main(["participants", str(recordings), *withdrawing]) == 0
    assert not any(WITHDRAWN in path.name for path in recordings.rglob("*"))


def play_session(folder: Path, code: str, session: str, chance: random.Random) -> Path:
    """One participant's session, from the code that is chosen in it to its end; its log."""

    async def scenario(rig: SessionRig) -> None:
        rig.session.hub.publish(plan_for_log(ExperimentView.of(rig.session)))  # as a host does
        study = trial_control(rig.session)
        await asyncio.sleep(chance.uniform(1, 30))  # before there is a code
        if chance.random() < 0.3:  # a slip of the pen
            study.assign("P99", [*study.propose("P99").order])
            await asyncio.sleep(3)
        study.assign(code, [*study.propose(code).order])
        done = 0
        while done < study.state.planned:
            await play_trial(rig, outcome := chance.choices(OUTCOMES, (8, 1, 1))[0], chance)
            done += outcome != "aborted"
            await asyncio.sleep(chance.uniform(0, 5))

    rig = SessionRig(
        folder,
        identity=SessionIdentity(session=session, wizard="W1"),
        made=study_experiment(folder),
        stem=f"2026-03-01T10-00-00_{session}",
    )
    return rig.run(scenario, 1).recorder.path


OUTCOMES = ("done", "aborted", "excluded")


async def play_trial(rig: SessionRig, outcome: str, chance: random.Random) -> None:
    """A trial with actions and mistakes, and the questionnaires that are due behind it."""
    study = trial_control(rig.session)
    study.trial("begin", "")
    for _ in range(chance.randrange(1, 6)):
        rig.session.play(chance.choice(("Hello", "Welcome", "Fall")), KEY)
        await asyncio.sleep(chance.uniform(2, 8))
        if chance.random() < 0.2:
            rig.session.mistake("", "")
    study.trial(outcome, "")
    rig.session.play("Hello", KEY)  # belongs to no trial
    await asyncio.sleep(2)
    for due in due_in(rig):
        if due.questionnaire not in ("each", "ux"):
            continue
        questionnaires(rig).begin_or_end(due.questionnaire, "begin", "wizard")
        item = "hard" if due.questionnaire == "each" else "pleasant"
        value = float(chance.randint(1, 5))
        questionnaires(rig).answer(
            AskAnswer(questionnaire=due.questionnaire, item=item, value=value)
        )
        await asyncio.sleep(1)
        if item == "pleasant":
            questionnaires(rig).answer(AskAnswer(questionnaire="ux", item="else", skipped=True))
        questionnaires(rig).begin_or_end(due.questionnaire, "done", "wizard")


# -- a computation of its own, from the lines of the logs ------------------------------------------


@dataclass
class Trial:
    participant: str
    condition: str
    number: int
    outcome: str = ""
    actions: int = 0
    mistakes: int = 0


@dataclass
class Tables:
    """Figures by participant and condition, answers by condition, and who was there."""

    figures: dict[tuple[str, str], dict[str, int]] = field(default_factory=dict)
    answers: dict[tuple[str, str], dict[str, list[float]]] = field(default_factory=dict)
    people: set[str] = field(default_factory=set)
    sessions: int = 0

    def means(self, scale: str) -> dict[str, tuple[int, float]]:
        """By condition: how many people, and the mean of their means."""
        found: dict[str, list[float]] = defaultdict(list)
        for (_, condition), items in self.answers.items():
            if scale in items:
                found[condition].append(statistics.fmean(items[scale]))
        return {each: (len(values), statistics.fmean(values)) for each, values in found.items()}


def computed(recordings: Path) -> Tables:
    """The tables out of the files, without anything of woz-tui."""
    longest: dict[str, list[dict[str, Any]]] = {}
    for path in recordings.rglob("*.jsonl"):
        if ".samples" in path.name:
            continue
        lines = [*parsed(path)]
        code = lines[0]["session"]
        if len(lines) > len(longest.get(code, ())):
            longest[code] = lines
    tables = Tables(sessions=len(longest))
    for lines in longest.values():
        add_session(tables, lines)
    return tables


def parsed(path: Path) -> Iterator[dict[str, Any]]:
    for line in path.read_bytes().split(b"\n"):
        try:
            yield json.loads(line)
        except ValueError:
            continue


def add_session(tables: Tables, lines: list[dict[str, Any]]) -> None:
    """Whose trials, actions, mistakes and answers there are in one session."""
    trials: list[Trial] = []
    runs: dict[str, Trial] = {}
    given: list[tuple[str, Trial | None, str, float]] = []
    participant, current, about = "", None, None
    for line in lines:
        match line["kind"]:
            case "session.changed" | "condition.assigned":
                participant = line.get("participant") or participant
            case "trial.started":
                current = Trial(participant, line["condition"], line["trial"])
                trials.append(current)
            case "trial.ended" if current is not None:
                current.outcome = line["outcome"]
                current = None
            case "action.requested" if line.get("source") == "key" and current is not None:
                current.actions += 1
                runs[line["run"]] = current
            case "mistake" if line["run"] in runs:
                runs[line["run"]].mistakes += 1
            case "questionnaire.started":
                behind = [each for each in trials if each.number == line.get("trial", -1)]
                about = behind[-1] if behind else None
            case "questionnaire.answered" if "value" in line:
                scale = f"{line['questionnaire']}.{line['item']}"
                given.append((participant, about, scale, line["value"]))
    tables.people |= {trial.participant for trial in trials}
    counted = [trial for trial in trials if trial.outcome == "done"]
    for trial in counted:
        figures = tables.figures.setdefault(
            (trial.participant, trial.condition), dict.fromkeys(FIGURES.values(), 0)
        )
        figures["trials"] += 1
        figures["actions"] += trial.actions
        figures["mistakes"] += trial.mistakes
    for who, behind_trial, scale, value in given:
        assert behind_trial is not None
        condition = behind_trial.condition
        same = [each for each in trials if each.condition == condition]
        if scale.startswith("ux.") and not any(each in counted for each in same):
            continue
        if scale.startswith("each.") and behind_trial not in counted:
            continue
        items = tables.answers.setdefault((who, condition), {})
        items.setdefault(scale, []).append(value)


# -- what the commands say -------------------------------------------------------------------------


def woz(*words: str | Path) -> str:
    """What a command prints. It ends with 1: copies are told."""
    out = StringIO()
    with redirect_stdout(out), redirect_stderr(StringIO()):
        assert main([*map(str, words)]) == 1
    return out.getvalue()


def rows(path: Path, delimiter: str = ",") -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file, delimiter=delimiter))


def compare(folder: Path) -> int:
    """Compare all tables of the study in `folder`; how many cells were compared."""
    recordings = folder / "recordings"
    own = computed(recordings)
    cells = 0
    report = json.loads(woz("report", recordings, "--json", "--csv", folder / "report"))
    assert len(report["sessions"]) == own.sessions
    (experiment,) = report["experiments"]
    for scale in SCALES:
        told = {
            each["condition"]: (each["total"]["n"], each["total"]["mean"])
            for each in experiment["scales"]
            if f"{each['questionnaire']}.{each['item']}" == scale
        }
        assert {name: n for name, (n, _) in told.items()} == {
            name: n for name, (n, _) in own.means(scale).items()
        }
        for condition, (_, mean) in own.means(scale).items():
            assert abs(told[condition][1] - mean) < 1e-9, (scale, condition)
            cells += 2
    woz("export", recordings, "--to", "csv", "--out", folder / "csv")
    for name in ("report", "csv"):
        found: dict[tuple[str, str], dict[str, int]] = {}
        for row in rows(folder / name / "conditions.csv"):
            if row["condition"] and row["counted"] == "true" and int(row["trials"] or 0):
                found[row["participant"], row["condition"]] = {
                    ours: int(row[theirs]) for theirs, ours in FIGURES.items()
                }
        assert found == own.figures, name
        cells += sum(map(len, found.values()))
        answers: dict[tuple[str, str], dict[str, list[float]]] = {}
        for row in rows(folder / name / "questionnaires.csv"):
            if row["counted"] == "true" and row["value"]:
                items = answers.setdefault((row["participant"], row["condition"]), {})
                scale = f"{row['questionnaire']}.{row['item']}"
                items.setdefault(scale, []).append(float(row["value"]))
        assert answers == own.answers, name
        cells += sum(map(len, answers.values()))
    woz("export", recordings, "--to", "bids", "--out", folder / "bids")
    subjects = {row["participant_id"] for row in rows(folder / "bids" / "participants.tsv", "\t")}
    assert subjects == {f"sub-{code}" for code in own.people}
    assert "sub-unknown01" not in subjects
    methods = woz("methods", recordings)
    assert f"{len(own.people)} participants" in methods
    return cells + len(subjects) + 1


def test_all_tables_of_a_study_agree_with_a_computation_of_its_own(tmp_path: Path) -> None:
    play_study(tmp_path, 6, 1)
    assert WITHDRAWN not in computed(tmp_path / "recordings").people
    assert compare(tmp_path) > 50


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        play_study(Path(place), int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1)
        sys.stdout.write(f"{compare(Path(place))} cells agree\n")
