//! Single cells: shapes, thresholds, stability and divisions, compared with an independent computation.

#[path = "../common/mod.rs"]
mod common;

mod boundary;
mod branch_ends;
mod branch_events;
mod calibrate;
mod cue_fields;
mod figures;
mod from_steady;
mod numeric_ranges;
mod par_cues;
mod phase;
mod physics;
mod published_scheme;
mod reference_branches;
mod reference_divisions;
mod reference_steady;
mod regulators;
mod search_effort;
mod sensitivities;
mod shell_profiles;
mod slow_cells;
mod solver_version;
mod stationary;
mod symmetric_cues;
mod work_counters;
