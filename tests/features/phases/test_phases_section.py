"""Phases in an experiment file."""

from __future__ import annotations

from pathlib import Path

from tests.config.reading import panel, read_experiment
from woz_tui.features.phases.section import PHASES
from woz_tui.features.training.session_kind import TRAINING

KEYS = """phases:
  - {title: Opening, panels: [P], script: A, after: closing}
  - {name: talk, panels: [Q], script: [A, B], planned: 2 min, lock_others: true}
  - {name: closing, after: [lost, found], on_enter: [A, B]}
  - {name: lost, after: found}
  - {name: found, after: lost}
"""


def test_phases_of_a_file(tmp_path: Path) -> None:
    text = panel("{label: A, say: Hi, then: B}")
    text += "  - {title: Q, actions: [{label: B, say: Ho, then: [A, B]}]}\n"
    experiment = read_experiment(tmp_path, text + KEYS.replace("script: A", "script: [A]"))
    opening, talk, closing, *_ = PHASES.of(experiment)
    assert (opening.name, opening.heading, opening.script) == ("Opening", "Opening", ("A",))
    assert (talk.planned, talk.lock_others, talk.after) == (120.0, True, ())
    assert closing.on_enter == ("A", "B")
    assert [action.then for each in experiment.panels for action in each.actions] == [
        ("B",),
        ("A", "B"),
    ]
    said = [f"{problem.path}: {problem.message}" for problem in experiment.warnings]
    assert said == [
        "phases[0].after: the first phase begins by itself; after has no effect here",
        "phases[1].script[0]: the panel 'P' is not in front in this phase; add it to panels: [...]",
        "phases[2].after: 'closing' can never begin: none of these phases can",
        "phases[3].after: 'lost' can never begin: none of these phases can",
        "phases[4].after: 'found' can never begin: none of these phases can",
    ]


def test_cues_of_a_training_want_answers_of_all_phases(tmp_path: Path) -> None:
    whole = read_experiment(tmp_path, panel("{label: A, say: Hi}") + "phases: [{name: talk}]\n")
    assert PHASES.of(whole)
    assert PHASES.of(TRAINING.experiment(whole)) == ()
