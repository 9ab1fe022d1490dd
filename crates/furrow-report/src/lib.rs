//! Presentation of results to readers.
//!
//! | file | contents |
//! |---|---|
//! | [`table`], `observed_table` | the founders' table as text; its columns beside observed counts |
//! | [`mod@scenarios_table`], [`mod@scenarios_page`] | several trees side by side, as text and as a page |
//! | [`mod@svg`] | the drawing of a lineage |
//! | [`mod@html`], `page` | the interactive page: its content, its frame with scripts and solver |
//! | [`film_page`] | the film of a division, to be turned |
//! | [`summary`] | counts over a tree |
//! | [`shapes`] | records of stationary shapes, folds and pitchforks |
//! | `surfaces` | records of cells without axial symmetry |
//! | [`reproduction`] | the paper's statements beside computed ones |

pub mod film_page;
pub mod html;
mod observed_table;
mod over_time;
mod page;
pub mod reproduction;
pub mod scenarios_page;
pub mod scenarios_table;
pub mod shapes;
mod spread;
pub mod spread_table;
pub mod summary;
#[cfg(not(target_family = "wasm"))]
pub mod surfaces;
pub mod svg;
pub mod table;
pub mod time_axis;

pub use film_page::FilmPage;
pub use html::{OfTree, explorer, html};
pub use scenarios_page::scenarios_page;
pub use scenarios_table::scenarios_table;
pub use shapes::{
    AzimuthalStability, checks_report, crossing_report, event_report, hopf_report, stationary_report, threshold_report,
};
pub use spread_table::spread_table;
pub use summary::{Generation, TreeSummary};
pub use svg::{colours as founder_colours, svg};
pub use table::founders_table;
pub use time_axis::TimeAxis;

/// Text with the characters that XML and HTML reserve replaced.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Text with long numbers rounded to six digits.
fn rounded(text: &str) -> String {
    let is_of_number = |c: char| c.is_ascii_digit() || c == '.';
    let piece = |piece: &str| {
        let number = piece.trim_end_matches(|c| !is_of_number(c));
        let rest = &piece[number.len()..];
        let long = Some(number).filter(|number| number.len() > 8 && number.contains('.'));
        match long.and_then(|number| number.parse::<f64>().ok()).filter(|value| *value > 0.0) {
            Some(value) => {
                let decimals = (5.0 - value.log10().floor()).clamp(0.0, 20.0);
                let digits = format!("{value:.*}", decimals as usize);
                format!(
                    "{}{rest}",
                    if decimals > 0.0 { digits.trim_end_matches('0').trim_end_matches('.') } else { &digits }
                )
            }
            None => piece.to_owned(),
        }
    };
    text.split_inclusive(|c| !is_of_number(c)).map(piece).collect()
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn long_numbers_are_rounded_and_the_rest_is_unchanged() {
        let cases = [
            ("r0 = 17.40506329113924", "r0 = 17.4051"),
            (
                "kappa:band,u0=0.4,omega=0.30000000000000004Lh,amplitude=-1.2345678901e-7",
                "kappa:band,u0=0.4,omega=0.3Lh,amplitude=-1.23457e-7",
            ),
            ("0.000012345678, 1234567.125, 0.0000000000", "0.0000123457, 1234567, 0.0000000000"),
            ("furrow 0.12.345678, commit 1234567890", "furrow 0.12.345678, commit 1234567890"),
            ("", ""),
        ];
        for (text, expected) in cases {
            assert_eq!(rounded(text), expected);
        }
    }
}
