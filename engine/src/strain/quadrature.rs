//! Gauss–Legendre rules and the sample points of a rod.

/// Nodes and weights of the `n`-point Gauss–Legendre rule on [0, 1], nodes increasing.
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let mut rule: Vec<(f64, f64)> = (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (value, derivative) = legendre(n, x);
                slope = derivative;
                let step = value / derivative;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect();
    rule.sort_by(|a, b| a.0.total_cmp(&b.0));
    rule
}

/// `P_n(x)` and its derivative, by the three-term recurrence.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut current) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (previous, current) = (current, ((2.0 * k - 1.0) * x * current - (k - 1.0) * previous) / k);
    }
    (current, n as f64 * (x * current - previous) / (x * x - 1.0))
}

/// The points X ∈ [0, 1] at which a rod is sampled: element ends and Gauss points, increasing.
///
/// These are the toolbox's "significant points"; point `e (G + 1)` is the start of element `e` and
/// `e (G + 1) + 1 + m` its `m`-th Gauss point.
pub fn sample_points(elements: usize, gauss_points: usize) -> Vec<f64> {
    let rule = gauss_legendre(gauss_points);
    let mut x = vec![0.0];
    for e in 0..elements {
        x.extend(rule.iter().map(|(t, _)| (e as f64 + t) / elements as f64));
        x.push((e + 1) as f64 / elements as f64);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrates_polynomials_exactly() {
        for n in 1..=12 {
            let rule = gauss_legendre(n);
            for degree in 0..2 * n {
                let integral: f64 = rule.iter().map(|(x, w)| w * x.powi(degree as i32)).sum();
                assert!((integral - 1.0 / (degree as f64 + 1.0)).abs() < 1e-14, "n = {n}, degree {degree}");
            }
        }
    }
}
