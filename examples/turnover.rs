//! The furrow of a cortex of variable thickness with turnover over the activity of its equator: Borja da Rocha, Bleyer and Turlier, "A viscous
//! active shell theory of the cell cortex" (J. Mech. Phys. Solids 164, 104876, 2022), with the constants of the program that they published
//! (github.com/VirtualEmbryo/active_viscous_shell).
//!
//! `cargo run --release --example turnover -- turnover.svg`

use furrow::{Cell, Law, Numerics};
use furrow_figures::drawing::Format;
use furrow_figures::plot::curves::{self, Curves, Series};
use furrow_mechanics::division::{DivisionInput, divide};
use furrow_mechanics::equilibria::{Branch, BranchOptions, ShapePoint, primary};

/// The cell's radius: lengths are free, and a large cell has little bending and little diffusion.
const R0: f64 = 8.0;
/// Activity away from the equator, ζ/(2μ k_d) with their ζ = 1, μ = 1 and k_d = 4.
const BASAL: f64 = 0.125;
/// Activity of the equator over that elsewhere in their division.
pub const DIVIDES: f64 = 20.0;
/// k_d in their unit of time.
pub const TURNOVER: f64 = 4.0;

/// Bending rigidity and diffusion of the cortex, relative to μ T₀ k_d R0² and k_d R0²: their membrane has neither.
#[derive(Clone, Copy)]
pub struct Small {
    /// κ.
    pub rigidity: f64,
    /// D.
    pub diffusion: f64,
}

/// The values of the figure.
pub const SMALL: Small = Small { rigidity: 1e-3, diffusion: 1e-3 };

/// Their cell, at rest without the band of activity, in a shell so wide and soft that it only holds its place: a free cell slides out of a
/// band that is fixed in space.
pub fn cell(Small { rigidity, diffusion }: Small) -> Result<Cell, Box<dyn std::error::Error>> {
    let law = Law::parse(include_str!("laws/borja_da_rocha2022.ron"), "examples/laws/borja_da_rocha2022.ron")?;
    // The law alone uses the thickness: a coupling of 0.
    let cue = format!("regulator:none,turnover=1,diffusion={},activity=0", diffusion * R0 * R0);
    let mut cell = Cell { epsilon: 0.01, ..Cell::new(R0) }.with_law(law).with_cue(cue.parse()?);
    (cell.shell.aspect, cell.shell.p0, cell.shell.w) = (1.0, 0.03, 3.0);
    cell.material.friction = 1e-6;
    cell.material.kappa = rigidity * R0 * R0;
    // An incompressible fluid of the viscosity μ in a thin layer of the thickness T₀.
    (cell.material.eta_b, cell.material.eta_s) = (3.0, 1.0);
    Ok(cell)
}

/// Activity of the equator over that elsewhere.
fn ratio(xi_s: f64) -> f64 {
    1.0 + xi_s / BASAL
}

/// The mirror-symmetric shapes at rest.
pub fn shapes(small: Small) -> Result<Branch, Box<dyn std::error::Error>> {
    let options = BranchOptions { xi: [0.0, 3.0], contours: true, ..BranchOptions::default() }.with_max_step(0.1);
    Ok(primary::follow(&cell(small)?, &Numerics::default(), &options, |event| event.fold().is_none())?)
}

/// The activity of the equator over that elsewhere at which shapes with a furrow end, and the last of them.
pub fn threshold(small: Small) -> Result<(f64, ShapePoint), Box<dyn std::error::Error>> {
    let fold = shapes(small)?.folds().next().ok_or("no fold")?.point;
    Ok((ratio(fold.xi_s), fold))
}

/// Time of a division with an activity of the equator over that elsewhere, in 1/k_d; `None` if the cell comes to rest.
pub fn division(activity: f64, small: Small) -> Result<Option<f64>, Box<dyn std::error::Error>> {
    let input = DivisionInput::new(Cell { xi_s: BASAL * (activity - 1.0), ..cell(small)? });
    let found = divide(&input)?;
    Ok(found.chi().map(|_| found.t_end))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (rigidity, diffusion) in [(1e-3, 1e-3), (5e-4, 1e-3), (2.5e-4, 1e-3), (1e-4, 1e-3), (1e-3, 2e-3)] {
        let (activity, last) = threshold(Small { rigidity, diffusion })?;
        println!(
            "κ = {rigidity}, D = {diffusion}: furrows at rest up to an equator {activity:.4} times as active, with the radius {:.4} R0",
            last.equator_radius / R0
        );
    }
    for activity in [4.0, DIVIDES] {
        match division(activity, SMALL)? {
            Some(t) => {
                println!("equator {activity} times as active: cut after {t:.2}/k_d, {:.2} of their time", t / TURNOVER)
            }
            None => println!("equator {activity} times as active: rest"),
        }
    }
    let Some(file) = std::env::args().nth(1) else { return Ok(()) };
    let branch = shapes(SMALL)?;
    let fold = branch.folds().next().ok_or("no fold")?.point;
    let places: Vec<[f64; 2]> = branch.points.iter().map(|p| [ratio(p.xi_s), p.equator_radius / R0]).collect();
    let last = places.len().saturating_sub(1);
    let picture = Curves {
        title: "A furrow closes where the equator is active enough\nradius of the furrow of cells at rest".to_owned(),
        axes: [
            ("activity of the equator over that elsewhere".to_owned(), [1.0, 7.0]),
            ("radius of the furrow over R0".to_owned(), [0.0, 1.0]),
        ],
        shapes: [0, last / 2, last]
            .into_iter()
            .map(|k| (format!("{:.1}", places[k][0]), branch.contours[k].clone()))
            .collect(),
        series: vec![Series { name: "at rest".to_owned(), points: places, dashed: false }],
        marks: vec![("end of the shapes at rest".to_owned(), [ratio(fold.xi_s), fold.equator_radius / R0])],
        ..Curves::default()
    };
    let format = Format::of(file.as_ref()).ok_or(Format::ALLOWED)?;
    std::fs::write(file, curves::draw(&picture).bytes(format)?)?;
    Ok(())
}
