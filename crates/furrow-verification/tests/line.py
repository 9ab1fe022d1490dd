"""Whether two antagonists keep their polarity on a line, by differences in space and short implicit steps in time.

It shares nothing with furrow: the grid is uniform, the evolution is followed from a sharp boundary in the middle until one of the two
has the larger concentration on both sides, and the surface per volume of the spheroid is its own. Reads constants and a length from
standard input, as JSON, and writes the time of the end, or null if both are still on their sides then.
"""

import json
import math
import sys

import numpy as np
from scipy.linalg import solve_banded

given = json.load(sys.stdin)
length, aspect, count, until = (given[name] for name in ["length", "aspect", "points", "until"])
c = given["constants"]

# Half the circumference of a prolate spheroid is the line.
angle = (np.arange(400) + 0.5) * math.pi / 400
long = length / (np.sqrt(np.sin(angle) ** 2 + np.cos(angle) ** 2 / aspect**2).mean() * math.pi)
short = long / aspect
e = math.sqrt(1 - 1 / aspect**2)
surface = 2 * math.pi * short**2 * (1 + long / (short * e) * math.asin(e))
psi = surface / (4 / 3 * math.pi * long * short**2)

step, h = 0.5, length / count
neighbours = np.full(count, 2.0)
neighbours[0] = neighbours[-1] = 1


def next_of(x, here, removal):
    """A concentration after a step in which its loss and diffusion are implicit."""
    spread = step * c["d_" + x] / h**2
    bands = np.full((3, count), -spread)
    bands[1] = 1 + step * (c["k_off_" + x] + removal) + spread * neighbours
    attached = c["k_on_" + x] * (c["rho_" + x] - psi * here.mean())
    return solve_banded((1, 1), bands, here + step * attached)


p = np.where(np.arange(count) < count // 2, 1.0, 0.0)
a = 1 - p
for k in range(int(until / step)):
    a, p = next_of("a", a, c["k_ap"] * p ** c["n_p"]), next_of("p", p, c["k_pa"] * a**2)
    if p[0] < a[0] or a[-1] < p[-1]:
        json.dump(k * step, sys.stdout)
        break
else:
    json.dump(None, sys.stdout)
