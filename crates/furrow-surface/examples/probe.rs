//! Probe.
use std::time::Instant;
use furrow_bvp::Gauss;
use furrow_cell::{Cell, Numerics};
use furrow_mechanics::cortex::symmetry::unfold;
use furrow_mechanics::equilibria::stationary::stationary;
use furrow_surface::embed::{ContourPoint, embed};
use furrow_bvp::Work;
use furrow_surface::newton::Newton;
use furrow_surface::problem::Problem;
use furrow_surface::space::Space;

fn main() {
    let args: Vec<f64> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    let (r0, xi, elements, modes) = (args[0], args[1], args[2] as usize, args[3] as usize);
    let cell = Cell { xi_s: xi, ..Cell::new(r0) };
    let numerics = Numerics::default();
    let shape = stationary(&cell, &numerics).unwrap();
    println!("axi L {} H {} p {}", shape.length(), shape.elongation(), shape.pressure());
    let full = if shape.cortex.domain == furrow_mechanics::cortex::Domain::Half { unfold(&shape.solution) } else { shape.solution.clone() };
    let gauss = Gauss::new(numerics.stages).unwrap();
    let space = Space::new(elements, modes);
    println!("unknowns {} block {:?}", space.unknowns(), space.blocks[1]);
    let mut problem = Problem::new(&cell, space);
    let shares = problem.mesh.shares(&problem.space);
    let mut state = embed(&problem.space, &shares, shape.pressure(), |u| {
        let mut y = [0.0; 7];
        full.eval(&gauss, u, &mut y);
        ContourPoint { r: y[0], z: y[1], v_r: y[5] * y[3].cos(), v_z: -y[5] * y[3].sin() }
    });
    let (_, length) = problem.speeds(&state.surface);
    problem.mesh.follow(&problem.space, &state.surface, length);
    let t = Instant::now();
    let residual = problem.residual(&state);
    println!("residual {:?} max {:e} vol {:e}", t.elapsed(), residual.balances.iter().fold(0.0f64, |a, b| a.max(b.abs())), residual.volume);
    let t = Instant::now();
    let jacobian = problem.jacobian(&state);
    println!("jacobian {:?}", t.elapsed()); for _ in 0..60 { std::hint::black_box(problem.jacobian(&state)); }
    // against differences
    let n = problem.space.unknowns();
    let mut worst = 0.0f64;
    for k in (0..n).step_by(1 + n / 40) {
        let h = 1e-6;
        let mut e = vec![0.0; n];
        e[k] = h;
        let (mut a, mut b) = (state.clone(), state.clone());
        problem.change(&mut a, &e, 0.0);
        e[k] = -h;
        problem.change(&mut b, &e, 0.0);
        let (ra, rb) = (problem.residual(&a), problem.residual(&b));
        for i in 0..n {
            let d = (ra.balances[i] - rb.balances[i]) / (2.0 * h);
            let j = jacobian.entry(i, k);
            let err = (d - j).abs() / (1.0 + j.abs());
            if err > worst { worst = err; println!("{i} {k}: {d} {j}"); }
        }
        let d = (ra.volume - rb.volume) / (2.0 * h);
        worst = worst.max((d - jacobian.row[k]).abs());
    }
    println!("worst {worst:e}");
    let t = Instant::now();
    let f = jacobian.factor().unwrap();
    println!("factor {:?}", t.elapsed());
    let t = Instant::now();
    let mut x = residual.balances.clone();
    f.solve(&mut x, 0.0);
    println!("solve {:?}", t.elapsed());
    let mut work = Work::default();
    let newton = Newton { tolerance: 1e-10, share: 1.0, iterations: 12, slow: 0.1 };
    let r = problem.solve(&newton, &mut state, &mut None, &mut work);
    let (_, length) = problem.speeds(&state.surface);
    for m in 0..=modes { println!("m {m} {:?}", problem.rates(&state, 4, Some(m)).map(|r| r.iter().map(|r| (r.re, r.im)).collect::<Vec<_>>())); }
    let pole = |u: f64| { let s = problem.space.station(u); let mut f = Vec::new(); problem.space.functions(&state.surface, &s, &mut f); problem.space.shape(&f, &problem.space.meridian(0.0))[0][2] };
    println!("{r:?} {work:?} L {length} H {} p {}", (pole(0.0) - pole(1.0)) / r0, state.pressure);
}
