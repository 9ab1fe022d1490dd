//! `furrow polarity`: PAR polarity at the sizes of the germline.

use super::cell::{length, load_lineage, one_of, positive, set};
use super::context::Context;
use super::error::CliError;
use super::messages;
use super::output::{number, or_dash, print_as, records_csv, writable_file};
use clap::Args;
use furrow_analysis::polarity::{
    Follows, NamedCell, PolarisedCell, PolarityStudy, PolarityStudyError, germline, polarity,
};
use furrow_formats::write_atomically;
use furrow_input::InputError;
use furrow_lineage::{Length, Units};
use furrow_mechanics::polarity::{
    Chemistry, LENGTH_UM, ParConstants, PolarityError, PolarityLimit, SurfaceToVolume, ZYGOTE_SURFACE_TO_VOLUME,
};
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Constants, in µm and s, by default those of Goehring et al. 2011: d_a, d_p (diffusion), k_on_a, k_on_p (attachment), k_off_a, \
k_off_p (detachment), rho_a, rho_p (amount per volume), k_ap (removal of A by P), k_pa (of P by A), n_p (power of P in the \
removal of A, 1 or 2), and psi, surface per volume: shape (the cell's own, the default) or a number for cells of all sizes, such as \
the 0.174 measured of the zygote.

Examples:
  furrow polarity
  furrow polarity --par psi=0.174 --par d_p=0.1
  furrow polarity --r0 3 --amplitude 0.2 --out profile.csv --json")]
pub struct PolarityArgs {
    /// Radius R0 of one cell, in L_h, or in µm, such as 17um; default the cells of the germline
    #[arg(help_heading = "Cell", long, value_name = "R", value_parser = length)]
    r0: Option<Length>,
    /// Volume of every cell divided by the volume of its shell, ε; default 0.87, the preset's
    #[arg(help_heading = "Cell", long, value_name = "E", value_parser = number)]
    epsilon: Option<f64>,
    /// Activity ξ_s of every cell, as published; default 25, the preset's
    #[arg(help_heading = "Cell", long, value_name = "X", value_parser = number)]
    xi: Option<f64>,
    /// Lineage file with the germline: the first cell, its smaller daughter, and so on; default the built-in one
    #[arg(help_heading = "Cell", long, value_name = "LINEAGE.ron")]
    lineage: Option<PathBuf>,
    /// Sets one constant of the chemistry; repeatable
    #[arg(help_heading = "Chemistry", long, value_name = "KEY=VALUE")]
    par: Vec<String>,
    /// L_h in µm; default from the lineage file, otherwise 3.2
    #[arg(help_heading = "Chemistry", long, value_name = "UM", value_parser = number)]
    length_um: Option<f64>,
    /// Dependence of κ on P: a step at the boundary, with the stiffer side at the pole where P is high, or a band of the same width
    #[arg(help_heading = "Chemistry", long, value_name = "step|band", default_value = "step", hide_possible_values = true,
        value_parser = one_of(Follows::NAMED))]
    profile: Follows,
    /// Relative increase of κ where P is high, or at the boundary
    #[arg(help_heading = "Chemistry", long, value_name = "A", default_value_t = 0.1, value_parser = number)]
    amplitude: f64,
    /// Writes A and P of the polarised cells along the contour as CSV
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    out: Option<PathBuf>,
}

/// The columns of `--out`.
const HEADER: &str = "cell,r0,u,a,p";

pub fn run(args: &PolarityArgs, mut context: Context) -> Result<(), CliError> {
    let amplitude = args.amplitude;
    let allowed = "a finite number above -1: kappa stays positive";
    InputError::require(amplitude.is_finite() && amplitude > -1.0, "--amplitude", "amplitude", amplitude, allowed)?;
    writable_file("--out", args.out.as_deref())?;
    let mut constants = ParConstants::GOEHRING2011;
    args.par.iter().try_for_each(|text| constants.set("--par", text))?;
    let lineage = load_lineage(args.lineage.as_deref())?;
    let of_lineage = lineage.units().length_um.unwrap_or(LENGTH_UM);
    let length_um = args.length_um.map_or(Ok(of_lineage), |um| positive("--length-um", um))?;
    let units = Units { length_um: Some(length_um), ..lineage.units() };
    let r0 = args.r0.map(|r0| r0.in_units(&units));
    let given = [("--r0", "r0", r0), ("--epsilon", "epsilon", args.epsilon), ("--xi", "xi_s", args.xi)];
    set(&context.globals, &mut context.settings, given)?;
    let settings = &context.settings;
    settings.check_divisions("settings")?;
    settings.check_activity(args.xi.map_or("settings", |_| "--xi"))?;
    let cells = match r0 {
        Some(_) => vec![NamedCell { name: None, cell: settings.cell.clone() }],
        None => germline(&lineage, settings)?,
    };
    let chemistry = Chemistry { numerics: settings.numerics, ..Chemistry::new(constants, length_um) };
    let found = polarity(&cells, settings, &chemistry, (args.profile, amplitude))?;
    if let [PolarisedCell { polarity: Err(error), .. }] = &found.cells[..] {
        return Err(PolarityStudyError::from(error.clone()).into());
    }
    for cell in &found.cells {
        if let Some(why) = cell.why() {
            messages::warning!("{}: {why}", name(cell));
        }
    }
    if let Some(file) = &args.out {
        let rows = found.cells.iter().flat_map(|cell| cell.profile.iter().map(move |[u, a, p]| (cell, [u, a, p])));
        let row = |(cell, [u, a, p]): (&PolarisedCell, [&f64; 3])| json!([name(cell), cell.r0, u, a, p]);
        write_atomically(file, &records_csv(HEADER, rows.map(row))?)?;
    }
    let shown = Shown { found: &found, chemistry: &chemistry };
    print_as(context.json, &found.document(&chemistry, amplitude), || shown.text())
}

/// The printed results.
struct Shown<'a> {
    found: &'a PolarityStudy,
    chemistry: &'a Chemistry,
}

/// The name of a cell in tables.
fn name(cell: &PolarisedCell) -> &str {
    cell.name.as_deref().unwrap_or("cell")
}

impl Shown<'_> {
    fn um(&self, r0: f64) -> f64 {
        r0 * self.chemistry.length_um
    }

    fn text(&self) -> String {
        let mut out = format!(
            "{:<6} {:>7}  {:>7}  {:>9}  {:>9}  {:>6}  {:>7}  {:<10}  {:>7}  measured χ\n",
            "cell", "R0", "R0 (µm)", "S/V (/µm)", "polarised", "u0", "ω", "outcome", "χ"
        );
        for cell in &self.found.cells {
            let boundary = match &cell.polarity {
                Ok(Some(found)) => format!("{:>9}  {:>6.4}  {:>7.4}", "yes", found.u0, found.omega),
                Ok(None) => format!("{:>9}  {:>6}  {:>7}", "no", "-", "-"),
                Err(_) => format!("{:>9}  {:>6}  {:>7}", "unknown", "-", "-"),
            };
            let division = cell.division.as_ref().and_then(|division| division.as_ref().ok());
            let outcome = division.map_or("undecided", |division| division.outcome().name());
            // Without a cue the noise determines the side.
            let chi = division
                .and_then(|division| if cell.readings().is_some() { division.chi_signed() } else { division.chi() });
            let chi = or_dash(chi, 4);
            let measured = cell.measured.as_ref().map_or("-".to_owned(), |m| {
                format!(
                    "{:.3}{}",
                    m.mean_signed.unwrap_or(m.mean),
                    m.sd_signed.map_or(String::new(), |sd| format!(" ± {sd:.3} (n = {})", m.n))
                )
            });
            let (name, r0, um) = (name(cell), cell.r0, self.um(cell.r0));
            let ratio = or_dash(cell.surface_to_volume, 4);
            let _ = writeln!(
                out,
                "{name:<6} {r0:>7.4}  {um:>7.2}  {ratio:>9}  {boundary}  {outcome:<10}  {chi:>7}  {measured}"
            );
        }
        out + &self.surface() + &self.limits() + &self.verdict()
    }

    /// The explanation of ψ and of the sign of χ.
    fn surface(&self) -> String {
        let sign = "χ of polarised and of measured cells is positive where the posterior daughter is the smaller\n";
        let psi = match self.chemistry.constants.surface_to_volume {
            SurfaceToVolume::Shape => format!(
                "ψ is S/V, surface over volume of each cell's own passive shape; measured of the zygote: {ZYGOTE_SURFACE_TO_VOLUME} /µm\n"
            ),
            SurfaceToVolume::Fixed(psi) => format!("ψ is {psi} /µm for cells of all sizes\n"),
        };
        psi + sign
    }

    fn limits(&self) -> String {
        let size = |r0: f64| format!("R0 = {r0:.4} ({:.2} µm)", self.um(r0));
        let polarised = |which: &str, limit: &Result<PolarityLimit, PolarityError>| match limit {
            Ok(PolarityLimit { r0, state }) => {
                format!("{which} polarised cell: {}, u0 = {:.4}, ω = {:.4}\n", size(*r0), state.u0, state.omega)
            }
            Err(error) => format!("{which} polarised cell: {error}\n"),
        };
        let mechanics = match &self.found.mechanics {
            Ok(critical) => size(critical.r0),
            Err(error) => error.to_string(),
        };
        polarised("smallest", &self.found.smallest)
            + &polarised("largest", &self.found.largest)
            + &format!("smallest cell that divides without a cue: {mechanics}\n")
    }

    /// One sentence on which limit comes first.
    fn verdict(&self) -> String {
        let PolarityStudy { cells, smallest: Ok(chemistry), mechanics: Ok(mechanics), .. } = self.found else {
            return String::new();
        };
        let too_small = |limit: f64| {
            let names: Vec<&str> = cells.iter().filter(|cell| cell.r0 < limit).map(name).collect();
            if names.is_empty() { "none".to_owned() } else { names.join(", ") }
        };
        let part =
            |what: &str, r0: f64| format!("below R0 = {r0:.4} cells cannot {what} (too small: {})", too_small(r0));
        let [chemical, mechanical] = [part("polarise", chemistry.r0), part("divide", mechanics.r0)];
        if chemistry.r0 > mechanics.r0 {
            format!("Chemistry ends first: {chemical}; {mechanical}.\n")
        } else {
            format!("Mechanics ends first: {mechanical}; {chemical}.\n")
        }
    }
}
