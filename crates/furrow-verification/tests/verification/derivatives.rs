//! Derivatives of the equations by hand, by dual numbers and by differences; invariance under mirror images and units. On
//! random states, for every field and profile of a cue.

use furrow_bvp::{
    BoundaryJacobian, BoundaryValueProblem, CollocationPoint, CollocationPoints, Directional, PointDirection,
    PointJacobian, PointValues,
};
use furrow_cell::cue::{Field, Profile, Quantity, RegulatorQuantity, Source, Width};
use furrow_cell::{Cell, Parameter};
use furrow_mechanics::cortex::equations::{
    BdfTerm, COMPONENTS, Carried, Constants, J, M, PHI, PSI, Q, R, REGULATED, T, V, Z, equations,
};
use furrow_mechanics::cortex::symmetry::{mirror, odd};
use furrow_mechanics::cortex::{Cortex, Domain};
use furrow_verification::balance::rates;
use furrow_verification::report::within;
use furrow_verification::states::{Draws, carried_past, cues, uneven_cell};
use num_dual::Dual64;

use crate::differences::{AT, difference_column, values};

/// A random state away from the axis, with (L, p).
fn state(components: usize, draws: &mut Draws) -> (Vec<f64>, [f64; 2]) {
    let mut y: Vec<f64> = (0..components).map(|_| draws.between(-1.0, 1.0)).collect();
    // Concentrations are above 0, and leave viscosities so.
    y.iter_mut().skip(PHI).for_each(|phi| *phi *= 0.5);
    (y[R], y[PSI]) = (draws.between(0.5, 2.0), draws.between(0.1, 3.0));
    (y, [draws.between(6.0, 8.0), draws.between(0.0, 3.0)])
}

/// A moving cortex with uneven activity.
fn cortex(cue: &str, free: &[Parameter]) -> Cortex {
    let mut cortex = Cortex::new(&uneven_cell(2.3, 21.0, cue).unwrap(), Domain::Full, free);
    (cortex.rate, cortex.past, cortex.noise) = (3.0, vec![[1.1, -0.2]], vec![1.03]);
    cortex.carried_past = vec![Carried { amount: 8.3, r_u: 5.1, z_u: -2.7 }];
    cortex
}

/// The solved equations agree with the independent statement of the balance of forces.
#[test]
fn the_equations_are_those_of_the_second_statement() {
    let (mut draws, mut largest) = (Draws(3), 0.0f64);
    for cue in cues() {
        let mut cortex = cortex(&cue, &[]);
        for _ in 0..5 {
            let (y, p) = state(cortex.components(), &mut draws);
            let [r_t, z_t] = [y[R] - cortex.past[0][0], y[Z] - cortex.past[0][1]].map(|d| d * cortex.rate);
            let [phi_t, stretching] = [(); 2].map(|()| draws.between(-1.0, 1.0));
            let motion = [r_t, z_t, phi_t];
            if cortex.is_regulated() {
                // However fast the contour stretches.
                let rates = [phi_t, r_t, stretching];
                cortex.carried_past = vec![carried_past(&cortex.cell, &y, p[0], cortex.rate, rates)];
            }
            let expected = expected(&cortex.cell, p, &y, motion);
            for (found, expected) in values(&cortex, &y, &p).iter().zip(expected) {
                largest = largest.max((found / p[0] - expected).abs() / (1.0 + expected.abs()));
            }
        }
    }
    within("the second statement", largest, 1e-12);
}

fn expected(cell: &Cell, p: [f64; 2], y: &[f64], motion: [f64; 3]) -> Vec<f64> {
    match y.len() {
        REGULATED => rates::<_, REGULATED>(cell, AT.x, p[0], p[1], 1.03, y.try_into().unwrap(), motion).to_vec(),
        _ => rates::<_, COMPONENTS>(cell, AT.x, p[0], p[1], 1.03, y.try_into().unwrap(), motion).to_vec(),
    }
}

/// Jacobians of the equations in all unknowns and free parameters.
#[test]
fn jacobians_by_hand_by_dual_numbers_and_by_differences_agree() {
    let (mut draws, mut by_dual, mut by_difference) = (Draws(4), 0.0f64, 0.0f64);
    for cue in cues() {
        let cell = uneven_cell(2.3, 21.0, &cue).unwrap();
        let mut free =
            vec![Parameter::XiS, Parameter::R0, Parameter::Kappa, Parameter::W, Parameter::SpontaneousCurvature];
        free.push(Parameter::NormalFriction);
        free.extend(Quantity::ALL.map(|quantity| Parameter::Cue { term: 0, quantity }));
        use RegulatorQuantity::{Diffusion, Half, Source as OfSource, Strength, Turnover};
        let numbers = Quantity::ALL.map(OfSource).into_iter().chain([Turnover, Diffusion]);
        let couplings = Field::ALL.into_iter().flat_map(|field| [Strength(field), Half(field)]);
        free.extend(numbers.chain(couplings).map(Parameter::Regulator));
        free.retain(|parameter| parameter.is_of(&cell));
        let mut cortex = cortex(&cue, &free);
        for _ in 0..3 {
            let (y, p) = state(cortex.components(), &mut draws);
            let mut p = p.to_vec();
            p.extend(free.iter().map(|parameter| parameter.get(&cell)));
            let (n, np) = (y.len(), p.len());
            let (f, jacobian) = by_hand(&mut cortex, &y, &p);
            for (by_hand, once) in f.iter().zip(values(&cortex, &y, &p)) {
                by_dual = by_dual.max((by_hand - once).abs() / (1.0 + once.abs()));
            }
            for k in 0..n + np {
                let dual = dual_column(&cortex, &y, &p, k);
                let step = if k < n { 1e-3 } else { 1e-4 * p[k - n].abs().max(0.1) };
                let difference = difference_column(&mut cortex, &y, &p, k, step);
                cortex.prepare(&p);
                for i in 0..=n {
                    let exact = jacobian[k][i];
                    by_dual = by_dual.max((exact - dual[i]).abs() / (1.0 + exact.abs()));
                    by_difference = by_difference.max((exact - difference[i]).abs() / (1.0 + exact.abs()));
                }
            }
        }
    }
    within("by hand and by dual numbers", by_dual, 1e-11);
    within("by hand and by differences", by_difference, 1e-6);
}

/// The function to differentiate, and the columns of the hand-written Jacobian: by y, then by the scalars. They are those of the last of
/// many points, which go through in groups.
fn by_hand(cortex: &mut Cortex, y: &[f64], p: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
    const POINTS: usize = 11;
    let one = cortex.clone();
    cortex.past = vec![one.past[0]; POINTS];
    cortex.carried_past = vec![one.carried_past[0]; POINTS];
    cortex.noise = vec![one.noise[0]; POINTS];
    let (x, states) = ([AT.x; POINTS], y.repeat(POINTS));
    cortex.prepare(p);
    cortex.prepare_points(&x, p);
    let (n, np) = (y.len(), p.len());
    let zeros = |size: usize| vec![0.0; POINTS * size];
    let (mut f, mut fy, mut fp, mut g, mut gy, mut gp) =
        (zeros(n), zeros(n * n), zeros(n * np), zeros(1), zeros(n), zeros(np));
    let mut out = PointJacobian { f: &mut f, fy: &mut fy, fp: &mut fp, g: &mut g, gy: &mut gy, gp: &mut gp };
    cortex.rhs_jacobian_many(CollocationPoints { first: 0, x: &x, y: &states }, p, &mut out);
    let PointJacobian { f, fy, fp, g, gy, gp } = out.at(POINTS - 1, n, np, 1);
    let by_y = (0..n).map(|k| (0..n).map(|i| fy[i * n + k]).chain([gy[k]]).collect());
    let columns = by_y.chain((0..np).map(|k| (0..n).map(|i| fp[i * np + k]).chain([gp[k]]).collect())).collect();
    (cortex.past, cortex.carried_past, cortex.noise) = (one.past, one.carried_past, one.noise);
    (f.iter().chain(&*g).copied().collect(), columns)
}

/// Derivatives of the right-hand sides by the motion, which determine growth rates: the past lies a step further back.
#[test]
fn the_response_to_a_motion_is_that_to_an_earlier_past() {
    let (mut draws, mut largest) = (Draws(6), 0.0f64);
    for cue in cues() {
        let mut cortex = cortex(&cue, &[]);
        for _ in 0..5 {
            let (y, p) = state(cortex.components(), &mut draws);
            let before = values(&cortex, &y, &p);
            let (here, carried, (sin, cos)) = (cortex.past[0], cortex.carried_past[0], y[PSI].sin_cos());
            let diluted = cortex.cell.cue.regulator().is_some_and(|regulator| regulator.diluted);
            // Outwards, along the contour, and of the regulator.
            for (normal, along, change) in [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)] {
                let moved = [normal * sin + along * cos, normal * cos - along * sin];
                cortex.past[0] = [0, 1].map(|k| here[k] - moved[k] / cortex.rate);
                if let (true, Some(phi)) = (cortex.is_regulated(), y.get(PHI)) {
                    let amount = if diluted { p[0] * (y[R] * change + (1.0 + phi) * moved[0]) } else { change };
                    cortex.carried_past[0].amount = carried.amount - amount / cortex.rate;
                }
                let mut response = vec![0.0; y.len()];
                let change = change - along * y.get(J).unwrap_or(&0.0);
                cortex.response_to_motion(AT, &y, p[0]).put(normal, change, &mut response);
                for ((after, before), response) in values(&cortex, &y, &p).iter().zip(&before).zip(&response) {
                    largest = largest.max((after - before - response).abs() / (1.0 + response.abs()));
                }
                (cortex.past[0], cortex.carried_past[0]) = (here, carried);
            }
            // Every part of a regulator's past by itself.
            for k in 0..if cortex.is_regulated() { 5 } else { 0 } {
                let unit = |i: usize| if i == k { 0.3 } else { 0.0 };
                let (place, change) = ([unit(0), unit(1)], Carried::from([unit(2), unit(3), unit(4)]));
                cortex.past[0] = [here[0] + place[0], here[1] + place[1]];
                let parts = carried.parts();
                cortex.carried_past[0] = std::array::from_fn(|i| parts[i] + change.parts()[i]).into();
                let normal = cortex.rate * (sin * place[0] + cos * place[1]);
                let strain = cortex.response_to_motion(AT, &y, p[0]).strain;
                let lost = normal * strain + cortex.response_to_past(&y, p[0], place, change);
                let after = values(&cortex, &y, &p)[J];
                largest = largest.max((before[J] - after - lost).abs() / (1.0 + lost.abs()));
                (cortex.past[0], cortex.carried_past[0]) = (here, carried);
            }
        }
    }
    within("the response to a motion", largest, 1e-11);
}

/// One of them by dual numbers.
fn dual_column(cortex: &Cortex, y: &[f64], p: &[f64], k: usize) -> Vec<f64> {
    match y.len() {
        REGULATED => dual_column_of::<REGULATED>(cortex, y, p, k),
        _ => dual_column_of::<COMPONENTS>(cortex, y, p, k),
    }
}

fn dual_column_of<const N: usize>(cortex: &Cortex, y: &[f64], p: &[f64], k: usize) -> Vec<f64> {
    let n = N;
    let unit = |i: usize, v: f64| Dual64::new(v, if i == k { 1.0 } else { 0.0 });
    let constants = Constants::new(&cortex.cell, |parameter, v| {
        cortex.free.iter().position(|f| *f == parameter).map_or(Dual64::from_re(v), |i| unit(n + 2 + i, v))
    });
    let lifted: [Dual64; N] = std::array::from_fn(|i| unit(i, y[i]));
    let [r_past, z_past] = cortex.past[0];
    let motion = BdfTerm { rate: cortex.rate, r_past, z_past, carried_past: cortex.carried_past[0] };
    let (f, g) = equations(&constants, AT.x, motion, 1.03, &lifted, unit(n, p[0]), unit(n + 1, p[1]));
    f.iter().chain([&g]).map(|f| f.eps).collect()
}

/// Conditions at both ends.
#[test]
fn jacobians_of_the_conditions_are_their_slopes() {
    let carried = "regulator:none,turnover=3,diffusion=1,activity=0.4";
    for (domain, cue) in [Domain::Full, Domain::Half].into_iter().flat_map(|d| [(d, "none"), (d, carried)]) {
        let mut cortex = cortex(cue, &[]);
        cortex.domain = domain;
        let (n, conditions) = (cortex.components(), cortex.dimensions().left);
        let (y, p) = state(cortex.components(), &mut Draws(9));
        for at_left in [true, false] {
            let at = |y: &[f64]| {
                let (mut r, mut ry, mut rp) = (vec![0.0; conditions], vec![0.0; conditions * n], vec![0.0; 10]);
                let mut out = BoundaryJacobian { r: &mut r, ry: &mut ry, rp: &mut rp };
                if at_left {
                    cortex.left(y, &p, &mut out)
                } else {
                    cortex.right(y, &p, &mut out)
                }
                (r, ry)
            };
            let (r, ry) = at(&y);
            for k in 0..n {
                let mut moved = y.clone();
                moved[k] += 1.0;
                let (there, _) = at(&moved);
                (0..conditions).for_each(|i| assert!((there[i] - r[i] - ry[i * n + k]).abs() < 1e-14, "{i} {k}"));
            }
        }
    }
}

/// Second and third directional derivatives, which determine normal forms, by differences of the first.
#[test]
fn higher_derivatives_are_slopes_of_the_lower() {
    let mut draws = Draws(5);
    let (mut second, mut third) = (0.0f64, 0.0f64);
    for cue in cues() {
        let cell = uneven_cell(2.3, 21.0, &cue).unwrap();
        let mut cortex = Cortex::new(&cell, Domain::Full, &[Parameter::XiS]);
        let (y, p) = state(cortex.components(), &mut draws);
        let (n, p) = (y.len(), [p[0], p[1], cell.xi_s]);
        let mut direction = || -> (Vec<f64>, [f64; 3]) {
            ((0..n).map(|_| draws.between(-1.0, 1.0)).collect(), std::array::from_fn(|_| draws.between(-1.0, 1.0)))
        };
        let (a, b) = (direction(), direction());
        let h = 1e-3;
        // The slope along a of the slope along b.
        let mut at = |s: f64, t: f64| {
            let y: Vec<f64> = (0..n).map(|k| y[k] + h * (s * a.0[k] + t * b.0[k])).collect();
            let p: [f64; 3] = std::array::from_fn(|k| p[k] + h * (s * a.1[k] + t * b.1[k]));
            cortex.prepare(&p);
            values(&cortex, &y, &p)
        };
        let corner = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(s, t)| at(s, t));
        let line = [-2.0, -1.0, 1.0, 2.0].map(|s| at(s, 0.0));
        cortex.prepare(&p);
        let (mut f, mut g) = (vec![0.0; n], vec![0.0]);
        let [along_a, along_b] = [&a, &b].map(|d| PointDirection { y: &d.0, p: &d.1 });
        let point = PointValues { at: AT, y: &y, p: &p };
        cortex.second(point, [along_a, along_b], [&mut f, &mut g]);
        f.extend(g);
        for i in 0..=n {
            let slope = (corner[0][i] - corner[1][i] - corner[2][i] + corner[3][i]) / (4.0 * h * h);
            second = second.max((slope - f[i]).abs() / (10.0 + slope.abs()));
        }
        let ([mut f2, mut f3], [mut g2, mut g3]) = ([(); 2].map(|()| vec![0.0; n]), [[0.0]; 2]);
        let points = CollocationPoints { first: AT.index, x: &[AT.x], y: &y };
        cortex.third_many(points, &p, along_a, [[&mut f2, &mut g2], [&mut f3, &mut g3]]);
        f3.extend(g3);
        for i in 0..=n {
            let slope = (line[3][i] - 2.0 * line[2][i] + 2.0 * line[1][i] - line[0][i]) / (2.0 * h.powi(3));
            third = third.max((slope - f3[i]).abs() / (100.0 + slope.abs()));
        }
    }
    within("second derivatives", second, 1e-3);
    within("third derivatives", third, 1e-3);
}

/// The mirrored cell at 1 − u, in the mirrored state and motion, changes as the mirror image does.
#[test]
fn the_equations_have_no_side() {
    let (mut draws, mut largest) = (Draws(6), 0.0f64);
    for cue in cues() {
        let one = cortex(&cue, &[]);
        let mut image = one.clone();
        image.cell = one.cell.mirrored();
        image.refresh();
        image.past = vec![[one.past[0][0], -one.past[0][1]]];
        let Carried { amount, r_u, z_u } = one.carried_past[0];
        image.carried_past = vec![Carried { amount, r_u: -r_u, z_u }];
        for _ in 0..5 {
            let (y, p) = state(one.components(), &mut draws);
            let mut mirrored = y.clone();
            mirror(&mut mirrored);
            let here = values(&one, &y, &p);
            let (mut there, mut g) = (vec![0.0; y.len()], vec![0.0]);
            image.rhs(CollocationPoint { x: 1.0 - AT.x, index: 0 }, &mirrored, &p, &mut there, &mut g);
            for k in 0..y.len() {
                // d/du and odd components change sign under u → 1 − u.
                let sign = if odd(y.len()).contains(&k) { 1.0 } else { -1.0 };
                largest = largest.max((there[k] - sign * here[k]).abs() / (1.0 + here[k].abs()));
            }
            largest = largest.max((g[0] - here[y.len()]).abs());
        }
    }
    within("mirror images", largest, 1e-12);
}

/// The cell with lengths, energies and times in other units.
fn in_units(cell: &Cell, length: f64, energy: f64, time: f64) -> Cell {
    let mut other = cell.clone();
    let tension = energy / (length * length);
    other.r0 *= length;
    other.xi_s *= energy / length;
    other.shell.p0 *= tension;
    let material = &mut other.material;
    material.kappa *= energy;
    material.spontaneous_curvature /= length;
    material.tension *= tension;
    material.eta_b *= tension * time;
    material.eta_s *= tension * time;
    material.friction *= tension * time / (length * length);
    material.normal_friction *= tension * time / (length * length);
    for term in other.cue.terms_mut() {
        if term.field == Field::Tension {
            term.amplitude *= tension;
        }
        if let Profile::Band { omega: Width::Length(omega), .. } | Profile::Step { omega: Width::Length(omega), .. } =
            &mut term.profile
        {
            *omega *= length;
        }
    }
    if let Some(regulator) = other.cue.regulator_mut() {
        regulator.turnover /= time;
        regulator.diffusion *= length * length / time;
        for coupling in regulator.couplings.iter_mut().filter(|coupling| coupling.field == Field::Tension) {
            coupling.strength *= tension;
        }
        if let Some(Source {
            profile:
                Profile::Band { omega: Width::Length(omega), .. } | Profile::Step { omega: Width::Length(omega), .. },
            ..
        }) = &mut regulator.source
        {
            *omega *= length;
        }
    }
    other
}

/// Separate changes of the units of length, energy and time: every term has the right dimension.
#[test]
fn the_equations_have_no_units() {
    let (mut draws, mut largest) = (Draws(7), 0.0f64);
    for cue in cues() {
        for (length, energy, time) in [(1.7, 1.0, 1.0), (1.0, 2.3, 1.0), (1.0, 1.0, 0.4)] {
            let one = cortex(&cue, &[]);
            let mut other = one.clone();
            other.cell = in_units(&one.cell, length, energy, time);
            other.refresh();
            other.rate /= time;
            other.past = vec![one.past[0].map(|x| x * length)];
            let diluted = one.cell.cue.regulator().is_some_and(|regulator| regulator.diluted);
            let Carried { amount, r_u, z_u } = one.carried_past[0];
            let amount = if diluted { amount * length * length } else { amount };
            other.carried_past = vec![Carried { amount, r_u: r_u * length, z_u: z_u * length }];
            let tension = energy / (length * length);
            let mut units = [1.0; REGULATED];
            units[J] = 1.0 / length;
            (units[R], units[Z], units[M], units[V]) = (length, length, energy / length, length / time);
            (units[Q], units[T]) = (tension, tension);
            let (y, p) = state(one.components(), &mut draws);
            let scaled: Vec<f64> = y.iter().zip(units).map(|(y, unit)| y * unit).collect();
            let here = values(&one, &y, &p);
            let there = values(&other, &scaled, &[p[0] * length, p[1] * tension / length]);
            for k in 0..y.len() {
                largest = largest.max((there[k] / units[k] - here[k]).abs() / (1.0 + here[k].abs()));
            }
        }
    }
    within("other units", largest, 1e-11);
}
