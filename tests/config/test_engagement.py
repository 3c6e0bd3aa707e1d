"""The section `engagement`: settings, effects by state, verbs, and who gives the signs."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.config.catalogue import CATALOGUE, Voice, VoiceSettings
from tests.config.reading import HEAD, HELLO, ROBOT, errors, panel, read_experiment, warned
from woz_tui.config import engagement_words as shapes
from woz_tui.config.actions import ACTION_FIELDS
from woz_tui.config.annotated_decoder import settings_from_texts
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.experiment import Action, Call, Engagement, Experiment, ParallelCalls, Wait
from woz_tui.config.loading import load
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.config.session_verbs import engagement_verbs
from woz_tui.config.sign_values import argument_problem, sign_value
from woz_tui.drivers.contract import Offer
from woz_tui.features.profiles.section import PROFILES
from woz_tui.sensing.filters import least
from woz_tui.sensing.state_machine import EDGES, OUTCOMES, Event, State

GOOD = Path(__file__).parent / "good" / "everything.yaml"


def section(folder: Path, text: str, *actions: str, head: str = HEAD) -> Engagement:
    experiment = read_experiment(
        folder, panel(*(actions or [HELLO]), head=f"{head}engagement: {text}\n")
    )
    assert experiment.engagement is not None
    return experiment.engagement


def steps_of(action: Action) -> list[list[tuple[str, object]] | float]:
    """Steps as verbs with their arguments, and pauses."""
    return [
        step.seconds if isinstance(step, Wait) else [(c.verb, dict(c.args)) for c in step.calls]
        for step in action.steps
    ]


@pytest.fixture(scope="module")
def everything() -> Experiment:
    return load(GOOD, CATALOGUE)


@pytest.fixture(scope="module")
def settled(everything: Experiment) -> Engagement:
    assert everything.engagement is not None
    return everything.engagement


# -- settings -----------------------------------------------------------------------------------


def test_settings_are_those_of_the_file(settled: Engagement) -> None:
    settings = settled.settings
    assert (settings.start, settings.signs, settings.filter) == (
        "hold",
        ("presence", "gaze"),
        "joint",
    )
    assert (settings.rate, settings.samples, settings.threshold) == (5.0, 10, 0.7)
    assert (settings.stale, settings.gaze.stale, settings.presence.stale) == (0.9, 2.0, None)
    assert (settings.gaze.rate, settings.presence.rate) == (3.0, None)
    assert settings.distance.sensor == "joint.pan"
    assert settings.timeouts.listening is None
    assert settings.timeouts.lost == 0.5
    assert settings.handshake.yes == ("Yes", "On")
    assert settings.visitors == str(GOOD.parent / "people.json")


def test_an_empty_section_has_the_papers_defaults_and_none_is_no_model(tmp_path: Path) -> None:
    empty = section(tmp_path, "{}")
    assert empty == Engagement(EngagementSettings())
    assert read_experiment(tmp_path, panel(HELLO)).engagement is None


@given(st.integers(0, 1000), st.integers(1, 1000))
def test_thresholds_are_the_decimals_that_were_typed(thousandths: int, places: int) -> None:
    """E2: k is counted in exact arithmetic, so 0.7 of 10 is 7 and not 8."""
    typed = {"threshold": f"{thousandths / 1000:.3f}", "samples": str(places)}
    settings = settings_from_texts(EngagementSettings, typed, Path())
    assert least(settings.threshold, settings.samples) == -(-thousandths * places // 1000)


@pytest.mark.parametrize("typed", ["0.7", ".7", "0.70", "7e-1"])
def test_a_threshold_can_be_typed_in_several_ways(tmp_path: Path, typed: str) -> None:
    threshold = section(tmp_path, f"{{threshold: {typed}}}").settings.threshold
    assert Fraction(str(threshold)) == Fraction(7, 10)


def test_the_names_of_states_and_outcomes_are_those_of_the_machine() -> None:
    assert (*shapes.STATES, shapes.STOPPED) == tuple(State)
    assert set(shapes.OUTCOMES) == set(OUTCOMES)
    assert len(shapes.OUTCOMES) == len(set(shapes.OUTCOMES))


# -- effects ------------------------------------------------------------------------------------


def test_effects_are_actions_of_their_own(settled: Engagement) -> None:
    assert set(settled.effects) == {"Wait", "PersonDetected", "EngagedWithKnown"}
    entered = settled.effects["PersonDetected"]
    assert (entered.name, entered.key, entered.panel) == ("on PersonDetected", "", "")
    assert steps_of(entered) == [
        [("say", {"text": "Come nearer"})],
        0.5,
        [("say", {"text": "Hi"}), ("play", {"move": "nod"})],
    ]
    assert steps_of(settled.effects["Wait"]) == [[("home", {})]]
    assert steps_of(settled.effects["EngagedWithKnown"]) == [[("say", {"text": "Hello {visitor}"})]]
    assert entered.place.line > 1


def test_actions_of_panels_are_named(settled: Engagement) -> None:
    assert settled.plays == {"PersonDetected": ("No",), "stop": ("No key",)}


def test_an_effect_can_say_whom_it_is_for(tmp_path: Path) -> None:
    two = "title: T\nrobots: {left: simulated, right: simulated}\n"
    effect = "{on_enter: {Wait: {emotion: sad, on: [left, right]}}}"
    action = section(tmp_path, effect, "{key: m, label: M, mark: x}", head=two).effects["Wait"]
    (step,) = action.steps
    assert isinstance(step, ParallelCalls)
    assert [call.driver for call in step.calls] == ["left.robot", "right.robot"]


def test_effects_are_not_among_the_actions(tmp_path: Path) -> None:
    text = panel(HELLO, head=f"{HEAD}engagement: {{on_enter: {{Wait: {{say: Hi}}}}}}\n")
    experiment = read_experiment(tmp_path, text)
    assert experiment.action("on Wait") is None
    found = errors(tmp_path, f"{text}script: [on Wait]\n")
    assert len(found) == 1
    assert "script[0]: there is no action 'on Wait'" in found[0]


def test_an_action_may_have_the_name_of_an_effect_that_there_is_not(tmp_path: Path) -> None:
    named = "{key: w, label: on Wait, say: Hi}"
    assert section(tmp_path, "{on_enter: {Wait: on Wait}}", named).plays == {"Wait": ("on Wait",)}


def test_an_effect_on_a_locked_action_or_behind_a_pause_is_warned_of(tmp_path: Path) -> None:
    locked = "{key: l, label: Locked, say: Hi, locked: on}"
    effects = "{on_enter: {Wait: [Locked, {wait: 1}, Hello]}}"
    found = warned(tmp_path, effects, locked, HELLO, sees="presence, gaze, distance")
    assert found == [
        "engagement.on_enter.Wait[0]: 'Locked' is locked and cannot be played",
        "engagement.on_enter.Wait[2]: 'Hello' starts at once and does not wait: actions run in"
        " parallel to the steps",
    ]


def test_the_visitor_is_a_variable_where_there_is_a_model(tmp_path: Path) -> None:
    greets = panel("{key: h, label: H, say: 'Hello {visitor}'}")
    assert not errors(tmp_path, greets + "engagement: {}\n")
    assert "there is no variable {visitor}" in errors(tmp_path, greets)[0]
    own = greets + "variables: {visitor: you}\n"
    assert read_experiment(tmp_path, own).variables == {"visitor": "you"}
    (found,) = errors(tmp_path, own + "engagement: {}\n")
    assert found.endswith("'visitor' is reserved for the session; choose another name")


# -- verbs --------------------------------------------------------------------------------------


def test_the_verbs_go_to_the_model(everything: Experiment) -> None:
    actions = {action.name: action for action in everything.panels[2].actions}
    calls = {
        name: call
        for name, action in actions.items()
        for step in action.steps
        if isinstance(step, ParallelCalls)
        for call in step.calls
    }
    assert {call.driver for call in calls.values()} == {ENGAGEMENT}
    assert {call.verb for call in calls.values()} == {verb.name for verb in engagement_verbs()}
    assert _plain(calls["Near"]) == ("sense", {"sign": "distance", "value": "0.8"})
    assert _plain(calls["Here"]) == ("sense", {"sign": "presence", "value": "on"})
    assert _plain(calls["Hold"]) == ("engagement", {"run": "hold"})
    assert _plain(calls["Slow"]) == (
        "filter",
        {"sign": "gaze", "kind": "joint", "samples": 12, "threshold": 0.7},
    )
    assert _plain(calls["Met"]) == ("handshake", {"what": "ok", "code": "V07"})


def test_what_stands_beside_a_verb_is_never_the_actions_own() -> None:
    """`{handshake: ok, name: V07}` would call the action so, and nobody would be introduced."""
    for verb in engagement_verbs():
        assert not {argument.name for argument in verb.arguments} & set(ACTION_FIELDS), verb.name


def _plain(call: Call) -> tuple[str, dict[str, object]]:
    return call.verb, dict(call.args)


def test_all_verbs_are_brief_so_that_none_waits_for_another() -> None:
    assert all(verb.brief and not verb.drives for verb in engagement_verbs())


@pytest.mark.parametrize("to", [*State, *dict.fromkeys(edge.outcome for edge in EDGES)])
def test_every_transition_can_be_forced_by_a_key(tmp_path: Path, to: str) -> None:
    """E7: every state and every outcome."""
    section(tmp_path, "{}", f"{{key: f, label: F, force: {to}}}")


def test_events_are_no_verbs() -> None:
    assert not {verb.name for verb in engagement_verbs()} & set(Event)


@pytest.mark.parametrize(
    ("sign", "value", "meant"),
    [
        ("presence", "on", True),
        ("gaze", "off", False),
        ("distance", "on", True),
        ("distance", "0.8", 0.8),
        ("distance", "0", 0.0),
        ("identity", "V07", "V07"),
        ("identity", "Unknown", "Unknown"),
        ("all", "off", False),
        *((sign, "sensor", None) for sign in (*shapes.SIGNS, "all")),
    ],
)
def test_what_the_wizard_may_say_of_a_sign(sign: str, value: str, meant: object) -> None:
    """E7: every sensor value can be forced, and given back."""
    assert sign_value(sign, value) == meant
    assert type(sign_value(sign, value)) is type(meant)
    assert argument_problem("sense", {"sign": sign, "value": value}) == ""


@given(st.sampled_from((*shapes.SIGNS, "all")), st.text(max_size=12))
def test_any_other_value_is_refused_with_a_sentence(sign: str, value: str) -> None:
    why = argument_problem("sense", {"sign": sign, "value": value})
    try:
        meant = sign_value(sign, value)
    except ValueError as error:
        assert str(error).startswith(f"{sign} is ")
        assert why in ("", str(error))  # with a variable in it, nobody knows yet
    else:
        assert why == "" or sign == "identity"  # where no name can be like this
        assert meant is None or isinstance(meant, bool | float | str)


@pytest.mark.parametrize("value", ["nan", "inf", "-1", "", " ", "1,5", "near"])
def test_a_distance_is_a_finite_number_of_metres(value: str) -> None:
    with pytest.raises(ValueError, match="distance is on, off, sensor or a number of metres"):
        sign_value("distance", value)


def test_a_value_with_a_variable_is_known_only_later() -> None:
    assert argument_problem("sense", {"sign": "distance", "value": "{metres}"}) == ""
    assert argument_problem("sense", {"sign": "distance", "value": "metres"}) != ""


@pytest.mark.parametrize(
    ("action", "sentence"),
    [
        ("visitor: Unknown", '"Unknown" cannot be a name'),
        ("visitor: 'sensor '", "cannot be a name: it is a command"),
        ("visitor: ''", "a visitor's name is empty"),
        ("visitor: '?!'", "has no letters and no digits"),
        ("handshake: ok, code: unknown", '"unknown" cannot be a name'),
        ("sense: identity, value: '?'", "has no letters and no digits"),
        (f"visitor: V1, age_group: {'a' * 33}", "an age group has 33 characters"),
        ("filter: {sign: all, kind: median}", "filter: {sign: distance, kind: median}"),
        ("filter: all", "changes nothing"),
        ("filter: joint", "filter: {sign: all, kind: joint}"),
        ("filter: median", "filter: {sign: distance, kind: median}"),
    ],
)
def test_what_the_model_would_refuse_is_found_in_the_file(
    tmp_path: Path, action: str, sentence: str
) -> None:
    head = f"{HEAD}engagement: {{}}\n"
    (found,) = errors(tmp_path, panel(f"{{key: v, label: V, {action}}}", head=head))
    assert sentence in found


@pytest.mark.parametrize(
    "action",
    [
        "visitor: V07",
        "visitor: '{participant}'",
        "handshake: ok",
        "sense: identity, value: unknown",
        "sense: identity, value: sensor",
        "filter: {sign: all, samples: 3}",
        "filter: {sign: distance, kind: median}",
    ],
)
def test_what_the_model_takes_passes_the_check(tmp_path: Path, action: str) -> None:
    head = f"{HEAD}engagement: {{}}\n"
    assert not errors(tmp_path, panel(f"{{key: v, label: V, {action}}}", head=head))


def test_a_confirmation_without_the_name_is_warned_of(tmp_path: Path) -> None:
    text = "{signs: [gaze], handshake: {confirm: 'Is that %s?'}}"
    (found,) = warned(tmp_path, text % "right", sees="gaze")
    assert found.startswith("engagement.handshake.confirm: does not repeat what was understood")
    assert not warned(tmp_path, text % "you, {name}", sees="gaze")


def test_a_profile_may_allow_the_models_verbs(tmp_path: Path) -> None:
    profiles = "profiles: {child: {verbs: [toggle, engagement]}}\n"
    text = panel(HELLO, head=f"{HEAD}engagement: {{}}\n{profiles}")
    assert PROFILES.of(read_experiment(tmp_path, text))["child"].verbs == {"toggle", "engagement"}
    (found,) = errors(tmp_path, panel(HELLO, head=HEAD + "profiles: {child: {verbs: [toggle]}}\n"))
    assert "no driver offers 'toggle'" in found


def test_a_verb_of_a_driver_with_the_same_name_is_warned_of(tmp_path: Path) -> None:
    class Rival(Voice):
        @classmethod
        def offer(cls, settings: VoiceSettings) -> Offer:
            return replace(
                super().offer(settings),
                verbs=(*super().offer(settings).verbs, engagement_verbs()[0]),
            )

    text = panel(HELLO, head=f"{ROBOT}engagement: {{signs: [gaze], gaze: {{sensor: joint.pan}}}}\n")
    (tmp_path / "e.yaml").write_text(text)
    experiment = load(tmp_path / "e.yaml", {**CATALOGUE, "voice": Rival})
    assert [problem.message for problem in experiment.warnings] == [
        "voice offers 'toggle' too; in actions it means the engagement model's"
    ]


def test_a_drivers_buttons_may_ask_for_the_models_verbs(tmp_path: Path) -> None:
    head = (
        "title: T\nrobot: {drivers: {eye: {type: camera, sees: [], buttons: {toggle: %s}},"
        " voice: {type: voice}}}\n"
    )
    assert not warned(tmp_path, "{signs: [gaze]}", head=head % "gaze")
    gase = panel(HELLO, head=head % "gase" + "engagement: {}\n")
    assert "'gase' is no sign; did you mean 'gaze'?" in errors(tmp_path, gase)[0]
    without = panel(HELLO, head=head % "gaze")
    assert "no driver offers 'toggle'" in errors(tmp_path, without)[0]


def test_never_is_null(tmp_path: Path) -> None:
    engagement = section(tmp_path, "{timeouts: {approach: null, listening: null, talking: null}}")
    limits = engagement.settings.timeouts
    assert (limits.approach, limits.listening, limits.talking) == (None, None, None)
