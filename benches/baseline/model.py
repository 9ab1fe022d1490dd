"""The active-surface cell model and its collocation solver, in plain numpy.

An independent baseline: written for side-by-side timing and as a check of the
Rust engine, which shares no code with it. Everything is the textbook choice:
three-stage Gauss collocation on all of u in [0, 1], Newton with a complex-step
Jacobian, stage unknowns eliminated interval by interval, one banded LU.
"""

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")  # one thread, before numpy is loaded

from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import solve_banded

# Gauss-Legendre, three stages, order six, on [0, 1].
_S = np.sqrt(15.0)
GAUSS_C = np.array([0.5 - _S / 10, 0.5, 0.5 + _S / 10])
GAUSS_A = np.array(
    [
        [5 / 36, 2 / 9 - _S / 15, 5 / 36 - _S / 30],
        [5 / 36 + _S / 24, 2 / 9, 5 / 36 - _S / 24],
        [5 / 36 + _S / 30, 2 / 9 + _S / 15, 5 / 36],
    ]
)
GAUSS_B = np.array([5 / 18, 4 / 9, 5 / 18])
# Column j: coefficients (ascending) of the Lagrange polynomial of stage j.
LAGRANGE = np.linalg.inv(np.vander(GAUSS_C, 3, increasing=True))

R, Z, PSI, M, Q, V_T, T, VOL = range(8)  # order of the state vector
STEP = 1e-30  # complex step: exact to rounding


class NewtonFailure(Exception):
    """Newton did not converge, or produced a non-finite number."""


@dataclass
class Cell:
    """Physical constants of one cell (units: kappa0, L_h, tau)."""

    r0: float
    epsilon: float = 0.87
    xi_s: float = 25.0
    ratio: float = -0.1  # xi_b / xi_s
    gain: float = 0.5
    eta_b: float = 1.0
    eta_s: float = 1.0
    friction: float = 1.0
    tension: float = 0.0
    aspect: float = 1.5
    shell_p0: float = 0.123
    shell_w: float = 0.1445
    cue: tuple | None = None  # (u0, omega, amplitude) of kappa(u)

    volume: float = field(init=False)
    a: float = field(init=False)
    b: float = field(init=False)

    def __post_init__(self):
        self.volume = 4 * np.pi * self.r0**3 / 3
        self.b = (self.r0**3 / (self.epsilon * self.aspect)) ** (1 / 3)
        self.a = self.aspect * self.b

    def kappa(self, u):
        """Bending rigidity and its derivative with respect to u."""
        if self.cue is None:
            return np.ones_like(u), np.zeros_like(u)
        u0, omega, amplitude = self.cue
        bump = amplitude * np.exp(-(((u - u0) / omega) ** 2))
        return 1 + bump, -2 * (u - u0) / omega**2 * bump


def derivatives(cell, y, length, p, a0, past_r, past_z, kappa, kappa_u, activity):
    """dy/du of the eight first-order equations.

    The velocities at fixed u are a0*r + past_r and a0*z + past_z (all zero for
    a stationary shape). `activity` is gain times the noise factor.
    """
    r, z, psi, m, q, v, t, _ = y
    sin, cos = np.sin(psi), np.cos(psi)
    c2 = sin / r
    curv = m / kappa
    c1 = curv - c2
    cot = cos / r
    v_n = sin * (a0 * r + past_r) + cos * (a0 * z + past_z)
    shear = 0.5 * cell.xi_s * activity * (c1 - c2)
    bulk = cell.ratio * cell.xi_s * activity * curv
    s_pp = cot * v + c2 * v_n
    s_uu = (t - shear - bulk - (cell.eta_b - cell.eta_s) * s_pp) / (cell.eta_b + cell.eta_s)
    t_pp = (cell.eta_b - cell.eta_s) * s_uu + (cell.eta_b + cell.eta_s) * s_pp - shear + bulk
    bend = 0.5 * kappa * (c2 * c2 - c1 * c1)
    w2 = cell.shell_w**2
    level = (z * z / cell.a**2 + r * r / cell.b**2 - 1) / w2
    wall = -2 * cell.shell_p0 / w2 * np.exp(level) * (r * sin / cell.b**2 + z * cos / cell.a**2)
    out = np.empty_like(y)
    out[R] = length * cos
    out[Z] = -length * sin
    out[PSI] = length * c1
    out[M] = length * q
    out[Q] = length * (
        -cot * q + c1 * (cell.tension + bend + t) + c2 * (cell.tension - bend + t_pp) - p - wall
    )
    out[V_T] = length * (s_uu - c1 * v_n)
    out[T] = length * (-cot * (t - t_pp) + cell.friction * v) - 0.5 * curv**2 * kappa_u
    out[VOL] = length * np.pi * r * r * sin
    return out


@dataclass
class State:
    """A collocation solution: nodes u, values y (8, N+1), slopes k (8, N, 3)."""

    u: np.ndarray
    y: np.ndarray
    k: np.ndarray
    length: float
    p: float
    t: float = 0.0

    def at(self, query):
        """Collocation polynomial and its slope at the points `query`."""
        i = np.clip(np.searchsorted(self.u, query, side="right") - 1, 0, self.u.size - 2)
        h = self.u[i + 1] - self.u[i]
        x = (query - self.u[i]) / h
        ones = np.ones_like(x)
        slope_w = np.stack([ones, x, x * x]).T @ LAGRANGE
        value_w = np.stack([x, x * x / 2, x**3 / 3]).T @ LAGRANGE
        k = self.k[:, i, :]
        return self.y[:, i] + h * np.sum(k * value_w, axis=2), np.sum(k * slope_w, axis=2)

    def moved_to(self, u):
        """The same solution carried over to another mesh."""
        y, _ = self.at(u)
        _, k = self.at(stage_points(u))
        return State(u, y, k.reshape(8, u.size - 1, 3), self.length, self.p, self.t)


def stage_points(u):
    """Gauss points of every interval, in order, flattened."""
    return (u[:-1, None] + np.diff(u)[:, None] * GAUSS_C).ravel()


class Solver:
    """Newton for one collocation system; counts its iterations."""

    def __init__(self, cell):
        self.cell = cell
        self.iterations = 0
        self._bands = None

    def _pattern(self, n):
        """Row and column of every block entry in band storage."""
        if self._bands is None or self._bands[0] != n:
            row = 5 + 10 * np.arange(n)[:, None, None] + np.arange(10)[:, None]
            col = 10 * np.arange(n)[:, None, None] + np.arange(20)[None, :]
            row, col = np.broadcast_arrays(row, col)
            self._bands = (n, 14 + row - col, col)
        return self._bands[1:]

    def linearise(self, state, a0, past_r, past_z, noise):
        """Slopes and their complex-step Jacobian at all Gauss points."""
        n = state.u.size - 1
        h = np.diff(state.u)
        points = stage_points(state.u)
        values = state.y[:, :-1, None] + h[:, None] * (state.k @ GAUSS_A.T)
        kappa, kappa_u = self.cell.kappa(points)
        y = np.repeat(values.reshape(8, 1, 3 * n), 10, axis=1).astype(complex)
        for j in range(8):
            y[j, j] += 1j * STEP
        length = np.full((10, 1), state.length, dtype=complex)
        length[8] += 1j * STEP
        p = np.full((10, 1), state.p, dtype=complex)
        p[9] += 1j * STEP
        f = derivatives(
            self.cell, y, length, p, a0, past_r, past_z, kappa, kappa_u, self.cell.gain * noise
        )
        return f[:, 0].real.reshape(8, n, 3), f.imag.reshape(8, 10, n, 3) / STEP

    def update(self, state, residual, jac, continuity, ends):
        """Solve the linearised system for the right-hand sides given.

        residual (8, N, 3): k - f; continuity (8, N): jump over each interval;
        ends: (five, five) residuals of the boundary conditions.
        """
        n = state.u.size - 1
        h = np.diff(state.u)
        big = np.einsum("i,jl,abij->ijalb", -h, GAUSS_A, jac[:, :8]).reshape(n, 24, 24)
        big[:, np.arange(24), np.arange(24)] += 1
        rhs = np.empty((n, 24, 11))
        rhs[:, :, :10] = jac.transpose(2, 3, 0, 1).reshape(n, 24, 10)
        rhs[:, :, 10] = -residual.transpose(1, 2, 0).reshape(n, 24)
        try:
            local = np.linalg.solve(big, rhs).reshape(n, 3, 8, 11)
        except np.linalg.LinAlgError as error:
            raise NewtonFailure("singular interval") from error
        quad = h[:, None, None] * np.einsum("j,ijax->iax", GAUSS_B, local)
        block = np.zeros((n, 10, 20))
        block[:, :8, :10] = -quad[:, :, :10]
        diagonal = np.arange(10)
        block[:, diagonal, diagonal] -= 1
        block[:, diagonal, 10 + diagonal] = 1
        size = 10 * (n + 1)
        band = np.zeros((29, size))
        band_row, band_col = self._pattern(n)
        band[band_row, band_col] = block
        b = np.zeros(size)
        b[5 : size - 5].reshape(n, 10)[:, :8] = quad[:, :, 10] - continuity.T
        for row, comp in enumerate((R, PSI, Q, V_T, VOL)):
            band[14 + row - comp, comp] = 1
            b[row] = -ends[0][row]
            last = size - 10 + comp
            band[14 + size - 5 + row - last, last] = 1
            b[size - 5 + row] = -ends[1][row]
        try:
            x = solve_banded((14, 14), band, b, overwrite_ab=True, overwrite_b=True, check_finite=False)
        except np.linalg.LinAlgError as error:
            raise NewtonFailure("singular matrix") from error
        if not np.all(np.isfinite(x)):
            raise NewtonFailure("non-finite update")
        x = x.reshape(n + 1, 10)
        dk = np.einsum("ijax,ix->aij", local[..., :10], x[:-1]) + local[..., 10].transpose(2, 0, 1)
        return x[:, :8].T, dk, x[0, 8], x[0, 9]

    def newton(self, guess, a0=0.0, past_r=0.0, past_z=0.0, noise=1.0, tol=1e-7, limit=12):
        """Solve the boundary-value problem, starting from `guess`."""
        s = State(guess.u, guess.y.copy(), guess.k.copy(), guess.length, guess.p, guess.t)
        h = np.diff(s.u)
        left = np.zeros(5)
        right = np.array([0.0, np.pi, 0.0, 0.0, self.cell.volume])
        which = [R, PSI, Q, V_T, VOL]
        for _ in range(limit):
            with np.errstate(all="ignore"):
                f, jac = self.linearise(s, a0, past_r, past_z, noise)
            if not (np.all(np.isfinite(f)) and np.all(np.isfinite(jac))):
                raise NewtonFailure("non-finite residual")
            self.iterations += 1
            jump = s.y[:, 1:] - s.y[:, :-1] - h * (s.k @ GAUSS_B)
            ends = (s.y[which, 0] - left, s.y[which, -1] - right)
            dy, dk, dl, dp = self.update(s, s.k - f, jac, jump, ends)
            size = np.max(np.abs(dy), axis=1) / (np.max(np.abs(s.y), axis=1) + 1e-2)
            size = max(size.max(), abs(dl) / s.length, abs(dp) / (abs(s.p) + 1))
            damp = min(1.0, 1.0 / size)
            s.y += damp * dy
            s.k += damp * dk
            s.length += damp * dl
            s.p += damp * dp
            if size < tol:
                return s
        raise NewtonFailure(f"last update {size:.1e} after {limit} iterations")


def adapted_mesh(state, n, floor=0.5):
    """Mesh of n intervals that equidistributes total curvature.

    Density: L*sqrt(c1^2 + c2^2) plus `floor` times its mean; grows like 1/r at the
    neck, so the neck takes a number of intervals logarithmic in its radius.
    """
    points = stage_points(state.u)
    y, k = state.at(points)
    c1 = k[PSI]
    c2 = state.length * np.sin(y[PSI]) / y[R]
    cell_width = np.diff(state.u)
    density = np.max(np.sqrt(c1**2 + c2**2).reshape(-1, 3), axis=1)
    for _ in range(2):  # neighbours share, so that intervals grow gradually
        padded = np.concatenate([density[:1], density, density[-1:]])
        density = np.maximum(density, 0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:])
    density = density + floor * np.sum(density * cell_width)
    mass = np.concatenate([[0.0], np.cumsum(density * cell_width)])
    imbalance = n * np.max(np.diff(mass)) / mass[-1]
    u = np.interp(np.linspace(0, mass[-1], n + 1), mass, state.u)
    u[0], u[-1] = 0.0, 1.0
    return u, imbalance


def ellipsoid(cell, n=80):
    """Cell-sized ellipsoid of the shell's proportions: start of every run."""
    theta = np.linspace(0, np.pi, 4001)
    scale = cell.epsilon ** (1 / 3)
    a, b = cell.a * scale, cell.b * scale
    speed = np.hypot(b * np.cos(theta), a * np.sin(theta))
    s = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(theta))])
    u = np.linspace(0, 1, n + 1)
    th = np.interp(u * s[-1], s, theta)
    r, z = b * np.sin(th), a * np.cos(th)
    psi = np.arctan2(a * np.sin(th), b * np.cos(th))
    root = np.hypot(b * np.cos(th), a * np.sin(th))
    curv = a * b / root**3 + a / (b * root)
    vol = np.pi * a * b**2 * (2 / 3 - np.cos(th) + np.cos(th) ** 3 / 3)
    zero = np.zeros_like(u)
    y = np.stack([r, z, psi, curv, zero, zero, zero, vol])
    k = np.repeat((np.diff(y) * n)[:, :, None], 3, axis=2)
    return State(u, y, k, s[-1], 0.0)


def passive_shape(cell, n=80):
    """Stationary shape without activity and cue, by pseudo-transient relaxation."""
    quiet = Cell(**{**{f: getattr(cell, f) for f in cell.__dataclass_fields__ if f not in ("volume", "a", "b")},
                    "xi_s": 0.0, "cue": None})
    solver = Solver(quiet)
    state = ellipsoid(quiet, n)
    dt = 1e-2
    while dt < 1e6:
        old, _ = state.at(stage_points(state.u))
        try:
            state = solver.newton(state, 1 / dt, -old[R] / dt, -old[Z] / dt, limit=25)
            dt *= 10
        except NewtonFailure:
            dt /= 4
            if dt < 1e-8:
                raise
    state = solver.newton(state)
    for _ in range(3):
        mesh, _ = adapted_mesh(state, n)
        state = solver.newton(state.moved_to(mesh))
    return state
