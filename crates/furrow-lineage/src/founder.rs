//! A founder: a named cell with its own row in tables.

use std::ops::RangeInclusive;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::check::founder_error;
use super::clock::FounderClock;
use super::definition::{CueRule, Lineage};
use super::observed::ObservedRounds;
use super::physics::FounderPhysics;
use super::rules::PhysicsRule;
use super::units::Length;
use furrow_cell::profile::WrittenShell;
use furrow_cell::settings::{SHELL_PROFILE, number_set_by};
use furrow_cell::{Cell, Parameter, ShellChoice};
use furrow_input::InputError;

/// Which daughter of an unequal division a founder is. Of equal daughters the one listed first is the anterior.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Daughter {
    /// The larger daughter.
    Larger,
    /// The smaller daughter.
    Smaller,
}

impl Daughter {
    /// The word in files.
    pub fn word(self) -> &'static str {
        match self {
            Daughter::Larger => "larger",
            Daughter::Smaller => "smaller",
        }
    }
}

/// One founder cell.
///
/// `S` is a [`WrittenShell`] while a file is read, since the shell may be a table in another file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, bound(deserialize = "S: Deserialize<'de>"))]
pub struct Founder<S = ShellChoice> {
    /// Name, unique in the file.
    pub name: String,
    /// The founder that divides into it; `None` for the first cell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mother: Option<String>,
    /// Which of the mother's daughters it is; given exactly when `mother` is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub daughter: Option<Daughter>,
    /// Name of its cue, inherited by its descendants up to the next founder unless `inherit` is false. Without it, and
    /// without the founder's `cue_rules`, the file's rules apply.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cue: Option<String>,
    /// Whether its descendants inherit its cue.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub inherit: bool,
    /// The daughter that inherits the cue, at each division of a cell that has it; both if not given. Of equal daughters the anterior
    /// one counts as the larger.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cue_passes_to: Option<Daughter>,
    /// Largest number of rounds of cells without the cue because of `cue_passes_to`, counted from the first of each line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rounds_without_cue: Option<u32>,
    /// Instead of `cue`: the cues of the founder and its descendants, by the first rule that applies. Generations are
    /// counted from the founder.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cue_rules: Vec<CueRule>,
    /// Radius R0, which replaces the one from the mother's division (or, for the first cell, from the physics), in L_h, or in µm
    /// if `units` give L_h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub r0: Option<Length>,
    /// The shell of the founder and its descendants up to the next founder, which replaces the run's: the profile of a table with its
    /// aspect ratio, or the ellipsoid with the run's aspect ratio.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shell_profile: Option<S>,
    /// Parameters of the founder and its descendants up to the next founder.
    #[serde(default, skip_serializing_if = "FounderPhysics::is_empty")]
    pub physics: FounderPhysics,
    /// Parameters of the founder and its descendants, for each parameter by the first rule that applies. They replace the file's
    /// `physics_rules`. Generations are counted from the founder.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub physics_rules: Vec<PhysicsRule>,
    /// Lifetimes of the founder and its descendants up to the next founder with a clock.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock: Option<FounderClock>,
    /// Letters (anterior, posterior) of the first generations below it; later generations use the file's `naming`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub letters: Vec<(char, char)>,
    /// Largest number of rounds of the founder and its descendants up to the next founder; 1 for a ganglion mother cell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub most_rounds: Option<u32>,
    /// Volume at division divided by volume at birth, for the founder and its descendants up to the next founder; 1 if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub growth: Option<f64>,
    /// Observed rounds; `sulston` is an older name of this field.
    #[serde(default, alias = "sulston", skip_serializing_if = "Option::is_none")]
    pub observed: Option<ObservedRounds>,
}

impl<S> Founder<S> {
    /// The same in another shell.
    fn with_shell<T>(self, shell_profile: Option<T>) -> Founder<T> {
        // Without `..`: the compiler asks for every field.
        let Founder {
            name,
            mother,
            daughter,
            cue,
            inherit,
            cue_passes_to,
            rounds_without_cue,
            cue_rules,
            r0,
            shell_profile: _,
            physics,
            physics_rules,
            clock,
            letters,
            most_rounds,
            growth,
            observed,
        } = self;
        Founder {
            name,
            mother,
            daughter,
            cue,
            inherit,
            cue_passes_to,
            rounds_without_cue,
            cue_rules,
            r0,
            shell_profile,
            physics,
            physics_rules,
            clock,
            letters,
            most_rounds,
            growth,
            observed,
        }
    }
}

impl Lineage {
    /// The allowed values named in errors if a setting of the run, by its [canonical name](furrow_cell::settings::canonical_name), affects
    /// no cell of these lineages because every founder sets its own; `None` if a founder uses the run's.
    pub fn allowed_of_run<'a>(lineages: impl IntoIterator<Item = &'a Lineage>, name: &'static str) -> Option<String> {
        let all: Option<Vec<String>> = lineages.into_iter().map(|lineage| lineage.only_own(name)).collect();
        all?.into_iter().next()
    }

    /// Rejects settings of a run (source, name and value) that affect [no cell](Self::allowed_of_run) of these lineages.
    ///
    /// # Errors
    /// Names the first of them.
    pub fn check_taken<'s>(
        lineages: &[&Lineage],
        given: impl IntoIterator<Item = (&'s str, &'static str, String)>,
    ) -> Result<(), InputError> {
        given.into_iter().try_for_each(|(source, name, value)| {
            let unused = Lineage::allowed_of_run(lineages.iter().copied(), name);
            unused.map_or(Ok(()), |allowed| Err(InputError::not_allowed(source, name, value, allowed)))
        })
    }

    /// [`allowed_of_run`](Self::allowed_of_run) of one lineage.
    fn only_own(&self, name: &'static str) -> Option<String> {
        let name = number_set_by(name);
        let has_own = |(k, founder): (usize, &Founder)| match name.parse() {
            // An ellipsoid has the aspect ratio of the run, which its table may set.
            _ if name == SHELL_PROFILE => matches!(founder.shell_profile, Some(ShellChoice::Profile(_))),
            Ok(parameter) => founder.sets(parameter) || self.rules_replace(k, parameter),
            Err(_) => false,
        };
        let by = "physics, physics_rules or shell_profile";
        let allowed = || format!("left out: every founder of {} has its own, by {by}", self.name);
        self.founders.iter().enumerate().all(has_own).then(allowed)
    }
}

impl Founder {
    /// Allowed factors of growth between birth and division.
    pub const GROWTH: RangeInclusive<f64> = 0.01..=100.0;

    /// Sets the shell and the parameters of a cell. The aspect ratio stretches the table.
    pub(super) fn apply(&self, cell: &mut Cell) {
        self.shell_profile.iter().for_each(|shell| shell.apply(cell));
        self.physics.apply(cell);
    }

    /// Whether it sets a parameter, by a number or by a table.
    pub fn sets(&self, parameter: Parameter) -> bool {
        let profile = self.shell_profile.as_ref().and_then(ShellChoice::profile);
        self.physics.has(parameter) || parameter == Parameter::Aspect && profile.is_some()
    }

    /// The settings of the founder and its descendants up to the next founder, as `NAME = VALUE`.
    pub fn changes(&self) -> impl Iterator<Item = String> {
        let shell = self.shell_profile.iter().map(|shell| format!("shell_profile = {}", shell.described()));
        shell.chain(self.physics.values().map(|(name, value)| format!("{name} = {value}")))
    }

    /// Overrides its fields by those that another founder sets, for a file with a base.
    pub(super) fn replace(&mut self, with: Founder) {
        // There is no `..`, so that a new field is a compile error until it is handled.
        let Founder {
            name: _,
            mother,
            daughter,
            cue,
            inherit,
            cue_passes_to,
            rounds_without_cue,
            cue_rules,
            r0,
            shell_profile,
            physics,
            physics_rules,
            clock,
            letters,
            most_rounds,
            growth,
            observed,
        } = with;
        self.mother = mother.or(self.mother.take());
        self.daughter = daughter.or(self.daughter);
        // A cue and rules exclude each other, so either replaces both.
        if cue.is_some() || !cue_rules.is_empty() {
            (self.cue, self.cue_rules, self.inherit) = (cue, cue_rules, inherit);
        } else if !inherit {
            self.inherit = false;
        }
        self.r0 = r0.or(self.r0);
        self.shell_profile = shell_profile.or(self.shell_profile.take());
        if !physics.is_empty() {
            self.physics = physics;
        }
        if !physics_rules.is_empty() {
            self.physics_rules = physics_rules;
        }
        self.clock = clock.or(self.clock);
        if !letters.is_empty() {
            self.letters = letters;
        }
        self.cue_passes_to = cue_passes_to.or(self.cue_passes_to);
        self.rounds_without_cue = rounds_without_cue.or(self.rounds_without_cue);
        self.most_rounds = most_rounds.or(self.most_rounds);
        self.growth = growth.or(self.growth);
        self.observed = observed.or(self.observed);
    }
}

fn yes() -> bool {
    true
}

fn is_yes(value: &bool) -> bool {
    *value
}

/// Founders with the tables of their shells. Paths of tables are relative to the folder of the file.
///
/// # Errors
/// Names the founder, or the table and its faulty line.
pub(super) fn in_shells(founders: Vec<Founder<WrittenShell>>, of: [&str; 2]) -> Result<Vec<Founder>, InputError> {
    let folder = Path::new(of[1]).parent().unwrap_or(Path::new(""));
    let read = |mut founder: Founder<WrittenShell>| {
        let refused = |value, allowed| founder_error(of, &founder.name, "shell_profile", value, allowed);
        let shell = founder.shell_profile.take().map(|written| written.read(folder, refused)).transpose()?;
        Ok(founder.with_shell(shell))
    };
    founders.into_iter().map(read).collect()
}
