"""Constants fitted to thresholds, ensembles of constants, and lineages over an ensemble."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, SupportsIndex

import numpy as np

from . import _furrow
from ._checks import given_of, path_of, refused, seed_of, text_or_path, texts_of, threads_of, whole
from ._results import Array, Result
from ._tables import Found, fixed, frame

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from ._cell import Value
    from ._furrow import Drawing
    from ._tree import Tree


@dataclass(frozen=True)
class Calibration(Result):
    """The constants that fit thresholds best, and what the thresholds leave open.

    ``parameters``: The fitted values.
    ``residuals``: Each threshold: ``r0``, ``epsilon``, ``xi_s`` given, ``computed``, ``relative`` deviation.
    ``rms``: Root mean square of the relative deviations.
    ``combinations``: Combinations of constants, by how well the thresholds determine them.
    ``iterations``: Steps of the search.
    ``excluded``: Statements of the targets that these constants violate.
    """

    parameters: dict[str, float]
    residuals: tuple[dict[str, float], ...]
    rms: float
    combinations: tuple[dict[str, Any], ...]
    iterations: int
    excluded: tuple[dict[str, str], ...]

    def to_dict(self) -> dict[str, Any]:
        """The result as numbers, strings and lists."""
        return {**super().to_dict(), "parameters": dict(self.parameters)}

    def to_pandas(self) -> pd.DataFrame:
        """One row per threshold."""
        return frame({name: [row[name] for row in self.residuals] for name in self.residuals[0]})


@dataclass(frozen=True, eq=False)
class Constants:
    """Weighted sets of constants that agree with the targets, for :func:`furrow.tree_ensemble`.

    ``parameters``: Names of the constants.
    ``values``: One row per set.
    ``weights``: Weights that sum to 1.
    ``effective_sample_size``: The equivalent number of independent sets.
    ``draws``: Sets that were tried.
    ``excluded``: The number of sets that each statement excluded.
    ``csv``: The table, as ``furrow tree --constants`` reads it.
    """

    parameters: tuple[str, ...]
    values: Array = field(repr=False)
    weights: Array = field(repr=False)
    effective_sample_size: float
    draws: int
    excluded: Mapping[str, int]
    csv: str = field(repr=False)

    @property
    def acceptance(self) -> float:
        """The share of the sets tried that no statement excludes."""
        return 1 - sum(self.excluded.values()) / max(self.draws, 1)

    def __len__(self) -> int:
        return len(self.weights)

    def __getitem__(self, name: str) -> Array:
        try:
            column: Array = self.values[:, self.parameters.index(name)]
        except ValueError:
            raise KeyError(name) from None
        return column

    def to_dict(self) -> dict[str, Any]:
        """The result as numbers, strings and lists."""
        columns = {name: self[name].tolist() for name in self.parameters}
        return {**columns, "weight": self.weights.tolist()}

    def to_pandas(self) -> pd.DataFrame:
        """One row per set."""
        return frame({**{name: self[name] for name in self.parameters}, "weight": self.weights})


class Ranges:
    """A lineage over sets of constants or over seeds: median and 90 % range of every count."""

    def __init__(self, found: Mapping[str, Any], drawing: Drawing, tree: Tree | None = None, page: str | None = None) -> None:
        self._found = dict(found)
        self._page = page
        #: The rounds with their ranges as the command line draws them.
        self.drawing = drawing
        #: Over seeds: the tree of the first one.
        self.tree = tree

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the picture (``.svg``, ``.pdf``, ``.png``) or, over seeds, the first tree's page with the ranges (``.html``)."""
        file = path_of("path", path)
        if not file.endswith(".html"):
            self.drawing.save(file)
        elif self._page is None:
            raise refused("path", str(path), "a file that ends in .svg, .pdf or .png: a page is of one tree")
        else:
            _furrow.write_text(file, self._page)

    @property
    def founders(self) -> Sequence[Mapping[str, Any]]:
        """Founders: ``name``, ``rounds`` (``min``, ``mean``, ``max``, ``terminal`` and others, each with ``p5``, ``p50``,
        ``p95``) and ``chi`` with the same quantiles."""
        founders: list[Mapping[str, Any]] = self._found["founders"]
        return founders

    @property
    def members(self) -> int:
        """The number of sets of constants."""
        return int(self._found["members"])

    def to_dict(self) -> dict[str, Any]:
        """The output of ``furrow tree --constants --json``."""
        return dict(self._found)

    def to_pandas(self) -> pd.DataFrame:
        """One row per founder, three columns per count."""
        rows: list[dict[str, Any]] = []
        for founder in self.founders:
            row: dict[str, Any] = {"name": founder["name"]}
            counts = {**(founder["rounds"] or {}), "chi": founder["chi"]}
            for name, count in counts.items():
                for quantile in ("p5", "p50", "p95"):
                    row[f"{name}_{quantile}"] = None if count is None else count[quantile]
            rows.append(row)
        names = dict.fromkeys(name for row in rows for name in row)
        return frame({name: [row.get(name) for row in rows] for name in names})

    def __repr__(self) -> str:
        return f"<furrow.Ranges of {len(self.founders)} founders over {self.members} sets of constants>"

    def plot(self, *, path: str | os.PathLike[str] | None = None) -> Figure:
        """Rounds of the founders with their ranges; needs matplotlib. With ``path`` the figure is also written there."""
        from . import plot

        return plot.saved(plot.ranges(self), path)


def table_of(constants: str | os.PathLike[str] | Constants) -> tuple[str | None, str | None]:
    """Sets of constants as a table in text, or as its file."""
    if isinstance(constants, Constants):
        return constants.csv, None
    return None, path_of("constants", constants)


def _targets(targets: str | os.PathLike[str]) -> tuple[str | None, str | None]:
    if targets is None:
        raise refused("targets", targets, "a file of targets, or its text")
    return text_or_path("targets", targets, "Targets")


def calibrate(
    targets: str | os.PathLike[str],
    *,
    unknowns: Sequence[str] | None = None,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    **parameters: Value,
) -> Calibration:
    """Fits constants to thresholds and reports what these leave open.

    ``targets`` is a file such as ``data/thresholds.ron`` or its text; ``unknowns`` names other constants to vary; keywords
    are parameters at which the search starts, over those of ``preset`` and ``config``.
    """
    found = _furrow.calibrate(_targets(targets), _names(unknowns), given_of(parameters, preset, config))
    return Calibration(
        parameters=found["parameters"],
        residuals=tuple(found["residuals"]),
        rms=found["rms"],
        combinations=tuple(found["combinations"]),
        iterations=found["iterations"],
        excluded=tuple(found["excluded"]),
    )


def _names(unknowns: Sequence[str] | None) -> list[str] | None:
    return None if unknowns is None else texts_of("unknowns", unknowns)


class Front(Found):
    """Sets of constants by how many statements they meet and how far their worst threshold is off: the output of ``furrow
    calibrate --front --json``."""

    def to_pandas(self) -> pd.DataFrame:
        """One row per set of the front."""
        names = self["parameters"]
        rows = [
            {"worst": row["worst"], "met": row["met"], **dict(zip(names, row["values"], strict=True))} for row in self["members"]
        ]
        return frame({name: [row[name] for row in rows] for name in ("worst", "met", *names)})


def front(
    targets: str | os.PathLike[str],
    members: SupportsIndex,
    *,
    unknowns: Sequence[str] | None = None,
    seed: SupportsIndex = 0,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    threads: SupportsIndex | None = None,
    **parameters: Value,
) -> Front:
    """Searches among ``members`` sets of constants for the front: the least worst threshold for each number of statements met.
    ``seed`` is that of the search; other arguments are those of :func:`calibrate`."""
    source, given = _targets(targets), given_of(parameters, preset, config)
    count = whole("members", members, 1, 10_000_000)
    return Front(_furrow.front(source, _names(unknowns), count, seed_of(seed), given, threads_of(threads)))


def ensemble(
    targets: str | os.PathLike[str],
    members: SupportsIndex,
    *,
    unknowns: Sequence[str] | None = None,
    seed: SupportsIndex = 0,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    threads: SupportsIndex | None = None,
    **parameters: Value,
) -> Constants:
    """Samples ``members`` sets of constants that agree with the targets, for :func:`furrow.tree_ensemble`. ``seed`` is that of
    the sample; other arguments are those of :func:`calibrate`."""
    source = _targets(targets)
    given = given_of(parameters, preset, config)
    count = whole("members", members, 1, 100_000)
    found = _furrow.ensemble(source, _names(unknowns), count, seed_of(seed), given, threads_of(threads))
    return Constants(
        parameters=tuple(found["parameters"]),
        values=fixed(np.array(found["values"], dtype=np.float64)),
        weights=fixed(np.array(found["weights"], dtype=np.float64)),
        effective_sample_size=found["effective_sample_size"],
        draws=found["draws"],
        excluded=found["excluded"],
        csv=found["csv"],
    )
