"""What may be the name (the code) of a visitor, and when two names are the same."""

from __future__ import annotations

import unicodedata

from woz_tui.config.problems import with_remedy
from woz_tui.protocol.sentence import Sentence

#: Longest name, in code points after normalisation.
LONGEST = 64
#: Longest word in a profile.
LONGEST_WORD = 32
#: Names that mean something else where an identity is given.
RESERVED = {
    "unknown": Sentence("check.word_for_nobody", "it is the word for a visitor without a name"),
    "sensor": Sentence("check.is_a_command", "it is a command"),
}
#: Joiners that Persian and Indic names need; they make no difference between names.
_JOINERS = "\u200c\u200d"
#: Categories that are never seen, or that turn the text around them.
_UNSEEN = {"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"}


class VisitorNameError(ValueError):
    """This cannot be a name; `reason` says why, `remedy` what to do."""

    def __init__(self, reason: str, remedy: str) -> None:
        super().__init__(with_remedy(reason, remedy))
        self.reason = reason
        self.remedy = remedy


def name_of(text: str) -> str:
    """The name that `text` means: composed (NFC), without blanks around it, with single blanks
    inside. Raises `VisitorNameError` if it is empty, longer than 64 characters, without any letter
    or digit, reserved, or holds control characters or marks that turn the direction of writing.
    """
    name = _tidy(text)
    if not name:
        raise VisitorNameError(
            Sentence("check.visitor_name_empty", "a visitor's name is empty"),
            Sentence("check.give_name", "give a code or a name"),
        )
    _check(name, Sentence("check.a_visitors_name", "a visitor's name"), LONGEST)
    if not any(character.isalnum() for character in name):
        raise VisitorNameError(
            Sentence(
                "check.name_without_letters",
                "{name} has no letters and no digits",
                name=quoted_name(name),
            ),
            Sentence("check.give_name", "give a code or a name"),
        )
    reason = RESERVED.get(key_of(name))
    if reason is not None:
        raise VisitorNameError(
            Sentence(
                "check.no_name",
                "{name} cannot be a name: {reason}",
                name=quoted_name(name),
                reason=reason,
            ),
            Sentence("check.another_name", "choose another name"),
        )
    return name


def word_of(text: str, what: str) -> str:
    """A word of a profile, tidied like a name; may be empty. `VisitorNameError` names `what`."""
    word = _tidy(text)
    _check(word, what, LONGEST_WORD)
    return word


def label_of(text: str) -> str:
    """A recogniser's name of a face, tidied like a name; `VisitorNameError` if it is empty."""
    label = _tidy(text)
    if not label:
        raise VisitorNameError(
            Sentence("check.face_label_empty", "a face's label is empty"),
            Sentence("check.give_face_label", "give the text that the recogniser sends"),
        )
    _check(label, Sentence("check.a_faces_label", "a face's label"), LONGEST)
    return label


def key_of(name: str) -> str:
    """Equal for names that people take for the same: letter case, blanks around and between
    words, composed or wide forms and joiners do not count.
    """
    folded = unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())
    return _tidy("".join(character for character in folded if character not in _JOINERS))


def quoted_name(text: str) -> str:
    """The text in quotes, with everything escaped that would not be seen on a terminal."""
    kept = "".join(
        character
        if unicodedata.category(character) not in _UNSEEN or character in _JOINERS
        else character.encode("unicode_escape").decode("ascii")
        for character in text[: 2 * LONGEST]
    )
    return f'"{kept}{"..." if len(text) > 2 * LONGEST else ""}"'


def _tidy(text: str) -> str:
    blanks = "".join(
        " " if unicodedata.category(character) == "Zs" else character for character in text
    )
    words = unicodedata.normalize("NFC", blanks).strip().split(" ")
    return " ".join(word for word in words if word)


def _check(text: str, what: str, longest: int) -> None:
    if len(text) > longest:
        raise VisitorNameError(
            Sentence(
                "check.too_long",
                "{what} has {number} characters, {longest} are allowed",
                what=what,
                number=len(text),
                longest=longest,
            ),
            Sentence("check.shorten", "shorten it"),
        )
    for character in text:
        if character not in _JOINERS and unicodedata.category(character) in _UNSEEN:
            raise VisitorNameError(
                Sentence(
                    "check.unseen_character",
                    "{what} holds the character U+{character:04X}, which is invisible",
                    what=what,
                    character=ord(character),
                ),
                Sentence("check.type_again", "type it again"),
            )
