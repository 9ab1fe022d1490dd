//! Boundary-value problems, branches and singular points from any bytes.

#[path = "../../../crates/furrow-bvp/tests/hostile/mod.rs"]
mod hostile;

/// Every problem ends with a result or an error; results keep their tolerance.
pub fn check(data: &[u8]) {
    hostile::check(data);
}
