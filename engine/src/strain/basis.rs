//! Scalar bases of a strain mode on X ∈ [0, 1].

use serde::Deserialize;

/// The families of basis functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BasisKind {
    /// Piecewise linear on the rod's elements.
    NodalLinear,
    /// Piecewise quadratic Lagrange on the rod's elements.
    NodalQuadratic,
    /// Piecewise cubic Lagrange on the rod's elements.
    NodalCubic,
    /// Piecewise cubic Hermite on the rod's elements: values and slopes (per element length).
    Hermite,
    /// Powers of X up to `order`.
    Monomial,
    /// Legendre polynomials of 2X − 1 up to `order`.
    Legendre,
    /// Chebyshev polynomials of the first kind of 2X − 1 up to `order`.
    Chebyshev,
}

/// A basis of one strain mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Basis {
    /// The family.
    pub kind: BasisKind,
    /// Highest degree of the global families; ignored by the piecewise ones.
    pub order: usize,
    /// Number of elements of the rod.
    pub elements: usize,
}

impl Basis {
    /// Polynomial degree within one element.
    pub fn degree(&self) -> usize {
        match self.kind {
            BasisKind::NodalLinear => 1,
            BasisKind::NodalQuadratic => 2,
            BasisKind::NodalCubic | BasisKind::Hermite => 3,
            BasisKind::Monomial | BasisKind::Legendre | BasisKind::Chebyshev => self.order,
        }
    }

    /// Whether the functions have support on single elements rather than on the whole rod.
    pub fn is_piecewise(&self) -> bool {
        !matches!(self.kind, BasisKind::Monomial | BasisKind::Legendre | BasisKind::Chebyshev)
    }

    /// Number of functions.
    pub fn len(&self) -> usize {
        match self.kind {
            BasisKind::Hermite => 2 * (self.elements + 1),
            _ if self.is_piecewise() => self.degree() * self.elements + 1,
            _ => self.order + 1,
        }
    }

    /// A basis always has at least one function.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Gauss points per element that integrate products of two functions exactly.
    pub fn gauss_points_needed(&self) -> usize {
        if self.is_piecewise() { self.degree() + 1 } else { (self.order + 1).div_ceil(self.elements) }
    }

    /// The functions with support on `element`, as `(index, value at X)`.
    pub fn evaluate(&self, element: usize, x: f64) -> Vec<(usize, f64)> {
        let s = x * self.elements as f64 - element as f64;
        let t = 2.0 * x - 1.0;
        match self.kind {
            BasisKind::NodalLinear | BasisKind::NodalQuadratic | BasisKind::NodalCubic => {
                let p = self.degree();
                (0..=p).map(|i| (p * element + i, lagrange(p, i, s))).collect()
            }
            BasisKind::Hermite => {
                let (s2, s3) = (s * s, s * s * s);
                let values = [1.0 - 3.0 * s2 + 2.0 * s3, s - 2.0 * s2 + s3, 3.0 * s2 - 2.0 * s3, s3 - s2];
                values.into_iter().enumerate().map(|(i, v)| (2 * element + i, v)).collect()
            }
            BasisKind::Monomial => (0..=self.order).map(|k| (k, x.powi(k as i32))).collect(),
            BasisKind::Legendre => recurrence(self.order, t, |k| ((2.0 * k - 1.0) / k, (k - 1.0) / k)),
            BasisKind::Chebyshev => recurrence(self.order, t, |_| (2.0, 1.0)),
        }
    }
}

/// The `i`-th Lagrange polynomial of degree `p` on equally spaced nodes of [0, 1].
fn lagrange(p: usize, i: usize, s: f64) -> f64 {
    let node = |j: usize| j as f64 / p as f64;
    (0..=p).filter(|j| *j != i).map(|j| (s - node(j)) / (node(i) - node(j))).product()
}

/// Polynomials with `y_k = a_k t y_{k−1} − b_k y_{k−2}`, `y_0 = 1`, `y_1 = t`.
fn recurrence(order: usize, t: f64, coefficients: impl Fn(f64) -> (f64, f64)) -> Vec<(usize, f64)> {
    let mut y = vec![1.0, t];
    for k in 2..=order {
        let (a, b) = coefficients(k as f64);
        y.push(a * t * y[k - 1] - b * y[k - 2]);
    }
    y.truncate(order + 1);
    y.into_iter().enumerate().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [BasisKind; 7] = [
        BasisKind::NodalLinear,
        BasisKind::NodalQuadratic,
        BasisKind::NodalCubic,
        BasisKind::Hermite,
        BasisKind::Monomial,
        BasisKind::Legendre,
        BasisKind::Chebyshev,
    ];

    /// Every basis of degree d reproduces a polynomial of degree d: fit at many points, compare.
    #[test]
    fn spans_polynomials_of_its_degree() {
        for kind in KINDS {
            let basis = Basis { kind, order: 3, elements: 2 };
            let target = |x: f64| 0.3 - x + 2.0 * x.powi(basis.degree().min(3) as i32);
            let points: Vec<(usize, f64)> =
                (0..40).map(|i| (i as f64 + 0.5) / 40.0).map(|x| ((2.0 * x) as usize, x)).collect();
            let a = nalgebra::DMatrix::from_fn(points.len(), basis.len(), |r, c| {
                let (e, x) = points[r];
                basis.evaluate(e, x).iter().filter(|(i, _)| *i == c).map(|(_, v)| v).sum()
            });
            let b = nalgebra::DVector::from_iterator(points.len(), points.iter().map(|(_, x)| target(*x)));
            let q = a.clone().svd(true, true).solve(&b, 1e-12).unwrap();
            assert!((a * q - b).norm() < 1e-11, "{kind:?}");
        }
    }
}
