//! The page refuses the same cells as the command line, with the same messages.

use furrow_cell::settings::Settings;
use furrow_cell::{Cell, Numerics};
use furrow_input::InputError;

/// Options of the command line by the parameters that they set.
const OPTIONS: [(&str, &str); 3] = [("--r0", "r0"), ("--epsilon", "epsilon"), ("--xi", "xi_s")];

/// Checks a cell before its division, as `furrow divide` does.
///
/// # Errors
/// Names the option, its value and the allowed range.
pub fn check(cell: &Cell, numerics: &Numerics) -> Result<(), InputError> {
    let settings = Settings::of(cell.clone(), *numerics);
    for (option, name) in OPTIONS {
        let value = match name {
            "r0" => cell.r0,
            "epsilon" => cell.epsilon,
            _ => cell.xi_s,
        };
        settings.validate(name).map_err(|allowed| InputError::not_allowed(option, name, value, allowed))?;
    }
    settings.check("settings")?;
    settings.check_activity("--xi")?;
    settings.check_divisions("settings")?;
    cell.cue.check().map_err(|error| InputError::not_allowed("--cue", error.field, error.value, error.allowed))
}

#[cfg(test)]
mod tests {
    use super::*;
    use furrow_cell::Cue;

    #[test]
    fn the_page_refuses_what_divide_refuses_with_the_same_message() {
        let refused = |cell: &Cell| check(cell, &Numerics::default()).map_err(|error| error.to_string());
        let cell = Cell::new(5.4);
        assert_eq!(refused(&cell), Ok(()));
        assert_eq!(
            refused(&Cell { xi_s: 200.0, ..cell.clone() }).unwrap_err(),
            "--xi: xi_s = 200: must be from -310.8 to 155.4 where kappa = 1 and gain = 0.4826"
        );
        assert_eq!(
            refused(&Cell { epsilon: 1.2, ..cell.clone() }).unwrap_err(),
            "--epsilon: epsilon = 1.2: must be above 0 and below 1"
        );
        assert_eq!(
            refused(&cell.with_cue(Cue::kappa_band(3.0, 0.1, 0.1))).unwrap_err(),
            "--cue: kappa.u0 = 3: must be from 0 to 1"
        );
    }
}
