"""Validates call arguments."""

from __future__ import annotations

import operator
import os
from collections.abc import Mapping
from typing import Any, SupportsIndex, TypeAlias

from ._errors import InputError

#: The source that errors name for call arguments.
ARGUMENTS = "furrow"

#: Parameters, the preset and the configuration file of a computation.
Given: TypeAlias = "tuple[Mapping[str, Any], str, str | None]"


def refused(field: str, value: object, allowed: str) -> InputError:
    """The error for an invalid argument."""
    shown = repr(value)
    if len(shown) > 60:
        shown = shown[:57] + "..."
    return InputError(f"{ARGUMENTS}: {field} = {shown}: must be {allowed}", field, value, allowed, ARGUMENTS)


def whole(field: str, value: SupportsIndex, least: int, most: int) -> int:
    """An integer within a range."""
    allowed = f"a whole number from {least} to {most}"
    if isinstance(value, bool):
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


def text_of(field: str, value: object) -> str:
    """A string."""
    if not isinstance(value, str):
        raise refused(field, value, "a text")
    return value


def given_of(parameters: Mapping[str, Any], preset: str, config: str | os.PathLike[str] | None) -> Given:
    """Parameters with a preset and a configuration file."""
    return dict(parameters), text_of("preset", preset), None if config is None else path_of("config", config)
