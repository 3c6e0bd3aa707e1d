"""Which action a wizard is likely to play next, from the acts of earlier sessions.

Four things are looked at, each as a probability for every action, and multiplied: what followed
the last two acts before (counts with Witten-Bell back-off); the place in the script; whether it
was played already in this trial; the visitor's words since the last act (BM25 against label,
sentences, and what was heard before that act in earlier sessions). Sessions of all conditions count
together: lists learnt by condition would tell a blind wizard which one it is.

The product is overconfident, because the four are not independent: `calibrate` flattens it until
what it says of acts of a session that it has not learnt is true.
"""

from __future__ import annotations

import math
import zlib
from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

#: Its version, which the log names.
VERSION = 1
#: Places of an action in the script, seen from its next line: that line, the two behind it, further
#: on, before it, not in the script.
_PLACES = 6
#: How often each of these was the next act where nothing is known yet: nothing heard, and heard.
_PRIOR: Mapping[bool, Sequence[float]] = {
    False: (11.0, 3.0, 1.5, 1.5, 1.0, 2.0),
    True: (4.0, 1.2, 0.8, 3.0, 3.0, 8.0),
}
#: The same for whether the next act was played before in this trial: not, and already.
_PLAYED: Sequence[float] = (18.0, 2.0)
#: Of BM25.
_K1, _B = 1.2, 0.6
#: So much of the probability goes by words, where any of them fits.
_WORDS = 0.95
#: Temperatures that are tried, and acts at the most with which that is done.
_TEMPERATURES = (1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0)
_CALIBRATING = 300
#: Words that say nothing of what they are about.
_COMMON = (
    " a an and are at be but can could do does for from have how i in is it its me my of on or so"
    " tell that the there they this to was we what when where which who why with would you your"
    " der die das den dem ein eine einen und oder ist sind war wie wer wo wann warum ich du er"
    " sie es wir ihr mir mich dir dich im am auf aus bei mit nach von zu zum zur nicht auch"
    " haben hat kann bitte "
)


def words_of(text: str) -> list[int]:
    """Its words as numbers: a cache on the disk is to hold nobody's words."""
    plain = "".join(sign if sign.isalnum() else " " for sign in text.casefold())
    return [zlib.crc32(word.encode()) for word in plain.split() if f" {word} " not in _COMMON]


@dataclass(frozen=True, slots=True)
class Act:
    """An act of an earlier session. `heard`: numbers of the words since the one before, None: no
    visitor spoke. `new`: the first one of a trial.
    """

    action: str
    phase: str = ""
    heard: tuple[int, ...] | None = None
    new: bool = False


@dataclass(frozen=True, slots=True)
class Moment:
    """What is known before an act: the acts before, oldest first; `played` in this trial; the lines
    of the script that holds, and the next one's number.
    """

    before: Sequence[str] = ()
    phase: str = ""
    heard: tuple[int, ...] | None = None
    played: Collection[str] = ()
    script: Sequence[str] = ()
    position: int = 0


class Ranked(NamedTuple):
    """An action, how likely it is, and what speaks for it most: script, order or words."""

    action: str
    share: float
    reason: str


@dataclass
class _Bag:
    """The words that belong to an action."""

    counts: Counter[int] = field(default_factory=Counter)
    length: int = 0

    def add(self, words: Iterable[int], sign: int = 1) -> None:
        for word in words:
            self.counts[word] += sign
            self.length += sign
            if not self.counts[word]:
                del self.counts[word]


class Ranker:
    """Ranks the actions of an experiment.

    Args:
        actions: What each is about: its label, what it says, what it answers.
        scripts: The lines of each phase's script, by its name (empty: the file's).
    """

    def __init__(
        self, actions: Mapping[str, Iterable[str]], scripts: Mapping[str, Sequence[str]]
    ) -> None:
        self._actions = [*actions]
        self._scripts = scripts
        self.temperature = _TEMPERATURES[2]
        self._followers: dict[tuple[str, ...], Counter[str]] = defaultdict(Counter)
        self._places = {heard: [*counts] for heard, counts in _PRIOR.items()}
        self._played = [*_PLAYED]
        self._bags = {name: _Bag() for name in actions}
        self._holding: dict[int, set[str]] = defaultdict(set)
        self._length = 0
        for name, texts in actions.items():
            for text in texts:
                self._add_words(name, words_of(text), 1)

    # -- learning --------------------------------------------------------------------------------

    def learn(self, acts: Sequence[Act], sign: int = 1) -> None:
        """Learn a session; -1: forget it again."""
        for act, moment in moments(acts, self._scripts):
            if act.action not in self._bags:
                continue
            for context in self._contexts(moment):
                self._followers[context][act.action] += sign
                if self._followers[context][act.action] <= 0:
                    del self._followers[context][act.action]
            self._places[moment.heard is not None][_place(act.action, moment)] += sign
            self._played[act.action in moment.played] += sign
            self._add_words(act.action, act.heard or (), sign)

    def _add_words(self, name: str, words: Sequence[int], sign: int) -> None:
        bag = self._bags[name]
        bag.add(words, sign)
        self._length += sign * len(words)
        for word in words:
            if word in bag.counts:
                self._holding[word].add(name)
            else:
                self._holding[word].discard(name)

    def calibrate(self, sessions: Sequence[Sequence[Act]]) -> None:
        """Choose the temperature with which sessions that were learnt would have been foretold best
        by all others.
        """
        losses = dict.fromkeys(_TEMPERATURES, 0.0)
        count = 0
        for acts in reversed(sessions):
            if count >= _CALIBRATING:
                break
            self.learn(acts, -1)
            for act, moment in moments(acts, self._scripts):
                logs = self._logs(moment)[0]
                if act.action not in logs:
                    continue
                count += 1
                for temperature in _TEMPERATURES:
                    share = _shares(logs, temperature)[act.action]
                    losses[temperature] -= math.log(max(share, 1e-9))
            self.learn(acts)
        if count:
            self.temperature = min(losses, key=lambda each: losses[each])

    # -- ranking ---------------------------------------------------------------------------------

    def rank(self, moment: Moment, allowed: Collection[str] | None = None) -> list[Ranked]:
        """All actions (or those that are `allowed`), the likeliest first."""
        logs, words, order = self._logs(moment)
        shares = _shares(logs, self.temperature)
        ranked = sorted(shares, key=lambda name: (-shares[name], name))
        return [
            Ranked(name, shares[name], _reason(name, moment, words, order))
            for name in ranked
            if allowed is None or name in allowed
        ]

    def _logs(
        self, moment: Moment
    ) -> tuple[dict[str, float], Mapping[str, float], Mapping[str, float]]:
        """Logarithms of the products, and two of their factors."""
        order, words = self._order(moment), self._words(moment.heard or ())
        heard = moment.heard is not None
        places = {name: _place(name, moment) for name in self._actions}
        there = Counter(places.values())
        counts = self._places[heard]
        total = sum(counts[place] for place in there) or 1.0
        again = Counter(name in moment.played for name in self._actions)
        played = sum(self._played[each] for each in again) or 1.0
        return (
            {
                name: math.log(order[name])
                + math.log(max(counts[places[name]], 0.05) / total / there[places[name]])
                + math.log(
                    max(self._played[name in moment.played], 0.05)
                    / played
                    / again[name in moment.played]
                )
                + math.log(words[name])
                for name in self._actions
            },
            words,
            order,
        )

    @staticmethod
    def _contexts(moment: Moment) -> Iterable[tuple[str, ...]]:
        """From the coarsest to the finest."""
        last, heard = moment.before[-2:], "heard" if moment.heard is not None else ""
        yield ("phase", moment.phase, heard)
        yield ("one", moment.phase, heard, *last[-1:])
        yield ("two", moment.phase, heard, *last)

    def _order(self, moment: Moment) -> dict[str, float]:
        """Witten-Bell: the more different acts followed, the more goes to the coarser context."""
        shares = dict.fromkeys(self._actions, 1 / max(1, len(self._actions)))
        for context in self._contexts(moment):
            followers = self._followers.get(context)
            if not followers:
                continue
            total, kinds = sum(followers.values()), len(followers)
            for name in shares:
                shares[name] = (followers.get(name, 0) + kinds * shares[name]) / (total + kinds)
        return shares

    def _words(self, heard: Sequence[int]) -> dict[str, float]:
        """BM25 of what was heard, as shares; the same for all where no word fits."""
        count = len(self._actions)
        even = dict.fromkeys(self._actions, 1 / max(1, count))
        mean = max(1.0, self._length / max(1, count))
        scores: dict[str, float] = defaultdict(float)
        for word in {*heard}:
            holding = self._holding.get(word, ())
            if not holding:
                continue
            rarity = math.log(1 + (count - len(holding) + 0.5) / (len(holding) + 0.5))
            for name in holding:
                bag = self._bags[name]
                n = bag.counts[word]
                norm = _K1 * (1 - _B + _B * bag.length / mean)
                scores[name] += rarity * n * (_K1 + 1) / (n + norm)
        total = sum(scores.values())
        if not total:
            return even
        # A word that fits little moves little.
        weight = _WORDS * min(1.0, max(scores.values()) / 3.0)
        return {
            name: (1 - weight) * even[name] + weight * scores.get(name, 0.0) / total
            for name in self._actions
        }


def moments(
    acts: Sequence[Act], scripts: Mapping[str, Sequence[str]]
) -> Iterable[tuple[Act, Moment]]:
    """Each act, and what was known before it."""
    before: list[str] = []
    played: set[str] = set()
    positions: dict[str, int] = {}
    for act in acts:
        if act.new:
            before, played, positions = [], set(), {}
        name = act.phase if act.phase in scripts else ""
        script = scripts.get(name, ())
        position = positions.get(name, 0)
        yield act, Moment(before[-2:], act.phase, act.heard, frozenset(played), script, position)
        before.append(act.action)
        played.add(act.action)
        if act.action in script:
            line = script.index(act.action)
            positions[name] = line + 1 if line >= position else position


def _place(action: str, moment: Moment) -> int:
    if action not in moment.script:
        return 5
    ahead = [
        line
        for line in range(moment.position, len(moment.script))
        if moment.script[line] not in moment.played
    ]
    for place, line in enumerate(ahead):
        if moment.script[line] == action:
            return min(place, 3)
    return 4


def _shares(logs: Mapping[str, float], temperature: float) -> dict[str, float]:
    if not logs:
        return {}
    most = max(logs.values())
    powers = {name: math.exp((log - most) / temperature) for name, log in logs.items()}
    total = sum(powers.values())
    return {name: power / total for name, power in powers.items()}


def _reason(
    name: str, moment: Moment, words: Mapping[str, float], order: Mapping[str, float]
) -> str:
    even = 1 / max(1, len(words))
    if words[name] > 2 * even:
        return "words"
    return "script" if _place(name, moment) == 0 or order[name] <= even else "order"
