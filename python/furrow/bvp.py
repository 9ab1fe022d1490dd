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

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, SupportsFloat, SupportsIndex

import numpy as np

from . import _furrow
from ._checks import ARGUMENTS, number_of, refused, whole
from ._errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ._furrow import Collocation

_Function = Callable[..., Any]

#: Most nodes of a mesh, and most nodes times n^2: with more, memory may run out, which ends the process without an error.
_MOST_NODES, _MOST_VALUES = 1_000_000, 16_000_000

#: Most nodes unless others are asked for.
_NODES = 2000


@dataclass(frozen=True, eq=False)
class Solution:
    """A solution of a boundary-value problem, as an object of :func:`scipy.integrate.solve_bvp` where names are the same.

    ``found["x"]`` is ``found.x``. It can be pickled and copied.

    ``x``: Nodes of the mesh; (m,).
    ``y``: Values at the nodes; (n, m).
    ``yp``: Slopes at the nodes; (n, m).
    ``p``: Scalar unknowns; None for a problem without them.
    ``rms_residuals``: Root of the mean square of (y' - f)/(1 + abs(f)) on every interval, summed over the components; (m - 1,).
    ``defect``: Largest defect abs(y' - f) h / (1 + abs(y)).
    ``condition``: An estimate, from below, of how much the solution changes per change of the equations.
    ``error``: Estimated error abs(dy) / (1 + abs(y)) where ``error_tol`` bounds it; None otherwise.
    ``niter``: Iterations of Newton's method on all meshes.
    ``status``: 0; a call without a solution raises an error.
    ``message``: The message of SciPy for this status.
    ``success``: True.
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    yp: NDArray[np.float64]
    p: NDArray[np.float64] | None
    rms_residuals: NDArray[np.float64]
    defect: float
    condition: float
    error: float | None
    niter: int
    _collocation: Collocation
    status: int = 0
    message: str = "The algorithm converged to the desired accuracy."
    success: bool = True

    def sol(self, x: ArrayLike, nu: SupportsIndex = 0) -> NDArray[np.float64]:
        """Values, or first derivatives with nu=1, at any x within the mesh: (n,) at a number, (n, k) at k numbers."""
        order = _derivative(nu)
        at = _within(_real("x", x), self.x[0], self.x[-1])
        rows = self._collocation.at(np.ascontiguousarray(at.ravel()), order == 1).reshape(-1, len(self.y))
        return np.moveaxis(rows.reshape(*at.shape, len(self.y)), -1, 0)

    def keys(self) -> list[str]:
        """The names of the results."""
        return [field.name for field in fields(self) if not field.name.startswith("_")] + ["sol"]

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def __getitem__(self, name: str) -> Any:
        if name not in self.keys():
            raise KeyError(name)
        return getattr(self, name)


def solve_bvp(
    fun: _Function,
    bc: _Function,
    x: ArrayLike,
    y: ArrayLike,
    p: ArrayLike | None = None,
    S: ArrayLike | None = None,
    fun_jac: _Function | None = None,
    bc_jac: _Function | None = None,
    tol: SupportsFloat = 1e-6,
    max_nodes: SupportsIndex = _NODES,
    verbose: SupportsIndex = 0,
    bc_tol: SupportsFloat | None = None,
    *,
    besides: Sequence[Solution] = (),
    error_tol: SupportsFloat | None = None,
) -> Solution:
    """Solves y' = f(x, y, p) + S y/(x - a) with conditions bc(y(a), y(b), p) = 0, from a guess y of shape (n, m) at m nodes x.

    ``fun(x, y)`` or, with p, ``fun(x, y, p)`` gives the slopes f of shape (n, k) at k points; ``bc(ya, yb)`` or ``bc(ya, yb, p)``
    as many numbers as there are components and scalar unknowns. ``fun_jac`` and ``bc_jac`` give their derivatives in the shapes
    that SciPy takes; without them derivatives are differences. All values are real: real and imaginary parts are components.

    The singular term is left out without ``S``, a matrix of shape (n, n). ``fun`` and ``fun_jac`` do not have it. A solution is
    regular at a if S y(a) = 0. The conditions must imply this: unlike SciPy, furrow does not project y(a).

    ``tol`` bounds the defect, and ``max_nodes`` the nodes of the mesh: at most 1000000, and 16000000/n^2 for many components. By
    default ``tol`` is smaller, and ``max_nodes`` larger, than in SciPy. Both the defect and the error are relative above 1 and
    absolute below: scale unknowns that are small throughout.
    ``error_tol`` bounds the estimated error abs(dy) / (1 + abs(y)) of every component as well; a second solution, on halved
    intervals, estimates it and is returned.
    With ``verbose`` 1 or 2 a line is printed at the end. ``bc_tol`` is taken for SciPy's sake and not needed: the conditions are
    solved as accurately as Newton's method solves the equations.

    A problem with several solutions gives another one for each call if those found before are passed as ``besides``.

    A problem is called singular if the condition at its solution is above 1e12, or grows without bound on halved intervals:
    it then has a family of solutions or none. An iterate that approaches one from a rough guess gets the same message.

    Raises :class:`furrow.NoOutcome` if no solution is found, :class:`furrow.InputError` for arguments that do not fit, and the
    exceptions of the functions.
    """
    _functions(fun=fun, bc=bc, fun_jac=fun_jac, bc_jac=bc_jac)
    nodes, guess = _guess(x, y)
    unknown = None if p is None else _finite("p", _real("p", p).ravel())
    told = whole("verbose", verbose, 0, 2)
    if bc_tol is not None:
        _tolerance("bc_tol", bc_tol)
    mesh, scalars, collocation, (defect, condition, error), residuals, iterations = _furrow.solve_bvp(
        (fun, bc),
        (fun_jac, bc_jac),
        nodes,
        guess,
        unknown,
        _singular(S, len(guess)),
        _known(besides, nodes, len(guess), unknown),
        (_tolerance("tol", tol), None if error_tol is None else _tolerance("error_tol", error_tol)),
        _most_nodes(max_nodes, *guess.shape) - 1,
    )

    def at(slope: bool) -> NDArray[np.float64]:
        return np.ascontiguousarray(collocation.at(mesh, slope).reshape(len(mesh), -1).T)

    if told:
        print(f"Solved in {iterations} iterations, number of nodes {len(mesh)}, largest defect {defect:.1e}.")
    found = None if unknown is None else scalars
    return Solution(mesh, at(False), at(True), found, residuals, defect, condition, error, iterations, collocation)


def _unfit(field: str, shown: str, allowed: str) -> InputError:
    """The error for an argument whose value is described in words."""
    return InputError(f"{ARGUMENTS}: {field} = {shown}: must be {allowed}", field, shown, allowed, ARGUMENTS)


def _functions(**functions: object) -> None:
    """Refuses what cannot be called; derivatives may be left out."""
    for name, function in functions.items():
        if not callable(function) and not (name.endswith("_jac") and function is None):
            raise refused(name, function, "a function")


def _real(field: str, value: ArrayLike) -> NDArray[np.float64]:
    """An array of real numbers, which may be infinite or no numbers."""
    allowed = "a real number or an array of real numbers"
    try:
        if _is_masked(value):
            raise _unfit(field, "an array with masked entries", "numbers throughout: fill the masked entries")
        found = np.asarray(value)
        if np.iscomplexobj(found):
            raise _unfit(field, "complex numbers", "real values: state real and imaginary parts as components")
        if found.dtype.kind not in "biufO":
            raise refused(field, value, allowed)
        return np.asarray(found, dtype=np.float64, order="C")
    except InputError:
        raise
    except (TypeError, ValueError, OverflowError):
        raise refused(field, value, allowed) from None


def _is_masked(value: object) -> bool:
    """Whether an array, or a row of a list of them, has masked entries, which would be taken as numbers."""
    return bool(np.ma.is_masked(value)) or (isinstance(value, (list, tuple)) and any(map(np.ma.is_masked, value)))


def _finite(field: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Refuses infinite values and those that are no numbers."""
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        place = ", ".join(map(str, bad[0]))
        raise _unfit(field, f"{values[tuple(bad[0])]} at [{place}]", "finite numbers")
    return values


def _guess(x: ArrayLike, y: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The mesh and the guess at its nodes."""
    nodes, guess = _real("x", x), _real("y", y)
    if nodes.ndim != 1 or not 2 <= len(nodes) <= _MOST_NODES:
        raise _unfit("x", f"an array of shape {nodes.shape}", f"an array of shape (m,) with m from 2 to {_MOST_NODES} nodes")
    _finite("x", nodes)
    back = np.flatnonzero(np.diff(nodes) <= 0)
    if len(back):
        before, at = nodes[back[0] : back[0] + 2]
        raise _unfit("x", f"{at:.6g} at [{back[0] + 1}] after {before:.6g}", "numbers that increase from node to node")
    if guess.ndim != 2 or guess.shape[1] != len(nodes) or not len(guess):
        shapes = f"an array of shape {guess.shape}"
        raise _unfit("y", shapes, f"an array of shape (n, {len(nodes)}): a row of values at the nodes x for every component")
    if len(nodes) > _limit(len(guess)):
        raise _unfit("x", f"{len(nodes)} nodes", f"at most {_limit(len(guess))} nodes for {len(guess)} components")
    return nodes, _finite("y", guess)


def _tolerance(field: str, value: SupportsFloat) -> float:
    """A bound that an error can be below."""
    number = number_of(field, value)
    if not 0 < number < np.inf:
        raise refused(field, number, "a finite number above 0")
    return number


def _limit(n: int) -> int:
    """The most nodes that are taken for n components."""
    return max(_NODES, min(_MOST_NODES, _MOST_VALUES // max(n, 1) ** 2))


def _most_nodes(value: SupportsIndex, n: int, nodes: int) -> int:
    """The most nodes of a mesh that begins with some."""
    try:
        return whole("max_nodes", value, nodes, _limit(n))
    except InputError:
        least = f"at least the number of nodes of x, {nodes}"
        allowed = f"a whole number, {least}, and at most {_limit(n)} for {n} components"
        raise refused("max_nodes", value, allowed) from None


def _singular(S: ArrayLike | None, n: int) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """S, and the matrix that gives the slopes at the left end."""
    if S is None:
        return None
    matrix = _real("S", S)
    if matrix.shape != (n, n):
        raise _unfit("S", f"an array of shape {matrix.shape}", f"an array of shape ({n}, {n})")
    return _finite("S", matrix), np.ascontiguousarray(np.linalg.pinv(np.identity(n) - matrix))


def _known(besides: Sequence[Solution], nodes: NDArray[np.float64], n: int, p: NDArray[np.float64] | None) -> list[Collocation]:
    """The polynomials of known solutions of a problem with n components on the interval of some nodes."""
    allowed = "a list of results of furrow.bvp.solve_bvp"
    if isinstance(besides, Solution):
        raise _unfit("besides", "one solution", allowed)
    try:
        known = list(besides)
    except TypeError:
        raise refused("besides", besides, allowed) from None
    for one in known:
        if not isinstance(one, Solution):
            raise refused("besides", one, allowed)
        sizes, own = (len(one.y), 0 if one.p is None else len(one.p)), (n, 0 if p is None else len(p))
        if sizes != own:
            found, needed = (f"{c} components and {s} scalar unknowns" for c, s in (sizes, own))
            raise _unfit("besides", f"a solution of {found}", f"solutions of this problem, which has {needed}")
        _same_interval(one.x, nodes)
    return [one._collocation for one in known]


def _same_interval(known: NDArray[np.float64], nodes: NDArray[np.float64]) -> None:
    """Refuses a known solution on another interval than that of the nodes, except for rounding."""
    slack = 1e-9 * (nodes[-1] - nodes[0])
    if abs(known[0] - nodes[0]) > slack or abs(known[-1] - nodes[-1]) > slack:
        found, needed = (f"from {x[0]:.6g} to {x[-1]:.6g}" for x in (known, nodes))
        raise _unfit("besides", f"a solution {found}", f"solutions on the interval of this problem, {needed}")


def _derivative(nu: SupportsIndex) -> int:
    """The order of a derivative that is offered."""
    try:
        return whole("nu", nu, 0, 1)
    except InputError:
        raise refused("nu", nu, "0 or 1") from None


def _within(x: NDArray[np.float64], left: float, right: float) -> NDArray[np.float64]:
    """Refuses places outside a mesh. Rounding may take an end out of it."""
    slack = 4 * np.spacing(max(abs(left), abs(right)))
    outside = np.argwhere(~((x >= left - slack) & (x <= right + slack)))
    if len(outside):
        place = ", ".join(map(str, outside[0]))
        at = f" at [{place}]" if place else ""
        raise _unfit("x", f"{x[tuple(outside[0])]}{at}", f"within the mesh, from {left} to {right}")
    return np.clip(x, left, right)
