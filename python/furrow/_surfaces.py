"""Results for one cell without axial symmetry: its surfaces, and its neck over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ._results import Array, Result, Series, number
from ._tables import frame

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class Neck(Result):
    """The neck of a division without axial symmetry, after every step that has one.

    ``t``: Times, in τ.
    ``radius``: Length over 2π of the shortest ring, in L_h.
    ``offset``: Distance of its centre from the axis, towards +x, in L_h.
    ``position``: Height z of its centre, in L_h.
    ``tilt``: Angle between its plane and the plane across the axis, in degrees, positive if it rises towards +x.
    """

    t: Array = field(repr=False)
    radius: Array = field(repr=False)
    offset: Array = field(repr=False)
    position: Array = field(repr=False)
    tilt: Array = field(repr=False)

    def __len__(self) -> int:
        return len(self.t)

    def to_pandas(self) -> pd.DataFrame:
        """One row per step."""
        return frame({name: getattr(self, name) for name in ("t", "radius", "offset", "position", "tilt")})

    def __repr__(self) -> str:
        return f"<Neck after {len(self)} steps>"


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface without axial symmetry, at points on rings around the axis and on meridians from pole to pole.

    The first ring is the posterior pole and the last the anterior one: all points of such a ring are the same. Meridian j is
    at φ = 2π j / (number of meridians), the first at +x, where one-sided necks move; the first is not repeated.

    ``u``: Arclength fraction of each ring on the mean meridian, 0 at the posterior pole.
    ``positions``: x, y and z, in L_h: rings × meridians × 3. The axis of the shell is z.
    ``normals``: Outward normals of length 1: rings × meridians × 3.
    ``tension``: Mean active tension, in κ0/L_h²: rings × meridians.
    """

    u: Array = field(repr=False)
    positions: Array = field(repr=False)
    normals: Array = field(repr=False)
    tension: Array = field(repr=False)

    @property
    def section(self) -> Array:
        """(x, z) of the section by the plane y = 0, in L_h: from the posterior pole along φ = 0, and back along φ = π."""
        ahead, behind = self.positions[:, 0], self.positions[::-1, self.positions.shape[1] // 2]
        return np.concatenate((ahead, behind))[:, [0, 2]]

    def to_dict(self) -> dict[str, list[object]]:
        """The arrays as lists, by name."""
        return {name: getattr(self, name).tolist() for name in ("u", "positions", "normals", "tension")}

    def __repr__(self) -> str:
        rings, meridians, _ = self.positions.shape
        return f"<Surface of {rings} rings × {meridians} meridians>"


@dataclass(frozen=True, eq=False)
class SurfaceFrame:
    """A dividing cell without axial symmetry at one time.

    ``t``: Time, in τ.
    ``length``: Length of the mean meridian, in L_h.
    ``pressure``: Pressure p, in κ0/L_h³.
    ``neck_radius``: Length of the neck over 2π, in L_h; None without a waist, as all that follow.
    ``neck_offset``: Distance of the neck's centre from the axis, towards +x, in L_h.
    ``neck_position``: Height z of the neck's centre, in L_h.
    ``chi``: |V_above − V_below|/V of the parts above and below the neck.
    ``surface``: The shape.
    """

    t: float
    length: float
    pressure: float
    neck_radius: float | None
    neck_offset: float | None
    neck_position: float | None
    chi: float | None
    surface: Surface


@dataclass(frozen=True, eq=False, repr=False)
class Surfaces(Series[SurfaceFrame]):
    """The shapes of a dividing cell without axial symmetry. Numbers of all frames are arrays; ``surfaces[k]`` is one frame,
    whose surface is a view.

    ``t``: Times, in τ.
    ``length``: Lengths of the mean meridian, in L_h.
    ``pressure``: Pressures, in κ0/L_h³.
    ``neck_radius``: Lengths of the neck over 2π, in L_h; NaN without a waist, as all that follow.
    ``neck_offset``: Distances of the neck's centre from the axis, towards +x, in L_h.
    ``neck_position``: Heights z of the neck's centre, in L_h.
    ``chi``: Asymmetry of the parts above and below the neck.
    ``u``: Arclength fractions of the rings on the mean meridian: frames × rings.
    ``positions``: x, y and z, in L_h: frames × rings × meridians × 3.
    ``normals``: Outward normals of length 1: frames × rings × meridians × 3.
    ``tension``: Mean active tension, in κ0/L_h²: frames × rings × meridians.
    ``shell``: Half axes of the shell along x, y and z, in L_h; of a profile, those of the ellipsoid of its second moments.
    ``wall``: Its section through the axis and x as r and z from the pole u = 0 to the other, in L_h: places × 2.
    """

    t: Array
    length: Array
    pressure: Array
    neck_radius: Array
    neck_offset: Array
    neck_position: Array
    chi: Array
    shell: tuple[float, float, float]
    wall: Array
    u: Array
    positions: Array
    normals: Array
    tension: Array

    def _one(self, k: int) -> SurfaceFrame:
        return SurfaceFrame(
            t=float(self.t[k]),
            length=float(self.length[k]),
            pressure=float(self.pressure[k]),
            neck_radius=number(self.neck_radius[k]),
            neck_offset=number(self.neck_offset[k]),
            neck_position=number(self.neck_position[k]),
            chi=number(self.chi[k]),
            surface=surface({name: getattr(self, name) for name in ("u", "positions", "normals", "tension")}, k),
        )

    def to_pandas(self) -> pd.DataFrame:
        """One row per frame, without the points."""
        names = ("t", "length", "pressure", "neck_radius", "neck_offset", "neck_position", "chi")
        return frame({name: getattr(self, name) for name in names})


def surface(arrays: Mapping[str, Array], k: int = 0) -> Surface:
    """One of several surfaces."""
    return Surface(**{name: array[k] for name, array in arrays.items()})
