"""Compares the model with measured embryos."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, SupportsFloat, SupportsIndex, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _furrow
from ._cell import _number
from ._checks import given_of, path_of, refused, text_of, threads_of
from ._memo import memo as shared_memo
from ._progress import Progress, shown
from ._results import Division, Frame, Frames
from ._studies import Constants, table_of
from ._tables import frame
from ._tree import Tree

if TYPE_CHECKING:
    from typing import TypeAlias

    import pandas as pd
    from matplotlib.figure import Figure

    from ._cell import Value
    from ._furrow import Memo

#: A file, several, a DataFrame, or columns by name.
Table: TypeAlias = Union[str, "os.PathLike[str]", Sequence[Union[str, "os.PathLike[str]"]], Mapping[str, Any], "pd.DataFrame"]


class Counts(Mapping[str, Any]):
    """Rounds of a tree and the observed rounds, for every definition of "rounds": the output of ``furrow compare counts
    --json``."""

    def __init__(self, found: Mapping[str, Any]) -> None:
        self._found = dict(found)

    def __getitem__(self, name: str) -> Any:
        return self._found[name]

    def __iter__(self) -> Any:
        return iter(self._found)

    def __len__(self) -> int:
        return len(self._found)

    def to_dict(self) -> dict[str, Any]:
        """The result as numbers, strings and lists."""
        return dict(self._found)

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


def counts(tree: Tree) -> Counts:
    """Compares rounds of a tree with the counts that its lineage file gives, for every definition of "rounds"; those of
    C. elegans at several stages (Sulston et al. 1983)."""
    if not isinstance(tree, Tree):
        raise refused("tree", tree, "a tree from furrow.tree()")
    return Counts(json.loads(_furrow.compare_counts(tree._grown)))


@dataclass(frozen=True)
class Mother:
    """Divisions of one mother in the embryos of a group, and in the model."""

    group: str  #: The group.
    mother: str  #: The mother.
    n: int  #: Divisions measured.
    measured: float  #: Mean of |χ|.
    sd: float | None  #: Its standard deviation.
    measured_signed: float  #: Mean of χ as first minus second named daughter.
    model: float | None  #: χ in the tree grown from the zygote; None if it does not divide there.
    model_outcome: str | None  #: Its outcome there.
    given_first: float | None  #: χ in the tree with the measured sizes of AB and P1.
    band: tuple[float, float, float] | None = None  #: χ over sets of constants: 5 %, median, 95 %.


@dataclass(frozen=True, eq=False)
class VolumesComparison:
    """Size asymmetries of measured divisions and of the model."""

    mothers: tuple[Mother, ...] = field(repr=False)  #: By group and mother.
    used: int  #: Number of volumes used.
    skipped: tuple[dict[str, Any], ...] = field(repr=False)  #: Volumes that could not be used, with reasons.
    length_scale: float | None  #: One L_h, in the cube root of the tables' unit.
    _found: Mapping[str, Any] = field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """The full result as numbers, strings and lists."""
        return dict(self._found)

    def to_pandas(self) -> pd.DataFrame:
        """One row per group and mother."""
        names = list(Mother.__dataclass_fields__)
        return frame({name: [getattr(mother, name) for mother in self.mothers] for name in names})

    def plot(self, *, path: str | None = None) -> Figure:
        """Measured and computed χ by mother; needs matplotlib."""
        from . import plot

        return plot.saved(plot.volumes(self), path)


def volumes(
    table: Table | None = None,
    *,
    group: str | None = None,
    voxel: SupportsFloat | None = None,
    length_scale: SupportsFloat | None = None,
    lineage: str | os.PathLike[str] | None = None,
    constants: str | os.PathLike[str] | Constants | None = None,
    preset: str = "gao2026",
    config: str | os.PathLike[str] | None = None,
    memo: Memo | None = None,
    threads: SupportsIndex | None = None,
    progress: Progress = None,
    **parameters: Value,
) -> VolumesComparison:
    """Compares size asymmetries of measured divisions with the model.

    ``table`` has the columns ``embryo``, ``cell`` and ``volume`` (or ``volume_um3``, ``volume_voxels``,
    ``relative_volume``) and optionally ``group``, ``frame`` and ``n``. It is a file, several files, a DataFrame or columns
    by name. Without it the model is compared with published means.
    """
    known = shared_memo() if memo is None else memo
    files, text = _table(table)
    with shown(progress, "divisions") as tell:
        found = json.loads(
            _furrow.compare_volumes(
                files,
                text,
                None if voxel is None else _positive("voxel", voxel),
                None if group is None else text_of("group", group),
                None if lineage is None else path_of("lineage", lineage),
                None if constants is None else table_of(constants),
                None if length_scale is None else _positive("length_scale", length_scale),
                given_of(parameters, preset, config),
                known,
                threads_of(threads),
                tell,
            )
        )
    scale = found["length_scale"]
    mothers = [_mother(of["group"], event) for of in found["groups"] for event in of["events"]]
    return VolumesComparison(
        mothers=tuple(mothers),
        used=found["used"],
        skipped=tuple(found["skipped"]),
        length_scale=None if scale is None else scale["length"],
        _found=found,
    )


def _positive(name: str, value: SupportsFloat) -> float:
    number = _number(name, value)
    if not (np.isfinite(number) and number > 0.0):
        raise refused(name, value, "a finite number above 0")
    return number


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


def _table(table: Table | None) -> tuple[list[str], str | None]:
    """Files, or a table as CSV."""
    if table is None:
        return [], None
    if isinstance(table, (str, os.PathLike)):
        return [path_of("table", table)], None
    if hasattr(table, "to_csv") and hasattr(table, "columns"):
        return [], str(table.to_csv(index=False))
    if isinstance(table, Mapping):
        columns = {text_of("table", name): list(values) for name, values in table.items()}
        if len({len(values) for values in columns.values()}) > 1:
            raise refused("table", {name: len(values) for name, values in columns.items()}, "columns of equal length")
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(columns)
        # str of a float has all its digits.
        writer.writerows(zip(*columns.values(), strict=True))
        return [], out.getvalue()
    if isinstance(table, Iterable):
        return [path_of("table", one) for one in table], None
    raise refused("table", table, "a file, several files, a DataFrame or columns by name")


@dataclass(frozen=True, eq=False)
class ContoursComparison:
    """Measured outlines and those of a division."""

    similarity: float  #: Mean of |A∩B|/|A|, A the measured.
    similarity_sd: float | None  #: Its standard deviation.
    length_scale: float  #: One L_h, in the unit of the outlines.
    contours: tuple[dict[str, Any], ...] = field(
        repr=False
    )  #: Each outline: the model's time ``t``, ``frame``, ``overlap`` and more.
    laid: tuple[tuple[NDArray[np.float64], NDArray[np.float64]], ...] = field(repr=False)
    """Both outlines of each pair, overlaid, in L_h, with the long axis along the second coordinate."""

    def to_dict(self) -> dict[str, Any]:
        """The result as numbers, strings and lists, without the outlines."""
        names = ("similarity", "similarity_sd", "length_scale")
        return {**{name: getattr(self, name) for name in names}, "contours": list(self.contours)}

    def plot(self, *, path: str | None = None) -> Figure:
        """The overlaid outlines; needs matplotlib."""
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
    through the axis of one cell.
    """
    frames: Iterable[Frame] | None = model.frames if isinstance(model, Division) else model
    if frames is None:
        raise refused("model", model, "a division with frames: cell.divide(frames=True)")
    outlines = [_outline(k, points) for k, points in enumerate(measured)]
    sections = []
    for one in frames:
        half = one.contour.points
        other = half[::-1] * np.array([-1.0, 1.0])
        sections.append((one.t, np.ascontiguousarray(np.concatenate((half, other)))))
    scale = None if length_scale is None else _positive("length_scale", length_scale)
    found = json.loads(_furrow.compare_contours(outlines, sections, scale))
    laid = tuple((np.array(a), np.array(b)) for a, b in found["laid"])
    return ContoursComparison(
        similarity=found["similarity"],
        similarity_sd=found["similarity_sd"],
        length_scale=found["length_scale"],
        contours=tuple(found["contours"]),
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
