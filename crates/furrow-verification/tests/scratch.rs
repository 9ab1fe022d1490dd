//! Scratch.
use furrow_cell::cue::*;
use furrow_cell::*;
use furrow_mechanics::division::*;
use furrow_mechanics::cortex::{observables, Domain};
use std::time::Instant;

fn reg(source: Option<(Profile, f64)>, k: f64, d: f64, diluted: bool, field: Field, b: f64) -> Cue {
    let r = Regulator { source: source.map(|(profile, amplitude)| Source { profile, amplitude }), turnover: k, diffusion: d, diluted,
        couplings: vec![Coupling { field, strength: b, half: None }] };
    Cue::with_regulator(vec![], Some(r)).unwrap()
}

#[test]
fn reference() {
    let band = |u0, omega| Profile::Band { u0, omega: Width::Fraction(omega) };
    let step = |u0, omega| Profile::Step { u0, omega: Width::Fraction(omega) };
    let cases = [
        (5.4, reg(Some((band(0.465, 0.0577), 0.1)), 25.0, 1.0, false, Field::Kappa, 1.0), ".2165 .4589 1.114 .096"),
        (4.0, reg(Some((band(0.46, 0.1), 0.3)), 10.0, 1.0, true, Field::Kappa, 1.0), ".1671 .468 .94 .416"),
        (3.0, reg(None, 10.0, 1.0, true, Field::Activity, 0.3), ".0001 .5 .908 .039"),
        (3.0, reg(Some((step(0.45, 0.1), 1.0)), 5.0, 1.0, true, Field::Friction, 1.0), "-.0165 .5033 .808 .258"),
        (1.65, reg(None, 10.0, 1.0, true, Field::Activity, 0.3), "failed phi -.118"),
        (3.0, Cue::none(), "none"), (5.4, Cue::none(), "none"),
        (5.4, Cue::published(), "published"),
        (5.4, reg(Some((band(0.465, 0.0577), 0.1)), 1.0, 0.05, true, Field::Kappa, 1.0), "D .05"),
        (5.4, reg(Some((band(0.465, 0.0577), 0.1)), 100.0, 10., true, Field::Kappa, 1.0), "D 10"),
    ];
    for (tol, n) in [(1e-5, 48), (1e-6, 96), (1e-7, 192)] {
    for (r0, cue, expected) in &cases[..4] {
        let numerics = Numerics { time_tolerance: tol, intervals: n, ..Numerics::default() };
        let input = DivisionInput { numerics, ..DivisionInput::new(Cell::gao2026_thresholds(*r0).with_cue(cue.clone())) };
        let mut last = None;
        let mut note = |f: Frame<'_>| {
            let u = f.neck.map_or(0.5, |n| n.u);
            last = observables::regulator_at(f.gauss, f.shape, Domain::Full, u).map(|phi| (phi, f.shape.intervals()));
        };
        match divide_with(&input, DivisionOptions::observed_by(&mut note)) {
            Ok((d, _)) => println!("{tol} {n} {r0} {expected}: {:?} chi {:?} u {:?} t {:.4} phi {:?} drift {:.1e} {:?}", d.outcome(), d.chi_signed(), d.u_furrow(), d.t_end, last, d.volume_drift, d.work),
            Err(e) => println!("{r0} {expected}: {e}"),
        }
    }}
    for thresholds in [true, false] {
    for (r0, cue, expected) in &cases {
        let cell = if thresholds { Cell::gao2026_thresholds(*r0) } else { Cell::new(*r0) };
        let input = DivisionInput::new(cell.with_cue(cue.clone()));
        let mut last = None;
        let t = Instant::now();
        let d = divide(&input);
        let el = t.elapsed();
        let mut note = |f: Frame<'_>| {
            let u = f.neck.map_or(0.5, |n| n.u);
            last = observables::regulator_at(f.gauss, f.shape, Domain::Full, u).map(|phi| (phi, f.shape.intervals()));
        };
        let _ = divide_with(&input, DivisionOptions::observed_by(&mut note));
        match d {
            Ok(d) => println!("{r0} {expected}: {:?} chi {:?} u {:?} t {:.4} phi {:?} work {:?} {:.1} ms", d.outcome(), d.chi_signed(), d.u_furrow(), d.t_end, (d.phi, last), d.work, el.as_secs_f64()*1e3),
            Err(e) => println!("{r0} {expected}: {e}"),
        }
    }}
    let cell = Cell::gao2026_thresholds(1.65).with_cue(cases[4].1.clone());
    let s = furrow_mechanics::equilibria::stationary::stationary(&cell, &Numerics::default()).unwrap();
    let g = furrow_bvp::Gauss::new(4);
    println!("steady {:?} {:?} {:?}", observables::regulator_at(&g, &s.solution, s.cortex.domain, 0.5), observables::regulator_at(&g, &s.solution, s.cortex.domain, 0.0), s.spectrum().unwrap().values.first());
}

#[test]
fn limit() {
    let band = |u0, omega| Profile::Band { u0, omega: Width::Fraction(omega) };
    for (r0, p, field) in [(5.4, (band(0.465, 0.0577), 0.1), Field::Kappa), (3.0, (Profile::Step { u0: 0.45, omega: Width::Fraction(0.1) }, 1.0), Field::Friction)] {
        let painted = Cue::new(vec![Term { field, profile: p.0, amplitude: p.1 }]).unwrap();
        let d = divide(&DivisionInput::new(Cell::gao2026_thresholds(r0).with_cue(painted))).unwrap();
        println!("painted {r0} {:?} {:?} {}", d.chi_signed(), d.u_furrow(), d.t_end);
        for (k, dd) in [(25., 1.0), (100., 1.0), (400., 1.0), (1600., 1.0), (6400., 1.0), (25600., 1.0), (25., 0.1), (25., 0.3), (25., 3.)] {
            for n in [48, 96] {
            for dil in [false, true] {
            let numerics = Numerics { time_tolerance: if n == 48 {1e-5} else {1e-6}, intervals: n, ..Numerics::default() };
            match divide(&DivisionInput { numerics, ..DivisionInput::new(Cell::gao2026_thresholds(r0).with_cue(reg(Some(p), k, dd, dil, field, 1.0)))}) {
                Ok(d) => println!("{r0} k {k} D {dd} {n} {dil} {:?} {:?} {:.4} {:?}", d.chi_signed(), d.u_furrow(), d.t_end, d.work.rejected),
                Err(e) => println!("{r0} k {k} {n} {dil} {e}"),
            }
            }}
        }
    }
}

#[test]
fn neck() {
    let step = |u0, omega| Profile::Step { u0, omega: Width::Fraction(omega) };
    let cue = reg(Some((step(0.45, 0.1), 1.0)), 5.0, 1.0, true, Field::Friction, 1.0);
    for (tol, n) in [(1e-5, 48), (4e-5,48), (1e-6, 48), (1e-5, 96), (1e-6, 96)] {
        let numerics = Numerics { time_tolerance: tol, intervals: n, ..Numerics::default() };
        let input = DivisionInput { numerics, ..DivisionInput::new(Cell::gao2026_thresholds(3.0).with_cue(cue.clone())) };
        let mut rows = vec![];
        let mut note = |f: Frame<'_>| {
            let Some(neck) = f.neck else { return };
            let i = f.shape.interval_of(neck.u);
            let st: Vec<String> = (0..4).map(|j| format!("{:.4}", f.shape.stage(i, j)[8])).collect();
            rows.push(format!("{:.5} r {:.5} phi {:.4} nodes {:.4} {:.4} stages {:?} j {:.3} h {:.4}", f.t, neck.radius / 3.0,
              observables::regulator_at(f.gauss, f.shape, Domain::Full, neck.u).unwrap(), f.shape.node(i)[8], f.shape.node(i+1)[8], st, f.shape.node(i)[7], f.shape.mesh[i+1]-f.shape.mesh[i]));
        };
        let _ = divide_with(&input, DivisionOptions::observed_by(&mut note));
        println!("{tol} {n}");
        for r in rows.iter().rev().take(9).rev() { println!("{r}"); }
    }
}

#[test]
fn cost() {
    let band = |u0, omega| Profile::Band { u0, omega: Width::Fraction(omega) };
    let step = |u0, omega| Profile::Step { u0, omega: Width::Fraction(omega) };
    let cases = [
        (5.4, Cue::none()), (5.4, Cue::published()),
        (5.4, reg(Some((band(0.465, 0.0577), 0.1)), 25.0, 1.0, true, Field::Kappa, 1.0)),
        (3.0, Cue::none()),
        (3.0, reg(None, 10.0, 1.0, true, Field::Activity, 0.3)),
        (3.0, Cue::new(vec![Term { field: Field::Friction, profile: step(0.45, 0.1), amplitude: 1.0 }]).unwrap()),
        (3.0, reg(Some((step(0.45, 0.1), 1.0)), 5.0, 1.0, true, Field::Friction, 1.0)),
        (4.0, Cue::kappa_band(0.46, 0.1, 0.3)),
        (4.0, reg(Some((band(0.46, 0.1), 0.3)), 10.0, 1.0, true, Field::Kappa, 1.0)),
    ];
    for (r0, cue) in &cases {
        let input = DivisionInput::new(Cell::new(*r0).with_cue(cue.clone()));
        let mut n = 0; let mut note = |f: Frame<'_>| n += f.shape.intervals();
        let _ = divide_with(&input, DivisionOptions::observed_by(&mut note));
        let mut best = f64::INFINITY;
        let mut work = None;
        for _ in 0..40 {
            let t = Instant::now();
            work = Some(divide(&input).unwrap().work);
            best = best.min(t.elapsed().as_secs_f64());
        }
        let w = work.unwrap();
        println!("cost {r0} {:.2} ms {:?} {} mean n {:.1}", best * 1e3, w, cue.regulator().is_some(), n as f64 / w.steps as f64);
    }
}
