//! The order of time steps, and the energy that a relaxing cell loses.

use furrow_bvp::newton::NewtonScratch;
use furrow_bvp::{BoundaryValueProblem, Newton, Solution, System};
use furrow_cell::{Cell, Cue, Numerics, Parameter, Shell};
use furrow_mechanics::cortex::equations::{COMPONENTS, R, Z};
use furrow_mechanics::cortex::{Cortex, Domain};
use furrow_mechanics::division::stepper::{HistoryPoint, Stepper};
use furrow_mechanics::division::{DivisionInput, DivisionOptions, divide, divide_with};
use furrow_verification::contour::Computed;
use furrow_verification::report::within;
use furrow_verification::states::{passive_shape, uneven_cell};

/// Mesh of these runs, which compare errors in time.
fn numerics() -> Numerics {
    Numerics { stages: 3, intervals: 20, ..Numerics::default() }
}

fn step(stepper: &mut Stepper, dt: f64, order: usize, count: usize) {
    for _ in 0..count {
        stepper.attempt(dt, order).unwrap();
        stepper.accept();
    }
}

/// Growing steps from the start up to length `dt`, then the given number of that length.
fn begin(stepper: &mut Stepper, dt: f64, count: usize) {
    let mut short = dt * 1.25f64.powi(-40);
    while short < dt {
        step(stepper, short, 4, 1);
        short *= 1.25;
    }
    step(stepper, dt, 4, count);
}

/// L² distance of two shapes on one mesh.
fn distance(a: &Solution, b: &Solution) -> f64 {
    let pairs = a.stages.chunks_exact(COMPONENTS).zip(b.stages.chunks_exact(COMPONENTS));
    let square: f64 = pairs.map(|(a, b)| (a[R] - b[R]).powi(2) + (a[Z] - b[Z]).powi(2)).sum();
    (square / (a.intervals() * a.m) as f64).sqrt()
}

/// Equal steps of order 1 to 4 from exact shapes, compared with far shorter steps.
#[test]
fn steps_converge_with_the_order_of_their_formula() {
    let cell = uneven_cell(3.0, 35.0, "none").unwrap();
    let start = passive_shape(&cell, &numerics()).unwrap();
    let stepper = || Stepper::new(Cortex::new(&cell, Domain::Full, &[]), start.m, numerics().intervals, start.clone());
    let (long, parts, steps) = (0.008, 8, 16);
    let short = long / parts as f64;
    let mut fine = stepper();
    begin(&mut fine, short, 4);
    // The last shapes before the comparison, newest first; the stepper keeps five.
    let mut history: Vec<HistoryPoint> = Vec::new();
    for _ in 0..5 * parts {
        step(&mut fine, short, 4, 1);
        history.insert(0, fine.history[0].clone());
    }
    step(&mut fine, short, 4, steps * parts);
    let end = fine.history[0].y.clone();
    println!("the shape moves by {:.3}", distance(&end, &history[0].y));
    assert!(distance(&end, &history[0].y) > 0.02, "the shape moves");
    for order in 1..=4 {
        let error = |every: usize| {
            let mut coarse = stepper();
            coarse.history = history.iter().step_by(every).take(5).cloned().collect();
            step(&mut coarse, short * every as f64, order, steps * parts / every);
            assert!((coarse.history[0].t - fine.history[0].t).abs() < 1e-9);
            distance(&coarse.history[0].y, &end)
        };
        let [coarse, fine] = [parts / 2, parts / 4].map(error);
        let seen = (coarse / fine).log2();
        println!("order {order}: {seen:.2}, from errors of {coarse:.1e} and {fine:.1e}");
        within(&format!("order in time of formula {order}"), (seen - order as f64).abs(), 0.4);
    }
}

/// A whole division chooses its steps and orders. The error of a step of order 4 is proportional to dt⁵ and there are 1/dt of them:
/// a hundred times smaller tolerance makes χ and the time of pinch-off 100^(4/5) = 40 times more accurate.
#[test]
fn divisions_converge_with_the_tolerance_of_their_steps() {
    let cell = Cell::gao2026_thresholds(3.0).with_cue("tension:gradient,amplitude=0.2".parse().unwrap());
    let [coarse, fine, exact] = [1e-4, 1e-6, 1e-8].map(|time_tolerance| {
        // A fine mesh: the error of a coarse one depends on when it was moved, and so on the steps.
        let numerics = Numerics { time_tolerance, noise: 0.0, intervals: 120, ..Numerics::default() };
        let division = divide(&DivisionInput { numerics, ..DivisionInput::new(cell.clone()) }).unwrap();
        [division.chi_signed().unwrap(), division.t_end]
    });
    for (k, what) in ["χ", "t_end"].into_iter().enumerate() {
        let [coarse, fine] = [coarse, fine].map(|found| (found[k] - exact[k]).abs());
        println!("{what}: errors of {coarse:.1e} and {fine:.1e}");
        within(&format!("{what} at a tolerance of 1e-6, to what it was at 1e-4"), fine / coarse, 0.05);
    }
}

/// Energy at one time of a run, and the powers that change it.
struct Observed {
    /// ∫ (½κC² + γ) dA.
    energy: f64,
    /// ∫ (Tᵈ:S + Γv²) dA, twice the dissipation function.
    dissipated: f64,
    /// ∫ f_c v_n dA.
    by_shell: f64,
    /// −∫ Tᵃ:S dA.
    by_activity: f64,
}

fn observe(stepper: &Stepper) -> Observed {
    let (cortex, shape) = (&stepper.cortex, &stepper.history[0].y);
    let moved = shape.stages.chunks_exact(COMPONENTS).zip(&cortex.past);
    let motion = moved.map(|(y, past)| [y[R] - past[0], y[Z] - past[1]].map(|d| d * cortex.rate)).collect();
    let state = Computed { cell: cortex.cell.clone(), shape: shape.clone(), motion, noise: Vec::new() };
    let on = |stress: [f64; 2], strain: [f64; 2]| stress[0] * strain[0] + stress[1] * strain[1];
    Observed {
        energy: state.integral(|p| {
            0.5 * p.here.kappa * (p.curvature[0] + p.curvature[1] - p.here.spontaneous).powi(2) + p.here.tension
        }),
        dissipated: state.integral(|p| {
            on(p.viscous, p.strain) + p.here.friction * p.v * p.v + cortex.cell.material.normal_friction * p.v_n * p.v_n
        }),
        by_shell: state.integral(|p| p.shell * p.v_n),
        by_activity: -state.integral(|p| on(p.active, p.strain)),
    }
}

/// The difference of the energy lost over a run and the integral of the powers, by Simpson's rule over even steps, relative to the
/// dissipation.
fn imbalance(cell: &Cell, start: Solution, dt: f64) -> f64 {
    let mut stepper = Stepper::new(Cortex::new(cell, Domain::Full, &[]), start.m, numerics().intervals, start);
    begin(&mut stepper, dt, 5);
    let mut run = vec![observe(&stepper)];
    for _ in 0..40 {
        step(&mut stepper, dt, 4, 1);
        run.push(observe(&stepper));
    }
    let integral = |of: fn(&Observed) -> f64| -> f64 {
        run.windows(3).step_by(2).map(|w| dt / 3.0 * (of(&w[0]) + 4.0 * of(&w[1]) + of(&w[2]))).sum()
    };
    let (lost, dissipated) = (run[0].energy - run[40].energy, integral(|o| o.dissipated));
    let given = integral(|o| o.by_shell + o.by_activity);
    println!("energy lost {lost:.6}, dissipated {dissipated:.6}, given {given:.6}");
    assert!(dissipated > 0.1, "{dissipated}");
    (lost + given - dissipated).abs() / dissipated
}

/// A cell without activity, released from its shell: dE/dt = −2Φ, Φ the dissipation function of the Rayleighian.
#[test]
fn a_relaxing_cell_loses_what_it_dissipates() {
    let pressed = Cell { shell: Shell { aspect: 3.0, ..Shell::GAO2026 }, ..uneven_cell(2.0, 0.0, "none").unwrap() };
    let start = passive_shape(&pressed, &numerics()).unwrap();
    let free = Cell { shell: Shell { p0: 0.0, ..pressed.shell }, ..pressed.clone() };
    within("energy of a free cell", imbalance(&free, start.clone(), 0.002), 1e-4);
    // In a soft shell: its force is not the gradient of an energy of the cell, so its power is external work.
    let held = Cell { shell: Shell { aspect: 1.2, p0: 0.4, w: 0.6, ..Shell::GAO2026 }, ..pressed };
    within("energy of a cell in a shell", imbalance(&held, start, 0.002), 1e-4);
}

/// With activity its power is added: −∫ Tᵃ:S dA.
#[test]
fn an_active_cell_spends_what_activity_gives() {
    let cell = uneven_cell(2.0, 20.0, "none").unwrap();
    let start = passive_shape(&cell, &numerics()).unwrap();
    within("energy of an active cell", imbalance(&cell, start, 0.004), 1e-4);
}

/// The rate of an implicit step is consistent: doubling the rate from half as far back gives the same step.
#[test]
fn a_step_is_a_rate_of_change_and_a_past() {
    let cell = uneven_cell(2.0, 18.0, "none").unwrap();
    let start = passive_shape(&cell, &numerics()).unwrap();
    let solve = |rate: f64, past: Vec<[f64; 2]>| {
        let mut cortex = Cortex::new(&cell, Domain::Full, &[]);
        (cortex.rate, cortex.past) = (rate, past);
        let (mut y, mut system) = (start.clone(), System::new(cortex.dimensions(), start.m));
        let newton = Newton { tolerance: 1e-12, ..Newton::default() };
        newton.solve(&mut system, &mut NewtonScratch::default(), &mut cortex, &mut y, &[], false).unwrap();
        y
    };
    let places = |y: &Solution| -> Vec<[f64; 2]> { y.stages.chunks_exact(COMPONENTS).map(|s| [s[R], s[Z]]).collect() };
    let once = solve(100.0, places(&start));
    let halfway = places(&start).iter().zip(places(&once)).map(|(a, b)| [0, 1].map(|k| 0.5 * (a[k] + b[k]))).collect();
    let again = solve(200.0, halfway);
    within("the same step at twice its rate", distance(&once, &again), 1e-10);
}

/// Lengths have no unit of their own: χ, the furrow and the time stay as they are if all lengths grow together, with activity,
/// shell, viscosities and friction as their dimensions say. Sensitivities must add up to that, each times its parameter and the
/// power of its length. Differences of divisions are too coarse to see that the neck at pinch-off is a thousandth of R0.
#[test]
fn sensitivities_have_no_unit_of_length() {
    use Parameter::{EtaB, EtaS, Friction, P0, R0, XiS};
    let powers = [(R0, 1.0), (XiS, -1.0), (P0, -2.0), (EtaB, -2.0), (EtaS, -2.0), (Friction, -4.0)];
    let numerics = Numerics { noise: 0.0, ..Numerics::default() };
    let cell = Cell::gao2026_thresholds(3.3).with_cue(Cue::published());
    let input = DivisionInput { numerics, ..DivisionInput::new(cell.clone()) };
    let parameters = powers.map(|(parameter, _)| parameter);
    let options = DivisionOptions { parameters: &parameters, ..DivisionOptions::default() };
    let (_, found) = divide_with(&input, options).unwrap();
    let (mut sums, mut sizes) = ([0.0; 3], [0.0f64; 3]);
    for (sensitivity, (parameter, power)) in found.unwrap().iter().zip(powers) {
        let of = [sensitivity.chi_signed, sensitivity.u_furrow, sensitivity.t_end];
        for (k, slope) in of.into_iter().enumerate() {
            let part = power * parameter.get(&cell) * slope;
            sums[k] += part;
            sizes[k] = sizes[k].max(part.abs());
        }
    }
    let largest = sums.iter().zip(sizes).map(|(sum, size)| sum.abs() / size).fold(0.0, f64::max);
    within("sensitivities in another unit of length", largest, 5e-5);
}
