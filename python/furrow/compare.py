"""Compares the model with measured embryos."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _furrow
from ._checks import given_of, number_of, optional_path, refused, text_of, texts_of, threads_of
from ._grow import tree as grow
from ._memo import memo_of
from ._progress import Progress, shown
from ._results import Division, Frame, Frames
from ._studies import Constants, table_of
from ._tables import Found, OfEmbryos, Table, fixed, frame, matching_of, of_embryos, positive, source_of, tables_of, times_of
from ._tree import Tree

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from ._cell import Value
    from ._furrow import Memo

#: Published means of :func:`volumes`.
PUBLISHED = ("jankele2021", "villoutreix2016")


class Counts(Found):
    """Rounds of a tree and the observed rounds, for every definition of "rounds": the output of ``furrow compare counts
    --json``."""

    def to_pandas(self) -> pd.DataFrame:
        """One row per founder, stage of the observed embryo and definition of rounds."""
        rows = [
            (stage["cells"], founder["founder"], reading, count["model"], count["observed"], count["within_one"])
            for stage in self["stages"]
            for founder in stage["founders"]
            for reading, count in founder["counts"].items()
        ]
        names = ("stage_cells", "founder", "reading", "model", "observed", "within_one")
        return frame({name: [row[k] for row in rows] for k, name in enumerate(names)})


def counts(
    tree: Tree,
    *,
    measured: str | os.PathLike[str] | None = None,
    names: Table | None = None,
    root: str | Sequence[str] | None = None,
) -> Counts:
    """Compares rounds of a tree with the counts that its lineage file gives, for every definition of "rounds"; those of
    C. elegans at several stages (Sulston et al. 1983).

    ``measured`` is an embryo that another program followed, which is compared instead, up to its last frame: nuclei (zip) or
    CD table of AceTree, spots of TrackMate, MaMuT (XML, CSV) or Mastodon (CSV), tracks of napari, ultrack (CSV) or the Cell
    Tracking Challenge (text), GEFF; or the CSV that ``furrow export`` writes.

    ``names`` and ``root`` match cells that have other names than the lineage's. ``names`` is a table with the columns
    ``tracked`` and ``name``, and optionally ``embryo``. ``root`` is ``"TRACKED=NAME"``, a tracked cell and its name, or
    ``"NAME"`` for the only cell without a mother, or several of these: the cells below get their names by their divisions.
    """
    if not isinstance(tree, Tree):
        raise refused("tree", tree, "a tree from furrow.tree()")
    file = optional_path("measured", measured)
    return Counts(_furrow.compare_counts(tree._grown, file, matching_of(names, root)))


class Lifetimes(Found):
    """Measured lifetimes and those of a tree: the output of ``furrow compare lifetimes --json``."""

    def to_pandas(self) -> pd.DataFrame:
        """One row per cell, with lifetimes in minutes. A model's lifetime is missing if its cell does not divide."""
        names = ("cell", "founder", "n", "mean", "sd", "volume", "model", "model_divides", "model_volume")
        return frame({name: [cell.get(name) for cell in self["cells"]] for name in names})


def lifetimes(
    table: Table | None = None,
    *,
    tree: Tree | None = None,
    volumes: Table | None = None,
    frame_minutes: OfEmbryos | None = None,
    common_pace: bool = False,
    common_size: bool = False,
    names: Table | None = None,
    root: str | Sequence[str] | None = None,
) -> Lifetimes:
    """Compares measured lifetimes of cells with those of a tree whose lineage has a clock.

    ``table`` has the columns ``cell`` and ``lifetime_min`` (or ``lifetime_s``, ``lifetime_h``; or ``birth_min`` and
    ``division_min``), and optionally ``embryo``, ``n``, ``sd_min`` and ``birth_min``, or is the file of an embryo that another
    program followed, or several files; ``frame_minutes`` is the time between frames where they are counted, one number or
    one for each embryo by name. Each embryo has its time factor in ``embryos``; ``common_pace`` divides by it before embryos
    are averaged. ``names`` and ``root`` match cells with other names, as for :func:`counts`. Without a table these are
    the published means of 28 embryos of C. elegans. ``tree`` is by default grown from the built-in founders.
    ``volumes`` are tables as for :func:`volumes`; default published ones. ``common_size`` divides the volumes of each embryo by
    its size factor before embryos are averaged. The clock is fitted: lifetimes of the model are no
    predictions.
    """
    if tree is not None and not isinstance(tree, Tree):
        raise refused("tree", tree, "a tree from furrow.tree()")
    grown = (grow() if tree is None else tree)._grown
    asked = times_of(table, volumes, frame_minutes, common_pace, common_size, names, root)
    return Lifetimes(_furrow.compare_lifetimes(grown, asked))


class Dose(Found):
    """Asymmetry over the dose of a protein, and of the model over the strength of its cue: the output of ``furrow compare dose
    --json``."""

    def to_pandas(self) -> pd.DataFrame:
        """One row per bin of the dose: measured means of χ, with sizes read as areas and as volumes, and the model's χ."""
        bins = self["bins"]
        columns: dict[str, list[Any]] = {name: [row[name] for row in bins] for name in ("name", "n")}
        for name in ("dose", "larger_share", "chi_area", "chi_volume"):
            columns[name] = [row[name]["mean"] for row in bins]
            columns[f"{name}_sd"] = [row[name]["sd"] for row in bins]
        columns["model"] = [row["model"]["chi"] for row in bins]
        columns["model_outcome"] = [row["model"]["outcome"] for row in bins]
        return frame(columns)


def dose(
    table: Table | None = None,
    *,
    bins: Sequence[SupportsFloat] | None = None,
    r0: Value | None = None,
    cue: str = "germline",
    lineage: str | os.PathLike[str] | None = None,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    law: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> Dose:
    """Compares asymmetry over the dose of a protein with the model's over the strength of its cue.

    ``table`` has the columns ``dose`` (1 is the wild type) and ``larger_share``, the larger daughter's share of the size of
    both, and optionally ``condition``. Without it the published means over the dose of PAR-6 are used. The cell, of the
    radius ``r0``, has the whole ``cue`` at dose 1 and none at 0. ``bins`` are rising edges of the dose, 0.2 apart by default.
    ``lineage``, ``preset``, ``config``, ``law`` and keywords are those of :class:`furrow.Cell`, and ``memo``, ``threads`` and
    ``progress`` those of :meth:`furrow.Cell.divide`.
    """
    known = memo_of(memo)
    with shown(progress, "divisions") as tell:
        found = _furrow.compare_dose(
            source_of(table),
            None if bins is None else _edges(bins),
            text_of("cue", cue),
            optional_path("lineage", lineage),
            given_of(parameters, preset, config, r0, law),
            known,
            threads_of(threads),
            tell,
        )
    return Dose(found)


@dataclass(frozen=True)
class Mother:
    """Divisions of one mother in the embryos of a group, and in the model.

    ``group``: The group.
    ``mother``: The mother.
    ``n``: Divisions measured.
    ``measured``: Mean of |χ|.
    ``sd``: Its standard deviation.
    ``measured_signed``: Mean of χ as first minus second named daughter; None if a table has no signs.
    ``model``: χ in the tree grown from the zygote; None if it does not divide there.
    ``model_outcome``: Its outcome there.
    ``given_first``: χ in the tree with the measured sizes of AB and P1.
    ``band``: χ over sets of constants: 5 %, median, 95 %.
    """

    group: str
    mother: str
    n: int
    measured: float
    sd: float | None
    measured_signed: float | None
    model: float | None
    model_outcome: str | None
    given_first: float | None
    band: tuple[float, float, float] | None = None


@dataclass(frozen=True, eq=False)
class VolumesComparison:
    """Size asymmetries of measured divisions and of the model.

    ``mothers``: By group and mother.
    ``used``: Number of volumes used.
    ``skipped``: Volumes that could not be used, with reasons.
    ``length_scale``: One L_h, in the cube root of the tables' unit.
    ``of_nuclei``: Whether volumes are those of nuclei, as in files of AceTree: χ is theirs then, not the cells'.
    ``trend``: χ over log₁₀ of the mother's volume: ``line`` (``slope`` per decade, ``slope_error``, …), ``spearman``, and the
        ``line`` of each of the ``embryos``.
    ``noise``: What noise of the measurement makes of equal divisions: its size by ``groups``, ``null_slope``, and ``share``,
        its share of the trend. None unless twenty mothers were measured themselves.
    ``bins``: χ by the mother's volume, largest first.
    ``tests``: Rank-sum tests of adjacent bins.
    ``regressions``: Of two groups: ``through_origin`` and ``with_intercept`` with the errors of both numbers.
    """

    mothers: tuple[Mother, ...] = field(repr=False)
    used: int
    skipped: tuple[dict[str, Any], ...] = field(repr=False)
    length_scale: float | None
    of_nuclei: bool
    trend: Mapping[str, Any] = field(repr=False)
    noise: Mapping[str, Any] | None = field(repr=False)
    bins: tuple[Mapping[str, Any], ...] = field(repr=False)
    tests: tuple[Mapping[str, Any], ...] = field(repr=False)
    regressions: tuple[Mapping[str, Any], ...] = field(repr=False)
    _found: Mapping[str, Any] = field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """The full result as numbers, strings and lists."""
        return dict(self._found)

    def to_pandas(self) -> pd.DataFrame:
        """One row per group and mother."""
        names = list(Mother.__dataclass_fields__)
        return frame({name: [getattr(mother, name) for mother in self.mothers] for name in names})

    def plot(self, *, path: str | os.PathLike[str] | None = None) -> Figure:
        """Measured and computed χ by mother; needs matplotlib. With ``path`` the figure is also written there."""
        from . import plot

        return plot.saved(plot.volumes(self), path)


def volumes(
    table: Table | None = None,
    *,
    published: Literal["jankele2021", "villoutreix2016"] | None = None,
    group: str | None = None,
    against: Table | None = None,
    regress: tuple[str, str] | None = None,
    population: str | Sequence[str] | None = None,
    bins: Sequence[SupportsFloat] | None = None,
    voxel: OfEmbryos | None = None,
    names: Table | None = None,
    root: str | Sequence[str] | None = None,
    unit: Literal["um3", "voxels", "relative"] | None = None,
    length_scale: SupportsFloat | Literal["fit"] | None = None,
    lineage: str | os.PathLike[str] | None = None,
    constants: str | os.PathLike[str] | Constants | None = None,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    law: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> VolumesComparison:
    """Compares size asymmetries of measured divisions with the model.

    ``table`` has the columns ``embryo``, ``cell`` and ``volume`` (or ``volume_um3``, ``volume_voxels``,
    ``relative_volume``) and optionally ``group``, ``frame`` and ``n``. A row can also be a division, with the columns
    ``embryo``, ``mother``, ``larger_um3`` and ``smaller_um3``. It is a file, several files, a DataFrame or columns
    by name. Files can be embryos that other programs followed, as for :func:`counts`, or folders of these; ``names`` and
    ``root`` match cells with other names. Without it the model is compared with ``published`` means, of C. elegans
    (``jankele2021``, the default) or of the sea urchin (``villoutreix2016``). ``group`` is the group of rows that have none.

    ``against`` is a table of a second condition, and ``regress`` names two groups of the tables: both give a regression.
    ``population`` names the populations of a table of divisions that are used, one or several; default all. ``bins`` are
    rising edges of the mother's volume. ``length_scale="fit"`` chooses one L_h by all mothers; without it
    the ``units`` of the lineage count, then P0. ``unit`` is that of tables which name none,
    and ``voxel`` the edge of a voxel in µm, one number or one for each embryo by name.

    ``lineage`` is that of the model, and ``constants`` are sets of constants for its ranges, as for :func:`furrow.tree_ensemble`.
    ``preset``, ``config``, ``law`` and keywords are those of :class:`furrow.Cell`, and ``memo``, ``threads`` and ``progress``
    those of :meth:`furrow.Cell.divide`.
    """
    known = memo_of(memo)
    if published is not None and published not in PUBLISHED:
        raise refused("published", published, f"one of {', '.join(PUBLISHED)}")
    if published is not None and table is not None:
        raise refused("published", published, "left out with a table")
    if against is not None and (table is None or group is not None):
        raise refused("against", against, "given with a table and without group")
    if population is not None and table is None:
        raise refused("population", population, "given with a table")
    populations = [population] if isinstance(population, str) else population
    groups = None if regress is None else texts_of("regress", regress)
    if groups is not None and len(groups) != 2:
        raise refused("regress", regress, "two groups of the tables")
    asked = {
        "tables": tables_of(table),
        "against": tables_of(against, "against"),
        "voxel": of_embryos("voxel", voxel),
        "matching": matching_of(names, root),
        "unit": None if unit is None else text_of("unit", unit),
        "group": None if group is None else text_of("group", group),
        "published": published,
        "bins": None if bins is None else _edges(bins),
        "regress": None if groups is None else (groups[0], groups[1]),
        "population": None if populations is None else texts_of("population", populations),
        "lineage": optional_path("lineage", lineage),
        "constants": None if constants is None else table_of(constants),
        "length_scale": length_scale
        if length_scale is None or isinstance(length_scale, str)
        else positive("length_scale", length_scale),
    }
    with shown(progress, "divisions") as tell:
        found = _furrow.compare_volumes(asked, given_of(parameters, preset, config, law=law), known, threads_of(threads), tell)
    scale = found["length_scale"]
    mothers = [_mother(of["group"], event) for of in found["groups"] for event in of["events"]]
    return VolumesComparison(
        mothers=tuple(mothers),
        used=found["used"],
        skipped=tuple(found["skipped"]),
        length_scale=None if scale is None else scale["length"],
        of_nuclei=found["of_nuclei"],
        trend=found["trend"],
        noise=found["noise"],
        bins=tuple(found["bins"]),
        tests=tuple(found["tests"]),
        regressions=tuple(found["regressions"]),
        _found=found,
    )


def _edges(bins: Sequence[SupportsFloat]) -> list[float]:
    allowed = "two numbers or more, rising"
    if isinstance(bins, str) or not isinstance(bins, Iterable):
        raise refused("bins", bins, allowed)
    edges = [number_of("bins", edge) for edge in bins]
    if len(edges) < 2 or not all(np.isfinite(edges)) or any(a >= b for a, b in pairwise(edges)):
        raise refused("bins", bins, allowed)
    return edges


def _mother(group: str, event: Mapping[str, Any]) -> Mother:
    model, first, band = event["model"], event["given_first"], event.get("band")
    chi = None if band is None else band["chi"]
    return Mother(
        group=group,
        mother=event["mother"],
        n=event["n"],
        measured=event["mean"],
        sd=event["sd"],
        measured_signed=event["mean_signed"],
        model=None if model is None else model["chi"],
        model_outcome=None if model is None else model["outcome"],
        given_first=None if first is None else first["chi"],
        band=None if chi is None else (chi["p5"], chi["p50"], chi["p95"]),
    )


@dataclass(frozen=True, eq=False)
class ContoursComparison:
    """Measured outlines and those of a division.

    ``similarity``: Mean of |A∩B|/|A|, A the measured.
    ``similarity_sd``: Its standard deviation.
    ``length_scale``: One L_h, in the unit of the outlines.
    ``contours``: Each outline that was used: its number as ``file``, the model's time ``t``, ``frame``, ``overlap`` and more.
    ``used``: How many outlines were used.
    ``skipped``: Outlines that could not be used: the number of the ``contour``, and ``why``.
    ``laid``: Both outlines of each pair, overlaid, in L_h, with the long axis along the second coordinate.
    """

    similarity: float
    similarity_sd: float | None
    length_scale: float
    contours: tuple[dict[str, Any], ...] = field(repr=False)
    used: int
    skipped: tuple[dict[str, Any], ...] = field(repr=False)
    laid: tuple[tuple[NDArray[np.float64], NDArray[np.float64]], ...] = field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """The result as numbers, strings and lists, without the outlines."""
        names = ("similarity", "similarity_sd", "length_scale", "used")
        lists = {"contours": list(self.contours), "skipped": list(self.skipped)}
        return {**{name: getattr(self, name) for name in names}, **lists}

    def plot(self, *, path: str | os.PathLike[str] | None = None) -> Figure:
        """The overlaid outlines; needs matplotlib. With ``path`` the figure is also written there."""
        from . import plot

        return plot.saved(plot.contours(self), path)


def contours(
    measured: Iterable[ArrayLike],
    model: Division | Frames | Iterable[Frame],
    *,
    length_scale: SupportsFloat | None = None,
) -> ContoursComparison:
    """Compares outlines of a dividing cell, arrays of (x, y), with those of a division with frames.

    Each outline is overlaid, by centroid and long axis, on the frame with the same furrow depth. All are sections
    through the axis of one cell. Outlines that cannot be used, such as those with fewer than three points, are ``skipped``.
    ``length_scale`` is one L_h in the unit of the outlines; without it all outlines have together the area of the model's.
    """
    frames: Iterable[Frame] | None = model.frames if isinstance(model, Division) else model
    if frames is None:
        raise refused("model", model, "a division with axial symmetry and frames: cell.divide(frames=True)")
    outlines = [_outline(k, points) for k, points in enumerate(measured)]
    sections = []
    for one in frames:
        half = one.contour.points
        other = half[::-1] * np.array([-1.0, 1.0])
        sections.append((one.t, np.ascontiguousarray(np.concatenate((half, other)))))
    scale = None if length_scale is None else positive("length_scale", length_scale)
    found = _furrow.compare_contours(outlines, sections, scale)
    laid = tuple((fixed(np.array(a)), fixed(np.array(b))) for a, b in found["laid"])
    return ContoursComparison(
        similarity=found["similarity"],
        similarity_sd=found["similarity_sd"],
        length_scale=found["length_scale"],
        contours=tuple(found["contours"]),
        used=found["used"],
        skipped=tuple(found["skipped"]),
        laid=laid,
    )


def _outline(k: int, points: ArrayLike) -> NDArray[np.float64]:
    try:
        array = np.ascontiguousarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        raise refused(f"measured[{k}]", points, "an array of (x, y)") from None
    if array.ndim != 2 or array.shape[1] != 2:
        raise refused(f"measured[{k}]", f"an array of the shape {array.shape}", "an array of (x, y), of the shape (n, 2)")
    return array
