"""Results for one cell: divisions with their shapes."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from ._checks import number_of, refused
from ._tables import frame, html_table, shown

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from ._cell import Cell
    from ._surfaces import Neck, Surfaces

Array = NDArray[np.float64]

#: A shape at one time.
One = TypeVar("One")

#: The columns of a contour, with their units.
PLACE_COLUMNS: Mapping[str, str] = {
    "u": "arclength fraction, 0 at the posterior pole",
    "r": "distance from the axis, L_h",
    "z": "position along the axis, L_h",
    "psi": "tangent angle ψ, from 0 to π",
    "c_uu": "meridional curvature c1, 1/L_h",
    "c_pp": "azimuthal curvature c2, 1/L_h",
    "t_uu": "meridional tension T_uu, active and viscous, κ0/L_h²",
    "t_pp": "azimuthal tension T_φφ, active and viscous, κ0/L_h²",
    "v": "tangential velocity towards larger u, L_h/τ",
    "v_n": "normal velocity outwards, L_h/τ",
    "active_t": "active force density along the contour, towards larger u, κ0/L_h³",
    "active_n": "active normal force, outwards as all that follow, κ0/L_h³",
    "viscous_n": "viscous normal force",
    "elastic_n": "elastic normal force: bending and passive tension",
    "pressure_n": "pressure",
    "shell_n": "force of the shell",
    "residual_n": "sum of the five, 0 for an exact solution",
}


@dataclass(frozen=True, eq=False)
class Contour:
    """A shape, point by point from pole to pole: ``contour["r"]`` and the other columns of :data:`PLACE_COLUMNS`.

    For a cell with a regulator there is also ``contour["phi"]``, the regulator φ.

    ``columns``: All columns by name.
    """

    columns: Mapping[str, Array] = field(repr=False)

    def __getitem__(self, name: str) -> Array:
        return self.columns[name]

    def __len__(self) -> int:
        return len(self.columns["u"])

    @property
    def r(self) -> Array:
        """Distance from the axis, in L_h."""
        return self.columns["r"]

    @property
    def z(self) -> Array:
        """Position along the axis, in L_h."""
        return self.columns["z"]

    @property
    def points(self) -> Array:
        """(r, z) of every point."""
        return np.column_stack((self.r, self.z))

    def to_pandas(self) -> pd.DataFrame:
        """One row per point."""
        return frame(self.columns)

    def __repr__(self) -> str:
        return f"<Contour of {len(self)} places>"


@dataclass(frozen=True, eq=False)
class Frame:
    """A dividing cell at one time.

    ``t``: Time, in τ.
    ``length``: Contour length L, in L_h.
    ``pressure``: Pressure p, in κ0/L_h³.
    ``neck_radius``: Radius of the neck, in L_h; None without a waist.
    ``neck_u``: Arclength fraction of the neck.
    ``chi``: |V_above − V_below|/V of the parts above and below the neck.
    ``contour``: The shape.
    """

    t: float
    length: float
    pressure: float
    neck_radius: float | None
    neck_u: float | None
    chi: float | None
    contour: Contour


class Series(Sequence[One]):
    """Shapes over time."""

    if TYPE_CHECKING:
        t: Array

    def _one(self, k: int) -> One:
        raise NotImplementedError

    def __len__(self) -> int:
        return len(self.t)

    @overload
    def __getitem__(self, index: int) -> One: ...
    @overload
    def __getitem__(self, index: slice) -> list[One]: ...
    def __getitem__(self, index: int | slice) -> One | list[One]:
        if isinstance(index, slice):
            return [self._one(k) for k in range(*index.indices(len(self)))]
        k = index + len(self) if index < 0 else index
        if not 0 <= k < len(self):
            raise IndexError(f"frame {index} of {len(self)}")
        return self._one(k)

    def __iter__(self) -> Iterator[One]:
        return (self._one(k) for k in range(len(self)))

    def at(self, t: float) -> One:
        """The frame closest to a time ``t``, in τ."""
        t = number_of("t", t)
        if not np.isfinite(t):
            raise refused("t", t, "a finite number of τ")
        return self[int(np.argmin(np.abs(self.t - t)))]

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {len(self)} from t = 0 to {self.t[-1]:.4g} τ>"


def number(value: np.float64) -> float | None:
    """A number, and None if it is NaN."""
    return None if np.isnan(value) else float(value)


@dataclass(frozen=True, eq=False, repr=False)
class Frames(Series[Frame]):
    """The shapes of a dividing cell. Numbers of all frames are arrays; ``frames[k]`` is one frame, whose contour is a
    view.

    ``t``: Times, in τ.
    ``length``: Contour lengths, in L_h.
    ``pressure``: Pressures, in κ0/L_h³.
    ``neck_radius``: Radii of the neck, in L_h; NaN without a waist.
    ``neck_u``: Arclength fractions of the neck.
    ``chi``: Asymmetry of the parts above and below the neck; NaN without a waist.
    ``shell``: Half axes of the shell along z and across, in L_h; of a profile, those of the ellipsoid of its second moments.
    ``wall``: The wall of the shell as r and z from the pole u = 0 to the other, in L_h: places × 2.
    """

    t: Array
    length: Array
    pressure: Array
    neck_radius: Array
    neck_u: Array
    chi: Array
    shell: tuple[float, float]
    wall: Array
    _places: Mapping[str, Array] = field(repr=False)
    _ends: NDArray[np.int64] = field(repr=False)

    def _one(self, k: int) -> Frame:
        begin = int(self._ends[k - 1]) if k else 0
        places = {name: column[begin : int(self._ends[k])] for name, column in self._places.items()}
        return Frame(
            t=float(self.t[k]),
            length=float(self.length[k]),
            pressure=float(self.pressure[k]),
            neck_radius=number(self.neck_radius[k]),
            neck_u=number(self.neck_u[k]),
            chi=number(self.chi[k]),
            contour=Contour(places),
        )

    def to_pandas(self) -> pd.DataFrame:
        """One row per frame; ``frames[k].contour.to_pandas()`` has the points of one."""
        names = ("t", "length", "pressure", "neck_radius", "neck_u", "chi")
        return frame({name: getattr(self, name) for name in names})


def _plain(value: Any) -> Any:
    """A value that JSON can represent."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if hasattr(value, "to_dict"):
        return value.to_dict()
    return value


#: Fields that results as numbers leave out.
_SHAPES = ("frames", "surfaces")


class Result:
    """Methods of all results."""

    def to_dict(self) -> dict[str, Any]:
        """The result as numbers, strings and lists for JSON."""
        return {f.name: _plain(getattr(self, f.name)) for f in fields(self) if f.name not in _SHAPES}  # type: ignore[arg-type]

    def to_pandas(self) -> pd.DataFrame:
        """One row with every scalar value."""
        values = self.to_dict().items()
        return frame({name: [value] for name, value in values if not isinstance(value, (dict, list))})

    def _rows(self) -> list[tuple[str, str]]:
        values = ((name, value) for name, value in self.to_dict().items() if not isinstance(value, (dict, list)))
        return [(name, shown(value)) for name, value in values]

    def _repr_html_(self) -> str:
        return html_table(self._rows(), type(self).__name__)


@dataclass(frozen=True)
class Division(Result):
    """The outcome of a division and its cost.

    ``cell``: The cell that divided.
    ``seed``: Seed of the noise in its first step.
    ``outcome``: ``symmetric``, ``asymmetric`` or ``failed``.
    ``chi``: Size asymmetry χ = |V1 − V2|/V; None if it failed.
    ``chi_signed``: Positive if the daughter at the pole u = 0 is smaller.
    ``u_furrow``: Furrow position in arclength fraction from the pole u = 0.
    ``t_end``: Time of pinch-off or of rest, in τ.
    ``daughters``: Radii R0 of the daughters below and above the furrow, in L_h.
    ``growth_rate``: Leading growth rate of the shape at rest, in 1/τ.
    ``slow_growth_rate``: For a cell that waits near a stationary shape: the growth rate there, in 1/τ.
    ``volume_drift``: Largest relative deviation of the volume.
    ``steps``: Time steps.
    ``rejected``: Rejected steps.
    ``newton_iterations``: Newton iterations.
    ``factorisations``: Factorisations of a Jacobian.
    ``remeshings``: Changes of the mesh.
    ``phi``: The regulator φ at the furrow at pinch-off, or at u = 0.5 at rest; None without one.
    ``neck_offset``: Distance of the neck's centre from the axis at the end, in L_h; None with axial symmetry.
    ``second_neck``: ``u``, ``radius`` (L_h) and ``share`` (volume beyond it, as a fraction of the cell's) of a second neck that
        is nearly closed at pinch-off, so that the cell falls into three parts; else None.
    ``frames``: Its shapes, if requested; None without axial symmetry.
    ``surfaces``: Its shapes without axial symmetry, if frames are requested.
    ``neck``: Its neck after every step without axial symmetry, if frames are requested.
    ``modes``: Largest azimuthal number in use at the end, as ``neck``.
    """

    cell: Cell = field(repr=False)
    seed: int
    outcome: str
    chi: float | None
    chi_signed: float | None
    u_furrow: float | None
    t_end: float
    daughters: tuple[float, float] | None
    growth_rate: float | None
    slow_growth_rate: float | None
    volume_drift: float
    steps: int
    rejected: int
    newton_iterations: int
    factorisations: int
    remeshings: int
    phi: float | None = None
    neck_offset: float | None = None
    second_neck: Mapping[str, float] | None = None
    frames: Frames | None = field(default=None, repr=False, compare=False)
    surfaces: Surfaces | None = field(default=None, repr=False, compare=False)
    neck: Neck | None = field(default=None, repr=False, compare=False)
    modes: int | None = field(default=None, repr=False, compare=False)

    @property
    def divided(self) -> bool:
        """Whether the cell divided."""
        return self.outcome != "failed"

    def plot(self, *, path: str | os.PathLike[str] | None = None) -> Figure:
        """Contours, asymmetry and the balance of forces, or sections, neck and asymmetry without axial symmetry; needs
        matplotlib and frames. With ``path`` the figure is also written there."""
        from . import plot

        return plot.saved(plot.division(self), path)


def division(cell: Cell, seed: int, record: Mapping[str, Any], **shapes: Any) -> Division:
    """The result from a record of the library, and its shapes."""
    daughters = record.get("daughters")
    return Division(
        cell=cell,
        seed=seed,
        outcome=record["outcome"],
        chi=record.get("chi"),
        chi_signed=record.get("chi_signed"),
        u_furrow=record.get("u_furrow"),
        t_end=record["t_end"],
        daughters=None if daughters is None else (daughters[0], daughters[1]),
        growth_rate=record.get("growth_rate"),
        slow_growth_rate=record.get("slow_growth_rate"),
        volume_drift=record["volume_drift"],
        steps=record["steps"],
        rejected=record["rejected"],
        newton_iterations=record["newton_iterations"],
        factorisations=record["factorisations"],
        remeshings=record["remeshings"],
        phi=record.get("phi"),
        neck_offset=record.get("neck_offset"),
        second_neck=record.get("second_neck"),
        **shapes,
    )


@dataclass(frozen=True, eq=False)
class Replicates(Sequence[Division]):
    """Divisions of one cell with different noise seeds.

    ``divisions``: In order of seeds.
    ``undecided``: Reasons why other seeds could not be computed.
    """

    divisions: tuple[Division, ...]
    undecided: Mapping[int, str]

    def __len__(self) -> int:
        return len(self.divisions)

    @overload
    def __getitem__(self, index: int) -> Division: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Division]: ...
    def __getitem__(self, index: int | slice) -> Division | Sequence[Division]:
        return self.divisions[index]

    @property
    def chi(self) -> Array:
        """χ of each division; NaN if it failed."""
        return np.array([np.nan if d.chi is None else d.chi for d in self.divisions])

    @property
    def chi_mean(self) -> float | None:
        """Mean χ of the cells that divided."""
        chi = self.chi[~np.isnan(self.chi)]
        return float(chi.mean()) if len(chi) else None

    @property
    def chi_sd(self) -> float | None:
        """Standard deviation of χ of the cells that divided: 0 of one, None without any."""
        chi = self.chi[~np.isnan(self.chi)]
        if len(chi) < 2:
            return 0.0 if len(chi) else None
        return float(chi.std(ddof=1))

    def to_dict(self) -> dict[str, Any]:
        """The result as numbers, strings and lists."""
        return {"divisions": [d.to_dict() for d in self.divisions], "undecided": dict(self.undecided)}

    def to_pandas(self) -> pd.DataFrame:
        """One row per division."""
        names = [f.name for f in fields(Division) if f.name not in ("cell", *_SHAPES, "neck", "modes", "daughters")]
        return frame({name: [getattr(d, name) for d in self.divisions] for name in names})

    def __repr__(self) -> str:
        mean = "" if self.chi_mean is None else f", mean χ = {self.chi_mean:.4f}"
        return f"<Replicates: {len(self)} divisions{mean}>"
