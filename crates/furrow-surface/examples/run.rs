//! Run.
use std::time::Instant;
use furrow_bvp::Gauss;
use furrow_cell::{Cell, Cue, Numerics};
use furrow_mechanics::cortex::symmetry::unfold;
use furrow_mechanics::equilibria::passive;
use furrow_surface::embed::{ContourPoint, embed};
use furrow_surface::newton::{Newton, Work};
use furrow_surface::neck::{asymmetry, neck};
use furrow_surface::problem::Problem;
use furrow_surface::space::Space;
use furrow_surface::stepper::Stepper;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let num = |k: usize| args[k].parse::<f64>().unwrap();
    let (r0, cue, elements, modes, tol, amplitude, duration) = (num(0), args[1] != "none", num(2) as usize, num(3) as usize, num(4), num(5), num(6));
    let tmax = args.get(7).map_or(60.0, |_| num(7));
    let mut cell = Cell::new(r0);
    if cue { cell = cell.with_cue(Cue::published()); }
    let numerics = Numerics::default();
    let (half, _) = passive(&cell, &numerics).unwrap();
    let full = unfold(&half);
    let gauss = Gauss::new(numerics.stages).unwrap();
    let space = Space::new(elements, modes);
    let mut problem = Problem::new(&cell.passive(), space).unwrap();
    let shares = problem.mesh.shares(&problem.space);
    let mut state = embed(&problem.space, &shares, full.scalars[1], |u| {
        let mut y = [0.0; 7];
        full.eval(&gauss, u, &mut y);
        ContourPoint { r: y[0], z: y[1], v_r: 0.0, v_z: 0.0 }
    });
    let (_, length) = problem.speeds(&state.surface);
    problem.mesh.follow(&problem.space, &state.surface, length);
    let mut work = Work::default();
    let newton = Newton { tolerance: 1e-7, iterations: 12, slow: 0.1 };
    for k in 0..6 {
        let r = problem.solve(&newton, &mut state, &mut None, &mut work);
        println!("passive {k} {r:?} {work:?} {:.3?}", problem.mesh.density);
        r.unwrap();
        let wanted = problem.wanted_density(&state.surface);
        for (d, w) in problem.mesh.density.iter_mut().zip(wanted) { *d += 0.5 * (w - *d); }
        let (_, length) = problem.speeds(&state.surface);
        problem.mesh.follow(&problem.space, &state.surface, length);
    }
    problem.solve(&newton, &mut state, &mut None, &mut work).unwrap();
    let constants = Problem::new(&cell, problem.space.clone()).unwrap().constants;
    problem.constants = constants;
    // noise
    let mut seed = 12345u64;
    let mut uniform = || { seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0 };
    let mut draws = vec![];
    for m in 0..=modes { for n in 0..=10 { let r = uniform(); draws.push((m, n, if m == 0 && n == 0 { 0.0 } else { amplitude * r })); } }
    let (speeds, length) = problem.speeds(&state.surface);
    let shares = problem.shares(&speeds, length);
    let noise: Vec<f64> = shares.iter().flat_map(|u| problem.space.meridians.iter().map(|mer| 1.0 + draws.iter().map(|(m, n, r)| r * (*n as f64 * std::f64::consts::PI * u).cos() * (*m as f64 * mer.phi).cos()).sum::<f64>()).collect::<Vec<_>>()).collect();
    problem.noise = noise;
    let mut stepper = Stepper::new(problem, state);
    let start = Instant::now();
    let mut dt = 1e-3f64.min(duration / 4.0);
    let mut printed = 0.0;
    let mut previous: Option<(f64, f64)> = None;
    loop {
        let t = stepper.history[0].t;
        if t >= duration && !stepper.problem.noise.is_empty() { stepper.problem.noise.clear(); stepper.forget(); }
        match stepper.attempt(dt) {
            Err(e) => { let c = &stepper.problem.contacts; let touching: Vec<f64> = c.iter().filter(|c| c.pressure > 0.0).map(|c| c.distance / r0).collect(); println!("touch {} min {:.4}", touching.len(), touching.iter().copied().fold(9.0, f64::min)); println!("t {t:.5} dt {dt:.2e} {e}"); dt *= 0.25; stepper.work.rejected += 1; if dt < 1e-9 { break; } }
            Ok((level, error)) => {
                let relative = error.map(|e| e / (r0 * tol));
                if relative.is_some_and(|e| e > 1.5) { dt *= 0.5; stepper.work.rejected += 1; continue; }
                let found = neck(&stepper.problem.space, &level.state.surface);
                let t = level.t;
                stepper.accept(level);
                let mut grow = relative.map_or(1.0, |e| (0.8 / e.max(1e-3).cbrt()).clamp(0.5, 2.0));
                if let (Some(n), Some((tb, rb))) = (found, previous) {
                    let speed = (rb - n.radius) / (t - tb);
                    if speed > 0.0 { grow = grow.min(0.25 * n.radius / speed / dt); }
                }
                if grow > 0.9 && grow < 1.25 { grow = 1.0; }
                if let Some(n) = found { previous = Some((t, n.radius)); }
                if t >= printed || !stepper.problem.contacts.is_empty() || found.is_some_and(|n| n.radius < 0.1 * r0) {
                    let chi = found.map_or(0.0, |n| asymmetry(&stepper.problem.space, &stepper.history[0].state.surface, &n));
                    let c = &stepper.problem.contacts; let touching: Vec<f64> = c.iter().filter(|c| c.pressure > 0.0).map(|c| c.distance / r0).collect(); println!("touch {} min {:.4}", touching.len(), touching.iter().copied().fold(9.0, f64::min)); println!("t {t:.5} dt {dt:.2e} err {:.2} neck {:?} chi {chi:.5} p {:.4} {:?} {:.2?}", relative.unwrap_or(0.0), found.map(|n| [n.u, n.radius / r0, n.offset / r0, n.height / r0]), stepper.history[0].state.pressure, stepper.work, start.elapsed());
                    printed = t * 1.1 + 0.005;
                }
                dt = (dt * grow).min(0.05);
                if t < duration { dt = dt.min(duration - t).max(1e-6); }
                if found.is_some_and(|n| n.radius < 0.01 * r0) || t > tmax { break; }
            }
        }
        if stepper.work.steps > 2000 { break; }
    }
    dump(&stepper.problem.space, &stepper.history[0].state.surface, "/tmp/dump.txt");
}

fn dump(space: &Space, surface: &[f64], path: &str) {
    use std::fmt::Write;
    let mut out = String::new();
    let mut f = Vec::new();
    for phi in [0.0, std::f64::consts::PI * 0.25, std::f64::consts::PI * 0.5, std::f64::consts::PI * 0.75, std::f64::consts::PI] {
        for k in 0..=400 {
            let u = k as f64 / 400.0;
            space.functions(surface, &space.station(u), &mut f);
            let x = space.shape(&f, &space.meridian(phi));
            writeln!(out, "{phi} {u} {} {} {}", x[0][0], x[0][1], x[0][2]).unwrap();
        }
    }
    for k in 1..space.elements * 2 {
        let u = k as f64 / (2 * space.elements) as f64;
        for j in 0..=48 {
            let phi = j as f64 * std::f64::consts::TAU / 48.0;
            space.functions(surface, &space.station(u), &mut f);
            let x = space.shape(&f, &space.meridian(phi));
            writeln!(out, "ring {u} {} {} {}", x[0][0], x[0][1], x[0][2]).unwrap();
        }
    }
    std::fs::write(path, out).unwrap();
}
