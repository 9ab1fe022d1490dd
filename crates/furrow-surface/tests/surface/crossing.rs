//! A surface that crosses itself is seen to.

use std::f64::consts::{PI, TAU};

use furrow_cell::{Cell, ThreeDimensional};
use furrow_surface::crossing::crossing;
use furrow_surface::embed::project;
use furrow_surface::problem::Problem;
use furrow_surface::space::{Harmonic, Space};

use crate::states::{during, within};

/// A tube around a curve that bends back towards itself in the plane y = 0 until its ends are `apart`.
fn bent_tube(space: &Space, apart: f64) -> Vec<f64> {
    let count = space.harmonics.len();
    let mut surface = vec![0.0; space.coefficients()];
    let around = 24;
    for (place, harmonic) in space.harmonics.iter().enumerate() {
        let values: Vec<[f64; 2]> = space.stations.iter().map(|station| {
            let mean = (0..around).map(|j| {
                let phi = TAU * (j as f64 + 0.5) / f64::from(around);
                let x = tube(station.u, phi, apart);
                let factor = if let Harmonic::Along(m) = harmonic { if *m == 0 { 1.0 } else { 2.0 } } else { 1.0 };
                factor * match harmonic {
                    Harmonic::Across(k) => x[0] * (f64::from(*k) * phi).cos() + x[1] * (f64::from(*k) * phi).sin(),
                    Harmonic::Along(m) => x[2] * (f64::from(*m) * phi).cos(),
                }
            });
            [mean.sum::<f64>() / f64::from(around), 0.0]
        }).collect();
        for (spline, [value, _]) in project(space, place, &values).into_iter().enumerate() {
            surface[spline * count + place] = value;
        }
    }
    surface
}

/// Its radius is 0.3, its middle line an arc of radius 1 from one end to the other.
fn tube(u: f64, phi: f64, apart: f64) -> [f64; 3] {
    // The angle between the ends, so that they are `apart` at the nearest.
    let open = 2.0 * ((0.5 * apart) / 1.0).asin();
    let along = (TAU - open) * 0.5 * (PI * u).cos();
    let radius = 0.3 * (PI * u).sin();
    let out = radius * phi.cos();
    [(1.0 + out) * along.cos() - 1.0, radius * phi.sin(), (1.0 + out) * along.sin()]
}

#[test]
fn a_tube_bent_into_itself_crosses_itself() {
    let space = Space::new(40, 4);
    assert_eq!(crossing(&space, &bent_tube(&space, 0.2)), 0.0);
    let found = crossing(&space, &bent_tube(&space, -0.2));
    println!("deep by {found}");
    assert!(found > 0.05, "{found}");
}

/// Walls of a cell that divides from one side pass through each other without contact.
#[test]
fn walls_cross_without_contact_alone() {
    let cell = || Cell::new(2.0);
    let softness = 3.0 * Problem::new(&cell(), Space::new(8, 0)).contact_law()[0];
    for contact in [true, false] {
        let settings = ThreeDimensional { contact, ..ThreeDimensional::default() };
        let states = during(cell(), &settings, &[0.0, 0.5, 1.0, 1.2, 1.4, 1.5, 1.6]);
        let depths: Vec<f64> = states.iter().map(|(problem, state)| crossing(&problem.space, &state.surface)).collect();
        println!("contact {contact}: {depths:?} of {softness} allowed");
        let deepest = depths.iter().copied().fold(0.0, f64::max);
        assert_eq!(depths[0], 0.0);
        if contact {
            within("walls in contact", deepest, softness);
        } else {
            assert!(deepest > 0.1 * cell().r0, "walls cross: {deepest}");
        }
    }
}
