//! Defects, and meshes made from them.

use super::order::uneven;
use super::problems::{Initial, layer, quadratic, solved};
use super::second_order::SecondOrder;
use crate::gauss::MAX_STAGES;
use crate::{Gauss, Solution, mesh};

fn largest_defect(m: usize, intervals: usize) -> f64 {
    let mut problem = quadratic();
    let y = solved(&mut problem, m, &uneven(intervals));
    mesh::defect(&Gauss::new(m).unwrap(), &mut problem, &y).into_iter().fold(0.0, f64::max)
}

#[test]
fn a_defect_is_that_of_its_definition() {
    // One stage: the straight line from the node value 1 through the stage value s, seen at a quarter of the interval.
    let (rate, h, s) = (-0.7, 0.5, 1.3);
    let y = Solution {
        components: 1,
        m: 1,
        mesh: vec![0.0, h, 2.0 * h],
        nodes: vec![1.0, 1.0, 1.0],
        stages: vec![s, 1.0],
        scalars: Vec::new(),
    };
    let mut problem = Initial { rate, condition: |y| (y, 1.0) };
    let defect = mesh::defect(&Gauss::new(1).unwrap(), &mut problem, &y);
    let value = 1.0 + 0.5 * (s - 1.0);
    let expected = [h * ((s - 1.0) / (0.5 * h) - rate * value).abs() / (1.0 + value), h * rate.abs() / 2.0];
    for (a, b) in defect.iter().zip(expected) {
        assert!((a - b).abs() < 8.0 * f64::EPSILON, "{a} {b}");
    }
}

#[test]
fn defects_shrink_like_h_to_the_m_plus_1() {
    // Between Gauss points u′ − f(u) is y^(m+1) Π(θ − c_j) h^m/m! to leading order; the defect has one more h.
    for m in 1..=MAX_STAGES {
        let (coarse, fine) = (largest_defect(m, 16), largest_defect(m, 32));
        let order = (coarse / fine).log2();
        assert!(fine > 1e-12 && (order - (m as f64 + 1.0)).abs() < 0.5, "m={m}: {order} {coarse:.1e} {fine:.1e}");
    }
}

#[test]
fn polynomials_that_solve_have_no_defect() {
    // y″ = 2 is solved by a parabola, which two stages hold exactly.
    let mut problem = SecondOrder { force: Box::new(|_, _| [2.0, 0.0, 0.0]), ends: [0.0, 1.0] };
    let y = solved(&mut problem, 2, &uneven(4));
    // Values below 2 in slopes, amplified by at most the 1/h that the defect multiplies away again.
    assert!(mesh::defect(&Gauss::new(2).unwrap(), &mut problem, &y).iter().all(|d| *d < 1e2 * f64::EPSILON));
}

#[test]
fn halving_keeps_every_node_and_adds_every_midpoint() {
    let mesh = uneven(8);
    let midpoints = mesh.windows(2).flat_map(|x| [0.5 * (x[0] + x[1]), x[1]]);
    assert_eq!(mesh::halved(&mesh), [mesh[0]].into_iter().chain(midpoints).collect::<Vec<_>>());
}

#[test]
fn imbalance_is_the_largest_share_over_the_mean_one() {
    // Integrals 1/2 · 1, 1/4 · 6 and 1/4 · 4, of mean 1.
    assert_eq!(mesh::imbalance(&[0.0, 0.5, 0.75, 1.0], &[1.0, 6.0, 4.0]), 1.5);
    // Each as wide as the monitor is low.
    assert_eq!(mesh::imbalance(&[0.0, 0.5, 0.75, 1.0], &[1.0, 2.0, 2.0]), 1.0);
}

#[test]
fn the_monitor_is_half_the_density_of_the_defect_and_half_its_mean() {
    let (mesh, m) = ([0.0, 0.5, 0.75, 1.0], 2);
    let mut weight = vec![9.0; 7];
    // Cube roots 1, 2 and 0 over widths 1/2, 1/4 and 1/4: densities 2, 8 and 0 of mean 1 + 2 + 0.
    mesh::defect_monitor(&mesh, &[1.0, 8.0, 0.0], m, &mut weight);
    let expected = [0.5 * (2.0 + 3.0), 0.5 * (8.0 + 3.0), 0.5 * (0.0 + 3.0)];
    assert_eq!(weight.len(), 3);
    for (w, e) in weight.iter().zip(expected) {
        assert!((w - e).abs() < 16.0 * f64::EPSILON * e, "{w} {e}");
    }
}

/// y″ = y/ε² with a layer of width ε at 0.
const EPSILON: f64 = 0.025;

/// Largest error of y at the nodes; the solution is sinh((1 − x)/ε)/sinh(1/ε).
fn layer_error(y: &Solution) -> f64 {
    let exact = |x: f64| ((1.0 - x) / EPSILON).sinh() / (1.0 / EPSILON).sinh();
    (0..y.mesh.len()).map(|i| (y.node(i)[0] - exact(y.mesh[i])).abs()).fold(0.0, f64::max)
}

#[test]
fn a_mesh_made_from_defects_beats_a_uniform_one_of_twice_as_many_intervals() {
    for m in 2..=4 {
        let (gauss, n) = (Gauss::new(m).unwrap(), 16);
        let mut problem = layer(EPSILON * EPSILON, [1.0, 0.0, 0.0], [1.0, 0.0]);
        let uniform = layer_error(&solved(&mut problem, m, &mesh::uniform(0.0, 1.0, 2 * n)));
        let mut y = solved(&mut problem, m, &mesh::uniform(0.0, 1.0, n));
        let (mut weight, mut adapted) = (Vec::new(), Vec::new());
        let mut imbalance = Vec::new();
        for _ in 0..3 {
            let defect = mesh::defect(&gauss, &mut problem, &y);
            mesh::defect_monitor(&y.mesh, &defect, m, &mut weight);
            imbalance.push(mesh::imbalance(&y.mesh, &weight));
            mesh::equidistribute(&y.mesh, &weight, n, &mut adapted);
            assert_eq!(adapted.len(), n + 1);
            y = solved(&mut problem, m, &adapted);
        }
        assert!(layer_error(&y) < uniform, "m={m}: {:.1e} {uniform:.1e}", layer_error(&y));
        assert!(imbalance[2] < imbalance[0], "m={m}: {imbalance:?}");
    }
}
