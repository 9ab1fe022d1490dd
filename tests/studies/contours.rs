//! `furrow compare contour`: outlines of cells and of a simulated division.
//!
//! Images of embryos are not public. The measured outlines here come from a simulated division, moved, turned, scaled and blurred
//! by known amounts, which the comparison must find.

use std::fmt::Write;
use std::path::Path;
use std::sync::OnceLock;

use crate::common::command::{answer, json};
use furrow_formats::frames::read_frames;
use rand_mt::Mt64;
use serde_json::Value;

/// Frames of one division, made once.
fn frames() -> &'static Path {
    static FRAMES: OnceLock<tempfile::TempDir> = OnceLock::new();
    let folder = FRAMES.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let cue = "kappa:band,u0=0.465,omega=0.0577,amplitude=0.1";
        answer(folder.path(), &["divide", "--r0", "4", "--cue", cue, "--frames", "frames", "--no-cache"]);
        folder
    });
    folder.path()
}

/// One in every few frames, both sides of the axis, at 240 places evenly spaced.
fn rings() -> Vec<Vec<[f64; 2]>> {
    let frames = read_frames(&frames().join("frames")).unwrap();
    let picked = frames.iter().step_by(frames.len() / 8).take(8);
    picked
        .map(|frame| {
            let other = frame.points.iter().rev().map(|[r, z]| [-r, *z]);
            let mut ring: Vec<[f64; 2]> = frame.points.iter().copied().chain(other).collect();
            ring.dedup();
            evenly(&ring, 240)
        })
        .collect()
}

fn evenly(ring: &[[f64; 2]], count: usize) -> Vec<[f64; 2]> {
    let next = |k: usize| ring[(k + 1) % ring.len()];
    let side = |k: usize| (next(k)[0] - ring[k][0]).hypot(next(k)[1] - ring[k][1]);
    let whole: f64 = (0..ring.len()).map(side).sum();
    let (mut k, mut passed) = (0, 0.0);
    (0..count)
        .map(|n| {
            let wanted = whole * n as f64 / count as f64;
            while passed + side(k) < wanted {
                passed += side(k);
                k += 1;
            }
            let share = (wanted - passed) / side(k);
            [0, 1].map(|i| ring[k][i] + share * (next(k)[i] - ring[k][i]))
        })
        .collect()
}

/// Turned, scaled and moved.
fn moved(ring: &[[f64; 2]], turn: f64, scale: f64, [x, y]: [f64; 2]) -> Vec<[f64; 2]> {
    let (sin, cos) = turn.sin_cos();
    ring.iter().map(|[u, v]| [x + scale * (u * cos - v * sin), y + scale * (u * sin + v * cos)]).collect()
}

/// Normal noise, by Box and Muller.
fn blurred(ring: &[[f64; 2]], sd: f64, random: &mut Mt64) -> Vec<[f64; 2]> {
    let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    let noisy = |[x, y]: &[f64; 2]| {
        let (radius, angle) = (sd * (-2.0 * (1.0 - uniform()).ln()).sqrt(), std::f64::consts::TAU * uniform());
        [x + radius * angle.cos(), y + radius * angle.sin()]
    };
    ring.iter().map(noisy).collect()
}

fn table(rings: &[Vec<[f64; 2]>]) -> String {
    let mut out = "stage,y,x\n".to_owned();
    for (k, ring) in rings.iter().enumerate() {
        for [x, y] in ring {
            let _ = writeln!(out, "s{k},{y},{x}");
        }
    }
    out
}

fn compared(folder: &Path, arguments: &[&str]) -> Value {
    let folder_of_frames = frames().join("frames");
    let head = ["compare", "contour", "--frames", folder_of_frames.to_str().unwrap()];
    json(folder, &[&head, arguments].concat())
}

/// The comparison of a table of contours.
fn compared_table(rings: &[Vec<[f64; 2]>], more: &[&str]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), table(rings)).unwrap();
    compared(folder.path(), &[&["t.csv"], more].concat())
}

/// Each is found to be its own frame, by a scale that is right, turned as it was turned.
#[test]
fn moved_and_turned_contours_are_laid_upon_themselves() {
    let rings = rings();
    let turns: Vec<f64> = (0..rings.len()).map(|k| 0.4 + 0.9 * k as f64).collect();
    let placed: Vec<_> = rings.iter().zip(&turns).map(|(ring, turn)| moved(ring, *turn, 3.7, [200.0, -80.0])).collect();
    let found = compared_table(&placed, &[]);
    assert_eq!((found["used"].as_u64(), found["n"].as_u64()), (Some(8), Some(8)));
    assert!((found["length_scale"].as_f64().unwrap() / 3.7 - 1.0).abs() < 1e-3, "{}", found["length_scale"]);
    let mut stages = 0;
    for (k, contour) in found["contours"].as_array().unwrap().iter().enumerate() {
        assert_eq!(contour["contour"], format!("s{k}"));
        let overlap = &contour["overlap"];
        let of = |name: &str| overlap[name].as_f64().unwrap();
        assert!(of("similarity") > 0.998 && of("of_model") > 0.998 && of("jaccard") > 0.996, "{contour}");
        assert!((contour["pixels"]["similarity"].as_f64().unwrap() - of("similarity")).abs() < 5e-3, "{contour}");
        assert!(
            (contour["measured"]["depth"].as_f64().unwrap() - contour["model"]["depth"].as_f64().unwrap()).abs() < 0.01
        );
        // The model's axis is the second coordinate: turned by `turn`, it lies a right angle further on.
        let angle = contour["angle"].as_f64().unwrap().to_radians() - turns[k] - std::f64::consts::FRAC_PI_2;
        assert!(angle.sin().abs() < 0.02, "{k}: {angle}");
        stages += usize::from(contour["stage"].is_u64());
    }
    assert_eq!(stages, 6);
}

/// Noise of a sd s moves the outline by s, in and out by turns: of a contour of length P about P·s·√(2/π)/2 lies outside, and the
/// similarity index is less by that share of the area. Twice the noise costs twice as much.
#[test]
fn noise_costs_what_it_must() {
    let mut random = Mt64::new(7);
    let lost = [0.02, 0.04].map(|sd| {
        let noisy = |ring: &Vec<_>| moved(&blurred(ring, sd, &mut random), 1.0, 5.0, [3.0, 9.0]);
        let noisy: Vec<_> = rings().iter().take(4).map(noisy).collect();
        1.0 - compared_table(&noisy, &[])["similarity"].as_f64().unwrap()
    });
    println!("{lost:?}");
    // A cell of R0 = 4 in its shell: P ≈ 26, area ≈ 52. Between points the outline is straight, which averages some of it away.
    let share = 26.0 / 52.0 * 0.02 * (2.0 / std::f64::consts::PI).sqrt() / 2.0;
    assert!((0.5..1.2).contains(&(lost[0] / share)), "{lost:?} {share}");
    assert!((1.6..2.4).contains(&(lost[1] / lost[0])), "{lost:?}");
}

/// A contour of another shape overlaps less, and by how much is known: an ellipse on the undivided cell's own.
#[test]
fn another_scale_gives_the_overlap_of_a_larger_cell() {
    let placed = [moved(&rings()[0], 0.2, 2.0, [0.0, 0.0])];
    // Taken as though one L_h were 1.6 of its units the cell is 1.25 times as long, and all of the model lies within.
    let found = compared_table(&placed, &["--length-scale", "1.6"]);
    let overlap = &found["contours"][0]["overlap"];
    assert!((overlap["similarity"].as_f64().unwrap() - 0.64).abs() < 2e-3, "{overlap}");
    assert!((overlap["of_model"].as_f64().unwrap() - 1.0).abs() < 1e-6);
}

/// Masks of the same contours, the cell bright or dark.
#[test]
fn masks_say_what_their_contours_say() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for (k, ring) in rings().iter().enumerate().step_by(3) {
        let placed = moved(ring, 0.5 + k as f64, 16.0, [128.0, 128.0]);
        let (background, cell) = if k == 3 { (255, 0) } else { (0, 255) };
        let name = format!("m{k}.png");
        write_mask(&folder.path().join(&name), &placed, [background, cell]);
        files.push(name);
    }
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let found = compared(folder.path(), &files);
    assert!((found["length_scale"].as_f64().unwrap() / 16.0 - 1.0).abs() < 5e-3);
    assert!(found["similarity"].as_f64().unwrap() > 0.993, "{}", found["similarity"]);
}

fn write_mask(file: &Path, ring: &[[f64; 2]], [background, cell]: [u8; 2]) {
    const SIDE: u32 = 256;
    let mut pixels = vec![background; (SIDE * SIDE) as usize];
    for row in 0..SIDE {
        let y = f64::from(row) + 0.5;
        for column in 0..SIDE {
            let x = f64::from(column) + 0.5;
            let next = ring.iter().cycle().skip(1);
            let crossed = ring
                .iter()
                .zip(next)
                .filter(|(p, q)| (p[1] <= y) != (q[1] <= y) && p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]) > x);
            if crossed.count() % 2 == 1 {
                pixels[(row * SIDE + column) as usize] = cell;
            }
        }
    }
    let mut encoder = png::Encoder::new(std::fs::File::create(file).unwrap(), SIDE, SIDE);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
}
