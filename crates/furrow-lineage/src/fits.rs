//! Checks that the cells of a lineage can be computed with the settings of a run.

use super::definition::{Lineage, names};
use super::founder::Founder;
use super::rules::PhysicsRule;
use furrow_cell::settings::Settings;
use furrow_cell::{Cell, Numerics, Parameter};
use furrow_input::{InputError, shown};

/// Parameters that limit one another through the active stress.
const OF_ACTIVITY: [Parameter; 3] = [Parameter::XiS, Parameter::Kappa, Parameter::Gain];

/// Parameters limited by the discretisation.
const OF_SHELL: [Parameter; 2] = [Parameter::W, Parameter::Flattening];

/// The same error for a field in another place.
fn moved(error: InputError, field: impl FnOnce(&str) -> String) -> InputError {
    match error {
        InputError::NotAllowed { source_name, field: of_cell, value, allowed } => {
            let plain = of_cell.rsplit('.').next().unwrap_or(&of_cell);
            InputError::NotAllowed { source_name, field: field(plain), value, allowed }
        }
        other => other,
    }
}

impl Lineage {
    /// Checks whether its cells can divide with the law of `cell`, a cell of the run, and with `numerics`; errors name the source
    /// `source_name`.
    ///
    /// # Errors
    /// Names the cue, founder or rule and the reason.
    pub fn check_cells(&self, cell: &Cell, numerics: &Numerics, source_name: &str) -> Result<(), InputError> {
        if numerics.modes == 0 {
            self.check_axisymmetric(source_name)?;
        }
        self.check_physics(cell, numerics, source_name)?;
        let of_founders = self.founders.iter().flat_map(|founder| founder.cue.iter().chain(names(&founder.cue_rules)));
        let cues = of_founders.chain(names(&self.cue_rules)).filter_map(|name| self.cue(name));
        cues.into_iter().try_for_each(|cue| cell.clone().with_cue(cue).check_law(source_name))
    }

    /// Checks whether the shells and activities of its founders and rules are compatible with `cell` and `numerics`; errors name `file`.
    ///
    /// # Errors
    /// Names the founder or rule, the field, its value and the allowed values.
    pub fn check_physics(&self, cell: &Cell, numerics: &Numerics, file: &str) -> Result<(), InputError> {
        let run = Settings::of(cell.clone(), *numerics);
        for founder in &self.founders {
            let own = check_founder(founder, &run, file)?;
            match &founder.physics_rules[..] {
                [] => check_rules(&self.physics_rules, &own, file, "physics_rules")?,
                rules => {
                    let field = format!("founder {}: physics_rules", shown(&founder.name));
                    check_rules(rules, &own, file, &field)?;
                }
            }
        }
        Ok(())
    }

    /// Rejects flattened shells and one-sided cues for trees of axisymmetric cells; errors name `file`.
    ///
    /// # Errors
    /// Names the cue, the founder or the rule.
    fn check_axisymmetric(&self, file: &str) -> Result<(), InputError> {
        if let Some((name, cue)) = self.cues.iter().find(|(_, cue)| cue.is_one_sided()) {
            let allowed = "without at=PHI for cells with axial symmetry, whose modes are 0";
            return Err(InputError::not_allowed(file, format!("cues[{name:?}]"), cue, allowed));
        }
        let allowed = "1 for cells with axial symmetry, whose modes are 0";
        let flattened =
            |founder: &&Founder| founder.physics.shell_flattening.is_some_and(|flattening| flattening != 1.0);
        if let Some(founder) = self.founders.iter().find(flattened) {
            let field = format!("founder {}: physics.shell_flattening", shown(&founder.name));
            return Err(InputError::not_allowed(file, field, founder.physics.shell_flattening.unwrap_or(1.0), allowed));
        }
        let rules = self.founders.iter().flat_map(|founder| &founder.physics_rules).chain(&self.physics_rules);
        match rules.into_iter().find(|rule| rule.parameter == Parameter::Flattening) {
            Some(rule) => Err(InputError::not_allowed(
                file,
                "physics_rules",
                rule.parameter,
                "another parameter for cells with axial symmetry",
            )),
            None => Ok(()),
        }
    }
}

/// Checks the shell and the activity of a founder's cells in a run; returns their settings.
fn check_founder(founder: &Founder, run: &Settings, source_name: &str) -> Result<Settings, InputError> {
    let mut own = run.clone();
    founder.apply(&mut own.cell);
    let sets = |parameters: &[Parameter]| parameters.iter().any(|parameter| founder.physics.has(*parameter));
    let checked = check_set(&own, [sets(&OF_SHELL), sets(&OF_ACTIVITY)], source_name);
    checked.map_err(|error| moved(error, |name| format!("founder {}: physics.{name}", shown(&founder.name))))?;
    Ok(own)
}

/// Checks the values from rules that do not depend on size, generation or other rules.
fn check_rules(rules: &[PhysicsRule], run: &Settings, source_name: &str, field: &str) -> Result<(), InputError> {
    let among = |parameters: &[Parameter]| rules.iter().filter(|rule| parameters.contains(&rule.parameter)).count();
    let alone = among(&OF_ACTIVITY) == 1;
    for (k, rule) in rules.iter().enumerate() {
        let Some(value) = rule.fixed_value() else { continue };
        let (of_shell, of_activity) = (OF_SHELL.contains(&rule.parameter), OF_ACTIVITY.contains(&rule.parameter));
        let mut ruled = run.clone();
        rule.parameter.set(&mut ruled.cell, value);
        let checked = check_set(&ruled, [of_shell, of_activity && alone], source_name);
        checked.map_err(|error| moved(error, |name| format!("{field}[{k}]: {name}")))?;
    }
    Ok(())
}

/// Checks the shell, the activity, or both.
fn check_set(settings: &Settings, [shell, activity]: [bool; 2], source_name: &str) -> Result<(), InputError> {
    if shell {
        settings.check_shell(source_name)?;
    }
    if activity { settings.check_activity(source_name) } else { Ok(()) }
}
