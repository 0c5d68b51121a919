"""Reading of TOML files."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.support.text_file import DEEPEST, FileRefused, entries
from wheelrail.support.text_file import read_text as text_of

MOST = 1.0  # MB
LONGEST_INTEGER = 10_000  # bits; Python refuses to print more than 4300 digits
COMMA = re.compile(r"[^#\"'\[]*=[ \t]*([+-]?\d+,\d+(?:[eE][+-]?\d+)?)[ \t]*(?:#.*)?$", re.ASCII)  # a decimal comma
WORD = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
DOTTED = re.compile(rf"(?<![\w-]){WORD}(?:[ \t]*+\.[ \t]*+{WORD}){{{DEEPEST},}}", re.ASCII)


def read_text(path: Path) -> str:
    """Text of a file; raises SceneError if it cannot be read."""
    try:
        return text_of(path, MOST)
    except FileRefused as error:
        raise SceneError(str(error)) from None


def parse(text: str, path: str | Path) -> dict[str, Any]:
    """Tables of a TOML text; raises SceneError for another text, naming path.

    Also for tables, arrays and dotted keys of more than 32 levels, and for whole numbers of thousands of digits, whose
    cost grows faster than their length.
    """
    if key := DOTTED.search(text):  # before tomllib, which takes memory with the square of their number
        line = text.count("\n", 0, key.start()) + 1
        raise SceneError(f"{path}, line {line}: not valid: {key[0]}: allowed: at most {DEEPEST} dots in a key")
    try:
        data = tomllib.loads(text)
    except ValueError as error:  # of TOML syntax, or of a number with thousands of digits
        raise SceneError(_decimal_comma(text, path) or f"{path}: not valid TOML: {error}") from None
    except RecursionError:
        raise SceneError(f"{path}: not valid TOML: brackets nested hundreds of levels deep") from None
    for name, value, depth in entries(data):
        if depth > DEEPEST:
            raise SceneError(f"{path}: {name}: brackets nested more than {DEEPEST} levels deep")
        if isinstance(value, int) and value.bit_length() > LONGEST_INTEGER:
            raise SceneError(f"{path}: {name}: a whole number of {value.bit_length()} bits: allowed: at most 64")
    return data


def _decimal_comma(text: str, path: str | Path) -> str:
    """Message about the first number with a decimal comma; empty without one."""
    for number, line in enumerate(text.splitlines(), start=1):
        if comma := COMMA.match(line):
            return f"{path}, line {number}: {comma[1]}: must have a decimal point: {comma[1].replace(',', '.')}"
    return ""
