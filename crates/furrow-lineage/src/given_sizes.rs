//! Consistency of the sizes of founders given in a lineage file.

use std::ops::RangeInclusive;

use super::definition::Lineage;
use furrow_input::shown;

/// Total volume of two daughters relative to the mother's that measurement errors may explain; a division conserves volume.
const KEPT: RangeInclusive<f64> = 0.8..=1.2;

impl Lineage {
    /// The volume at birth of a founder with a given radius, in volumes of a sphere of radius L_h. The given radius is the one at
    /// division.
    pub(super) fn given_at_birth(&self, founder: usize) -> Option<f64> {
        Some(self.given_r0(founder)?.powi(3) / self.growth(founder))
    }

    /// Warnings about mothers and daughters: the given volume of a mother should equal the sum of the given volumes of her daughters.
    pub fn doubtful_sums(&self) -> Vec<String> {
        let written = |founder: usize| self.founders[founder].r0.map_or(String::new(), |r0| format!("r0 = {r0}"));
        let name = |founder: usize| shown(&self.founders[founder].name);
        let doubt = |(mother, daughters): (usize, Option<(usize, usize)>)| {
            let ((larger, smaller), r0) = (daughters?, self.given_r0(mother)?);
            let sum = self.given_at_birth(larger)? + self.given_at_birth(smaller)?;
            let share = sum / r0.powi(3);
            (!KEPT.contains(&share)).then(|| {
                format!(
                    "founder {}: {}, but its daughters {} ({}) and {} ({}) have {share:.2} times its volume together, at birth",
                    name(mother),
                    written(mother),
                    name(larger),
                    written(larger),
                    name(smaller),
                    written(smaller),
                )
            })
        };
        self.daughters().into_iter().enumerate().filter_map(doubt).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read([p0, ab, p1]: [&str; 3]) -> Result<Lineage, String> {
        let text = format!(
            "(name: \"x\", founders: [(name: \"P0\"{p0}),\n(name: \"AB\", mother: \"P0\", daughter: larger{ab}),\n\
             (name: \"P1\", mother: \"P0\", daughter: smaller{p1})])"
        );
        Lineage::parse(&text, "x.ron").map_err(|error| error.to_string())
    }

    #[test]
    fn a_larger_daughter_is_not_given_as_the_smaller_one() {
        let why = "x.ron:2: founder \"AB\": daughter = larger: must be smaller, or r0 = 2 at least r0 = 3.9 of \"P1\"";
        assert_eq!(read(["", ", r0: 2", ", r0: 3.9"]).unwrap_err(), why);
        let why =
            "x.ron:2: founder \"AB\": daughter = larger: must be smaller, or r0 = 12um at least r0 = 3.9 of \"P1\"";
        assert_eq!(read(["", ", r0: \"12um\"", ", r0: 3.9"]).unwrap_err(), why);
        for fine in [["", ", r0: 3", ", r0: 3"], ["", ", r0: 2", ""], ["", ", r0: 3, growth: 1.1", ", r0: 2.9"]] {
            read(fine).unwrap();
        }
        let refused = read(["", ", r0: 3, growth: 2", ", r0: 2.9"]).unwrap_err();
        assert!(refused.ends_with("r0 = 2.9 of \"P1\", both over the cube root of growth, as at birth"), "{refused}");
    }

    #[test]
    fn daughters_that_do_not_have_their_mothers_volume_are_doubtful() {
        for (sizes, share) in [
            ([", r0: 4", ", r0: 4", ", r0: 3.9"], Some("1.93")),
            ([", r0: 4", ", r0: 2.5", ", r0: 2"], Some("0.37")),
            ([", r0: 4", ", r0: 4, growth: 2", ", r0: 4, growth: 2"], None),
            ([", r0: 4", ", r0: 3.4", ", r0: 3.0"], None),
            (["", ", r0: 9", ", r0: 3.9"], None),
        ] {
            let doubts = read(sizes).unwrap().doubts();
            let expected = share.map(|share| format!("have {share} times its volume together, at birth"));
            assert_eq!(doubts.len(), expected.iter().len(), "{doubts:?}");
            assert!(doubts.iter().all(|doubt| doubt.ends_with(expected.as_deref().unwrap_or(""))), "{doubts:?}");
        }
    }
}
