"""Boundary-value problems of functions."""

import copy
import math
import pickle

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


def test_an_error_is_bounded_where_it_is_asked_for():
    # y'' = 1e4 (y - cos x) - cos x with layers at both ends, which the conditions leave out.
    def fun(x, y):
        return np.vstack((y[1], 1e4 * (y[0] - np.cos(x)) - np.cos(x)))

    def ends(ya, yb):
        return np.array([ya[0] - 1, yb[0] - np.cos(1)])

    guess = (np.linspace(0, 1, 5), np.zeros((2, 5)))
    rough = solve_bvp(fun, ends, *guess, tol=1e-2)
    found = solve_bvp(fun, ends, *guess, tol=1e-2, error_tol=1e-9)
    x = np.linspace(0, 1, 101)
    exact = np.vstack((np.cos(x), -np.sin(x)))
    errors = [np.max(np.abs(one.sol(x) - exact) / (1 + np.abs(exact))) for one in (rough, found)]
    assert rough.error is None and errors[0] > 1e-9
    assert errors[1] <= found.error <= 1e-9
    with pytest.raises(furrow.NoOutcome, match="limit of 10 intervals is reached before the bound on the error"):
        solve_bvp(fun, ends, *guess, tol=10.0, error_tol=1e-9, max_nodes=11)


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
    with pytest.raises(furrow.InputError, match=r"fun = values that are not numbers .*: must be .* real numbers"):
        solve_bvp(lambda x, y: "slopes", ends, x, zeros)
    with pytest.raises(ZeroDivisionError):
        solve_bvp(lambda x, y: 1 / 0, ends, x, zeros)
    # No solution above 3.51.
    with pytest.raises(furrow.NoOutcome):
        solve_bvp(lambda x, y: np.vstack((y[1], -4 * np.exp(y[0]))), ends, x, zeros)


GUESS = np.linspace(0, 1, 5), np.zeros((2, 5))

#: Arguments that are refused, with the field that the error names and a part of its message.
REFUSED = [
    ({"fun": 1}, "fun", "a function"),
    ({"bc": None}, "bc", "a function"),
    ({"fun_jac": "exact"}, "fun_jac", "a function"),
    ({"x": GUESS[0][::-1]}, "x", r"x = 0.75 at \[1\] after 1: must be numbers that increase"),
    ({"x": [0, 0.5, 0.5, 0.7, 1]}, "x", r"x = 0.5 at \[2\] after 0.5"),
    ({"x": [0, 0.2, math.nan, 0.7, 1]}, "x", r"x = nan at \[2\]: must be finite"),
    ({"x": [0, 0.2, 0.5, 0.7, math.inf]}, "x", r"x = inf at \[4\]: must be finite"),
    ({"x": [0], "y": [[0], [0]]}, "x", r"shape \(1,\): must be .* from 2 to 1000000 nodes"),
    ({"x": [[0, 1]]}, "x", r"shape \(1, 2\): must be an array of shape \(m,\)"),
    ({"x": list("abcde")}, "x", "real numbers"),
    ({"x": np.arange(10**5), "y": np.zeros((16, 10**5))}, "x", "x = 100000 nodes: must be at most 62500 nodes for 16 components"),
    ({"x": np.arange(10**6 + 1)}, "x", r"shape \(1000001,\): must be .* from 2 to 1000000 nodes"),
    ({"x": GUESS[0] + 0j}, "x", "real and imaginary parts as components"),
    ({"y": GUESS[1] + 1j}, "y", "y = complex numbers: must be real values: state real and imaginary parts as components"),
    ({"y": np.full((2, 5), math.nan)}, "y", r"y = nan at \[0, 0\]: must be finite"),
    ({"y": [[0, 0, 0, 0, 0], [0, 0, 0, -math.inf, 0]]}, "y", r"y = -inf at \[1, 3\]: must be finite"),
    ({"y": np.zeros((2, 4))}, "y", r"shape \(2, 4\): must be an array of shape \(n, 5\)"),
    ({"y": np.zeros(5)}, "y", r"shape \(5,\): must be an array of shape \(n, 5\)"),
    ({"y": np.zeros((0, 5))}, "y", r"shape \(0, 5\): must be an array of shape \(n, 5\)"),
    ({"y": [[0], [0, 1]]}, "y", "real numbers"),
    ({"y": np.ma.masked_equal(GUESS[1], 0)}, "y", "y = an array with masked entries: must be numbers throughout"),
    ({"x": np.ma.masked_equal(GUESS[0], 1)}, "x", "x = an array with masked entries"),
    ({"y": [np.ma.masked_equal(row, 0) for row in GUESS[1]]}, "y", "y = an array with masked entries"),
    ({"p": [1, math.nan]}, "p", r"p = nan at \[1\]: must be finite"),
    ({"p": math.inf}, "p", r"p = inf at \[0\]: must be finite"),
    ({"p": [1j]}, "p", "real and imaginary parts"),
    ({"S": np.zeros((2, 3))}, "S", r"shape \(2, 3\): must be an array of shape \(2, 2\)"),
    ({"S": [[0, math.nan], [0, 0]]}, "S", r"nan at \[0, 1\]"),
    ({"S": 1j * np.identity(2)}, "S", "real and imaginary parts"),
    ({"tol": 0}, "tol", "tol = 0.0: must be a finite number above 0"),
    ({"tol": -1e-3}, "tol", "tol = -0.001: must be"),
    ({"tol": math.nan}, "tol", "tol = nan: must be"),
    ({"tol": math.inf}, "tol", "tol = inf: must be"),
    ({"tol": None}, "tol", "tol = None: must be a number"),
    ({"bc_tol": 0}, "bc_tol", "bc_tol = 0.0: must be"),
    ({"verbose": 3}, "verbose", "verbose = 3: must be a whole number from 0 to 2"),
    ({"max_nodes": 0}, "max_nodes", "max_nodes = 0: must be a whole number, at least the number of nodes of x, 5"),
    ({"max_nodes": -1}, "max_nodes", "max_nodes = -1"),
    ({"max_nodes": 1}, "max_nodes", "max_nodes = 1: must be"),
    ({"max_nodes": 4}, "max_nodes", "max_nodes = 4: must be a whole number, at least the number of nodes of x, 5"),
    ({"max_nodes": 10.5}, "max_nodes", "max_nodes = 10.5: must be a whole number"),
    ({"max_nodes": math.inf}, "max_nodes", "max_nodes = inf: must be a whole number"),
    ({"max_nodes": math.nan}, "max_nodes", "max_nodes = nan: must be a whole number"),
    # So many nodes would end the process where memory does.
    ({"max_nodes": 10**9}, "max_nodes", r"max_nodes = 1000000000: .* at most 1000000 for 2 components"),
    ({"y": np.zeros((16, 5)), "max_nodes": 10**5}, "max_nodes", "at most 62500 for 16 components"),
    ({"error_tol": -1}, "error_tol", r"error_tol = -1.0: must be a finite number above 0"),
    ({"besides": [1]}, "besides", r"besides = 1: must be a list of results of furrow.bvp.solve_bvp"),
    ({"besides": 1}, "besides", r"besides = 1: must be a list"),
]


@pytest.mark.parametrize(("given", "field", "message"), REFUSED)
def test_arguments_are_refused_before_anything_is_solved(given, field, message):
    def fail(*arguments):
        raise AssertionError("called")

    arguments = {"fun": fail, "bc": fail, "x": GUESS[0], "y": GUESS[1]} | given
    with pytest.raises(furrow.InputError, match=message) as refused:
        solve_bvp(**arguments)
    assert refused.value.field == field and len(str(refused.value)) < 220


def test_known_solutions_are_of_the_same_problem():
    found = solve_bvp(bratu, ends, *GUESS)
    with pytest.raises(furrow.InputError, match="besides = one solution: must be a list"):
        solve_bvp(bratu, ends, *GUESS, besides=found)
    with pytest.raises(furrow.InputError, match=r"solution of 2 components and 0 scalar .* which has 1 components and 0"):
        solve_bvp(lambda x, y: y, lambda ya, yb: ya - 1, [0, 1], [[1, 1]], besides=[found])


def test_known_solutions_are_on_the_same_interval():
    found = solve_bvp(bratu, ends, *GUESS)
    with pytest.raises(furrow.InputError, match=r"a solution from 0 to 1: must be solutions on the interval .* from 0 to 1.5"):
        solve_bvp(bratu, ends, 1.5 * GUESS[0], GUESS[1], besides=[found])


def test_derivatives_of_conditions_are_as_many_as_there_are_arguments():
    three = (np.identity(2), np.identity(2), np.zeros((2, 1)))
    with pytest.raises(furrow.InputError, match="bc_jac = 3 arrays: must be a function that returns 2 arrays"):
        solve_bvp(bratu, ends, *GUESS, bc_jac=lambda ya, yb: three)


def test_complex_values_are_refused():
    x, ones = np.linspace(0, 1, 5), np.ones((1, 5))
    with pytest.raises(furrow.InputError, match=r"fun = complex numbers: must be .* real and imaginary parts as components"):
        solve_bvp(lambda x, y: (0.3 + 0.2j) * y, lambda ya, yb: ya - 1, x, ones)
    with pytest.raises(furrow.InputError, match="bc = complex numbers"):
        solve_bvp(lambda x, y: y, lambda ya, yb: ya - 1j, x, ones)
    with pytest.raises(furrow.InputError, match="fun_jac = complex numbers"):
        solve_bvp(lambda x, y: y, lambda ya, yb: ya - 1, x, ones, fun_jac=lambda x, y: np.ones((1, 1, len(x)), complex))
    # As components they are solved for: y(1) = exp(0.3 + 0.2i).
    turned = np.array([[0.3, -0.2], [0.2, 0.3]])
    found = solve_bvp(lambda x, y: turned @ y, lambda ya, yb: ya - [1, 0], x, np.ones((2, 5)), tol=1e-9)
    assert complex(*found.y[:, -1]) == pytest.approx(np.exp(0.3 + 0.2j), abs=1e-9)


@pytest.mark.filterwarnings("ignore:invalid value")
@pytest.mark.parametrize("start", [1e-7, 1e-9, 1e-12])
def test_differences_stay_where_a_function_is_defined(start):
    # The root is not defined left of 0, to which the solution (x/2 + sqrt(start))^2 is nearer than a difference is wide.
    found = solve_bvp(lambda x, y: np.sqrt(y), lambda ya, yb: ya - start, np.linspace(0, 1, 11), np.ones((1, 11)))
    assert found.y[0, -1] == pytest.approx((0.5 + math.sqrt(start)) ** 2, abs=1e-8)


@pytest.mark.filterwarnings("ignore:invalid value")
def test_differences_of_conditions_and_of_unknowns_stay_where_they_are_defined():
    # p is nearer to 1 than a difference is wide, and the roots are not defined beyond.
    def fun(x, y, p):
        return np.sqrt(1 - p[0]) * y

    def bc(ya, yb, p):
        return [ya[0] - np.sqrt(1 - p[0]), p[0] - 1 + 1e-6]

    found = solve_bvp(fun, bc, [0, 1], [[1, 1]], [0.5])
    assert found.p == pytest.approx([1 - 1e-6], abs=1e-12)
    assert found.y[0] == pytest.approx(1e-3 * np.exp([0, 1e-3]), rel=1e-6)


def singular_slopes(x, y):
    return np.vstack((y[1], -y[0]))


def singular_derivatives(x, y):
    zero, one = np.zeros_like(x), np.ones_like(x)
    return np.array([[zero, one], [-one, zero]])


#: y'' + 2 y'/x as y' and a term that is singular at 0.
SPHERE = [[0, 0], [0, -2]]


@pytest.mark.parametrize("derivatives", [None, singular_derivatives])
def test_a_singular_term(derivatives):
    # y'' + 2 y'/x + y = 0 is solved by sin x / x.
    x = np.linspace(0, np.pi / 2, 5)
    found = solve_bvp(
        singular_slopes, lambda ya, yb: [ya[1], yb[0] - 2 / np.pi], x, np.ones((2, 5)), None, SPHERE, derivatives, None, 1e-9
    )
    at = np.linspace(0, np.pi / 2, 101)
    assert np.abs(found.sol(at)[0] - np.sinc(at / np.pi)).max() < 1e-11
    # y''(0) = -1/3, where the term is 0/0.
    assert found.yp[:, 0] == pytest.approx([0, -1 / 3], abs=1e-8)
    assert found.rms_residuals.max() < 1e-8


def test_a_singular_term_of_a_nonlinear_equation():
    # Emden's equation y'' + 2 y'/x + y^5 = 0 is solved by (1 + x^2/3)^(-1/2).
    guess = np.vstack((np.full(5, math.sqrt(0.75)), np.full(5, 1e-4)))
    found = solve_bvp(
        lambda x, y: np.vstack((y[1], -(y[0] ** 5))),
        lambda ya, yb: np.array([ya[1], yb[0] - math.sqrt(0.75)]),
        np.linspace(0, 1, 5),
        guess,
        S=SPHERE,
        tol=1e-9,
    )
    at = np.linspace(0, 1, 101)
    assert np.abs(found.sol(at)[0] - (1 + at**2 / 3) ** -0.5).max() < 1e-11


def test_a_singular_term_with_a_scalar_unknown():
    # y'' + 2 y'/x + p^2 y = 0 with y(0) = 1 and y(1) = 0 is solved by sin(p x) / (p x) with p = pi; the left end is at 3.
    x = np.linspace(3, 4, 9)
    found = solve_bvp(
        lambda x, y, p: np.vstack((y[1], -(p[0] ** 2) * y[0])),
        lambda ya, yb, p: np.array([ya[0] - 1, ya[1], yb[0]]),
        x,
        np.vstack((4 - x, -np.ones(9))),
        [3],
        SPHERE,
        tol=1e-9,
    )
    assert found.p == pytest.approx([np.pi], abs=1e-10)


def test_conditions_that_allow_a_singular_solution_have_no_outcome():
    with pytest.raises(furrow.NoOutcome, match="singular"):
        solve_bvp(singular_slopes, lambda ya, yb: [ya[0] - 1, yb[0] - 0.3], GUESS[0], np.ones((2, 5)), S=SPHERE)


def test_results_are_those_of_scipy(capsys):
    found = solve_bvp(bratu, ends, *GUESS, None, None, None, None, 1e-6, 1000, 0, 1e-8)
    assert capsys.readouterr().out == ""
    assert (found.status, found.success) == (0, True) and "converged" in found.message
    assert found["x"] is found.x and found["sol"](0.5)[0] == found.sol(0.5)[0] and dict(found)["niter"] == found.niter
    assert "rms_residuals" in found and "_collocation" not in found
    with pytest.raises(KeyError):
        found["_collocation"]
    assert found.rms_residuals.shape == (len(found.x) - 1,)
    # The mean of the residuals by many points.
    at = found.x[0] + (found.x[1] - found.x[0]) * (np.arange(1000) + 0.5) / 1000
    slopes = bratu(at, found.sol(at))
    residuals = (found.sol(at, 1) - slopes) / (1 + abs(slopes))
    assert found.rms_residuals[0] == pytest.approx(math.sqrt((residuals**2).sum(axis=0).mean()), rel=1e-2)
    for verbose in (1, 2):
        solve_bvp(bratu, ends, *GUESS, verbose=verbose)
        assert capsys.readouterr().out == (
            f"Solved in {found.niter} iterations, number of nodes {len(found.x)}, largest defect {found.defect:.1e}.\n"
        )


def test_solutions_are_pickled_and_copied():
    found, at = solve_bvp(bratu, ends, *GUESS), np.linspace(0, 1, 101)
    for again in (pickle.loads(pickle.dumps(found)), copy.deepcopy(found), copy.copy(found)):
        assert (again.sol(at) == found.sol(at)).all() and (again.sol(at, 1) == found.sol(at, 1)).all()
        assert (again.x == found.x).all() and again.defect == found.defect and again.p is None
        # It is known as the one that it is a copy of.
        with np.errstate(over="ignore"):
            second = solve_bvp(bratu, ends, np.linspace(0, 1, 9), np.zeros((2, 9)), besides=[again])
        assert second.sol(0.0)[1] == pytest.approx(10.8469, abs=1e-3)


def test_values_between_nodes_are_as_accurate_as_those_at_nodes():
    found, at = solve_bvp(lambda x, y: y, lambda ya, yb: ya - 1, [0, 1], [[1, 1]], tol=1e-9), np.linspace(0, 1, 1001)
    assert np.abs(found.sol(at)[0] - np.exp(at)).max() < 1e-10 and np.abs(found.sol(at, 1)[0] - np.exp(at)).max() < 1e-8
    assert (found.sol(found.x) == found.y).all() and (found.sol(found.x, 1) == found.yp).all()


def test_solutions_are_evaluated_within_their_mesh():
    found = solve_bvp(bratu, ends, *GUESS)
    for x, message in (
        (7.0, "x = 7.0: must be within the mesh, from 0.0 to 1.0"),
        ([0.5, -0.1], r"x = -0.1 at \[1\]: must be within"),
        ([[math.nan]], r"x = nan at \[0, 0\]: must be within"),
        (math.inf, "x = inf: must be within"),
        ("0.5", "x = '0.5': must be a real number"),
        (None, "x = None|x = nan"),
        (0.5j, "x = complex numbers"),
    ):
        with pytest.raises(furrow.InputError, match=message):
            found.sol(x)
    for nu in (2, -1, 0.5, "1", None, np.zeros(2)):
        with pytest.raises(furrow.InputError, match=r"nu = .*: must be 0 or 1"):
            found.sol(0.5, nu)
    # Rounding of an end, no places, and both derivatives that are offered.
    assert (found.sol(1 + 1e-16) == found.y[:, -1]).all() and (found.sol(np.nextafter(1, 2)) == found.y[:, -1]).all()
    assert found.sol([]).shape == (2, 0) and found.sol(0.5, np.int64(1)).shape == (2,)


def test_messages_write_small_numbers_shortly():
    with np.errstate(all="ignore"), pytest.raises(furrow.NoOutcome) as failed:
        solve_bvp(lambda x, y: (1 / x)[None], lambda ya, yb: yb, np.linspace(0, 1, 11), np.zeros((1, 11)), tol=1e-3)
    assert len(str(failed.value)) < 200


def test_no_more_nodes_are_taken_than_allowed():
    assert len(solve_bvp(bratu, ends, *GUESS, max_nodes=5, tol=1e-3).x) <= 5
    with pytest.raises(furrow.NoOutcome):
        solve_bvp(bratu, ends, *GUESS, max_nodes=5, tol=1e-12)


def test_more_than_sixteen_equations():
    x = np.linspace(0, 1, 5)
    found = solve_bvp(lambda x, y: -y, lambda a, b: a - 1, x, np.ones((24, 5)))
    assert abs(found.sol(0.7) - np.exp(-0.7)).max() < 1e-7
    with pytest.raises(furrow.InputError, match="40 components and scalar unknowns are more than 32"):
        solve_bvp(lambda x, y: -y, lambda a, b: a - 1, x, np.ones((40, 5)))


def test_a_jump_of_the_right_hand_side_is_found():
    x = np.linspace(0, 1, 11)
    for jump in np.linspace(0.013, 0.987, 40):
        found = solve_bvp(lambda x, y, at=jump: np.where(x > at, 1.0, 0.0)[None, :], lambda a, b: a, x, np.zeros((1, 11)))
        assert abs(found.sol(1.0)[0] - (1 - jump)) < 1e-5, jump


def test_conditions_that_depend_on_an_end_far_from_the_guess_hold():
    x = np.linspace(0, 1, 5)
    found = solve_bvp(
        lambda x, y: np.vstack((y[1], 0 * x)),
        lambda a, b: np.array([a[0] + max(b[0] - 2, 0) - 2, a[1] - 3]),
        x,
        np.zeros((2, 5)),
    )
    assert abs(found.y[0, 0] - 0.5) < 1e-8


def test_differences_follow_the_size_of_a_component():
    # y'' = 100 y^3 / c^2 with values of 1e-6; scaled by c the middle is 0.307687446.
    c, x = 1e-6, np.linspace(0, 1, 11)
    found = solve_bvp(
        lambda x, y: np.vstack((y[1], 100 * y[0] ** 3 / c**2)),
        lambda ya, yb: np.array([ya[0] - c, yb[0] - 2 * c]),
        x,
        c * np.vstack((1 + x, np.ones_like(x))),
    )
    assert found.sol(0.5)[0] / c == pytest.approx(0.3076874, abs=1e-5)


def test_rough_guesses_with_zeros_at_the_ends():
    # The first zero of the Bessel function J0. The guess is a sine, which at 1 is 1e-15 by rounding.
    x = np.linspace(0, 1, 15)
    found = solve_bvp(
        lambda x, y, p: np.vstack((y[1], -p[0] * y[0])),
        lambda ya, yb, p: np.array([ya[0] - 1, ya[1], yb[0]]),
        x,
        4 * np.vstack((np.sin(2 * np.pi * x), np.sin(2 * np.pi * x + 1))),
        [5.0],
        S=np.diag([0.0, -1.0]),
    )
    assert found.p is not None and math.sqrt(found.p[0]) == pytest.approx(2.404825557695773, abs=1e-6)


def test_a_family_of_solutions_has_no_outcome_on_a_coarse_mesh_either():
    with pytest.raises(furrow.NoOutcome, match="singular"):
        solve_bvp(lambda x, y: np.vstack((y[1], -y[0])), ends, np.linspace(0, np.pi, 5), np.ones((2, 5)))
