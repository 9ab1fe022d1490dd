//! Four laws of active stress beside each other: how long a division takes, how its ring closes, and how unequal the daughters are, over
//! the size of the cell, beside what embryos do.
//!
//! `cargo run --release --example laws -- laws-out` prints the tables of docs/book/src/theory/laws.md and writes `laws-out/laws.svg`. Divisions
//! are kept in `laws-out/divisions.csv`: an interrupted run goes on where it ended.

mod embryo;
mod figure;

use std::collections::HashMap;
use std::io::Write;
use std::path::Path;

use furrow::{Cell, Law, Numerics, Parameter};
use furrow_figures::drawing::Format;
use furrow_lineage::batch::Key;
use furrow_measured::statistics::line;
use furrow_mechanics::cortex::observables::equator_radius;
use furrow_mechanics::division::{DivisionInput, DivisionOptions, Frame, divide_with};
use furrow_mechanics::equilibria::{BranchOptions, Criticality, PointKind, primary};

/// Any error of the study.
pub type Fault = Box<dyn std::error::Error>;

/// A law of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Studied {
    /// The paper's.
    Curvature,
    /// Tension along a ring that a carried regulator makes.
    Ring,
    /// A cortex that gains and loses thickness.
    Thickness,
    /// The paper's, with carried tension.
    Both,
}

impl Studied {
    /// Every law.
    pub const ALL: [Studied; 4] = [Studied::Curvature, Studied::Ring, Studied::Thickness, Studied::Both];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        ["curvature", "carried ring", "thickness", "curvature and carried tension"][self as usize]
    }

    fn law(self) -> Result<Option<Law>, Fault> {
        let text = match self {
            Studied::Curvature => return Ok(None),
            Studied::Ring => include_str!("ring.ron"),
            Studied::Thickness => include_str!("thickness.ron"),
            Studied::Both => include_str!("curvature_and_tension.ron"),
        };
        Ok(Some(Law::parse(text, self.name())?))
    }

    /// A cell with this law, without a cue or with one at the published place.
    pub fn cell(self, r0: f64, cued: bool) -> Result<Cell, Fault> {
        let germline = if cued { "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1" } else { "none" };
        let place = if cued { 0.465 } else { 0.5 };
        let cue = match self {
            Studied::Curvature => germline.to_owned(),
            Studied::Ring => format!("regulator:band,u0={place},omega=0.1,amplitude=1,{CARRIED}"),
            Studied::Thickness => format!("regulator:none,{CARRIED}"),
            Studied::Both if cued => format!("regulator:none,{CARRIED}+{germline}"),
            Studied::Both => format!("regulator:none,{CARRIED}"),
        };
        let mut cell = Cell { law: self.law()?.map(Box::new), ..Cell::new(r0) }.with_cue(cue.parse()?);
        if self == Studied::Thickness {
            "law.u0".parse::<Parameter>()?.set(&mut cell, place);
        }
        Ok(cell)
    }
}

/// Turnover and diffusion of what flow carries: 0.04/s and 0.04 µm²/s for τ = 4 min and L_h = 3.2 µm. Only the law knows it.
const CARRIED: &str = "turnover=10,diffusion=1,activity=0";

/// Radii of cells, in L_h.
pub const SIZES: [f64; 12] = [1.8, 2.0, 2.2, 2.4, 2.7, 3.0, 3.4, 3.8, 4.2, 4.6, 5.0, 5.4];

/// Shares of the first radius of the equator at which the ring is timed.
pub const SHARES: [f64; 5] = [0.9, 0.7, 0.5, 0.3, 0.1];

/// R0, ε and threshold ξ_s* of the shapes at which the paper prints one, and whether it is subcritical.
pub const PRINTED: [(f64, f64, f64, bool); 4] =
    [(1.64, 0.87, 25.796, true), (2.0, 0.87, 22.006, false), (2.22, 0.64, 6.24, true), (2.22, 0.88, 21.94, false)];

/// The activity at which symmetric cells begin to divide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold {
    /// ξ_s there.
    pub xi_s: f64,
    /// What happens there.
    pub kind: &'static str,
}

impl Studied {
    /// The threshold of a cell without a cue: the first pitchfork, as the paper prints it, of a law of curvature. The shapes of the others
    /// end in a fold before they lose their symmetry.
    pub fn threshold(self, cell: &Cell) -> Result<Threshold, Fault> {
        let wanted =
            if matches!(self, Studied::Curvature | Studied::Both) { PointKind::Pitchfork } else { PointKind::Fold };
        let options = BranchOptions { xi: [0.0, 150.0], ..BranchOptions::default() };
        let found = primary::follow(cell, &Numerics::default(), &options, |event| event.kind() != wanted)?;
        let event = found.events.iter().find(|event| event.kind() == wanted).ok_or("no threshold up to ξ_s = 150")?;
        let kind = event.pitchfork().map_or("fold", |at| kind(at.criticality() == Criticality::Subcritical));
        Ok(Threshold { xi_s: event.point().xi_s, kind })
    }
}

fn kind(subcritical: bool) -> &'static str {
    if subcritical { "subcritical" } else { "supercritical" }
}

/// The strength at which the harder of two cells, R0 = 2 and the zygote, has the paper's threshold of R0 = 2. A threshold is inversely
/// proportional to it.
pub fn strength(law: Studied) -> Result<f64, Fault> {
    let mut hardest = 0.0f64;
    for r0 in [2.0, 5.4] {
        let mut cell = law.cell(r0, false)?;
        "law.strength".parse::<Parameter>()?.set(&mut cell, 1.0);
        hardest = hardest.max(law.threshold(&cell)?.xi_s);
    }
    Ok(hardest / PRINTED[1].2)
}

/// One division.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Whether it divides.
    pub divided: bool,
    /// χ, if it does.
    pub chi: f64,
    /// Time of pinch-off or rest, in τ.
    pub t_end: f64,
    /// Times at which the radius of the ring is a share of [`SHARES`] of the equator's at first, in τ.
    pub times: [f64; 5],
}

impl Row {
    /// Computes a division.
    pub fn compute(input: &DivisionInput) -> Result<Row, Fault> {
        let mut ring: Vec<[f64; 2]> = Vec::new();
        let mut observe = |frame: Frame<'_>| {
            let radius = frame.neck.map_or_else(|| equator_radius(frame.gauss, frame.shape), |neck| neck.radius);
            ring.push([frame.t, radius]);
        };
        let (division, _) = divide_with(input, DivisionOptions::observed_by(&mut observe))?;
        let first = ring.first().map_or(f64::NAN, |at| at[1]);
        let passed = |share: f64| {
            let step = ring.windows(2).find(|step| step[1][1] < share * first);
            step.map_or(f64::NAN, |step| {
                let [[t, a], [next, b]] = [step[0], step[1]];
                t + (next - t) * (a - share * first) / (a - b)
            })
        };
        let chi = division.chi();
        Ok(Row {
            divided: chi.is_some(),
            chi: chi.unwrap_or(f64::NAN),
            t_end: division.t_end,
            times: SHARES.map(passed),
        })
    }

    /// Speed of the ring between two shares, in first radii per τ.
    pub fn speeds(&self) -> [f64; 4] {
        std::array::from_fn(|k| (SHARES[k] - SHARES[k + 1]) / (self.times[k + 1] - self.times[k]))
    }

    /// Time from the first share to the last, in τ.
    pub fn closing(&self) -> f64 {
        self.times[4] - self.times[0]
    }

    fn numbers(&self) -> Vec<f64> {
        [self.chi, self.t_end].into_iter().chain(self.times).collect()
    }

    fn of(numbers: &[f64]) -> Option<Row> {
        let [chi, t_end, times @ ..] = numbers else { return None };
        Some(Row { divided: chi.is_finite(), chi: *chi, t_end: *t_end, times: times.try_into().ok()? })
    }
}

/// Divisions, kept in a file by the key of their input.
pub struct Kept {
    file: std::fs::File,
    rows: HashMap<String, Row>,
}

impl Kept {
    /// Reads the file, if there is one.
    ///
    /// # Errors
    /// Of a line that is no division.
    pub fn open(path: &Path) -> Result<Kept, Fault> {
        let mut rows = HashMap::new();
        for (k, line) in std::fs::read_to_string(path).unwrap_or_default().lines().enumerate() {
            let (key, numbers) = line.split_once(',').unwrap_or((line, ""));
            let numbers: Result<Vec<f64>, _> = numbers.split(',').map(str::parse).collect();
            let row = numbers.ok().and_then(|numbers| Row::of(&numbers));
            let allowed = "a key, χ, t_end and five times; delete the line to compute it anew";
            rows.insert(
                key.to_owned(),
                row.ok_or_else(|| format!("{}:{}: {line}: must be {allowed}", path.display(), k + 1))?,
            );
        }
        Ok(Kept { file: std::fs::OpenOptions::new().create(true).append(true).open(path)?, rows })
    }

    /// A division, read or computed and written.
    pub fn row(&mut self, input: &DivisionInput) -> Result<Row, Fault> {
        let key: String = Key::new(input).as_bytes().iter().map(|byte| format!("{byte:02x}")).collect();
        if let Some(row) = self.rows.get(&key) {
            return Ok(row.clone());
        }
        let row = Row::compute(input)?;
        let numbers: Vec<String> = row.numbers().iter().map(f64::to_string).collect();
        writeln!(self.file, "{key},{}", numbers.join(","))?;
        self.rows.insert(key, row.clone());
        Ok(row)
    }
}

/// The divisions of a law, without and with a cue, by [`SIZES`].
pub struct Curve {
    /// The law.
    pub law: Studied,
    /// Whether the cells have the cue.
    pub cued: bool,
    /// The divisions.
    pub rows: Vec<Row>,
}

impl Curve {
    /// The exponent of R0 in a time, fitted to the cells that divide.
    fn exponent(&self, time: impl Fn(&Row) -> f64) -> f64 {
        let divided = SIZES.iter().zip(&self.rows).filter(|(_, row)| row.divided);
        let points: Vec<[f64; 2]> = divided.map(|(r0, row)| [r0.ln(), time(row).ln()]).collect();
        line(&points).map_or(f64::NAN, |line| line.slope)
    }
}

fn curves(kept: &mut Kept, finer: bool) -> Result<Vec<Curve>, Fault> {
    let mut out = Vec::new();
    for law in Studied::ALL {
        for cued in [false, true] {
            let mut rows = Vec::new();
            for r0 in SIZES {
                let input = DivisionInput::new(law.cell(r0, cued)?);
                let input = if finer { input.refined().ok_or("no finer mesh")? } else { input };
                rows.push(kept.row(&input).map_err(|error| format!("{}: {error}", law.name()))?);
            }
            out.push(Curve { law, cued, rows });
        }
    }
    Ok(out)
}

fn print_thresholds() -> Result<(), Fault> {
    println!("Thresholds ξ_s* at the paper's four places, and of the zygote.\n");
    println!(
        "| law | strength | R0 = 1.64 | 2.00 | 2.22, ε = 0.64 | 2.22, ε = 0.88 | 5.4 |\n|---|---|---|---|---|---|---|"
    );
    for law in Studied::ALL {
        let strength = if law == Studied::Curvature { "–".to_owned() } else { format!("{:.4}", strength(law)?) };
        let places = PRINTED.iter().map(|(r0, epsilon, ..)| (*r0, *epsilon)).chain([(5.4, 0.87)]);
        let mut words = Vec::new();
        for (r0, epsilon) in places {
            let Threshold { xi_s, kind } = law.threshold(&Cell { epsilon, ..law.cell(r0, false)? })?;
            words.push(format!("{xi_s:.3} {kind}"));
        }
        println!("| {} | {strength} | {} |", law.name(), words.join(" | "));
    }
    let printed: Vec<String> = PRINTED.iter().map(|(.., xi_s, sub)| format!("{xi_s} {}", kind(*sub))).collect();
    println!("| the paper | – | {} | |", printed.join(" | "));
    println!(
        "\nLargest difference from the paper's thresholds over the share of carried tension.\n\n| carried | difference | kinds |\n|---|---|---|"
    );
    for carried in [0.1, 0.2, 0.3, 0.4, 0.5] {
        let mut found = Vec::new();
        for (r0, epsilon, xi_s, sub) in PRINTED {
            let mut cell = Cell { epsilon, ..Studied::Both.cell(r0, false)? };
            "law.carried".parse::<Parameter>()?.set(&mut cell, carried);
            "law.strength".parse::<Parameter>()?.set(&mut cell, 1.0);
            let at = Studied::Both.threshold(&cell)?;
            found.push((at.xi_s / xi_s, at.kind == kind(sub)));
        }
        // The strength makes the second threshold the paper's.
        let worst = found.iter().map(|(ratio, _)| (ratio / found[1].0 - 1.0).abs()).fold(0.0, f64::max);
        let kinds = found.iter().filter(|(_, same)| *same).count();
        println!("| {carried} | {:.1} % | {kinds} of 4 as in the paper |", 100.0 * worst);
    }
    Ok(())
}

fn print_divisions(curves: &[Curve]) {
    println!("\nTime of pinch-off in τ and χ over R0.\n");
    let sizes: Vec<String> = SIZES.iter().map(f64::to_string).collect();
    println!("| law | cue | | {} |\n|---|---|---|{}", sizes.join(" | "), "---|".repeat(SIZES.len()));
    for Curve { law, cued, rows } in curves {
        let cue = if *cued { "yes" } else { "no" };
        let words = |of: &dyn Fn(&Row) -> String| -> String {
            let words = rows.iter().map(|row| if row.divided { of(row) } else { "–".to_owned() });
            words.collect::<Vec<_>>().join(" | ")
        };
        println!("| {} | {cue} | t | {} |", law.name(), words(&|row| format!("{:.2}", row.t_end)));
        println!("| | | χ | {} |", words(&|row| format!("{:.3}", row.chi)));
    }
    println!(
        "\nThe ring of the zygote: speed in first radii per τ, between shares of the first radius. Exponents of R0 over all cells that divide.\n"
    );
    println!(
        "| law | cue | 0.9–0.7 | 0.7–0.5 | 0.5–0.3 | 0.3–0.1 | last/first | exponent of t_end | of the closing from 0.9 to 0.1 |\n|---|---|---|---|---|---|---|---|---|"
    );
    for curve in curves {
        let speeds = curve.rows[SIZES.len() - 1].speeds();
        let words: Vec<String> = speeds.iter().map(|speed| format!("{speed:.2}")).collect();
        let [pinch, closing] = [curve.exponent(|row| row.t_end), curve.exponent(Row::closing)];
        let (name, cue) = (curve.law.name(), if curve.cued { "yes" } else { "no" });
        println!(
            "| {name} | {cue} | {} | {:.2} | {pinch:.2} | {closing:.2} |",
            words.join(" | "),
            speeds[3] / speeds[0]
        );
    }
    let speeds = embryo::RING_SPEEDS;
    let words: Vec<String> = speeds.iter().map(|speed| format!("{speed:.3} a frame")).collect();
    println!("| one embryo | | {} | {:.2} | 0 | 0 |", words.join(" | "), speeds[3] / speeds[0]);
}

fn print_embryo(curves: &[Curve]) -> Result<(), Fault> {
    println!("\nχ of Jankele et al. 2021 (mean ± sd over embryos) beside the laws, interpolated over R0.\n");
    let names: Vec<&str> = Studied::ALL.iter().map(|law| law.name()).collect();
    println!("| mother | R0 | measured | {} |\n|---|---|---|---|---|---|---|", names.join(" | "));
    for measured in embryo::measured()? {
        let of_law = |law: &Studied| {
            let curve = curves.iter().find(|curve| curve.law == *law && curve.cued == measured.germline);
            let chi = curve.and_then(|curve| embryo::interpolated(&curve.rows, measured.r0));
            chi.map_or("–".to_owned(), |chi| format!("{chi:.3}"))
        };
        let words: Vec<String> = Studied::ALL.iter().map(of_law).collect();
        let embryo::Measured { mother, r0, mean, sd, .. } = measured;
        println!("| {mother} | {r0:.2} | {mean:.3} ± {sd:.3} | {} |", words.join(" | "));
    }
    Ok(())
}

/// The largest change over the cells that divide, with the size at which it is.
fn worst(a: &Curve, b: &Curve, change: impl Fn(&Row, &Row) -> f64) -> [f64; 2] {
    let pairs = SIZES.iter().zip(a.rows.iter().zip(&b.rows)).filter(|(_, (a, b))| a.divided && b.divided);
    pairs.map(|(r0, (a, b))| [change(a, b), *r0]).fold([0.0; 2], |most, at| if at[0] > most[0] { at } else { most })
}

fn print_mesh(coarse: &[Curve], fine: &[Curve]) {
    println!(
        "\nLargest changes on twice the mesh, and the size at which they are.\n\n| law | cue | outcomes | χ | t_end | speeds |\n|---|---|---|---|---|---|"
    );
    for (a, b) in coarse.iter().zip(fine) {
        let same = a.rows.iter().zip(&b.rows).all(|(a, b)| a.divided == b.divided);
        let chi = worst(a, b, |a, b| (a.chi - b.chi).abs());
        let relative = [
            worst(a, b, |a, b| (a.t_end / b.t_end - 1.0).abs()),
            worst(a, b, |a, b| {
                let (a, b) = (a.speeds(), b.speeds());
                (0..4).map(|k| (a[k] / b[k] - 1.0).abs()).fold(0.0, f64::max)
            }),
        ];
        let [t_end, speeds] = relative.map(|[change, r0]| format!("{:.2} % at {r0}", 100.0 * change));
        let (name, cue) = (a.law.name(), if a.cued { "yes" } else { "no" });
        let outcomes = if same { "the same" } else { "differ" };
        println!("| {name} | {cue} | {outcomes} | {:.4} at {} | {t_end} | {speeds} |", chi[0], chi[1]);
    }
}

fn main() -> Result<(), Fault> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "laws-out".to_owned());
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    print_thresholds()?;
    let mut kept = Kept::open(&folder.join("divisions.csv"))?;
    let coarse = curves(&mut kept, false)?;
    print_divisions(&coarse);
    print_embryo(&coarse)?;
    print_mesh(&coarse, &curves(&mut kept, true)?);
    let picture = figure::draw(&coarse, &embryo::measured()?);
    std::fs::write(folder.join("laws.svg"), picture.bytes(Format::Svg)?)?;
    std::fs::write(folder.join("laws.png"), picture.bytes(Format::Png)?)?;
    Ok(())
}
