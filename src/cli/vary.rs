//! Options that vary one parameter of a cell over a range.

use super::cell::{CueArgs, length, warn_of_regulator, warn_of_size};
use super::context::Context;
use super::output::number;
use clap::Args;
use furrow_analysis::boundary::over_range;
use furrow_cell::{Cell, Cue, Parameter};
use furrow_input::{InputError, did_you_mean};
use furrow_lineage::{Length, parse_cue};

// A parameter, its range, and the cell.
#[derive(Debug, Args)]
#[command(next_help_heading = "Cell")]
pub struct VaryArgs {
    /// Parameter to vary: r0, epsilon, or any other parameter of a cell in --set; for a cue cue.u0, cue.omega,
    /// cue.amplitude, regulator.turnover and similar names
    #[arg(long, value_name = "NAME")]
    vary: String,
    /// First value of the parameter; for r0 also in µm, such as 5um
    #[arg(long, value_name = "A", value_parser = length)]
    from: Length,
    /// Last value of the parameter
    #[arg(long, value_name = "B", value_parser = length)]
    to: Length,
    /// Radius R0, in L_h, or in µm, such as 17um, if another parameter varies
    #[arg(long, value_name = "R", value_parser = length)]
    r0: Option<Length>,
    /// Volume of the cell divided by the volume of its shell, ε, if another parameter varies
    #[arg(long, value_name = "E", value_parser = number)]
    epsilon: Option<f64>,
    #[command(flatten)]
    pub cue: CueArgs,
}

/// The values of the options.
pub struct Varied {
    /// The cell, at the first value.
    pub cell: Cell,
    /// The parameter.
    pub parameter: Parameter,
    /// First and last value.
    pub range: [f64; 2],
}

impl VaryArgs {
    /// The cell and its parameter.
    ///
    /// # Errors
    /// Names the option, its value and the allowed values.
    pub fn read(&self, context: &mut Context) -> Result<Varied, InputError> {
        let parameter = parameter("--vary", &self.vary)?;
        let allowed = "another parameter: curves and diagrams run over ξ_s as it is";
        InputError::require(parameter != Parameter::XiS, "--vary", "vary", "xi_s", allowed)?;
        let allowed = "a parameter of a cell with axial symmetry";
        InputError::require(parameter != Parameter::Flattening, "--vary", "vary", parameter, allowed)?;
        let given = Given { option: "--vary", parameter, r0: self.r0, epsilon: self.epsilon, xi: None, cue: &self.cue };
        let cell = given.cell(context)?;
        let [from, to] =
            [("--from", self.from), ("--to", self.to)].map(|(option, end)| given.end(option, end, context));
        let range = [from?, to?];
        given.warn_of_size([Some(self.from), Some(self.to)], context);
        given.range(cell, range, context)
    }
}

/// A parameter and the other options of a cell.
pub struct Given<'a> {
    /// The option that names the parameter.
    pub option: &'static str,
    /// The parameter.
    pub parameter: Parameter,
    pub r0: Option<Length>,
    pub epsilon: Option<f64>,
    pub xi: Option<f64>,
    pub cue: &'a CueArgs,
}

impl Given<'_> {
    /// The cell, without a value of the parameter.
    ///
    /// # Errors
    /// Names the option, its value and the allowed values.
    pub fn cell(&self, context: &mut Context) -> Result<Cell, InputError> {
        let parameter = self.parameter;
        let lineage = self.cue.lineage()?;
        context.units = lineage.units();
        context.units = self.r0.map_or(context.units, |r0| context.units.asked_in(r0));
        let r0 = self.r0.map(|r0| r0.in_units(&context.units));
        warn_of_size(&context.units, self.r0);
        let options = [
            ("--r0", Parameter::R0, r0),
            ("--epsilon", Parameter::Epsilon, self.epsilon),
            ("--xi", Parameter::XiS, self.xi),
        ];
        for (option, of, given) in options {
            if let Some(value) = given {
                let allowed = format!("left out where {of} varies: see --from and --to");
                InputError::require(parameter != of, option, of.name(), value, allowed)?;
                context.settings.set_number(option, of.name(), value)?;
            }
            let fine = given.is_some() || of != Parameter::R0 || parameter == of;
            InputError::require(fine, option, of.name(), "absent", format!("given where {parameter} varies"))?;
        }
        let cue = parse_cue(&self.cue.cue, &lineage)?;
        context.settings.check_cue("--cue", &cue)?;
        let cell = context.settings.cell.clone().with_cue(cue);
        cell.check_law("--cue")?;
        warn_of_regulator(&cell);
        let mut allowed = Parameter::allowed_of_cue(&cell.cue);
        if cell.cue == Cue::none() {
            allowed += ": see --cue";
        }
        if let Parameter::Law(_) = parameter {
            let own = cell.law.iter().flat_map(|law| law.parameters()).map(Parameter::name).collect::<Vec<_>>();
            let of_law = if own.is_empty() { String::new() } else { format!(": {}", own.join(", ")) };
            allowed = format!("a constant of the law of --law{of_law}");
        }
        InputError::require(
            parameter.is_of(&cell),
            self.option,
            self.option.trim_start_matches('-'),
            parameter,
            allowed,
        )?;
        Ok(cell)
    }

    /// An end of the parameter's range, in L_h if the parameter is a radius in µm.
    ///
    /// # Errors
    /// The value is a length in µm, but the parameter is not a radius.
    pub fn end(&self, option: &str, end: Length, context: &mut Context) -> Result<f64, InputError> {
        let fine = self.parameter == Parameter::R0 || matches!(end, Length::Natural(_));
        let allowed = "a number: only r0 may be in um";
        InputError::require(fine, option, option.trim_start_matches('-'), end, allowed)?;
        context.units = context.units.asked_in(end);
        Ok(end.in_units(&context.units))
    }

    /// Warns of ends of the range far outside the sizes for which the constants are intended.
    pub fn warn_of_size(&self, ends: [Option<Length>; 2], context: &Context) {
        let ends = ends.into_iter().flatten().filter(|_| self.parameter == Parameter::R0);
        warn_of_size(&context.units, ends);
    }

    /// The cell with its parameter over a range of allowed values.
    ///
    /// # Errors
    /// Names the option, its value and the allowed values.
    pub fn range(&self, cell: Cell, range: [f64; 2], context: &mut Context) -> Result<Varied, InputError> {
        let cell = over_range(&mut context.settings, cell, self.parameter, range, ["--from", "--to"])?;
        Ok(Varied { cell, parameter: self.parameter, range })
    }
}

/// The parameter with the name given by an option.
///
/// # Errors
/// Lists the names.
pub fn parameter(option: &str, name: &str) -> Result<Parameter, InputError> {
    name.parse().map_err(|_| {
        // Curves already run over ξ_s, and they are axisymmetric.
        let unfit = |p: &Parameter| matches!(p, Parameter::XiS | Parameter::Flattening);
        let others = Parameter::ALL.into_iter().filter(|p| option != "--vary" || !unfit(p));
        let names: Vec<&str> = others.map(Parameter::name).collect();
        let nearest = did_you_mean(name, names.iter().copied());
        let allowed = format!("one of {}, {}{nearest}", names.join(", "), Parameter::OF_CUES.join(", "));
        InputError::not_allowed(option, option.trim_start_matches('-'), format!("{name:?}"), allowed)
    })
}
