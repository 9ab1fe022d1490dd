//! Surfaces as binary glTF 2.0, which Blender, three.js and most viewers open.

use serde_json::{Value, json};

use super::colour::{blended, strongest};
use super::{SurfaceError, SurfaceFrame, SurfaceMesh};

/// Seconds for which a frame is shown, and the last one.
const SHOWN: f32 = 1.0 / 12.0;
const LAST: f32 = 1.5;
/// Numbers of the specification: types of components, uses of buffers.
const FLOAT: u32 = 5126;
const BYTE: u32 = 5121;
const INDEX: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
/// The axis of the cell becomes x, and the direction of the first column y, upwards.
const TURN: [f32; 4] = [0.5; 4];

/// Frames as one binary glTF file: a mesh for each, with normals, colours and the attribute `_VALUE`, and an animation
/// that shows them in turn by their scales. `value` describes the values.
///
/// # Errors
/// [`SurfaceError`].
pub fn glb(frames: &[SurfaceFrame], value: &str) -> Result<Vec<u8>, SurfaceError> {
    let mut file = Buffer::default();
    let strongest = strongest(frames);
    let (mut meshes, mut nodes, mut indices) = (Vec::new(), Vec::new(), Indices::default());
    // A viewer that plays no animation shows a frame with a deep furrow.
    let (last, deep) = (frames.len().saturating_sub(1), frames.len() * 4 / 5);
    for (k, frame) in frames.iter().enumerate() {
        let mesh = frame.surface.mesh()?;
        meshes.push(json!({ "primitives": [{
            "attributes": file.vertices(&mesh, strongest), "indices": indices.of(&mut file, &mesh.triangles), "material": 0,
        }] }));
        let scale = [if k == deep { 1.0 } else { 0.0 }; 3];
        nodes.push(json!({ "name": format!("frame {k:04}"), "mesh": k, "scale": scale, "extras": frame.about }));
    }
    let root = nodes.len();
    nodes.push(json!({ "name": "division", "rotation": TURN, "children": (0..root).collect::<Vec<_>>() }));
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    for k in (0..root).filter(|_| last > 0) {
        samplers.push(file.visibility(k, last));
        channels.push(json!({ "sampler": k, "target": { "node": k, "path": "scale" } }));
    }
    let material = json!({
        "name": "cortex",
        "pbrMetallicRoughness": { "baseColorFactor": [1.0, 1.0, 1.0, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.5 },
    });
    let mut document = json!({
        "asset": { "version": "2.0", "generator": "furrow", "extras": {
            "length_unit": "L_h", "time_unit": "τ", "value": value, "strongest_colour": strongest,
            "axes": "before the turn of the node `division`, the axis of the shell is z, with the posterior pole at larger z",
        } },
        "scene": 0,
        "scenes": [{ "nodes": [root] }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [material],
        "accessors": file.accessors,
        "bufferViews": file.views,
        "buffers": [{ "byteLength": file.bytes.len() }],
    });
    if last > 0 {
        document["animations"] = json!([{ "name": "division", "samplers": samplers, "channels": channels }]);
    }
    container(document.to_string().into_bytes(), file.bytes).ok_or(SurfaceError::Large)
}

/// The two chunks after the header of the file; `None` beyond the 4 GB that the header can count.
fn container(mut text: Vec<u8>, mut binary: Vec<u8>) -> Option<Vec<u8>> {
    text.resize(text.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF".to_vec();
    let total = u32::try_from(12 + 8 + text.len() + 8 + binary.len()).ok()?;
    bytes.extend([2, total].into_iter().flat_map(u32::to_le_bytes));
    for (kind, chunk) in [(b"JSON", text), (b"BIN\0", binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    Some(bytes)
}

/// The triangles that were written last, and their accessor: frames of the same grid share them.
#[derive(Default)]
struct Indices {
    triangles: Vec<[u32; 3]>,
    accessor: usize,
}

impl Indices {
    fn of(&mut self, file: &mut Buffer, triangles: &[[u32; 3]]) -> usize {
        if self.triangles != triangles {
            let bytes = triangles.iter().flatten().flat_map(|corner| corner.to_le_bytes());
            let accessor = json!({ "componentType": INDEX, "count": 3 * triangles.len(), "type": "SCALAR" });
            *self = Indices { triangles: triangles.to_vec(), accessor: file.add(bytes, Some(INDICES), accessor) };
        }
        self.accessor
    }
}

/// The binary part of the file, with its description.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Adds bytes and their accessor, and returns the accessor's index. Lengths are multiples of four bytes.
    fn add(&mut self, bytes: impl Iterator<Item = u8>, target: Option<u32>, mut accessor: Value) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let mut view = json!({ "buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Adds vectors of N numbers with their extremes.
    fn floats<const N: usize>(&mut self, vectors: &[[f32; N]], target: Option<u32>) -> usize {
        let extreme = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..N).filter_map(|c| vectors.iter().map(|vector| vector[c]).reduce(pick)).collect()
        };
        let kind = if N == 1 { "SCALAR" } else { "VEC3" };
        let accessor = json!({
            "componentType": FLOAT, "count": vectors.len(), "type": kind, "min": extreme(f32::min), "max": extreme(f32::max),
        });
        self.add(vectors.iter().flatten().flat_map(|x| x.to_le_bytes()), target, accessor)
    }

    /// Adds the vertices of a mesh and returns its attributes.
    fn vertices(&mut self, mesh: &SurfaceMesh, strongest: f64) -> Value {
        let single = |vectors: &[[f64; 3]]| vectors.iter().map(|vector| vector.map(|x| x as f32)).collect::<Vec<_>>();
        let values: Vec<[f32; 1]> = mesh.values.iter().map(|value| [*value as f32]).collect();
        let colours = mesh.values.iter().flat_map(|value| {
            let [r, g, b] = blended(value / strongest).map(linear);
            [r, g, b, 255]
        });
        let painted = json!({
            "componentType": BYTE, "normalized": true, "count": mesh.values.len(), "type": "VEC4",
        });
        json!({
            "POSITION": self.floats(&single(&mesh.points), Some(VERTICES)),
            "NORMAL": self.floats(&single(&mesh.normals), Some(VERTICES)),
            "COLOR_0": self.add(colours, Some(VERTICES), painted),
            "_VALUE": self.floats(&values, Some(VERTICES)),
        })
    }

    /// The sampler of frame k's scale: 1 while it is shown, else 0.
    fn visibility(&mut self, k: usize, last: usize) -> Value {
        let from = k as f32 * SHOWN;
        let until = from + if k == last { LAST } else { SHOWN };
        let mut keys = vec![([from], [1.0; 3]), ([until], [if k == last { 1.0 } else { 0.0 }; 3])];
        if k > 0 {
            keys.insert(0, ([0.0], [0.0; 3]));
        }
        let (times, scales): (Vec<[f32; 1]>, Vec<[f32; 3]>) = keys.into_iter().unzip();
        json!({ "input": self.floats(&times, None), "output": self.floats(&scales, None), "interpolation": "STEP" })
    }
}

/// A component of an sRGB colour, from 0 to 255, as the linear one that glTF uses.
fn linear(part: f64) -> u8 {
    let share = part / 255.0;
    let light = if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) };
    (255.0 * light).round() as u8
}
