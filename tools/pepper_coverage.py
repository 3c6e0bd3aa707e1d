"""Which test shows which call of NAOqi and which key of a WoZ4U file, and the robot's settings.

Tests bear `@pytest.mark.naoqi("ALMotion.moveTo")` and `@pytest.mark.woz4u("pepper_ips")`.
"""

from __future__ import annotations

from collections import Counter

from woz_drivers.pepper.model import PEPPER

from tools import marked_tests as marked
from woz_tui.config.woz4u.woz4u_keys import AUTONOMY, TOP_LEVEL
from woz_tui.drivers.robot_settings import RobotSetting


def _of_settings() -> dict[str, str]:
    """The calls that read and set the robot's settings."""
    verbs = Counter(one.verb for one in PEPPER.settings.values())
    reached: dict[str, list[str]] = {}
    for one in PEPPER.settings.values():
        shared = verbs[one.verb] > 1
        verb = f"`{one.verb}: {{{one.argument}: ...}}`" if shared else f"`{one.verb}`"
        for call, how in ((one.put, verb), (one.get, f"setting `{one.name}`")):
            if call:
                reached.setdefault(".".join(call[:2]), []).append(how)
    return {call: ", ".join(ways) for call, ways in reached.items()}


#: Every call of the robot's own software that a wizard of a Pepper needs, and how it is reached.
CALLS: dict[str, str] = {
    **_of_settings(),
    "ALBasicAwareness.pauseAwareness": "the stop, of a robot that refuses the mode Head",
    "ALBasicAwareness.resumeAwareness": "the release after that",
    "ALTextToSpeech.say": "`say` with `plain: true`, `read`",
    "ALTextToSpeech.stopAll": "the stop, a `say` cut short",
    "ALTextToSpeech/TextDone": "`naoqi: ALMemory.getData`; a `say` ends with its own call",
    "ALAnimatedSpeech.say": "`say`, `read`",
    "tag.vct": "`say`",
    "tag.rspd": "`say`",
    "tag.pau": "`say`",
    "tag.vol": "`say`",
    "tag.rst": "`say`",
    "tag.run": "`say`",
    "tag.start": "`say`",
    "tag.stop": "`say`",
    "tag.wait": "`say`",
    "ALAnimationPlayer.run": "`play`",
    "ALMotion.wakeUp": "`torque: on`",
    "ALMotion.rest": "`torque: off`, the end of a session",
    "ALMotion.moveTo": "`drive`",
    "ALMotion.stopMove": "a `drive` cut short, the stop",
    "ALMotion.killAll": "the stop",
    "ALMotion.getRobotVelocity": "the stop: whether it stands",
    "ALMotion.setStiffnesses": "`gaze`, `nudge`, `hip`, `pose`",
    "ALMotion.angleInterpolation": "`pose`",
    "ALRobotPosture.goToPosture": "`posture`, `home`",
    "ALTabletService.showWebview": "`screen`",
    "ALTabletService.hideWebview": "`tablet: hide`",
    "ALTabletService.enableWifi": "`tablet: wifi`",
    "ALTabletService.playVideo": "`screen` with a video",
    "ALTabletService.onTouchDownRatio": "readings `touch.x`, `touch.y`",
    "ALTabletService.onTouchMove": "readings `touch.x`, `touch.y`",
    "ALTabletService.onTouchUp": "readings `touch.x`, `touch.y`",
    "ALTabletService.videoFinished": "the default picture comes back",
    "ALAudioPlayer.loadFile": "`sound`",
    "ALAudioPlayer.play": "`sound`",
    "ALAudioPlayer.playWebStream": "`sound` with a file of this machine, or an address",
    "ALAudioPlayer.setVolume": "`sound: {volume: ...}`",
    "ALAudioPlayer.stopAll": "the stop, a `sound` cut short",
    "ALAudioPlayer.unloadAllFiles": "the end of a session",
    "ALAudioPlayer.getLoadedFilesIds": "`sound`: what is loaded still",
    "ALLeds.fadeRGB": "`eyes`",
    "ALLeds.setIntensity": "`eyes_brightness`",
    "ALLeds.getIntensity": "setting `eyes`",
    "ALLeds.randomEyes": "`eyes_animation: random`",
    "ALLeds.rasta": "`eyes_animation: rasta`",
    "ALLeds.rotateEyes": "`eyes_animation: rotate`",
    "ALAudioDevice.enableEnergyComputation": "reading `loudness`",
    "ALAudioDevice.getFrontMicEnergy": "reading `loudness`",
    "ALAudioDevice.setClientPreferences": "`listen`",
    "ALAudioDevice.subscribe": "`listen`",
    "ALAudioDevice.unsubscribe": "`listen: off`",
    "ALAudioDevice.setParameter": "`talk`: the rate of the loudspeaker",
    "ALAudioDevice.sendRemoteBufferToOutput": "`talk`",
    "ALAudioDevice.flushAudioOutputs": "the stop of `talk`",
    "ALAudioRecorder.startMicrophonesRecording": "`record_sound: on`",
    "ALAudioRecorder.stopMicrophonesRecording": "`record_sound: off`",
    "ALVideoDevice.subscribe": "the camera's screen, `picture`",
    "ALVideoDevice.getImageRemote": "the camera's screen, `picture`",
    "ALVideoDevice.unsubscribe": "the camera's screen closed",
    "Device/SubDeviceList/Platform/Front/Sonar/Sensor/Value": "reading `distance`",
    "PeoplePerception/VisiblePeopleList": "readings `presence`, `people`",
    "PeoplePerception/Person/<id>/Distance": "reading `nearest`",
    "PeoplePerception/Person/<id>/IsLookingAtRobot": "reading `gaze`",
    "FaceDetected": "reading `identity`",
    "ALFaceCharacteristics.subscribe": "`senses: {face: true}`: readings `looks.age` and the like",
    "ALMood.subscribe": "`senses: {mood: true}`",
    "ALMood.currentPersonState": "readings `looks.valence`, `looks.attention`",
    "ALSoundLocalization/SoundLocated": "reading `direction`",
    "ALFaceDetection.learnFace": "`learn_face`",
    "ALFaceDetection.getLearnedFacesList": "`face_consent: {given: false}`",
    "ALFaceDetection.forgetPerson": "`face_consent: {given: false}`",
    **{
        f"ALSpeechRecognition.{method}": "`recognition: {phrases: [...]}`"
        for method in ("setVocabulary", "setLanguage", "pause", "subscribe", "unsubscribe")
    },
    "WordRecognized": "speech as text",
    "SpeechDetected": "where speech begins and ends",
}

#: Every key of a WoZ4U file that stands for something here.
KEYS = (
    *TOP_LEVEL,
    *AUTONOMY,
    *("is_default_img", "is_default", "key_comb", "tooltip", "title"),
)
#: Name of a table -> the mark of its tests, its rows.
TABLES = {"calls": ("naoqi", [*CALLS]), "keys": ("woz4u", [*KEYS])}


def uncovered(table: str) -> list[str]:
    """Rows of a table that no test shows."""
    mark, rows = TABLES[table]
    shown = {one.statement for one in marked.found(mark)}
    return [name for name in rows if name not in shown]


def unknown(table: str) -> list[str]:
    """Marks that name no row."""
    mark, rows = TABLES[table]
    return sorted({one.statement for one in marked.found(mark)} - {*rows})


def page() -> str:
    """The page with the settings, the calls and the keys."""
    return f"""\
# Pepper: every setting, call and key, and which test shows it

Look up here which verb changes a setting of the robot, how a wizard reaches a call of NAOqi, and
which tests show that it works, and [what becomes of a key of a WoZ4U
file](../how-to/woz4u.md#how-each-key-is-converted). `make generated` writes this page; `pytest -m
naoqi` and `pytest -m woz4u` run the tests.

## Every setting

As the robot's screen (`@`) shows them.

{_settings()}

## Every call

{_calls()}

## Every key of a WoZ4U file

{_keys()}
"""


def _calls() -> str:
    head = ("| call | how a wizard reaches it | tests |", "|---|---|---|")
    tests = _tests("calls")
    return "\n".join([*head, *(f"| `{row}` | {CALLS[row]} | {tests[row]} |" for row in CALLS)])


def _keys() -> str:
    rows = [f"| `{key}` | {shown} |" for key, shown in _tests("keys").items()]
    return "\n".join(["| key | tests |", "|---|---|", *rows])


def _tests(table: str) -> dict[str, str]:
    """Row -> the tests that show it."""
    mark, rows = TABLES[table]
    tests = marked.by_statement(marked.found(mark))
    return {row: marked.cell(tests.get(row, {})) for row in rows}


def _settings() -> str:
    rows = [
        f"| `{one.name}` | {one.what} | {_values(one)} | {_code(one.verb)} | {_code(one.file)} |"
        for one in PEPPER.settings.values()
    ]
    head = "| setting | | values | verb | in the robot file |"
    return "\n".join([head, "|---|---|---|---|---|", *rows])


def _values(setting: RobotSetting) -> str:
    match setting.kind:
        case "flag":
            return "on, off"
        case "number":
            return setting.numbers
        case _:
            return ", ".join(map(_code, setting.choices))


def _code(text: str) -> str:
    return f"`{text}`" if text else ""
