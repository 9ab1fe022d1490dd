//! Vesicles without and with spontaneous curvature, beside what Seifert, Berndl and Lipowsky (Phys. Rev. A 44, 1182, 1991) found: the
//! shape of least bending energy is prolate above a reduced volume of .65, oblate down to .59, and a stomatocyte below.
//!
//! `cargo run --release --example vesicles -- vesicles.svg`

use std::f64::consts::PI;

use furrow::{Cell, Law, Numerics};
use furrow_figures::drawing::Format;
use furrow_figures::plot::curves::{self, Curves, Series};
use furrow_mechanics::equilibria::{Branch, BranchOptions, Pitchfork, ShapeError, ShapePoint, asymmetric, primary};

/// Energy of a sphere, the unit of energies here.
pub const SPHERE: f64 = 8.0 * PI;

/// Tension at the beginning of each branch, of a sphere.
const TENSION: f64 = 10.0;

/// A vesicle of radius 1 and rigidity 1 in a shell so wide and soft that it only holds its place and chooses whether a branch becomes
/// prolate (`aspect` above 1) or oblate.
fn vesicle(aspect: f64, spontaneous_curvature: f64) -> Result<Cell, Box<dyn std::error::Error>> {
    let law = Law::parse(include_str!("laws/vesicle.ron"), "examples/laws/vesicle.ron")?;
    let mut cell = Cell::new(1.0).with_law(law);
    cell.epsilon = 0.01;
    (cell.shell.aspect, cell.shell.p0, cell.shell.w) = (aspect, 1e-2, 3.0);
    cell.material.tension = TENSION;
    cell.material.spontaneous_curvature = spontaneous_curvature;
    Ok(cell)
}

fn options(until: Option<f64>) -> BranchOptions {
    BranchOptions { xi: [0.0, 60.0], reduced_volume: until, points: 3000, contours: true, ..BranchOptions::default() }
        .with_max_step(0.4)
}

/// A family of shapes, down to a reduced volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Cigars.
    Prolate,
    /// Discs, dented where the reduced volume is small.
    Oblate,
    /// Cups.
    Stomatocyte,
}

/// The vesicles without spontaneous curvature.
pub struct Vesicles {
    oblate: Cell,
    prolate: Cell,
    /// Where stomatocytes branch off.
    pub stomatocytes: Pitchfork,
}

impl Vesicles {
    /// Finds where stomatocytes branch off.
    pub fn new() -> Result<Vesicles, Box<dyn std::error::Error>> {
        let oblate = vesicle(0.6, 0.0)?;
        let branch = primary::follow(&oblate, &numerics(), &options(None), |event| event.pitchfork().is_none())?;
        let stomatocytes = branch.pitchforks().next().ok_or("no stomatocytes")?.clone();
        Ok(Vesicles { oblate, prolate: vesicle(1.5, 0.0)?, stomatocytes })
    }

    /// A family down to a reduced volume. Stomatocytes begin as unstable shapes of .51 and rise to .66 before they fall.
    pub fn family(&self, family: Family, until: f64) -> Result<Branch, ShapeError> {
        let options = options(Some(until));
        match family {
            Family::Prolate => primary::follow(&self.prolate, &numerics(), &options, |_| true),
            Family::Oblate => primary::follow(&self.oblate, &numerics(), &options, |_| true),
            Family::Stomatocyte => Ok(asymmetric::follow(&self.stomatocytes, &self.oblate, &options).branch),
        }
    }

    /// The shape of a family at a reduced volume.
    pub fn shape(&self, family: Family, volume: f64) -> Result<ShapePoint, Box<dyn std::error::Error>> {
        let branch = self.family(family, volume)?;
        let last = branch.points.last().filter(|point| (point.reduced_volume - volume).abs() < 1e-5);
        Ok(*last.ok_or_else(|| format!("no {family:?} of reduced volume {volume}: {}", branch.ended))?)
    }

    /// The reduced volume between two others at which two families have the same energy, by the secant rule.
    pub fn coexist(&self, [a, b]: [Family; 2], ends: [f64; 2]) -> Result<f64, Box<dyn std::error::Error>> {
        let difference = |volume: f64| -> Result<f64, Box<dyn std::error::Error>> {
            Ok(self.shape(a, volume)?.bending_energy - self.shape(b, volume)?.bending_energy)
        };
        let [mut from, mut to] = [(ends[0], difference(ends[0])?), (ends[1], difference(ends[1])?)];
        while (to.0 - from.0).abs() > 1e-6 {
            let next = to.0 - to.1 * (to.0 - from.0) / (to.1 - from.1);
            (from, to) = (to, (next, difference(next)?));
        }
        Ok(to.0)
    }
}

/// The mesh: stomatocytes have a narrow opening.
fn numerics() -> Numerics {
    Numerics { intervals: 96, ..Numerics::default() }
}

/// A bud on a vesicle with spontaneous curvature.
#[derive(Clone, Debug)]
pub struct Bud {
    /// Radius of the neck.
    pub neck: f64,
    /// Radii of the spheres with the volumes on both sides of the neck.
    pub radii: [f64; 2],
    /// Its contour.
    pub contour: Vec<[f64; 2]>,
}

/// Pears of a vesicle with spontaneous curvature, as their neck closes. Prolate shapes become pears where they lose their mirror symmetry.
pub fn buds(spontaneous_curvature: f64) -> Result<Vec<Bud>, Box<dyn std::error::Error>> {
    let mut cell = vesicle(1.5, spontaneous_curvature)?;
    // A pear that moves along the axis as its neck closes is held harder.
    cell.shell.p0 = 1.0;
    let prolate = primary::follow(&cell, &numerics(), &options(None), |event| event.pitchfork().is_none())?;
    let pitchfork = prolate.pitchforks().next().ok_or("no pears")?;
    let pears = asymmetric::follow(pitchfork, &cell, &options(None)).branch;
    Ok(pears.contours.into_iter().filter_map(bud).collect())
}

/// The bud of a contour, if it has a neck.
fn bud(contour: Vec<[f64; 2]>) -> Option<Bud> {
    let narrow = |&k: &usize| contour[k][0] < contour[k - 1][0] && contour[k][0] <= contour[k + 1][0];
    let neck = (1..contour.len() - 1).filter(narrow).min_by(|&i, &j| contour[i][0].total_cmp(&contour[j][0]))?;
    // Between two rings lies a truncated cone.
    let cone = |ends: &[[f64; 2]]| {
        let [a, b] = [ends[0], ends[1]];
        PI / 3.0 * (a[1] - b[1]) * (a[0] * a[0] + a[0] * b[0] + b[0] * b[0])
    };
    let radii =
        [&contour[..=neck], &contour[neck..]].map(|part| (0.75 / PI * part.windows(2).map(cone).sum::<f64>()).cbrt());
    Some(Bud { neck: contour[neck][0], radii, contour })
}

/// The curve of a family over reduced volume: the stable part, and the unstable one before it.
fn series(name: &str, branch: &Branch) -> Vec<Series> {
    let points: Vec<[f64; 2]> = branch.points.iter().map(|p| [p.reduced_volume, p.bending_energy / SPHERE]).collect();
    let turn = (0..points.len()).max_by(|&i, &j| points[i][0].total_cmp(&points[j][0])).unwrap_or(0);
    let of = |points: &[[f64; 2]], dashed| Series { name: name.to_owned(), points: points.to_vec(), dashed };
    vec![of(&points[..=turn], true), of(&points[turn..], false)]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    use Family::{Oblate, Prolate, Stomatocyte};
    let vesicles = Vesicles::new()?;
    let first = vesicles.coexist([Prolate, Oblate], [0.64, 0.66])?;
    let second = vesicles.coexist([Stomatocyte, Oblate], [0.58, 0.6])?;
    let begin = vesicles.stomatocytes.point;
    println!("prolate and oblate shapes have the same energy at v = {first:.5}");
    println!("oblate shapes and stomatocytes have the same energy at v = {second:.5}");
    println!("stomatocytes branch off at v = {:.5}", begin.reduced_volume);
    let buds = buds(3.0)?;
    for bud in buds.iter().filter(|bud| bud.neck < 0.1).step_by(40) {
        let [a, b] = bud.radii;
        println!("C0 = 3: neck {:.4}, radii {a:.4} and {b:.4}, 1/R1 + 1/R2 = {:.3}", bud.neck, 1.0 / a + 1.0 / b);
    }
    let Some(file) = std::env::args().nth(1) else { return Ok(()) };
    let families = [("prolate", Prolate, 0.45), ("oblate", Oblate, 0.51), ("stomatocyte", Stomatocyte, 0.45)];
    let mut curves = Vec::new();
    for (name, family, until) in families {
        curves.extend(series(name, &vesicles.family(family, until)?));
    }
    let mut shapes = Vec::new();
    for (name, family, volume) in [
        ("prolate", Prolate, first),
        ("oblate", Oblate, first),
        ("oblate", Oblate, second),
        ("stomatocyte", Stomatocyte, second),
    ] {
        let contour = vesicles.family(family, volume)?.contours.pop().ok_or("no contour")?;
        shapes.push((format!("{name}, v = {volume:.3}"), contour));
    }
    shapes.extend(buds.last().map(|bud| ("bud, C0 = 3".to_owned(), bud.contour.clone())));
    let energy = |family, volume| vesicles.shape(family, volume).map(|shape| shape.bending_energy / SPHERE);
    let picture = Curves {
        title: "Vesicles: bending energy over reduced volume\ndashed: unstable".to_owned(),
        axes: [("reduced volume v".to_owned(), [0.44, 1.0]), ("bending energy / 8πκ".to_owned(), [0.95, 2.45])],
        series: curves,
        marks: vec![
            (format!("v = {first:.4}"), [first, energy(Oblate, first)?]),
            (format!("v = {second:.4}"), [second, energy(Oblate, second)?]),
            (format!("v = {:.4}", begin.reduced_volume), [begin.reduced_volume, begin.bending_energy / SPHERE]),
        ],
        shapes,
        ..Curves::default()
    };
    let format = Format::of(file.as_ref()).ok_or(Format::ALLOWED)?;
    std::fs::write(file, curves::draw(&picture).bytes(format)?)?;
    Ok(())
}
