"""The YAML parser's complaints in the words of those who write experiment files."""

from __future__ import annotations

import yaml

#: (part of the parser's sentence, ours). First match wins.
_SAID = (
    ("tab character that violates", "a tab; YAML is indented with blanks"),
    ("alphabetic or numeric", "text that begins with * or & needs quotes"),
    ("mapping values are not allowed", "a colon too many: text that holds ': ' needs quotes"),
    ("could not find expected ':'", "a colon is missing after a name, or a quote is not closed"),
    ("block sequence entries", "a dash cannot stand here; is the line above complete?"),
    ("expected '-' indicator", "a '-' is expected here; look at the indentation"),
    ("expected ',' or ']'", "a ',' or the closing ] is missing"),
    ("expected ',' or '}'", "a ',' or the closing } is missing"),
    ("unexpected end of stream", "these quotes are never closed"),
    ("escape character", "unknown escape after \\ in double quotes; use single quotes"),
    ("hexdecimal", "unknown escape after \\ in double quotes; use single quotes"),
    ("expected node content", "a value is missing here, or text that needs quotes"),
    ("<document start>", "this stands outside of the file's mapping; look at the indentation"),
    ("expected key", "this does not fit: look at the indentation and the quotes"),
    ("tag", "text that begins with ! needs quotes"),
    ("URI", "text that begins with ! needs quotes"),
    ("directive", "text that begins with % needs quotes"),
    ("comment or line break", "text that begins with > or | needs quotes"),
)


def explained(error: yaml.YAMLError, text: str) -> tuple[int, int, str]:
    """Line and column (from 1) of the error in `text`, and a sentence."""
    if not isinstance(error, yaml.MarkedYAMLError):
        return 1, 1, " ".join(str(error).split())
    said = f"{error.problem or 'cannot be understood'} {error.context or ''}".strip()
    mark = error.problem_mark or error.context_mark
    begun = error.context_mark
    if "end of stream" in said and begun is not None:
        mark = begun
    if mark is None:
        return 1, 1, said
    message = next((ours for theirs, ours in _SAID if theirs in said), said)
    if "start any token" in said:
        message = _character(text, mark.line, mark.column)
    if begun is not None and begun.line < mark.line:
        message += f" (begun in line {begun.line + 1})"
    return mark.line + 1, mark.column + 1, message


def _character(text: str, line: int, column: int) -> str:
    """What cannot begin a token: nearly always a tab, or a character that wants quotes."""
    lines = text.splitlines()
    found = lines[line][column : column + 1] if line < len(lines) else ""
    if found == "\t":
        return "a tab; YAML is indented with blanks"
    return f"text that begins with {found or 'this character'} needs quotes"
