"""Which test shows which call of NAOqi and which key of a WoZ4U file, and the robot's settings.

Tests bear `@pytest.mark.naoqi("ALMotion.moveTo")` and `@pytest.mark.woz4u("pepper_ips")`.
"""

from __future__ import annotations

from collections import Counter

from woz_drivers.pepper.model import PEPPER

from tools import marked_tests as marked
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

#: Every key of a WoZ4U file, and conversion.
KEYS: dict[str, str] = {
    "pepper_ips": "the driver's `robots`",
    "camera_save_dir": "the driver's `pictures`",
    "audio_save_dir": "the driver's `recordings`",
    **{
        f"lock_{section}_section": f"the panel {panel} is locked, and with it its verbs"
        for section, panel in (
            ("autonomous_life", "Autonomy"),
            ("movement_control", "Movement"),
            ("tablet", "Tablet"),
            ("anim_speech", "Speech"),
            ("volume", "Voice"),
            ("audio", "Sounds"),
            ("gesture", "Gestures"),
            ("color", "Eyes"),
            ("eye_anim", "Eye animations"),
        )
    },
    "autonomous_life_config": "the driver's `autonomy`, applied on connect",
    "autonomous_state": "`autonomy: {state: ...}`",
    "tangential_collision": "`autonomy: {tangential: ...}`",
    "orthogonal_collision": "`autonomy: {orthogonal: ...}`",
    "blinking": "`autonomy: {blinking: ...}`",
    "basic_awareness": "`autonomy: {awareness: ...}`",
    "engagement_mode": "`autonomy: {engagement: ...}`",
    "head_breathing": "`autonomy: {head_breathing: ...}`",
    "arms_breathing": "`autonomy: {arms_breathing: ...}`",
    "body_breathing": "`autonomy: {body_breathing: ...}`",
    "legs_breathing": "`autonomy: {legs_breathing: ...}`",
    "listening_movement": "`autonomy: {listening_movement: ...}`",
    "speaking_movement": "`autonomy: {speaking_movement: ...}`",
    "default_head_turn_deg": "`steps: {head: ...}`",
    "default_turn_deg": "`steps: {turn: ...}`",
    "default_drive_dist": "`steps: {drive: ...}`, in metres",
    "tablet_root_location": "the driver's `tablet: {root: ...}`",
    "tablet_items": "panel Tablet, verb `screen`",
    "is_default_img": "the driver's `tablet: {default: ...}`",
    "animated_speech": "panel Speech, verbs `say` and `read`",
    "volume": "the driver's `voice: {volume: ...}`",
    "voice_speed": "the driver's `voice: {speed: ...}`",
    "voice_pitch": "the driver's `voice: {pitch: ...}`",
    "audio_files": "panel Sounds, verb `sound`",
    "gestures": "panel Gestures, verb `play`",
    "colors": "panel Eyes, verb `eyes`",
    "is_default": "the driver's `eyes`",
    "rasta_anim": "panel Eye animations, verb `eyes_animation`",
    "random_anim": "panel Eye animations, verb `eyes_animation`",
    "rotate_anim": "panel Eye animations, verb `eyes_animation`",
    "key_comb": "the action's `key`",
    "tooltip": "the action's `help`",
    "title": "the action's `label`",
}
#: Name of a table -> the mark of its tests, its rows, the heading of its second column.
TABLES = {
    "calls": ("naoqi", CALLS, "call", "how a wizard reaches it"),
    "keys": ("woz4u", KEYS, "key", "conversion"),
}


def uncovered(table: str) -> list[str]:
    """Rows of a table that no test shows."""
    mark, rows, *_ = TABLES[table]
    shown = {one.statement for one in marked.found(mark)}
    return [name for name in rows if name not in shown]


def unknown(table: str) -> list[str]:
    """Marks that name no row."""
    mark, rows, *_ = TABLES[table]
    return sorted({one.statement for one in marked.found(mark)} - rows.keys())


def page() -> str:
    """The page with the settings, the calls and the keys."""
    return f"""\
# Pepper: every setting, call and key, and which test shows it

Look up here which verb changes a setting of the robot, how a wizard reaches a call of NAOqi, what
becomes of a key of a WoZ4U file, and which tests show that it works. `make generated` writes this
page; `pytest -m naoqi` and `pytest -m woz4u` run the tests.

## Every setting

As the robot's screen (`@`) shows them.

{_settings()}

## Every call

{_table("calls")}

## Every key of a WoZ4U file

{_table("keys")}
"""


def _table(name: str) -> str:
    mark, rows, first, second = TABLES[name]
    tests = marked.by_statement(marked.found(mark))
    lines = [
        f"| `{row}` | {reached} | {marked.cell(tests.get(row, {}))} |"
        for row, reached in rows.items()
    ]
    return "\n".join([f"| {first} | {second} | tests |", "|---|---|---|", *lines])


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
