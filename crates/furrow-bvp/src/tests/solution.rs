//! Solutions as functions: values, slopes, and transfers between meshes.

use super::problems::random_solution;
use super::{Random, distance};
use crate::gauss::MAX_STAGES;
use crate::{Dimensions, Gauss, Solution, mesh};

/// All numbers of stages, with random numbers of their own.
fn every_stage_count(seed: u64) -> impl Iterator<Item = (usize, Gauss, Random)> {
    (1..=MAX_STAGES).map(move |m| (m, Gauss::new(m).unwrap(), Random(seed + m as u64)))
}

/// Value and slope at x of component c, a polynomial of degree m.
fn polynomial(m: usize, c: usize, x: f64) -> (f64, f64) {
    let coefficient = |k: usize| 1.0 / (1.0 + (c + k) as f64);
    let value = (0..=m).rev().fold(0.0, |v, k| v * x + coefficient(k));
    let slope = (1..=m).rev().fold(0.0, |v, k| v * x + k as f64 * coefficient(k));
    (value, slope)
}

fn sampled_polynomial(gauss: &Gauss, mesh: &[f64]) -> Solution {
    Solution::from_fn(gauss, mesh, 2, &[0.25, -3.0], |x, v| {
        v.iter_mut().enumerate().for_each(|(c, v)| *v = polynomial(gauss.m, c, x).0);
    })
    .unwrap()
}

/// Largest Σ|basis| on [0, 1] with the derivatives: by how much errors of values come out amplified in the polynomial
/// and, times 1/h, in its slope.
fn amplification(gauss: &Gauss) -> (f64, f64) {
    let mut basis = vec![0.0; gauss.m + 1];
    let (mut value, mut slope) = (0.0f64, 0.0f64);
    for k in 0..=1000 {
        gauss.basis(k as f64 / 1000.0, &mut basis);
        value = value.max(basis.iter().map(|b| b.abs()).sum());
        gauss.basis_derivative(k as f64 / 1000.0, &mut basis);
        slope = slope.max(basis.iter().map(|b| b.abs()).sum());
    }
    (value, slope)
}

/// Rounding of values below 4 and of positions, in polynomials of slope below 8: some units in the last place for each
/// of the at most six terms of the interpolation.
const ROUNDING: f64 = 6.0 * 8.0 * 4.0 * f64::EPSILON;

#[test]
fn polynomials_of_degree_m_are_exact_in_value_and_slope() {
    for m in 1..=MAX_STAGES {
        let gauss = Gauss::new(m).unwrap();
        let y = sampled_polynomial(&gauss, &Random(m as u64).mesh(4));
        let (value, slope) = amplification(&gauss);
        for k in 0..=50 {
            let x = y.mesh[0] + (y.mesh[4] - y.mesh[0]) * k as f64 / 50.0;
            let (i, mut v, mut dv) = (y.interval_of(x), [0.0; 2], [0.0; 2]);
            let h = y.mesh[i + 1] - y.mesh[i];
            y.eval(&gauss, x, &mut v);
            y.slope_in(&gauss, i, (x - y.mesh[i]) / h, &mut dv);
            for c in 0..2 {
                let exact = polynomial(m, c, x);
                assert!((v[c] - exact.0).abs() <= value * ROUNDING, "m={m} {x}");
                assert!((dv[c] - exact.1).abs() <= slope / h * ROUNDING, "m={m} {x}: {} {}", dv[c], exact.1);
            }
        }
    }
}

#[test]
fn transfers_carry_polynomials_of_degree_m_exactly() {
    for (m, gauss, mut random) in every_stage_count(40) {
        let y = sampled_polynomial(&gauss, &random.mesh(3));
        let ends = [y.mesh[0], y.mesh[3]];
        for intervals in [1, 2, 5, 16] {
            let there = mesh::uniform(ends[0], ends[1], intervals);
            let (carried, exact) = (y.on_mesh(&gauss, &there), sampled_polynomial(&gauss, &there));
            let allowed = amplification(&gauss).0 * ROUNDING;
            assert_eq!((&carried.mesh, &carried.scalars), (&exact.mesh, &exact.scalars));
            assert!(distance(&carried.nodes, &exact.nodes) <= allowed, "m={m}");
            assert!(distance(&carried.stages, &exact.stages) <= allowed, "m={m}");
        }
    }
}

/// Values that belong to no smooth function, so that an exact copy can come from the right place only.
fn rough(m: usize, mesh: Vec<f64>, random: &mut Random) -> Solution {
    random_solution(Dimensions { components: 3, scalars: 2, ..Dimensions::default() }, m, mesh, random)
}

#[test]
fn nodes_in_common_keep_their_values_to_the_last_bit() {
    for (m, gauss, mut random) in every_stage_count(60) {
        let mesh = random.mesh(6);
        let y = rough(m, mesh.clone(), &mut random);
        // Finer with all nodes in common, coarser with every second, and a mixture.
        let mixture =
            vec![mesh[0], mesh[1], 0.3 * mesh[1] + 0.7 * mesh[2], mesh[4], 0.5 * (mesh[4] + mesh[5]), mesh[6]];
        for there in [mesh::halved(&mesh), vec![mesh[0], mesh[2], mesh[4], mesh[6]], mixture] {
            let carried = y.on_mesh(&gauss, &there);
            let common: Vec<(usize, usize)> =
                (0..there.len()).filter_map(|k| mesh.iter().position(|x| *x == there[k]).map(|i| (k, i))).collect();
            assert!(common.len() >= 4);
            for (k, i) in common {
                assert_eq!(carried.node(k), y.node(i), "m={m} node {i}");
            }
        }
    }
}

#[test]
fn a_transfer_to_the_same_mesh_keeps_nodes_exactly_and_stages_to_rounding() {
    for (m, gauss, mut random) in every_stage_count(80) {
        let mesh = random.mesh(5);
        let y = rough(m, mesh.clone(), &mut random);
        let carried = y.on_mesh(&gauss, &mesh);
        assert_eq!(carried.nodes, y.nodes);
        // A stage position is found again to a few roundings of x, at which the polynomial has a slope of at most the
        // amplification over h.
        let (_, slope) = amplification(&gauss);
        let narrowest = mesh.windows(2).map(|x| x[1] - x[0]).fold(f64::INFINITY, f64::min);
        assert!(distance(&carried.stages, &y.stages) <= 16.0 * f64::EPSILON * slope / narrowest);
    }
}

#[test]
fn storage_that_is_reused_changes_nothing() {
    let (gauss, mut random) = (Gauss::new(4).unwrap(), Random(3));
    let mesh = random.mesh(5);
    let ends = (mesh[0], mesh[5]);
    let y = rough(4, mesh, &mut random);
    let mut out = rough(2, random.mesh(9), &mut random);
    for intervals in [12, 3, 7] {
        let there = mesh::uniform(ends.0, ends.1, intervals);
        y.transfer_into(&gauss, &there, &mut out);
        assert_eq!(out, y.on_mesh(&gauss, &there));
    }
}

/// sin 3x as a solution; its (m+1)st derivative is at most 3^(m+1).
fn sine(gauss: &Gauss, mesh: &[f64]) -> Solution {
    Solution::from_fn(gauss, mesh, 1, &[], |x, v| v[0] = (3.0 * x).sin()).unwrap()
}

/// Bound on the error of interpolating [`sine`]: |y^(m+1)|/(m+1)! Π|x − x_k| with the points in an interval of width h.
fn interpolation_error(m: usize, mesh: &[f64]) -> f64 {
    let h = mesh.windows(2).map(|x| x[1] - x[0]).fold(0.0, f64::max);
    (1..=m + 1).map(|k| 3.0 * h / k as f64).product()
}

#[test]
fn there_and_back_loses_no_more_than_two_interpolations() {
    for m in 1..=MAX_STAGES {
        let gauss = Gauss::new(m).unwrap();
        let (here, there) = (Random(m as u64).mesh(6), mesh::uniform(0.0, 1.0, 7));
        let stretch = |x: &f64| (x - here[0]) / (here[6] - here[0]);
        let mut here: Vec<f64> = here.iter().map(stretch).collect();
        (here[0], here[6]) = (0.0, 1.0);
        let y = sine(&gauss, &here);
        let back = y.on_mesh(&gauss, &there).on_mesh(&gauss, &here);
        // The second interpolation has its own error and amplifies the first one's.
        let (first, second) = (interpolation_error(m, &here), interpolation_error(m, &there));
        let allowed = amplification(&gauss).0 * first + second + ROUNDING;
        let lost = distance(&back.nodes, &y.nodes).max(distance(&back.stages, &y.stages));
        assert!(lost <= allowed, "m={m}: {lost:.1e} {allowed:.1e}");
        assert!(back.nodes[0] == y.nodes[0] && back.nodes[6] == y.nodes[6]);
    }
}

#[test]
fn there_and_back_over_a_finer_mesh_with_the_same_nodes_loses_nothing() {
    // Every half carries the same polynomial, for which its own points are exact.
    for m in 1..=MAX_STAGES {
        let gauss = Gauss::new(m).unwrap();
        let y = sine(&gauss, &mesh::uniform(0.0, 1.0, 5));
        let finer = mesh::halved(&y.mesh);
        let back = y.on_mesh(&gauss, &finer).on_mesh(&gauss, &y.mesh);
        assert_eq!(back.nodes, y.nodes);
        let (value, _) = amplification(&gauss);
        assert!(distance(&back.stages, &y.stages) <= value * value * ROUNDING, "m={m}");
    }
}

#[test]
fn intervals_are_found_with_their_left_nodes_and_clamped_beyond_the_ends() {
    let y = sampled_polynomial(&Gauss::new(2).unwrap(), &[0.0, 0.1, 0.5, 2.0]);
    let cases = [(-1.0, 0), (0.0, 0), (0.05, 0), (0.1, 1), (0.3, 1), (0.5, 2), (1.9, 2), (2.0, 2), (7.0, 2)];
    for (x, i) in cases {
        assert_eq!(y.interval_of(x), i, "{x}");
    }
}

#[test]
fn ends_are_the_ends_of_the_first_and_last_polynomials() {
    for (m, gauss, mut random) in every_stage_count(90) {
        let mesh = random.mesh(4);
        let y = rough(m, mesh.clone(), &mut random);
        let (mut v, mut w) = ([0.0; 3], [0.0; 3]);
        for i in 0..4 {
            y.eval(&gauss, mesh[i], &mut v);
            assert_eq!(v, y.node(i), "a node belongs to the interval on its right");
            for j in 0..m {
                y.eval_in(&gauss, i, gauss.c[j], &mut v);
                assert_eq!(v, y.stage(i, j));
            }
        }
        // At the last node it is the polynomial that is evaluated; the node has a value of its own.
        y.eval(&gauss, mesh[4], &mut v);
        y.eval_in(&gauss, 3, 1.0, &mut w);
        assert_eq!(v, w);
        assert!(v != y.node(4));
        // By the node equation the value at the end is y₀ + Σ d_j (Y_j − y₀): the polynomial's.
        let rest = 1.0 - gauss.d.iter().sum::<f64>();
        for c in 0..3 {
            let end = rest * y.node(3)[c] + (0..m).map(|j| gauss.d[j] * y.stage(3, j)[c]).sum::<f64>();
            assert!((v[c] - end).abs() <= amplification(&gauss).0 * ROUNDING, "m={m}");
        }
    }
}

/// Values of a mirrored function: y(−x).
fn mirrored(y: &Solution) -> Solution {
    let reversed = |values: &[f64]| values.chunks(y.components).rev().flatten().copied().collect();
    Solution {
        mesh: y.mesh.iter().rev().map(|x| -x).collect(),
        nodes: reversed(&y.nodes),
        stages: reversed(&y.stages),
        ..y.clone()
    }
}

/// A change of mesh keeps the mirror symmetry of a problem, even for values that are no collocation solution.
#[test]
fn transfers_do_not_know_left_from_right() {
    for (m, gauss, mut random) in every_stage_count(80) {
        let mesh = random.mesh(6);
        let y = rough(m, mesh.clone(), &mut random);
        let there = mesh::halved(&mesh::uniform(mesh[0], mesh[6], 5));
        let back: Vec<f64> = there.iter().rev().map(|x| -x).collect();
        let (one, other) = (y.on_mesh(&gauss, &there), mirrored(&mirrored(&y).on_mesh(&gauss, &back)));
        assert!(distance(&one.nodes, &other.nodes) < 1e-10, "m={m}: {}", distance(&one.nodes, &other.nodes));
        assert!(distance(&one.stages, &other.stages) < 1e-10, "m={m}: {}", distance(&one.stages, &other.stages));
    }
}
