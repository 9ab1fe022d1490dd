//! Splines of degree 4 on equal elements of [0, 1], three times continuously differentiable, clamped at both ends: the
//! j-th spline from an end behaves like the j-th power of the distance.

/// Degree of the splines.
pub const DEGREE: usize = 4;

/// Number of splines that do not vanish on an element.
pub const LOCAL: usize = DEGREE + 1;

/// Values and first two derivatives of the splines `element` … `element` + 4 at a place of that element.
pub type LocalValues = [[f64; 3]; LOCAL];

/// Splines of degree `degree` that do not vanish at `x` in `element`, by the recursion of Cox and de Boor.
fn values(elements: usize, element: usize, x: f64, degree: usize) -> [f64; LOCAL] {
    let knot = |k: isize| (k.clamp(0, elements as isize)) as f64 / elements as f64;
    let first = element as isize;
    let mut out = [0.0; LOCAL];
    out[0] = 1.0;
    for d in 1..=degree {
        let mut carried = 0.0;
        for r in 0..d {
            let (right, left) = (knot(first + r as isize + 1), knot(first + r as isize + 1 - d as isize));
            let share = out[r] / (right - left);
            out[r] = carried + (right - x) * share;
            carried = (x - left) * share;
        }
        out[d] = carried;
    }
    out
}

/// Values and two derivatives at `x` in `element`.
pub fn local_values(elements: usize, element: usize, x: f64) -> LocalValues {
    let knot = |k: isize| (k.clamp(0, elements as isize)) as f64 / elements as f64;
    let first = element as isize;
    // The derivative of a spline of degree d from the splines of degree d − 1.
    let slope = |lower: &[f64; LOCAL], d: usize| -> [f64; LOCAL] {
        std::array::from_fn(|r| {
            let start = first - d as isize + r as isize;
            let part = |value: f64, from: isize| {
                if value == 0.0 { 0.0 } else { value / (knot(from + d as isize) - knot(from)) }
            };
            let before = if r > 0 && r <= d { part(lower[r - 1], start) } else { 0.0 };
            let after = if r < d { part(lower[r], start + 1) } else { 0.0 };
            d as f64 * (before - after)
        })
    };
    let value = values(elements, element, x, DEGREE);
    let lower = values(elements, element, x, DEGREE - 1);
    let first_derivative = slope(&lower, DEGREE);
    let second_derivative = slope(&slope(&values(elements, element, x, DEGREE - 2), DEGREE - 1), DEGREE);
    std::array::from_fn(|r| [value[r], first_derivative[r], second_derivative[r]])
}

/// The element that contains `x` in [0, 1].
pub fn element_of(elements: usize, x: f64) -> usize {
    ((x * elements as f64) as usize).min(elements - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splines_sum_to_one_and_derivatives_are_differences() {
        let elements = 7;
        for x in [1e-6, 0.03, 0.2, 0.51, 0.77, 0.999] {
            let element = element_of(elements, x);
            let here = local_values(elements, element, x);
            assert!((here.iter().map(|b| b[0]).sum::<f64>() - 1.0).abs() < 1e-14, "{x}");
            let h = 1e-6;
            let [low, high] = [x - h, x + h].map(|x| local_values(elements, element, x));
            for r in 0..LOCAL {
                for d in 0..2 {
                    let difference = (high[r][d] - low[r][d]) / (2.0 * h);
                    assert!((difference - here[r][d + 1]).abs() < 1e-5 * (1.0 + here[r][d + 1].abs()), "{x} {r} {d}");
                }
            }
        }
        let pole = local_values(elements, 0, 0.0);
        assert_eq!(pole.map(|b| b[0]), [1.0, 0.0, 0.0, 0.0, 0.0]);
        assert!(pole[2][1] == 0.0 && pole[3][2] == 0.0 && pole[2][2] > 0.0);
    }
}
