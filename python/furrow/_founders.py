"""Founders of a tree, with their rounds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Rounds:
    """Rounds of division from a founder to its terminal cells. Observed ones that the lineage file does not give are None."""

    min: float | None = None  #: Fewest.
    mean: float | None = None  #: Mean over terminal cells.
    max: float | None = None  #: Most.
    full_doublings: int | None = None  #: Generations in which every cell divided.
    symmetric_doublings: int | None = None  #: Generations in which every cell divided equally.
    terminal: int | None = None  #: Terminal cells.


@dataclass(frozen=True)
class Founder:
    """A founder: its cell, its own division, its rounds and the observed rounds."""

    name: str  #: Name.
    r0: float | None  #: Radius, in L_h; None if it was not born.
    cue: str  #: Name of its cue.
    outcome: str | None  #: Outcome of its own division.
    chi: float | None  #: Size asymmetry of its division.
    rounds: Rounds | None  #: Rounds in the model.
    observed: Rounds | None  #: Rounds observed.
    last_division_min: float | None = None  #: Its last division, in minutes; None without a clock.


def _rounds(found: Mapping[str, Any] | None) -> Rounds | None:
    if found is None:
        return None
    return Rounds(
        min=found.get("min"),
        mean=found.get("mean"),
        max=found.get("max"),
        full_doublings=found.get("full_doublings"),
        symmetric_doublings=found.get("symmetric"),
        terminal=found.get("terminal"),
    )


def founder_of(found: Mapping[str, Any]) -> Founder:
    """A row of the founders' table."""
    return Founder(
        name=found["name"],
        r0=found["r0"],
        cue=found["cue"],
        outcome=found["outcome"],
        chi=found["chi"],
        rounds=_rounds(found["rounds"]),
        observed=_rounds(found["observed"]),
        last_division_min=found.get("last_division_min"),
    )
