//! Options that let one parameter of a cell run over a range.

use super::cell::{CueArgs, length, natural};
use super::context::Context;
use super::output::number;
use clap::Args;
use furrow_cell::{Cell, Parameter};
use furrow_input::{InputError, did_you_mean};
use furrow_lineage::{Length, parse_cue};

// A parameter, its range, and the cell it is varied of.
#[derive(Debug, Args)]
#[command(next_help_heading = "Cell")]
pub struct VaryArgs {
    /// Parameter that varies: r0, epsilon, or any other parameter of a cell in --set; for a cue cue.u0, cue.omega or
    /// cue.amplitude
    #[arg(long, value_name = "NAME")]
    vary: String,
    /// First value of the parameter
    #[arg(long, value_name = "A", allow_negative_numbers = true, value_parser = number)]
    from: f64,
    /// Last value of the parameter
    #[arg(long, value_name = "B", allow_negative_numbers = true, value_parser = number)]
    to: f64,
    /// Radius R0, if another parameter varies
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = length)]
    r0: Option<Length>,
    /// Volume fraction ε, if another parameter varies
    #[arg(long, value_name = "E", allow_negative_numbers = true, value_parser = number)]
    epsilon: Option<f64>,
    #[command(flatten)]
    pub cue: CueArgs,
}

/// Values at which a cue is checked over the range of one of its numbers.
const STEPS: u32 = 64;

/// What the options say.
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
    /// Names the option, its value and what is allowed.
    pub fn read(&self, context: &mut Context) -> Result<Varied, InputError> {
        let parameter = self.parameter()?;
        let lineage = self.cue.lineage()?;
        let r0 = self.r0.map(|r0| natural("--r0", r0, &lineage.units())).transpose()?;
        for (option, of, given) in [("--r0", Parameter::R0, r0), ("--epsilon", Parameter::Epsilon, self.epsilon)] {
            if let Some(value) = given {
                let allowed = format!("left out where {of} varies: see --from and --to");
                InputError::require(parameter != of, option, of.name(), value, allowed)?;
                context.settings.set_number(option, of.name(), value)?;
            }
            let fine = given.is_some() || of != Parameter::R0 || parameter == of;
            InputError::require(fine, option, of.name(), "absent", format!("given where {parameter} varies"))?;
        }
        let mut cell = context.settings.cell.clone().with_cue(parse_cue(&self.cue.cue, &lineage)?);
        let allowed = match cell.cue.terms() {
            [] => "a number of a cue, and none is given: see --cue".to_owned(),
            terms => format!("a number of the cue's terms, cue[0] to cue[{}]: {}", terms.len() - 1, cell.cue),
        };
        InputError::require(parameter.is_of(&cell), "--vary", "vary", parameter, allowed)?;
        for (option, value) in [("--to", self.to), ("--from", self.from)] {
            if let Parameter::Cue { .. } = parameter {
                // On the way as well: two bands may be far enough apart at both ends and not in between.
                for k in 0..=STEPS {
                    let way = self.from + (self.to - self.from) * f64::from(k) / f64::from(STEPS);
                    parameter.set(&mut cell, if option == "--to" { value } else { way });
                    cell.cue.check().map_err(|e| InputError::not_allowed(option, e.field, e.value, e.allowed))?;
                }
            } else {
                context.settings.set_number(option, parameter.name(), value)?;
                context.settings.check_wall(option)?;
            }
            parameter.set(&mut cell, value);
        }
        Ok(Varied { cell, parameter, range: [self.from, self.to] })
    }

    fn parameter(&self) -> Result<Parameter, InputError> {
        if let Ok(parameter) = self.vary.parse() {
            let allowed = "another parameter: curves and diagrams run over ξ_s as it is";
            InputError::require(parameter != Parameter::XiS, "--vary", "vary", "xi_s", allowed)?;
            return Ok(parameter);
        }
        let others = Parameter::ALL.into_iter().filter(|p| *p != Parameter::XiS);
        let names: Vec<&str> = others.map(Parameter::name).collect();
        let nearest = did_you_mean(&self.vary, names.iter().copied());
        let allowed = format!("one of {}, cue.u0, cue.omega, cue.amplitude{nearest}", names.join(", "));
        Err(InputError::not_allowed("--vary", "vary", format!("{:?}", self.vary), allowed))
    }
}
