//! Where a fibre goes in a curved wall whose winding keeps the section that it encloses.
//!
//! The wall is incompressible and moves along its radii. Under extension and bending, the stretch along the
//! rod at the radius ϱ is a + b ϱ/r, with a that at the centre of the arc and b what bending adds at the
//! radius r of the fibre in the reference section. The winding stays at the radius R, and the wall between
//! it and the fibre, which is at r′, keeps its volume: ∫ (a + b ϱ/r) ϱ dϱ from r′ to R is (R² − r²)/2. With
//! the hoop stretch h = r′/r and P = R/r,
//!
//! ```text
//! F(h) = a (h² − P²) + ⅔ b (h³ − P³) + P² − 1 = 0,    λ = a + b h,    ∂F/∂h = 2hλ,
//! ```
//!
//! and the stretch across the wall is 1/(λh). Without bending h² = P² − (P² − 1)/a.

use super::jet2::Jet2;
use crate::linalg::fma;

/// Halley's iterations for h. From stretches of 0.7 to 2.5 they are exact to rounding, from 0.4 to 4 to 1e-8.
const ITERATIONS: usize = 2;
/// F beyond which there is no h: the wall would have to turn inside out.
const NO_WALL: f64 = 1e-6;

/// A fibre in a wall under a and b.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    pub a: f64,
    pub b: f64,
    /// P.
    pub ratio: f64,
    /// h.
    pub hoop: f64,
}

/// Fibres under a and b, evaluated together.
#[derive(Clone, Debug, Default)]
pub(super) struct Walls {
    strains: Vec<[f64; 2]>,
    ratio: Vec<f64>,
    stretch: Vec<f64>,
    hoop: Vec<f64>,
}

impl Walls {
    pub fn clear(&mut self) {
        self.strains.clear();
        self.ratio.clear();
    }

    pub fn push(&mut self, strains: [f64; 2], ratio: f64) {
        self.strains.push(strains);
        self.ratio.push(ratio);
    }

    /// λ of each.
    pub fn stretches(&mut self) -> &[f64] {
        let n = self.ratio.len();
        self.stretch.resize(n, 0.0);
        let (strains, ratio, stretch) = (&self.strains[..n], &self.ratio[..n], &mut self.stretch[..n]);
        for i in 0..n {
            let [a, b] = strains[i];
            stretch[i] = Wall::new(a, b, ratio[i]).stretch();
        }
        stretch
    }

    /// The places of all.
    pub fn places(&mut self) -> impl Iterator<Item = Wall> {
        let n = self.ratio.len();
        self.hoop.resize(n, 0.0);
        let (strains, ratio, hoop) = (&self.strains[..n], &self.ratio[..n], &mut self.hoop[..n]);
        for i in 0..n {
            let [a, b] = strains[i];
            hoop[i] = Wall::new(a, b, ratio[i]).hoop;
        }
        let place =
            |((&[a, b], &ratio), &mut hoop): ((&[f64; 2], &f64), &mut f64)| Wall { a, b, ratio, hoop };
        strains.iter().zip(ratio).zip(hoop).map(place)
    }
}

impl Wall {
    /// Finds the place of a fibre.
    #[inline(always)]
    pub fn new(a: f64, b: f64, ratio: f64) -> Self {
        let mut wall = Self { a, b, ratio, hoop: 1.0 };
        // As if all of the wall were stretched as its middle is, to first order.
        let middle = fma(0.5 * b, 1.0 + ratio, a);
        wall.hoop += 0.5 * (ratio * ratio - 1.0) * (middle - 1.0) / middle;
        for _ in 0..ITERATIONS {
            let excess = wall.excess();
            let (slope, bend) = (2.0 * wall.hoop * wall.stretch(), wall.bend());
            wall.hoop -= 2.0 * excess * slope / (2.0 * slope * slope - excess * bend);
        }
        wall
    }

    /// F.
    #[inline(always)]
    fn excess(&self) -> f64 {
        let Self { a, b, ratio, hoop } = *self;
        let third = 2.0 / 3.0 * b;
        let (here, winding) = (fma(third, hoop, a), fma(third, ratio, a));
        fma(hoop * hoop, here, -fma(ratio * ratio, winding - 1.0, 1.0))
    }

    /// ∂²F/∂h².
    #[inline(always)]
    fn bend(&self) -> f64 {
        2.0 * fma(2.0 * self.b, self.hoop, self.a)
    }

    /// λ.
    #[inline(always)]
    pub fn stretch(&self) -> f64 {
        fma(self.b, self.hoop, self.a)
    }

    /// Whether the wall between the fibre and the winding exists.
    #[inline(always)]
    pub fn exists(&self) -> bool {
        let Self { a, b, ratio, hoop } = *self;
        let wall = (hoop > 0.0) & (self.stretch() > 0.0) & (a + b * ratio > 0.0);
        wall & (self.excess().abs() < NO_WALL)
    }

    /// λ and h with their derivatives with respect to a and b.
    #[inline(always)]
    pub fn jets(&self) -> [Jet2; 2] {
        let Self { b, ratio, hoop: h, .. } = *self;
        let slope = (2.0 * h * self.stretch()).recip();
        let (square, outer) = (h * h, ratio * ratio);
        let by_a = slope * (outer - square);
        let by_b = slope * (2.0 / 3.0) * fma(outer, ratio, -square * h);
        let bend = self.bend();
        let second = [
            -slope * by_a * fma(bend, by_a, 4.0 * h),
            -slope * fma(bend * by_a, by_b, 2.0 * h * fma(h, by_a, by_b)),
            -slope * by_b * fma(bend, by_b, 4.0 * square),
        ];
        let hoop = Jet2 { value: h, first: [by_a, by_b], second };
        let along = Jet2 {
            value: self.stretch(),
            first: [fma(b, by_a, 1.0), fma(b, by_b, h)],
            second: [b * second[0], fma(b, second[1], by_a), fma(b, second[2], 2.0 * by_b)],
        };
        [along, hoop]
    }

    /// First and second derivatives with respect to a and b of a function of ln λ and ln h, from those with
    /// respect to these.
    #[inline(always)]
    pub fn chained(&self, first: [f64; 2], [uu, uv, vv]: [f64; 3]) -> ([f64; 2], [f64; 3]) {
        let across = (self.stretch() * self.hoop).recip();
        let [along, hoop] = self.jets();
        let logarithm = |jet: Jet2, r: f64| {
            let [a, b] = jet.first.map(|d| d * r);
            let second = |k: usize, square: f64| fma(jet.second[k], r, -square);
            ([a, b], [second(0, a * a), second(1, a * b), second(2, b * b)])
        };
        let ([u_a, u_b], u) = logarithm(along, self.hoop * across);
        let ([v_a, v_b], v) = logarithm(hoop, self.stretch() * across);
        let by = |u: f64, v: f64| fma(first[0], u, first[1] * v);
        let bent = |[u, v]: [f64; 2], [x, y]: [f64; 2], more: f64| {
            fma(fma(uu, u, uv * v), x, fma(fma(uv, u, vv * v), y, more))
        };
        let ([a, b], rest) = ([[u_a, v_a], [u_b, v_b]], [0, 1, 2].map(|k| by(u[k], v[k])));
        ([by(u_a, v_a), by(u_b, v_b)], [bent(a, a, rest[0]), bent(a, b, rest[1]), bent(b, b, rest[2])])
    }

    /// Derivatives with respect to P of the first ones that `chained` makes of the same.
    #[inline(always)]
    pub fn by_ratio(&self, first: [f64; 2], [uu, uv, vv]: [f64; 3]) -> [f64; 2] {
        let [along, hoop] = self.jets();
        let (change, of_hoop) = self.hoop_by_ratio(hoop);
        let of_along = [self.b * of_hoop[0], fma(self.b, of_hoop[1], change)];
        let (r_u, r_v) = (along.value.recip(), hoop.value.recip());
        let (u, v) = (self.b * change * r_u, change * r_v);
        let force = [fma(uu, u, uv * v), fma(uv, u, vv * v)];
        [0, 1].map(|k| {
            let (u_k, v_k) = (along.first[k], hoop.first[k]);
            let of_u = fma(force[0], u_k, first[0] * fma(-u, u_k, of_along[k]));
            let of_v = fma(force[1], v_k, first[1] * fma(-v, v_k, of_hoop[k]));
            fma(of_u, r_u, of_v * r_v)
        })
    }

    /// Derivatives of λ with respect to a and b, and to P.
    pub fn stretch_slopes(&self) -> ([f64; 2], f64) {
        let [along, hoop] = self.jets();
        (along.first, self.b * self.hoop_by_ratio(hoop).0)
    }

    /// The derivative of h with respect to P, and its own with respect to a and b.
    #[inline(always)]
    fn hoop_by_ratio(&self, hoop: Jet2) -> (f64, [f64; 2]) {
        let Self { a, b, ratio, hoop: h } = *self;
        let (slope, bend) = ((2.0 * h * self.stretch()).recip(), self.bend());
        let change = slope * 2.0 * ratio * (a + b * ratio - 1.0);
        let by_a = slope * (2.0 * ratio - change * fma(bend, hoop.first[0], 2.0 * h));
        let by_b = slope * (2.0 * ratio * ratio - change * fma(bend, hoop.first[1], 2.0 * h * h));
        (change, [by_a, by_b])
    }
}

#[cfg(test)]
mod tests {
    use super::Wall;

    /// The volume of the wall outside each fibre, summed up between the places of 2,000 fibres.
    #[test]
    fn the_wall_keeps_its_volume() {
        let (inner, winding, count) = (0.8, 1.0, 2_000);
        for (axial, bend) in [(1.3, 0.0), (1.1, 0.9), (1.6, -0.5), (0.8, 0.1)] {
            let (mut volume, mut last) = (0.0, winding);
            for k in 0..=count {
                let r = winding + (inner - winding) * f64::from(k) / f64::from(count);
                let wall = Wall::new(axial, bend * r, winding / r);
                assert!(wall.exists());
                let place = wall.hoop * r;
                let middle = 0.5 * (place + last);
                volume += (axial + bend * middle) * middle * (last - place);
                last = place;
                let kept = 0.5 * (winding * winding - r * r);
                assert!((volume - kept).abs() < 1e-8, "{axial} {bend} {r}: {volume} {kept}");
            }
        }
    }

    #[test]
    fn a_wall_that_bends_too_far_does_not_exist() {
        assert!(Wall::new(1.2, 0.2, 1.2).exists());
        assert!(!Wall::new(0.2, 0.0, 1.2).exists());
        assert!(!Wall::new(1.0, -1.2, 1.2).exists());
        assert!(!Wall::new(f64::NAN, 0.0, 1.2).exists());
    }
}
