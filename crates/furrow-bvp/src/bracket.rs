//! The Illinois method for a root between two values.

/// Two values around a root, with the function's values there. Values of x come from the caller, who may also interpolate.
///
/// # Examples
/// x² = 2:
///
/// ```
/// use furrow_bvp::Bracket;
///
/// let mut bracket = Bracket::new([[1.0, -1.0], [2.0, 2.0]]);
/// for _ in 0..12 {
///     let x = bracket.secant();
///     bracket.keep([x, x * x - 2.0]);
/// }
/// assert!((bracket.secant() - 2f64.sqrt()).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Bracket {
    /// x and the value there, at both ends.
    pub ends: [[f64; 2]; 2],
    last_side: Option<usize>,
}

impl Bracket {
    /// Between two points.
    pub fn new(ends: [[f64; 2]; 2]) -> Bracket {
        Bracket { ends, last_side: None }
    }

    /// Where the line through the ends vanishes.
    pub fn secant(&self) -> f64 {
        let [[a, at_a], [b, at_b]] = self.ends;
        a + at_a / (at_a - at_b) * (b - a)
    }

    /// Puts a new point in the place of the end with its sign. If the same end is replaced twice in succession, the value at the other end
    /// is halved, so that this end moves too.
    pub fn keep(&mut self, point: [f64; 2]) {
        let side = usize::from(point[1] * self.ends[1][1] > 0.0);
        self.ends[side] = point;
        if self.last_side.replace(side) == Some(side) {
            self.ends[1 - side][1] *= 0.5;
        }
    }
}
