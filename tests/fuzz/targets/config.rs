//! Configuration files.

use furrow_cell::settings::{Settings, listing};

use super::{FILE, accepted, text};

/// A valid configuration is the same after all its values are written to a file and read, or set one by one.
pub fn check(data: &[u8]) {
    let Some(text) = text(data) else { return };
    let mut settings = Settings::default();
    let Some(()) = accepted(settings.apply_config(text, FILE)) else { return };
    let values = listing(&settings);
    let section = |wanted: &str| -> String {
        let of = values.iter().filter(|(section, _, _)| *section == wanted);
        of.map(|(_, name, value)| format!("{name}: {value}, ")).collect()
    };
    let written = format!("Config(physics: ({}), numerics: ({}))", section("physics"), section("numerics"));
    let mut again = Settings::default();
    again.apply_config(&written, FILE).unwrap_or_else(|error| panic!("{error}: {written}"));
    assert_eq!(again, settings);
    let pairs: Vec<String> = values.iter().map(|(section, name, value)| format!("{section}.{name}={value}")).collect();
    let mut set = Settings::default();
    set.apply_overrides(&pairs).expect("what a file may say may be set");
    assert_eq!(set, settings);
}
