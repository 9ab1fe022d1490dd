//! Every change to a bit of a division needs a new solver version.

use furrow_cell::{Cell, Numerics, Scheme};
use furrow_lineage::batch::SOLVER_VERSION;
use furrow_mechanics::division::{Division, DivisionInput, divide};

/// Radius, ε, cue, seed, the published scheme, and the hash of the division's numbers in this version of the solver.
const DIVISIONS: [(f64, f64, &str, u64, bool, &str); 13] = [
    (1.5, 0.87, "none", 0, false, "e777d9ca53cf05fa"),
    (1.6, 0.7, "none", 3, false, "049c6740c12ec35c"),
    (2.0, 0.87, "none", 1, false, "597f1e9652472ee2"),
    (2.5, 0.87, "none", 0, false, "f2cbcfbcf150acbd"),
    (2.5, 0.87, "none", 7, false, "25dad2df7d36c711"),
    (2.5, 0.87, "none", 1 << 32, false, "91ad726b3c7478e0"),
    (3.0, 0.8, "none", 0, false, "744d857c1d3a6b13"),
    (5.4, 0.87, "none", 0, false, "d549c4e7c4d1757a"),
    (2.0, 0.87, "none", 1, true, "63ed32a3a365d338"),
    (5.4, 0.87, "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1", 0, false, "909c163eadb36c4a"),
    (2.2, 0.87, "activity:step,u0=0.5,omega=0.1,amplitude=0.1", 0, false, "80a6839c18e83887"),
    (2.8, 0.87, "tension:gradient,amplitude=0.1", 0, false, "e8a1ec435bfa9ef4"),
    (
        3.4,
        0.87,
        "kappa:u0=0.4,omega=0.3Lh,amplitude=0.1+activity:u0=0.5,omega=0.1,amplitude=-0.05",
        0,
        false,
        "78385c4276706f92",
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
