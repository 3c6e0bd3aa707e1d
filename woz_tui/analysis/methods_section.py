"""A method section's sentences out of the figures, after the reporting guidelines for studies with
a wizard: L. D. Riek, Wizard of Oz Studies in HRI, Journal of Human-Robot Interaction 1 (1), 2012.

Every number comes from `study_figures.StudyFacts`. What was not recorded is said or left out, never
guessed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.feature_figures import FeatureFigures
from woz_tui.analysis.report_tables import FEWEST
from woz_tui.analysis.study_figures import ConditionFacts, StudyFacts
from woz_tui.analysis.text_format import (
    Some,
    capital,
    counted,
    in_seconds,
    listed,
    neither,
    times,
    was,
    were,
)
from woz_tui.config.about_file import NOTHING, About
from woz_tui.feature import pieces

#: What the guidelines ask for and no log can know, by the keys of about.yaml that say it.
BY_HAND: Mapping[tuple[str, ...], str] = {
    ("wizards",): "who the wizards were and what they knew of the hypotheses",
    (
        *("participants", "instructions", "debriefing"),
    ): "who the participants were, what they were told, and whether they knew of the wizard",
    ("robot",): "the robot: what it is, and how autonomous it was",
    ("technology",): "the technology that the wizard stood for",
    ("training",): "what wizards had to reach before the first session",
    ("place", "scenario"): "the place, and the scenario in words",
    ("iterative",): "whether the design was iterative",
    ("limitations",): "what the method leaves open",
}
_ORDERS = {
    "latin-square": "by a Latin square (Williams)",
    "blocks": "in shuffled blocks",
    "fixed": "in a fixed order",
    "hand": "by hand",
}
_SOURCES = {
    "key": "by key",
    "script": "by the script",
    "palette": "from the palette",
    "midi": "on a MIDI panel",
    "gamepad": "on a gamepad",
    "stream-deck": "on a Stream Deck",
    "spacemouse": "on a 6-D mouse",
    "wii-remote": "on a Wii Remote",
    "imu": "on a motion sensor in the hand",
    "program": "by a program",
    "phase": "with a phase",
    "engagement": "by the engagement model itself",
    "replay": "by a re-run",
}
#: More robots are not named one by one.
_MOST_ROBOTS = 5
_NAMES = {
    "transcript": "the transcript of speech",
    "distance": "the distance",
    "loudness": "the loudness",
    "presence": "the presence",
    "gaze": "the gaze",
    "identity": "the identity",
    "direction": "the direction of sound",
    "engagement": "the engagement model",
    "joints": "the joints",
    "face": "the face",
}


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Sentences about one thing."""

    head: str
    sentences: tuple[str, ...]


def by_hand(about: About = NOTHING) -> list[str]:
    """What is to be written by hand, as far as `about` does not say it."""
    return [
        words for keys, words in BY_HAND.items() if not all(getattr(about, key) for key in keys)
    ]


def paragraphs(facts: StudyFacts, about: About = NOTHING) -> list[Paragraph]:
    """Everything that the logs and `about` say; paragraphs without a sentence are left out."""
    found = [
        Paragraph("Participants and sessions", tuple(_sessions(facts, about))),
        Paragraph("Robot", tuple(_robot(facts, about))),
        Paragraph("Wizards", tuple(_wizards(facts, about))),
        Paragraph("Wizard production", tuple(_production(facts))),
        Paragraph("Wizard recognition", tuple(_recognition(facts))),
        Paragraph("Errors and times", tuple(_performance(facts))),
        Paragraph("Suspicion", tuple(_suspicion(facts, about))),
        Paragraph("Data", tuple(_data(facts))),
        Paragraph("Method", tuple(_method(about))),
    ]
    return [each for each in found if each.sentences]


# -- paragraphs -----------------------------------------------------------------------------------


def _sessions(facts: StudyFacts, about: About) -> Iterator[str]:
    yield from _attended(facts)
    yield from _said(about.participants, about.instructions, about.debriefing)
    if facts.deserted:
        left = f"{Some(facts.deserted, 'session')} without a participant"
        yield f"{left} {were(facts.deserted)} left out."


def _attended(facts: StudyFacts) -> Iterator[str]:
    if not facts.sessions:
        yield "The logs contain no session with a participant."
        return
    people = len(facts.participants)
    if people:
        yield (
            f"In all, {counted(people, 'participant')} took part in"
            f" {counted(facts.sessions, 'session')}{_lengths(facts)}."
        )
    else:
        yield f"There {were(facts.sessions)} {counted(facts.sessions, 'session')}{_lengths(facts)}."
    if facts.unnamed:
        yield f"No participant was recorded in {counted(facts.unnamed, 'session')}."
    conditions = [(name, len(who)) for name, who in sorted(facts.people.items()) if name]
    if conditions:
        sentences = [
            f"the condition {name} had {counted(count, 'participant')}"
            for name, count in conditions
        ]
        yield f"{capital(listed(sentences))}."
    elif people:
        yield "Conditions were not recorded."
    yield from _orders(facts)
    software = [name for name in facts.software if name]
    files = f"experiment {'file' if len(facts.files) == 1 else 'files'} {listed([*facts.files])}"
    file = f" with the {files}" if facts.files else ""
    title = f' ("{facts.title}")' if facts.title and file else ""
    if software:
        yield f"The robot was run by {listed(sorted(software))}{file}{title}."
    for name, each in pieces("figures", FeatureFigures).items():
        if name in facts.features:
            yield from each.attended(facts.features[name])


def _said(*texts: str) -> Iterator[str]:
    """What the researcher wrote, as sentences."""
    for text in filter(None, texts):
        yield capital(text if text.endswith((".", "!", "?")) else f"{text}.")


def _robot(facts: StudyFacts, about: About) -> Iterator[str]:
    yield from _said(about.robot)
    others = {robot: count for robot, count in sorted(facts.robots.items()) if robot}
    sessions = counted(sum(others.values()), "session")
    if len(others) == 1:
        yield f"In {sessions} the file was played with the robot {next(iter(others))}."
    elif 1 < len(others) <= _MOST_ROBOTS:
        named = listed([f"{robot} ({count})" for robot, count in others.items()])
        yield f"In {sessions} the file was played with the robots {named}."
    elif others:
        first, *_, last = others
        yield (
            f"In {sessions} the file was played with {len(others)} robot files, {first} to {last}."
        )
    known = facts.simulated.total()
    simulated = {drivers: count for drivers, count in facts.simulated.items() if drivers}
    count = sum(simulated.values())
    if count:
        where = "" if count == facts.sessions == known else f" in {counted(count, 'session')}"
        drivers = listed(sorted({driver for each in simulated for driver in each}))
        yield f"The robot was simulated{where} ({drivers}); no hardware moved."
    if about.technology:
        yield from _said(f"the wizard stood for {about.technology}")


def _method(about: About) -> Iterator[str]:
    yield from _said(about.place and f"the sessions took place in {about.place}", about.scenario)
    yield from _said(about.iterative, about.limitations)


def _suspicion(facts: StudyFacts, about: About) -> Iterator[str]:
    for name, each in pieces("figures", FeatureFigures).items():
        if name in facts.features:
            yield from each.suspicion(facts.features[name], about.suspicion)


def _lengths(facts: StudyFacts) -> str:
    lengths = facts.lengths
    if lengths.mean is None:
        return ""
    if lengths.n == 1:
        return f" of {_minutes(lengths.mean)} min"
    spread = "" if lengths.sd is None else f" (SD {_minutes(lengths.sd)} min)"
    return f" of {_minutes(lengths.mean)} min on average{spread}"


def _orders(facts: StudyFacts) -> Iterator[str]:
    methods = [
        f"{_ORDERS.get(method, method)} in {counted(count, 'session')}"
        for method, count in sorted(facts.orders.items())
    ]
    if methods:
        yield f"Conditions were assigned {listed(methods)}."


def _wizards(facts: StudyFacts, about: About) -> Iterator[str]:
    if not facts.sessions:
        return
    recorded = {name: count for name, count in sorted(facts.wizards.items()) if name}
    if not recorded:
        yield "The wizard was not recorded."
    elif len(recorded) == 1:
        [(name, count)] = recorded.items()
        led = "all sessions" if count == facts.sessions > 1 else counted(count, "session")
        yield f"The robot was controlled by 1 wizard ({name}), who led {led}."
    else:
        led = listed(
            [f"{name} led {counted(count, 'session')}" for name, count in recorded.items()]
        )
        yield f"The robot was controlled by {len(recorded)} wizards: {led}."
    if recorded and facts.wizards[""]:
        yield f"No wizard was recorded in {counted(facts.wizards[''], 'session')}."
    for name, each in pieces("figures", FeatureFigures).items():
        yield from each.wizards(facts.apart.get(name, ()), [*recorded])
    yield from _said(about.wizards)
    if about.training:
        yield from _said(f"before the first session wizards had to reach: {about.training}")


def _production(facts: StudyFacts) -> Iterator[str]:
    if facts.offered:
        yield (
            f"The wizard chose from {counted(len(facts.offered), 'prepared action')} on"
            f" {counted(len(facts.panels), 'panel')} ({listed([*facts.panels])})."
        )
        locked = [title for title, lock in facts.panels.items() if lock]
        if locked:
            yield (
                f"{Some(len(locked), 'panel')} ({listed(locked)}) {were(len(locked))} locked"
                " unless unlocked on purpose."
            )
    elif facts.sessions:
        yield "What the wizard could choose from was not recorded."
    for name, each in pieces("figures", FeatureFigures).items():
        if name in facts.features:
            yield from each.methods(facts.features[name])
        yield from each.methods_of_times(facts.times)
    yield from _acted(facts)


def _acted(facts: StudyFacts) -> Iterator[str]:
    total = sum(facts.outcomes.values())
    if not total:
        return
    sources = [
        (count, _SOURCES.get(source, f"by {source}"))
        for source, count in facts.sources.most_common()
    ]
    if len(sources) == 1:
        how = f"{'all ' if total > 1 else ''}{sources[0][1]}"
    else:
        how = listed([f"{count} {words}" for count, words in sources])
    yield f"In all, {counted(total, 'action')} {were(total)} asked for, {how}."
    ends = [
        f"{count} {one if count == 1 else many}"
        for end, (one, many) in _ENDS.items()
        if (count := facts.outcomes[end])
    ]
    if len(ends) == 1 and total > 1:
        yield f"All of them {ends[0].partition(' ')[2]}."
    elif len(ends) == 1:
        yield f"It {ends[0].partition(' ')[2]}."
    else:
        yield f"Of these, {listed(ends)}."
    if facts.direct:
        yield f"Besides, {counted(facts.direct, 'improvised action')} {were(facts.direct)} played."
    if facts.edited:
        rewritten = f"{counted(facts.edited, 'prepared sentence')} {were(facts.edited)} rewritten"
        yield f"Before being said, {rewritten} by the wizard."


_ENDS = {
    "done": ("was carried out", "were carried out"),
    "failed": ("failed", "failed"),
    "stopped": ("was stopped or replaced", "were stopped or replaced"),
    "superseded": ("was replaced by a newer one", "were replaced by newer ones"),
    "refused": ("was refused", "were refused"),
    "left_out": (
        "was left out for a robot that lacks it",
        "were left out for a robot that lacks them",
    ),
    "open": ("has no end in the log", "have no end in the log"),
}


def _recognition(facts: StudyFacts) -> Iterator[str]:
    if not facts.sessions:
        return
    for (hidden, blurred), count in sorted(facts.views.items()):
        parts = [f"did not see {listed(_named(hidden), 'or')}"] if hidden else []
        parts += [f"saw {listed(_named(blurred))} only blurred"] if blurred else []
        yield f"In {counted(count, 'session')} the wizard {listed(parts)}."
    if not facts.views:
        yield "No restriction of the wizard's view was recorded."


def _named(names: Sequence[str]) -> list[str]:
    return [_NAMES.get(name, name) for name in names]


def _performance(facts: StudyFacts) -> Iterator[str]:
    if facts.acts:
        marked = f"{facts.mistakes} ({_per_cent(facts.mistakes, facts.acts)})"
        what = "marked as a mistake" if facts.mistakes == 1 else "marked as mistakes"
        yield f"Of {counted(facts.acts, 'wizard action')}, {marked} {was(facts.mistakes)} {what}."
    yield from _reacted(facts)
    yield from _by_condition(facts)
    if facts.press.n:
        yield (
            "The time from the request of a wizard action to its start in the robot, the wait"
            " behind an earlier act included, was"
            f" {_spread(facts.press, _fine, 'ms')}, over {counted(facts.press.n, 'wizard action')}."
        )
    if facts.stops:
        yield (
            f"The emergency stop was pressed {times(facts.stops)}"
            f" in {counted(facts.stopped_sessions, 'session')}."
        )
    if facts.unreached:
        names = listed([f"{name} ({times(n)})" for name, n in sorted(facts.unreached.items())])
        yield f"It did not reach {names}, which {was(len(facts.unreached))} not connected."


#: Why a cue has no reaction time, in words.
_CENSORED = {
    "missed": "not answered within the window",
    "answered_early": "answered before they came",
    "superseded": "superseded by a newer cue",
    "cut": "cut off by a break or by the end of the trial or the log",
}
#: Results of cues to which an answer was not due within the window, in words.
_NOT_DUE = {
    "answered_early": "answered before they came",
    "superseded": "superseded",
    "cut": "cut off by a break or by the end of the trial or the log",
}


def _reacted(facts: StudyFacts) -> Iterator[str]:
    cues = sum(facts.results.values())
    if not cues:
        return
    due = facts.results["answered"] + facts.results["missed"]
    share = ""
    if due:
        others = [words for result, words in _NOT_DUE.items() if facts.results[result]]
        left = f" of those {neither(others)}" if others else ""
        share = f" ({_per_cent(facts.results['answered'], due)}{left})"
    yield (
        f"Of {counted(cues, 'cue')} that needed an answer, the wizard answered"
        f" {facts.results['answered']} within {in_seconds(facts.window_us)} s"
        f"{share}."
    )
    if facts.reactions.n >= FEWEST:
        yield f"The reaction time was {_spread(facts.reactions, in_seconds, 's')}."
    if facts.results["answered"] < cues:
        censored = [
            f"{facts.results[result]} {words}"
            for result, words in _CENSORED.items()
            if facts.results[result]
        ]
        without = cues - facts.results["answered"]
        yield f"{Some(without, 'cue')} {were(without)} without a reaction time: {listed(censored)}."


def _by_condition(facts: StudyFacts) -> Iterator[str]:
    told = {name: each for name, each in sorted(facts.by_condition.items()) if name}
    if len(told) < 2:
        return
    acts = [
        f"{each.mistakes} of {counted(each.acts, 'wizard action')} in {name}"
        for name, each in told.items()
        if each.acts
    ]
    if acts:
        yield f"Marked as mistakes were {listed(acts)}."
    answers = [_answered_in(name, each) for name, each in told.items() if each.results.total()]
    if answers:
        yield f"Of cues, {listed(answers)} were answered in time."


def _answered_in(name: str, facts: ConditionFacts) -> str:
    words = f"{facts.results['answered']} of {facts.results.total()} in {name}"
    if facts.reactions.n < FEWEST:
        return words
    return f"{words} (median {in_seconds(facts.reactions.median or 0.0)} s)"


def _data(facts: StudyFacts) -> Iterator[str]:
    if not facts.sessions:
        return
    if facts.left_out:
        outcomes = [
            f"{count} {was(count)} {outcome}" for outcome, count in sorted(facts.left_out.items())
        ]
        yield f"Of {counted(facts.trials, 'trial')}, {listed(outcomes)} and left out."
    if facts.outside:
        yield (
            f"In {counted(facts.outside, 'session')} there was time outside of trials; figures of"
            " what the wizard did are of the trials alone."
        )
    if facts.reruns:
        yield f"{Some(facts.reruns, 're-run')} of a session {were(facts.reruns)} left out."
    if facts.damaged:
        yield (
            f"The {'log' if facts.damaged == 1 else 'logs'} of {counted(facts.damaged, 'session')}"
            f" {were(facts.damaged)} damaged;"
            f" {counted(facts.lost, 'line')} {were(facts.lost)} lost."
        )
    if facts.open_logs:
        yield (
            f"The {'log' if facts.open_logs == 1 else 'logs'} of"
            f" {counted(facts.open_logs, 'session')}"
            f" {were(facts.open_logs)} cut off before the end."
        )
    if not facts.damaged and not facts.open_logs:
        yield f"No line was lost from the {'log' if facts.sessions == 1 else 'logs'}."


# -- words ----------------------------------------------------------------------------------------


def _per_cent(part: int, total: int) -> str:
    return f"{100 * part / total:.1f} %"


def _fine(us: float) -> str:
    return f"{us / 1e3:.1f}"


def _minutes(us: float) -> str:
    return f"{us / 60e6:.1f}"


def _spread(series: Durations, form: Callable[[float], str], unit: str) -> str:
    """Median, 95 % quantile and longest of durations that are not empty."""
    median, p95, most = (series.quantile(share) or 0.0 for share in (0.5, 0.95, 1.0))
    return (
        f"{form(median)} {unit} in the median (95 % quantile {form(p95)} {unit},"
        f" longest {form(most)} {unit})"
    )
