"""Boundary-value problems of ordinary differential equations, by the collocation that furrow solves its own with.

>>> import numpy as np
>>> import furrow
>>> def fun(x, y):
...     return np.vstack((y[1], -np.exp(y[0])))
>>> def bc(ya, yb):
...     return np.array([ya[0], yb[0]])
>>> found = furrow.bvp.solve_bvp(fun, bc, np.linspace(0, 1, 5), np.zeros((2, 5)))
>>> round(float(found.sol(0.5)[0]), 6)
0.140539
>>> with np.errstate(over="ignore"):
...     second = furrow.bvp.solve_bvp(fun, bc, np.linspace(0, 1, 9), np.zeros((2, 9)), besides=[found])
>>> round(float(second.sol(0.5)[0]), 4)
4.0915
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _furrow
from ._checks import refused

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ._furrow import Collocation

_Function = Callable[..., Any]


@dataclass(frozen=True)
class Solution:
    """A solution of a boundary-value problem, as an object of :func:`scipy.integrate.solve_bvp` where names are the same."""

    #: Nodes of the mesh; (m,).
    x: NDArray[np.float64]
    #: Values at the nodes; (n, m).
    y: NDArray[np.float64]
    #: Slopes at the nodes; (n, m).
    yp: NDArray[np.float64]
    #: Scalar unknowns; None for a problem without them.
    p: NDArray[np.float64] | None
    #: Largest defect abs(y' - f) h / (1 + abs(y)).
    defect: float
    #: By how much the solution changes at most per change of the equations.
    condition: float
    #: Iterations of Newton's method on all meshes.
    niter: int
    _collocation: Collocation

    def sol(self, x: ArrayLike, nu: int = 0) -> NDArray[np.float64]:
        """Values, or first derivatives with nu=1, at any x within the mesh: (n,) at a number, (n, k) at k numbers."""
        if nu not in (0, 1):
            raise refused("nu", nu, "0 or 1")
        at = np.asarray(x, dtype=np.float64)
        rows = self._collocation.at(np.ascontiguousarray(at.ravel()), nu == 1).reshape(-1, len(self.y))
        return np.moveaxis(rows.reshape(*at.shape, len(self.y)), -1, 0)


def solve_bvp(
    fun: _Function,
    bc: _Function,
    x: ArrayLike,
    y: ArrayLike,
    p: ArrayLike | None = None,
    *,
    fun_jac: _Function | None = None,
    bc_jac: _Function | None = None,
    besides: Sequence[Solution] = (),
    tol: float = 1e-6,
    max_nodes: int = 2000,
) -> Solution:
    """Solves y' = f(x, y, p) with conditions bc(y(a), y(b), p) = 0, from a guess y of shape (n, m) at the m nodes x.

    ``fun(x, y)`` or, with p, ``fun(x, y, p)`` gives the slopes of shape (n, k) at k points; ``bc(ya, yb)`` or ``bc(ya, yb, p)``
    as many numbers as there are components and scalar unknowns. ``fun_jac`` and ``bc_jac`` give their derivatives in the shapes
    that SciPy takes; without them derivatives are differences. ``tol`` bounds the defect. Singular terms are not offered.

    A problem with several solutions gives another one for each call if those found before are passed as ``besides``.

    Raises :class:`furrow.NoOutcome` if no solution is found, :class:`furrow.InputError` for arguments that do not fit, and the
    exceptions of the functions.
    """
    nodes = np.ascontiguousarray(x, dtype=np.float64)
    guess = np.ascontiguousarray(y, dtype=np.float64)
    if nodes.ndim != 1 or guess.ndim != 2 or guess.shape[1] != len(nodes):
        shapes = f"x of shape {nodes.shape} and y of shape {guess.shape}"
        raise refused("y", shapes, "x of shape (m,) and y of shape (n, m)")
    unknown = None if p is None else np.ascontiguousarray(p, dtype=np.float64).ravel()
    mesh, scalars, collocation, (defect, condition), iterations = _furrow.solve_bvp(
        (fun, bc),
        (fun_jac, bc_jac),
        nodes,
        guess,
        unknown,
        [known._collocation for known in besides],
        float(tol),
        int(max_nodes) - 1,
    )

    def at(slope: bool) -> NDArray[np.float64]:
        return np.ascontiguousarray(collocation.at(mesh, slope).reshape(len(mesh), -1).T)

    found = None if unknown is None else scalars
    return Solution(mesh, at(False), at(True), found, defect, condition, iterations, collocation)
