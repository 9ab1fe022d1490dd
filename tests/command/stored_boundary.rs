//! `furrow boundary --write`.

use furrow_cell::{Cell, Numerics};
use furrow_mechanics::critical::Stored;

use crate::common::command::{HERE, json};
use crate::common::shapes::check_close;

/// The written boundary equals the compiled one: radii of every cue of the built-in lineage, where criticality
/// changes, and the curve of pitchforks from one end of the range to the other.
#[test]
fn a_stored_boundary_is_written_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("boundary.json");
    let path = path.to_str().unwrap();
    json(HERE, &["boundary", "--vary", "r0", "--from", "1.5", "--to", "5.4", "--no-folds", "--write", path]);
    let read = |path: &str| {
        let text = std::fs::read_to_string(path).unwrap();
        Stored::parse(&text, path, &Cell::new(1.0), &Numerics::default()).unwrap()
    };
    let (written, kept) =
        (read(path), read(concat!(env!("CARGO_MANIFEST_DIR"), "/crates/furrow-mechanics/data/gao2026.boundary.json")));
    let close = |a: f64, b: f64| check_close(a, b, 1e-7);
    assert_eq!(written.radii.len(), kept.radii.len());
    for (a, b) in written.radii.iter().zip(&kept.radii) {
        close(a.from, b.from);
        let (a, b) = (&a.critical, &b.critical);
        assert_eq!((&a.cue, a.kind), (&b.cue, b.kind));
        close(a.r0, b.r0);
        close(a.slope, b.slope);
    }
    assert_eq!(written.degenerate.len(), kept.degenerate.len());
    for (a, b) in written.degenerate.iter().zip(&kept.degenerate) {
        close(a.r0, b.r0);
        close(a.xi_s, b.xi_s);
    }
    // The curve from end to end; where its points lie in between is the step control's affair.
    let ends = |stored: &Stored| [stored.pitchfork[0], *stored.pitchfork.last().unwrap()];
    for (a, b) in ends(&written).iter().zip(ends(&kept)) {
        assert_eq!((a.r0, a.criticality()), (b.r0, b.criticality()));
        close(a.xi_s, b.xi_s);
    }
    assert!(written.pitchfork.len() > 20 && written.pitchfork.windows(2).all(|p| p[0].r0 < p[1].r0));
}
