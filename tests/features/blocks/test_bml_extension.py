"""EyePi's extension of BML is played by the same table as its topics."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.bridge.rig import CATALOGUE, EXPERIMENT, bridged, eyepi
from woz_tui.bridge.ros_data import RosDataError
from woz_tui.bridge.topic_table import load_table
from woz_tui.client import connect
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.features.blocks.behaviour_calls import BehaviourCalls, UnplayableError
from woz_tui.features.blocks.bml_block import Behaviour, read_block
from woz_tui.features.blocks.realizer import BmlRealizer, Feedback
from woz_tui.features.blocks.robot_tables import robot_calls
from woz_tui.features.blocks.section import BLOCKS
from woz_tui.protocol.messages import Json

BLOCK = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0"'
    ' xmlns:e="http://hmi.ewi.utwente.nl/eyepiengine" id="b">{}</bml>'
)


def behaviour(inner: str) -> Behaviour:
    """The only one of a block."""
    block = read_block(BLOCK.format(inner))
    assert not block.warnings
    [only] = block.behaviours
    return only


def calls() -> BehaviourCalls:
    """What behaviours stand for on EyePi."""
    experiment, _ = eyepi()
    return robot_calls(
        experiment.drivers, BLOCKS.of(experiment).tables, CATALOGUE, EXPERIMENT.parent
    )


def played_verbs(inner: str) -> list[tuple[str, str, str, dict[str, Json]]]:
    """From which point until which each verb is played, with what."""
    found = calls().calls(behaviour(inner))
    return [(each.point, each.until, each.verb, dict(each.args)) for each in found]


@pytest.mark.parametrize(
    ("attributes", "verb", "args"),
    [
        ('x="0.5" y="-0.5"', "gaze", {"yaw": -28.125, "pitch": -22.5}),
        ("", "gaze", {"yaw": 0.0, "pitch": 0.0}),
        ('x="9" y="9"', "gaze", {"yaw": -56.25, "pitch": 45.0}),
        ('offsetAngle="10" offsetDirection="LEFT"', "gaze", {"yaw": 10.0, "pitch": 0.0}),
        ('offsetAngle="10" offsetDirection="NONE"', "gaze", {"yaw": 0.0, "pitch": 0.0}),
        ('x="0.5" y="-0.5" influence="HEAD"', "gaze", {"yaw": -28.125, "pitch": -22.5}),
        ('x="0.5" y="-0.5" influence="EYES"', "look", {"x": -0.5, "y": 0.5}),
    ],
)
def test_a_look_goes_to_a_place_of_the_picture(
    attributes: str, verb: str, args: dict[str, Json]
) -> None:
    home = dict.fromkeys(args, 0.0)
    assert played_verbs(f'<e:eyePiGaze id="g" {attributes}/>') == [
        ("start", "ready", verb, args),
        ("relax", "end", verb, home),
    ]
    assert played_verbs(f'<e:EyePiGazeShift id="g" {attributes}/>') == [
        ("start", "end", verb, args)
    ]


def test_a_message_is_played_as_from_a_planner() -> None:
    message = '<e:directRosMessage id="m" topic="{}"><data>{}</data></e:directRosMessage>'
    sequence = '<sequence type="int">4</sequence><request type="float">0.1</request>'
    assert played_verbs(message.format("ram/animation/hmmm/sequence", sequence)) == [
        ("start", "end", "play", {"move": "shake"})
    ]
    places = "".join(
        f'<{name} type="tuple"><e type="{kind}">{a}</e><e type="{kind}">{b}</e></{name}>'
        for name, kind, a, b in (
            ("locationsX", "float", 1, 0),
            ("locationsY", "float", 0, 0),
            ("weights", "int", 10, 9),
        )
    )
    assert played_verbs(message.format("/ram/animation/hmmm/saliency", places)) == [
        ("start", "end", "gaze", {"yaw": -56.25, "pitch": 0.0})
    ]


@pytest.mark.parametrize(
    ("topic", "data", "why"),
    [
        ("ram/animation/hmmm/emotions", "<data/>", "did you mean 'ram/animation/hmmm/emotion'"),
        ("ram/animation/hmmm/emotion", "<data><valence type='str'>x</valence></data>", "no float"),
        ("ram/animation/hmmm/sequence", "<data/>", "no sequence 0"),
        ("ram/animation/hmmm/emotion", "", "no XML"),
    ],
)
def test_a_message_that_means_nothing_is_told(topic: str, data: str, why: str) -> None:
    message = f'<e:directRosMessage id="m" topic="{topic}">{data}</e:directRosMessage>'
    with pytest.raises(UnplayableError, match=why):
        calls().calls(behaviour(message))


def test_a_robot_without_such_a_table_says_so() -> None:
    experiment, _ = eyepi()
    without = robot_calls(experiment.drivers, {}, CATALOGUE, EXPERIMENT.parent)
    with pytest.raises(UnplayableError, match="topics"):
        without.calls(behaviour('<e:EyePiGazeShift id="g" x="1"/>'))


async def test_a_block_of_the_extension_is_played_and_told(tmp_path: Path) -> None:
    async with bridged(tmp_path) as planner, connect(planner.host.path, name="planner") as client:
        told: list[Feedback] = []
        realizer = BmlRealizer(client, told.append)
        await realizer.perform(
            BLOCK.format(
                '<e:EyePiGazeShift id="g" x="0.5" y="0" end="0.4"/>'
                '<e:directRosMessage id="m" topic="ram/animation/hmmm/sequence" start="g:end">'
                '<data><sequence type="int">3</sequence></data></e:directRosMessage>'
            )
        )
        await planner.until(lambda: any(each.attributes.get("id") == "b:end" for each in told))
        assert not [each for each in told if each.name == "warningFeedback"]
        assert [line.verb for line in planner.commands("gaze", "play")] == ["gaze", "play"]
        ids = [each.attributes.get("id") for each in told]
        assert ids.index("b:g:end") < ids.index("b:m:end")
        await realizer.close()


@pytest.mark.parametrize(
    ("table", "why"),
    [
        ("takes: {a: {fields: {x: number}}}", "'number' is no type"),
        ("takes: {a: {fields: {x: int}, plays: [{verb: v, args: {y: {field: z}}}]}}", "'z'"),
        ("takes: {a: {fields: {x: int}, sequences: {1: {verb: v}}}}", "is missing"),
        ("takes: {a: {fields: {x: int}, plays: [{verb: v, args: {y: {field: x, to: [0, 1]}}}]}}",
         "both from and to"),
        ("bridge: my_robot", "letters and digits"),
        ("answer: {}", "did you mean 'answers'"),
        ("answers: {a: {tells: jokes}}", "general"),
        ("answers: {a: {tells: gaze, shows: {x: 1}}}", "belong to state"),
        ("answers: {a: {tells: state, fields: {x: int}, shows: {y: 1}}}", "none of the fields"),
        ("answers: {a: {tells: state, fields: {x: [int]}, shows: {x: 1}}}", "none of the fields"),
        ("answers: {a: {tells: state, fields: {x: [int]}, shows: {x.0: 1, x.2: 1}}}", "gaps"),
        ("takes: {a: {fields: {inputId: str, locationsX: [float], locationsY: [float], weights:"
         " [int]}, looks: {verb: gaze, args: {yaw: {field: locationsX.0}}}}}", "locationsX.0"),
        ("takes: {a: {fields: {x: int}, plays: [{verb: v, args: {y: {field: x.0}}}]}}", "'x.0'"),
        ("[1]", "a table of topics"),
    ],
)  # fmt: skip
def test_a_wrong_table_is_told_with_its_place(tmp_path: Path, table: str, why: str) -> None:
    file = tmp_path / "t.yaml"
    file.write_text(table)
    with pytest.raises(ExperimentError, match=why):
        load_table(str(file))
    robot = (EXPERIMENT.parent / "robots" / "eyepi.yaml").read_text()
    (tmp_path / "robot.yaml").write_text(
        robot.replace("topics: eyepi", "topics: t.yaml").replace("../moves", str(tmp_path))
    )
    experiment = tmp_path / "e.yaml"
    experiment.write_text(
        "title: T\nrobot: robot.yaml\n"
        "panels: [{title: P, actions: [{key: a, label: A, play: nod}]}]\n"
    )
    with pytest.raises(ExperimentError, match=why) as caught:
        load(experiment, CATALOGUE)
    assert str(file) in str(caught.value)


@pytest.mark.hypothesis
@given(data=st.data())
def test_whatever_a_message_holds_it_is_verbs_or_refused(data: st.DataObject) -> None:
    _, table = eyepi()
    topic = data.draw(st.sampled_from([*table.takes]))
    names = st.sampled_from([*table.takes[topic].fields])
    numbers = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(2**62), 2**62)
    values = (
        numbers | st.text(max_size=5) | st.booleans() | st.lists(numbers, max_size=4).map(tuple)
    )
    message = data.draw(st.dictionaries(names, values))
    with contextlib.suppress(RosDataError):
        for call in table.calls(topic, message):
            assert call.verb
            json.dumps(call.args, allow_nan=False)
