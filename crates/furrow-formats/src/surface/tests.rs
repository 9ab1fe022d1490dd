//! Surfaces with and without an axis as triangles, read back from the files that they are written into.

use std::collections::HashSet;
use std::f64::consts::{PI, TAU};

use furrow_cell::Cell;
use furrow_mechanics::division::{DivisionInput, Trajectory};
use serde_json::{Value, json};

use super::*;

/// An ellipsoid with half axes a, b, c along x, y, z, off the axis by `aside` where it is widest: one side bulges.
fn bulging([a, b, c]: [f64; 3], aside: f64, columns: usize) -> SurfaceGrid {
    let rows = 2 * columns + 1;
    let mut grid = SurfaceGrid { rows, columns, ..SurfaceGrid::default() };
    for k in 0..rows * columns {
        let (u, phi) = ((k / columns) as f64 / (rows - 1) as f64 * PI, (k % columns) as f64 / columns as f64 * TAU);
        let pole = k / columns == 0 || k / columns == rows - 1;
        let (sin, cos) = (if pole { 0.0 } else { u.sin() }, if pole { u.cos().round() } else { u.cos() });
        // A shear of each section keeps its area, and so the volume.
        grid.points.push([a * sin * phi.cos() + aside * sin * sin, b * sin * phi.sin(), c * cos]);
        let [x, y, z] = [sin * phi.cos() / a, sin * phi.sin() / b, cos / c];
        // z = c cos(u), so that the shear is aside·(1 − z²/c²).
        let normal = [x, y, z + x * aside * 2.0 * cos / c];
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        grid.normals.push(normal.map(|x| x / length));
        grid.values.push(phi.cos() * sin);
    }
    grid
}

/// Whether every edge lies in exactly two triangles, once in each direction, and every triangle faces as its normals do.
fn is_closed_and_outward(points: &[[f64; 3]], normals: &[[f64; 3]], triangles: &[[u32; 3]]) -> bool {
    let mut edges = HashSet::new();
    let mut once = true;
    for [a, b, c] in triangles {
        once &= [(a, b), (b, c), (c, a)].into_iter().all(|edge| edges.insert(edge));
    }
    let faces_out = |[a, b, c]: &[u32; 3]| {
        let [p, q, r] = [a, b, c].map(|k| points[*k as usize]);
        let (d, e) = ([0, 1, 2].map(|k| q[k] - p[k]), [0, 1, 2].map(|k| r[k] - p[k]));
        let across = [d[1] * e[2] - d[2] * e[1], d[2] * e[0] - d[0] * e[2], d[0] * e[1] - d[1] * e[0]];
        let along = [a, b, c].map(|k| normals[*k as usize]);
        along.iter().map(|n| (0..3).map(|k| n[k] * across[k]).sum::<f64>()).sum::<f64>() > 0.0
    };
    once && edges.iter().all(|(a, b)| edges.contains(&(*b, *a))) && triangles.iter().all(faces_out)
}

fn volume(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    SurfaceMesh { points: points.to_vec(), triangles: triangles.to_vec(), ..SurfaceMesh::default() }.volume()
}

#[test]
fn a_bulging_grid_is_a_closed_mesh_of_its_volume_in_either_direction() {
    let grid = bulging([2.0, 1.5, 3.0], 0.8, 60);
    let mesh = grid.mesh().unwrap();
    let exact = 4.0 / 3.0 * PI * 2.0 * 1.5 * 3.0;
    assert!(is_closed_and_outward(&mesh.points, &mesh.normals, &mesh.triangles));
    assert!((mesh.volume() / exact - 1.0).abs() < 3e-3, "{} {exact}", mesh.volume());
    assert_eq!(mesh.points.len(), 119 * 60 + 2);
    assert_eq!(mesh.points.len() + mesh.triangles.len() - 3 * mesh.triangles.len() / 2, 2, "a sphere's Euler number");
    // The same surface with columns in the other direction.
    let mut turned = grid.clone();
    turned.points.iter_mut().chain(&mut turned.normals).for_each(|vector| vector[1] = -vector[1]);
    let mesh = turned.mesh().unwrap();
    assert!(mesh.volume() > 0.0 && is_closed_and_outward(&mesh.points, &mesh.normals, &mesh.triangles));
}

#[test]
fn what_is_no_closed_surface_is_refused() {
    let good = bulging([1.0; 3], 0.0, 8);
    let refused = |change: &dyn Fn(&mut SurfaceGrid)| {
        let mut grid = good.clone();
        change(&mut grid);
        grid.mesh().unwrap_err()
    };
    assert_eq!(refused(&|grid| grid.columns = 2), SurfaceError::Small { rows: 17, columns: 2 });
    let count = SurfaceError::Count { name: "values", found: 135, wanted: 136 };
    assert_eq!(refused(&|grid| grid.values.truncate(135)), count);
    let finite = SurfaceError::NotFinite { name: "normal", row: 1, column: 2 };
    assert_eq!(refused(&|grid| grid.normals[10][1] = f64::NAN), finite);
    assert_eq!(refused(&|grid| grid.points[130][0] = 0.5), SurfaceError::OpenPole { row: 16, apart: 0.5 });
}

/// Normals from tangent angles agree with the triangles' normals, and the volume stays constant.
#[test]
fn a_dividing_cell_keeps_its_volume_as_a_mesh() {
    let film = Trajectory::compute(&DivisionInput::new(Cell::gao2026_thresholds(2.5))).unwrap();
    let exact = 4.0 / 3.0 * PI * 2.5_f64.powi(3);
    for share in [0.0, 0.6, 1.0] {
        let places = film.at(share * film.division.t_end).places;
        let mesh = SurfaceGrid::revolved(&places, 96, |place| place.t_uu).mesh().unwrap();
        assert!(is_closed_and_outward(&mesh.points, &mesh.normals, &mesh.triangles), "{share}");
        assert!((mesh.volume() / exact - 1.0).abs() < 5e-3, "{share}: {} {exact}", mesh.volume());
    }
}

fn frame(t: f64, aside: f64) -> SurfaceFrame {
    let about = json!({ "t": t, "chi": null }).as_object().unwrap().clone();
    SurfaceFrame { surface: bulging([2.0, 1.5, 3.0], aside, 24), about }
}

fn float(bytes: &[u8]) -> f64 {
    f64::from(f32::from_le_bytes(bytes.try_into().unwrap()))
}

#[test]
fn a_ply_reads_back_as_it_was() {
    let frame = frame(0.25, 0.8);
    let mesh = frame.surface.mesh().unwrap();
    let bytes = ply(&frame, "mean tension ½(T_uu + T_φφ), in κ0/L_h²", 1.0).unwrap();
    let end = bytes.windows(11).position(|part| part == b"end_header\n").unwrap() + 11;
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    assert!(header.is_ascii(), "{header}");
    for line in ["format binary_little_endian 1.0", "comment t = 0.25", "property float value", "property uchar blue"] {
        assert!(header.lines().any(|found| found == line), "no {line} in {header}");
    }
    assert!(
        header.contains("L_h") && header.contains("comment value: mean tension 0.5 (T_uu") && !header.contains("chi")
    );
    let count = |element: &str| -> usize {
        header.lines().find_map(|line| line.strip_prefix(&format!("element {element} "))).unwrap().parse().unwrap()
    };
    let (vertices, faces) = bytes[end..].split_at(31 * count("vertex"));
    assert_eq!([count("face") * 13, count("face")], [faces.len(), mesh.triangles.len()]);
    let (mut points, mut normals) = (Vec::new(), Vec::new());
    for (k, vertex) in vertices.chunks_exact(31).enumerate() {
        let number = |j: usize| float(&vertex[4 * j..4 * j + 4]);
        points.push([number(0), number(1), number(2)]);
        normals.push([number(3), number(4), number(5)]);
        assert!((number(6) - mesh.values[k]).abs() < 1e-6);
        assert_eq!(vertex[28..], super::colour::colour(mesh.values[k]));
    }
    let corner = |face: &[u8], j: usize| u32::from_le_bytes(face[1 + 4 * j..5 + 4 * j].try_into().unwrap());
    assert!(faces.chunks_exact(13).all(|face| face[0] == 3));
    let triangles: Vec<[u32; 3]> = faces.chunks_exact(13).map(|face| [0, 1, 2].map(|j| corner(face, j))).collect();
    assert!(is_closed_and_outward(&points, &normals, &triangles));
    assert!((volume(&points, &triangles) / mesh.volume() - 1.0).abs() < 1e-5);
}

/// The document and the binary part of a file, with its lengths checked.
fn chunks(bytes: &[u8]) -> (Value, &[u8]) {
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], number(4), number(8)), (&b"glTF"[..], 2, bytes.len()));
    let text = number(12);
    assert_eq!((&bytes[16..20], &bytes[24 + text..28 + text]), (&b"JSON"[..], &b"BIN\0"[..]));
    assert_eq!([text % 4, number(20 + text) % 4, 28 + text + number(20 + text)], [0, 0, bytes.len()]);
    (serde_json::from_slice(&bytes[20..20 + text]).unwrap(), &bytes[28 + text..])
}

/// The bytes of an accessor, with its bounds, alignment and extremes checked.
fn accessed<'b>(document: &Value, binary: &'b [u8], number: &Value) -> &'b [u8] {
    let whole = |value: &Value| value.as_u64().unwrap() as usize;
    let accessor = &document["accessors"][whole(number)];
    let view = &document["bufferViews"][whole(&accessor["bufferView"])];
    let parts = match accessor["type"].as_str().unwrap() {
        "SCALAR" => 1,
        "VEC3" => 3,
        "VEC4" => 4,
        other => panic!("{other}"),
    };
    let kind = whole(&accessor["componentType"]);
    let size = if kind == 5121 { 1 } else { 4 };
    assert_eq!(whole(&view["byteLength"]), whole(&accessor["count"]) * parts * size);
    assert_eq!(whole(&view["byteOffset"]) % 4, 0);
    let bytes = &binary[whole(&view["byteOffset"])..][..whole(&view["byteLength"])];
    if kind == 5126 {
        for c in 0..parts {
            let all = || bytes.chunks_exact(4).skip(c).step_by(parts).map(float);
            let ends = [all().fold(f64::MAX, f64::min), all().fold(f64::MIN, f64::max)];
            let stated = ["min", "max"].map(|name| accessor[name][c].as_f64().unwrap());
            assert!((0..2).all(|k| stated[k] as f32 == ends[k] as f32), "{stated:?} {ends:?}");
        }
    }
    bytes
}

fn vectors(bytes: &[u8]) -> Vec<[f64; 3]> {
    bytes.chunks_exact(12).map(|vector| [0, 1, 2].map(|c| float(&vector[4 * c..4 * c + 4]))).collect()
}

#[test]
fn a_glb_reads_back_as_it_was() {
    let frames: Vec<SurfaceFrame> = (0..4).map(|k| frame(0.1 * f64::from(k), 0.2 * f64::from(k))).collect();
    let bytes = glb(&frames, "tension").unwrap();
    let (document, binary) = chunks(&bytes);
    assert_eq!(document["buffers"][0]["byteLength"].as_u64().unwrap() as usize, binary.len());
    assert_eq!([&document["asset"]["version"], &document["asset"]["extras"]["length_unit"]], ["2.0", "L_h"]);
    assert_eq!([document["meshes"].as_array().unwrap().len(), document["nodes"].as_array().unwrap().len()], [4, 5]);
    let mut indices = HashSet::new();
    for (k, frame) in frames.iter().enumerate() {
        let part = &document["meshes"][k]["primitives"][0];
        let attribute = |name: &str| accessed(&document, binary, &part["attributes"][name]);
        let (points, normals) = (vectors(attribute("POSITION")), vectors(attribute("NORMAL")));
        let mesh = frame.surface.mesh().unwrap();
        let numbers = accessed(&document, binary, &part["indices"]);
        let corners: Vec<u32> =
            numbers.chunks_exact(4).map(|corner| u32::from_le_bytes(corner.try_into().unwrap())).collect();
        let triangles: Vec<[u32; 3]> = corners.chunks_exact(3).map(|corners| corners.try_into().unwrap()).collect();
        assert_eq!(triangles, mesh.triangles);
        assert!(is_closed_and_outward(&points, &normals, &triangles));
        assert!((volume(&points, &triangles) / mesh.volume() - 1.0).abs() < 1e-5);
        assert_eq!([attribute("COLOR_0").len(), attribute("_VALUE").len()], [4 * points.len(); 2]);
        assert!((document["nodes"][k]["extras"]["t"].as_f64().unwrap() - 0.1 * k as f64).abs() < 1e-9);
        indices.insert(part["indices"].as_u64());
    }
    assert_eq!(indices.len(), 1, "frames of one grid share their triangles");
}

/// At every time exactly one frame has a size.
#[test]
fn a_glb_shows_one_frame_after_another() {
    let frames: Vec<SurfaceFrame> = (0..4).map(|k| frame(f64::from(k), 0.1)).collect();
    let bytes = glb(&frames, "tension").unwrap();
    let (document, binary) = chunks(&bytes);
    let animation = &document["animations"][0];
    let scale = |k: usize, time: f64| {
        let channel = &animation["channels"][k];
        assert_eq!([&channel["target"]["node"], &channel["target"]["path"]], [&json!(k), &json!("scale")]);
        let sampler = &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize];
        assert_eq!(sampler["interpolation"], "STEP");
        let times: Vec<f64> = accessed(&document, binary, &sampler["input"]).chunks_exact(4).map(float).collect();
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]) && times[0] == 0.0);
        let scales = vectors(accessed(&document, binary, &sampler["output"]));
        assert_eq!(times.len(), scales.len());
        scales[times.partition_point(|key| *key <= time) - 1][0]
    };
    for step in 0..20 {
        let time = 0.02 + 0.05 * f64::from(step);
        let shown: Vec<usize> = (0..4).filter(|k| scale(*k, time) == 1.0).collect();
        assert_eq!(shown, [((time * 12.0) as usize).min(3)], "{time}");
    }
    let still = document["nodes"].as_array().unwrap().iter().filter(|node| node["scale"] == json!([1.0, 1.0, 1.0]));
    assert_eq!(still.count(), 1, "a viewer without animations shows one");
    let single = glb(&frames[..1], "tension").unwrap();
    assert_eq!(chunks(&single).0.get("animations"), None);
}
