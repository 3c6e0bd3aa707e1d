"""What a WoZ4U `config.yaml` may say, by its README, its paper and what its program reads."""

from __future__ import annotations

from collections.abc import Collection

from woz_tui.config.yaml_nodes import MappingNode

#: Lists of buttons: what an item may say.
ITEMS = {
    "animated_speech": ("title", "string", "tooltip", "key_comb"),
    "gestures": ("title", "gesture", "tooltip", "key_comb"),
    "tablet_items": ("title", "file_name", "tooltip", "key_comb", "is_default_img"),
    "audio_files": ("title", "location", "tooltip", "key_comb"),
    "colors": ("title", "red", "green", "blue", "tooltip", "key_comb", "is_default"),
}
ANIMATIONS = ("rasta_anim", "random_anim", "rotate_anim")
ANIMATION_FIELDS = ("duration", "key_comb")
AUTONOMY = (
    *("autonomous_state", "tangential_collision", "orthogonal_collision", "blinking"),
    *("basic_awareness", "engagement_mode", "head_breathing", "arms_breathing"),
    *("body_breathing", "legs_breathing", "listening_movement", "speaking_movement"),
)
LOCKS = (
    *("lock_autonomous_life_section", "lock_movement_control_section", "lock_tablet_section"),
    *("lock_anim_speech_section", "lock_volume_section", "lock_audio_section"),
    *("lock_gesture_section", "lock_color_section", "lock_eye_anim_section"),
)
STEPS = ("default_head_turn_deg", "default_turn_deg", "default_drive_dist")
VOICE = ("volume", "voice_speed", "voice_pitch")

#: Every key of the top level.
TOP_LEVEL = (
    *("pepper_ips", "camera_save_dir", "audio_save_dir"),
    *LOCKS,
    "autonomous_life_config",
    *STEPS,
    "tablet_root_location",
    *ITEMS,
    *VOICE,
    *ANIMATIONS,
)

#: Names that such files had in earlier versions of the program, and what reads the same now.
OLDER = {
    "images": "tablet_items",
    "image_root_location": "tablet_root_location",
    "messages": "animated_speech",
    "sentences": "animated_speech",
}

#: Words that other files may well have.
_COMMON = ("gestures", "colors", "audio_files", *VOICE)

#: Our own format says who the robot is; a WoZ4U file does not know these words.
_OWN_ONLY = ("panels", "robot", "robots")


def recognised(table: MappingNode, own: Collection[str]) -> bool:
    """Whether a file is a WoZ4U file: it names neither panels nor a robot as our own format (whose
    top level is `own`) does, and it has a key that only WoZ4U has, or more keys of WoZ4U's than of
    ours. Loudness and voice alone do not count.
    """
    keys = table.entries.keys()
    if keys & set(_OWN_ONLY):
        return False
    theirs = (keys & set(TOP_LEVEL)) - set(VOICE)
    return bool(theirs - set(_COMMON)) or len(theirs) > len(keys & set(own))
