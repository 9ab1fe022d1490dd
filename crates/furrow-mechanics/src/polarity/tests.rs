use super::branch::follow;
use super::problem::{A, A_U, COMPONENTS, MEAN_A, P, P_U, Polarity, SCALE};
use super::states::{Evolution, is_polarised, polarity};
use super::*;
use furrow_bvp::{
    BoundaryValueProblem, CollocationPoint, Directional, Gauss, PointDirection, PointJacobian, PointValues, Solution,
    mesh,
};
use furrow_cell::ZYGOTE;
use std::f64::consts::PI;

fn zygote() -> (Chemistry, Membrane) {
    let chemistry = Chemistry::goehring2011();
    let membrane = chemistry.membrane(&Cell::new(ZYGOTE)).unwrap();
    (chemistry, membrane)
}

/// Mean of `of(A, P)` over the surface.
fn surface_mean(membrane: &Membrane, y: &Solution, of: impl Fn(f64, f64) -> f64) -> f64 {
    let gauss = y.gauss();
    let mut sum = 0.0;
    for i in 0..y.intervals() {
        for j in 0..y.m {
            let (h, at) = (y.mesh[i + 1] - y.mesh[i], y.stage(i, j));
            sum += h * gauss.b[j] * membrane.at(y.stage_x(&gauss, i, j))[1] * of(at[A], at[P]);
        }
    }
    sum
}

/// The uniform states [A, P] at surface per volume ψ, ordered by increasing P: P at rest beside the A that is at rest for it.
fn uniform_states(c: &ParConstants, psi: f64) -> Vec<[f64; 2]> {
    let a = |p: f64| c.k_on_a * c.rho_a / (c.k_off_a + c.k_on_a * psi + c.k_ap * p);
    let gain = |p: f64| c.k_on_p * (c.rho_p - psi * p) - c.k_off_p * p - c.k_pa * a(p) * a(p) * p;
    // Evenly spaced in the logarithm: there is little P where A dominates.
    let places: Vec<f64> = (0..=4000).map(|k| 1e-8 * 1e9f64.powf(f64::from(k) / 4000.0)).collect();
    let zero = |[mut low, mut high]: [f64; 2]| {
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if gain(low) * gain(middle) > 0.0 { low = middle } else { high = middle }
        }
        [a(low), low]
    };
    places.windows(2).filter(|pair| gain(pair[0]) * gain(pair[1]) <= 0.0).map(|pair| zero([pair[0], pair[1]])).collect()
}

#[test]
fn uniform_states_solve_the_algebra_and_are_stationary() {
    let (chemistry, membrane) = zygote();
    let (c, psi) = (chemistry.constants, membrane.surface_to_volume);
    let found = uniform_states(&c, psi);
    assert_eq!(found.len(), 3, "A rules, P rules, and one between: {found:?}");
    for [a, p] in found {
        let gain_a = c.k_on_a * (c.rho_a - psi * a) - c.k_off_a * a - c.k_ap * p * a;
        let gain_p = c.k_on_p * (c.rho_p - psi * p) - c.k_off_p * p - c.k_pa * a * a * p;
        assert!(gain_a.abs() < 1e-14 && gain_p.abs() < 1e-14, "{gain_a} {gain_p}");
        let problem = Polarity::new(c, membrane.clone(), Some(1.0));
        let grid = mesh::uniform(0.0, 1.0, 20);
        let y = Solution::from_fn(&Gauss::new(4).unwrap(), &grid, COMPONENTS, &[a, p], |_, y| {
            y.copy_from_slice(&[a, p, 0.0, 0.0]);
        })
        .unwrap();
        let mut evolution = Evolution::new(problem, y.clone());
        evolution.advance(f64::INFINITY).unwrap();
        let moved = evolution.state.nodes.iter().zip(&y.nodes).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(moved < 1e-10, "{moved}");
    }
}

/// Without antagonism A comes to rest at k_on ρ/(k_off + k_on ψ), for any initial state.
#[test]
fn without_antagonism_both_are_uniform() {
    let (mut chemistry, membrane) = zygote();
    (chemistry.constants.k_ap, chemistry.constants.k_pa) = (0.0, 0.0);
    let (c, psi) = (chemistry.constants, membrane.surface_to_volume);
    let y = chemistry.evolved(&membrane, 1.0, 0.4).unwrap();
    let expected =
        [c.k_on_a * c.rho_a / (c.k_off_a + c.k_on_a * psi), c.k_on_p * c.rho_p / (c.k_off_p + c.k_on_p * psi)];
    for node in y.nodes.chunks_exact(COMPONENTS) {
        assert!((node[A] - expected[0]).abs() < 1e-9 && (node[P] - expected[1]).abs() < 1e-9, "{node:?} {expected:?}");
    }
    assert_eq!(uniform_states(&c, psi).len(), 1);
}

/// On a sphere a Legendre mode without a mean decays by detachment plus D l(l + 1)/R²: an implicit step divides it by 1
/// + Δt times the rate.
#[test]
fn legendre_modes_decay_on_a_sphere_at_their_exact_rate() {
    let mut chemistry = Chemistry::goehring2011();
    (chemistry.constants.k_ap, chemistry.constants.k_pa) = (0.0, 0.0);
    let c = chemistry.constants;
    // A cell in a loose shell is a sphere.
    let cell = Cell { epsilon: 0.3, ..Cell::new(2.0) };
    let membrane = chemistry.membrane(&cell).unwrap();
    let radius = 2.0 * chemistry.length_um;
    assert!((membrane.surface_to_volume - 3.0 / radius).abs() < 1e-6, "{}", membrane.surface_to_volume);
    let [[a, p]] = uniform_states(&c, membrane.surface_to_volume)[..] else { panic!("one uniform state") };
    for l in [1, 2] {
        let mode = |u: f64| {
            let (x, slope) = ((PI * u).cos(), -PI * (PI * u).sin());
            if l == 1 { [x, slope] } else { [1.5 * x * x - 0.5, 3.0 * x * slope] }
        };
        let start =
            Solution::from_fn(&Gauss::new(4).unwrap(), &mesh::uniform(0.0, 1.0, 40), COMPONENTS, &[a, p], |u, y| {
                let [f, slope] = mode(u);
                y.copy_from_slice(&[a + 0.1 * f, p + 0.1 * f, 0.1 * slope, 0.1 * slope]);
            })
            .unwrap();
        let mut evolution = Evolution::new(Polarity::new(c, membrane.clone(), Some(1.0)), start);
        let dt = 20.0;
        evolution.advance(dt).unwrap();
        let [first, _] = [evolution.state.node(0), evolution.state.node(1)];
        let of_mode = (l * (l + 1)) as f64 / (radius * radius);
        for (k, rest, k_off, d) in [(A, a, c.k_off_a, c.d_a), (P, p, c.k_off_p, c.d_p)] {
            let expected = 0.1 / (1.0 + dt * (k_off + d * of_mode));
            let found = first[k] - rest;
            assert!((found - expected).abs() < 1e-7, "l = {l}, component {k}: {found} {expected}");
        }
    }
}

/// Derivatives by y, by the scalars and along pairs of directions, compared with differences.
#[test]
fn derivatives_agree_with_differences() {
    let (mut chemistry, membrane) = zygote();
    for (psi, n_p) in [(SurfaceToVolume::Shape, 1), (SurfaceToVolume::Fixed(0.174), 2)] {
        (chemistry.constants.surface_to_volume, chemistry.constants.n_p) = (psi, n_p);
        let mut problem = Polarity::new(chemistry.constants, membrane.clone(), None);
        (problem.past.rate, problem.past.values) = (0.3, vec![[0.4, 1.1]]);
        let at = CollocationPoint { x: 0.3, index: 0 };
        let (y, p) = ([0.7, 1.3, 2.0, -3.0], [0.6, 1.7, 0.9]);
        let values = |problem: &Polarity, x: &[f64; 7]| {
            let (mut f, mut g) = ([0.0; 4], [0.0; 2]);
            problem.rhs(at, &x[..4], &x[4..], &mut f, &mut g);
            [f[0], f[1], f[2], f[3], g[0], g[1]]
        };
        let jacobian = |problem: &Polarity, x: &[f64; 7]| {
            let ([mut f, mut fy, mut fp], [mut g, mut gy, mut gp]) =
                ([vec![0.0; 4], vec![0.0; 16], vec![0.0; 12]], [vec![0.0; 2], vec![0.0; 8], vec![0.0; 6]]);
            let mut out = PointJacobian { f: &mut f, fy: &mut fy, fp: &mut fp, g: &mut g, gy: &mut gy, gp: &mut gp };
            problem.rhs_jacobian(at, &x[..4], &x[4..], &mut out);
            let row = |r: usize| -> Vec<f64> {
                match r {
                    0..4 => [&fy[4 * r..4 * r + 4], &fp[3 * r..3 * r + 3]].concat(),
                    _ => [&gy[4 * (r - 4)..4 * (r - 3)], &gp[3 * (r - 4)..3 * (r - 3)]].concat(),
                }
            };
            (0..6).map(row).collect::<Vec<_>>()
        };
        let x = [y[0], y[1], y[2], y[3], p[0], p[1], p[2]];
        let exact = jacobian(&problem, &x);
        for k in 0..7 {
            let (mut above, mut below) = (x, x);
            let step = 1e-5;
            (above[k], below[k]) = (x[k] + step, x[k] - step);
            let (above, below) = (values(&problem, &above), values(&problem, &below));
            for r in 0..6 {
                let expected = (above[r] - below[r]) / (2.0 * step);
                assert!(
                    (exact[r][k] - expected).abs() < 1e-6 * (1.0 + expected.abs()),
                    "{r} {k}: {} {expected}",
                    exact[r][k]
                );
            }
        }
        // Second derivatives are implemented for stationary states.
        problem.past.rate = 0.0;
        let (a, b) = ([0.3, -0.5, 0.2, 0.9, 0.4, -0.3, 0.8], [-0.6, 0.2, 0.7, 0.1, -0.2, 0.5, 0.6]);
        let along = |d: &[f64; 7], step: f64| std::array::from_fn(|k| x[k] + step * d[k]);
        let (above, below) = (jacobian(&problem, &along(&b, 1e-5)), jacobian(&problem, &along(&b, -1e-5)));
        let (mut f, mut g) = ([0.0; 4], [0.0; 2]);
        let [along_a, along_b] = [&a, &b].map(|d| PointDirection { y: &d[..4], p: &d[4..] });
        let point = PointValues { at, y: &y, p: &p };
        problem.second(point, [along_a, along_b], [&mut f, &mut g]);
        for r in 0..4 {
            let expected: f64 = (0..7).map(|k| (above[r][k] - below[r][k]) / 2e-5 * a[k]).sum();
            assert!((f[r] - expected).abs() < 1e-5 * (1.0 + expected.abs()), "{r}: {} {expected}", f[r]);
        }
        // The third derivative along A and P only.
        let flat = [0.3, -0.5, 0.2, 0.9, 0.0, 0.0, 0.0];
        let second = |step: f64| {
            let x: [f64; 7] = along(&flat, step);
            let ([mut f2, mut f3], [mut g2, mut g3]) = ([[0.0; 4]; 2], [[0.0; 2]; 2]);
            let point = PointValues { at, y: &x[..4], p: &p };
            let along = PointDirection { y: &flat[..4], p: &flat[4..] };
            assert!(problem.third(point, along, [[&mut f2, &mut g2], [&mut f3, &mut g3]]));
            (f2, f3)
        };
        let ((above, third), (below, _)) = (second(1e-4), second(-1e-4));
        for r in 0..4 {
            let expected = (above[r] - below[r]) / 2e-4;
            assert!((third[r] - expected).abs() < 1e-5 * (1.0 + expected.abs()), "{r}: {} {expected}", third[r]);
        }
    }
}

/// P is at the posterior pole, and the boundary near the middle, as in the embryo.
#[test]
fn the_zygote_of_goehring_is_polarised_with_its_boundary_near_the_middle() {
    let (chemistry, membrane) = zygote();
    assert!(
        (membrane.surface_to_volume / ZYGOTE_SURFACE_TO_VOLUME - 1.0).abs() < 0.03,
        "{}",
        membrane.surface_to_volume
    );
    let y = chemistry.polarised(&Cell::new(ZYGOTE)).unwrap().unwrap();
    let Readings { u0, omega, a, p, means } = readings(&y).unwrap();
    assert!((u0 - 0.46910).abs() < 1e-4, "{u0}");
    assert!((omega + 0.08407).abs() < 1e-4, "{omega}");
    assert!(p[0] > 100.0 * p[1] && a[1] > 100.0 * a[0], "{p:?} {a:?}");
    // Diffusion is conservative: the means are at rest as well.
    let c = chemistry.constants;
    let removed =
        [c.k_ap * surface_mean(&membrane, &y, |a, p| a * p), c.k_pa * surface_mean(&membrane, &y, |a, p| a * a * p)];
    let attached = [
        c.k_on_a * (c.rho_a - membrane.surface_to_volume * means[0]) - c.k_off_a * means[0],
        c.k_on_p * (c.rho_p - membrane.surface_to_volume * means[1]) - c.k_off_p * means[1],
    ];
    for k in 0..2 {
        assert!((attached[k] / removed[k] - 1.0).abs() < 1e-8, "{attached:?} {removed:?}");
    }
    assert!((surface_mean(&membrane, &y, |a, _| a) - means[0]).abs() < 1e-12);
}

#[test]
fn the_mirror_image_of_a_state_is_a_state() {
    let (chemistry, membrane) = zygote();
    let y = chemistry.polarised(&Cell::new(ZYGOTE)).unwrap().unwrap();
    let gauss = y.gauss();
    let grid: Vec<f64> = y.mesh.iter().rev().map(|u| 1.0 - u).collect();
    let mut value = [0.0; COMPONENTS];
    let mirrored = Solution::from_fn(&gauss, &grid, COMPONENTS, &y.scalars, |u, out| {
        y.eval(&gauss, 1.0 - u, &mut value);
        out.copy_from_slice(&[value[A], value[P], -value[A_U], -value[P_U]]);
    })
    .unwrap();
    let mut evolution = Evolution::new(Polarity::new(chemistry.constants, membrane, Some(1.0)), mirrored);
    evolution.advance(f64::INFINITY).unwrap();
    assert!((polarity(&evolution.state) + polarity(&y)).abs() < 1e-8, "{}", polarity(&evolution.state));
    for k in 0..2 {
        assert!((evolution.state.scalars[MEAN_A + k] - y.scalars[MEAN_A + k]).abs() < 1e-8);
    }
    assert_eq!(readings(&evolution.state), None, "P at the anterior pole is not the embryo's polarity");
}

#[test]
fn two_resolutions_agree() {
    let chemistry = Chemistry::goehring2011();
    let mut fine = chemistry;
    (fine.resolution.intervals, fine.numerics.intervals) = (200, 96);
    let of = |chemistry: &Chemistry, r0: f64| readings(&chemistry.polarised(&Cell::new(r0)).unwrap().unwrap()).unwrap();
    for r0 in [5.4, 3.0] {
        let (coarse, fine) = (of(&chemistry, r0), of(&fine, r0));
        assert!((coarse.u0 - fine.u0).abs() < 1e-6, "{coarse:?} {fine:?}");
        assert!((coarse.omega - fine.omega).abs() < 1e-6, "{coarse:?} {fine:?}");
        assert!(
            (coarse.p[0] - fine.p[0]).abs() < 1e-6 && (coarse.a[1] - fine.a[1]).abs() < 1e-6,
            "{coarse:?} {fine:?}"
        );
    }
    let limits = [&chemistry, &fine].map(|c| c.limit(&Cell::new(1.0), Towards::Smaller).unwrap().r0);
    assert!((limits[0] - limits[1]).abs() < 1e-6, "{limits:?}");
}

/// At the fold found by continuation the evolution in time loses polarity: the last state persists in a cell that is 1
/// % larger, and vanishes in one that is 1 % smaller.
#[test]
fn polarity_ends_at_the_fold() {
    let chemistry = Chemistry::goehring2011();
    let limit = chemistry.limit(&Cell::new(1.0), Towards::Smaller).unwrap();
    assert!((limit.r0 - 2.709_592).abs() < 1e-5, "{limit:?}");
    let persists = |r0: f64| {
        let membrane = chemistry.membrane(&Cell::new(r0)).unwrap();
        let state = chemistry.evolved(&membrane, 1.0, limit.state.u0).unwrap();
        is_polarised(&state)
    };
    assert!(persists(1.01 * limit.r0));
    assert!(!persists(0.99 * limit.r0));
    let state = |r0: f64| chemistry.polarised(&Cell::new(r0)).unwrap();
    assert!(state(1.0001 * limit.r0).is_some());
    assert!(state(0.9999 * limit.r0).is_none());
    let u0 = readings(&state(1.000_001 * limit.r0).unwrap()).unwrap().u0;
    assert!((u0 - limit.state.u0).abs() < 2e-3, "{u0} {limit:?}");
}

/// Polarised states over size form a closed curve: in cells that are too large the pools no longer hold the boundary.
#[test]
fn polarised_states_form_a_closed_curve_over_size() {
    let chemistry = Chemistry::goehring2011();
    let largest = chemistry.limit(&Cell::new(1.0), Towards::Larger).unwrap();
    assert!((largest.r0 - 10.637_716).abs() < 1e-4, "{largest:?}");
    let (_, membrane) = zygote();
    let state = chemistry.evolved(&membrane, 1.0, 0.5).unwrap();
    let mut branch = chemistry.branch(membrane, 1.0, &state, Towards::Smaller).unwrap();
    assert_eq!(follow(&mut branch, 0.1).unwrap(), super::branch::BranchEnd::Fold);
    let (mut folds, mut back) = (1, false);
    branch
        .follow([0.1, 10.0], 1000, |branch, advance| {
            folds += usize::from(advance.passed_fold);
            let u0 = readings(&branch.state.solution).unwrap().u0;
            back = folds == 2 && branch.state.solution.scalars[SCALE] < 1.0 && u0 < 0.5;
            !back
        })
        .unwrap();
    assert!(back && folds == 2, "{folds}");
    assert!(chemistry.polarised(&Cell::new(0.999 * largest.r0)).unwrap().is_some());
    assert!(chemistry.polarised(&Cell::new(1.001 * largest.r0)).unwrap().is_none());
}

/// Sharp-interface limit at fixed ψ: the curvature of a narrow boundary no longer moves it, only the pools hold it, and
/// P takes the same fraction of the surface of every shape. The deviation is inversely proportional to the size.
#[test]
fn a_narrow_boundary_takes_the_same_part_of_any_surface() {
    let mut chemistry = Chemistry::goehring2011();
    chemistry.constants.surface_to_volume = SurfaceToVolume::Fixed(ZYGOTE_SURFACE_TO_VOLUME);
    // A sphere, and a cell confined by its shell.
    let membranes = [0.3, 0.87].map(|epsilon| chemistry.membrane(&Cell { epsilon, ..Cell::new(ZYGOTE) }).unwrap());
    let part = |membrane: &Membrane, scale: f64| {
        let y = chemistry.evolved(membrane, scale, 0.5).unwrap();
        let u0 = readings(&y).unwrap().u0;
        let steps = 20_000;
        (0..steps).map(|k| membrane.at(u0 * (k as f64 + 0.5) / steps as f64)[1] * u0 / steps as f64).sum::<f64>()
    };
    let off = [4.0, 8.0, 16.0].map(|scale| (part(&membranes[0], scale) - part(&membranes[1], scale)).abs());
    assert!(off[2] < 1e-3 && (1.6..2.2).contains(&(off[1] / off[2])), "{off:?}");
}

/// Before the fold a perturbed state returns; beyond it, where the branch leads back to larger cells, it leaves.
#[test]
fn states_are_stable_before_the_fold_and_unstable_beyond_it() {
    let (chemistry, membrane) = zygote();
    let scale = 0.6;
    let stable = chemistry.evolved(&membrane, scale, 0.5).unwrap();
    let mut branch = chemistry.branch(membrane.clone(), scale, &stable, Towards::Smaller).unwrap();
    assert_eq!(follow(&mut branch, 0.1).unwrap(), super::branch::BranchEnd::Fold);
    branch.follow([0.1, scale], 1000, |_, _| true).unwrap();
    let mut unstable = branch.state.solution.clone();
    assert_eq!(unstable.scalars[SCALE], scale);
    unstable.scalars.truncate(SCALE);
    // The boundary moves by about 0.004 of the contour; steps of 20 s resolve its further motion.
    let moved = |state: &Solution| {
        let mut disturbed = state.clone();
        let shift = |values: &mut Vec<f64>| {
            for y in values.chunks_exact_mut(COMPONENTS) {
                y[A] -= 0.004 * y[A_U];
                y[P] -= 0.004 * y[P_U];
            }
        };
        shift(&mut disturbed.nodes);
        shift(&mut disturbed.stages);
        let place = |y: &Solution| readings(y).map_or(f64::INFINITY, |found| found.u0);
        let mut evolution =
            Evolution::new(Polarity::new(chemistry.constants, membrane.clone(), Some(scale)), disturbed);
        let start = place(&evolution.state) - place(state);
        for _ in 0..100 {
            evolution.advance(20.0).unwrap();
        }
        (place(&evolution.state) - place(state)).abs() / start.abs()
    };
    let (returned, left) = (moved(&stable), moved(&unstable));
    assert!(returned < 0.5 && left > 2.0, "{returned} {left}");
}

#[test]
fn a_boundary_that_the_mesh_does_not_resolve_is_refused() {
    let mut chemistry = Chemistry::goehring2011();
    chemistry.constants.surface_to_volume = SurfaceToVolume::Fixed(ZYGOTE_SURFACE_TO_VOLUME);
    let membrane = chemistry.membrane(&Cell::new(ZYGOTE)).unwrap();
    assert!(chemistry.evolved(&membrane, 1.0, 0.5).is_ok());
    chemistry.resolution.intervals = 6;
    let error = chemistry.evolved(&membrane, 1.0, 0.5).unwrap_err();
    assert!(matches!(error, PolarityError::Unresolved { .. }), "{error}");
}

#[test]
fn constants_are_set_by_name_and_errors_name_the_allowed_values() {
    let mut constants = ParConstants::GOEHRING2011;
    for text in ["d_a=0.3", "psi=0.174", "k_ap=0"] {
        constants.set("--par", text).unwrap();
    }
    assert_eq!((constants.d_a, constants.k_ap), (0.3, 0.0));
    assert_eq!(constants.surface_to_volume, SurfaceToVolume::Fixed(0.174));
    constants.set("--par", "psi=shape").unwrap();
    assert_eq!(constants.surface_to_volume, SurfaceToVolume::Shape);
    constants.set("--par", "n_p=2").unwrap();
    assert_eq!(constants.n_p, 2);
    for (text, part) in [
        ("d_a=0", "d_a"),
        ("d_a=x", "d_a"),
        ("kap=1", "k_ap"),
        ("psi=-1", "psi"),
        ("n_p=3", "1 or 2"),
        ("d_a", "KEY=VALUE"),
    ] {
        let message = constants.set("--par", text).unwrap_err().to_string();
        assert!(message.contains("--par") && message.contains(part), "{text}: {message}");
    }
}
