"""A stationary shape of the cortex by scipy.integrate.solve_bvp, from the equations of the paper.

It shares nothing with furrow: the discretisation is another one (Lobatto points with control of the residual), the volume is an
eighth differential equation, and the poles, which its points must not touch, are cut off and replaced by the series of a smooth
surface about its pole. Reads one cell with a rough shape from standard input, one `name numbers...` per line, and writes a
shape in the same form.
"""

import sys

import numpy as np
from scipy.integrate import solve_bvp

if sys.argv[1:] == ["--installed"]:
    sys.exit(0)

given = {}
for line in sys.stdin:
    name, *numbers = line.split()
    given[name] = np.array([float(number) for number in numbers])

scalar = {name: numbers[0] for name, numbers in given.items() if len(numbers) == 1}
kappa0, eta_b, eta_s = scalar["kappa"], scalar["eta_b"], scalar["eta_s"]
friction, gamma = scalar["friction"], scalar["tension"]
xi_s = scalar["gain"] * scalar["xi_s"]
xi_b = xi_s * scalar["xi_ratio"]
p0, w = scalar["p0"], scalar["w"]
b = (scalar["r0"] ** 3 / (scalar["epsilon"] * scalar["aspect"])) ** (1 / 3)
a = scalar["aspect"] * b
volume = 4 * np.pi * scalar["r0"] ** 3 / 3
amplitude, u0, omega = scalar["amplitude"], scalar["u0"], scalar["omega"]


def rigidity(u):
    """kappa and its derivative by u: a band of stiffer cortex."""
    bell = amplitude * np.exp(-(((u - u0) / omega) ** 2))
    return kappa0 * (1 + bell), -2 * kappa0 * bell * (u - u0) / omega**2


def flow(u, y, length):
    """All that the equations are made of at u."""
    r, z, psi, m, q, v, t, _ = y
    kappa, kappa_u = rigidity(u)
    c2 = np.sin(psi) / r
    mean = m / kappa
    c1 = mean - c2
    cot = np.cos(psi) / r
    s_pp = cot * v
    s_uu = (t - xi_s * (c1 - c2) / 2 - xi_b * mean - (eta_b - eta_s) * s_pp) / (eta_b + eta_s)
    t_pp = eta_b * (s_uu + s_pp) - eta_s * (s_uu - s_pp) - xi_s * (c1 - c2) / 2 + xi_b * mean
    h_uu = gamma + kappa * (c2**2 - c1**2) / 2
    h_pp = gamma - kappa * (c2**2 - c1**2) / 2
    shell = -2 * p0 / w**2 * np.exp((z**2 / a**2 + r**2 / b**2 - 1) / w**2)
    shell = shell * (r * np.sin(psi) / b**2 + z * np.cos(psi) / a**2)
    push = c1 * (h_uu + t) + c2 * (h_pp + t_pp) - shell
    return c1, cot, s_uu, t_pp, push, mean**2 * kappa_u / length / 2


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
    c = m / rigidity(u)[0] / 2
    push = flow(u, y, length)[4]
    rate = (t - 2 * xi_b * c) / (2 * eta_b)
    return [r - s + c**2 * s**3 / 6, psi - c * s, q - (push - pressure) * s / 2, v - rate * s, filled - np.pi * c * s**4 / 4]


def ends(first, last, unknown):
    seen = last * np.array([1, -1, -1, 1, -1, -1, 1, -1]) + np.array([0, 0, np.pi, 0, 0, 0, 0, volume])
    # The shell is the same from either side, and z enters by it alone.
    return np.array(pole(CUT, first, unknown) + pole(1 - CUT, seen, unknown))


# The part of the contour cut off at each pole.
CUT = 2e-3

guess = np.array([given[name] for name in ["r", "z", "psi", "m", "q", "v", "t"]])
u = np.concatenate([[CUT], given["u"][(given["u"] > 2 * CUT) & (given["u"] < 1 - 2 * CUT)], [1 - CUT]])
guess = np.array([np.interp(u, given["u"], row) for row in guess])
density = np.pi * scalar["length"] * guess[0] ** 2 * np.sin(guess[2])
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
    p=np.array([1.02 * scalar["length"], 0.9 * scalar["pressure"] + 0.05]),
    tol=1e-7,
    max_nodes=20_000,
)
if not found.success:
    sys.exit(f"solve_bvp: {found.message}")
u = given["u"][(given["u"] > 0.02) & (given["u"] < 0.98)]
shape = found.sol(u)
print("u", *(repr(float(value)) for value in u))
print("nodes", found.x.size)
print("length", found.p[0])
print("pressure", found.p[1])
for name, values in zip(["r", "z", "psi", "m", "q", "v", "t"], shape):
    print(name, *(repr(float(value)) for value in values))
