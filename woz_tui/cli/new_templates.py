"""What `woz new` writes: five small dialogues, and the file around them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Offer:
    """What the robot can do: its gestures by name, and whether it senses who is there."""

    moves: frozenset[str]
    senses: bool


@dataclass(frozen=True, slots=True)
class Line:
    """A key with a sentence; `other` is said in the second condition, `move` goes with it."""

    key: str
    label: str
    text: str
    other: str = ""
    move: str = ""


@dataclass(frozen=True, slots=True)
class Template:
    """Phases with their lines in order, lines for any time, what participants are asked."""

    title: str
    about: str
    phases: Mapping[str, tuple[Line, ...]]
    always: tuple[Line, ...]
    items: tuple[tuple[str, str], ...]


_ALWAYS = (
    Line("y", "Yes", "Yes.", "Yes, exactly!", "nod"),
    Line("n", "No", "No.", "No, I am afraid not.", "shake"),
    Line("i", "I see", "I see.", "I see. Thank you for telling me.", "nod"),
)
_LIKED = ("liked", "I liked the robot.")
_CLEAR = ("clear", "I always knew what the robot wanted from me.")

TEMPLATES: Mapping[str, Template] = {
    "interview": Template(
        "Interview",
        "A semi-structured interview: an opening, questions with follow-ups, a closing.",
        {
            "Opening": (
                Line("h", "Hello", "Hello.", "Hello! How nice that you are here.", "wave"),
                Line("w", "Who I am", "I am a robot, and I have some questions for you."),
                Line("c", "Consent", "You may stop at any time. Shall we begin?"),
            ),
            "Topics": (
                Line("a", "Your day", "What did you do today?", "I am curious: how was your day?"),
                Line("b", "Work", "What do you work on?", "Tell me: what do you love to work on?"),
                Line("d", "Robots", "What should a robot never do?"),
                Line("m", "Tell me more", "Can you tell me more about that?"),
                Line("e", "Example", "Can you give me an example?"),
            ),
            "Closing": (
                Line("o", "Anything else", "Is there anything else?"),
                Line("g", "Goodbye", "Thank you. Goodbye.", "Thank you so much. Bye!", "bow"),
            ),
        },
        _ALWAYS,
        (_LIKED, ("listened", "The robot listened to me.")),
    ),
    "museum": Template(
        "Museum guide",
        "A guide: it greets, shows three exhibits, asks a question, says goodbye.",
        {
            "Welcome": (
                Line("h", "Hello", "Hello.", "Hello! How lovely that you have come.", "wave"),
                Line("w", "Welcome", "Welcome to our museum. I am your guide."),
            ),
            "Tour": (
                Line("1", "Whale", "Above you is the whale.", "Look up! This is our whale."),
                Line("2", "Boat", "This boat is from 1890.", "And this boat: it is from 1890!"),
                Line("3", "Map", "This map shows the whole coast."),
                Line("q", "Quiz", "How old do you think the whale is?"),
                Line("a", "Answer", "It was about ninety years old."),
            ),
            "Goodbye": (
                Line("t", "That was all", "That was the tour. Do you have a question?"),
                Line("g", "Goodbye", "Goodbye.", "Goodbye! Come back soon.", "bow"),
            ),
        },
        _ALWAYS,
        (_LIKED, ("learned", "I learned something.")),
    ),
    "game": Template(
        "Guessing game",
        "A game: the robot thinks of an animal, the other one asks until it is found.",
        {
            "Rules": (
                Line("h", "Hello", "Hello.", "Hello! I am so glad to play with you.", "wave"),
                Line("r", "Rules", "I think of an animal. You ask, and I say yes or no."),
                Line("s", "Start", "I have one. Ask me!"),
            ),
            "Play": (
                Line("c", "Close", "You are close.", "Oh, you are so close!"),
                Line("f", "Far", "That is not it.", "Not yet, but that was a good idea."),
                Line("1", "First hint", "It lives in water."),
                Line("2", "Second hint", "It is very large."),
                Line("w", "Won", "Right. It is the whale.", "Yes! You found it: the whale!", "bow"),
            ),
            "End": (
                Line("a", "Again", "Do you want to play again?"),
                Line("g", "Goodbye", "Goodbye.", "That was fun. Bye!", "wave"),
            ),
        },
        _ALWAYS,
        (_LIKED, ("fun", "The game was fun.")),
    ),
    "tutoring": Template(
        "Tutoring",
        "A lesson: explain, let the learner try, praise or help, sum up.",
        {
            "Explain": (
                Line("h", "Hello", "Hello.", "Hello! I am happy to learn with you.", "wave"),
                Line("e", "Explain", "Today we add fractions."),
                Line("1", "Example", "One half and one quarter are three quarters."),
            ),
            "Practice": (
                Line("2", "Task", "What are one third and one sixth?"),
                Line("p", "Praise", "That is right.", "That is right. You think so well!", "nod"),
                Line("t", "Try again", "That is not right.", "Nearly! Try it once more."),
                Line("c", "Hint", "Bring both to the same denominator."),
                Line("k", "Take your time", "Take your time."),
            ),
            "Summary": (
                Line("s", "Sum up", "First the same denominator, then you add."),
                Line("g", "Goodbye", "The lesson is over.", "Well done today. Bye!", "bow"),
            ),
        },
        _ALWAYS,
        (_LIKED, ("helped", "The robot helped me to learn.")),
    ),
    "survey": Template(
        "Survey robot",
        "A robot that asks passers-by a few questions and thanks them.",
        {
            "Approach": (
                Line("h", "Hello", "Hello.", "Hello! Do you have a moment for me?", "wave"),
                Line("m", "May I ask", "May I ask you three questions?"),
            ),
            "Questions": (
                Line("1", "How often", "How often do you come here?"),
                Line("2", "Rating", "From one to five: how do you like it here?"),
                Line("3", "Wish", "What would you change?"),
                Line("w", "Why", "Why is that?"),
            ),
            "Thanks": (
                Line("t", "Thanks", "Thank you.", "Thank you so much, that helps a lot!", "bow"),
                Line("g", "Goodbye", "Goodbye.", "Have a wonderful day!"),
            ),
        },
        _ALWAYS,
        (_LIKED, _CLEAR),
    ),
}


def robot_of(answer: str) -> str:
    """What stands behind `robot:`."""
    if answer == "pepper":
        return "{drivers: {pepper: {type: pepper, robots: [simulated]}}}"
    return answer if answer == "simulated" else json.dumps(answer)


def written(template: Template, wanted: Mapping[str, str], offer: Offer) -> str:
    """The whole file; `wanted` are the answers by the question's name."""
    conditions = [name.strip() for name in wanted["conditions"].split(",") if name.strip()]
    return "\n".join(
        [
            f"# {template.about}",
            "# `woz check` finds every mistake; docs/reference/experiment-file.md has every key.",
            "# The sentences are examples: write your own, in the language of your participants.",
            f"title: {template.title}",
            f"robot: {robot_of(wanted['robot'])}",
            *(["# instead of simulated: your robot's address"] * (wanted["robot"] == "pepper")),
            f"language: {wanted['language']}      # of what the console shows to participants",
            f"keyboard: {wanted['keyboard']}      # of the wizard",
            "",
            *(_study(template, conditions) if wanted["kind"] == "study" else ()),
            *(_engagement() if offer.senses else ()),
            *_repairs(),
            *_panels(template, conditions, offer),
            *_phases(template),
            *(_training(template) if wanted["kind"] == "study" else ()),
        ]
    )


def _study(template: Template, conditions: list[str]) -> Iterator[str]:
    yield 'participants: {pattern: "P\\\\d\\\\d"}   # P01 ... P99: codes, never names'
    if conditions:
        yield f"conditions: {json.dumps(conditions, ensure_ascii=False)}"
    if len(conditions) > 1:
        yield "# Everybody gets all conditions, in a balanced order. `within: no`: each gets one."
        yield "design: {order: latin-square}"
    yield ""
    yield "questionnaires:"
    yield "  - name: after"
    yield "    title: How was it?"
    yield f"    when: {'condition' if len(conditions) > 1 else 'trial'}"
    yield "    scale: {low: 1, high: 7, ends: [not at all, very much]}"
    yield "    items:"
    for name, question in template.items:
        yield f"      - {{name: {name}, question: {json.dumps(question)}}}"
    yield ""
    yield "preflight:                    # you tick these before the first participant (ctrl+f)"
    yield "  - The consent form is signed"
    yield "  - The participant cannot see the wizard"
    yield ""


def _engagement() -> Iterator[str]:
    yield "engagement:                   # is somebody there, and with the robot?"
    yield "  signals: none"
    yield "  handshake: {by: nobody}"
    yield "  timeouts: {lost: 2 s, absent: 10 s}   # gone for 10 s: nobody waits any more"
    yield ""


def _repairs() -> Iterator[str]:
    yield "# Keys that save a dialogue: again, other words, yes, no, I do not know ..."
    yield "repairs: {}                   # the sentences of `language`; or your own"
    yield ""


def _panels(template: Template, conditions: list[str], offer: Offer) -> Iterator[str]:
    yield "panels:"
    for title, lines in {**template.phases, "Any time": template.always}.items():
        yield f"  - title: {title}"
        yield "    actions:"
        for line in lines:
            move = f", play: {line.move}" if line.move in offer.moves else ""
            said = _said(line, conditions)
            yield f"      - {{key: {json.dumps(line.key)}, label: {line.label}, say: {said}{move}}}"
        if title == "Any time":
            varied = '{any: ["Hm, let me think.", "One moment, please.", "Let me see."]}'
            yield "      # one of several, in shuffled order, until all were said:"
            yield f"      - {{key: {_free(template)}, label: Let me think, say: {varied}}}"
            yield "      - {key: z, label: Marker, mark: look at this again}"
    yield ""


def _free(template: Template) -> str:
    """A letter that no line has."""
    lines = [*template.always, *(line for lines in template.phases.values() for line in lines)]
    used = {line.key for line in lines}
    return next(letter for letter in "lkjvx" if letter not in used)


def _said(line: Line, conditions: list[str]) -> str:
    """The sentence; one for each condition if they differ."""
    if len(conditions) < 2 or not line.other:
        return json.dumps(line.other if not conditions and line.other else line.text)
    by_condition = dict.fromkeys(conditions, line.text) | {conditions[1]: line.other}
    texts = (f"{json.dumps(name)}: {json.dumps(text)}" for name, text in by_condition.items())
    return f"{{{', '.join(texts)}}}"


def _phases(template: Template) -> Iterator[str]:
    yield "phases:                       # one key goes on; space plays the next line of a phase"
    before = ""
    for title, lines in template.phases.items():
        after = f", after: {before}" if before else ""
        script = ", ".join(line.label for line in lines)
        yield f"  - {{title: {title}, panels: [{title}, Any time], script: [{script}]{after}}}"
        before = title
    yield ""


def _training(template: Template) -> Iterator[str]:
    labels = [line.label for lines in template.phases.values() for line in lines]
    yield "training:                     # `woz train`: a visitor is simulated, you answer"
    yield "  count: 10"
    yield "  cues:"
    yield f"    - {{cue: approach, answers: {labels[0]}}}"
    yield '    - {cue: question, says: ["Is that so?", "Really?"], answers: ["Yes", "No"]}'
    yield '    - {cue: question, says: ["I work here.", "It is warm today."], answers: I see}'
    yield f"    - {{cue: leave, answers: {labels[-1]}}}"
    yield ""
