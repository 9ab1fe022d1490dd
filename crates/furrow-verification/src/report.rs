//! A number that must be small, and how small it is.

/// Fails unless `found` is below `allowed`. What was found is printed either way: `tests/mutations` reads from it by how much
/// a mutated model is off.
///
/// # Panics
/// If it is not below, or no number.
#[track_caller]
pub fn within(what: &str, found: f64, allowed: f64) {
    println!("{what}: off by {found:.1e} of {allowed:.0e} allowed");
    assert!(found < allowed, "{what}: off by {found:.1e}, allowed is {allowed:.0e}");
}

/// The same where a number is expected: the difference relative to 1 + |expected|.
///
/// # Panics
/// If it is not below, or no number.
#[track_caller]
pub fn near(what: &str, found: f64, expected: f64, allowed: f64) {
    within(
        &format!("{what} ({found:.9} beside {expected:.9})"),
        (found - expected).abs() / (1.0 + expected.abs()),
        allowed,
    );
}
