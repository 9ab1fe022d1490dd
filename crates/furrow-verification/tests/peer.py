"""A stationary shape of the cortex by scipy.integrate.solve_bvp, from the equations of the paper.

It shares nothing with furrow: the discretisation is another one (Lobatto points with control of the residual), the volume is an
eighth differential equation, and the poles, which its points must not touch, are cut off and replaced by the series of a smooth
surface about its pole. Reads one cell with a rough shape from standard input, as JSON, and writes a shape in the same form.
"""

import json
import sys

import numpy as np
from scipy.integrate import solve_bvp

if sys.argv[1:] == ["--installed"]:
    sys.exit(0)

given = json.load(sys.stdin)
cell = given["cell"]
material, shell_of = cell["material"], cell["shell"]
band = {"amplitude": 0, "u0": 0.5, "omega": 1}
if cell["cue"] != "none":
    band = {key: float(value) for key, value in (entry.split("=") for entry in cell["cue"].split(",")[1:])}
kappa0, eta_b, eta_s, friction, gamma = (material[name] for name in ["kappa", "eta_b", "eta_s", "friction", "tension"])
preferred = material.get("spontaneous_curvature", 0)
xi_s = material["gain"] * cell["xi_s"]
xi_b = xi_s * material["xi_ratio"]
p0, w = shell_of["p0"], shell_of["w"]
b = (cell["r0"] ** 3 / (cell["epsilon"] * shell_of["aspect"])) ** (1 / 3)
a = shell_of["aspect"] * b
volume = 4 * np.pi * cell["r0"] ** 3 / 3
amplitude, u0, omega = band["amplitude"], band["u0"], band["omega"]


def rigidity(u):
    """kappa and its derivative by u: a band of stiffer cortex."""
    bell = amplitude * np.exp(-(((u - u0) / omega) ** 2))
    return kappa0 * (1 + bell), -2 * kappa0 * bell * (u - u0) / omega**2


def flow(u, y, length):
    """All that the equations are made of at u."""
    r, z, psi, m, q, v, t, _ = y
    kappa, kappa_u = rigidity(u)
    c2 = np.sin(psi) / r
    mean = m / kappa + preferred
    bent = mean - preferred
    c1 = mean - c2
    cot = np.cos(psi) / r
    s_pp = cot * v
    s_uu = (t - xi_s * (c1 - c2) / 2 - xi_b * mean - (eta_b - eta_s) * s_pp) / (eta_b + eta_s)
    t_pp = eta_b * (s_uu + s_pp) - eta_s * (s_uu - s_pp) - xi_s * (c1 - c2) / 2 + xi_b * mean
    h_uu = gamma + kappa * bent**2 / 2 - kappa * bent * c1
    h_pp = gamma + kappa * bent**2 / 2 - kappa * bent * c2
    shell = -2 * p0 / w**2 * np.exp((z**2 / a**2 + r**2 / b**2 - 1) / w**2)
    shell = shell * (r * np.sin(psi) / b**2 + z * np.cos(psi) / a**2)
    push = c1 * (h_uu + t) + c2 * (h_pp + t_pp) - shell
    return c1, cot, s_uu, t_pp, push, bent**2 * kappa_u / length / 2


def equations(u, y, unknown):
    length, pressure = unknown
    r, _, psi, _, q, v, t, _ = y
    c1, cot, s_uu, t_pp, push, pull = flow(u, y, length)
    q_s = push - pressure - cot * q
    t_s = -cot * (t - t_pp) + friction * v - pull
    by_s = [np.cos(psi), -np.sin(psi), c1, q, q_s, s_uu, t_s, np.pi * r**2 * np.sin(psi)]
    return length * np.array(by_s)


def pole(u, y, unknown):
    """r, psi, q, v and the volume at a small distance s from a pole where the surface is a sphere of curvature c: by how much
    they miss their series. Seen from its own pole either end looks alike."""
    length, pressure = unknown
    s = CUT * length
    r, _, psi, m, q, v, t, filled = y
    c = (m / rigidity(u)[0] + preferred) / 2
    push = flow(u, y, length)[4]
    rate = (t - 2 * xi_b * c) / (2 * eta_b)
    return [r - s + c**2 * s**3 / 6, psi - c * s, q - (push - pressure) * s / 2, v - rate * s, filled - np.pi * c * s**4 / 4]


def ends(first, last, unknown):
    seen = last * np.array([1, -1, -1, 1, -1, -1, 1, -1]) + np.array([0, 0, np.pi, 0, 0, 0, 0, volume])
    # The shell is the same from either side, and z enters by it alone.
    return np.array(pole(CUT, first, unknown) + pole(1 - CUT, seen, unknown))


# The part of the contour cut off at each pole.
CUT = 2e-3

NAMES = ["r", "z", "psi", "m", "q", "v", "t"]
nodes = np.array(given["u"])
u = np.concatenate([[CUT], nodes[(nodes > 2 * CUT) & (nodes < 1 - 2 * CUT)], [1 - CUT]])
guess = np.array([np.interp(u, nodes, given["shape"][name]) for name in NAMES])
density = np.pi * given["length"] * guess[0] ** 2 * np.sin(guess[2])
filled = np.concatenate([[0], np.cumsum((density[1:] + density[:-1]) / 2 * np.diff(u))])
# Nothing that is found may come from the guess: it is off by some percent, smoothly.
psi = guess[2].copy()
guess *= 1 + 0.03 * np.cos(5 * u)
guess[2] = psi + 0.03 * np.sin(2 * np.pi * u)
found = solve_bvp(
    equations,
    ends,
    u,
    np.vstack([guess, filled]),
    p=np.array([1.02 * given["length"], 0.9 * given["pressure"] + 0.05]),
    tol=1e-7,
    max_nodes=20_000,
)
if not found.success:
    sys.exit(f"solve_bvp: {found.message}")
u = nodes[(nodes > 0.02) & (nodes < 0.98)]
shape = dict(zip(NAMES, found.sol(u).tolist()))
length, pressure = found.p.tolist()
print(json.dumps({"u": u.tolist(), "nodes": found.x.size, "length": length, "pressure": pressure, "shape": shape}))
