//! Branch points of algebraic equations in the scalar unknowns, which may be conditions of any kind.

use furrow_bvp::{BranchPointKind, Continuation, ContinuationSettings, Metric, SimpleProblem, Solution, locate, mesh};

/// What an equation is written as.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Left,
    Right,
    Integral,
}

use Kind::{Integral, Left, Right};

type Number = furrow_bvp::auto::Jet;

/// y′ = 0, y(0) = 0, and N equations in N + 1 scalar unknowns.
fn problem<const N: usize>(equations: fn(&[Number]) -> [Number; N], kinds: [Kind; N]) -> SimpleProblem {
    let count = |kind| kinds.iter().filter(|k| **k == kind).count();
    let write = move |kind, p: &[Number], out: &mut [Number]| {
        let those = equations(p).into_iter().zip(kinds).filter(|(_, k)| *k == kind);
        out.iter_mut().zip(those).for_each(|(out, (value, _))| *out = value);
    };
    SimpleProblem::new(1, |_, y, _, f| f[0] = y[0] * 0.0)
        .scalars(N + 1)
        .left_conditions(1 + count(Left), move |y, p, r| {
            r[0] = y[0];
            write(Left, p, &mut r[1..]);
        })
        .right_conditions(count(Right), move |_, p, r| write(Right, p, r))
        .integrals(count(Integral), |_, _, _, _| {})
        .offsets(move |p, h| write(Integral, p, h))
}

/// The branch points of a branch of constants.
fn points(problem: SimpleProblem, scalars: &[f64], upwards: bool, bound: f64) -> Vec<(f64, BranchPointKind)> {
    let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 4), &[0.0], scalars);
    let settings = ContinuationSettings { max_step: 0.05, ..Default::default() };
    let metric = Metric::unit(1, scalars.len());
    let mut branch = Continuation::start(problem, guess, metric, settings, upwards).unwrap();
    let range = if upwards { [f64::NEG_INFINITY, bound] } else { [bound, f64::INFINITY] };
    let mut found = Vec::new();
    branch
        .follow(range, 1000, |branch, advance| {
            if advance.passed_branch_point {
                let point = locate::branch_point(branch).unwrap();
                found.push((point.parameter(), point.kind()));
            }
            true
        })
        .unwrap();
    found
}

/// x(λ − x) = 0.
#[test]
fn a_branch_point_is_found_whichever_kind_of_condition_has_it() {
    for kind in [Left, Right, Integral] {
        let found = points(problem(|p| [p[0] * (p[1] - p[0])], [kind]), &[0.0, -0.53], true, 1.0);
        assert_eq!(found.len(), 1, "{kind:?}: {found:?}");
        assert!(found[0].0.abs() < 1e-8 && found[0].1 == BranchPointKind::Transcritical, "{kind:?}: {found:?}");
    }
}

/// Two competitors for space, with shares m and c, and t = 1 − m − c left: 0 = am c − λm/(m + t) + γmt, 0 = rtc − dc − amc.
/// Branches cross at c = 0 where m = 0 or m = (r − d)/(r + a), and at m = 0 where t = d/r and λ = t(ac + γt).
#[test]
fn a_branch_point_of_two_equations_is_found_whichever_kinds_of_conditions_they_are() {
    let (a, gamma, d) = (0.1, 0.8, 0.44);
    let equations = |p: &[Number]| {
        let (a, gamma, d) = (0.1, 0.8, 0.44);
        let [m, c, lambda] = [p[0], p[1], p[2]];
        let t = -m - c + 1.0;
        [m * c * a - lambda * m / (m + t) + m * t * gamma, t * c - c * d - m * c * a]
    };
    let m = (1.0 - d) / (1.0 + a);
    let exact = [gamma * (1.0 - m), gamma];
    let other = d * (a * (1.0 - d) + gamma * d);
    for first in [Left, Right, Integral] {
        for second in [Left, Right, Integral] {
            let kinds = [first, second];
            let with_first = points(problem(equations, kinds), &[1.0 - 0.1 / gamma, 0.0, 0.1], true, 1.0);
            let places: Vec<f64> = with_first.iter().map(|point| point.0).collect();
            assert_eq!(places.len(), 2, "{kinds:?}: {places:?}");
            for (found, exact) in places.iter().zip(exact) {
                assert!((found - exact).abs() < 1e-8, "{kinds:?}: {places:?}");
            }
            let without = points(problem(equations, kinds), &[0.0, 1.0 - d, 0.1], true, 0.5);
            assert_eq!(without.len(), 1, "{kinds:?}: {without:?}");
            assert!((without[0].0 - other).abs() < 1e-8, "{kinds:?}: {without:?}");
        }
    }
}
