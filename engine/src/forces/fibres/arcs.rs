//! Fibres of one material in the curved walls that are wound, evaluated together: loops over arrays, which
//! are vectorised, and short, so that the next fibres need not wait for these.

use super::axial::PointForce;
use super::description::Fibre;
use super::law::Law;
use super::wall::Wall;
use crate::linalg::fma;

/// Those of a material that is not linear.
#[derive(Clone, Debug, Default)]
pub(super) struct Arcs {
    /// Gauss points in order, each with the end of its fibres.
    runs: Vec<(usize, usize)>,
    /// a and b (see `wall.rs`) by 1 + ε, θ_y and θ_z: a by the first, both by the others.
    by_axial: Vec<f64>,
    by_bend_y: [Vec<f64>; 2],
    by_bend_z: [Vec<f64>; 2],
    /// w L A.
    weight: Vec<f64>,
    /// P.
    ratio: Vec<f64>,
}

/// What a state makes of them, fibre by fibre.
#[derive(Clone, Debug, Default)]
pub(super) struct ArcEnergies {
    a: Vec<f64>,
    b: Vec<f64>,
    pub along: Vec<f64>,
    pub hoop: Vec<f64>,
    /// w and its derivatives with respect to the logarithms of λ and h: by the first twice, by both, by
    /// the second twice.
    pub value: Vec<f64>,
    pub first: [Vec<f64>; 2],
    pub second: [Vec<f64>; 3],
    /// Forces conjugate to ε, θ_y and θ_z, and their derivatives, by rows of the lower triangle.
    force: [Vec<f64>; 3],
    tangent: [Vec<f64>; 6],
}

/// Rows and columns of the lower triangle.
const TRIANGLE: [(usize, usize); 6] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];

impl ArcEnergies {
    fn resize(&mut self, n: usize) {
        let Self { a, b, along, hoop, value, first, second, force, tangent } = self;
        let all = [a, b, along, hoop, value].into_iter().chain(first).chain(second).chain(force);
        all.chain(tangent).for_each(|numbers| numbers.resize(n, 0.0));
    }
}

impl Arcs {
    pub fn clear(&mut self) {
        let Self { runs, by_axial, by_bend_y, by_bend_z, weight, ratio } = self;
        runs.clear();
        let single = [by_axial, weight, ratio].into_iter();
        single.chain(by_bend_y).chain(by_bend_z).for_each(Vec::clear);
    }

    pub fn is_empty(&self) -> bool {
        self.weight.is_empty()
    }

    /// Appends a fibre of a Gauss point, the last so far or a later one, of weight w L = `scale`.
    pub fn push(&mut self, point: usize, fibre: &Fibre, length: f64, scale: f64) {
        let rate = fibre.stretch / length;
        let ([centre_y, centre_z], [arm_y, arm_z]) = (fibre.centre, fibre.arm());
        self.by_axial.push(fibre.stretch);
        self.by_bend_y[0].push(rate * centre_z);
        self.by_bend_y[1].push(rate * arm_z);
        self.by_bend_z[0].push(-rate * centre_y);
        self.by_bend_z[1].push(-rate * arm_y);
        self.weight.push(scale * fibre.area);
        self.ratio.push(fibre.ratio);
        match self.runs.last_mut() {
            Some((last, end)) if *last == point => *end += 1,
            _ => self.runs.push((point, self.weight.len())),
        }
    }

    /// Evaluates all fibres under the strains ε, θ_y and θ_z of the Gauss points; `false` if one of them
    /// does not exist.
    pub fn evaluate<const P: usize>(
        &self,
        law: Law,
        constants: &[f64],
        strains: &[[f64; 3]],
        out: &mut ArcEnergies,
    ) -> bool {
        out.resize(self.weight.len());
        self.stretch::<P>(strains, out);
        let sound = self.move_walls(out);
        law.evaluate_arcs(constants, out);
        self.chain::<P>(out);
        sound
    }

    /// a and b.
    fn stretch<const P: usize>(&self, strains: &[[f64; 3]], out: &mut ArcEnergies) {
        let n = self.weight.len();
        let (by_axial, a, b) = (&self.by_axial[..n], &mut out.a[..n], &mut out.b[..n]);
        let [by_y, by_z] = [&self.by_bend_y, &self.by_bend_z].map(|by| by.each_ref().map(|by| &by[..n]));
        let mut first = 0;
        for (point, end) in &self.runs {
            let [axial, bend_y, bend_z] = strains[*point];
            for i in first..*end {
                a[i] = fma(bend_y, by_y[0][i], (1.0 + axial) * by_axial[i]);
                b[i] = bend_y * by_y[1][i];
                // Planar models, of P = 2, have no θ_z.
                if P == 3 {
                    a[i] = fma(bend_z, by_z[0][i], a[i]);
                    b[i] = fma(bend_z, by_z[1][i], b[i]);
                }
            }
            first = *end;
        }
    }

    /// λ and h; `false` if a wall does not exist.
    fn move_walls(&self, out: &mut ArcEnergies) -> bool {
        let n = self.weight.len();
        let (a, b, ratio) = (&out.a[..n], &out.b[..n], &self.ratio[..n]);
        let (along, hoop) = (&mut out.along[..n], &mut out.hoop[..n]);
        let mut sound = true;
        for i in 0..n {
            let wall = Wall::new(a[i], b[i], ratio[i]);
            sound &= wall.exists();
            (along[i], hoop[i]) = (wall.stretch(), wall.hoop);
        }
        sound
    }

    /// Forces and their derivatives, from those of w.
    fn chain<const P: usize>(&self, out: &mut ArcEnergies) {
        let n = self.weight.len();
        let (weight, ratio, by_axial) = (&self.weight[..n], &self.ratio[..n], &self.by_axial[..n]);
        let [by_y, by_z] = [&self.by_bend_y, &self.by_bend_z].map(|by| by.each_ref().map(|by| &by[..n]));
        let (a, b, hoop, value) = (&out.a[..n], &out.b[..n], &out.hoop[..n], &mut out.value[..n]);
        let (first, second) = (out.first.each_ref().map(|d| &d[..n]), out.second.each_ref().map(|d| &d[..n]));
        let force = out.force.each_mut().map(|f| &mut f[..n]);
        let tangent = out.tangent.each_mut().map(|t| &mut t[..n]);
        for i in 0..n {
            let wall = Wall { a: a[i], b: b[i], ratio: ratio[i], hoop: hoop[i] };
            let first = [0, 1].map(|k| weight[i] * first[k][i]);
            let second = [0, 1, 2].map(|k| weight[i] * second[k][i]);
            let (d, [aa, ab, bb]) = wall.chained(first, second);
            let rows = [[by_axial[i], 0.0], [by_y[0][i], by_y[1][i]], [by_z[0][i], by_z[1][i]]];
            value[i] *= weight[i];
            for m in 0..P {
                force[m][i] = d[0] * rows[m][0] + d[1] * rows[m][1];
            }
            for (k, (m, n)) in TRIANGLE.into_iter().enumerate().take(P * (P + 1) / 2) {
                let [x, y] = rows[m];
                tangent[k][i] = (aa * x + ab * y) * rows[n][0] + (ab * x + bb * y) * rows[n][1];
            }
        }
    }

    /// Adds the fibres' forces to those of the Gauss points and returns their energy.
    pub fn add_forces<const P: usize>(&self, energies: &ArcEnergies, points: &mut [PointForce]) -> f64 {
        let (mut total, mut first) = (0.0, 0);
        for (point, end) in &self.runs {
            let sum = |numbers: &[f64]| numbers[first..*end].iter().sum::<f64>();
            let point = &mut points[*point];
            total += sum(&energies.value);
            for m in 0..P {
                point.force[m] += sum(&energies.force[m]);
            }
            for (k, (m, n)) in TRIANGLE.into_iter().enumerate().take(P * (P + 1) / 2) {
                let tangent = sum(&energies.tangent[k]);
                point.tangent[m][n] += tangent;
                if m != n {
                    point.tangent[n][m] += tangent;
                }
            }
            first = *end;
        }
        total
    }

    /// Adds the sizes of the fibres' forces to those of the Gauss points.
    pub fn add_magnitudes(&self, energies: &ArcEnergies, points: &mut [[f64; 3]]) {
        let mut first = 0;
        for (point, end) in &self.runs {
            for (sum, force) in points[*point].iter_mut().zip(&energies.force) {
                *sum += force[first..*end].iter().map(|f| f.abs()).sum::<f64>();
            }
            first = *end;
        }
    }
}
