//! Contours, in tables of points and in masks. The first byte selects the kind, and whether a label is requested.

use furrow_measured::contour::Contour;
use furrow_measured::contour::furrow::furrow;
use furrow_measured::contour::overlap::{overlap, overlap_of_pixels};
use furrow_measured::contour::polygons::Contours;

use super::{FILE, accepted};

/// A valid contour encloses an area, survives writing and reading, and overlaps with itself.
pub fn check(data: &[u8]) {
    let Some((&how, bytes)) = data.split_first() else { return };
    let mut found = Contours::default();
    let read = match how % 3 {
        0 => found.read_table(bytes, FILE),
        1 => found.read_mask(bytes, FILE, None),
        _ => found.read_mask(bytes, FILE, Some(u16::from(how))),
    };
    let Some(_) = accepted(read) else { return };
    for left in &found.left_out {
        assert!(left.file == FILE && !left.why.is_empty() && left.why.len() < 500, "{left:?}");
    }
    for traced in found.traced.iter().take(4) {
        holds(&traced.contour);
    }
}

fn holds(contour: &Contour) {
    let moments = contour.moments();
    // The moments of a sliver are lost to rounding.
    if moments.area.is_nan() || moments.elongation > 1e3 {
        return;
    }
    assert!(moments.area > 0.0 && moments.elongation >= 1.0 - 1e-9, "{moments:?}");
    let points: Vec<[f64; 2]> = contour.points().iter().map(|point| [point.x, point.y]).collect();
    let (again, _) = Contour::new(points).expect("what is a contour is one again");
    assert!((again.moments().area / moments.area - 1.0).abs() < 0.02);
    let upright = contour.upright();
    assert!((0.0..=1.0).contains(&furrow(&upright).depth), "{:?}", furrow(&upright));
    let own = overlap(&upright, &upright);
    assert!((own.similarity - 1.0).abs() < 1e-3 && (own.jaccard - 1.0).abs() < 1e-3, "{own:?}");
    let side = moments.area.sqrt() / 100.0;
    assert!(overlap_of_pixels(&upright, &upright, side).similarity >= 1.0 - 1e-12);
}
