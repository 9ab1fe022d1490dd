//! Numbers that embryos share or have each to themselves.

use furrow_input::{InputError, listed};

/// A number for all embryos, and others for some by their names.
///
/// # Examples
/// ```
/// use furrow_measured::per_embryo::PerEmbryo;
/// let minutes = PerEmbryo::new([(None, 1.5), (Some("late".to_owned()), 2.0)]);
/// assert_eq!([minutes.of("early"), minutes.of("late")], [Some(1.5), Some(2.0)]);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PerEmbryo {
    all: Option<f64>,
    of: Vec<(String, f64)>,
}

impl From<Option<f64>> for PerEmbryo {
    fn from(all: Option<f64>) -> PerEmbryo {
        PerEmbryo { all, of: Vec::new() }
    }
}

impl PerEmbryo {
    /// Numbers of embryos by name; without a name of all others. Of several numbers of one embryo the last is taken.
    pub fn new(numbers: impl IntoIterator<Item = (Option<String>, f64)>) -> PerEmbryo {
        let mut found = PerEmbryo::default();
        for (embryo, number) in numbers {
            match embryo {
                Some(embryo) => found.of.push((embryo, number)),
                None => found.all = Some(number),
            }
        }
        found
    }

    /// The same of a list in which no embryo has two numbers; errors name the option.
    ///
    /// # Errors
    /// The first embryo that has two.
    pub fn of_list(numbers: &[(Option<String>, f64)], option: &str) -> Result<PerEmbryo, InputError> {
        let again =
            |(k, (embryo, _)): &(usize, &(Option<String>, f64))| numbers[..*k].iter().any(|(other, _)| other == embryo);
        match numbers.iter().enumerate().find(again) {
            None => Ok(PerEmbryo::new(numbers.iter().cloned())),
            Some((_, (embryo, number))) => {
                let of = embryo.as_ref().map_or("all embryos".to_owned(), |embryo| format!("{embryo:?}"));
                Err(InputError::not_allowed(option, "value", number, format!("left out: it is the second one of {of}")))
            }
        }
    }

    /// The number of an embryo.
    pub fn of(&self, embryo: &str) -> Option<f64> {
        self.of.iter().rev().find(|(name, _)| name == embryo).map(|(_, number)| *number).or(self.all)
    }

    /// Whether there is no number.
    pub fn is_empty(&self) -> bool {
        self.all.is_none() && self.of.is_empty()
    }

    /// Requires that each number is in these limits; errors name the option and the field, and say that it must be `allowed`.
    ///
    /// # Errors
    /// The first number that is not.
    pub fn require_in(&self, limits: [f64; 2], (option, field): (&str, &str), allowed: &str) -> Result<(), InputError> {
        let mut numbers = self.all.iter().chain(self.of.iter().map(|(_, number)| number));
        match numbers.find(|number| !(limits[0]..=limits[1]).contains(*number)) {
            None => Ok(()),
            Some(number) => Err(InputError::not_allowed(option, field, number, allowed)),
        }
    }

    /// Requires that each named embryo is among `embryos`.
    ///
    /// # Errors
    /// The first one that is not.
    pub fn require_known(&self, embryos: &[&str], option: &str) -> Result<(), InputError> {
        match self.of.iter().find(|(name, _)| !embryos.contains(&name.as_str())) {
            None => Ok(()),
            Some((name, _)) => {
                let allowed = format!("one of the embryos: {}", listed(embryos.iter().copied(), ", "));
                Err(InputError::not_allowed(option, "embryo", format!("{name:?}"), allowed))
            }
        }
    }
}
