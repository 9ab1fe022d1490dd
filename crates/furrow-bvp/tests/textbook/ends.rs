//! How unsuccessful solves end, and their errors.

use furrow_bvp::{
    Continuation, ContinuationError, ContinuationSettings, Gauss, Interrupt, InvalidInput, Metric, NewtonError, Place,
    Settings, SimpleProblem, Solution, SolveError, Stop, TooLarge, mesh, solve,
};

/// u″ = (u³ − u)/ε², u(0) = 0, u(1) = 1, from u = x: it has about 1/ε solutions.
fn waves(epsilon: f64) -> (SimpleProblem, Solution) {
    let problem = SimpleProblem::new(2, move |_, y, _, f| {
        f[0] = y[1];
        f[1] = (y[0] * y[0] * y[0] - y[0]) / (epsilon * epsilon);
    })
    .quadratures(1)
    .left_conditions(1, |y, _, r| r[0] = y[0])
    .right_conditions(1, |y, _, r| r[0] = y[0] - 1.0);
    let line = |x: f64, y: &mut [f64]| y.copy_from_slice(&[x, 1.0]);
    let guess = Solution::from_fn(&Gauss::default(), &mesh::uniform(0.0, 1.0, 10), 2, &[], line).unwrap();
    (problem, guess)
}

#[test]
fn a_solve_ends_with_its_budget() {
    let (mut problem, guess) = waves(0.1);
    assert!(solve(&mut problem, &guess, &Settings::default()).is_ok());
    let (mut problem, guess) = waves(1e-3);
    for budget in [0.5, 2.0] {
        let settings = Settings { budget, ..Settings::default() };
        let outcome = solve(&mut problem, &guess, &settings);
        let Err(SolveError::Stopped { reason: Stop::Budget, .. }) = outcome else { panic!("{outcome:?}") };
    }
    let refused = solve(&mut problem, &guess, &Settings { budget: 0.0, ..Settings::default() });
    let Err(SolveError::Invalid(InvalidInput::Setting { name: "the budget", .. })) = refused else {
        panic!("{refused:?}")
    };
}

#[test]
fn the_homotopy_can_be_limited_and_switched_off() {
    let (mut problem, guess) = waves(1e-2);
    let mut outcome = |homotopy| {
        let settings = Settings { homotopy, max_intervals: 200, budget: 60.0, ..Settings::default() };
        solve(&mut problem, &guess, &settings)
    };
    for homotopy in [0, 5] {
        let outcome = outcome(homotopy);
        let Err(SolveError::Newton { intervals: 160, .. }) = outcome else { panic!("{homotopy}: {outcome:?}") };
    }
    let outcome = outcome(Settings::default().homotopy);
    let Err(SolveError::Stopped { reason: Stop::Budget, .. }) = outcome else { panic!("{outcome:?}") };
}

#[test]
fn an_interrupt_ends_a_solve_and_a_branch() {
    let interrupt = Interrupt::default();
    interrupt.set();
    let (mut problem, guess) = waves(0.1);
    let outcome = solve(&mut problem, &guess, &Settings { interrupt, ..Settings::default() });
    let Err(SolveError::Stopped { reason: Stop::Interrupted, intervals: 10, best: None }) = outcome else {
        panic!("{outcome:?}")
    };
    let interrupt = Interrupt::default();
    let bratu = SimpleProblem::new(2, |_, y, p, f| {
        f[0] = y[1];
        f[1] = -p[0] * furrow_bvp::DualNum::exp(&y[0]);
    })
    .scalars(1)
    .left_conditions(1, |y, _, r| r[0] = y[0])
    .right_conditions(1, |y, _, r| r[0] = y[0]);
    let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 10), &[0.0, 0.0], &[0.0]);
    let settings = ContinuationSettings { interrupt: interrupt.clone(), ..Default::default() };
    let mut branch = Continuation::start(bratu, guess, Metric::unit(2, 1), settings, true).unwrap();
    let ended = branch.follow([0.0, 3.0], 100, |branch, _| {
        if branch.state.points == 4 {
            interrupt.set();
        }
        true
    });
    let Err(ContinuationError::Stopped { reason: Stop::Interrupted, parameter, .. }) = ended else {
        panic!("{ended:?}")
    };
    assert!(branch.state.points == 4 && parameter == branch.state.parameter());
    // It goes on from there.
    branch.settings.interrupt = Interrupt::default();
    assert!(branch.advance().is_ok());
}

/// √x of a negative number next to the right end.
#[test]
fn what_is_not_a_number_is_named_with_its_place() {
    use furrow_bvp::DualNum;
    let start = |left: f64| {
        let mut problem = SimpleProblem::new(2, |x, y, _, f| {
            f[0] = y[1];
            f[1] = (y[0] * 0.0 + (0.7 - x)).sqrt();
        })
        .left_conditions(1, move |y, _, r| r[0] = y[0] + left)
        .right_conditions(1, |y, _, r| r[0] = y[0]);
        let guess = Solution::constant(2, &mesh::uniform(0.0, 1.0, 10), &[0.0, 0.0], &[]);
        let outcome = solve(&mut problem, &guess, &Settings { max_intervals: 10, ..Settings::default() });
        let Err(SolveError::Newton { source, .. }) = outcome else { panic!("{outcome:?}") };
        source
    };
    let NewtonError::Undefined { place: Place::Rhs { component: 1, x }, .. } = start(0.0) else {
        panic!("{}", start(0.0))
    };
    assert!(x > 0.7 && x < 0.73, "{x}");
    // Later parts of the equations come after it.
    assert!(matches!(start(f64::NAN), NewtonError::Undefined { place: Place::Rhs { component: 1, .. }, .. }));
}

/// Twelve springs u″ = −k²u from 0 to sin k: 24 equations; twelve are quadratures.
#[test]
fn closures_that_declare_quadratures_may_have_more_components() {
    const SPRINGS: usize = 12;
    let stiffness = |k: usize| 0.1 * (k + 1) as f64;
    let springs = || {
        SimpleProblem::new(2 * SPRINGS, move |_, y, _, f| {
            for k in 0..SPRINGS {
                f[k] = y[SPRINGS + k];
                f[SPRINGS + k] = -y[k] * stiffness(k).powi(2);
            }
        })
        .left_conditions(SPRINGS, |y, _, r| r.copy_from_slice(&y[..SPRINGS]))
        .right_conditions(SPRINGS, move |y, _, r| {
            for (k, (r, y)) in r.iter_mut().zip(y).enumerate() {
                *r = *y - stiffness(k).sin();
            }
        })
    };
    let guess = Solution::constant(4, &mesh::uniform(0.0, 1.0, 4), &[0.0; 2 * SPRINGS], &[]);
    let refused = solve(&mut springs(), &guess, &Settings::default());
    assert_eq!(refused, Err(InvalidInput::from(TooLarge::StageUnknowns { stage_unknowns: 96 }).into()));
    let solved = solve(&mut springs().quadratures(SPRINGS), &guess, &Settings::default()).unwrap();
    for (k, slope) in solved.solution.node(0)[SPRINGS..].iter().enumerate() {
        assert!((slope - stiffness(k)).abs() < 1e-8, "{k}: {slope}");
    }
}
