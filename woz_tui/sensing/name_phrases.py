"""What people say when they are asked for their name, as a table by language.

Words are compared without accents, case and punctuation (`heiße` is `heisse`, `sì` is `si`). All
languages count at once: a museum's visitors do not tell first which one they will speak.
"""

from __future__ import annotations

from dataclasses import dataclass


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
