//! Divisions with regulators of all sorts end with an outcome or with an error that says why.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use furrow_cell::cue::Field;
use furrow_cell::{Cell, Cue};
use furrow_mechanics::division::{DivisionError, DivisionInput, divide};
use furrow_verification::states::Draws;

/// How many are drawn.
const COUNT: usize = 300;
/// A division takes a second or two; a longer one makes no progress.
const LONGEST: f64 = 60.0;

/// One of several.
fn one_of<'a>(draws: &mut Draws, of: &[&'a str]) -> &'a str {
    of[draws.between(0.0, of.len() as f64) as usize]
}

/// A regulator with or without a source that acts on one to three fields.
fn regulator(draws: &mut Draws) -> String {
    let amplitude = draws.between(-1.0, 1.0);
    let (u0, omega) = (draws.between(0.05, 0.95), draws.between(0.03, 0.4));
    let source = match one_of(draws, &["none", "gradient", "band", "step"]) {
        "none" => "none".to_owned(),
        "gradient" => format!("gradient,amplitude={amplitude:.4}"),
        profile => format!("{profile},u0={u0:.4},omega={omega:.4},amplitude={amplitude:.4}"),
    };
    let diffusion = draws.between(0.05f64.ln(), 10f64.ln()).exp();
    let turnover = draws.between(0.0, 100.0);
    let diluted = one_of(draws, &["true", "false"]);
    let mut names = Field::ALL.map(Field::name).to_vec();
    let fields = 1 + draws.between(0.0, 3.0) as usize;
    let couplings: Vec<String> = (0..fields)
        .map(|_| {
            let name = names.remove(draws.between(0.0, names.len() as f64) as usize);
            format!("{name}={:.4}", draws.between(-1.0, 1.0))
        })
        .collect();
    let couplings = couplings.join(",");
    format!("regulator:{source},turnover={turnover:.4},diffusion={diffusion:.4},diluted={diluted},{couplings}")
}

/// Cells with a regulator; regulators that bring a coefficient to zero by their source alone are left out.
fn cells() -> Vec<Cell> {
    let mut draws = Draws(27);
    let mut out = Vec::new();
    while out.len() < COUNT {
        let (text, r0) = (regulator(&mut draws), draws.between(1.2, 5.4));
        if let Ok(cue) = text.parse::<Cue>() {
            out.push(Cell::gao2026_thresholds(r0).with_cue(cue));
        }
    }
    out
}

/// What an error is about, without its numbers.
fn kind(error: &DivisionError) -> String {
    format!("{error:?}").split([' ', '{']).next().unwrap_or_default().to_owned()
}

#[test]
fn a_division_with_any_regulator_ends_with_an_outcome_or_a_reason() {
    let (cells, next) = (cells(), AtomicUsize::new(0));
    let solve = || {
        let mut solved = Vec::new();
        while let Some(cell) = cells.get(next.fetch_add(1, Ordering::Relaxed)) {
            let began = Instant::now();
            let ended = divide(&DivisionInput::new(cell.clone()));
            let seconds = began.elapsed().as_secs_f64();
            let said = match &ended {
                Ok(division) => format!("{} {:?} {}", division.outcome(), division.chi_signed(), division.work.steps),
                Err(error) => error.to_string(),
            };
            println!("{seconds:.1} s, R0 = {:.4}, {}: {said}", cell.r0, cell.cue);
            solved.push((seconds, ended));
        }
        solved
    };
    let solved: Vec<_> = std::thread::scope(|scope| {
        let threads = [scope.spawn(solve), scope.spawn(solve)];
        threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
    });
    let mut kinds = BTreeMap::<String, usize>::new();
    for (_, ended) in &solved {
        *kinds.entry(ended.as_ref().map_or_else(kind, |division| division.outcome().to_string())).or_default() += 1;
    }
    let slowest = solved.iter().map(|(seconds, _)| *seconds).fold(0.0, f64::max);
    println!("{kinds:?}, slowest {slowest:.1} s");
    assert_eq!(solved.len(), COUNT);
    assert!(slowest < LONGEST, "{slowest}");
    // None for want of a mesh or a step that resolves it.
    assert_eq!(kinds.keys().filter(|kind| kind.starts_with("Stalled")).count(), 0, "{kinds:?}");
}

/// A regulator that gathers at the neck takes a coefficient away there, which ends the division whether or not the equations still
/// have a solution.
#[test]
fn a_coefficient_that_a_regulator_takes_away_is_named_with_its_place() {
    let folded =
        "regulator:band,u0=0.3934,omega=0.1179,amplitude=0.533,turnover=10,diffusion=0.39,kappa=-0.353,xi_s=0.8878";
    for (r0, cue, coefficient, place) in [
        (4.68, "regulator:none,turnover=67,diffusion=0.1,friction=-0.85", "friction", 0.5),
        (2.45, "regulator:none,turnover=45,diffusion=0.16,eta_s=-0.99", "eta_s", 0.5),
        (2.65, "regulator:none,turnover=59,diffusion=0.065,viscosity=-0.9", "eta_b", 0.5),
        // Here no step is solved any more before it is at zero.
        (3.0523, folded, "kappa", 0.305),
    ] {
        let cell = Cell::gao2026_thresholds(r0).with_cue(cue.parse().unwrap());
        let error = divide(&DivisionInput::new(cell)).unwrap_err();
        println!("{cue}: {error}");
        let DivisionError::Coefficient { field, u, value, .. } = error else { panic!("{cue}: {error}") };
        assert_eq!(field, coefficient, "{cue}");
        assert!((u - place).abs() < 0.02 && value < 0.02, "{cue}: {value} at {u}");
        assert!(error.to_string().contains("lower its coupling"), "{error}");
    }
}

/// A regulator that turns over slowly and pulls on the cortex gathers in a pole, ever more of it in ever less room, as aggregating cells
/// do. Time stepping stalls there for a reason, which is named; with faster turnover the cell divides or rests.
#[test]
fn a_regulator_that_collapses_to_a_point_is_named() {
    for (r0, cue, pole) in [
        (1.43, "regulator:gradient,amplitude=0.26,turnover=0.25,diffusion=0.08,tension=0.92", 0.0),
        (1.78, "regulator:gradient,amplitude=-0.67,turnover=0.02,diffusion=0.3,tension=0.77", 1.0),
    ] {
        let solve =
            |cue: &str| divide(&DivisionInput::new(Cell::gao2026_thresholds(r0).with_cue(cue.parse().unwrap())));
        let error = solve(cue).unwrap_err();
        println!("{cue}: {error}");
        let DivisionError::Collapses { u, c, .. } = error else { panic!("{cue}: {error}") };
        assert!((u - pole).abs() < 1e-2 && c > 100.0, "{cue}: {c} at {u}");
        let advised = solve(&cue.replace("turnover=0.", "turnover=5.")).unwrap();
        println!("with more turnover: {}", advised.outcome());
    }
}
