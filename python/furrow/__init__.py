"""furrow predicts from mechanics how the cells of an embryo divide.

>>> import furrow
>>> zygote = furrow.Cell(r0=5.4, cue="germline")
>>> division = zygote.divide()
>>> round(division.chi, 3)
0.185

Lengths are in L_h, times in τ, activities in κ0/L_h; ξ_s is the published activity. Parameters have the names of the
command line, which GUIDE.md explains. Installations with the same ``solver_version`` give bit-identical divisions
and share cached ones.
"""

from __future__ import annotations

from . import compare, fit
from ._cell import Cell, Value
from ._errors import InputError, Interrupted, NoOutcome
from ._founders import Founder
from ._furrow import Memo, __version__, parameter_names, presets, solver_version
from ._memo import memo, use_store
from ._results import (
    PLACE_COLUMNS,
    Branch,
    Contour,
    Curve,
    Division,
    Event,
    Frame,
    Frames,
    Pitchfork,
    Replicates,
    Steady,
)
from ._solve import solve
from ._studies import Calibration, Constants, Ranges, calibrate, ensemble
from ._sweep import Sweep, sweep
from ._tree import Scenarios, Tree, read_tree, tree

__all__ = [
    "PLACE_COLUMNS",
    "Branch",
    "Calibration",
    "Cell",
    "Constants",
    "Contour",
    "Curve",
    "Division",
    "Event",
    "Founder",
    "Frame",
    "Frames",
    "InputError",
    "Interrupted",
    "Memo",
    "NoOutcome",
    "Pitchfork",
    "Ranges",
    "Replicates",
    "Scenarios",
    "Steady",
    "Sweep",
    "Tree",
    "Value",
    "__version__",
    "calibrate",
    "compare",
    "ensemble",
    "fit",
    "memo",
    "parameter_names",
    "presets",
    "read_tree",
    "solve",
    "solver_version",
    "sweep",
    "tree",
    "use_store",
]
