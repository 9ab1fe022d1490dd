//! The smallest cell with PAR polarity, on a line and on the surface of a cell, over the diffusion of the PAR proteins: Hubatsch et al., "A
//! cell size threshold limits cell polarity and asymmetric division potential" (Nature Physics 15, 1078, 2019), with the constants of the scripts
//! that they published (github.com/lhcgeneva/PARmodelling).
//!
//! `cargo run --release --example polarity_line -- polarity_line.svg`

use furrow::Cell;
use furrow_figures::drawing::Format;
use furrow_figures::plot::curves::{self, Curves, Series};
use furrow_mechanics::polarity::{Chemistry, LENGTH_UM, ParConstants, PolarityError, Towards};

/// Length over width of an ellipse; half its circumference is their line.
pub const ASPECT: f64 = 27.0 / 15.0;

/// Their constants for two proteins that are alike, which remove each other by the square of the other's concentration, in µm and s.
const ALIKE: ParConstants = ParConstants {
    d_a: 0.1,
    d_p: 0.1,
    k_on_a: 0.006,
    k_on_p: 0.006,
    k_off_a: 0.005,
    k_off_p: 0.005,
    rho_a: 1.01,
    rho_p: 1.0,
    k_ap: 1.0,
    k_pa: 1.0,
    n_p: 2,
    ..ParConstants::GOEHRING2011
};

/// The two sets of constants of their scripts.
#[derive(Clone, Copy)]
pub enum Set {
    /// Two proteins that are alike, with 1 % more of A.
    Alike,
    /// The zygote, of Goehring et al. 2011.
    Zygote,
}

/// A set of constants with the diffusion constants multiplied by a factor.
pub fn chemistry(set: Set, factor: f64) -> Chemistry {
    let constants = match set {
        Set::Alike => ALIKE,
        Set::Zygote => ParConstants::GOEHRING2011,
    };
    let (d_a, d_p) = (factor * constants.d_a, factor * constants.d_p);
    Chemistry::new(ParConstants { d_a, d_p, ..constants }, LENGTH_UM)
}

/// Length of the shortest line with a polarised state, in µm.
pub fn on_line(set: Set, factor: f64) -> Result<f64, PolarityError> {
    Ok(chemistry(set, factor).limit_on_line(ASPECT, Towards::Smaller)?.0)
}

/// Contour length of the smallest polarised cell in the preset's shell, from pole to pole, in µm.
pub fn on_cell(set: Set, factor: f64) -> Result<f64, PolarityError> {
    let chemistry = chemistry(set, factor);
    let limit = chemistry.limit(&Cell::new(1.0), Towards::Smaller)?;
    Ok(chemistry.membrane(&Cell::new(limit.r0))?.length)
}

/// A curve's name, its set, and its threshold by set and factor of the diffusion constants.
type Curve = (&'static str, Set, fn(Set, f64) -> Result<f64, PolarityError>);

const CURVES: [Curve; 4] = [
    ("two alike, line", Set::Alike, on_line),
    ("two alike, cell", Set::Alike, on_cell),
    ("zygote, line", Set::Zygote, on_line),
    ("zygote, cell", Set::Zygote, on_cell),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let factors: Vec<f64> = (1..=9).map(|k| 0.25 * f64::from(k)).collect();
    let mut series = Vec::new();
    for (name, set, limit) in CURVES {
        let mut points = Vec::new();
        for factor in &factors {
            match limit(set, *factor) {
                Ok(length) => {
                    println!("{name}: D × {factor:.2}, smallest contour {length:.3} µm");
                    points.push([factor.sqrt(), length]);
                }
                Err(why) => println!("{name}: D × {factor:.2}: {why}"),
            }
        }
        series.push(Series { name: name.to_owned(), points, dashed: name.ends_with("cell") });
    }
    let Some(file) = std::env::args().nth(1) else { return Ok(()) };
    let picture = Curves {
        title: "The smallest polarised cell over the diffusion of the PAR proteins".to_owned(),
        axes: [
            ("√(D/D₀), D₀ published".to_owned(), [0.0, 1.6]),
            ("contour from pole to pole (µm)".to_owned(), [0.0, 60.0]),
        ],
        series,
        ..Curves::default()
    };
    let format = Format::of(file.as_ref()).ok_or(Format::ALLOWED)?;
    std::fs::write(file, curves::draw(&picture).bytes(format)?)?;
    Ok(())
}
