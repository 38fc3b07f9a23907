//! The path of an actuator in the cross-sections of its rod: offset d, tangent τ and moment arms.

use crate::lie::LieGroup;
use crate::strain::Mode;
use crate::tree::{GaussPoint, Rod};

/// A chamber or cable: a load input acting along a path on one rod.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Actuator {
    pub rod: usize,
    /// The load input.
    pub input: usize,
    /// +1 when a positive input lengthens the path, −1 when it shortens it.
    pub sign: f64,
    /// Parameter holding the lever (y, z).
    pub lever: usize,
    /// For each Gauss point of the rod the first of four parameters that hold the part of the path that does not
    /// depend on its radius: offset (y, z) and slope.
    pub routing: Vec<usize>,
}

impl Actuator {
    /// Offset d and slope d′ of the path at a Gauss point.
    pub fn path(&self, rod: &Rod, gauss: &GaussPoint, routing: usize, p: &[f64]) -> [[f64; 2]; 2] {
        let (s, slope) = (p[rod.radius.start + gauss.point], p[rod.slope.start + gauss.point]);
        let along = |i: usize, size: f64, fixed: usize| p[fixed + i] + p[self.lever + i] * size;
        [[0, 1].map(|i| along(i, s, routing)), [0, 1].map(|i| along(i, slope, routing + 2))]
    }

    /// Adds derivatives with respect to what makes the path at a Gauss point, given those with respect to the
    /// components of d and of d′.
    pub fn add_by_path(
        &self,
        rod: &Rod,
        gauss: &GaussPoint,
        routing: usize,
        p: &[f64],
        [by_offset, by_slope]: [[f64; 2]; 2],
        gradient: &mut [f64],
    ) {
        let (radius, slope) = (rod.radius.start + gauss.point, rod.slope.start + gauss.point);
        for i in 0..2 {
            let lever = p[self.lever + i];
            gradient[radius] += lever * by_offset[i];
            gradient[slope] += lever * by_slope[i];
            gradient[self.lever + i] += p[radius] * by_offset[i] + p[slope] * by_slope[i];
            gradient[routing + i] += by_offset[i];
            gradient[routing + 2 + i] += by_slope[i];
        }
    }
}

/// Derivative of the path's tangent with respect to a strain component, at the offset `d = (y, z)`.
pub(super) fn moment_arm(mode: Mode, d: [f64; 2]) -> [f64; 3] {
    match mode {
        Mode::TwistX => [0.0, -d[1], d[0]],
        Mode::BendY => [d[1], 0.0, 0.0],
        Mode::BendZ => [-d[0], 0.0, 0.0],
        Mode::ExtendX => [1.0, 0.0, 0.0],
        Mode::ShearY => [0.0, 1.0, 0.0],
        Mode::ShearZ => [0.0, 0.0, 1.0],
    }
}

/// Adds the contribution of the strains to the path's tangent at the offset `d`.
pub(super) fn add_tangent_of(strain: &[f64; 6], modes: &[Mode], d: [f64; 2], tau: &mut [f64; 3]) {
    for mode in modes {
        let arm = moment_arm(*mode, d);
        for i in 0..3 {
            tau[i] += strain[mode.index()] * arm[i];
        }
    }
}

/// τ̂ and |τ|.
#[inline]
pub(super) fn unit_tangent(tau: [f64; 3], base: [f64; 3]) -> ([f64; 3], f64) {
    // A path collapsed to a point has no direction; the floor keeps the tangent finite.
    let norm = dot(&tau, &tau).sqrt().max(1e-9 * base[0].abs());
    let inverse = 1.0 / norm;
    (tau.map(|t| t * inverse), norm)
}

#[inline]
pub(super) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The paths of a design at the rods' Gauss points.
#[derive(Clone, Debug, Default)]
pub(crate) struct Paths {
    pub(super) points: Vec<PathPoint>,
    pub(super) columns: Vec<PathColumn>,
    /// One for each pair of a point's columns, the first not before the second.
    pub(super) pairs: Vec<ColumnPair>,
}

/// Tangent of an actuator's path at a Gauss point: τ = base + Σ q_c size_c e_axis, dℓ = weight |τ|.
#[derive(Clone, Debug)]
pub(super) struct PathPoint {
    pub base: [f64; 3],
    pub weight: f64,
    /// Ends of its columns, those along each axis; the first begin where the previous point's end.
    pub ends: [usize; 3],
}

#[derive(Clone, Debug)]
pub(super) struct PathColumn {
    pub dof: usize,
    pub size: f64,
}

/// Inner product of two columns, and the entry of the tangent's half to which the pair adds.
#[derive(Clone, Debug)]
pub(super) struct ColumnPair {
    pub entry: usize,
    pub product: f64,
    /// One half for a column with itself.
    pub share: f64,
}

impl Paths {
    pub fn clear(&mut self) {
        self.points.clear();
        self.columns.clear();
        self.pairs.clear();
    }

    /// Appends the columns of a Gauss point, axis by axis, and their pairs.
    pub fn push_columns(&mut self, gauss: &GaussPoint, length: f64, d: [f64; 2], dof: usize) -> [usize; 3] {
        let first = self.columns.len();
        let mut ends = [0; 3];
        for (axis, end) in ends.iter_mut().enumerate() {
            for &(dof, mode, phi) in &gauss.columns {
                let mode = Mode::ALL[mode];
                if moment_arm(mode, [1.0; 2])[axis] != 0.0 {
                    let scale = if mode.is_angular() { phi } else { phi * length };
                    self.columns.push(PathColumn { dof, size: moment_arm(mode, d)[axis] * scale });
                }
            }
            *end = self.columns.len();
        }
        let columns = &self.columns[first..];
        let axis = |m: usize| ends.iter().filter(|end| first + m >= **end).count();
        for (m, a) in columns.iter().enumerate() {
            for (l, b) in columns[..=m].iter().enumerate() {
                let entry = a.dof.max(b.dof) * dof + a.dof.min(b.dof);
                let product = if axis(m) == axis(l) { a.size * b.size } else { 0.0 };
                let share = if m == l { 0.5 } else { 1.0 };
                self.pairs.push(ColumnPair { entry, product, share });
            }
        }
        ends
    }
}

/// Adds the contribution of the coordinates to the normalised strains at a Gauss point, by mode.
pub(super) fn add_strain(
    strain: &mut [f64; 6],
    columns: &[(usize, usize, f64)],
    length: f64,
    coordinates: &[f64],
) {
    for &(dof, mode, phi) in columns {
        strain[mode] += coordinates[dof] * if mode < 3 { phi } else { phi * length };
    }
}

/// The contribution of the strains to a path's tangent at an offset.
pub(super) fn tangent_of<G: LieGroup<D, P>, const D: usize, const P: usize>(
    strain: &[f64; 6],
    d: [f64; 2],
) -> [f64; 3] {
    let mut tau = [0.0; 3];
    add_tangent_of(strain, &G::AXES, d, &mut tau);
    tau
}

/// Its derivative with respect to the offset.
pub(super) fn tangent_by_offset<G: LieGroup<D, P>, const D: usize, const P: usize>(
    strain: &[f64; 6],
) -> [[f64; 3]; 2] {
    [[1.0, 0.0], [0.0, 1.0]].map(|side| {
        let mut tau = [0.0; 3];
        for mode in G::AXES.into_iter().filter(|mode| mode.is_angular()) {
            add_tangent_of(strain, &[mode], side, &mut tau);
        }
        tau
    })
}
