//! The rod u″ + λ sin u = 0 with free ends u′ = 0, straight and buckled: its branches to λ = 100 as a table, or as a picture if a file is
//! named: `cargo run --example diagram -- rod.svg`.

use furrow_bvp::{
    ContinuationSettings, Diagram, DiagramSettings, DualNum, Metric, SimpleProblem, Solution, diagram, mesh,
};

/// Largest λ, and largest |u(0)| in the picture.
const BOUNDS: [f64; 2] = [100.0, 3.2];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rod = SimpleProblem::new(2, |_x, y, p, f| {
        f[0] = y[1];
        f[1] = -p[0] * y[0].sin();
    })
    .scalars(1)
    .left_conditions(1, |y, _p, r| r[0] = y[1])
    .right_conditions(1, |y, _p, r| r[0] = y[1]);
    let start = Solution::constant(4, &mesh::uniform(0.0, 1.0, 30), &[0.0, 0.0], &[5.0]);
    let metric = Metric { components: vec![1.0, 0.0], scalars: vec![0.01] };
    let continuation = ContinuationSettings { max_step: 0.3, ..Default::default() };
    let settings = DiagramSettings { continuation, range: [1.0, BOUNDS[0]], depth: 1, ..Default::default() };
    let found = diagram(&rod, start, &metric, &settings, |y| vec![y.node(0)[0]])?;
    match std::env::args().nth(1) {
        Some(file) => std::fs::write(file, picture(&found))?,
        None => found.write_csv(&mut std::io::stdout().lock(), &["angle"])?,
    }
    Ok(())
}

/// Branches as lines, special points as discs.
fn picture(found: &Diagram) -> String {
    let place =
        |lambda: f64, angle: f64| format!("{:.1},{:.1}", 600.0 * lambda / BOUNDS[0], 200.0 * (1.0 - angle / BOUNDS[1]));
    let mut svg = String::from("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 600 400\">\n");
    for branch in &found.branches {
        let line: Vec<String> = branch.points.iter().map(|point| place(point.parameter, point.observed[0])).collect();
        svg += &format!("<polyline fill=\"none\" stroke=\"#1f5f8b\" points=\"{}\"/>\n", line.join(" "));
    }
    for point in &found.special {
        let at = place(point.parameter, point.observed[0]);
        let title = format!("{:?} at λ = {:.9}", point.kind, point.parameter);
        svg += &format!(
            "<g transform=\"translate({at})\"><circle r=\"4\" fill=\"#c8502b\"><title>{title}</title></circle></g>\n"
        );
    }
    svg + "</svg>\n"
}
