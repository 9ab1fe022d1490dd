//! The function space of surfaces and flows: splines from pole to pole times Fourier modes around the axis.
//!
//! Fields are mirror-symmetric under y → −y. With ζ = x + iy, ζ = Σ ζ_k(u) e^{ikφ} and z = Σ z_m(u) cos mφ have real
//! coefficients. A disturbance e^{imφ} of an axisymmetric surface has ζ_{1+m}, ζ_{1−m} and z_m, and all three are kept for
//! every m up to M: truncating x, y and z at the same Fourier mode would give eigenvalues that converge to wrong values. At the
//! poles ζ_k behaves like s^|k| and z_m like s^m, as for smooth functions of the plane.

use furrow_bvp::gauss::gauss_rule;

use crate::splines::{DEGREE, LocalValues, local_values};

/// One Fourier mode of a vector field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Harmonic {
    /// ζ_k e^{ikφ} in x + iy.
    Across(i32),
    /// z_m cos mφ.
    Along(i32),
}

impl Harmonic {
    /// The mode number m of the disturbance e^{imφ} to which it belongs.
    pub fn azimuthal(self) -> usize {
        match self {
            Harmonic::Across(k) => (k - 1).unsigned_abs() as usize,
            Harmonic::Along(m) => m.unsigned_abs() as usize,
        }
    }

    /// The number of its Fourier mode.
    fn wave(self) -> i32 {
        let (Harmonic::Across(k) | Harmonic::Along(k)) = self;
        k
    }

    /// The mean over the circle of the square of its derivative with respect to φ.
    pub fn turning(self) -> f64 {
        let square = f64::from(self.wave()).powi(2);
        if let Harmonic::Along(_) = self { 0.5 * square } else { square }
    }

    /// All harmonics up to M, ordered by azimuthal mode number.
    fn up_to(modes: usize) -> Vec<Harmonic> {
        let of = |m: i32| match m {
            0 => vec![Harmonic::Across(1), Harmonic::Along(0)],
            m => vec![Harmonic::Across(1 + m), Harmonic::Across(1 - m), Harmonic::Along(m)],
        };
        (0..=modes as i32).flat_map(of).collect()
    }
}

/// Number of Gauss points in an element.
pub(crate) const POINTS: usize = 5;

/// A quadrature point along u.
#[derive(Clone, Debug)]
pub struct Station {
    /// Coordinate u of the mesh.
    pub u: f64,
    /// Quadrature weight.
    pub weight: f64,
    /// Its element, which is also its first spline.
    pub element: usize,
    /// The splines at this point.
    pub basis: LocalValues,
}

/// Cosine and sine of every harmonic at a meridian, without the sign and factor of derivatives with respect to φ.
#[derive(Clone, Debug)]
pub struct Meridian {
    /// Angle φ.
    pub phi: f64,
    /// cos kφ and sin kφ of each harmonic.
    pub wave: Vec<[f64; 2]>,
    /// The entries of a jet that f, f′ and f″ of each harmonic fill.
    pub entries: Vec<[Entries; 3]>,
}

impl Meridian {
    fn new(harmonics: &[Harmonic], phi: f64) -> Meridian {
        let wave = harmonics.iter().map(|h| (phi * f64::from(h.wave())).sin_cos()).map(|(s, c)| [c, s]);
        let wave: Vec<[f64; 2]> = wave.collect();
        let entries = harmonics.iter().zip(&wave).map(|(harmonic, wave)| entries(*harmonic, *wave)).collect();
        Meridian { phi, wave, entries }
    }
}

/// The index of a coefficient among the unknowns.
const FIXED: u32 = u32::MAX;

/// The function space, with its quadrature and the numbering of its unknowns.
#[derive(Clone, Debug)]
pub struct Space {
    /// Number of elements from pole to pole.
    pub elements: usize,
    /// Largest azimuthal mode number M.
    pub modes: usize,
    /// Its Fourier modes.
    pub harmonics: Vec<Harmonic>,
    /// Quadrature along u.
    pub stations: Vec<Station>,
    /// Quadrature along φ ∈ (0, π): equal weights, which sum to 2π for the whole circle.
    pub meridians: Vec<Meridian>,
    /// Unknown of each coefficient: spline × (surface, flow) × harmonic.
    unknown: Vec<u32>,
    /// Ranges of the unknowns of each block of splines; only neighbouring blocks are coupled.
    pub blocks: Vec<std::ops::Range<usize>>,
}

impl Space {
    /// The space of `elements` elements and azimuthal mode numbers up to `modes`.
    pub fn new(elements: usize, modes: usize) -> Space {
        let harmonics = Harmonic::up_to(modes);
        let (points, weights) = gauss_rule(POINTS);
        let stations = (0..elements).flat_map(|element| {
            let (points, weights) = (points.clone(), weights.clone());
            points.into_iter().zip(weights).map(move |(point, weight)| {
                let u = (element as f64 + point) / elements as f64;
                Station { u, weight: weight / elements as f64, element, basis: local_values(elements, element, u) }
            })
        });
        let stations = stations.collect();
        let count = if modes == 0 { 1 } else { 3 * modes };
        let meridian = |j: usize| Meridian::new(&harmonics, std::f64::consts::PI * (j as f64 + 0.5) / count as f64);
        let meridians = (0..count).map(meridian).collect();
        let mut space =
            Space { elements, modes, harmonics, stations, meridians, unknown: Vec::new(), blocks: Vec::new() };
        space.number();
        space
    }

    /// The harmonics of x₀ and z₀ of the rings' centres; there is no x₀ with axial symmetry.
    pub fn centre(&self) -> [Option<usize>; 2] {
        [Harmonic::Across(0), Harmonic::Along(0)].map(|of| self.harmonics.iter().position(|harmonic| *harmonic == of))
    }

    /// The largest coefficient of the harmonics of the largest azimuthal mode number; 0 with axial symmetry.
    pub fn tail(&self, surface: &[f64]) -> f64 {
        let of = |k: &usize| self.modes > 0 && self.harmonics[k % self.harmonics.len()].azimuthal() == self.modes;
        (0..surface.len()).filter(of).map(|k| surface[k].abs()).fold(0.0, f64::max)
    }

    /// The coefficients of the same function in this space, from a space with the same elements.
    pub fn adopt(&self, coefficients: &[f64], of: &Space) -> Vec<f64> {
        let from = |harmonic: &Harmonic| of.harmonics.iter().position(|other| other == harmonic);
        let places: Vec<Option<usize>> = self.harmonics.iter().map(from).collect();
        let row = |spline: usize| {
            let row = &coefficients[spline * of.harmonics.len()..][..of.harmonics.len()];
            places.iter().map(move |place| place.map_or(0.0, |place| row[place]))
        };
        (0..self.splines()).flat_map(row).collect()
    }

    /// Number of splines.
    pub fn splines(&self) -> usize {
        self.elements + DEGREE
    }

    /// Number of coefficients of a surface, or of a flow.
    pub fn coefficients(&self) -> usize {
        self.splines() * self.harmonics.len()
    }

    /// Number of unknowns of surface and flow.
    pub fn unknowns(&self) -> usize {
        self.blocks.last().map_or(0, |block| block.end)
    }

    /// Weight of a meridian.
    pub fn meridian_weight(&self) -> f64 {
        2.0 * std::f64::consts::PI / self.meridians.len() as f64
    }

    /// The unknown of a coefficient of the surface (`field` 0) or the flow (1); `None` if it is zero at a pole.
    pub fn unknown(&self, spline: usize, field: usize, harmonic: usize) -> Option<usize> {
        let index = self.unknown[(2 * spline + field) * self.harmonics.len() + harmonic];
        (index != FIXED).then_some(index as usize)
    }

    /// Numbers the unknowns by splines, and groups them into blocks of at least [`DEGREE`] splines.
    fn number(&mut self) {
        let splines = self.splines();
        let mut next = 0;
        let mut starts = Vec::new();
        self.unknown = Vec::with_capacity(2 * self.coefficients());
        for spline in 0..splines {
            starts.push(next as usize);
            let from_pole = spline.min(splines - 1 - spline);
            for _ in 0..2 {
                for harmonic in &self.harmonics {
                    let wave = harmonic.wave().unsigned_abs() as usize;
                    self.unknown.push(if from_pole < wave.min(DEGREE) {
                        FIXED
                    } else {
                        next += 1;
                        next - 1
                    });
                }
            }
        }
        // An axisymmetric function has no slope at a pole, so its first two coefficients there are one unknown.
        let width = 2 * self.harmonics.len();
        for (outer, inner) in [(0, 1), (splines - 1, splines - 2)] {
            for k in 0..width {
                if self.harmonics[k % self.harmonics.len()].wave() == 0 {
                    self.unknown[outer * width + k] = self.unknown[inner * width + k];
                }
            }
        }
        self.close_gaps();
        let blocks = splines / DEGREE;
        let first = |block: usize| if block == blocks { splines } else { block * DEGREE };
        let range = |block: usize| {
            let of = self.unknown[first(block) * width..first(block + 1) * width].iter().filter(|k| **k != FIXED);
            let (low, high) = of.fold((u32::MAX, 0), |(low, high), k| (low.min(*k), high.max(*k)));
            low as usize..high as usize + 1
        };
        self.blocks = (0..blocks).map(range).collect();
    }

    /// Numbers the unknowns without gaps, in the same order.
    fn close_gaps(&mut self) {
        let mut used: Vec<u32> = self.unknown.iter().copied().filter(|k| *k != FIXED).collect();
        used.sort_unstable();
        used.dedup();
        for k in self.unknown.iter_mut().filter(|k| **k != FIXED) {
            *k = used.binary_search(k).map_or(FIXED, |place| place as u32);
        }
    }

    /// Values and two derivatives with respect to u of a function at a station; `coefficients` by spline × harmonic.
    pub fn function(&self, coefficients: &[f64], station: &Station, harmonic: usize) -> [f64; 3] {
        let mut out = [0.0; 3];
        for (r, basis) in station.basis.iter().enumerate() {
            let c = coefficients[(station.element + r) * self.harmonics.len() + harmonic];
            for (out, b) in out.iter_mut().zip(basis) {
                *out += c * b;
            }
        }
        out
    }

    /// All functions at a station.
    pub fn functions(&self, coefficients: &[f64], station: &Station, out: &mut Vec<[f64; 3]>) {
        out.clear();
        out.extend((0..self.harmonics.len()).map(|harmonic| self.function(coefficients, station, harmonic)));
    }

    /// The values at a meridian of any angle.
    pub fn meridian(&self, phi: f64) -> Meridian {
        Meridian::new(&self.harmonics, phi)
    }

    /// The values at a ring of any u.
    pub fn station(&self, u: f64) -> Station {
        let element = crate::splines::element_of(self.elements, u);
        Station { u, weight: 0.0, element, basis: local_values(self.elements, element, u) }
    }

    /// X, X_u, X_φ, X_uu, X_uφ, X_φφ on a meridian, from the functions at a station.
    pub fn shape(&self, functions: &[[f64; 3]], meridian: &Meridian) -> [[f64; 3]; 6] {
        let mut out = [[0.0; 3]; 6];
        for ((harmonic, f), [cos, sin]) in self.harmonics.iter().zip(functions).zip(&meridian.wave) {
            let k = f64::from(harmonic.wave());
            match harmonic {
                Harmonic::Across(_) => {
                    for (row, value) in [(0, f[0]), (1, f[1]), (3, f[2]), (5, -k * k * f[0])] {
                        out[row][0] += value * cos;
                        out[row][1] += value * sin;
                    }
                    for (row, value) in [(2, k * f[0]), (4, k * f[1])] {
                        out[row][0] -= value * sin;
                        out[row][1] += value * cos;
                    }
                }
                Harmonic::Along(_) => {
                    for (row, value) in [(0, f[0]), (1, f[1]), (3, f[2]), (5, -k * k * f[0])] {
                        out[row][2] += value * cos;
                    }
                    out[2][2] -= k * f[0] * sin;
                    out[4][2] -= k * f[1] * sin;
                }
            }
        }
        out
    }
}

/// Nonzero entries of a jet: (3·row + component, factor).
#[derive(Clone, Copy, Debug, Default)]
pub struct Entries {
    list: [(usize, f64); 6],
    count: usize,
}

impl Entries {
    fn push(&mut self, row: usize, component: usize, factor: f64) {
        self.list[self.count] = (3 * row + component, factor);
        self.count += 1;
    }

    /// The entries.
    pub fn list(&self) -> &[(usize, f64)] {
        &self.list[..self.count]
    }
}

/// Entries of X, X_u, X_φ, X_uu, X_uφ, X_φφ to which a function f(u) of this harmonic contributes by f, by f′ and by f″.
fn entries(harmonic: Harmonic, [cos, sin]: [f64; 2]) -> [Entries; 3] {
    let k = f64::from(harmonic.wave());
    let mut out = [Entries::default(); 3];
    // (derivative with respect to u, row, derivatives with respect to φ)
    for (d, row, turns) in [(0, 0, 0), (0, 2, 1), (0, 5, 2), (1, 1, 0), (1, 4, 1), (2, 3, 0)] {
        let [by_cos, by_sin] = match turns {
            0 => [cos, sin],
            1 => [-k * sin, k * cos],
            _ => [-k * k * cos, -k * k * sin],
        };
        match harmonic {
            Harmonic::Across(_) => {
                out[d].push(row, 0, by_cos);
                out[d].push(row, 1, by_sin);
            }
            Harmonic::Along(_) => out[d].push(row, 2, by_cos),
        }
    }
    out
}
