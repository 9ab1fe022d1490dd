"""Stationary shapes on the full domain and their leading growth rate.

    python stability.py --r0 2.0
"""

import argparse
import json

from model import GAUSS_A, PSI, STEP, R, Z, Cell, NewtonFailure, Solver, adapted_mesh, derivatives, passive_shape, stage_points

import numpy as np


def rest_shape(cell, n=80, steps=8):
    """Mirror-symmetric stationary shape, reached by raising xi_s from zero."""
    state = passive_shape(cell, n)
    for i in range(1, steps + 1):
        part = Cell(cell.r0, cell.epsilon, cell.xi_s * i / steps)
        state = Solver(part).newton(state, limit=40)
        mesh, _ = adapted_mesh(state, n)
        state = Solver(part).newton(state.moved_to(mesh))
    return state


def growth_rate(cell, state, shift, even=False, tol=1e-10, limit=2000):
    """Eigenvalue of the dynamics nearest `shift` by inverse iteration.

    A backward-Euler step of size 1/shift, linearised about rest, multiplies a mode of
    rate sigma by shift/(shift - sigma). Returns (sigma, mode of (r, z) at the Gauss
    points). `even` keeps to mirror-symmetric modes.
    """
    solver = Solver(cell)
    n = state.u.size - 1
    points = stage_points(state.u)
    y, _ = state.at(points)
    rest_r, rest_z = -shift * y[R], -shift * y[Z]
    _, jac = solver.linearise(state, shift, rest_r, rest_z, 1.0)
    mode = np.random.RandomState(7).uniform(-1, 1, 3) @ np.stack([np.cos(j * np.pi * points) for j in (1, 2, 3)])
    dr, dz = mode * np.sin(y[PSI]), mode * np.cos(y[PSI])
    zero8 = np.zeros((8, n))
    ends = (np.zeros(5), np.zeros(5))
    h = np.diff(state.u)
    kappa, kappa_u = cell.kappa(points)
    sigma = 0.0
    for _ in range(limit):
        if even:
            dr, dz = 0.5 * (dr + dr[::-1]), 0.5 * (dz - dz[::-1])
        size = np.sqrt(np.mean(dr**2 + dz**2))
        dr, dz = dr / size, dz / size
        # Right-hand side: f with the old shape displaced by the mode.
        f = derivatives(cell, y.astype(complex), state.length, state.p, shift,
                        rest_r - 1j * STEP * shift * dr, rest_z - 1j * STEP * shift * dz,
                        kappa, kappa_u, cell.gain)
        dy, dk, _, _ = solver.update(state, -(f.imag / STEP).reshape(8, n, 3), jac, zero8, ends)
        new = (dy[:, :-1, None] + h[:, None] * (dk @ GAUSS_A.T)).reshape(8, -1)
        factor = np.mean(new[R] * dr + new[Z] * dz)
        previous, sigma = sigma, shift * (1 - 1 / factor)
        dr, dz = new[R], new[Z]
        if abs(sigma - previous) < tol * (1 + abs(sigma)):
            break
    return sigma, (dr, dz)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--r0", type=float, required=True)
    parser.add_argument("--epsilon", type=float, default=0.87)
    parser.add_argument("--xi", type=float, default=25.0)
    a = parser.parse_args()
    cell = Cell(a.r0, a.epsilon, a.xi)
    try:
        state = rest_shape(cell)
    except NewtonFailure as failure:
        raise SystemExit(f"no weakly elongated rest shape found at R0={a.r0}, xi_s={a.xi} (beyond the fold?): {failure}")
    found = []
    for shift in (3.0, 1.0, 0.3, 0.1):
        sigma, (dr, _) = growth_rate(cell, state, shift)
        odd = float(np.linalg.norm(dr - dr[::-1]) / (2 * np.linalg.norm(dr)))
        found.append({"shift": shift, "sigma": sigma, "odd_part_of_mode": odd})
    even, _ = growth_rate(cell, state, 0.3, even=True)
    print(json.dumps({"r0": a.r0, "xi_s": a.xi, "L_over_R0": state.length / a.r0,
                      "H": (state.y[Z, 0] - state.y[Z, -1]) / a.r0, "p": state.p,
                      "modes": found, "leading_even": even}))


if __name__ == "__main__":
    main()
