//! A shell breaks the symmetry of a dividing cell with tension that follows a regulator: Gao, Mietke and Ma, "Confinement-induced symmetry
//! breaking of active surfaces" (arXiv 2602.21519), with the constants of the scripts that they published
//! (github.com/ruima86/Confinement-symmetry-breaking).
//!
//! `cargo run --release --example confinement -- confinement.svg`

use furrow::{Cell, Law, Numerics};
use furrow_figures::drawing::Format;
use furrow_figures::plot::curves::{self, Curves, Series};
use furrow_mechanics::division::{DivisionInput, Snapshot, Trajectory};
use furrow_mechanics::equilibria::{Branch, BranchOptions, PointKind, ShapeError, asymmetric, primary};

/// Their radius of the cell; friction, viscosities, rigidity and diffusion give the units.
const R0: f64 = 3.0;
/// Their scale of activity: a tension at the resting concentration of ηD/R0².
pub const PECLET: f64 = (1.0 + 100.0) / (R0 * R0);
/// ε of figure 3a, from the half axes 3.1936 and 1.3 · 3.1936 of the script.
pub const FIGURE_3A: f64 = 0.637_644_845;
/// ε of figure 1b, from the half axes 3.5 and 1.3 · 3.5.
pub const FIGURE_1B: f64 = 0.484_413_546;
/// Activity of figure 1b.
const DIVIDES: f64 = 150.0;
/// The opposite sides of a neck of this radius repel each other in their model.
const CONTACT: f64 = 0.1;

/// The cell in a shell that is 1/ε times as large. Its regulator has five times its resting concentration at the equator.
pub fn cell(epsilon: f64) -> Result<Cell, Box<dyn std::error::Error>> {
    let law = Law::parse(include_str!("laws/gao_mietke_ma2026.ron"), "examples/laws/gao_mietke_ma2026.ron")?;
    // The law alone uses the regulator: a coupling of 0.
    let source = format!("band,u0=0.5,omega={},amplitude=4", 50f64.powf(-0.5));
    let cue = format!("regulator:{source},turnover=5,diffusion=1,activity=0");
    let mut cell = Cell { epsilon, ..Cell::new(R0) }.with_law(law).with_cue(cue.parse()?);
    (cell.shell.aspect, cell.shell.p0, cell.shell.w) = (1.3, 0.1, 50f64.powf(-0.5));
    cell.material.friction = 0.01;
    Ok(cell)
}

/// How branches are followed.
pub fn options() -> BranchOptions {
    BranchOptions { xi: [0.0, 150.0], contours: true, ..BranchOptions::default() }.with_max_step(0.5)
}

/// The mirror-symmetric shapes of a cell, and the asymmetric ones of its first pitchfork.
pub fn branches(cell: &Cell) -> Result<(Branch, Option<Branch>), ShapeError> {
    let symmetric = primary::follow(cell, &Numerics::default(), &options(), |_| true)?;
    let asymmetric = symmetric.pitchforks().next().map(|found| asymmetric::follow(found, cell, &options()).branch);
    Ok((symmetric, asymmetric))
}

/// Whether symmetric shapes lose their symmetry, in a pitchfork, before they end, in a fold.
pub fn breaks(epsilon: f64) -> Result<bool, Box<dyn std::error::Error>> {
    let found = primary::follow(&cell(epsilon)?, &Numerics::default(), &options(), |_| false)?;
    let first = found.events.first().ok_or("neither a fold nor a pitchfork")?;
    Ok(first.kind() == PointKind::Pitchfork)
}

/// The confinement from which on they do, between two others, by halving.
pub fn critical(mut ends: [f64; 2]) -> Result<f64, Box<dyn std::error::Error>> {
    while ends[1] - ends[0] > 1e-3 {
        let middle = 0.5 * (ends[0] + ends[1]);
        ends[usize::from(breaks(middle)?)] = middle;
    }
    Ok(0.5 * (ends[0] + ends[1]))
}

/// A cell as its furrow closes.
pub struct Constriction {
    /// When the neck has the radius at which its sides touch, in τ.
    pub t: f64,
    /// (V_above − V_below)/V then.
    pub asymmetry: f64,
    /// Contours at the beginning, half-way and then.
    pub contours: [Vec<[f64; 2]>; 3],
}

/// The division of figure 1b.
pub fn constriction() -> Result<Constriction, Box<dyn std::error::Error>> {
    let input = DivisionInput::new(Cell { xi_s: DIVIDES, ..cell(FIGURE_1B)? });
    let film = Trajectory::compute(&input)?;
    let frames: Vec<Snapshot> = (0..film.times().len()).map(|step| film.step(step)).collect();
    let narrow = |radius: f64| frames.iter().position(|f| f.neck.is_some_and(|neck| neck.radius < radius));
    let (half, end) = narrow(0.5 * R0).zip(narrow(CONTACT)).ok_or("the furrow does not close")?;
    let contours = [0, half, end].map(|k| frames[k].contour());
    Ok(Constriction { t: frames[end].t, asymmetry: frames[end].asymmetry, contours })
}

fn series(name: &str, branch: &Branch) -> Series {
    let points = branch.points.iter().map(|point| [point.xi_s / PECLET, point.elongation]).collect();
    Series { name: name.to_owned(), points, dashed: false }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (loose, _) = branches(&cell(FIGURE_3A)?)?;
    let fold = loose.folds().next().ok_or("no fold")?.point;
    let longest = loose.points.iter().fold(0.0f64, |most, point| most.max(point.elongation));
    println!(
        "ε = {FIGURE_3A:.4}: fold at ξ = {:.4}, Pe = {:.4}; longest shape H = {:.5}",
        fold.xi_s,
        fold.xi_s / PECLET,
        longest * R0
    );
    println!("symmetric shapes lose their symmetry before they end from ε = {:.4} on", critical([0.68, 0.71])?);
    let tight = 0.75;
    let (symmetric, asymmetric) = branches(&cell(tight)?)?;
    let asymmetric = asymmetric.ok_or("no pitchfork")?;
    let pitchfork = symmetric.pitchforks().next().ok_or("no pitchfork")?.point;
    println!("ε = {tight}: pitchfork at ξ = {:.4}, Pe = {:.4}", pitchfork.xi_s, pitchfork.xi_s / PECLET);
    let Constriction { t, asymmetry, contours } = constriction()?;
    println!("ε = {FIGURE_1B:.4}, ξ = {DIVIDES}: the sides of the neck touch at t = {t:.4} τ, χ = {asymmetry:.1e}");
    let Some(file) = std::env::args().nth(1) else { return Ok(()) };
    let [a, b, c] = contours;
    let mut shapes = vec![
        ("ε = 0.484, t = 0".to_owned(), a),
        ("ε = 0.484, half-way".to_owned(), b),
        (format!("ε = 0.484, t = {t:.2} τ"), c),
    ];
    shapes.extend(asymmetric.contours.last().map(|last| (format!("ε = {tight}, asymmetric"), last.clone())));
    let picture = Curves {
        title: "A shell breaks the symmetry of a cell with saturating tension\nelongation of its stationary shapes over activity".to_owned(),
        axes: [("activity Pe".to_owned(), [0.0, 5.0]), ("elongation H".to_owned(), [1.95, 2.8])],
        series: vec![
            series("symmetric, ε = 0.638", &loose),
            series("symmetric, ε = 0.75", &symmetric),
            series("asymmetric, ε = 0.75", &asymmetric),
        ],
        marks: vec![
            ("fold".to_owned(), [fold.xi_s / PECLET, fold.elongation]),
            ("pitchfork".to_owned(), [pitchfork.xi_s / PECLET, pitchfork.elongation]),
        ],
        shapes,
        ..Curves::default()
    };
    let format = Format::of(file.as_ref()).ok_or(Format::ALLOWED)?;
    std::fs::write(file, curves::draw(&picture).bytes(format)?)?;
    Ok(())
}
