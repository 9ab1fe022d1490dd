//! Divisions from a stationary shape (figure S5): disturbances of stable shapes decay, of unstable ones grow, at the rate of the
//! spectrum.

use furrow_cell::{Cell, Numerics};
use furrow_mechanics::division::{DivisionInput, Outcome};
use furrow_mechanics::perturbation::{Perturbation, perturbed};

const GERMLINE: &str = "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1";

fn at(r0: f64, xi_s: f64) -> DivisionInput {
    DivisionInput::new(Cell { xi_s, ..Cell::gao2026_thresholds(r0) })
}

fn watched(input: &DivisionInput) -> Perturbation {
    perturbed(input, 40.0).unwrap()
}

/// The pitchfork of R0 = 2 is at ξ_s = 22.057.
#[test]
fn distances_grow_and_decay_at_the_leading_rate() {
    for (xi_s, from, to, returns) in [
        (23.0, 1e-4, 3e-2, false),
        (22.6, 3e-6, 1e-2, false),
        (24.5, 1e-4, 3e-2, false),
        (26.9, 1e-3, 1e-1, false),
        (20.0, 1e-12, 1e-7, true),
        (21.0, 1e-12, 1e-7, true),
        (21.9, 1e-7, 5e-6, true),
    ] {
        let found = watched(&at(2.0, xi_s));
        let rate = found.rate_between(from, to).unwrap();
        println!("{xi_s}: {rate} beside {}", found.start_growth_rate);
        assert!((rate / found.start_growth_rate - 1.0).abs() < 0.01);
        assert_eq!(found.returned(), returns, "{xi_s}");
    }
}

/// On the usual mesh a division shifts growth rates by −5e-4/τ, so that a shape that is left slowly seems to return.
#[test]
fn a_growth_rate_below_the_accuracy_of_the_mesh_is_not_resolved() {
    let input = DivisionInput::new(Cell { xi_s: 22.066, ..Cell::new(2.0) });
    let finer = DivisionInput { numerics: Numerics { intervals: 96, ..input.numerics }, ..input.clone() };
    let [coarse, fine] = [input, finer].map(|input| watched(&input));
    assert!(coarse.start_growth_rate > 0.0 && coarse.returned() && !coarse.is_resolved());
    assert!(!fine.returned() && fine.is_resolved());
}

/// On both sides of the threshold, with and without a cue, below the critical radius and above; with noise of any seed.
#[test]
fn what_returns_is_what_is_stable() {
    let cued = |r0: f64, xi_s: f64| {
        let input = at(r0, xi_s);
        DivisionInput { cell: input.cell.clone().with_cue(GERMLINE.parse().unwrap()), ..input }
    };
    let mut both = [0, 0];
    for input in [at(2.0, 22.0), at(2.0, 22.12), at(1.64, 25.0), at(1.64, 25.9), at(2.5, 14.0), cued(2.2, 20.0)] {
        for seed in 0..3 {
            let found = watched(&DivisionInput { seed, ..input.clone() });
            let rate = found.start_growth_rate;
            assert_eq!(found.returned(), rate < 0.0, "R0 = {}, seed {seed}: {rate}", input.cell.r0);
            both[usize::from(found.returned())] += 1;
        }
    }
    assert!(both[0] >= 6 && both[1] >= 6, "{both:?}");
}

/// What leaves divides like a cell that has come up to the saddle from the passive shape.
#[test]
fn what_leaves_divides_as_from_the_passive_shape() {
    let input = at(2.0, 25.0);
    let from_steady = watched(&input).division;
    let from_passive = furrow_mechanics::division::divide(&input).unwrap();
    println!("{:?} beside {:?}", from_steady.chi(), from_passive.chi());
    assert_eq!(from_steady.outcome(), Outcome::Asymmetric);
    assert!((from_steady.chi().unwrap() - from_passive.chi().unwrap()).abs() < 2e-3);
    // Halved steps change nothing.
    let numerics = Numerics { step_factor: 0.5, ..Numerics::default() };
    let halved = watched(&DivisionInput { numerics, ..input }).division;
    println!("{:?} with halved steps", halved.chi());
    assert!((from_steady.chi().unwrap() - halved.chi().unwrap()).abs() < 2e-3);
    assert!((from_steady.t_end / halved.t_end - 1.0).abs() < 0.01);
}

#[test]
fn it_is_watched_to_the_end() {
    let found = perturbed(&at(2.0, 20.0), 7.5).unwrap();
    assert!((found.distances.last().unwrap()[0] - 7.5).abs() < 1e-8);
    assert_eq!(found.distances[0], [0.0, 0.0]);
    assert!(found.distances.windows(2).all(|pair| pair[1][0] > pair[0][0]));
    assert!((found.division.growth_rate().unwrap() - found.start_growth_rate).abs() < 1e-3);
    // Off the centre by now, and still on its way.
    assert!(perturbed(&at(2.0, 23.0), 45.0).unwrap().division.growth_rate().is_none());
}
