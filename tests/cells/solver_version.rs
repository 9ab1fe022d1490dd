//! Every change to a bit of a division needs a new solver version.

use furrow_cell::{Cell, Numerics, Scheme};
use furrow_lineage::batch::SOLVER_VERSION;
use furrow_mechanics::division::{Division, DivisionInput, divide};

/// Radius, ε, cue, seed, the published scheme, and the hash of the division's numbers in this version of the solver.
const DIVISIONS: [(f64, f64, &str, u64, bool, &str); 13] = [
    (1.5, 0.87, "none", 0, false, "3960552eba3f14ed"),
    (1.6, 0.7, "none", 3, false, "542106717e6e5ff9"),
    (2.0, 0.87, "none", 1, false, "08794be031fb9767"),
    (2.5, 0.87, "none", 0, false, "b7649c75831541be"),
    (2.5, 0.87, "none", 7, false, "d8b99c6f951b87e1"),
    (2.5, 0.87, "none", 1 << 32, false, "903b4e054b2beb1f"),
    (3.0, 0.8, "none", 0, false, "42310af96cef7ba7"),
    (5.4, 0.87, "none", 0, false, "c2bfd60cba67360b"),
    (2.0, 0.87, "none", 1, true, "fd82b48f14b831e8"),
    (5.4, 0.87, "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1", 0, false, "b70830a1aa82ea62"),
    (2.2, 0.87, "activity:step,u0=0.5,omega=0.1,amplitude=0.1", 0, false, "df8b128644a811f3"),
    (2.8, 0.87, "tension:gradient,amplitude=0.1", 0, false, "029deb4734c74be7"),
    (
        3.4,
        0.87,
        "kappa:u0=0.4,omega=0.3Lh,amplitude=0.1+activity:u0=0.5,omega=0.1,amplitude=-0.05",
        0,
        false,
        "505ebcec845708ef",
    ),
];

fn hash(division: &Division) -> String {
    let d = division;
    let [first, second] = d.daughters().map_or([None; 2], |radii| radii.map(Some));
    let maybe = [d.chi(), d.chi_signed(), d.u_furrow(), first, second, d.growth_rate(), d.slow_growth_rate];
    let reals = maybe.map(|real| real.map(f64::to_bits));
    let numbers = (reals, d.t_end.to_bits(), d.volume_drift.to_bits(), d.work.steps, d.work.iterations);
    let text = format!("{} {numbers:?}", d.outcome());
    blake3::hash(text.as_bytes()).to_hex()[..16].to_owned()
}

#[test]
fn divisions_have_the_bits_of_this_version() {
    let mut differ = Vec::new();
    for (r0, epsilon, cue, seed, published, kept) in DIVISIONS {
        let cell = Cell { epsilon, ..Cell::gao2026_thresholds(r0) }.with_cue(cue.parse().unwrap());
        let scheme = if published { Scheme::Published } else { Scheme::Converged };
        let numerics = Numerics { scheme, ..Numerics::default() };
        let found = hash(&divide(&DivisionInput { cell, numerics, seed }).unwrap());
        if found != kept {
            differ.push(format!("({r0:?}, {epsilon}, \"{cue}\", {seed}, {published}, \"{found}\"),"));
        }
    }
    assert!(
        differ.is_empty(),
        "these divisions have other bits than in version {SOLVER_VERSION} of the solver, and stored divisions would be mixed \
         with others: raise SOLVER_VERSION in crates/furrow-lineage/src/batch/key.rs, store the new bits here, and run \
         crates/furrow-page/build.sh\n{}",
        differ.join("\n")
    );
}
