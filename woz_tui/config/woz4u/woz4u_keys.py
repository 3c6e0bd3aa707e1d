"""What a WoZ4U `config.yaml` may say, by its README, its paper and what its program reads."""

from __future__ import annotations

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
}
#: Sections of earlier versions that are something else now.
EARLIER = ("led_settings",)
#: The same as `OLDER` for fields of entries.
OLDER_FIELDS = {"short": "title", "full_text": "string", "message": "string", "text": "string"}
