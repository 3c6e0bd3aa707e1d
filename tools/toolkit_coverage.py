"""Which test shows which acceptance statement: the page docs/reference/toolkit-coverage.md.

Tests bear `@pytest.mark.toolkit("R2", "L4")` (`tools/marked_tests.py`).
"""

from __future__ import annotations

from tools import marked_tests as marked

MARK = "toolkit"

#: The statements, in the words of this project. They follow the requirements of a thesis about a
#: toolkit for robot puppeteers (J. Oosterkamp); numbers are its own where it gives one.
STATEMENTS: dict[str, str] = {
    "G1": "modules are joined by messages; losing one leaves the others running",
    "G3": "everything runs without a robot",
    "G5": "demo, direct and outside control, tracking and saccade following can be reached",
    "G7": "a control counts once it has passed the robot's value; a first touch moves nothing",
    "R1": "three joints with their ranges; what lies outside ends at the limit",
    "R2": "no setpoint is ever faster than its joint: 360, 250 and 320 deg/s",
    "R3": "a joint's axis is said in the file; shaking turns the joint that pans",
    "R4": "whatever is commanded, setpoints stay finite, within range and speed, and the loop runs",
    "R5": "the wanted and the reachable setpoint are both known and can be seen",
    "R6": "another robot, of five joints, is a file; a wrong file is refused with its line",
    "L1": "low level: joints and face directly, through the safety layer",
    "L2": "middle level: gaze, pose, home, moves, breathing and blinking",
    "L3": "high level: modes, which use the levels below",
    "L4": "a gaze is a straight line, complete in its time or as soon as the speed allows",
    "L5": "a gaze at a point in space passes within 2 degrees of it, or is the nearest there is",
    "L6": "home is reached from anywhere, and the face stays as it is",
    "L7": "moves at any speed begin and end at the pose held, without a jump",
    "L8": "breathing has its frequency and amplitude about the pose, within the limits",
    "L9": "blinking closes and opens the eyes and changes nothing else; its rate can be set",
    "M1": "normal is the mode at the start",
    "M2": "an input counts in exactly the modes of the table",
    "M3": "leaving a mode leads in a straight line to the pose that the controls want now",
    "M4": "no change between two modes makes a jump or loses a stop",
    "M5": "the demo shows everything in a minute, in order, and returns by itself",
    "M6": "tracking and saccade following keep to their own rows below",
    "F1": "a face is a pure function to 24 x 16 lights; device and screen get the same picture",
    "F2": "six emotions are six clearly different pictures",
    "F3": "intensity leads from neutral to the whole emotion in steps that can be seen",
    "F4": "valence and arousal name one emotion and its strength, all round the circle",
    "F5": "whichever control was touched last wins, and what is shown follows",
    "F6": "the eyes move over the matrix and never leave it",
    "F7": "the crash plays on the face alone and gives the emotion back",
    "F8": "the look is iconic and pleasant",
    "O1": "pictures are searched fast enough: 32 a second at little cost",
    "O2": "what counts as the colour, pixel by pixel",
    "O3": "the middle and the size of what was found; nothing found is no error",
    "O4": "the head turns to it, follows it and comes to rest on it",
    "O5": "unseen it becomes sad and goes home; seen again it is happy; flicker changes nothing",
    "O6": "while tracking there is no breathing, and only the stop counts",
    "S1": "the eyes jump, the head follows smoothly until the eyes are in the middle again",
    "S2": "a new jump on the way makes none in the joints; beyond the range the eyes keep the rest",
    "S3": "saccade following has a button, which can be moved",
    "P1": "every trait can be changed at any time without a jump",
    "P2": "one control changes the pace of breathing and of moves",
    "P3": "smoothing: slower but never over the target, and always there in the end",
    "P4": "compression draws every pose towards the middle and never widens",
    "P5": "personalities have names, come back exactly and differ between two robots",
    "K1": "every control of the panel does what its map says, from bytes on the wire",
    "K2": "the state of all controls can be seen, on the screen and by their lights",
    "K3": "several controls at once: nothing is lost, nothing is late",
    "E1": "other software plays moves, gaze, emotion, eyes and joints, stops, and is answered",
    "E2": "priorities between the levels are decided and published",
    "E3": "nonsense, floods and lost connections of other software are survived",
    "E4": "the wizard's stop beats everything",
    "V1": "the drawing equals the kinematics and the face equals the device's",
    "V2": "the reference poses of the thesis come out as computed by hand",
    "V3": "screen and robot differ by nothing but the joints' speed",
    "U1": "two robots in one show, played live and again from its recording",
    "U3": "profiles lock or hide what a wizard shall not use",
    "U4": "ten minutes without a hand: alive, and no drift",
    "U5": "hours of random input: memory flat, ticks in time",
    "X1": "one control moves several things that have no joint in common, within all limits",
    "X2": "layers recorded one over the other replay in step; each can be muted and redone",
    "X3": "key frames can be made, moved and deleted; files replay exactly",
    "X4": "a 6-D mouse, a Wii remote and a motion sensor play it, and let go is at rest",
    "X5": "each emotion has its sound, intensity changes it, and it can be muted",
}
#: Nobody can test these.
MATTERS_OF_TASTE = frozenset({"F8"})
#: These hold if others do.
FOLLOWS = {"M6": ("O4", "O5", "O6", "S1", "S2")}


def uncovered() -> list[str]:
    """Statements that no test shows, but for matters of taste."""
    covered = {shown.statement for shown in marked.found(MARK)}
    covered |= {name for name, parts in FOLLOWS.items() if covered.issuperset(parts)}
    return [name for name in STATEMENTS if name not in covered | MATTERS_OF_TASTE]


def page() -> str:
    """The whole page."""
    tests = marked.by_statement(marked.found(MARK))
    names = [*STATEMENTS, *sorted(tests.keys() - STATEMENTS.keys())]
    rows = [f"| {n} | {STATEMENTS.get(n, '')} | {_cell(n, tests.get(n, {}))} |" for n in names]
    return "\n".join([*_HEAD, *rows, ""])


_HEAD = (
    "# What the body promises, and which test shows it",
    "",
    "Look up here what a puppeteer may rely on. The statements follow J. Oosterkamp's thesis on a",
    "toolkit for robot puppeteers. Each row names the tests that bear the statement's name;",
    "`pytest -m toolkit` runs them all. `make generated` writes this page.",
    "",
    "| | statement | tests |",
    "|---|---|---|",
)


def _cell(name: str, files: dict[str, list[str]]) -> str:
    if name in MATTERS_OF_TASTE:
        return "a matter of taste: look at [the faces](../images/faces.svg)"
    if not files and name in FOLLOWS:
        return f"see {', '.join(FOLLOWS[name])}"
    return marked.cell(files)
