//! Fibres of one material, evaluated together: loops over arrays, which are vectorised.

use super::axial::PointForce;
use super::description::Fibre;
use super::law::Law;

/// Fibres of a material that is not linear, ready for evaluation: all but those in curved walls.
#[derive(Clone, Debug, Default)]
pub(super) struct Fibres {
    /// Gauss points in order, each with the end of its fibres.
    runs: Vec<(usize, usize)>,
    /// z/L and −y/L.
    z: Vec<f64>,
    y: Vec<f64>,
    /// w L A.
    weight: Vec<f64>,
    stretch: Vec<f64>,
}

/// w and its derivatives with respect to 1 + ε + κ_y z − κ_z y, fibre by fibre.
#[derive(Clone, Debug, Default)]
pub(super) struct Energies {
    pub stretch: Vec<f64>,
    pub value: Vec<f64>,
    pub first: Vec<f64>,
    pub second: Vec<f64>,
}

impl Energies {
    fn resize(&mut self, n: usize) {
        for numbers in [&mut self.stretch, &mut self.value, &mut self.first, &mut self.second] {
            numbers.resize(n, 0.0);
        }
    }
}

impl Fibres {
    pub fn clear(&mut self) {
        self.runs.clear();
        for numbers in [&mut self.z, &mut self.y, &mut self.weight, &mut self.stretch] {
            numbers.clear();
        }
    }

    pub fn is_empty(&self) -> bool {
        self.weight.is_empty()
    }

    /// Appends a fibre of a Gauss point, the last so far or a later one, of weight w L = `scale`.
    pub fn push(&mut self, point: usize, fibre: &Fibre, length: f64, scale: f64) {
        self.z.push(fibre.z / length);
        self.y.push(-fibre.y / length);
        self.weight.push(scale * fibre.area);
        self.stretch.push(fibre.stretch);
        match self.runs.last_mut() {
            Some((last, end)) if *last == point => *end += 1,
            _ => self.runs.push((point, self.weight.len())),
        }
    }

    /// Evaluates all fibres under the strains ε, θ_y and θ_z of the Gauss points; `false` if one of them
    /// vanishes.
    pub fn evaluate(
        &self,
        law: Law,
        constants: &[f64],
        wound: bool,
        strains: &[[f64; 3]],
        out: &mut Energies,
    ) -> bool {
        out.resize(self.weight.len());
        let mut first = 0;
        for (point, end) in &self.runs {
            let [axial, bend_y, bend_z] = strains[*point];
            let at = first..*end;
            let arms = self.z[at.clone()].iter().zip(&self.y[at.clone()]).zip(&self.stretch[at.clone()]);
            for (out, ((z, y), stretch)) in out.stretch[at].iter_mut().zip(arms) {
                *out = (1.0 + axial + (z * bend_y + y * bend_z)) * stretch;
            }
            first = *end;
        }
        let sound = out.stretch.iter().fold(true, |all, x| all & (*x > 0.0));
        law.evaluate(constants, &self.stretch, wound, out);
        sound
    }

    /// Adds the fibres' forces to those of the Gauss points and returns their energy.
    pub fn add_forces<const P: usize>(&self, energies: &Energies, points: &mut [PointForce]) -> f64 {
        let (mut total, mut first) = (0.0, 0);
        for (point, end) in &self.runs {
            let (mut force, mut tangent) = ([0.0; 3], [[0.0; 3]; 3]);
            for i in first..*end {
                let (z, weight) = (self.z[i], self.weight[i]);
                let (pull, slope) = (weight * energies.first[i], weight * energies.second[i]);
                total += weight * energies.value[i];
                force[0] += pull;
                force[1] += pull * z;
                tangent[0][0] += slope;
                tangent[0][1] += slope * z;
                tangent[1][1] += slope * z * z;
                if P == 3 {
                    let y = self.y[i];
                    force[2] += pull * y;
                    tangent[0][2] += slope * y;
                    tangent[1][2] += slope * z * y;
                    tangent[2][2] += slope * y * y;
                }
            }
            for (m, n) in [(0, 1), (0, 2), (1, 2)] {
                tangent[n][m] = tangent[m][n];
            }
            points[*point].add(force, tangent);
            first = *end;
        }
        total
    }

    /// Adds the sizes of the fibres' forces to those of the Gauss points.
    pub fn add_magnitudes(&self, energies: &Energies, points: &mut [[f64; 3]]) {
        let mut first = 0;
        for (point, end) in &self.runs {
            for i in first..*end {
                let force = (self.weight[i] * energies.first[i]).abs();
                let sizes = [force, force * self.z[i].abs(), force * self.y[i].abs()];
                points[*point].iter_mut().zip(sizes).for_each(|(sum, size)| *sum += size);
            }
            first = *end;
        }
    }
}
