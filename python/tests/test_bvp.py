"""Boundary-value problems of functions."""

import numpy as np
import pytest

import furrow
from furrow.bvp import solve_bvp


def bratu(x, y):
    return np.vstack((y[1], -np.exp(y[0])))


def ends(ya, yb):
    return np.array([ya[0], yb[0]])


def test_bratu_has_the_published_slope_at_its_end():
    found = solve_bvp(bratu, ends, np.linspace(0, 1, 5), np.zeros((2, 5)), tol=1e-9)
    # The smaller root of theta = sqrt(2) cosh(theta / 4).
    theta = 1.517164598978
    assert found.sol(0.0)[1] == pytest.approx(theta * np.tanh(theta / 4), abs=1e-8)
    assert found.p is None and found.defect < 1e-9 and found.y.shape == found.yp.shape == (2, len(found.x))
    # The polynomial satisfies the equations at the nodes.
    assert np.abs(found.sol(found.x, 1) - bratu(found.x, found.y)).max() < 1e-6
    assert found.sol(np.array([[0.1, 0.2], [0.3, 0.4]])).shape == (2, 2, 2) and found.sol(0.3).shape == (2,)


def test_a_further_solution_is_found_besides_the_known_ones():
    guess = np.linspace(0, 1, 9), np.zeros((2, 9))
    first = solve_bvp(bratu, ends, *guess)
    # Steps of the search may lead far away.
    with np.errstate(over="ignore"):
        second = solve_bvp(bratu, ends, *guess, besides=[first])
    # The larger root of theta = sqrt(2) cosh(theta / 4).
    theta = 10.938702772107
    assert second.sol(0.0)[1] == pytest.approx(theta * np.tanh(theta / 4), abs=1e-4)
    with np.errstate(over="ignore"), pytest.raises(furrow.NoOutcome, match="besides the 2 known ones"):
        solve_bvp(bratu, ends, *guess, besides=[first, second])


def test_further_solutions_of_conditions_that_involve_both_ends():
    # Constants y with y (y^2 - 1) = 0 are periodic.
    x = np.linspace(0, 1, 5)

    def fun(x, y):
        return y**3 - y

    found = []
    for _ in range(3):
        found.append(solve_bvp(fun, lambda ya, yb: ya - yb, x, np.full((1, 5), 0.4), besides=found))
    assert sorted(float(one.sol(0.5)[0]) for one in found) == pytest.approx([-1, 0, 1], abs=1e-6)


def test_a_scalar_unknown_and_derivatives_by_hand():
    x = np.linspace(0, 1, 9)
    guess = np.vstack((np.sin(2 * np.pi * x), 6 * np.cos(2 * np.pi * x)))

    def fun(x, y, p):
        return np.vstack((y[1], -(p[0] ** 2) * y[0]))

    def bc(ya, yb, p):
        return np.array([ya[0], yb[0], ya[1] - p[0]])

    def fun_jac(x, y, p):
        zero, one = np.zeros_like(x), np.ones_like(x)
        by_y = np.array([[zero, one], [-(p[0] ** 2) * one, zero]])
        return by_y, np.array([[zero], [-2 * p[0] * y[0]]])

    def bc_jac(ya, yb, p):
        return np.array([[1, 0], [0, 0], [0, 1]]), np.array([[0, 0], [1, 0], [0, 0]]), np.array([[0], [0], [-1]])

    by_differences = solve_bvp(fun, bc, x, guess, [6.0], tol=1e-9)
    by_hand = solve_bvp(fun, bc, x, guess, [6.0], fun_jac=fun_jac, bc_jac=bc_jac, tol=1e-9)
    for found in (by_differences, by_hand):
        assert found.p == pytest.approx([2 * np.pi], abs=1e-9)


def test_conditions_may_involve_both_ends():
    x = np.linspace(0, 2 * np.pi, 9)
    found = solve_bvp(lambda x, y: np.vstack((y[1], y[0] + np.cos(x))), lambda ya, yb: ya - yb, x, np.zeros((2, 9)), tol=1e-9)
    assert np.abs(found.sol(np.linspace(0, 6, 50))[0] + np.cos(np.linspace(0, 6, 50)) / 2).max() < 1e-8


def test_what_does_not_fit_is_refused_and_what_a_function_raises_is_raised():
    x, zeros = np.linspace(0, 1, 5), np.zeros((2, 5))
    with pytest.raises(furrow.InputError, match=r"bc = an array of shape \[1\]: must be a function .* of shape \[2\]"):
        solve_bvp(bratu, lambda ya, yb: ya[:1], x, zeros)
    with pytest.raises(furrow.InputError, match="must be x of shape"):
        solve_bvp(bratu, ends, x, np.zeros((2, 4)))
    with pytest.raises(furrow.InputError, match="node 1 of the mesh is 0"):
        solve_bvp(bratu, ends, np.zeros(5), zeros)
    with pytest.raises(furrow.InputError, match="nu = 2: must be 0 or 1"):
        solve_bvp(bratu, ends, x, zeros).sol(0.5, 2)
    with pytest.raises(ZeroDivisionError):
        solve_bvp(lambda x, y: 1 / 0, ends, x, zeros)
    # No solution above 3.51.
    with pytest.raises(furrow.NoOutcome):
        solve_bvp(lambda x, y: np.vstack((y[1], -4 * np.exp(y[0]))), ends, x, zeros)
