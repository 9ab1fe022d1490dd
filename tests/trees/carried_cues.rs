//! Trees with regulators that the flow carries: critical radii end the branches that divisions would end.

use furrow_cell::Cell;
use furrow_lineage::TreeSettings;

use super::strong_cues::dividing;

/// Of all kinds: with and without a source, made on either side and evenly, diluted and not, slow and fast, on one field and several,
/// joined to a painted term.
const REGULATORS: [&str; 10] = [
    "regulator:none,turnover=10,diffusion=1,activity=0.3",
    "regulator:none,turnover=3,diffusion=4,activity=-0.4",
    "regulator:none,turnover=0,diffusion=2,kappa=0.3",
    "regulator:band,u0=0.465,omega=0.0577,amplitude=0.1,turnover=25,diffusion=1,diluted=false,kappa=1",
    "regulator:band,u0=0.5,omega=0.1,amplitude=0.3,turnover=10,diffusion=1,activity=0.4",
    "regulator:step,u0=0.45,omega=0.1,amplitude=1,turnover=5,diffusion=1,friction=1",
    "regulator:gradient,amplitude=0.4,turnover=8,diffusion=0.5,tension=0.8,kappa=-0.2",
    "regulator:band,u0=0.6,omega=0.2,amplitude=-0.5,turnover=60,diffusion=3,xi_s=0.5,viscosity=0.3",
    "regulator:step,u0=0.6,omega=0.1,amplitude=0.5,turnover=20,diffusion=2,tension=3,tension.half=1.5",
    "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1+regulator:none,turnover=12,diffusion=1.5,diluted=false,xi_b=0.5",
];

#[test]
fn critical_radii_end_no_branch_that_divides_with_a_regulator() {
    for (number, text) in REGULATORS.into_iter().enumerate() {
        let cell = if number % 2 == 0 { Cell::gao2026_thresholds(2.4) } else { Cell::new(2.4) };
        let [ahead, all] = dividing(&text.parse().unwrap(), &TreeSettings { cell, ..TreeSettings::default() }, 24);
        println!("{text}: {} cells", all.len());
        assert!(all.len() > 1 && all.iter().any(|(_, divides)| !divides), "{text}: {all:?}");
        assert_eq!(ahead, all, "{text}");
    }
}
