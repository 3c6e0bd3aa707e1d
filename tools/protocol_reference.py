"""Every request and answer of the socket, as a page and as JSON Schema, from their classes."""

from __future__ import annotations

import inspect
from collections.abc import Iterable
from typing import Any, Union, get_args

import msgspec

from tools.log_reference import json_type
from woz_tui.cli.safe_streams import json_text
from woz_tui.protocol.description import Description, Prediction
from woz_tui.protocol.kinds import (
    answer_kinds,
    message_kinds,
    prediction_kinds,
    request_kinds,
)
from woz_tui.protocol.requests import PROTOCOL, Request

_COMMON = tuple(field.name for field in msgspec.structs.fields(Request))
_HEAD = f"""# Requests and answers, field by field

Look up a field of the socket's protocol. [protocol.md](protocol.md) explains how it is spoken, with
examples; [protocol.schema.json](protocol.schema.json) has the same as JSON Schema, with all
messages of the stream, which [session-log.md](session-log.md) explains. This is protocol
{PROTOCOL}.

A field that is not *needed* may be left out: then it has its default. Every request may have `ref`,
a number that comes back in its reply, and `sent_us` (see *Too old* in protocol.md).
"""
_TABLE = ("| field | type | needed | default |", "|---|---|---|---|")


def schema() -> dict[str, Any]:
    """JSON Schema: `Request`, `Answer` and `Message` are what a line can be."""
    kinds = {"Request": request_kinds(), "Answer": answer_kinds(), "Message": message_kinds()}
    lines = {name: Union[each] for name, each in kinds.items()}  # noqa: UP007 - of a tuple
    data = _data()
    found, definitions = msgspec.json.schema_components(
        (*lines.values(), *data), ref_template="#/$defs/{name}"
    )
    for definition in definitions.values():
        if "description" in definition:
            definition["description"] = _text(definition["description"])
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"woz-tui protocol {PROTOCOL}",
        "$ref": "#/$defs/Request",
        "$defs": dict(zip(lines, found, strict=False)) | definitions,
    }


def page() -> str:
    """A section for each request and each answer."""
    parts = [
        _HEAD,
        "## Requests\n",
        *map(_section, request_kinds()),
        "## Answers\n",
        *map(_section, answer_kinds()),
        "## Data of replies\n",
        "What stands in `data` of the replies to `describe` and `predict`.\n",
        *map(_section, dict.fromkeys(_nested(_data()))),
    ]
    return "\n".join(parts)


def _data() -> tuple[type[msgspec.Struct], ...]:
    """What stands in `data` of replies."""
    return Description, Prediction, *prediction_kinds().values()


def _nested(kinds: Iterable[type[msgspec.Struct]]) -> Iterable[type[msgspec.Struct]]:
    """These structs, each followed by those in its fields."""
    for kind in kinds:
        yield kind
        for field in msgspec.structs.fields(kind):
            inner = [
                each
                for each in (field.type, *get_args(field.type), *_of_lists(field.type))
                if isinstance(each, type) and issubclass(each, msgspec.Struct)
            ]
            yield from _nested(inner)


def _of_lists(annotation: Any) -> Iterable[Any]:
    for each in get_args(annotation):
        yield from get_args(each)


def _section(kind: type[msgspec.Struct]) -> str:
    tag = kind.__struct_config__.tag
    fields = [field for field in msgspec.structs.fields(kind) if field.name not in _COMMON]
    lines = [f"### `{tag or kind.__name__}`", "", _text(kind.__doc__ or ""), ""]
    if fields:
        lines += [
            "| field | type | needed | default |",
            "|---|---|---|---|",
            *map(_row, fields),
            "",
        ]
    return "\n".join(lines)


def _row(field: msgspec.structs.FieldInfo) -> str:
    default = field.default
    if field.default_factory is not msgspec.NODEFAULT:
        default = field.default_factory()
    shown = "" if field.required or default in ("", None) else f"`{_json(default)}`"
    needed = "yes" if field.required else ""
    choices = msgspec.json.schema(field.type).get("enum", ())
    words = ", ".join(f"`{choice}`" for choice in choices if choice) or json_type(field.type)
    return f"| `{field.encode_name}` | {words} | {needed} | {shown} |"


def _json(value: Any) -> str:
    plain = msgspec.to_builtins(value)
    return "{}" if isinstance(plain, dict) else json_text(plain)


def _text(doc: str) -> str:
    return " ".join(inspect.cleandoc(doc).split())
