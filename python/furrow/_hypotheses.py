"""Hypotheses beside each other."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, SupportsIndex

from . import _furrow
from ._checks import (
    bool_of,
    cues_of,
    given_of,
    number_of,
    optional_path,
    path_of,
    refused,
    seed_of,
    shard_of,
    text_of,
    texts_of,
    threads_of,
    whole,
)
from ._memo import memo_of
from ._progress import Progress, shown
from ._shapes import Drawn
from ._tables import TABLES, OfEmbryos, Table, frame, matching_of, of_embryos, tables_of

if TYPE_CHECKING:
    import pandas as pd

    from ._cell import Value
    from ._furrow import Drawing, Memo


class Hypotheses(Drawn):
    """Hypotheses beside each other: the output of ``furrow test --json``."""

    def __init__(self, found: Mapping[str, Any], drawing: Drawing, samples: tuple[list[list[list[float]]], str]) -> None:
        super().__init__(found, drawing)
        self._points, self._table = samples

    def save_samples(self, path: str | os.PathLike[str]) -> None:
        """Writes the samples of all hypotheses as a table (CSV), which ``furrow.tree_ensemble(constants=…)`` reads, or
        :func:`furrow.merge` the tables of all parts."""
        if not any(self._points):
            raise refused("samples", None, "given in the test")
        _furrow.write_text(path_of("path", path), self._table)

    def samples_to_pandas(self, hypothesis: str | None = None) -> pd.DataFrame:
        """The sample of a hypothesis, by default of the first: one column per number, one row per point."""
        names = [row["name"] for row in self["hypotheses"]]
        if hypothesis is not None and hypothesis not in names:
            raise refused("hypothesis", hypothesis, f"one of {', '.join(names)}")
        at = 0 if hypothesis is None else names.index(hypothesis)
        if not self._points[at]:
            raise refused("samples", None, "given in the test")
        numbers = [number["name"] for number in self["hypotheses"][at]["posterior"]["parameters"]]
        return frame({name: [point[k] for point in self._points[at]] for k, name in enumerate(numbers)})

    def to_pandas(self) -> pd.DataFrame:
        """One row per hypothesis."""
        names = ("name", "cue", "log_likelihood", "k", "aicc", "delta_aicc", "weight", "loo", "log_evidence", "sigma")
        return frame({name: [row[name] for row in self["hypotheses"]] for name in names})

    def pairs_to_pandas(self) -> pd.DataFrame:
        """One row per pair of hypotheses."""
        names = ("a", "b", "delta", "se", "p", "distinguishable", "needed")
        return frame({name: [row[name] for row in self["pairs"]] for name in names})

    def cells_to_pandas(self) -> pd.DataFrame:
        """One row per cell and hypothesis: what was measured, and χ of the model, missing where the cell does not divide."""
        names = ("cell", "n", "measured", "sd", "r0", "chi", "has_cue", "log_likelihood")
        rows = [(tested["name"], *(cell[name] for name in names)) for tested in self["hypotheses"] for cell in tested["cells"]]
        return frame({name: [row[k] for row in rows] for k, name in enumerate(("hypothesis", *names))})


def _tables(table: Table, name: str) -> tuple[list[str], str | None]:
    if table is None:
        raise refused(name, table, TABLES)
    return tables_of(table, name)


def _lifetimes(table: Table | None, sd: float) -> tuple[tuple[list[str], str | None], float] | None:
    if table is None:
        return None
    return (([], None) if isinstance(table, str) and table == "published" else _tables(table, "lifetimes")), sd


def test(
    table: Table,
    cues: Sequence[str] | Mapping[str, str] = (),
    *,
    hypotheses: str | os.PathLike[str] | None = None,
    free: Sequence[str] | None = None,
    noise: Literal["given", "common", "replicates"] | None = None,
    folded: bool = False,
    cells: Sequence[str] | None = None,
    population: Sequence[str] | None = None,
    class_columns: Sequence[str] = (),
    voxel: OfEmbryos | None = None,
    names: Table | None = None,
    root: str | Sequence[str] | None = None,
    unit: Literal["um3", "voxels", "relative"] | None = None,
    rounds: float | None = None,
    lifetimes: Table | Literal["published"] | None = None,
    lifetime_sd: float = 0.2,
    lineage: str | os.PathLike[str] | None = None,
    particles: SupportsIndex | None = None,
    moves: SupportsIndex | None = None,
    seed: SupportsIndex = 0,
    samples: SupportsIndex | None = None,
    shard: tuple[SupportsIndex, SupportsIndex] | None = None,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Hypotheses:
    """Tests hypotheses against each other: which of several ``cues`` fits measured χ best, and whether the difference is more
    than chance.

    ``table`` is one of :func:`furrow.compare.volumes`, such as one with the columns ``mother`` and ``chi`` and optionally
    ``embryo``, ``chi_sd`` and ``mother_um3``, or a file of targets of :func:`furrow.fit.cue`. ``cues`` are texts, of which
    ``"name=CUE"`` names a hypothesis, or cues by name. ``free`` lists the numbers that are fitted, such as ``cue.amplitude`` or
    ``epsilon@somatic``; by default all numbers of each cue, and none for an empty list. ``noise`` says where the errors of χ come
    from, and ``folded`` models measured χ as the absolute value of a χ with a normal error. ``cells`` and ``population``
    choose cells and groups. ``names`` and ``root`` match cells with other names than
    the lineage's, and ``voxel`` is the edge of a voxel in µm, as for :func:`furrow.compare.volumes`. ``class_columns``
    are columns whose texts, joined, name the class of cells of the lineage that each mother is one of. ``samples`` draws so many
    points of each posterior; ``shard=(k, n)`` draws part k of n, each of so many points, for :func:`furrow.merge`.

    ``hypotheses`` is a file of more hypotheses, which may have free numbers of their own. ``rounds`` also uses the mean rounds of
    founders that the lineage has as observed, with this standard deviation in rounds. ``lifetimes`` is a table of
    :func:`furrow.compare.lifetimes`, or ``"published"``; ``lifetime_sd`` is the standard deviation of ln lifetime of the cells of
    a generation about the lineage's clock.

    ``lineage`` has the cells and the names of cues, and ``unit`` is that of volumes in tables which name none. Each best fit is
    searched for by a swarm of ``particles`` with so many ``moves``, from ``seed`` on. Keywords are parameters, over those of
    ``preset`` and ``config``; ``memo``, ``threads`` and ``progress`` are those of :meth:`furrow.Cell.divide`.
    """
    named = cues_of(cues)
    if not named and hypotheses is None:
        raise refused("cues", cues, "at least one cue")
    asked = {
        "table": _tables(table, "table"),
        "cues": named,
        "free": None if free is None else texts_of("free", free) or ["none"],
        "lineage": optional_path("lineage", lineage),
        "noise": None if noise is None else text_of("noise", noise),
        "folded": bool_of("folded", folded),
        "cells": None if cells is None else texts_of("cells", cells),
        "population": None if population is None else texts_of("population", population),
        "class": texts_of("class_columns", class_columns),
        "voxel": of_embryos("voxel", voxel),
        "matching": matching_of(names, root),
        "unit": None if unit is None else text_of("unit", unit),
        "hypotheses": optional_path("hypotheses", hypotheses),
        "rounds": None if rounds is None else number_of("rounds", rounds),
        "lifetimes": _lifetimes(lifetimes, number_of("lifetime_sd", lifetime_sd)),
        "search": (
            None if particles is None else whole("particles", particles, 2, 10_000),
            None if moves is None else whole("moves", moves, 1, 100_000),
            seed_of(seed),
        ),
        "samples": None if samples is None else whole("samples", samples, 20, 100_000),
        "shard": shard_of(shard),
    }
    known = memo_of(memo)
    with shown(progress, "candidates") as tell:
        found, drawing, samples_of = _furrow.test(asked, given_of(parameters, preset, config), known, threads_of(threads), tell)
    return Hypotheses(found, drawing, samples_of)
