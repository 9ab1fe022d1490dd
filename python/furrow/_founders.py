"""Founders of a tree, with their rounds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Rounds:
    """Rounds of division from a founder to its terminal cells. Observed ones that the lineage file does not give are None.

    ``min``: Fewest.
    ``mean``: Mean over terminal cells.
    ``max``: Most.
    ``full_doublings``: Generations in which every cell divided.
    ``symmetric_doublings``: Generations in which every cell divided equally.
    ``terminal``: Terminal cells.
    """

    min: float | None = None
    mean: float | None = None
    max: float | None = None
    full_doublings: int | None = None
    symmetric_doublings: int | None = None
    terminal: int | None = None


@dataclass(frozen=True)
class Founder:
    """A founder: its cell, its own division, its rounds and the observed rounds.

    ``name``: Name.
    ``r0``: Radius, in L_h; None if it was not born.
    ``cue``: Name of its cue.
    ``outcome``: Outcome of its own division.
    ``chi``: Size asymmetry of its division.
    ``rounds``: Rounds in the model.
    ``observed``: Rounds observed.
    ``last_division_min``: The last division below it, in minutes; None without a clock.
    ``last_division_extrapolated``: Whether that follows a lifetime beyond the sizes to which the clock was fitted.
    """

    name: str
    r0: float | None
    cue: str
    outcome: str | None
    chi: float | None
    rounds: Rounds | None
    observed: Rounds | None
    last_division_min: float | None = None
    last_division_extrapolated: bool = False


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
        last_division_extrapolated=found.get("last_division_extrapolated", False),
    )
