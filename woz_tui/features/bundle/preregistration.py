"""A preregistration out of the experiment file, in the order of OSF's form, with headed gaps for
what no file says; and what was played otherwise than it says.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping, Sequence

from woz_tui.analysis.text_format import counted, listed
from woz_tui.config.about_file import About
from woz_tui.features.bundle.codebook import Variable, items_of
from woz_tui.features.bundle.registered_study import RegisteredStudy
from woz_tui.features.bundle.session_copies import PlayedFile

GAP = "*(to be written by hand)*"
_ORDERS = {
    "latin-square": "a Latin square (Williams), rows in turn by participant",
    "blocks": "shuffled blocks, computed from the seed of the file",
    "fixed": "one fixed order for all",
}


def preregistration(registered: PlayedFile, study: RegisteredStudy, about: About) -> str:
    """The text in Markdown; `study` is what the `registered` file plans."""
    return "\n".join(_lines(registered, study, about)) + "\n"


def _lines(registered: PlayedFile, study: RegisteredStudy, about: About) -> Iterator[str]:
    title = about.title or study.title or registered.name
    items = items_of(study.settings.questionnaires)
    yield f"# Preregistration: {title}"
    yield ""
    yield (
        f"Out of `{registered.name}` (SHA-256 `{registered.sha256}`). What the file cannot say is"
        f" marked {GAP}."
    )
    if about.preregistration:
        yield from ("", f"Registered at {about.preregistration}.")
    for head, text in (
        ("Hypotheses", about.hypotheses or GAP),
        ("Design", "\n".join(_design(study))),
        ("Blinding", _blinding(study)),
        ("Randomisation", _randomisation(study)),
        ("Existing data", GAP),
        ("Collection of data", about.participants or GAP),
        ("Sample size and its reason", GAP),
        ("When to stop", GAP),
        ("Manipulated variables", "\n".join(_manipulated(study))),
        ("Measured variables", "\n".join(_measured(items))),
        ("Indices", "\n".join(f"* `{each.name}`: {each.label}" for each in items if each.is_score)),
        ("Models", GAP),
        ("Criteria for inference", GAP),
        ("What is excluded", _EXCLUDED),
        ("Missing data", GAP),
        ("Exploratory analyses", GAP),
    ):
        yield from ("", f"## {head}", "", text or GAP)


_EXCLUDED = (
    "Trials that were aborted, excluded with a reason while the session ran, or cut off by the end"
    " of the log, and practice trials (number 0). An answer to a cue counts within 10 s."
)


def _design(study: RegisteredStudy) -> Iterator[str]:
    design, conditions = study.settings.design, study.conditions
    yield f"Conditions: {listed([*conditions]) if conditions else 'none'}."
    if design is not None:
        who = "each participant gets all" if design.within else "each participant gets one"
        trials = counted(design.trials, "trial") if design.trials else "no number of trials"
        yield f"{'Within' if design.within else 'Between'} participants: {who}, {trials} in each."


def _blinding(study: RegisteredStudy) -> str:
    if study.settings.blind:
        labels = listed([*study.settings.blind.values()])
        return f"The wizard reads {labels} instead of the conditions' names."
    return "The file blinds nobody."


def _randomisation(study: RegisteredStudy) -> str:
    design = study.settings.design
    if design is None:
        return "The file orders no conditions."
    order = _ORDERS.get(design.order, design.order or "as the wizard says")
    return f"Order of conditions: {order}. {study.order}".strip()


def _manipulated(study: RegisteredStudy) -> Iterator[str]:
    if study.conditions:
        yield f"* the condition: {listed([*study.conditions])}"
    for name, by_condition in study.settings.by_condition.items():
        yield f"* `{name}`:"
        for condition, text in by_condition.items():
            yield f"    * {condition}: {text}"


def _measured(items: Sequence[Variable]) -> Iterator[str]:
    for each in items:
        if each.is_score:
            continue
        values = f" ({each.values})" if each.values else ""
        yield f"* `{each.name}`, asked {each.asked}: {each.label}{values}"
    yield (
        "* of the wizard and the robot: the figures of `woz report`, as the codebook defines them"
        " by table"
    )


def deviations(
    registered: PlayedFile, versions: Iterable[PlayedFile], sessions: Mapping[str, int]
) -> str:
    """What was played against what was registered, version by version."""
    return "\n".join(_deviations(registered, versions, sessions)) + "\n"


def _deviations(
    registered: PlayedFile, versions: Iterable[PlayedFile], sessions: Mapping[str, int]
) -> Iterator[str]:
    yield "# What was played otherwise than registered"
    yield ""
    yield f"Registered: `{registered.name}`, SHA-256 `{registered.sha256}`."
    for each in versions:
        begun = counted(sessions.get(each.sha256, 0), "session")
        yield from ("", f"## Version {each.sha256[:8]}: {begun} began with it", "")
        changes = [*_differences(registered, each)]
        yield from ("```diff", *changes, "```") if changes else ("As registered.",)


def _differences(registered: PlayedFile, played: PlayedFile) -> Iterator[str]:
    for place, (name, text) in enumerate(played.files.items()):
        # The experiment file may have been renamed: it is the first of both.
        before = registered.name if place == 0 else name
        if place and before not in registered.files and len(registered.files) == 1:
            continue  # the file alone was given
        yield from difflib.unified_diff(
            registered.files.get(before, "").splitlines(),
            text.splitlines(),
            f"registered/{before}",
            f"played/{name}",
            lineterm="",
        )
