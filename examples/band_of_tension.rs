//! A cortex with a band of higher tension: Bächer, Khoromskaia, Salbreux and Gekle, "A three-dimensional numerical model of an active cell cortex in
//! the viscous limit" (Front. Phys. 9, 753230, 2021), with the constants of their axisymmetric program
//! (github.com/DianaKhoromskaia/AxisymCortex).
//!
//! `cargo run --release --example band_of_tension -- band_of_tension.svg`

use furrow::{Cell, Law, Numerics, Parameter};
use furrow_figures::drawing::Format;
use furrow_figures::plot::curves::{self, Curves, Series};
use furrow_mechanics::division::{DivisionInput, Trajectory, divide};
use furrow_mechanics::equilibria::{Branch, BranchOptions, primary};

/// The cell's radius: lengths are free, and a large cell has little bending.
pub const R0: f64 = 8.0;
/// Their steepness of the band.
const STEEPNESS: f64 = 10.0;
/// Bending rigidity in units of tension times R0². Their membrane has none.
pub const RIGIDITY: f64 = 1e-3;

/// Their cell with the tension 1, in a shell so wide and soft that it only holds its place. ξ_s is the excess of tension on the equator, and
/// `power` says how abruptly the band ends.
pub fn cell(power: f64, rigidity: f64) -> Result<Cell, Box<dyn std::error::Error>> {
    let law = Law::parse(include_str!("laws/bacher2021.ron"), "examples/laws/bacher2021.ron")?;
    let mut cell = Cell { epsilon: 0.01, ..Cell::new(R0) }.with_law(law);
    "law.power".parse::<Parameter>()?.set(&mut cell, power);
    (cell.shell.aspect, cell.shell.p0, cell.shell.w) = (1.0, 1e-4, 3.0);
    (cell.material.friction, cell.material.tension, cell.material.kappa) = (1e-6, 1.0, rigidity * R0 * R0);
    Ok(cell)
}

/// The mirror-symmetric shapes at rest.
pub fn shapes(power: f64, rigidity: f64) -> Result<Branch, Box<dyn std::error::Error>> {
    let options = BranchOptions { xi: [0.0, 20.0], contours: true, ..BranchOptions::default() }.with_max_step(0.5);
    Ok(primary::follow(&cell(power, rigidity)?, &Numerics::default(), &options, |event| event.fold().is_none())?)
}

/// The excess of tension at which shapes with a furrow end.
pub fn threshold(power: f64, rigidity: f64) -> Result<f64, Box<dyn std::error::Error>> {
    Ok(shapes(power, rigidity)?.folds().next().ok_or("no fold")?.point.xi_s)
}

/// The flow at the beginning.
pub struct Start {
    /// The pressure and the exact one, in units of tension over R0.
    pub pressure: [f64; 2],
    /// The largest tangential velocity, and the largest difference of the normal velocity from the exact one, over the largest
    /// normal velocity.
    pub off: [f64; 2],
}

/// Compares the first velocities with the exact ones of a sphere, on which bending exerts no force: no tangential flow, and the normal velocity
/// (⟨ζ⟩ − ζ)R0/(2η_b) for a tension ζ with the mean ⟨ζ⟩ over the surface.
pub fn start(power: f64, excess: f64) -> Result<Start, Box<dyn std::error::Error>> {
    let mut input = DivisionInput::new(Cell { xi_s: excess, ..cell(power, RIGIDITY)? });
    (input.numerics.noise, input.numerics.first_step) = (1e-6, 1e-4);
    let film = Trajectory::compute(&input)?;
    let first = film.step(1);
    let tension = |angle: f64| 1.0 + excess * (-STEEPNESS * angle.abs().powf(power)).exp();
    // By the midpoint rule; the area between two circles of latitude is their distance along the axis.
    let count = 4000;
    let height = |k: usize| (k as f64 + 0.5) / count as f64;
    let mean = (0..count).map(|k| tension(height(k).asin())).sum::<f64>() / count as f64;
    let exact = |u: f64| 0.5 * (mean - tension(std::f64::consts::PI * (u - 0.5))) * R0;
    let largest = |of: &dyn Fn(usize) -> f64| (0..first.places.len()).fold(0.0f64, |most, k| most.max(of(k).abs()));
    let size = largest(&|k| exact(first.places[k].u));
    let off = [largest(&|k| first.places[k].v), largest(&|k| first.places[k].v_n - exact(first.places[k].u))];
    Ok(Start { pressure: [first.pressure * R0, 2.0 * mean], off: off.map(|x| x / size) })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Start { pressure: [found, exact], off: [along, outwards] } = start(2.0, 3.0)?;
    println!(
        "at the beginning: pressure {found:.4}, exact {exact:.4}; tangential flow {along:.1e}, normal flow off by {outwards:.1e}"
    );
    let mut series = Vec::new();
    let mut marks = Vec::new();
    let mut contours = Vec::new();
    for power in [2.0, 4.0] {
        let branch = shapes(power, RIGIDITY)?;
        let fold = branch.folds().next().ok_or("no fold")?.point;
        println!(
            "power {power}: furrows at rest up to an excess of {:.3}; with a tenth of the rigidity {:.3}",
            fold.xi_s,
            threshold(power, 0.1 * RIGIDITY)?
        );
        for excess in [0.8 * fold.xi_s, 1.3 * fold.xi_s] {
            let found = divide(&DivisionInput::new(Cell { xi_s: excess, ..cell(power, RIGIDITY)? }))?;
            let end = if found.chi().is_some() { "cut" } else { "rest" };
            println!("power {power}, excess {excess:.2}: {end} at {:.2} η/γ", found.t_end);
        }
        let points: Vec<[f64; 2]> = branch.points.iter().map(|p| [p.xi_s, p.equator_radius / R0]).collect();
        contours.extend(branch.contours.last().map(|last| (format!("power {power}"), last.clone())));
        series.push(Series { name: format!("power {power}"), points, dashed: power > 2.0 });
        marks.push((format!("end, power {power}"), [fold.xi_s, fold.equator_radius / R0]));
    }
    let Some(file) = std::env::args().nth(1) else { return Ok(()) };
    let picture = Curves {
        title:
            "A band of tension furrows a cell, and cuts it where it is strong\nradius of the furrow of cells at rest"
                .to_owned(),
        axes: [
            ("excess of tension on the equator over that elsewhere".to_owned(), [0.0, 9.0]),
            ("radius of the furrow over R0".to_owned(), [0.0, 1.0]),
        ],
        series,
        marks,
        shapes: contours,
        ..Curves::default()
    };
    let format = Format::of(file.as_ref()).ok_or(Format::ALLOWED)?;
    std::fs::write(file, curves::draw(&picture).bytes(format)?)?;
    Ok(())
}
