//! What decides how a division ends: the stability of the resting shape, the sign of a growth rate however small, and the
//! neck's radius.

use furrow_cell::{Cell, Cue, Numerics};
use furrow_mechanics::cortex::equations::LENGTH;
use furrow_mechanics::cortex::observables::positions;
use furrow_mechanics::cortex::symmetry::mirror;
use furrow_mechanics::division::oscillation::Oscillation;
use furrow_mechanics::division::{
    Division, DivisionError, DivisionInput, DivisionOptions, Outcome, divide, divide_with,
};
use furrow_mechanics::equilibria::{BranchOptions, pitchfork};
use furrow_verification::report::{near, within};
use furrow_verification::states::{resting, uneven_cell};

fn solve(cell: Cell) -> Division {
    divide(&DivisionInput::new(cell)).unwrap_or_else(|e| panic!("{e}"))
}

/// A cell does not rest in a symmetric shape with a positive growth rate, however small, and rests in one with a negative rate.
/// Its pitchfork is subcritical: beyond it there is no other stable shape.
#[test]
fn a_growth_rate_above_zero_divides_and_one_below_rests() {
    let cell = Cell::gao2026_thresholds(1.64);
    let threshold = pitchfork::first(&cell, &Numerics::default(), &BranchOptions::default()).unwrap().point.xi_s;
    for margin in [1e-5, 1e-6] {
        let above = solve(Cell { xi_s: threshold * (1.0 + margin), ..cell.clone() });
        let growing = above.growth_rate().unwrap_or(0.0);
        assert!(above.outcome() == Outcome::Asymmetric, "at rest in a shape that grows at {growing:.1e}");
        let rate = above.slow_growth_rate.unwrap();
        println!("ξ_s/ξ_s* − 1 = {margin:e}: σ = {rate:.1e}, {:?} after {:.0} τ", above.outcome(), above.t_end);
        assert!(rate > 0.0 && rate < 1e-3, "{rate}");
        let below = solve(Cell { xi_s: threshold * (1.0 - margin), ..cell.clone() });
        assert_eq!(below.outcome(), Outcome::Arrested, "below by {margin:e}");
        let rate = below.growth_rate().unwrap();
        assert!(rate < 0.0 && rate > -1e-3, "{rate}");
    }
}

/// With a tenth of the noise a cell waits at its saddle for longer by the time in which the growing mode grows tenfold.
#[test]
fn a_wait_at_a_saddle_is_as_long_as_growth_takes() {
    let cell = Cell::gao2026_thresholds(1.64);
    let threshold = pitchfork::first(&cell, &Numerics::default(), &BranchOptions::default()).unwrap().point.xi_s;
    let cell = Cell { xi_s: threshold * (1.0 + 1e-6), ..cell };
    let [loud, quiet] = [1e-2, 1e-3].map(|noise| {
        let numerics = Numerics { noise, ..Numerics::default() };
        divide(&DivisionInput { numerics, ..DivisionInput::new(cell.clone()) }).unwrap()
    });
    let growth = loud.slow_growth_rate.unwrap() * (quiet.t_end - loud.t_end);
    near("growth by the tenfold", growth, 10f64.ln(), 0.02);
}

/// The contour of a cell that oscillates, by its lengths at the steps of its division. Its swing is 4·10⁻³. The same lengths with a swing of
/// 2·10⁻⁴ are a cycle still, and with 5·10⁻⁵, which is what a shape at rest may tremble by, no more: the least is 10⁻⁴.
#[test]
fn a_cell_that_trembles_does_not_oscillate() {
    let cell = Cell { xi_s: 13.661062187437096, ..Cell::gao2026_thresholds(4.314170770347118) };
    let mut lengths: Vec<[f64; 2]> = Vec::new();
    let observed = divide_with(
        &DivisionInput::new(cell),
        DivisionOptions::observed_by(&mut |frame| lengths.push([frame.t, frame.shape.scalars[LENGTH]])),
    );
    let Err(DivisionError::Oscillates { period, .. }) = observed else { panic!("{observed:?}") };
    let late = &lengths[lengths.len() / 2..];
    let ends = late.iter().fold([f64::INFINITY, 0.0f64], |[a, b], [_, length]| [a.min(*length), b.max(*length)]);
    let swing = (ends[1] - ends[0]) / ends[1];
    println!("period {period:.2} τ, swing {swing:.1e}");
    assert!(swing > 1e-3, "{swing}");
    let period_of = |wanted: f64| {
        let mut oscillation = Oscillation::default();
        // Around the longest contour, with a swing that is so large.
        let scaled = |length: f64| ends[1] - (ends[1] - length) * (wanted / swing);
        lengths.iter().find_map(|[t, length]| oscillation.note(*t, scaled(*length)))
    };
    near("period with a swing of 2e-4", period_of(2e-4).unwrap_or(0.0), period, 1e-9);
    let trembling = period_of(5e-5);
    assert!(trembling.is_none(), "a swing of 5e-5 is taken for an oscillation of {:.2} τ", trembling.unwrap_or(0.0));
}

/// A division ends where the neck is narrower than 10⁻³ R0, and no sooner.
#[test]
fn a_division_ends_at_a_thousandth_of_the_radius() {
    let cell = Cell::gao2026_thresholds(3.0);
    let mut necks = Vec::new();
    let division = divide_with(
        &DivisionInput::new(cell.clone()),
        DivisionOptions::observed_by(&mut |frame| {
            necks.extend(frame.neck.map(|neck| neck.radius / cell.r0));
        }),
    );
    assert_eq!(division.unwrap().0.outcome(), Outcome::Symmetric);
    let [.., before, last] = necks[..] else { panic!("{necks:?}") };
    assert!(last < 1e-3 && before > 1e-3, "the last two necks are {before:.1e} and {last:.1e} of R0");
}

/// Shapes at rest of a cell and of its mirror image are mirror images.
#[test]
fn mirror_images_rest_as_mirror_images() {
    let mut largest = 0.0f64;
    for cue in [
        "kappa:band,u0=0.44,omega=0.15,amplitude=0.2",
        "tension:gradient,amplitude=0.25",
        "regulator:band,u0=0.44,omega=0.15,amplitude=0.5,turnover=4,diffusion=1,kappa=0.4",
    ] {
        let cell = uneven_cell(2.0, 9.0, cue).unwrap();
        let [one, image] = [cell.clone(), cell.mirrored()].map(|cell| resting(&cell).unwrap().shape);
        for i in 0..=one.intervals() {
            let mut mirrored = one.node(i).to_vec();
            mirror(&mut mirrored);
            let there = image.node(one.intervals() - i);
            largest = mirrored.iter().zip(there).fold(largest, |most, (a, b)| most.max((a - b).abs()));
        }
    }
    within("mirror images at rest", largest, 1e-8);
}

/// The passive shape depends on neither activity nor cue: a division starts from it.
#[test]
fn a_division_starts_from_the_passive_shape_without_its_cue() {
    let cell = uneven_cell(3.0, 25.0, "none").unwrap();
    let cued = cell.clone().with_cue("kappa:band,u0=0.44,omega=0.15,amplitude=0.2".parse().unwrap());
    let [a, b] = [cell, cued].map(|cell| {
        let mut start = Vec::new();
        divide_with(
            &DivisionInput::new(cell),
            DivisionOptions::observed_by(&mut |frame| {
                if frame.t == 0.0 {
                    positions(frame.shape, &mut start);
                }
            }),
        )
        .unwrap();
        start
    });
    let apart = a.iter().zip(&b).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max);
    assert!(!a.is_empty() && a.len() == b.len());
    within("the shape at t = 0, to that without the cue", apart, 1e-12);
}

/// χ follows from the volumes on both sides of the neck.
#[test]
fn chi_is_that_of_the_volumes_on_the_two_sides() {
    let cell = Cell::gao2026_thresholds(3.3).with_cue(Cue::published());
    let mut last = None;
    let (division, _) = divide_with(
        &DivisionInput::new(cell.clone()),
        DivisionOptions::observed_by(&mut |frame| {
            // By frusta between many points, independent of the solver's quadrature.
            let mut y = vec![0.0; frame.shape.components];
            let mut at = |u: f64| {
                frame.shape.eval(frame.gauss, u, &mut y);
                [y[0], y[1]]
            };
            if let Some(neck) = frame.neck {
                let mut volume = |from: f64, to: f64| {
                    let points: Vec<[f64; 2]> =
                        (0..=4000).map(|k| at(from + (to - from) * f64::from(k) / 4000.0)).collect();
                    let frustum = |w: &[[f64; 2]]| {
                        (w[0][1] - w[1][1]) * (w[0][0] * w[0][0] + w[0][0] * w[1][0] + w[1][0] * w[1][0])
                    };
                    std::f64::consts::PI / 3.0 * points.windows(2).map(frustum).sum::<f64>()
                };
                let [first, second] = [volume(0.0, neck.u), volume(neck.u, 1.0)];
                last = Some((second - first) / (first + second));
            }
        }),
    )
    .unwrap();
    near("χ", division.chi_signed().unwrap(), last.unwrap(), 1e-5);
}
