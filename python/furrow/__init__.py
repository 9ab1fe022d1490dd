"""furrow predicts from mechanics how the cells of an embryo divide.

>>> import furrow
>>> zygote = furrow.Cell(r0=5.4, cue="germline")
>>> division = zygote.divide()
>>> round(division.chi, 3)
0.185

Lengths are in L_h, times in τ, activities in κ0/L_h; ξ_s is the published activity. Parameters have the names of the
command line, which the book explains. Installations with the same ``solver_version`` give bit-identical divisions
and share cached ones.
"""

from __future__ import annotations

from . import bvp, cache, compare, fit
from ._branches import Branch, Crossing, Curve, Event, HopfPoint, Pitchfork, Steady
from ._cell import Cell, Value
from ._errors import InputError, Interrupted, NoOutcome
from ._files import Reproduction, explore, merge, new_lineage, reproduce, tree_schema
from ._founders import Founder
from ._furrow import Drawing, Memo, __version__, parameter_names, presets, solver_version
from ._grow import NewCell, Scenarios, grow, scenarios, tree, tree_ensemble
from ._hypotheses import Hypotheses, test
from ._memo import memo, use_store
from ._observed import export_observed
from ._results import PLACE_COLUMNS, Contour, Division, Frame, Frames, Replicates
from ._shapes import Boundary, Checks, CriticalRadius, Perturbation, Perturbations, Phase, Polarity, polarity
from ._solve import solve
from ._studies import Calibration, Constants, Front, Ranges, calibrate, ensemble, front
from ._surfaces import Neck, Surface, SurfaceFrame, Surfaces
from ._sweep import Sweep, sweep
from ._tree import Tree, TreeCell, read_tree

__all__ = [
    "PLACE_COLUMNS",
    "Boundary",
    "Branch",
    "Calibration",
    "Cell",
    "Checks",
    "Constants",
    "Contour",
    "CriticalRadius",
    "Crossing",
    "Curve",
    "Division",
    "Drawing",
    "Event",
    "Founder",
    "Frame",
    "Frames",
    "Front",
    "HopfPoint",
    "Hypotheses",
    "InputError",
    "Interrupted",
    "Memo",
    "Neck",
    "NewCell",
    "NoOutcome",
    "Perturbation",
    "Perturbations",
    "Phase",
    "Pitchfork",
    "Polarity",
    "Ranges",
    "Replicates",
    "Reproduction",
    "Scenarios",
    "Steady",
    "Surface",
    "SurfaceFrame",
    "Surfaces",
    "Sweep",
    "Tree",
    "TreeCell",
    "Value",
    "__version__",
    "bvp",
    "cache",
    "calibrate",
    "compare",
    "ensemble",
    "explore",
    "export_observed",
    "fit",
    "front",
    "grow",
    "memo",
    "merge",
    "new_lineage",
    "parameter_names",
    "polarity",
    "presets",
    "read_tree",
    "reproduce",
    "scenarios",
    "solve",
    "solver_version",
    "sweep",
    "test",
    "tree",
    "tree_ensemble",
    "tree_schema",
    "use_store",
]
