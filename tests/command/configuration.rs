//! Parameters from a file and from `--set`.

use furrow_cell::settings::Settings;
use furrow_cell::{Cell, RigidityGradient};

fn set(list: &[&str]) -> Settings {
    let mut settings = Settings::default();
    settings.apply_overrides(&list.iter().map(|s| s.to_string()).collect::<Vec<_>>()).unwrap();
    settings
}

#[test]
fn every_name_reaches_its_field() {
    let s = set(&["xi=20", "g=0.4", "eps=0.8", "a_over_b=1.3", "P0=0.2", "physics.w=0.1", "rigidity_gradient=dropped"]);
    let Cell { xi_s, epsilon, material, shell, .. } = s.cell;
    assert_eq!((xi_s, material.gain, epsilon, shell.aspect, shell.p0, shell.w), (20.0, 0.4, 0.8, 1.3, 0.2, 0.1));
    assert_eq!(material.rigidity_gradient, RigidityGradient::Dropped);
    let numerics = set(&["stages=3", "numerics.intervals=40", "noise=0"]).numerics;
    assert_eq!((numerics.stages, numerics.intervals, numerics.noise), (3, 40, 0.0));
}

/// The ratio ξ_b/ξ_s is what stays fixed, whichever of the two is set first.
#[test]
fn xi_b_sets_the_ratio() {
    assert_eq!(set(&["xi=20"]).cell.material.xi_ratio, -0.1);
    assert_eq!(set(&["xi_b=-4", "xi=20"]).cell.material.xi_ratio, -0.2);
    assert_eq!(set(&["xi=20", "xi_b=-4"]).cell.material.xi_ratio, -0.2);
}

#[test]
fn file_keeps_the_preset_elsewhere() {
    let mut settings = Settings::default();
    settings.apply_config("Config(physics: (eps: 0.7, xi: 20), numerics: (stages: 3))", "c.ron").unwrap();
    assert_eq!(settings.cell, Cell { epsilon: 0.7, xi_s: 20.0, ..Settings::default().cell });
    assert_eq!(settings.numerics.stages, 3);
}
