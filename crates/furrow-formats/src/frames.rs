//! Frames of a dividing cell: its contour with curvatures and forces as CSV, or its surface as PLY or glTF.

use super::files::{FileSet, WriteError, check_file, check_folder, write_atomically};
use super::surface::{SurfaceFrame, SurfaceGrid, glb, ply, strongest};
use furrow_input::table::{Table, malformed, text as table_text};
use furrow_input::{InputError, read_text};
use furrow_mechanics::cortex::forces::Place;
use furrow_mechanics::division::{Snapshot, Trajectory};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::io;
use std::path::{Path, PathBuf};

/// The entry of a frame in the list, without its file name.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct About {
    /// Time, in τ.
    pub t: f64,
    /// Radius of the neck, in L_h; null without a waist.
    pub neck_radius: Option<f64>,
    /// Where it is.
    pub neck_u: Option<f64>,
    /// Distance of its centre from the axis, towards +x, in L_h; absent with axial symmetry.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neck_offset: Option<f64>,
    /// Contour length L, in L_h.
    pub length: f64,
    /// Pressure p, in κ0/L_h³.
    pub pressure: f64,
    /// |V_above − V_below|/V of the parts on both sides of the neck.
    pub chi: Option<f64>,
}

impl About {
    fn of(still: &Snapshot) -> About {
        About {
            t: still.t,
            neck_radius: still.neck.map(|neck| neck.radius),
            neck_u: still.neck.map(|neck| neck.u),
            neck_offset: None,
            length: still.length,
            pressure: still.pressure,
            chi: still.neck.map(|_| still.asymmetry.abs()),
        }
    }

    /// As metadata of a surface.
    pub fn fields(&self) -> Map<String, Value> {
        match json!(self) {
            Value::Object(fields) => fields,
            _ => Map::new(),
        }
    }
}

/// Name of the list of frames in a folder of contours.
pub const INDEX: &str = "frames.json";
/// Columns of an axisymmetric surface.
const COLUMNS_AROUND: usize = 64;
/// The values of an axisymmetric surface.
pub const TENSION: &str = "mean tension ½(T_uu + T_φφ), active and viscous, in κ0/L_h²";

/// The files of the frames of a division.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameFiles {
    /// A folder with `frame_NNNN.csv` and [`INDEX`].
    Csv(PathBuf),
    /// `NAME_NNNN.ply` in a folder, and their list `NAME.json`.
    Ply(PathBuf, String),
    /// One file with all of them.
    Glb(PathBuf),
}

impl FrameFiles {
    /// The files that a path names: surfaces if it ends in `.ply` or `.glb`, in upper or lower case, and is no folder,
    /// else contours in the folder of this name.
    pub fn of(path: &Path) -> FrameFiles {
        let extension = path.extension().and_then(|name| name.to_str()).unwrap_or_default().to_ascii_lowercase();
        match (extension.as_str(), path.file_stem().and_then(|name| name.to_str())) {
            ("ply", Some(name)) if !path.is_dir() => {
                let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
                FrameFiles::Ply(folder.unwrap_or(Path::new(".")).to_owned(), name.to_owned())
            }
            ("glb", _) if !path.is_dir() => FrameFiles::Glb(path.to_owned()),
            _ => FrameFiles::Csv(path.to_owned()),
        }
    }

    /// Checks that the files can be written, before the work that they show.
    ///
    /// # Errors
    /// [`WriteError`], also of a list that has other content than frames: it would be replaced.
    pub fn check(&self) -> Result<(), WriteError> {
        match self {
            FrameFiles::Csv(folder) => Series::of_contours(folder).check(),
            FrameFiles::Ply(folder, stem) => Series::of_surfaces(folder, stem).check(),
            FrameFiles::Glb(path) => check_file(path),
        }
    }
}

/// Several files, one a frame, and their list.
struct Series<'a> {
    folder: &'a Path,
    stem: &'a str,
    extension: &'a str,
    index: String,
}

/// The columns of a frame:
///
/// | column | |
/// |---|---|
/// | `u` | arclength fraction, 0 at the posterior pole |
/// | `r` | distance from the axis, L_h |
/// | `z` | position along the axis, L_h |
/// | `psi` | tangent angle ψ, from 0 to π |
/// | `c_uu` | meridional curvature c1, 1/L_h |
/// | `c_pp` | azimuthal curvature c2, 1/L_h |
/// | `t_uu` | meridional tension T_uu, active and viscous, κ0/L_h² |
/// | `t_pp` | azimuthal tension T_φφ, active and viscous, κ0/L_h² |
/// | `v` | tangential velocity towards larger u, L_h/τ |
/// | `v_n` | normal velocity outwards, L_h/τ |
/// | `active_t` | active force density along the contour, towards larger u, κ0/L_h³ |
/// | `active_n` | active normal force, outwards as all that follow, κ0/L_h³ |
/// | `viscous_n` | viscous normal force |
/// | `elastic_n` | elastic normal force: bending and passive tension |
/// | `pressure_n` | pressure |
/// | `shell_n` | force of the shell |
/// | `residual_n` | sum of the five, 0 of an exact solution |
/// | `phi` | the regulator φ: only of a cell that has one |
pub const COLUMNS: &str =
    "u r z psi c_uu c_pp t_uu t_pp v v_n active_t active_n viscous_n elastic_n pressure_n shell_n residual_n phi";

/// The frames of a division: one after each step, or one every `every` τ and the last.
pub fn stills(film: &Trajectory, every: Option<f64>) -> Vec<Snapshot> {
    match every {
        None => (0..film.times().len()).map(|number| film.step(number)).collect(),
        Some(step) => film.uniform_times(step).into_iter().map(|t| film.at(t)).collect(),
    }
}

/// Most frames at even times.
const MOST_FRAMES: f64 = 100_000.0;

/// Refuses a step that gives more than 100 000 frames, as of a cell that waits for thousands of τ. Errors name `source_name`.
///
/// # Errors
/// Names the least allowed step.
pub fn check_step(source_name: &str, t_end: f64, every: Option<f64>) -> Result<(), InputError> {
    let least = t_end / MOST_FRAMES;
    match every.filter(|step| *step < least) {
        None => Ok(()),
        Some(step) => {
            let allowed = format!("at least {least:.3e}: the division takes {t_end:.3} τ");
            Err(InputError::not_allowed(source_name, "frame_step", step, allowed))
        }
    }
}

/// Writes the frames of a division. Without `every` there is a frame after each step, with it a frame every `every` τ, and
/// the last shape. [`FrameFiles::of`] says which files a path names:
///
/// * a folder: `frame_NNNN.csv` with the [`COLUMNS`], a row at each collocation point and at both poles, and `frames.json`
///   with the time and the neck of each;
/// * `NAME.ply`: surfaces as `NAME_NNNN.ply`, from the same points, and the same list as `NAME.json`;
/// * `NAME.glb`: all surfaces in one file.
///
/// They replace the frames that an earlier list names. Other files stay.
///
/// # Errors
/// [`WriteError`].
pub fn write_frames(path: &Path, film: &Trajectory, every: Option<f64>) -> Result<(), WriteError> {
    let stills = stills(film, every);
    let files = FrameFiles::of(path);
    if let FrameFiles::Csv(folder) = &files {
        return Series::of_contours(folder)
            .write(stills.iter().map(|still| Ok((csv(still).into_bytes(), About::of(still).fields()))));
    }
    write_surfaces(&files, &stills.iter().map(surface).collect::<Vec<_>>(), TENSION)
}

/// The axisymmetric surface of a shape, with [`TENSION`].
pub fn surface(still: &Snapshot) -> SurfaceFrame {
    SurfaceFrame {
        surface: SurfaceGrid::revolved(&still.places, COLUMNS_AROUND, |place| 0.5 * (place.t_uu + place.t_pp)),
        about: About::of(still).fields(),
    }
}

/// Writes surfaces, with or without an axis, as PLY or glTF. `value` says what their values are, with the unit. They
/// replace the frames that an earlier list names.
///
/// # Errors
/// [`WriteError`], also of a grid that is no closed surface, and of a folder of contours.
pub fn write_surfaces(files: &FrameFiles, frames: &[SurfaceFrame], value: &str) -> Result<(), WriteError> {
    match files {
        FrameFiles::Csv(folder) => Err(failed(folder, "surfaces are written into files that end in .ply or .glb")),
        FrameFiles::Glb(path) => write_atomically(path, &glb(frames, value).map_err(|error| failed(path, error))?),
        FrameFiles::Ply(folder, stem) => {
            let strongest = strongest(frames);
            let bytes = |frame: &SurfaceFrame| ply(frame, value, strongest).map_err(|error| failed(folder, error));
            Series::of_surfaces(folder, stem).write(frames.iter().map(|frame| Ok((bytes(frame)?, frame.about.clone()))))
        }
    }
}

fn failed(path: &Path, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> WriteError {
    WriteError { path: path.display().to_string(), source: io::Error::other(source) }
}

impl<'a> Series<'a> {
    fn of_contours(folder: &'a Path) -> Series<'a> {
        Series { folder, stem: "frame", extension: "csv", index: INDEX.to_owned() }
    }

    fn of_surfaces(folder: &'a Path, stem: &'a str) -> Series<'a> {
        Series { folder, stem, extension: "ply", index: format!("{stem}.json") }
    }

    fn check(&self) -> Result<(), WriteError> {
        check_folder(self.folder, &[&self.index])?;
        self.listed().map(drop)
    }

    /// Name of a frame, counted from 0.
    fn name(&self, number: usize) -> String {
        format!("{}_{number:04}.{}", self.stem, self.extension)
    }

    /// Writes the frames and their list together, and removes those that an earlier list names.
    fn write(
        &self,
        frames: impl Iterator<Item = Result<(Vec<u8>, Map<String, Value>), WriteError>>,
    ) -> Result<(), WriteError> {
        let earlier = self.listed()?;
        let mut files = FileSet::new(self.folder);
        let mut entries = Vec::new();
        for (number, frame) in frames.enumerate() {
            let (bytes, about) = frame?;
            let name = self.name(number);
            files.stage(&name, &bytes)?;
            entries.push(std::iter::once(("file".to_owned(), json!(name))).chain(about).collect::<Map<_, _>>());
        }
        let index = serde_json::to_string_pretty(&entries);
        let index = index.map_err(|error| failed(&self.folder.join(&self.index), error))?;
        files.stage(&self.index, format!("{index}\n").as_bytes())?;
        files.commit()?;
        let left = earlier.into_iter().filter(|number| *number >= entries.len());
        remove(left.map(|number| self.folder.join(self.name(number))))
    }

    /// The numbers of the files that the folder's list names, if they are named like frames; empty without a list.
    ///
    /// # Errors
    /// The list has other content than frames.
    fn listed(&self) -> Result<Vec<usize>, WriteError> {
        let list = self.folder.join(&self.index);
        let Ok(text) = std::fs::read(&list) else { return Ok(Vec::new()) };
        let listed: Vec<Listed> = serde_json::from_slice(&text)
            .map_err(|_| failed(&list, "it lists no frames, and would be replaced by their list"))?;
        let number = |file: &str| {
            let number = file.strip_prefix(self.stem)?.strip_prefix('_')?.strip_suffix(self.extension)?;
            number.strip_suffix('.')?.parse().ok()
        };
        let frame = |entry: Listed| number(&entry.file).filter(|number| entry.file == self.name(*number));
        Ok(listed.into_iter().filter_map(frame).collect())
    }
}

/// The numbers of the [`COLUMNS`] at a place; the last one is missing without a regulator.
pub fn row(p: &Place) -> impl Iterator<Item = f64> {
    let head = [p.u, p.r, p.z, p.psi, p.c_uu, p.c_pp, p.t_uu, p.t_pp, p.v, p.v_n, p.active_tangential];
    head.into_iter().chain(p.normal.parts()).chain([p.normal.residual()]).chain(p.phi)
}

/// One frame as CSV under the names of its columns.
fn csv(still: &Snapshot) -> String {
    let count = still.places.first().map_or(0, |place| row(place).count());
    let names: Vec<&str> = COLUMNS.split(' ').take(count).collect();
    let line = |place| row(place).map(|number| number.to_string()).collect::<Vec<_>>().join(",");
    std::iter::once(names.join(",")).chain(still.places.iter().map(line)).map(|line| line + "\n").collect()
}

/// The contour of a frame that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameContour {
    /// Name of its file.
    pub file: String,
    /// Time, in τ.
    pub t: f64,
    /// Radius and position along the axis, in L_h, from pole to pole.
    pub points: Vec<[f64; 2]>,
}

/// The fields that are read of an entry.
#[derive(Deserialize)]
struct Listed {
    file: String,
    t: f64,
}

/// Reads the contours of a division that [`write_frames`] has written into `folder`.
///
/// # Errors
/// A folder without the list of frames, or a frame that is not as it was written, with line and column.
pub fn read_frames(folder: &Path) -> Result<Vec<FrameContour>, InputError> {
    let index = folder.join(INDEX);
    let listed: Vec<Listed> = serde_json::from_str(&read_text(&index)?).map_err(|error| {
        InputError::other_file(index.display(), "a list of frames, as furrow divide --frames writes it", error)
    })?;
    let read = |listed: Listed| {
        // The list names files beside itself and no others.
        if Path::new(&listed.file).components().count() != 1 {
            let file = index.display().to_string();
            return Err(InputError::not_allowed(file, "file", listed.file, "the name of a file in the same folder"));
        }
        let path = folder.join(&listed.file);
        let points = read_contour(&read_text(&path)?, &path.display().to_string())?;
        Ok(FrameContour { file: listed.file, t: listed.t, points })
    };
    listed.into_iter().map(read).collect()
}

/// The columns r and z of a frame.
fn read_contour(text: &str, file: &str) -> Result<Vec<[f64; 2]>, InputError> {
    let mut table = Table::open(text.as_bytes(), file)?;
    let (line, names) = table.header(|_| false)?;
    let find = |wanted: &str| {
        let why = format!("no column is called {wanted}, as in every frame that furrow writes");
        names.iter().position(|name| name == wanted).ok_or_else(|| malformed(file, line, why))
    };
    let columns = [find("r")?, find("z")?];
    let mut points = Vec::new();
    while let Some(row) = table.next_row()? {
        let refused = |column: usize, message: String| InputError::Malformed {
            file: file.to_owned(),
            line: row.line as usize,
            column: column + 1,
            message,
        };
        if let Some((column, why)) = row.surplus() {
            return Err(refused(column, why));
        }
        let number = |column: usize| {
            let text = table_text(row.text(column));
            row.number(column).map_err(|why| refused(column, format!("{text:?} is {why}")))
        };
        points.push([number(columns[0])?, number(columns[1])?]);
    }
    Ok(points)
}

/// Removes files, as far as they are still there.
fn remove(files: impl Iterator<Item = PathBuf>) -> Result<(), WriteError> {
    for path in files {
        match std::fs::remove_file(&path) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                return Err(WriteError { path: path.display().to_string(), source });
            }
            _ => {}
        }
    }
    Ok(())
}
