"""Validates call arguments."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterable, Mapping
from typing import Any, SupportsIndex, TypeAlias

import numpy as np

from ._errors import InputError

#: The source that errors name for call arguments.
ARGUMENTS = "furrow"

#: Parameters, the preset, the configuration file and the law of a computation.
Given: TypeAlias = "tuple[Mapping[str, Any], str, str | None, str | None]"


def refused(field: str, value: object, allowed: str) -> InputError:
    """The error for an invalid argument."""
    shown = repr(value)
    if len(shown) > 60:
        shown = shown[:57] + "..."
    return InputError(f"{ARGUMENTS}: {field} = {shown}: must be {allowed}", field, value, allowed, ARGUMENTS)


def number_of(field: str, value: object) -> float:
    """A number; texts and truth values are none."""
    if isinstance(value, (bool, np.bool_, str, bytes)):
        raise refused(field, value, "a number")
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise refused(field, value, "a number") from None


def pair_of(field: str, value: object) -> tuple[float, float]:
    """A first and a last value."""
    allowed = "a first and a last value, two numbers"
    if isinstance(value, (str, bytes, Mapping)) or not isinstance(value, Iterable):
        raise refused(field, value, allowed)
    ends = list(value)
    if len(ends) != 2:
        raise refused(field, value, allowed)
    return number_of(field, ends[0]), number_of(field, ends[1])


def bool_of(field: str, value: object) -> bool:
    """True or False."""
    if not isinstance(value, (bool, np.bool_)):
        raise refused(field, value, "True or False")
    return bool(value)


def shard_of(shard: object) -> tuple[int, int] | None:
    """Part k of n, if one is given."""
    if shard is None:
        return None
    allowed = "(k, n), part k of n parts"
    if not isinstance(shard, (tuple, list)) or len(shard) != 2:
        raise refused("shard", shard, allowed)
    return whole("shard", shard[0], 1, 1_000_000), whole("shard", shard[1], 1, 1_000_000)


def texts_of(field: str, values: object) -> list[str]:
    """A list of strings."""
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise refused(field, values, "a list of texts")
    return [text_of(field, value) for value in values]


def cues_of(cues: object) -> list[str]:
    """A list of cues, or cues by name, as the command line writes them: ``NAME=CUE``."""
    if not isinstance(cues, Mapping):
        return texts_of("cues", cues)
    for name in cues:
        if any(sign in text_of("cues", name) for sign in ":,+="):
            raise refused("cues", name, "names without the signs : , + and =")
    return [f"{name}={text_of('cues', cue)}" for name, cue in cues.items()]


def whole(field: str, value: SupportsIndex, least: int, most: int) -> int:
    """An integer within a range."""
    allowed = f"a whole number from {least} to {most}"
    if isinstance(value, (bool, np.bool_)):
        raise refused(field, value, allowed)
    try:
        number = operator.index(value)
    except TypeError:
        raise refused(field, value, allowed) from None
    if not least <= number <= most:
        raise refused(field, value, allowed)
    return number


def seed_of(value: SupportsIndex) -> int:
    """A seed."""
    return whole("seed", value, 0, 2**64 - 1)


def threads_of(value: SupportsIndex | None) -> int:
    """The number of threads; 0 for one per core."""
    return 0 if value is None else whole("threads", value, 1, 1024)


def path_of(field: str, value: str | os.PathLike[str]) -> str:
    """A path as text."""
    try:
        path = os.fspath(value)
    except TypeError:
        raise refused(field, value, "a path") from None
    if not isinstance(path, str) or "\0" in path:
        raise refused(field, value, "a path without NUL characters")
    return path


def optional_path(field: str, value: str | os.PathLike[str] | None) -> str | None:
    """A path as text, if one is given."""
    return None if value is None else path_of(field, value)


def text_or_path(field: str, value: str | os.PathLike[str], struct: str) -> tuple[str | None, str | None]:
    """The text of a document in RON, whose struct may be named, or the path of its file."""
    if isinstance(value, str) and (value.lstrip().startswith("(") or f"{struct}(" in value):
        return value, None
    return None, path_of(field, value)


def text_of(field: str, value: object) -> str:
    """A string."""
    if not isinstance(value, str):
        raise refused(field, value, "a text")
    return value


def given_of(
    parameters: Mapping[str, Any],
    preset: str,
    config: str | os.PathLike[str] | None,
    r0: Any | None = None,
    law: str | os.PathLike[str] | None = None,
) -> Given:
    """Parameters, the radius among them if there is one, with a preset, a configuration file and a law."""
    given = dict(parameters) if r0 is None else {"r0": r0, **parameters}
    return given, text_of("preset", preset), optional_path("config", config), optional_path("law", law)
