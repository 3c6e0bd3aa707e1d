"""A museum whose wizard follows a script and answers questions: sessions to learn from."""

from __future__ import annotations

import random
from collections.abc import Iterator

from woz_tui.features.proposals.ranker import Act, words_of

PHASES = ("opening", "tour", "questions", "end")
#: What belongs to which phase; the first lines of each are the script's.
SCRIPTS = {
    "opening": ("Hello", "Your name", "Sit down"),
    "tour": ("The whale", "The skeleton", "The tank", "The film"),
    "questions": ("Any questions", "Quiz one", "Quiz two"),
    "end": ("Thank you", "Questionnaire", "Goodbye"),
}
#: Answers, each with questions of which the last two are heard in sessions nobody has learnt from.
TOPICS = {
    "Its size": (
        "how big is the whale|how long is it|what size does it have|is it bigger than a bus"
        "|how large can they grow|how many metres from head to tail"
    ),
    "Its weight": (
        "how heavy is the whale|what does it weigh|how many tons is that|is it heavier than"
        " an elephant|what weight would a scale show|how many kilos is such an animal"
    ),
    "Its food": (
        "what does it eat|what is its food|does it eat fish|how much does it eat"
        "|what do they feed on|is it hungry all day"
    ),
    "Its age": (
        "how old is it|how old can they get|when was it born|how many years do they live"
        "|what age do whales reach|does it live longer than people"
    ),
    "Its home": (
        "where does it live|which sea is its home|does it live in cold water|where was it found"
        "|in which ocean do they swim|from what part of the world is it"
    ),
    "Its voice": (
        "does it sing|what sound does it make|can you hear whales|how loud is its song"
        "|do they talk with each other|what noise do they make"
    ),
    "Its young": (
        "does it have babies|how many children does it have|how big is a baby whale"
        "|how long is a whale pregnant|do mothers care for their young|where are calves born"
    ),
    "Its breath": (
        "how does it breathe|how long can it dive|why does it blow water|does it need air"
        "|how deep can they go|when does it come up"
    ),
    "Photographs": (
        "may i take a photo|can i take pictures|is photography allowed|may i use my camera"
        "|can you take a picture of us|are selfies fine"
    ),
    "Opening hours": (
        "when do you close|when does the museum open|how long are you open today"
        "|are you open on sunday|until what time can we stay|is it open tomorrow"
    ),
    "Tickets": (
        "what does a ticket cost|how much is the entrance|is there a price for children"
        "|where can i buy tickets|do students pay less|is it free for kids"
    ),
    "Toilets": (
        "where is the toilet|where are the restrooms|is there a bathroom|i need the toilet"
        "|where can i wash my hands|which way to the washroom"
    ),
    "Coffee": (
        "where can i get coffee|is there a cafe|can we eat something here|where is the restaurant"
        "|do you sell drinks|i am thirsty"
    ),
    "Who I am": (
        "what are you|are you a robot|what is your name|who made you"
        "|are you alive|how do you work inside"
    ),
    "My age": (
        "how old are you robot|when were you built|since when do you work here robot"
        "|what is your birthday robot|are you new robot|were you made long ago robot"
    ),
    "Next tour": (
        "when is the next tour|is there a guided tour|how long does the tour take"
        "|can i join a tour|do you walk around with visitors|is somebody showing us around"
    ),
    "The shop": (
        "where is the shop|can i buy a souvenir|do you sell postcards|is there a gift shop"
        "|i want a present for my son|where do i get a toy whale"
    ),
}
#: Eleven of the answers are asked, so that there are 24 actions.
ANSWERS = tuple(TOPICS)[:11]
SCRIPT_ACTIONS = tuple(action for lines in SCRIPTS.values() for action in lines)
ACTIONS = (*SCRIPT_ACTIONS, *ANSWERS)
LOST, RANDOM = 0.12, 0.08
#: Answers that lead to another question, as curious people have them.
_LEADS = {"Its size": "Its weight", "Its food": "Its young", "Photographs": "Opening hours"}


def about() -> dict[str, list[str]]:
    """What each action is about, as a file says it: its label and one sentence."""
    said = {
        "Its size": "It is thirty metres long.",
        "Its weight": "It weighs a hundred and fifty tons.",
        "Its food": "It eats krill.",
        "Its age": "Whales live for ninety years.",
        "Its home": "It lives in all oceans.",
        "Its voice": "Its song is heard over a hundred kilometres.",
        "Its young": "A calf is born every three years.",
        "Its breath": "It comes up to breathe every ten minutes.",
        "Photographs": "Please take pictures, but without a flash.",
        "Opening hours": "We close at half past five.",
        "Tickets": "A ticket is eight euros, children are free.",
    }
    return {name: [name, said.get(name, "")] for name in ACTIONS}


def session(seed: str, *, heldout: bool = False, known: bool = False) -> list[Act]:
    """15 to 20 acts. `heldout`: with questions that were in no other session, unless `known`."""
    chance = random.Random(seed)
    acts: list[Act] = []
    for phase in PHASES:
        asked = chance.randint(1, 3) if phase in ("tour", "questions") else 0
        topics = chance.sample(ANSWERS, 3)
        for line in SCRIPTS[phase]:
            acts.append(Act(line, phase, None, not acts))
            while asked and chance.random() < 0.55:
                asked -= 1
                topic = topics.pop()
                acts.append(Act(topic, phase, _question(chance, topic, heldout and not known)))
                follows = _LEADS.get(topic)
                if follows and chance.random() < 0.5:
                    heard = _question(chance, follows, heldout and not known)
                    acts.append(Act(follows, phase, heard))
    return [_slip(chance, act) for act in acts]


def _question(chance: random.Random, topic: str, new: bool) -> tuple[int, ...]:
    questions = TOPICS[topic].split("|")
    text = chance.choice(questions[4:] if new else questions[:4])
    kept = [word for word in text.split() if chance.random() >= LOST]
    return tuple(words_of(" ".join(kept)))


def _slip(chance: random.Random, act: Act) -> Act:
    if chance.random() >= RANDOM:
        return act
    return Act(chance.choice(ACTIONS), act.phase, act.heard, act.new)


def sessions(seed: int, count: int) -> Iterator[list[Act]]:
    """Sessions to learn from."""
    for number in range(count):
        yield session(f"{seed} {number}")
