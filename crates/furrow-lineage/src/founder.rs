//! A founder: a cell with a name and a row of the tables of its own.

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

/// Which daughter of an unequal division a founder is. Of equal daughters the one listed first takes the first place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Daughter {
    /// The larger daughter.
    Larger,
    /// The smaller daughter.
    Smaller,
}

impl Daughter {
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Daughter::Larger => "larger",
            Daughter::Smaller => "smaller",
        }
    }
}

/// One founder cell.
///
/// `S` is a [`WrittenShell`] while a file is read: a table of its own is a file beside it.
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
    /// Name of its cue, inherited by its descendants up to the next founder unless `inherit` says otherwise. Without it, and
    /// without rules of its own, the file's `cue_rules` apply.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cue: Option<String>,
    /// Whether its descendants inherit its cue.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub inherit: bool,
    /// The daughter that inherits the cue, at each division of a cell that has it; both if not given. Of equal daughters the anterior
    /// one counts as the larger.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cue_passes_to: Option<Daughter>,
    /// Most rounds of division of cells that `cue_passes_to` left without the cue, counted from the first of each line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rounds_without_cue: Option<u32>,
    /// In place of `cue`: the cues of the founder and its descendants, by the first rule that applies. Generations are
    /// counted from the founder.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cue_rules: Vec<CueRule>,
    /// Radius R0 in place of the one its mother's division (or the physics, for the first cell) gives, in L_h, or in µm
    /// where `units` say how long L_h is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub r0: Option<Length>,
    /// The shell of it and of its descendants up to the next founder, in place of the run's: the profile of a table with its aspect
    /// ratio, or the ellipsoid with the run's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shell_profile: Option<S>,
    /// Parameters of its own and of its descendants up to the next founder.
    #[serde(default, skip_serializing_if = "FounderPhysics::is_empty")]
    pub physics: FounderPhysics,
    /// Parameters of some of it and its descendants, by the first rule for each that applies, in place of the file's
    /// `physics_rules`. Generations are counted from the founder.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub physics_rules: Vec<PhysicsRule>,
    /// How long it and its descendants up to the next founder with a clock live.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock: Option<FounderClock>,
    /// Letters (anterior, posterior) of the generations below it; the file's `naming` after these.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub letters: Vec<(char, char)>,
    /// Most rounds of division of it and its descendants up to the next founder, as of a ganglion mother cell, which divides once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub most_rounds: Option<u32>,
    /// Volume at division divided by volume at birth, of it and its descendants up to the next founder; 1 if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub growth: Option<f64>,
    /// Observed rounds; `sulston` is an older word for them.
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
    /// What errors say is allowed where a setting of the run, by its [canonical name](furrow_cell::settings::canonical_name), reaches no
    /// cell of these lineages, since every founder has its own; `None` if a founder takes the run's.
    pub fn allowed_of_run<'a>(lineages: impl IntoIterator<Item = &'a Lineage>, name: &'static str) -> Option<String> {
        let all: Option<Vec<String>> = lineages.into_iter().map(|lineage| lineage.only_own(name)).collect();
        all?.into_iter().next()
    }

    /// Refuses settings of a run, each with its source, name and value, that reach [no cell](Self::allowed_of_run) of these lineages.
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
        let has_own = |founder: &Founder| match name.parse() {
            // An ellipsoid has the aspect ratio of the run's table.
            _ if name == SHELL_PROFILE => matches!(founder.shell_profile, Some(ShellChoice::Profile(_))),
            Ok(parameter) => founder.sets(parameter),
            Err(_) => false,
        };
        let allowed = || format!("left out: every founder of {} has its own, by physics or shell_profile", self.name);
        self.founders.iter().all(has_own).then(allowed)
    }
}

impl Founder {
    /// Factors by which cells may grow between birth and division.
    pub const GROWTH: RangeInclusive<f64> = 0.01..=100.0;

    /// Gives a cell its shell and its parameters. Its aspect ratio stretches its table.
    pub(super) fn apply(&self, cell: &mut Cell) {
        self.shell_profile.iter().for_each(|shell| shell.apply(cell));
        self.physics.apply(cell);
    }

    /// Whether it sets a parameter, by a number or by its table.
    pub fn sets(&self, parameter: Parameter) -> bool {
        let profile = self.shell_profile.as_ref().and_then(ShellChoice::profile);
        self.physics.has(parameter) || parameter == Parameter::Aspect && profile.is_some()
    }

    /// Its changes for itself and its descendants up to the next founder, each as `NAME = VALUE`.
    pub fn changes(&self) -> impl Iterator<Item = String> {
        let shell = self.shell_profile.iter().map(|shell| format!("shell_profile = {}", shell.described()));
        shell.chain(self.physics.values().map(|(name, value)| format!("{name} = {value}")))
    }

    /// Overrides it by what another one gives, as a file with a base does.
    pub(super) fn replace(&mut self, with: Founder) {
        // Without `..`: a new field does not compile until it is handled.
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
        // A cue and rules exclude each other, so that either takes the place of both.
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

/// Founders with the tables of their shells, which are relative to the folder of a text's file.
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
