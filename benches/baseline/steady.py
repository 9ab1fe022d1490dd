"""Mirror-symmetric stationary shapes with scipy.integrate.solve_bvp.

    python steady.py                  # the xi_s of the reference branch at R0 = 2.00
    python steady.py --r0 3 --xi 15   # one shape, timed

Half domain x = 2u in [0, 1], unknown parameters (L, p), the limits of the equations
taken at the pole. Prints JSON.
"""

import argparse
import csv
import json
import os
import time

from model import M, PSI, Q, R, T, V_T, VOL, Z, Cell, derivatives, ellipsoid

import numpy as np
from scipy.integrate import solve_bvp


def slopes(cell, y, length, p):
    """dy/dx at rest with x = 2u; at r = 0 the limits (umbilic, isotropic)."""
    pole = np.broadcast_to(y[R].real < 1e-12, y[R].shape)
    safe = y.copy()
    safe[R] = np.where(pole, 1.0, y[R])
    one = np.ones(y.shape[-1])
    out = derivatives(cell, safe, length, p, 0.0, 0.0, 0.0, one, 0 * one, cell.gain)
    if np.any(pole):
        m, t, z = y[M], y[T], y[Z]
        w2 = cell.shell_w**2
        wall = -2 * cell.shell_p0 / w2 * np.exp((z * z / cell.a**2 - 1) / w2) * z / cell.a**2
        bulk = cell.ratio * cell.xi_s * cell.gain * m
        limits = {
            R: length + 0 * m, Z: 0 * m, PSI: 0.5 * length * m, M: length * y[Q],
            Q: 0.5 * length * (m * (cell.tension + t) - p - wall),
            V_T: length * (t - bulk) / (2 * cell.eta_b), T: 0 * m, VOL: 0 * m,
        }
        for component, value in limits.items():
            out[component] = np.where(pole, value, out[component])
    return 0.5 * out


def jacobian(cell, y, length, p):
    """Complex-step derivatives of `slopes` in the shapes solve_bvp wants."""
    step = 1e-30
    yc = np.repeat(y[:, None, :], 10, axis=1).astype(complex)
    for j in range(8):
        yc[j, j] += 1j * step
    lc = np.full((10, 1), length, dtype=complex)
    pc = np.full((10, 1), p, dtype=complex)
    lc[8] += 1j * step
    pc[9] += 1j * step
    f = slopes(cell, yc, lc, pc).imag / step
    return f[:, :8], f[:, 8:]


def boundary(cell, ya, yb):
    return np.array([ya[R], ya[PSI], ya[Q], ya[V_T], ya[VOL],
                     yb[Z], yb[PSI] - np.pi / 2, yb[Q], yb[V_T], yb[VOL] - cell.volume / 2])


def solve(cell, x, y, length, p, tol=1e-8, exact_jacobian=True):
    """One stationary shape from the guess given."""
    options = {}
    if exact_jacobian:
        options["fun_jac"] = lambda x, y, q: jacobian(cell, y, q[0], q[1])
    with np.errstate(all="ignore"):
        return solve_bvp(lambda x, y, q: slopes(cell, y, q[0], q[1]), lambda ya, yb, q: boundary(cell, ya, yb),
                         x, y, p=[length, p], tol=tol, bc_tol=1e-8, max_nodes=50000, **options)


def solve_at_length(cell, length, x, y, xi, p, tol=1e-8):
    """The shape of prescribed contour length; xi_s is unknown instead."""
    def with_xi(xi_s):
        return Cell(cell.r0, cell.epsilon, xi_s)

    with np.errstate(all="ignore"):
        return solve_bvp(lambda x, y, q: slopes(with_xi(q[0]), y, length, q[1]),
                         lambda ya, yb, q: boundary(cell, ya, yb), x, y, p=[xi, p], tol=tol, bc_tol=1e-8,
                         max_nodes=50000)


def start(r0, epsilon, tol=1e-4):
    """Passive shape: relaxed from an ellipsoid by stiffening the shell."""
    full = ellipsoid(Cell(r0, epsilon, 0.0), n=80)
    x, y, length, p = 2 * full.u[:41], full.y[:, :41].copy(), full.length, 0.0
    y[:, 0][[R, PSI, VOL]] = 0.0
    for shell in (0.01, 0.03, 0.123):
        cell = Cell(r0, epsilon, 0.0, shell_p0=shell)
        s = solve(cell, x, y, length, p, tol)
        if not s.success:
            raise SystemExit(f"passive shape, P0={shell}: {s.message}")
        x, y, (length, p) = s.x, s.y, s.p
    return x, y, length, p


def observables(cell, y, length, p):
    return {"H": 2 * y[Z, 0] / cell.r0, "L_over_R0": length / cell.r0, "r_eq": y[R, -1] / cell.r0, "p": p}


def climb(r0, epsilon, xi, tol=1e-4, step=2.0):
    """Coarse continuation in xi_s from the passive shape: a guess for one shape."""
    x, y, length, p = start(r0, epsilon, tol)
    for value in np.linspace(0, xi, int(np.ceil(xi / step)) + 1)[1:]:
        s = solve(Cell(r0, epsilon, value), x, y, length, p, tol)
        if not s.success:
            raise SystemExit(f"continuation to xi_s={value}: {s.message}")
        x, y, (length, p) = s.x, s.y, s.p
    return x, y, length, p


def one_shape(r0, epsilon, xi, tol, exact_jacobian=True):
    """Everything from nothing, then the final solve alone, both timed."""
    began, cpu_began = time.perf_counter(), time.process_time()
    guess = climb(r0, epsilon, xi)
    climbed = time.perf_counter()
    cell = Cell(r0, epsilon, xi)
    s = solve(cell, *guess, tol=tol, exact_jacobian=exact_jacobian)
    done, cpu_seconds = time.perf_counter(), time.process_time() - cpu_began
    return {"r0": r0, "epsilon": epsilon, "xi_s": xi, "converged": bool(s.success), "L": s.p[0],
            **observables(cell, s.y, *s.p), "residual": float(np.max(s.rms_residuals)), "nodes": int(s.x.size),
            "seconds_final_solve": done - climbed, "seconds": done - began, "cpu_seconds": cpu_seconds}, s


def against_reference(path, tol):
    """Every row of the reference branch: at its xi_s up to the fold, at its L beyond it."""
    with open(path) as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    out, guess, xi, beyond, highest = [], None, 0.0, False, 0.0
    for row in rows:
        target, length = float(row["xi"]), 2.0 * float(row["L_over_R0"])
        beyond = beyond or target < highest
        highest = max(highest, target)
        began = time.perf_counter()
        if not beyond:
            result, s = one_shape(2.0, 0.87, target, tol)
            found, length = target, s.p[0]
        else:
            x, y, lengths, p = guess
            for part in np.linspace(lengths, length, 9)[1:]:
                s = solve_at_length(Cell(2.0), part, x, y, xi, p, tol if part == length else 1e-4)
                if not s.success:
                    raise SystemExit(f"continuation to L={part}: {s.message}")
                x, y, (xi, p) = s.x, s.y, s.p
            found = xi
            result = {"xi_s": xi, **observables(Cell(2.0), s.y, length, s.p[1]),
                      "residual": float(np.max(s.rms_residuals)), "nodes": int(s.x.size),
                      "seconds": time.perf_counter() - began}
        guess, xi = (s.x, s.y, length, s.p[1]), found
        for key, column in (("xi_s", "xi"), ("H", "H"), ("L_over_R0", "L_over_R0"), ("r_eq", "r_eq_over_R0"), ("p", "p")):
            result["difference_" + key] = result[key] - float(row[column])
        out.append(result)
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--r0", type=float, default=2.0)
    parser.add_argument("--epsilon", type=float, default=0.87)
    parser.add_argument("--xi", type=float, help="without it: compare with the reference branch")
    parser.add_argument("--tol", type=float, default=1e-8)
    parser.add_argument("--finite-differences", action="store_true", help="solve_bvp's own Jacobian")
    here = os.path.dirname(os.path.abspath(__file__))
    parser.add_argument("--reference", default=os.path.join(here, "../../../shared/reference/branch_R2.00.csv"))
    a = parser.parse_args()
    if a.xi is not None:
        answer, _ = one_shape(a.r0, a.epsilon, a.xi, a.tol, not a.finite_differences)
    else:
        if not os.path.exists(a.reference):
            raise SystemExit(f"no reference table at {a.reference}: give --reference or --xi")
        answer = against_reference(a.reference, a.tol)
    print(json.dumps(answer, indent=1))


if __name__ == "__main__":
    main()
