//! Sessions at the command line: the user's commands and their output. The shell runs them.
#![cfg(unix)]

use crate::common::cases::check_session;

#[test]
fn tables() {
    check_session("command/sessions/tables.txt");
}

#[test]
fn shells() {
    check_session("command/sessions/shells.txt");
}

#[test]
fn laws() {
    check_session("command/sessions/laws.txt");
}

#[test]
fn branches() {
    check_session("command/sessions/branches.txt");
}

#[test]
fn commands() {
    check_session("command/sessions/commands.txt");
}

#[test]
fn compare() {
    check_session("command/sessions/compare.txt");
}

#[test]
fn export() {
    check_session("command/sessions/export.txt");
}

#[test]
fn help() {
    check_session("command/sessions/help.txt");
}

#[test]
fn alternatives() {
    check_session("command/sessions/alternatives.txt");
}

#[test]
fn matching() {
    check_session("command/sessions/matching.txt");
}

#[test]
fn hypotheses() {
    check_session("command/sessions/hypotheses.txt");
}

#[test]
fn lineages() {
    check_session("command/sessions/lineages.txt");
}

#[test]
fn contours() {
    check_session("command/sessions/contours.txt");
}

/// There is no /dev/full elsewhere.
#[cfg(target_os = "linux")]
#[test]
fn outputs() {
    check_session("command/sessions/outputs.txt");
}

#[test]
fn polarity() {
    check_session("command/sessions/polarity.txt");
}

#[test]
fn solve() {
    check_session("command/sessions/solve.txt");
}

#[test]
fn pictures() {
    check_session("command/sessions/pictures.txt");
}

#[test]
fn refusals() {
    check_session("command/sessions/refusals.txt");
}

#[test]
fn surfaces() {
    check_session("command/sessions/surfaces.txt");
}

#[test]
fn scenarios() {
    check_session("command/sessions/scenarios.txt");
}

#[test]
fn sweeps() {
    check_session("command/sessions/sweeps.txt");
}

#[test]
fn workflows() {
    check_session("command/sessions/workflows.txt");
}

/// Every example of the help, and ensembles.
#[test]
#[ignore = "takes minutes of every core"]
fn what_takes_minutes() {
    check_session("command/sessions/minutes.txt");
}

#[test]
#[ignore = "needs Slurm"]
fn slurm_solves_the_parts_of_a_sweep() {
    check_session("command/sessions/slurm.txt");
}

#[test]
#[ignore = "needs Snakemake"]
fn snakemake_merges_the_parts_of_a_sweep() {
    check_session("command/sessions/snakemake.txt");
}

#[test]
fn tracked() {
    check_session("command/sessions/tracked.txt");
}
