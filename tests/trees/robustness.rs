//! Far outside the paper's range, cells divide, come to rest, or fail with a reason and advice that helps.

use std::path::Path;

use furrow_analysis::Sweep;
use furrow_cell::Cell;
use furrow_cell::settings::{Overrides, Settings};
use furrow_lineage::Lineage;
use furrow_lineage::parse_cue;
use furrow_mechanics::division::{Division, DivisionError, DivisionInput, Outcome, divide};
use furrow_mechanics::equilibria::{BranchOptions, pitchfork};

fn cell(r0: f64, epsilon: f64, xi_s: f64, aspect: f64, cue: &str) -> Cell {
    let lineage = Lineage::c_elegans().unwrap();
    let mut cell = Cell { epsilon, xi_s, ..Cell::gao2026_thresholds(r0) }.with_cue(parse_cue(cue, &lineage).unwrap());
    cell.shell.aspect = aspect;
    cell
}

fn solve(cell: Cell) -> Result<Division, DivisionError> {
    divide(&DivisionInput::new(cell))
}

/// Inside the range of the paper every cell has an outcome: every fifteenth cell of the sweeps whose table is in
/// docs/robustness.md.
#[test]
fn cells_inside_the_range_of_the_paper_divide_or_rest() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/robustness");
    let mut solved = 0;
    for name in ["inside-none.ron", "inside-gradient.ron", "inside-local.ron"] {
        let sweep = Sweep::read(&folder.join(name), &Settings::default(), &Overrides::default()).unwrap();
        for index in (0..sweep.points()).step_by(15) {
            let point = sweep.point(index);
            assert_eq!(point.invalid, None);
            if let Err(error) = divide(&point.input) {
                panic!("{name}, point {index}: {error}");
            }
            solved += 1;
        }
    }
    assert!(solved >= 100, "{solved}");
}

/// The cortex is thirty times softer at one pole, and what happens there a hundred times quicker than a first step of the
/// usual length can follow.
#[test]
fn a_first_step_that_is_too_long_is_shortened() {
    let soft = cell(1.7735163328511918, 0.6140116058841385, 16.00555643173181, 1.5, "kappa:gradient,amplitude=0.964");
    let division = solve(soft).unwrap();
    assert_eq!(division.outcome(), Outcome::Asymmetric);
    assert!(division.chi().unwrap() > 0.99);
    assert!(division.work.rejected > 0);
}

/// Where the shell is so wide that its force at the cell is less than rounding, a cell is at rest wherever it is.
#[test]
fn a_cell_afloat_in_a_wide_shell_is_at_rest() {
    for floating in [cell(3.62, 0.162, 4.16, 1.45, "none"), cell(3.62, 0.2, 4.16, 1.45, "none")] {
        let division = solve(floating).unwrap();
        assert_eq!(division.outcome(), Outcome::Arrested);
        assert!(division.growth_rate().unwrap().abs() < 1e-6, "{:?}", division.growth_rate());
    }
    // The same cell where the shell holds it.
    assert_eq!(solve(cell(3.62, 0.3, 4.16, 1.45, "none")).unwrap().outcome(), Outcome::Arrested);
}

/// A cell whose contour wanders without ever repeating itself is given up after a fixed number of steps, not after hours; with a weaker
/// cue, as the reason says, it has an outcome.
#[test]
fn a_cell_that_wanders_for_ever_is_given_up() {
    let wanderer = |amplitude: f64| {
        let cue = format!("xi_b:band,u0=0.51160016,omega=0.43904883,amplitude={amplitude}");
        solve(cell(3.3322480222790363, 0.48457205238274037, 122.24158052753391, 3.8890853184737084, &cue))
    };
    match wanderer(-9.448993361942284) {
        Err(error @ DivisionError::Restless { .. }) => {
            assert!(error.to_string().ends_with("lower xi_s or the cue's amplitude"), "{error}");
        }
        other => panic!("{other:?}"),
    }
    assert!(wanderer(-4.0).is_ok());
}

/// A wall that is thinner than the mesh can tell gave pitchforks on the wrong side: it is refused, and with as many intervals
/// as the refusal says the pitchfork is right.
#[test]
fn a_wall_too_thin_for_the_mesh_is_refused() {
    let set = |pairs: &[&str]| {
        let mut settings = Settings::default();
        let pairs: Vec<String> = pairs.iter().map(|pair| (*pair).to_owned()).collect();
        settings.apply_overrides(&pairs).map(|()| settings)
    };
    assert_eq!(
        set(&["w=0.01"]).unwrap_err().to_string(),
        "--set: physics.w = 0.01: must be at least 2.000e-2 where numerics.intervals = 48; or set intervals to 96"
    );
    assert!(
        set(&["w=1e-9"])
            .unwrap_err()
            .to_string()
            .ends_with("must be at least 2.344e-4, with numerics.intervals = 4096")
    );
    let threshold = |intervals: usize| {
        let settings = set(&["w=0.01", &format!("intervals={intervals}")]).unwrap();
        let cell = Cell { r0: 2.0, ..settings.cell };
        pitchfork::first(&cell, &settings.numerics, &BranchOptions::default()).unwrap().point.xi_s
    };
    let [coarse, fine] = [96, 384].map(threshold);
    assert!((coarse / fine - 1.0).abs() < 2e-4, "{coarse}, {fine}");
}

/// The mirror image of a cue has the mirror image of the outcome also where the cue is far stronger than any of the paper's.
#[test]
fn strong_cues_have_mirror_images() {
    let cue = "activity:step,u0=0.3,omega=0.2,amplitude=6";
    let given = cell(2.4, 0.6, 30.0, 3.0, cue);
    let mirrored = Cell { cue: given.cue.mirrored(), ..given.clone() };
    let without_noise = |cell: Cell| {
        let mut input = DivisionInput::new(cell);
        input.numerics.noise = 0.0;
        divide(&input).unwrap()
    };
    let (one, other) = (without_noise(given), without_noise(mirrored));
    assert_ne!(one.outcome(), Outcome::Arrested);
    assert!((one.chi_signed().unwrap() + other.chi_signed().unwrap()).abs() < 1e-4, "{one:?}, {other:?}");
}
