//! Assertions that print the compared values.

/// Asserts that `found` is below `allowed` and prints both, which `mutations.py` reports.
///
/// # Panics
/// If it is not below, or is NaN.
#[track_caller]
pub fn within(what: &str, found: f64, allowed: f64) {
    println!("{what}: off by {found:.1e} of {allowed:.0e} allowed");
    assert!(found < allowed, "{what}: off by {found:.1e}, allowed is {allowed:.0e}");
}

/// Asserts that the difference of `found` and `expected`, relative to 1 + |expected|, is below `allowed`.
///
/// # Panics
/// If it is not below, or is NaN.
#[track_caller]
pub fn near(what: &str, found: f64, expected: f64, allowed: f64) {
    within(
        &format!("{what} ({found:.9} beside {expected:.9})"),
        (found - expected).abs() / (1.0 + expected.abs()),
        allowed,
    );
}
