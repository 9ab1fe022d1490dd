"""One division in plain numpy: prints one JSON document.

    python division.py --r0 2.5
    python division.py --r0 5.4 --cue 0.465,0.0577,0.1 --order 2 --dt-max 0.02
"""

import argparse
import json
import sys
import time

from model import PSI, R, VOL, Z, Cell, NewtonFailure, Solver, adapted_mesh, passive_shape, stage_points

import numpy as np
from scipy.optimize import brentq


def furrow(state):
    """(u, r) of the smallest interior minimum of the radius, or None."""
    rising = np.cos(state.y[PSI]) > 0
    best = None
    for i in np.flatnonzero(~rising[:-1] & rising[1:]):
        u = brentq(lambda x: np.cos(state.at(np.array([x]))[0][PSI, 0]), state.u[i], state.u[i + 1], xtol=1e-14)
        r = state.at(np.array([u]))[0][R, 0]
        if best is None or r < best[1]:
            best = (u, r)
    return best


def divide(cell, seed=0, order=1, n=80, dt_max=0.1, dt_first=1e-3, tol=None, neck_step=0.08, t_max=150.0,
           amplitude=0.01, rest=1e-9, restart=False, trace=None):
    """Evolve from the passive shape until pinch-off, rest or t_max.

    order 1: backward Euler; order 2: variable-step BDF2. `tol` bounds the
    difference between a step and its extrapolated guess, relative to R0.
    BDF2 remembers the noise of the first step, which raises its effect by
    1/(1 - w^2/(1 + 2w)) for steps growing by w (2.29 here: w = 1.5) and brings t_end
    of a slow asymmetric division forward by the log of that over the growth rate.
    `restart` takes the second step at first order too, which removes this memory.
    """
    if tol is None:
        tol = 0.02 if order == 1 else 0.01
    began, cpu_began = time.perf_counter(), time.process_time()
    state = passive_shape(cell, n)
    solver = Solver(cell)
    coefficients = np.random.RandomState(seed).uniform(-amplitude, amplitude, 10)
    modes = np.arange(1, 11)
    past = [state]  # newest first
    t, dt, steps, rejected = 0.0, dt_first, 0, 0
    outcome, neck_past, speed = "timeout", None, np.inf
    while t < t_max:
        mesh, imbalance = adapted_mesh(past[0], n)
        guess = past[0] if imbalance < 1.5 else past[0].moved_to(mesh)
        points = stage_points(guess.u)
        x = [s.at(points)[0] for s in past]
        first = steps == 0
        noise = 1 + coefficients @ np.cos(np.pi * modes[:, None] * points) if first else 1.0
        if order == 1 or steps < (2 if restart else 1):
            a0 = 1 / dt
            past_x = [-a0 * x[0][c] for c in (R, Z)]
        else:
            w = dt / (past[0].t - past[1].t)
            a0 = (1 + 2 * w) / (1 + w) / dt
            past_x = [(-(1 + w) * x[0][c] + w * w / (1 + w) * x[1][c]) / dt for c in (R, Z)]
        times = [s.t for s in past[: order + 1]]
        weights = [
            np.prod([(t + dt - b) / (a - b) for b in times if b != a]) for a in times
        ]  # Lagrange extrapolation to the new time
        if len(past) > 2:
            extended = [past[j].moved_to(guess.u) for j in range(1, len(times))]
            for name in ("y", "k", "length", "p"):
                value = weights[0] * getattr(guess, name)
                for weight, old in zip(weights[1:], extended):
                    value = value + weight * getattr(old, name)
                setattr(guess := type(guess)(**vars(guess)), name, value)
        try:
            new = solver.newton(guess, a0, past_x[0], past_x[1], noise)
            neck = furrow(new)
            if neck is not None and neck_past is not None and neck[1] < 0.5 * neck_past[1]:
                raise NewtonFailure("neck lost more than half its radius in one step")
        except NewtonFailure as failure:
            rejected += 1
            dt /= 3
            if dt < 1e-12:
                raise SystemExit(f"step size fell below 1e-12 at t={t:.6g}: {failure}")
            continue
        got, _ = new.at(points)
        predicted = sum(weight * value for weight, value in zip(weights, x))
        error = np.max(np.abs(got[[R, Z]] - predicted[[R, Z]])) / cell.r0
        if len(past) > 2 and error > 4 * tol and dt > 1e-9:
            rejected += 1
            dt *= max(0.3, 0.8 * (tol / error) ** (1 / (order + 1)))
            continue
        steps += 1
        t += dt
        new.t = t
        normal = np.sin(got[PSI]) * (got[R] - x[0][R]) + np.cos(got[PSI]) * (got[Z] - x[0][Z])
        speed = np.max(np.abs(normal)) / dt / cell.r0
        if trace is not None:
            trace(new, neck, dt)
        past = [new, *past[:2]]
        shrink = 0.0
        if neck is not None and neck_past is not None:
            shrink = (neck_past[1] - neck[1]) / dt / neck[1]
        last_neck, neck_past = neck_past, neck
        if neck is not None and neck[1] < 0.001 * cell.r0:
            outcome = "divided"
            break
        if t > 1 and speed < rest:
            outcome = "failed"  # at rest to rounding: see README on stability
            break
        grow = 1.5 if len(past) < 3 else min(1.5, 0.9 * (tol / max(error, 1e-300)) ** (1 / (order + 1)))
        dt = min(dt * max(grow, 0.3), dt_max)
        if first and restart:
            dt = dt_first
        if shrink > 0:
            dt = min(dt, neck_step / shrink)
    result = {
        "outcome": outcome, "r0": cell.r0, "epsilon": cell.epsilon, "xi_s": cell.xi_s, "cue": cell.cue,
        "seed": seed, "order": order, "intervals": n, "dt_max": dt_max, "tol": tol,
    }
    if outcome == "divided":
        u, r = neck
        part = new.at(np.array([u]))[0][VOL, 0]
        signed = (cell.volume - 2 * part) / cell.volume
        limit = 0.001 * cell.r0
        fraction = (last_neck[1] - limit) / (last_neck[1] - r)
        result.update(chi=abs(signed), chi_signed=signed, u_furrow=u,
                      t_end=past[1].t + fraction * (t - past[1].t))
    else:
        result.update(t_end=t, speed=speed, H=(new.y[Z, 0] - new.y[Z, -1]) / cell.r0,
                      asymmetry=asymmetry(new, cell))
    result.update(steps=steps, rejected_steps=rejected, newton_iterations=solver.iterations,
                  seconds=time.perf_counter() - began, cpu_seconds=time.process_time() - cpu_began)
    return result, past


def asymmetry(state, cell):
    """Largest |r(u) - r(1-u)| / R0: zero for a mirror-symmetric shape."""
    u = np.linspace(0, 1, 401)
    r = state.at(u)[0][R]
    return float(np.max(np.abs(r - r[::-1])) / cell.r0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--r0", type=float, required=True)
    parser.add_argument("--epsilon", type=float, default=0.87)
    parser.add_argument("--xi", type=float, default=25.0)
    parser.add_argument("--cue", help="u0,omega,amplitude of the rigidity cue")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--order", type=int, choices=(1, 2), default=1, help="1 backward Euler, 2 BDF2")
    parser.add_argument("--intervals", type=int, default=80)
    parser.add_argument("--dt-max", type=float, default=0.1)
    parser.add_argument("--tol", type=float)
    parser.add_argument("--neck-step", type=float, default=0.08)
    parser.add_argument("--restart", action="store_true", help="order 2: forget the noise of the first step")
    parser.add_argument("--t-max", type=float, default=150.0)
    parser.add_argument("--trace", action="store_true", help="a line per step on stderr")
    a = parser.parse_args()
    cue = tuple(float(x) for x in a.cue.split(",")) if a.cue else None
    cell = Cell(a.r0, a.epsilon, a.xi, cue=cue)

    def line(state, neck, dt):
        u, r = neck if neck else (float("nan"), float("nan"))
        print(f"t={state.t:.8f} dt={dt:.3e} u={u:.5f} r/R0={r / a.r0:.6e} asym={asymmetry(state, cell):.3e}",
              file=sys.stderr)

    result, _ = divide(cell, a.seed, a.order, a.intervals, a.dt_max, tol=a.tol, neck_step=a.neck_step,
                       t_max=a.t_max, restart=a.restart, trace=line if a.trace else None)
    json.dump(result, sys.stdout)
    print()


if __name__ == "__main__":
    main()
