"""The reference page of the experiment file, out of the schema that is made from the code.

Examples are what the experiments that come with woz-tui say, and else those in `EXAMPLES`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import yaml

from tools import EXPERIMENTS
from tools.driver_settings import bundled
from woz_tui.config.actions import ACTION_FIELDS
from woz_tui.config.engagement_section import ENTERED
from woz_tui.config.engagement_words import SIGNS
from woz_tui.config.json_schema import experiment_schema
from woz_tui.config.session_verbs import WAIT, session_verbs
from woz_tui.features.blocks.robot_tables import KEYS, TOPICS, TOPICS_WORDS
from woz_tui.features.blocks.section import BML_VERB

#: Whose examples come first: what is read most.
FIRST = ("interview.yaml", "study.yaml", "demo.yaml", "guide.yaml")

HEAD = """\
# The experiment file

Look up here every key of an experiment file: its type, its default, an example. The page is made
from the code (`make generated`); `woz schema` gives the same to editors.

What becomes of a small file:

```
 title: Museum guide                          ┌ Museum guide ────── 00:12  ✓ Recording ─┐
 robot: simulated                             │ ┌ 1 Speech ─────┐ ┌ 2 Gestures ──────┐  │
 panels:                                      │ │ h  Hello      │ │ n  Nod           │  │
   - title: Speech            ──────────────▶ │ │ q  Question   │ │                  │  │
     actions:                  panels, keys,  │ └───────────────┘ └──────────────────┘  │
       - key: h                labels         │                                         │
         label: Hello                         │                                         │
         say: Hello {participant}!  ───────▶  │ 00:11  Hello   "Hello P07!"      done   │
   - title: Gestures           verbs of the   │                                         │
     actions:                  robot          │                                         │
       - {key: n, label: Nod, play: nod}      │                                         │
 script: [Hello, Nod]       ───────────────▶  │ space: Hello                            │
                               the next line  └─────────────────────────────────────────┘
```

`woz new` writes a file to begin with, `woz check FILE` finds every mistake with its line,
`woz check --why KEY FILE` says whether locks, phases, parts and profiles let a key be pressed, and
a session reads the file again with one key (ctrl+e) while it runs. Seconds may carry a unit
(`300 ms`, `4 s`, `2 min`). Text needs quotes only where YAML needs them: `No`, `007` and `12:30`
stay what they are.
"""
COLUMNS = """\
| key | type | default | example | what it says |
|---|---|---|---|---|
"""
VERBS = """\
## Verbs

What an action or a step does. `woz check --all FILE` lists the verbs of your robot with their
arguments; each robot's page has them, too. These are there with every robot:

| verb | example | what it does |
|---|---|---|
"""
#: What no experiment of ours says, by path.
EXAMPLES: dict[str, Any] = {
    "session.access": {"anna": "wizard", "display": "watcher"},
    "robots": {"left": "robots/eyepi.yaml", "right": "robots/eyepi.yaml"},
    "robot.name": "Sophie",
    "session.stale_after": "2 s",
    "session.driving": "held",
    "panels.locked": True,
    "panels.covers": ["drive", "nudge"],
    "panels.for": "voice",
    "actions.on": "voice",
    "actions.help": "only for children",
    "actions.locked": True,
    "actions.name": "Hello again",
    "actions.when_busy": "replace",
    "answers.engagement": ["say", "Gestures"],
    "answers.marker": "play",
    "actions.then": ["Yes", "No"],
    "design.block": 4,
    "design.seed": 7,
    "design.within": False,
    "questionnaires.name": "ux",
    "questionnaires.file": "tlx.yaml",
    "questionnaires.scores": {"warmth": {"items": ["kind", "cold"], "missing": 1}},
    "questionnaires.scores.items": ["kind", "cold"],
    "questionnaires.scores.weights": {"mental": 3, "effort": 2},
    "questionnaires.scores.pairs": ["mental-effort"],
    "questionnaires.scores.onto": {"low": 0, "high": 100},
    "questionnaires.instrument": {"citation": "Brooke (1996)"},
    "questionnaires.instrument.citation": "Brooke (1996)",
    "questionnaires.instrument.link": "https://uxpajournal.org/sus-a-retrospective/",
    "questionnaires.instrument.terms": "CC BY 4.0",
    "questionnaires.instrument.read": "2026-11-29: the licence line of the article",
    "questionnaires.scale.points": ["never", "seldom", "often"],
    "questionnaires.scale.labels": {1: "not at all", 4: "half", 7: "quite"},
    "training.count": 20,
    "training.cues.window": "8 s",
    **{f"engagement.{sign}": {"samples": 10} for sign in SIGNS},
    **{f"engagement.{sign}.sensor": f"left.{sign}" for sign in SIGNS},
    "engagement.*.rate": 5,
    "engagement.turns": "paper",
    "engagement.timeouts.absent": "5 s",
    "engagement.joint": {"glance": 0.7},
    "engagement.sound": {"hang_over": "0.8 s"},
    "engagement.sound.threshold": 0.05,
    "engagement.handshake.face_consent": "May I remember your face?",
    "engagement.handshake.yes": ["yes", "that is right"],
    "engagement.handshake.no": ["no"],
    "engagement.visitors": "visitors.json",
    **{f"engagement.on_enter.{state}": {"eyes": "green"} for state in ENTERED},
    "profiles": {"child": {"panels": ["Face"]}},
    "profiles.verbs": ["say"],
    "repairs.on": "left",
    "repairs.without": ["dont_know"],
    "repairs.yes": {"say": "Yes!", "play": "nod"},
    "repairs.no": "I am afraid not.",
    "repairs.dont_know": "The lady at the desk knows.",
    "repairs.please_repeat": "Pardon?",
    "phases": [{"name": "opening", "script": ["Hello", "Consent"]}],
    "phases.name": "opening",
    "phases.title": "Opening",
    "phases.panels": ["Speech"],
    "phases.script": ["Hello", "Consent"],
    "phases.on_enter": "Look up",
    "phases.after": "opening",
    "phases.planned": "5 min",
    "phases.lock_others": True,
    "participants.fields": {"first": "text", "group": ["child", "adult"]},
    "participants.table": "people.csv",
    "slots": {"colour": {"offer": ["red", "blue"], "keep": "participant"}},
    "slots.offer": ["red", "blue"],
    "slots.heard": True,
    "slots.keep": "participant",
    "suggest": {"logs": True},
    "suggest.model": {"name": "qwen2.5-1.5b-instruct"},
    "suggest.model.name": "qwen2.5-1.5b-instruct",
    "programs": {"mcp": "propose"},
    "page": {"plain": True},
    "page.for": ["watch", "answer"],
    "page.certificate": "page.pem",
    "page.key": "page.key",
    "page.names": ["robot.lab"],
    "page.questionnaire": "tlx",
    "page.pictures": ["eye"],
    "choices": [{"name": "animal", "options": [{"text": "Whale"}]}],
    "choices.name": "animal",
    "choices.question": "Which animal shall we talk about?",
    "choices.options": [{"text": "Whale", "plays": "Whale intro"}],
    "choices.options.text": "Whale",
    "choices.options.picture": "media/whale.svg",
    "choices.options.plays": "Whale intro",
    "lsl": {"sensors": ["distance"]},
    "lsl.sensors": ["distance"],
    "lsl.shares": ["texts"],
    "lsl.take": [{"stream": "eyes", "as": "marker"}],
    "lsl.take.stream": "eyes",
    "lsl.take.source_id": "tobii-12",
    "lsl.take.type": "Markers",
    "lsl.take.sensor": "heart",
}
#: What sections within `engagement` are about.
MEANINGS = {
    **{f"engagement.{sign}": "this sign's own sensor and filter" for sign in SIGNS},
    "engagement.joint": "the filter `joint`",
    "phases.name": "what `after` and the log call it",
    "engagement.sound": "what counts as speech",
    "engagement.timeouts": "how long a state may last",
    "engagement.handshake": "how somebody without a name is asked for it",
    "engagement.attention": "what the robot turns to",
}
BLOCKS = """\
## `bml` in a robot file

What behaviours of [BML](../how-to/bml.md) stand for on this robot: a word (a move, an emotion, a
posture) or verbs as in an action. What is not said is as usual.

| key | on the left | example |
|---|---|---|
"""
_BML_EXAMPLES = {
    "gesture": "{BEAT: Explain_1, GREET: {play: wave, speed: 0.8}}",
    "head": "{NOD: Yes_1}",
    "pointing": "{left: point-left, door: {play: point-left}}",
    "faceLexeme": "{SMILE: {eyes: green}, NEUTRAL: {eyes: white}}",
    "faceFacs": "{12: {emotion: happy, intensity: 0.5}}",
    "posture": "{SITTING: {posture: Sit}}",
    "locomotion": "{kitchen: {goto: kitchen}}",
    "targets": "{door: [60, -5]}",
    TOPICS: "eyepi",
}
_VERB_WORDS = {
    "set": "{condition: warm}",
    "unlock": "Speech",
    "wait": 0.5,
    "mark": "smile",
    "note": "came late",
    "lock": "Speech",
    "bml": "greet.xml",
}


def page() -> str:
    """The whole page."""
    schema = experiment_schema(bundled())
    found = _found()
    parts = [HEAD, _section("Top level", "", schema["properties"], schema, found)]
    for name, each in schema["properties"].items():
        properties = _inner(each, schema)
        if name in ("robot", "robots"):
            continue  # drivers have pages of their own
        if properties:
            parts.append(_section(f"`{name}`", name, properties, schema, found))
        if name == "panels":
            action = schema["$defs"]["action"]["properties"]
            own = {field: action[field] for field in ACTION_FIELDS if field in action}
            parts.append(_section("An action", "actions", own, schema, found))
            parts.append(VERBS + "".join(_verbs()))
    parts.append(BLOCKS + "".join(_bml()))
    return "\n".join(parts)


def _section(heading: str, path: str, properties: Any, schema: Any, found: dict[str, Any]) -> str:
    rows = "".join(
        f"| `{name}` | {_kind(each, schema)} | {_default(each)} |"
        f" {_example(where, each, schema, found)} | {_meaning(where, each, schema)} |\n"
        for name, where, each in _keys(path, properties, schema)
    )
    return f"## {heading}\n\n{COLUMNS}{rows}"


def _keys(path: str, properties: Any, schema: Any) -> Iterator[tuple[str, str, Any]]:
    """Name in the table, path, schema; below a section also the keys within its keys."""
    for name, each in properties.items():
        where = f"{path}.{name}".lstrip(".")
        yield name, where, each
        inner = _inner(each, schema) if path not in ("", "panels", "actions") else {}
        for below, more in (inner or {}).items():
            yield f"{name}.{below}", f"{where}.{below}", more


def _inner(each: Any, schema: Any) -> Any:
    """The keys of a mapping, of a list's entries, or of the values of a mapping of names."""
    for candidate in (each, each.get("items"), each.get("additionalProperties")):
        for form in _forms(candidate, schema):
            if form.get("properties"):
                return form["properties"]
    return {}


def _forms(each: Any, schema: Any) -> Iterator[Any]:
    if not isinstance(each, dict):
        return
    if "$ref" in each:
        yield from _forms(schema["$defs"][each["$ref"].rpartition("/")[2]], schema)
        return
    yield each
    for form in (*each.get("oneOf", ()), *each.get("anyOf", ())):
        yield from _forms(form, schema)


def _kind(each: Any, schema: Any) -> str:
    names = dict.fromkeys(name for form in _forms(each, schema) if (name := _named(form, schema)))
    return " or ".join(name for name in names if (name, "seconds") != ("number", [*names][-1]))


def _named(form: Any, schema: Any) -> str:
    """One form in a word or two."""
    words = form.get("enum")
    if words is not None:
        if True in words:
            return "yes or no"
        shown = ", ".join(f"`{word}`" for word in words[:12])
        return shown + (", ..." if len(words) > 12 else "")
    kind = form.get("type")
    if kind == "array":
        return f"list of {_kind(form.get('items', {}), schema)}".removesuffix(" of any")
    if kind in ("integer", "number"):
        low, high = form.get("minimum"), form.get("maximum")
        span = f", {low:g} to {high:g}" if None not in (low, high) else ""
        return f"{'whole number' if kind == 'integer' else 'number'}{span}"
    if "ms|s" in form.get("pattern", ""):
        return "seconds"
    plain = {"object": "mapping", "null": "nothing", "string": "text"}
    return "text" if isinstance(kind, list) else plain.get(kind, "")


def _default(each: Any) -> str:
    if "default" not in each:
        return ""
    value = each["default"]
    return f"`{str(value).lower() if isinstance(value, bool) else value}`"


def _meaning(where: str, each: Any, schema: Any) -> str:
    forms = [each, *_forms(each, schema)]
    text = next((form["description"] for form in forms if "description" in form), "")
    section = where.rpartition(".")[0]
    if not text and section.startswith("engagement."):
        on_enter = section == "engagement.on_enter"
        text = "done on entering this state" if on_enter else "as above, for this sign alone"
    return str(text or MEANINGS.get(where, "")).replace("|", "\\|")


def _example(path: str, each: Any, schema: Any, found: dict[str, Any]) -> str:
    """What a file says, or what it could say."""
    section, _, name = path.rpartition(".")
    above = section.rpartition(".")[0]
    value = EXAMPLES.get(path, found.get(path, each.get("default")))
    if value is None and above:  # a sign's own filter is written as that of all
        value = EXAMPLES.get(f"{above}.*.{name}", found.get(f"{above}.{name}"))
    for form in _forms(each, schema):
        if value is None and form.get("enum"):
            value = form["enum"][0]
    return "" if value is None else f"`{_flow(_plain(value))}`".replace("|", "\\|")


def _plain(value: Any) -> Any:
    """Numbers as such: files are read without guessing."""
    match value:
        case dict():
            return {name: _plain(each) for name, each in value.items()}
        case list():
            return [*map(_plain, value)]
        case bool():
            return str(value).lower()
        case str() if re.fullmatch(r"-?\d+(\.\d+)?", value):
            return float(value) if "." in value else int(value)
    return value


class _Unquoted(yaml.SafeDumper):
    """Writes `No` and `true` without quotes, as an experiment file may."""


_Unquoted.yaml_implicit_resolvers = {
    first: [each for each in resolvers if each[0] != "tag:yaml.org,2002:bool"]
    for first, resolvers in yaml.SafeDumper.yaml_implicit_resolvers.items()
}


def _flow(value: Any) -> str:
    """YAML on one line, short."""
    text = yaml.dump(
        value, Dumper=_Unquoted, default_flow_style=True, width=10**6, allow_unicode=True
    )
    text = text.removesuffix("...\n").strip()
    return text if len(text) <= 60 else text[:57] + "..."


def _found() -> dict[str, Any]:
    """By path, the shortest value that our own experiments give it, the best known file first."""
    files = sorted(EXPERIMENTS.glob("*.yaml"), key=lambda path: (path.name not in FIRST, path.name))
    found: dict[str, Any] = {}
    for file in files:
        content = yaml.load(file.read_text(encoding="utf-8"), yaml.BaseLoader)
        if isinstance(content, dict) and "panels" in content:
            own: dict[str, Any] = {}
            for name, value in content.items():
                _collect(name, value, own)
            found = {**own, **found}
    return found


def _collect(path: str, value: Any, found: dict[str, Any]) -> None:
    if value is None or value == "":
        return
    if path not in found or len(str(value)) < len(str(found[path])):
        found[path] = value
    if isinstance(value, dict):
        for name, inner in value.items():
            _collect(f"{path}.{name}", inner, found)
            if path in ("profiles", "phases"):
                _collect(path, inner, found)
    if isinstance(value, list):
        for entry in value:
            if isinstance(entry, dict):
                for name, inner in entry.items():
                    below = "actions" if path == "panels.actions" else path
                    _collect(f"{below}.{name}", inner, found)


def _bml() -> Iterator[str]:
    for name, words in {**KEYS, TOPICS: TOPICS_WORDS}.items():
        example = _BML_EXAMPLES[name]
        yield f"| `{name}` | {words} | `{example}` |\n"


def _verbs() -> Iterator[str]:
    for verb in (*session_verbs(), BML_VERB, WAIT):
        argument = verb.arguments[0].name if verb.arguments else ""
        value = _VERB_WORDS.get(verb.name, f"<{argument}>")
        yield f"| `{verb.name}` | `{verb.name}: {value}` | {verb.summary} |\n"
