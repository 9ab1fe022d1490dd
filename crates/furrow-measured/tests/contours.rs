//! Contours as people trace them: tables of points and masks, sound and broken.

use furrow_measured::contour::furrow::furrow;
use furrow_measured::contour::overlap::{overlap, overlap_of_pixels};
use furrow_measured::contour::polygons::Contours;
use furrow_measured::contour::{Contour, Unusable};
use proptest::prelude::*;

fn table(text: &[u8]) -> Contours {
    let mut found = Contours::default();
    found.read_table(text, "t.csv").unwrap();
    found
}

/// A mask by its rows, `#` inside.
fn mask(rows: &[&str], [background, cell]: [u8; 2]) -> Vec<u8> {
    let pixels = rows.iter().flat_map(|row| row.bytes()).map(|byte| if byte == b'#' { cell } else { background });
    grey([rows[0].len() as u32, rows.len() as u32], &pixels.collect::<Vec<u8>>())
}

fn grey([width, height]: [u32; 2], pixels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(pixels).unwrap();
    bytes
}

fn masked(bytes: &[u8], label: Option<u16>) -> Contours {
    let mut found = Contours::default();
    found.read_mask(bytes, "m.png", label).unwrap();
    found
}

/// Points at `count` angles around a cell.
fn around(count: u32, at: impl Fn(f64) -> [f64; 2]) -> Vec<[f64; 2]> {
    (0..count).map(|k| at(f64::from(k) / f64::from(count) * std::f64::consts::TAU)).collect()
}

const SQUARES: &str = "contour,x,y\na,0,0\nb,5,5\na,2,0\nb,5,8\na,2,2\nb,8,8\na,0,2\nb,8,5\n";

#[test]
fn contours_of_one_table_are_kept_apart_in_any_dress() {
    for text in [
        SQUARES.to_owned(),
        format!("\u{feff}{}", SQUARES.replace('\n', "\r\n")),
        SQUARES.replace(',', ";"),
        SQUARES.replace(',', "\t").replace("contour", "Stage").replace("\tx\ty", "\tX\tZ"),
    ] {
        let found = table(text.as_bytes());
        let areas: Vec<(&str, f64)> =
            found.traced.iter().map(|traced| (traced.name.as_str(), traced.contour.moments().area)).collect();
        assert_eq!(areas, [("a", 4.0), ("b", 9.0)], "{text}");
        assert!(found.left_out.is_empty());
    }
    let bare = table(b"0,0\n4,0\n4,1\n0,1\n0,0\n");
    assert_eq!(bare.traced[0].contour.points().len(), 4);
}

#[test]
fn an_invalid_contour_is_left_out_with_its_place_and_the_others_stay() {
    let broken = "id,x,y\na,0,0\na,2,0\na,2,2\nb,0,0\nb,nan,1\nb,1,0\nc,0,0\nc,1,1\nd,0,0\nd,1,1\nd,2,2\ne,0,0\ne,2,2\ne,2,0\ne,0,2\n";
    let read = table(broken.as_bytes());
    assert_eq!(read.traced.len(), 1);
    let left = read.left_out.iter().map(|l| format!("{}:{} {}: {}", l.file, l.line.unwrap(), l.contour, l.why));
    let found: Vec<String> = left.collect();
    assert_eq!(found[0], "t.csv:6 b: column 2: \"nan\" is not a finite number");
    assert_eq!(found[1], "t.csv:8 c: 2 points; a contour has at least 3 that differ");
    assert_eq!(found[2], "t.csv:10 d: it encloses no area");
    assert!(found[3].starts_with("t.csv:13 e: it ") && found.len() == 4, "{found:?}");
}

#[test]
fn tables_of_something_else_are_refused() {
    for (text, expected) in [
        (&b"a,b\n1,2\n"[..], "columns x and y (or r and z)"),
        (b"", "the table is empty"),
        (b"x,y\n", "no points"),
        (b"\xff\xfex\0", "UTF-16"),
        (
            "x (px),y (\u{b5}m)\n1,2\n".as_bytes(),
            "t.csv:1:1: both coordinates must have one unit; \"x (px)\" has px, \"y (\u{b5}m)\" has um",
        ),
        (b"x,y_um\n1,2\n", "one unit; \"x\" has none, \"y_um\" has um"),
        (b"x,y,x2,y2\n1,2,3,4\n", "\"x\" and \"x2\" both have x: one of them must be left out"),
        (b"x_px,y_px,x_um,y_um\n1,2,3,4\n", "\"x_px\" and \"x_um\" both have x"),
        (b"z,r,z.1\n1,2,3\n", "\"z\" and \"z.1\" both have z"),
    ] {
        let said = Contours::default().read_table(text, "t.csv").unwrap_err().to_string();
        assert!(said.contains(expected), "{said}");
    }
}

/// A small loop is cut off and reported; a contour of two halves is refused.
#[test]
fn small_loops_are_cut_off_and_large_ones_refused() {
    let mut points = around(200, |t| [3.0 * t.cos(), 2.0 * t.sin()]);
    let (whole, none) = Contour::new(points.clone()).unwrap();
    assert_eq!(none, 0.0);
    // Two neighbours in the wrong order.
    points.swap(40, 41);
    let (mended, cut) = Contour::new(points).unwrap();
    assert!(cut > 0.0 && cut < 1e-2, "{cut}");
    assert!((mended.moments().area / whole.moments().area - 1.0).abs() < 1e-2);
    let eight = vec![[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.9]];
    assert!(matches!(Contour::new(eight), Err(Unusable::Crosses(_) | Unusable::NoArea)));
}

/// An ellipse at any place and angle, by its formulas.
#[test]
fn moments_of_an_ellipse_agree_with_formulas_at_any_place() {
    for (turn, [x, y]) in [(0.0, [0.0, 0.0]), (0.7, [1e4, -3e3]), (2.9, [-50.0, 1e6])] {
        let (sin, cos) = f64::sin_cos(turn);
        let points = around(2000, |t| {
            let (u, v) = (3.0 * t.cos(), 2.0 * t.sin());
            [x + u * cos - v * sin, y + u * sin + v * cos]
        });
        let moments = Contour::new(points).unwrap().0.moments();
        assert!((moments.area / (6.0 * std::f64::consts::PI) - 1.0).abs() < 1e-5);
        assert!((moments.elongation - 1.5).abs() < 1e-5);
        assert!((moments.centroid - nalgebra::Point2::new(x, y)).norm() < 1e-6);
        let axis = nalgebra::Vector2::new(cos, sin);
        assert!(moments.long_axis.dot(&axis).abs() > 1.0 - 1e-8 && moments.long_axis.x >= 0.0);
    }
}

/// By hand: a plus of five pixels has the outline of an octagon through the middles of its outer sides.
#[test]
fn the_outline_of_a_mask_goes_around_its_pixels() {
    let plus = ["......", "..#...", ".###..", "..#...", "......"];
    for values in [[0, 255], [255, 0], [7, 9]] {
        let found = masked(&mask(&plus, values), None);
        let moments = found.traced[0].contour.moments();
        // Of each of eight outer corners an eighth of a pixel is cut off, and each of four inner ones has one more.
        assert!((moments.area - (5.0 - 8.0 / 8.0 + 4.0 / 8.0)).abs() < 1e-12, "{}", moments.area);
        assert_eq!((moments.centroid.x, moments.centroid.y), (2.5, 2.5));
        assert_eq!(found.traced[0].pixel, Some(1.0));
    }
}

#[test]
fn the_largest_piece_is_taken_its_holes_filled_and_the_rest_reported() {
    let rows = ["#.........", "..#####...", "..#...#...", "..#.#.#...", "..#...#..#", "..#####.##"];
    let found = masked(&mask(&rows, [0, 200]), None);
    let traced = &found.traced[0];
    assert!((traced.contour.moments().area - (25.0 - 0.5)).abs() < 1e-12);
    assert_eq!(traced.notes[0], "3 smaller pieces, 5 pixels beside 16, were left out");
    assert!(traced.notes[1].contains("rim"));
}

#[test]
fn cells_of_a_picture_of_labels_are_separated() {
    let pixels: Vec<u8> = [0, 1, 1, 2, 2, 2, 0, 1, 1, 2, 2, 2].into();
    let bytes = grey([6, 2], &pixels);
    let area = |label| masked(&bytes, Some(label)).traced[0].contour.moments().area;
    assert!((area(1) - 3.5).abs() < 1e-12 && (area(2) - 5.5).abs() < 1e-12);
    let none = masked(&bytes, Some(3));
    assert_eq!((none.traced.len(), none.left_out[0].why.as_str()), (0, "no pixel of it has the label 3"));
}

/// Labels fill areas, the values of a mask's soft or noisy edges do not.
#[test]
fn a_picture_of_labels_needs_a_label_and_a_mask_with_soft_edges_does_not() {
    let picture = |value: &dyn Fn(f64) -> u8| {
        let far = |at: u32| (f64::from(at % 40) - 19.5).hypot(f64::from(at / 40) - 19.5);
        grey([40, 40], &(0..1600).map(|at| value(far(at))).collect::<Vec<u8>>())
    };
    let labels = picture(&|r| if r < 6.0 { 2 } else { u8::from(r < 12.0) });
    let said = Contours::default().read_mask(&labels[..], "m.png", None).unwrap_err().to_string();
    let why = "must be given with --label: the picture has the labels 0, 1, 2, and a mask has one colour on another";
    assert_eq!(said, format!("m.png: label = (not given): {why}"));
    assert_eq!(masked(&labels, Some(2)).traced.len(), 1);
    let rings = picture(&|r| r as u8);
    let said = Contours::default().read_mask(&rings[..], "m.png", None);
    assert!(said.is_ok(), "rings of one pixel fill no area: {said:?}");
    for soft in [
        picture(&|r| (255.0 * (12.5 - r).clamp(0.0, 1.0)) as u8),
        picture(&|r| (255.0 / (1.0 + (r - 12.0).exp())) as u8),
        picture(&|r| if r < 12.0 { 150 + (r * 7.0) as u8 % 3 } else { 100 + (r * 5.0) as u8 % 3 }),
    ] {
        let area = masked(&soft, None).traced[0].contour.moments().area;
        assert!((area - 452.0).abs() < 15.0, "{area}");
    }
}

/// r is a distance from the axis: points from pole to pole, open or closed along the axis, are one side.
#[test]
fn a_side_of_a_section_gets_the_other_one() {
    let side: Vec<[f64; 2]> = (0..=200)
        .map(|k| f64::from(k) / 200.0 * std::f64::consts::PI)
        .map(|t| [2.0 * t.sin(), 3.0 * t.cos()])
        .collect();
    let text = |heading: &str, points: &[[f64; 2]]| {
        let rows: String = points.iter().map(|[r, z]| format!("{r},{z}\n")).collect();
        format!("{heading}\n{rows}")
    };
    let area = |text: &str| {
        let traced = &table(text.as_bytes()).traced[0];
        (traced.contour.moments().area / (6.0 * std::f64::consts::PI), traced.notes.len())
    };
    let half = |at: usize| [&side[at..], &side[..at]].concat();
    for points in [side.clone(), half(80), [&side[..], &side[..1]].concat()] {
        let (whole, notes) = area(&text("r (µm),z (µm)", &points));
        assert!((whole - 1.0).abs() < 1e-3 && notes == 1, "{whole} {notes}");
        let (one_side, notes) = area(&text("x,y", &points));
        assert!((one_side - 0.5).abs() < 1e-3 && notes == 0, "{one_side} {notes}");
    }
    // A section that lies beside the axis, or across it, is whole.
    for aside in [2.5, -0.5] {
        let points = around(200, |t| [aside + 2.0 * t.cos(), 3.0 * t.sin()]);
        let (whole, notes) = area(&text("r,z", &points));
        assert!((whole - 1.0).abs() < 1e-3 && notes == 0, "{aside}: {whole} {notes}");
    }
}

/// Every second column inside, on a spine: as many sides as pixels. Where these are a million it is refused before anything is clipped.
#[test]
fn combs_with_a_million_sides_are_left_out() {
    let comb = |size: usize| {
        let inside = |x: usize, y: usize| (x % 2 == 1 || y + 9 > size) && (1..size - 1).contains(&y);
        let pixels: Vec<u8> = (0..size * size).map(|at| if inside(at % size, at / size) { 200 } else { 0 }).collect();
        masked(&grey([size as u32; 2], &pixels), None)
    };
    let (small, large) = (comb(100), comb(1101));
    // 50 teeth of 91 rows with both their sides, a spine of 7 rows and 100 columns.
    assert_eq!(small.traced[0].contour.points().len(), 50 * 2 * 91 + 2 * 7 + 2 * 100);
    assert!(large.traced.is_empty());
    assert_eq!(large.left_out[0].why, "1000000 points or more; the outline of one cell has fewer");
}

#[test]
fn pictures_that_are_no_masks_are_refused_or_left_out() {
    assert_eq!(masked(&grey([4, 4], &[9; 16]), None).left_out[0].why, "it has one colour alone");
    let whole = grey([64, 64], &(0..4096_u32).map(|k| (k % 251) as u8).collect::<Vec<u8>>());
    for bytes in [&b"GIF89a"[..], &whole[..whole.len() / 2], b""] {
        let error = Contours::default().read_mask(bytes, "m.png", None).unwrap_err().to_string();
        assert!(error.starts_with("m.png: is not a mask, a PNG picture: "), "{error}");
    }
}

/// The depth is a ratio of widths: it does not change with place, angle and scale.
#[test]
fn depth_does_not_depend_on_how_a_cell_lies() {
    let peanut = |turn: f64, scale: f64| {
        let (sin, cos) = turn.sin_cos();
        let points = around(800, |t| {
            let radius = scale * (1.0 + 0.5 * (2.0 * t).cos());
            let (u, v) = (radius * t.cos(), radius * t.sin());
            [9.0 + u * cos - v * sin, u * sin + v * cos]
        });
        furrow(&Contour::new(points).unwrap().0.upright()).depth
    };
    let straight = peanut(0.0, 1.0);
    // Half a width of 0.5 at the waist; the widest place is where r sin t is largest.
    let widest = (0..100_000).map(|k| f64::from(k) * 1e-5 * std::f64::consts::FRAC_PI_2);
    let widest = widest.map(|t| (1.0 + 0.5 * (2.0 * t).cos()) * t.sin()).fold(0.0, f64::max);
    assert!((straight - (1.0 - 0.5 / widest)).abs() < 1e-3, "{straight}");
    for (turn, scale) in [(0.3, 1.0), (1.9, 40.0), (-1.2, 1e-3)] {
        assert!((peanut(turn, scale) - straight).abs() < 2e-3);
    }
}

proptest! {
    /// Two independent methods: exact areas, and the pixels of a fine grid. Stars of any corners, beside or upon each other.
    #[test]
    fn exact_areas_agree_with_pixels(
        radii in prop::collection::vec(0.3_f64..1.0, 5..40),
        others in prop::collection::vec(0.3_f64..1.0, 5..40),
        aside in -2.0_f64..2.0,
    ) {
        let star = |radii: &[f64], aside: f64| {
            let corner = |(k, radius): (usize, &f64)| {
                let t = k as f64 / radii.len() as f64 * std::f64::consts::TAU;
                [aside + radius * t.cos(), radius * t.sin()]
            };
            Contour::new(radii.iter().enumerate().map(corner).collect()).unwrap()
        };
        let ((a, none), (b, _)) = (star(&radii, 0.0), star(&others, aside));
        prop_assert_eq!(none, 0.0);
        let (exact, pixels) = (overlap(&a, &b), overlap_of_pixels(&a, &b, 0.005));
        prop_assert!((exact.similarity - pixels.similarity).abs() < 0.02, "{exact:?} {pixels:?}");
        prop_assert!((exact.jaccard - pixels.jaccard).abs() < 0.02, "{exact:?} {pixels:?}");
        let own = overlap(&a, &a);
        prop_assert!((own.similarity - 1.0).abs() < 1e-6 && (own.jaccard - 1.0).abs() < 1e-6, "{own:?}");
        // Turning both equally changes nothing.
        let turned = overlap(&a.turned(), &b.turned());
        prop_assert!((turned.similarity - exact.similarity).abs() < 1e-6, "{turned:?} {exact:?}");
    }

    /// Any bytes give a contour, a report or an error, never a panic.
    #[test]
    fn no_bytes_break_the_readers(bytes in prop::collection::vec(any::<u8>(), 0..400), head in 0_usize..4) {
        let heads: [&[u8]; 4] = [b"", b"x,y\n", b"contour,x,y\n1,0,0\n", b"\x89PNG\r\n\x1a\n"];
        let whole = [heads[head], &bytes].concat();
        let mut found = Contours::default();
        let _ = found.read_table(&whole[..], "t.csv");
        let _ = found.read_mask(&whole[..], "m.png", None);
        let _ = found.read_mask(&whole[..], "m.png", Some(1));
    }
}

/// Memory is not taken for more pixels than the file can hold.
#[test]
fn a_small_file_that_declares_a_huge_picture_is_refused() {
    let mut bytes = grey([2, 2], &[0; 4]);
    bytes[16..20].copy_from_slice(&10_000_u32.to_be_bytes());
    bytes[20..24].copy_from_slice(&10_000_u32.to_be_bytes());
    let mut checksum = flate2::Crc::new();
    checksum.update(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&checksum.sum().to_be_bytes());
    let said = Contours::default().read_mask(&bytes[..], "m.png", None).unwrap_err().to_string();
    assert!(said.contains("10000 × 10000 pixels cannot be in"), "{said}");
    let endless = std::io::repeat(0);
    let said = Contours::default().read_mask(endless, "zero", None).unwrap_err().to_string();
    assert!(said.contains("it does not begin as one"), "{said}");
}

#[test]
fn a_third_coordinate_and_numbers_of_points_are_no_outlines() {
    let read = |text: &str| table(text.as_bytes());
    let flat = read("z,y,x\n5,0,0\n5,0,2\n5,1,2\n5,1,0\n");
    assert_eq!((flat.traced.len(), flat.left_out.len()), (1, 0));
    let deep = read("z,y,x\n5,0,0\n6,0,2\n7,1,2\n8,1,0\n");
    assert_eq!((deep.traced.len(), deep.left_out[0].line), (0, Some(3)));
    assert!(deep.left_out[0].why.contains("z must be the same"), "{}", deep.left_out[0].why);
    let numbered = read("id,x,y\n1,0,0\n2,2,0\n3,2,1\n4,0,1\n");
    assert_eq!((numbered.traced.len(), numbered.left_out.len()), (1, 0));
}

#[test]
fn files_in_different_units_are_converted_or_refused() {
    let square =
        |unit: &str, side: f64| format!("x ({unit}),y ({unit})\n0,0\n{side},0\n{side},{side}\n0,{side}\n").into_bytes();
    let mut found = Contours::default();
    found.read_table(&square("µm", 4.0)[..], "a.csv").unwrap();
    found.read_table(&square("mm", 0.004)[..], "b.csv").unwrap();
    let areas: Vec<f64> = found.traced.iter().map(|traced| traced.contour.moments().area).collect();
    assert!(areas.iter().all(|area| (area - 16.0).abs() < 1e-9), "{areas:?}");
    let why = found.read_table(&square("px", 4.0)[..], "c.csv").unwrap_err().to_string();
    assert_eq!(why, "c.csv: unit = px: must be um, the unit of the files before");
    let why = found.read_mask(&grey([4, 4], &[0; 16])[..], "m.png", None).unwrap_err().to_string();
    assert!(why.starts_with("m.png: unit = px"), "{why}");
}

#[test]
fn a_side_that_does_not_reach_the_axis_is_not_taken_for_an_outline() {
    let found = table(b"r,z\n0.3,0\n2,1\n2,3\n0.3,4\n");
    assert!(found.traced.is_empty() && found.left_out[0].why.contains("does not reach the axis"), "{found:?}");
    assert_eq!(table(b"r,z\n0,0\n2,1\n2,3\n0,4\n").traced.len(), 1);
}
