//! A task for the tests of this floor: a stick, which breaks in two if it is long enough.

use super::{
    key::CanonicalBytes,
    store::PAYLOAD,
    task::{Record, Task},
};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stick {
    pub length: f64,
}

impl Stick {
    pub fn new(length: f64) -> Stick {
        Stick { length }
    }

    /// Stands in for the solver: long sticks break in halves, those of medium length unequally, short ones not at all.
    pub fn break_in_two(&self) -> Broken {
        let skew = match self.length {
            length if length < 1.0 => None,
            length if length < 8.0 => Some(0.1 * (8.0 - length)),
            _ => Some(0.0),
        };
        let pieces = skew.map(|skew| [-1.0, 1.0].map(|sign| 0.5 * self.length * (1.0 + sign * skew)));
        Broken { skew, pieces, sound: 1.0 / self.length }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Broken {
    pub skew: Option<f64>,
    pub pieces: Option<[f64; 2]>,
    pub sound: f64,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StickError {
    #[error("a stick of length {length} bends")]
    Bends { length: f64 },
}

impl Task for Stick {
    type Record = Broken;
    type Error = StickError;

    fn write_canonical(&self, bytes: &mut CanonicalBytes) {
        bytes.name("stick");
        bytes.real(self.length);
    }

    fn size(&self) -> f64 {
        self.length
    }

    fn with_size(&self, size: f64) -> Stick {
        Stick::new(size)
    }
}

impl Record for Broken {
    const FOLDER: &'static str = "sticks";

    fn encode(&self) -> [u8; PAYLOAD] {
        let mut payload = [0; PAYLOAD];
        payload[0] = u8::from(self.skew.is_some()) + 2 * u8::from(self.pieces.is_some());
        let [left, right] = self.pieces.unwrap_or_default();
        for (place, real) in [self.skew.unwrap_or_default(), left, right, self.sound].into_iter().enumerate() {
            payload[8 * (place + 1)..8 * (place + 2)].copy_from_slice(&real.to_le_bytes());
        }
        payload
    }

    fn decode(payload: &[u8; PAYLOAD]) -> Option<Broken> {
        let real = |place: usize| f64::from_le_bytes(std::array::from_fn(|byte| payload[8 * (place + 1) + byte]));
        (payload[0] < 4).then(|| Broken {
            skew: (payload[0] & 1 != 0).then(|| real(0)),
            pieces: (payload[0] & 2 != 0).then(|| [real(1), real(2)]),
            sound: real(3),
        })
    }

    fn scaled(&self, factor: f64) -> Broken {
        Broken { pieces: self.pieces.map(|pieces| pieces.map(|length| length * factor)), ..self.clone() }
    }

    fn response(&self) -> Option<f64> {
        self.skew
    }
}
