"""Parses a visitor's answer: a name, yes or no. Names are taken out of sentences.

The phrases are those of `LANGUAGES`: words are compared without accents, case and punctuation
(`heiße` is `heisse`, `sì` is `si`), and all languages count at once, since visitors do not announce
which one they will speak. A guess that is wrong costs one question, because
the robot repeats every name before it learns it; a wrong yes would not, so what is both a yes and
a no is neither.

What is no name: everyday words; where the recogniser writes capitals, a word without one; several
words without a phrase such as `my name is` in a question, or beside other sentences (`Hello Ada,
where is the whale?`); Japanese that is not written as names are.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import astuple, dataclass
from pathlib import Path

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
            "call me", "my first name is", "they call me", "people call me", "everyone calls me",
            "everybody calls me",
            "i am called", "i'm called", "i go by",
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
            "sorry", "please", "so", "and", "but", "actually", "okay", "ok", "just", "let me think",
            "good morning", "good afternoon", "good evening", "good day", "greetings",
            "nice to meet you", "pleased to meet you",
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
        ends=(
            "and", "but", "from", "thanks", "thank", "please", "nice", "what", "who", "how",
            "pleased",
        ),
        declines=(
            "i don't want to", "i do not want to", "i'd rather not", "i would rather not",
            "none of your business", "i won't tell", "i will not tell",
        ),
    ),
    "de": Phrases(
        before=(
            "mein name ist", "mein vorname ist", "mein name lautet", "ich heiße",
            "man nennt mich", "nenn mich",
            "nennen sie mich", "der name ist", "sie nennen mich", "alle nennen mich",
            "du kannst mich",
            "sie können mich", "ihr könnt mich",
        ),
        copulas=(
            "ich bin der", "ich bin die", "ich bin", "i bin der", "i bin die", "i bin",
            "ich bins", "ich bin's",
        ),
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
            "hallo", "guten tag", "guten morgen", "guten abend", "grüß gott", "servus", "moin",
            "also",
            "äh", "ähm", "bitte", "sondern", "einfach", "lass mich überlegen",
            "freut mich",
        ),
        never=(
            "ich", "du", "sie", "es", "wir", "mich", "mir", "mein", "dein", "ist", "bin",
            "bist", "sind", "hat", "habe", "das", "der", "die", "was", "wie", "wer", "warum",
            "bitte", "danke", "nochmal", "verstehe", "jahre", "ein", "eine", "hier", "gut",
            "auch", "hallo", "moment", "müde", "tschüss", "wiedersehen", "ciao",
        ),
        ends=("und", "aber", "aus", "danke", "bitte", "wie", "wer", "freut", "nennen"),
        declines=("das sage ich nicht", "möchte ich nicht", "will ich nicht", "das geht dich"),
    ),
    "it": Phrases(
        before=(
            "mi chiamo", "il mio nome è", "mio nome è", "chiamami", "mi chiami", "mi chiamano",
            "mi dicono", "puoi chiamarmi", "può chiamarmi", "tutti mi chiamano",
        ),
        copulas=("io sono", "io sono il", "io sono la"),
        opening=("sono", "sono il", "sono la"),
        after=("è il mio nome",),
        yes=("sì", "certo", "esatto", "giusto", "corretto", "sono io", "va bene", "è il mio nome"),
        no=("no", "sbagliato"),
        negations=("non",),
        fillers=(
            "ciao", "buongiorno", "buonasera", "salve", "ehm", "allora", "beh", "fammi pensare",
            "piacere",
        ),
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
            "appelle-moi", "appelle moi", "on m'appelle", "vous pouvez m'appeler",
            "tu peux m'appeler",
        ),
        copulas=("je suis",),
        opening=("c'est", "moi c'est"),
        after=("est mon nom", "est mon prénom"),
        yes=("oui", "ouais", "exactement", "c'est ça", "c'est moi", "d'accord", "c'est mon nom"),
        no=("non", "faux"),
        negations=("pas", "ne"),
        fillers=("bonjour", "bonsoir", "salut", "coucou", "euh", "alors", "simplement"),
        never=(
            "je", "nous", "vous", "moi", "est", "suis", "mon", "nom", "bonjour", "une", "ici",
            "que", "quoi", "comment", "qui", "pourquoi", "merci", "ça", "c'est", "ans",
            "revoir", "adieu", "salut",
        ),
        ends=("et", "mais", "merci", "enchanté", "enchantée"),
        declines=("je ne veux pas", "je préfère pas", "je préfère ne pas", "je ne dis pas"),
    ),
    "es": Phrases(
        before=(
            "me llamo", "mi nombre es", "llámame", "llámeme", "puedes llamarme",
            "puede llamarme", "me dicen", "me llaman",
        ),
        copulas=("yo soy",),
        opening=("soy",),
        after=("es mi nombre",),
        yes=("sí", "claro", "exacto", "correcto", "eso es", "soy yo", "vale"),
        no=("no", "incorrecto"),
        negations=("no", "nunca"),
        fillers=("hola", "buenos días", "buenas tardes", "buenas noches", "eh", "pues", "bueno"),
        never=(
            "yo", "él", "te", "soy", "eres", "nombre", "qué", "cómo", "quién", "por", "gracias",
            "entiendo", "años", "hola", "aquí", "bien", "adiós", "hasta", "luego",
        ),
        ends=("y", "pero", "gracias", "encantado", "encantada"),
        declines=("no quiero", "prefiero no", "no lo digo"),
    ),
    "nl": Phrases(
        before=(
            "mijn naam is", "mijn voornaam is", "ik heet", "de naam is", "noem me", "noem mij",
            "ze noemen me",
            "ze noemen mij", "iedereen noemt me", "je mag me", "je kunt me", "u mag me",
            "u kunt me",
        ),
        copulas=("ik ben", "dit is"),
        opening=("het is",),
        after=("is mijn naam", "heet ik", "ben ik"),
        yes=("ja", "jawel", "jazeker", "klopt", "dat klopt", "precies", "inderdaad", "dat ben ik"),
        no=("nee", "neen", "fout"),
        negations=("niet", "geen"),
        fillers=(
            "hallo", "hoi", "goedemorgen", "goedemiddag", "goedenavond", "goedendag", "eh", "maar",
            "even denken", "aangenaam",
        ),
        never=("mijn", "jouw", "naam", "waar", "wat", "wie", "hoe", "doei", "tot", "ziens"),
        ends=("maar", "uit", "noemen", "bedankt", "aangenaam"),
        declines=("dat zeg ik niet", "liever niet", "wil ik niet"),
    ),
    "sv": Phrases(
        before=(
            "mitt namn är",
            "mitt förnamn är", "jag heter", "namnet är", "kalla mig", "du kan kalla mig",
            "ni kan kalla mig", "de kallar mig", "alla kallar mig", "jag kallas",
        ),
        copulas=("jag är", "det här är"),
        opening=("det är",),
        after=("är mitt namn", "heter jag"),
        yes=("ja", "japp", "just det", "precis", "det stämmer", "stämmer", "det är jag"),
        no=("nej", "nä"),
        negations=("inte", "ingen"),
        fillers=(
            "hej", "hejsan", "hallå", "tjena", "god morgon", "god kväll", "god dag", "öh", "alltså",
            "låt mig tänka",
        ),
        never=("mitt", "ditt", "namn", "var", "vad", "vem", "hur", "hejdå", "adjö"),
        ends=("och", "men", "från", "tack", "trevligt"),
        declines=("det säger jag inte", "helst inte", "vill jag inte"),
    ),
    "ja": Phrases(
        before=(
            "私の名前は", "わたしの名前は", "僕の名前は", "ぼくの名前は", "俺の名前は", "名前は",
        ),
        copulas=("私は", "わたしは", "僕は", "ぼくは", "俺は"),
        opening=(),
        after=(
            "です", "でございます", "と申します", "といいます", "と言います", "っていいます",
            "って言います", "って呼んでください", "と呼んでください", "っていうんだ",
        ),
        yes=("はい", "うん", "ええ", "そうです", "その通りです", "合っています"),
        no=("いいえ", "違います", "ちがいます"),
        negations=("じゃないです", "ではありません", "じゃありません"),
        fillers=(
            "こんにちは", "こんばんは", "おはようございます", "おはよう", "はじめまして",
            "初めまして", "えっと", "ええと", "あのう", "どうも", "よろしくお願いします",
            "よろしく",
        ),
        never=("です", "か", "ね", "よ", "お名前は", "何ですか"),
        ends=(
            "です", "でございます", "と申します", "といいます", "と言います", "っていいます",
            "って言います", "って呼んでください", "と呼んでください", "っていうんだ",
        ),
        declines=("言いたくない", "教えたくない"),
    ),
}


#: A name has no more words than this, and without a phrase that introduces it than that.
WORDS, BARE = 4, 3
#: Whoever says more has not answered.
LONGEST = 400

_ENDS_CLAUSE = frozenset(",.;:!?…、。\uff01\uff1f")
#: They stand within a name without a capital: `de`, `van`, `von`.
_WITHIN = frozenset({
    "de", "la", "del", "della", "di", "da", "van", "von", "der", "den", "zu", "ten", "ter", "el",
    "al", "bin", "ibn", "af", "du", "le",
})
#: In front of a name, and not without one.
_TITLES = frozenset({
    "mr", "mrs", "ms", "miss", "mister", "dr", "doctor", "doktor", "professor", "prof", "herr",
    "frau", "signor", "signora", "dottor", "dottoressa", "monsieur", "madame", "docteur", "senor",
    "senora", "don", "dona", "meneer", "mevrouw",
})
# fmt: on
#: Japanese, which is written without spaces; and how names are written in it, not as verbs are.
_JAPANESE = re.compile("[ぁ-ゟァ-ヿ]")
_SIGNS_OF_ASIA = re.compile("[ぁ-ゟァ-ヿ一-鿿々]")
_WRITTEN_AS_NAMES = re.compile("[ァ-ヿ・]{1,20}|[一-鿿々]{1,5}|[ぁ-ゟ]{2,4}")
#: Three o'clock, a Frenchman, on a journey.
_COUNTED_OR_OF_A_KIND = re.compile(
    "[一二三四五六七八九十百何0-9]+[時分秒年月日円人歳才回階度番]半?|.+[人者員師語駅館国達側]|..+中"
)
#: Endings of words for what somebody or something is like.
_QUALITY = re.compile(
    ".{3,}(isch|lich|haft|keit|heit|ful|less|able|ible|tion|mente|ssim[oa]|bility|ousness)"
)
#: Japanese phrases that are found within a text; shorter ones only between other signs.
_FOUND_WITHIN = 3


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
        self._denials = {phrase[0] for phrase in self._negations if len(phrase) == 1}
        #: Whether what is read is written with capitals, and is a question.
        self._capitals = self._asks = False

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
        self._capitals = _writes_capitals(text, words)
        self._asks = text.rstrip().endswith(("?", "\uff1f"))
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
        if no:  # and the name that comes with it, if any: `no, not Anna, Bob`
            rest = _without(self._led(words), proposed)
            left = [word for word in rest if word.key not in self._denials]
            return NameAnswer(name=self._name(self._led(left)), no=True)
        name = self._name(self._led(words))
        return _YES if name and key_of(name) == key_of(proposed) else NameAnswer(name=name)

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
                name = self._spoken(self._led(rest[length:], self._fillers), sure=True)
            elif length := _leading(
                rest, self._copulas if start and not words[start - 1].last else self._starting
            ):
                name = self._spoken(self._led(rest[length:]))
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
                return self._spoken(self._led(clause))
        return ""

    def _bare(self, words: _Words) -> str:
        """The name and nothing else, as the one clause that says something."""
        clauses = [led for clause in _clauses(words) if (led := self._led(clause))]
        if not clauses or (self._asks and len(words) > 1):
            return ""
        first, *others = clauses
        if len(first) > BARE and not any(word.key in self._ends for word in first):
            return ""
        if any(other[0].key not in self._ends for other in others):
            return ""
        return self._spoken(first, bare=True)

    def _spoken(self, words: _Words, *, sure: bool = False, bare: bool = False) -> str:
        """The words in front, up to an end; empty if they are no name. `sure`: a phrase stands
        before them that is for names alone; `bare`: none does, so all of them are the name.
        """
        name: list[str] = []
        for place, word in enumerate(words):
            if word.key in self._ends:
                break
            if word.key in self._denials:
                return ""
            if name and _goes_on(words[place:]):
                name.append(word.text)
                continue
            if not name and word.key in _TITLES and not word.last and place + 1 < len(words):
                name.append(word.text)
                continue
            small = self._capitals and word.text[:1].islower()
            surname = self._capitals and name and not (small or bare or word.key in _ENGLISH_I)
            if small or (not surname and self._is_no_name(word, sure=sure)):
                if bare or not name or not (sure or self._capitals):
                    return ""
                break
            name.append(word.text)
            if word.last:
                break
        return _written(" ".join(name)) if len(name) <= WORDS else ""

    def _is_no_name(self, word: _Word, *, sure: bool) -> bool:
        if _SIGNS_OF_ASIA.search(word.text) and (
            not _WRITTEN_AS_NAMES.fullmatch(word.text) or _COUNTED_OR_OF_A_KIND.fullmatch(word.text)
        ):
            return True
        if word.key in _EVERYDAY:
            named = sure and self._capitals and word.text[:1].isupper()
            return not named or word.key in _ENGLISH_I
        return not sure and (word.key in self._never or _QUALITY.fullmatch(word.key) is not None)


def _phrases(*kinds: str, more: Iterable[str] = ()) -> list[_Phrase]:
    """Phrases of all languages, and `more`, as words to compare, the longest first."""
    known = [getattr(language, kind) for language in LANGUAGES.values() for kind in kinds]
    found = {tuple(word.key for word in _words(one)) for table in (*known, more) for one in table}
    return sorted((phrase for phrase in found if phrase), key=lambda one: (-len(one), one))


def _words(text: str) -> list[_Word]:
    words: list[_Word] = []
    for piece in _spaced(unicodedata.normalize("NFC", text).replace("\u2019", "'")).split():
        bare = piece.lstrip("".join(c for c in set(piece) if not c.isalnum()))
        bare = bare.rstrip("".join(c for c in set(piece) if not _belongs(c)))
        last = bool(_ENDS_CLAUSE & set(piece[piece.rfind(bare) + len(bare) :]))
        if bare:
            words.append(_Word(bare, _key(bare), last))
        elif words and _ENDS_CLAUSE & set(piece):
            words[-1] = _Word(words[-1].text, words[-1].key, True)
    return words


def _spaced(text: str) -> str:
    """Japanese with spaces around the phrases that are known, and behind what ends a clause."""
    if not _JAPANESE.search(text):
        return text
    return _PHRASES_OF_JAPANESE.sub(r" \g<0> ", re.sub("([、。\uff01\uff1f])", r"\1 ", text))


def _writes_capitals(text: str, words: _Words) -> bool:
    """Whether names would have a capital: some word has one, if it is not `I` alone, which
    everybody writes so.
    """
    shown = [word for word in words if word.text[:1].isupper() and word.key not in _ENGLISH_I]
    punctuated = text.rstrip()[-1:] in _ENDS_CLAUSE and any(
        word.text[:1].isupper() for word in words
    )
    return text != text.upper() and (bool(shown) or punctuated)


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


def _goes_on(words: _Words) -> bool:
    """Whether a name goes on with a `van den` and what has a capital."""
    small = [word.key in _WITHIN and not word.last for word in words]
    length = small.index(False) if False in small else 0
    return length > 0 and words[length].text[:1].isupper()


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


_ENGLISH_I = frozenset({"i", "i'm", "i'd", "i'll", "i've"})
#: As they are compared.
_EVERYDAY = frozenset(
    _key(word)
    for line in Path(__file__).with_name("everyday_words.txt").read_text("utf-8").splitlines()
    if not line.startswith("#")
    for word in line.split()
)
#: Short ones that are found within a text, too.
_WITHOUT_SPACES = (*LANGUAGES["ja"].copulas, *LANGUAGES["ja"].after)
_PHRASES_OF_JAPANESE = re.compile(
    "|".join(
        sorted(
            (
                re.escape(phrase)
                for table in astuple(LANGUAGES["ja"])
                for phrase in table
                if len(phrase) >= _FOUND_WITHIN or phrase in _WITHOUT_SPACES
            ),
            key=len,
            reverse=True,
        )
    )
)
