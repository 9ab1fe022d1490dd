//! Numbers of options.

/// Reads the number of an option.
///
/// # Errors
/// Says what is allowed; clap adds the option and the value.
pub fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| "must be a number, as 0.87 or 1e-3".to_owned())
}
