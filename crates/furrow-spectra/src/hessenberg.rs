//! Eigenvalues of an upper Hessenberg matrix, such as Arnoldi iteration leaves: it needs no reduction first.
//!
//! # References
//! Golub & Van Loan, *Matrix Computations*, 4th ed., Johns Hopkins 2013, §7.5 (implicit double shifts), §7.6 (inverse iteration).

/// Sweeps allowed for one eigenvalue or pair.
const MOST_SWEEPS: usize = 60;

/// After every so many sweeps for one eigenvalue the shifts are changed, in case they go round in circles.
const STALLED: usize = 10;

/// The eigenvalues (real and imaginary part) of the upper Hessenberg matrix of order n with the given rows, which are
/// destroyed; both of each complex pair. None where they are not finite or the iteration does not converge.
pub(crate) fn eigenvalues(h: &mut [f64], stride: usize, n: usize) -> Option<Vec<[f64; 2]>> {
    let mut found = vec![[0.0; 2]; n];
    let size = (0..n).flat_map(|i| &h[i * stride..i * stride + n]).fold(0.0f64, |most, x| most.max(x.abs()));
    if !size.is_finite() {
        return None;
    }
    let (mut active, mut sweeps) = (n, 0);
    while active > 0 {
        let last = active - 1;
        let start = deflated(h, stride, active, size);
        if start == last {
            found[last] = [h[last * stride + last], 0.0];
            (active, sweeps) = (last, 0);
        } else if start + 1 == last {
            let at = |i: usize, j: usize| h[(start + i) * stride + start + j];
            [found[start], found[last]] = pair([[at(0, 0), at(0, 1)], [at(1, 0), at(1, 1)]]);
            (active, sweeps) = (start, 0);
        } else {
            sweeps += 1;
            if sweeps > MOST_SWEEPS {
                return None;
            }
            sweep(h, stride, [start, last], sweeps % STALLED == 0);
        }
    }
    found.iter().flatten().all(|x| x.is_finite()).then_some(found)
}

/// First row of the trailing block of the leading `active` rows that does not split. The entry that it splits at is set to 0.
fn deflated(h: &mut [f64], stride: usize, active: usize, size: f64) -> usize {
    for i in (1..active).rev() {
        let beside = h[(i - 1) * stride + i - 1].abs() + h[i * stride + i].abs();
        let scale = if beside > 0.0 { beside } else { size };
        if h[i * stride + i - 1].abs() <= f64::EPSILON * scale {
            h[i * stride + i - 1] = 0.0;
            return i;
        }
    }
    0
}

/// The eigenvalues of a matrix of order 2.
fn pair([[a, b], [c, d]]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let half = 0.5 * (a - d);
    let discriminant = half * half + b * c;
    if discriminant < 0.0 {
        let (re, im) = (0.5 * (a + d), (-discriminant).sqrt());
        return [[re, im], [re, -im]];
    }
    // Of the two distances from d the larger first: the other by their product, without cancellation.
    let far = half + discriminant.sqrt().copysign(half);
    let near = if far == 0.0 { 0.0 } else { -b * c / far };
    [[d + far, 0.0], [d + near, 0.0]]
}

/// One sweep with both eigenvalues of the trailing block of order 2 as shifts, on rows and columns `start` to `last`.
fn sweep(h: &mut [f64], stride: usize, [start, last]: [usize; 2], stalled: bool) {
    let at = |h: &[f64], i: usize, j: usize| h[i * stride + j];
    let (mut trace, mut determinant) = {
        let [a, b] = [at(h, last - 1, last - 1), at(h, last - 1, last)];
        let [c, d] = [at(h, last, last - 1), at(h, last, last)];
        (a + d, a * d - b * c)
    };
    if stalled {
        let off = at(h, last, last - 1).abs() + at(h, last - 1, last - 2).abs();
        (trace, determinant) = (1.5 * off, off * off);
    }
    // The first column of H² − trace H + determinant.
    let (a, b, c, d) =
        (at(h, start, start), at(h, start, start + 1), at(h, start + 1, start), at(h, start + 1, start + 1));
    let mut column = [a * a + b * c - trace * a + determinant, c * (a + d - trace), c * at(h, start + 2, start + 1)];
    for k in start..last {
        let order = if k + 1 == last { 2 } else { 3 };
        if k > start {
            for (i, x) in column.iter_mut().enumerate() {
                *x = if i < order { at(h, k + i, k - 1) } else { 0.0 };
            }
        }
        let Some((v, tau)) = reflector(&column[..order]) else { continue };
        for j in k.saturating_sub(1).max(start)..=last {
            let sum: f64 = (0..order).map(|i| v[i] * h[(k + i) * stride + j]).sum();
            (0..order).for_each(|i| h[(k + i) * stride + j] -= tau * v[i] * sum);
        }
        for i in start..=last.min(k + 3) {
            let row = &mut h[i * stride + k..i * stride + k + order];
            let sum: f64 = row.iter().zip(&v).map(|(x, v)| x * v).sum();
            row.iter_mut().zip(&v).for_each(|(x, v)| *x -= tau * v * sum);
        }
        if k > start {
            (1..order).for_each(|i| h[(k + i) * stride + k - 1] = 0.0);
        }
    }
}

/// v and τ of I − τ v vᵀ, which maps `x` on the first axis; none where it is there already.
fn reflector(x: &[f64]) -> Option<([f64; 3], f64)> {
    let size = x.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    if size == 0.0 || x[1..].iter().all(|x| *x == 0.0) {
        return None;
    }
    let mut v = [0.0; 3];
    v.iter_mut().zip(x).for_each(|(v, x)| *v = x / size);
    v[0] += v.iter().map(|v| v * v).sum::<f64>().sqrt().copysign(v[0]);
    Some((v, 2.0 / v.iter().map(|v| v * v).sum::<f64>()))
}

/// A complex number.
type Complex = [f64; 2];

fn times([a, b]: Complex, [c, d]: Complex) -> Complex {
    [a * c - b * d, a * d + b * c]
}

fn over(a: Complex, [c, d]: Complex) -> Complex {
    let square = c * c + d * d;
    times(a, [c / square, -d / square])
}

/// Steps of inverse iteration for an eigenvector: the shift is an eigenvalue to rounding.
const INVERSE_STEPS: usize = 2;

/// Modulus of the last component of the eigenvector of length 1 that belongs to the eigenvalue `value` of the Hessenberg matrix
/// with the given rows.
pub(crate) fn last_component(h: &[f64], stride: usize, n: usize, value: Complex) -> f64 {
    let (mut rows, mut x) = (vec![[0.0; 2]; n * n], vec![[1.0, 0.0]; n]);
    let largest =
        (0..n).flat_map(|i| &h[i * stride..i * stride + n]).fold(f64::MIN_POSITIVE, |most, x| most.max(x.abs()));
    for _ in 0..INVERSE_STEPS {
        for i in 0..n {
            rows[i * n..(i + 1) * n].iter_mut().zip(&h[i * stride..]).for_each(|(to, from)| *to = [*from, 0.0]);
            rows[i * n + i] = [h[i * stride + i] - value[0], -value[1]];
        }
        solve(&mut rows, n, &mut x, f64::EPSILON * largest);
        let size = x.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
        x.iter_mut().flatten().for_each(|x| *x /= size);
    }
    x[n - 1][0].hypot(x[n - 1][1])
}

/// Solves a Hessenberg system by elimination with exchanges of neighbouring rows. Pivots below `least` are taken for that.
fn solve(rows: &mut [Complex], n: usize, x: &mut [Complex], least: f64) {
    let size = |[a, b]: Complex| a.abs().max(b.abs());
    for i in 0..n {
        if i + 1 < n && size(rows[(i + 1) * n + i]) > size(rows[i * n + i]) {
            (i..n).for_each(|j| rows.swap(i * n + j, (i + 1) * n + j));
            x.swap(i, i + 1);
        }
        if size(rows[i * n + i]) < least {
            rows[i * n + i] = [least, 0.0];
        }
        if i + 1 < n && size(rows[(i + 1) * n + i]) > 0.0 {
            let factor = over(rows[(i + 1) * n + i], rows[i * n + i]);
            for j in i..n {
                let [a, b] = times(factor, rows[i * n + j]);
                rows[(i + 1) * n + j][0] -= a;
                rows[(i + 1) * n + j][1] -= b;
            }
            let [a, b] = times(factor, x[i]);
            x[i + 1] = [x[i + 1][0] - a, x[i + 1][1] - b];
        }
    }
    for i in (0..n).rev() {
        for j in i + 1..n {
            let [a, b] = times(rows[i * n + j], x[j]);
            x[i] = [x[i][0] - a, x[i][1] - b];
        }
        x[i] = over(x[i], rows[i * n + i]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;

    /// A Hessenberg matrix of numbers that look random, with subdiagonal entries that get smaller.
    fn hessenberg(n: usize, decay: f64) -> Vec<f64> {
        let mut seed = n as u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let entry = |i: usize, j: usize, x: f64| match i {
            _ if i > j + 1 => 0.0,
            _ if i == j + 1 => x * decay.powi(i as i32),
            _ => x,
        };
        (0..n * n).map(|k| entry(k / n, k % n, random())).collect()
    }

    #[test]
    fn agrees_with_a_general_solver() {
        for (n, decay) in (1..=24).flat_map(|n| [(n, 1.0), (n, 0.5)]) {
            let h = hessenberg(n, decay);
            let mut found = eigenvalues(&mut h.clone(), n, n).unwrap();
            let expected = Mat::from_fn(n, n, |i, j| h[i * n + j]).eigen().unwrap();
            let (values, vectors) = (expected.S(), expected.U());
            for k in 0..n {
                let (near, _) = (found.iter().enumerate())
                    .map(|(i, [re, im])| (i, (re - values[k].re).hypot(im - values[k].im)))
                    .min_by(|a, b| a.1.total_cmp(&b.1))
                    .unwrap();
                let [re, im] = found.swap_remove(near);
                assert!((re - values[k].re).hypot(im - values[k].im) < 1e-10, "{n} {k}: {re} {im} {:?}", values[k]);
                let norm = (0..n).map(|i| vectors[(i, k)].norm_sqr()).sum::<f64>().sqrt();
                let (last, expected) = (last_component(&h, n, n, [re, im]), vectors[(n - 1, k)].norm() / norm);
                assert!((last - expected).abs() < 1e-6 * expected + 1e-12, "{n} {k}: {last} {expected}");
            }
        }
    }

    /// A cyclic shift is its own worst case: double shifts alone leave it as it is.
    #[test]
    fn turns_that_shifts_alone_leave_alone_are_resolved() {
        let n = 5;
        let cycle = |k: usize| if (k / n) == (k % n + 1) % n { 1.0 } else { 0.0 };
        let found = eigenvalues(&mut Vec::from_iter((0..n * n).map(cycle)), n, n).unwrap();
        assert!(found.iter().all(|[re, im]| (re.hypot(*im) - 1.0).abs() < 1e-12), "{found:?}");
        let angles = found.iter().map(|[re, im]| (im.atan2(*re) * n as f64 / std::f64::consts::TAU).round() as i32);
        let mut angles = Vec::from_iter(angles);
        angles.sort_unstable();
        assert_eq!(angles, [-2, -1, 0, 1, 2]);
    }

    #[test]
    fn what_is_not_finite_has_no_eigenvalues() {
        assert_eq!(eigenvalues(&mut [f64::NAN, 1.0, 1.0, 1.0], 2, 2), None);
        assert_eq!(eigenvalues(&mut [0.0; 9], 3, 3), Some(vec![[0.0; 2]; 3]));
    }
}
