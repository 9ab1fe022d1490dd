//! Options that define one cell.

use super::messages;
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::context::{Context, Globals};
use super::output::number;
use furrow_cell::settings::Settings;
use furrow_cell::{Cell, Cue};
use furrow_input::InputError;
use furrow_lineage::units::size_doubt;
use furrow_lineage::{Length, Lineage, Units, parse_cue};

// A cue.
#[derive(Debug, Args)]
#[command(next_help_heading = "Cell")]
pub struct CueArgs {
    /// Polarity cue: none, a name in the lineage file, or terms FIELD:PROFILE,key=value,.. joined by +
    ///
    /// Fields: kappa, activity, xi_s, xi_b, eta_b, eta_s, viscosity, friction, tension. Profiles: band (u0, omega,
    /// amplitude; the name may be omitted), step (the same), gradient (amplitude), par and par_band (amplitude, and
    /// constants of PAR polarity, such as k_ap=0.25, which determine position and width). The width omega is in u, or with
    /// the suffix Lh in L_h. With --three-dimensional a term may act on one side of the axis: at=90deg,spread=60deg.
    ///
    /// One term may be a regulator, which the flow advects: regulator:PROFILE,key=value,.. Its keys: the keys of PROFILE,
    /// its source (PROFILE none: no source); turnover (1/τ); diffusion (L_h²/τ); each field that it changes, as in
    /// activity=0.3, or with saturation tension=30,tension.half=10; and diluted=false for a label, which converging
    /// flow does not concentrate. If the lineage file has units, widths may be in um, turnover in /s, and diffusion in
    /// um2/s.
    #[arg(long, value_name = "CUE", default_value = "none")]
    pub cue: String,
    /// Lineage file with named cues; default the built-in one
    #[arg(long, value_name = "LINEAGE.ron")]
    pub lineage: Option<PathBuf>,
}

impl CueArgs {
    /// The lineage that defines the named cues.
    ///
    /// # Errors
    /// Names the file and the error in it.
    pub fn lineage(&self) -> Result<Lineage, InputError> {
        load_lineage(self.lineage.as_deref())
    }

    /// The cue, and the units of the lineage.
    ///
    /// The built-in lineage has no units and is read only if the cue is one of its named cues: reading it would take a fifth of
    /// the time of a cached division.
    ///
    /// # Errors
    /// Names the file or the part of the cue, and the allowed values.
    fn read(&self) -> Result<(Cue, Units), InputError> {
        let spelled = self.lineage.is_none().then(|| self.cue.parse::<Cue>());
        if let Some(Ok(cue)) = spelled {
            return Ok((cue, Units::default()));
        }
        let lineage = self.lineage()?;
        Ok((parse_cue(&self.cue, &lineage)?, lineage.units()))
    }
}

/// Reads a lineage file, or the built-in one, and warns of suspicious values.
///
/// # Errors
/// As [`Lineage::load`].
pub fn load_lineage(file: Option<&Path>) -> Result<Lineage, InputError> {
    let lineage = Lineage::load(file)?;
    let place = || file.map_or(String::new(), |file| format!("{}: ", file.display()));
    lineage.doubts().iter().for_each(|doubt| messages::warning!("{}{doubt}", place()));
    Ok(lineage)
}

// One cell at any activity.
#[derive(Debug, Args)]
#[command(next_help_heading = "Cell")]
pub struct CellArgs {
    /// Radius R0 of the sphere with the cell's volume, in L_h, or in µm, such as 17um (L_h is 3.2 µm unless the lineage file says
    /// otherwise)
    #[arg(long, value_name = "R", value_parser = length)]
    r0: Length,
    /// Volume of the cell divided by the volume of its shell, ε
    #[arg(long, value_name = "E", value_parser = number)]
    epsilon: Option<f64>,
    #[command(flatten)]
    cue: CueArgs,
}

impl CellArgs {
    /// The cell, with all other parameters from the settings.
    ///
    /// # Errors
    /// Names the option, its value and the allowed values.
    pub fn read(&self, context: &mut Context) -> Result<Cell, InputError> {
        let (cue, units) = self.cue.read()?;
        context.units = units.asked_in(self.r0);
        let r0 = self.r0.in_units(&context.units);
        let given = [("--r0", "r0", Some(r0)), ("--epsilon", "epsilon", self.epsilon)];
        set(&context.globals, &mut context.settings, given)?;
        warn_of_size(&context.units, [self.r0]);
        context.settings.check_cue("--cue", &cue)?;
        let cell = context.settings.cell.clone().with_cue(cue);
        cell.check_law("--cue")?;
        warn_of_regulator(&cell);
        Ok(cell)
    }
}

// One cell at one activity.
#[derive(Debug, Args)]
#[command(next_help_heading = "Cell")]
pub struct ActiveCellArgs {
    #[command(flatten)]
    cell: CellArgs,
    /// Activity ξ_s as published; default 25, the preset's, unless --config or --set changes it
    #[arg(long, value_name = "X", value_parser = number)]
    xi: Option<f64>,
}

impl ActiveCellArgs {
    /// The cell, with all other parameters from the settings.
    ///
    /// # Errors
    /// Names the option, its value and the allowed values.
    pub fn read(&self, context: &mut Context) -> Result<Cell, InputError> {
        set(&context.globals, &mut context.settings, [("--xi", "xi_s", self.xi)])?;
        let cell = self.cell.read(context)?;
        context.settings.check_activity(self.xi.map_or("settings", |_| "--xi"))?;
        Ok(cell)
    }
}

// Options for cells without axial symmetry.
#[derive(Debug, Args)]
#[command(next_help_heading = "Cell")]
pub struct AxisArgs {
    /// Computes cells without axial symmetry: they may bend, and their furrow may close from one side
    #[arg(long)]
    three_dimensional: bool,
    /// Largest azimuthal mode number of a surface, as --set modes=M: modes cos mφ with m up to M; a surface uses as many as its shape
    /// needs; default 4
    #[arg(long, value_name = "M", requires = "three_dimensional", value_parser = clap::value_parser!(u8).range(1..=12))]
    modes: Option<u8>,
}

/// Default of the largest azimuthal mode number of a surface.
const MODES: usize = 4;

impl AxisArgs {
    /// The global options with the settings of these options: `--set` and `--config` may change the default number of modes.
    ///
    /// # Errors
    /// The number of modes is given twice.
    pub fn applied(&self, globals: &Globals) -> Result<Globals, InputError> {
        let mut globals = globals.clone();
        if self.three_dimensional {
            globals.base_modes = MODES;
        }
        if let Some(modes) = self.modes {
            globals.check_once("--modes", "modes")?;
            globals.set.push(format!("modes={modes}"));
        }
        Ok(globals)
    }
}

// The first cell of a lineage, and the constants of all its cells.
#[derive(Debug, Args)]
#[command(next_help_heading = "Cell")]
pub struct FirstCellArgs {
    /// Radius R0 of the first cell, in L_h, or in µm, such as 17um; default the lineage's, otherwise 5.4, the preset's
    #[arg(long, value_name = "R", value_parser = length)]
    pub r0: Option<Length>,
    /// Volume of every cell divided by the volume of its shell, ε; default 0.87, the preset's
    #[arg(long, value_name = "E", value_parser = number)]
    epsilon: Option<f64>,
    /// Activity ξ_s of every cell, as published; default 25, the preset's
    #[arg(long, value_name = "X", value_parser = number)]
    xi: Option<f64>,
}

impl FirstCellArgs {
    /// The settings with the values of the options.
    ///
    /// # Errors
    /// Names the option, its value and the allowed values.
    pub fn settings(&self, context: &Context, units: &Units) -> Result<Settings, InputError> {
        let mut settings = context.settings_in(units)?;
        let r0 = self.r0.map(|r0| r0.in_units(units));
        let given = [("--r0", "r0", r0), ("--epsilon", "epsilon", self.epsilon), ("--xi", "xi_s", self.xi)];
        set(&context.globals, &mut settings, given)?;
        settings.check_activity(self.xi.map_or("settings", |_| "--xi"))?;
        Ok(settings)
    }

    /// The options that are given, with the names of their parameters and their values.
    pub fn given(&self) -> impl Iterator<Item = (&'static str, &'static str, String)> {
        let r0 = self.r0.map(|r0| ("--r0", "r0", r0.to_string()));
        let others = [("--epsilon", "epsilon", self.epsilon), ("--xi", "xi_s", self.xi)];
        let others = others.into_iter().filter_map(|(option, name, value)| Some((option, name, value?.to_string())));
        r0.into_iter().chain(others)
    }
}

/// Sets the parameters of the given options, which `--set` must not set too.
///
/// # Errors
/// Names the option, its value and the allowed values.
pub fn set<const N: usize>(
    globals: &Globals,
    settings: &mut Settings,
    of: [(&str, &str, Option<f64>); N],
) -> Result<(), InputError> {
    let mut given = of.into_iter().filter_map(|(option, name, value)| Some((option, name, value?)));
    given.try_for_each(|(option, name, value)| {
        globals.check_once(option, name)?;
        settings.set_number(option, name, value)
    })
}

/// Reads the length of an option.
///
/// # Errors
/// As [`number`].
pub fn length(text: &str) -> Result<Length, String> {
    let finite = |length: &Length| matches!(length, Length::Natural(x) | Length::Micrometres(x) if x.is_finite());
    let length = text.parse().ok().filter(finite);
    length.ok_or_else(|| "must be a finite number of L_h, as 5.4, or of µm, as 17um".to_owned())
}

/// Warns once of radii far outside the range for which the constants are intended.
pub fn warn_of_size(units: &Units, radii: impl IntoIterator<Item = Length>) {
    if let Some(doubt) = radii.into_iter().find_map(|r0| size_doubt(r0, units)) {
        messages::warning!("{doubt}");
    }
}

/// Warns of a law that uses a regulator if the cell has no regulator.
pub fn warn_of_regulator(cell: &Cell) {
    messages::warn_of(cell.lacks_regulator().map(|doubt| format!("--cue: {doubt}")));
}

/// The description of a cell at the start of the output: size, confinement, activity if given, and law unless it is the built-in one.
pub fn described(cell: &Cell, units: &Units, xi_s: Option<f64>) -> String {
    let size = units.in_micrometres(cell.r0);
    let xi_s = xi_s.map_or(String::new(), |xi_s| format!(", ξ_s = {xi_s}"));
    let law = cell.law.as_ref().map_or(String::new(), |law| format!(", law {}", law.name()));
    format!("R0 = {}{size}, ε = {}{xi_s}{law}", cell.r0, cell.epsilon)
}

/// Reads one of several values by its name.
pub fn one_of<T>(values: impl IntoIterator<Item = (&'static str, T)>) -> impl TypedValueParser<Value = T>
where
    T: Clone + Send + Sync + 'static,
{
    let values: Vec<_> = values.into_iter().collect();
    let names = PossibleValuesParser::new(values.iter().map(|(name, _)| *name));
    names.try_map(move |given| {
        values.iter().find(|(name, _)| *name == given).map(|(_, value)| value.clone()).ok_or("unknown name")
    })
}

/// A finite number above 0 from an option.
///
/// # Errors
/// Names the option, its value and the allowed values.
pub fn positive(option: &str, value: f64) -> Result<f64, InputError> {
    let field = option.trim_start_matches('-').replace('-', "_");
    let not_allowed = || InputError::not_allowed(option, field, value, "a finite number above 0");
    (value.is_finite() && value > 0.0).then_some(value).ok_or_else(not_allowed)
}
