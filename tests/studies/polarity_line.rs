//! The example on the smallest polarised cell beside the script of Hubatsch et al. 2019.

#[allow(dead_code, reason = "the example draws its picture too")]
#[path = "../../examples/polarity_line.rs"]
mod example;

use example::{Set, on_cell, on_line};

/// On a line with two ends, their geometry.
#[test]
fn the_shortest_polarised_line_is_that_of_their_script() {
    let alike = [0.5, 1.0, 2.0].map(|factor| on_line(Set::Alike, factor).unwrap());
    for (found, expected) in alike.into_iter().zip([6.314, 10.681, 19.142]) {
        assert!((found - expected).abs() < 0.002, "{found} {expected}");
    }
    // Their script ends after 2000 s, when shorter lines may still be losing their polarity: limits of 6.16, 9.73 and 15.32 µm.
    for (found, theirs) in alike.into_iter().zip([6.156, 9.734, 15.324]) {
        assert!(found > theirs && found < 1.26 * theirs, "{found} {theirs}");
    }
    // With the zygote's constants it gives 13.44 to 13.50 µm, on 100 points.
    let zygote = on_line(Set::Zygote, 1.0).unwrap();
    assert!((zygote - 13.369).abs() < 0.002 && (zygote / 13.47 - 1.0).abs() < 0.01, "{zygote}");
}

/// On the surface of a cell a polarised state needs a longer contour: the boundary is where the surface is widest, and narrows if it moves.
#[test]
fn the_smallest_polarised_cell_has_a_longer_contour_than_the_line() {
    for (set, expected) in [(Set::Alike, 36.647), (Set::Zygote, 29.233)] {
        let found = on_cell(set, 1.0).unwrap();
        assert!((found - expected).abs() < 0.01, "{found} {expected}");
    }
}
