"""Parses a visitor's answer: a name, yes or no. Names are taken out of sentences.

The phrases are those of `LANGUAGES`: words are compared without accents, case and punctuation
(`heiße` is `heisse`, `sì` is `si`), and all languages count at once, since visitors do not announce
which one they will speak. A guess that is wrong costs one question, because
the robot repeats every name before it learns it; a wrong yes would not, so what is both a yes and
a no is neither.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from woz_tui.config.visitor_names import key_of, quoted_name


@dataclass(frozen=True, slots=True)
class Phrases:
    """One language. `before` and `after` stand before and after a name. So do `copulas`, but also
    before much else, and `opening` only at the start of what is said. `yes`, `no` and `negations`
    answer a question. `never` are words that are in no name, `fillers` and `ends` come before and
    after one and are not part of it. `declines` refuse to give one.
    """

    before: tuple[str, ...]
    copulas: tuple[str, ...]
    opening: tuple[str, ...]
    after: tuple[str, ...]
    yes: tuple[str, ...]
    no: tuple[str, ...]
    negations: tuple[str, ...]
    fillers: tuple[str, ...]
    never: tuple[str, ...]
    ends: tuple[str, ...]
    declines: tuple[str, ...]


# fmt: off
LANGUAGES: dict[str, Phrases] = {
    "en": Phrases(
        before=(
            "my name is", "my name's", "my names", "the name is", "the name's", "name is",
            "call me", "they call me", "people call me", "i am called", "i'm called",
        ),
        copulas=("i am", "i'm", "this is", "you are talking to"),
        opening=("it's", "it is", "im"),
        after=("is my name", "is the name"),
        yes=(
            "yes", "yeah", "yep", "sure", "correct", "exactly", "right", "it is", "i am",
            "that's me", "that is me", "that's my name", "that is my name", "of course",
            "absolutely", "you got it", "alright", "okay", "o.k",
        ),
        no=("no", "nope", "nah", "wrong", "incorrect"),
        negations=("not", "isn't", "isnt", "don't", "dont", "never"),
        fillers=(
            "hello", "hi", "hey", "oh", "ah", "er", "erm", "uh", "um", "ehm", "mm", "well",
            "sorry", "please", "so", "and", "but", "actually", "okay", "ok", "good morning",
        ),
        never=(
            "i", "i'm", "me", "my", "you", "your", "he", "she", "we", "they", "it", "it's",
            "that", "that's", "this", "these", "those", "is", "are", "was", "were", "be", "a",
            "did", "does", "have", "has", "could", "would", "what", "why", "how", "one", "more",
            "when", "where", "who", "the", "name", "sure", "quite", "really", "here", "other",
            "know", "hear", "say", "said", "again", "pardon", "wait", "moment", "nobody",
            "hello", "hi", "thanks", "please", "old", "years", "sorry", "afraid", "fine",
            "goodbye", "bye", "farewell", "cheers", "welcome",
            "good", "happy", "tired", "very", "too", "just", "going", "way", "another", "problem",
        ),
        ends=("and", "but", "from", "thanks", "thank", "please", "nice", "what", "who", "how"),
        declines=(
            "i don't want to", "i do not want to", "i'd rather not", "i would rather not",
            "none of your business", "i won't tell", "i will not tell",
        ),
    ),
    "de": Phrases(
        before=(
            "mein name ist", "mein name lautet", "ich heiße", "man nennt mich", "nenn mich",
            "nennen sie mich", "der name ist",
        ),
        copulas=("ich bin der", "ich bin die", "ich bin"),
        opening=("das ist",),
        after=("ist mein name", "heiße ich", "bin ich"),
        yes=(
            "ja",
            "jawohl",
            "genau",
            "richtig",
            "stimmt",
            "korrekt",
            "das bin ich",
            "das ist mein name",
        ),
        no=("nein", "nee", "nö", "falsch"),
        negations=("nicht", "kein", "keine"),
        fillers=(
            "hallo", "guten tag", "guten morgen", "grüß gott", "servus", "also", "äh", "ähm",
            "bitte", "sondern",
        ),
        never=(
            "ich", "du", "sie", "es", "wir", "mich", "mir", "mein", "dein", "ist", "bin",
            "bist", "sind", "hat", "habe", "das", "der", "die", "was", "wie", "wer", "warum",
            "bitte", "danke", "nochmal", "verstehe", "jahre", "ein", "eine", "hier", "gut",
            "auch", "hallo", "moment", "anders", "müde", "tschüss", "wiedersehen", "ciao",
        ),
        ends=("und", "aber", "aus", "danke", "bitte", "wie", "wer"),
        declines=("das sage ich nicht", "möchte ich nicht", "will ich nicht", "das geht dich"),
    ),
    "it": Phrases(
        before=(
            "mi chiamo", "il mio nome è", "mio nome è", "chiamami", "mi chiami",
            "puoi chiamarmi",
        ),
        copulas=("io sono",),
        opening=("sono",),
        after=("è il mio nome",),
        yes=("sì", "certo", "esatto", "giusto", "corretto", "sono io", "va bene", "è il mio nome"),
        no=("no", "sbagliato"),
        negations=("non",),
        fillers=("ciao", "buongiorno", "buonasera", "salve", "ehm", "allora", "beh"),
        never=(
            "lui", "noi", "voi", "ti", "sono", "sei", "è", "il", "un", "una", "qui", "bene",
            "che", "cosa", "come", "chi", "perché", "nome", "grazie", "prego", "capito", "anni",
            "ciao", "stanco", "stanca", "arrivederci", "arrivederla", "addio",
        ),
        ends=("e", "ma", "grazie", "piacere", "vengo"),
        declines=("non voglio", "preferisco di no", "non lo dico", "preferirei di no"),
    ),
    "fr": Phrases(
        before=(
            "je m'appelle", "mon nom est", "mon prénom est", "appelez-moi", "appelez moi",
            "appelle-moi", "appelle moi",
        ),
        copulas=("je suis",),
        opening=("c'est", "moi c'est"),
        after=("est mon nom", "est mon prénom"),
        yes=("oui", "ouais", "exactement", "c'est ça", "c'est moi", "d'accord", "c'est mon nom"),
        no=("non", "faux"),
        negations=("pas", "ne"),
        fillers=("bonjour", "bonsoir", "salut", "euh", "alors"),
        never=(
            "je", "nous", "vous", "moi", "est", "suis", "mon", "nom", "bonjour", "une", "ici",
            "que", "quoi", "comment", "qui", "pourquoi", "merci", "ça", "c'est", "ans",
            "revoir", "adieu", "salut",
        ),
        ends=("et", "mais", "merci", "enchanté", "enchantée"),
        declines=("je ne veux pas", "je préfère pas", "je préfère ne pas", "je ne dis pas"),
    ),
    "es": Phrases(
        before=("me llamo", "mi nombre es", "llámame", "llámeme", "puedes llamarme"),
        copulas=("yo soy",),
        opening=("soy",),
        after=("es mi nombre",),
        yes=("sí", "claro", "exacto", "correcto", "eso es", "soy yo", "vale"),
        no=("no", "incorrecto"),
        negations=("no", "nunca"),
        fillers=("hola", "buenos días", "buenas tardes", "eh", "pues", "bueno"),
        never=(
            "yo", "él", "te", "soy", "eres", "nombre", "qué", "cómo", "quién", "por", "gracias",
            "entiendo", "años", "hola", "aquí", "bien", "adiós", "hasta", "luego",
        ),
        ends=("y", "pero", "gracias", "encantado", "encantada"),
        declines=("no quiero", "prefiero no", "no lo digo"),
    ),
}
# fmt: on


#: A name has no more words than this.
WORDS = 4
#: Whoever says more has not answered.
LONGEST = 400

_ENDS_CLAUSE = frozenset(",.;:!?…")


@dataclass(frozen=True, slots=True)
class NameAnswer:
    """What was understood; `why` nothing was."""

    name: str = ""
    yes: bool = False
    no: bool = False
    declined: bool = False
    why: str = ""


_YES = NameAnswer(yes=True)
_AMBIGUOUS = NameAnswer(why="both yes and no")


@dataclass(frozen=True, slots=True)
class _Word:
    """A word as it was said, how it is compared, and whether a clause ends with it."""

    text: str
    key: str
    last: bool


_Words = Sequence[_Word]
_Phrase = tuple[str, ...]


class NameAnswerParser:
    """Reads answers. `yes` and `no` are an experiment's words, beside those of the table."""

    def __init__(self, yes: Iterable[str], no: Iterable[str]) -> None:
        self._yes = _phrases("yes", more=yes)
        self._no = _phrases("no", more=no)
        self._negations = _phrases("negations")
        self._declines = _phrases("declines")
        self._before = _phrases("before")
        self._copulas = _phrases("copulas")
        self._starting = _phrases("copulas", "opening")
        self._after = _phrases("after")
        self._fillers = _phrases("fillers")
        self._ends = {word for (word,) in _phrases("ends")}
        answers: list[_Phrase] = [phrase for phrase in self._yes + self._no if len(phrase) == 1]
        self._leads = self._fillers + answers
        self._never = {word for (word,) in [*_phrases("never"), *answers]}
        self._denials = {word for (word,) in self._negations}

    def read(self, text: str, proposed: str = "") -> NameAnswer:
        """What `text` says; `proposed` is the name that the visitor was asked to confirm, if
        any.
        """
        if len(text) > LONGEST:
            return NameAnswer(why="the answer was too long")
        words = _words(text)
        if not words:
            return NameAnswer(why="nothing was understood")
        if _anywhere(words, self._declines):
            return NameAnswer(declined=True)
        why = f"no name in {quoted_name(text.strip())}"
        if not proposed:
            return NameAnswer(name=self._name(self._led(words)), why=why)
        return self._about(words, proposed)

    def read_consent(self, text: str) -> NameAnswer:
        """Whether `text` is a yes or a no and nothing of the other."""
        words = _words(text)
        if len(text) > LONGEST or not words:
            return NameAnswer(why="nothing was understood")
        if _anywhere(words, self._declines):
            return NameAnswer(declined=True)
        yes, no = self._is_yes(words) or self._agrees(words), self._denies(words)
        return _AMBIGUOUS if yes and no else NameAnswer(yes=yes, no=no)

    def _about(self, words: _Words, proposed: str) -> NameAnswer:
        """The answer to whether `proposed` is right."""
        if self._is_yes(words):
            return _YES
        introduced = self._introduced(words)
        if introduced and key_of(introduced) != key_of(proposed):
            return NameAnswer(name=introduced, no=True)
        without = _without(words, proposed)
        yes, no = self._agrees(without), self._denies(without)
        if yes:
            return _AMBIGUOUS if no else _YES
        if no:
            return self._instead(words, proposed)
        name = self._name(self._led(words))
        return _YES if name and key_of(name) == key_of(proposed) else NameAnswer(name=name)

    def _instead(self, words: _Words, proposed: str) -> NameAnswer:
        """A no, and the name that comes with it, if any: `no, not Anna, Bob`."""
        rest = _without(self._led(words), proposed)
        left = [word for word in rest if word.key not in self._denials]
        return NameAnswer(name=self._name(self._led(left)), no=True)

    # -- yes and no -----------------------------------------------------------------------------

    def _is_yes(self, words: _Words) -> bool:
        """Whether it is a yes and nothing else."""
        led = self._led(words, self._fillers)
        return 0 < _leading(led, self._yes) == len(led)

    def _agrees(self, words: _Words) -> bool:
        """A yes in front, or one somewhere in a short answer that denies nothing."""
        led = self._led(words, self._fillers)
        if length := _leading(led, self._yes):
            return not _leading(led[length:], self._negations)
        return len(words) <= 2 * WORDS and not self._denies(words) and _anywhere(words, self._yes)

    def _denies(self, words: _Words) -> bool:
        return _anywhere(words, self._no) or _anywhere(words, self._negations)

    # -- names ----------------------------------------------------------------------------------

    def _led(self, words: _Words, leads: Sequence[_Phrase] | None = None) -> _Words:
        """The words without `leads` in front; these are fillers, yes and no if not given."""
        while length := _leading(words, self._leads if leads is None else leads):
            words = words[length:]
        return words

    def _name(self, words: _Words) -> str:
        return self._introduced(words) or self._named_before(words) or self._bare(words)

    def _introduced(self, words: _Words) -> str:
        """`my name is Anna`, wherever it stands in the sentence."""
        for start in range(len(words)):
            rest = words[start:]
            if length := _leading(rest, self._before):
                name = self._spoken(self._led(rest[length:], self._fillers), set())
            elif length := _leading(rest, self._copulas if start else self._starting):
                name = self._spoken(self._led(rest[length:]), self._never)
            else:
                continue
            if name:
                return name
        return ""

    def _named_before(self, words: _Words) -> str:
        """`Anna is my name`."""
        for end in range(1, len(words)):
            if _leading(words[end:], self._after):
                clause = list(_clauses(words[:end]))[-1]
                return self._spoken(self._led(clause), self._never)
        return ""

    def _bare(self, words: _Words) -> str:
        """The name and nothing else, as one clause of what was said."""
        for clause in _clauses(words):
            name = self._spoken(self._led(clause), self._never)
            if name:
                return name
        return ""

    def _spoken(self, words: _Words, never: set[str]) -> str:
        """The words in front, up to an end; empty if they are no name."""
        name: list[str] = []
        for word in words:
            if word.key in self._ends:
                break
            if word.key in self._denials or word.key in never:
                return ""
            name.append(word.text)
            if word.last:
                break
        return _written(" ".join(name)) if len(name) <= WORDS else ""


def _phrases(*kinds: str, more: Iterable[str] = ()) -> list[_Phrase]:
    """Phrases of all languages, and `more`, as words to compare, the longest first."""
    known = [getattr(language, kind) for language in LANGUAGES.values() for kind in kinds]
    found = {tuple(word.key for word in _words(one)) for table in (*known, more) for one in table}
    return sorted((phrase for phrase in found if phrase), key=lambda one: (-len(one), one))


def _words(text: str) -> list[_Word]:
    words: list[_Word] = []
    for piece in unicodedata.normalize("NFC", text).replace("\u2019", "'").split():
        bare = piece.lstrip("".join(c for c in set(piece) if not c.isalnum()))
        bare = bare.rstrip("".join(c for c in set(piece) if not _belongs(c)))
        last = bool(_ENDS_CLAUSE & set(piece[piece.rfind(bare) + len(bare) :]))
        if bare:
            words.append(_Word(bare, _key(bare), last))
        elif words and _ENDS_CLAUSE & set(piece):
            words[-1] = _Word(words[-1].text, words[-1].key, True)
    return words


def _belongs(character: str) -> bool:
    """Whether a word may end with it: letters, digits, marks that lie on letters."""
    return character.isalnum() or unicodedata.category(character).startswith("M")


def _key(word: str) -> str:
    apart = unicodedata.normalize("NFKD", word.casefold())
    return "".join(character for character in apart if not unicodedata.combining(character))


def _clauses(words: _Words) -> Iterator[_Words]:
    start = 0
    for end, word in enumerate(words, 1):
        if word.last or end == len(words):
            yield words[start:end]
            start = end


def _leading(words: _Words, phrases: Iterable[_Phrase]) -> int:
    """How many words the first phrase has that stands in front; 0: none does."""
    keys = tuple(word.key for word in words[: 2 * WORDS])
    return next((len(phrase) for phrase in phrases if keys[: len(phrase)] == phrase), 0)


def _anywhere(words: _Words, phrases: Sequence[_Phrase]) -> bool:
    return any(_leading(words[start:], phrases) for start in range(len(words)))


def _without(words: _Words, name: str) -> list[_Word]:
    """The words without those of the name."""
    keys = {word.key for word in _words(name)}
    return [word for word in words if word.key not in keys]


def _written(name: str) -> str:
    """A name as it is written: recognisers often know no capitals."""
    if name != name.lower():
        return name
    return " ".join(word[:1].upper() + word[1:] for word in name.split(" "))
