//! A surface as PLY, which Blender, MeshLab, ParaView and CloudCompare open.

use std::fmt::Write;

use super::colour::colour;
use super::{SurfaceError, SurfaceFrame};

/// A surface as a binary PLY file: vertices with normals, values and colours, and triangles. `value` describes the values;
/// `strongest` is the value with the strongest colour.
///
/// # Errors
/// [`SurfaceError`].
pub fn ply(frame: &SurfaceFrame, value: &str, strongest: f64) -> Result<Vec<u8>, SurfaceError> {
    let mesh = frame.surface.mesh()?;
    let mut header = String::from(
        "ply\nformat binary_little_endian 1.0\ncomment written by furrow\n\
         comment lengths in L_h; the axis of the shell is z, with the posterior pole at larger z\n",
    );
    let _ = writeln!(header, "comment value: {}", ascii(value));
    for (name, known) in frame.about.iter().filter(|(_, known)| !known.is_null()) {
        let _ = writeln!(header, "comment {}", ascii(&format!("{name} = {known}")));
    }
    let _ = writeln!(header, "element vertex {}", mesh.points.len());
    for name in ["x", "y", "z", "nx", "ny", "nz", "value"] {
        let _ = writeln!(header, "property float {name}");
    }
    for name in ["red", "green", "blue"] {
        let _ = writeln!(header, "property uchar {name}");
    }
    let _ = writeln!(header, "element face {}", mesh.triangles.len());
    header += "property list uchar int vertex_indices\nend_header\n";
    let mut bytes = header.into_bytes();
    for ((point, normal), value) in mesh.points.iter().zip(&mesh.normals).zip(&mesh.values) {
        let numbers = point.iter().chain(normal).chain([value]);
        bytes.extend(numbers.flat_map(|x| (*x as f32).to_le_bytes()));
        bytes.extend(colour(value / strongest));
    }
    for corners in &mesh.triangles {
        bytes.push(3);
        bytes.extend(corners.iter().flat_map(|corner| corner.to_le_bytes()));
    }
    Ok(bytes)
}

/// A text as part of a line of ASCII, as comments are.
fn ascii(text: &str) -> String {
    let plain = |letter: char| match letter {
        'τ' => "tau".to_owned(),
        'κ' => "kappa".to_owned(),
        'φ' => "phi".to_owned(),
        '½' => "0.5 ".to_owned(),
        '²' => "^2".to_owned(),
        '³' => "^3".to_owned(),
        ' '..='~' => letter.to_string(),
        _ => "?".to_owned(),
    };
    text.chars().map(plain).collect()
}
