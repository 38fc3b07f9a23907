//! The strains ε, θ_y and θ_z at the Gauss points of rods that have fibres which are not linear, and what
//! the forces conjugate to them add to coordinates.

use super::description::FibreRod;
use crate::strain::Mode;
use crate::tree::{GaussPoint, Rod};

/// The place of a mode among ε, θ_y, θ_z.
pub(super) fn axial(mode: usize) -> Option<usize> {
    match Mode::ALL[mode] {
        Mode::ExtendX => Some(0),
        Mode::BendY => Some(1),
        Mode::BendZ => Some(2),
        _ => None,
    }
}

/// How strains follow from coordinates; Gauss points are counted over all these rods.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct AxialStrains {
    pub points: usize,
    shares: Vec<Share>,
    pairs: Vec<Pair>,
}

/// A coordinate adds φ q to a strain of a Gauss point.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Share {
    point: usize,
    coordinate: usize,
    strain: usize,
    phi: f64,
}

/// Two coordinates, the first not after the second, of one Gauss point.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pair {
    point: usize,
    coordinates: [usize; 2],
    strains: [usize; 2],
    phi: f64,
}

/// Forces conjugate to ε, θ_y, θ_z at a Gauss point and their derivative.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PointForce {
    pub force: [f64; 3],
    pub tangent: [[f64; 3]; 3],
}

impl AxialStrains {
    pub fn new(rods: &[FibreRod], all: &[Rod]) -> Self {
        let mut found = Self::default();
        for rod in rods.iter().filter(|rod| !rod.linear) {
            all[rod.rod].gauss.iter().for_each(|gauss| found.push(gauss));
        }
        found
    }

    fn push(&mut self, gauss: &GaussPoint) {
        let point = self.points;
        let first = self.shares.len();
        for (coordinate, mode, phi) in &gauss.columns {
            if let Some(strain) = axial(*mode) {
                self.shares.push(Share { point, coordinate: *coordinate, strain, phi: *phi });
            }
        }
        let own = &self.shares[first..];
        for a in own {
            for b in own.iter().filter(|b| b.coordinate >= a.coordinate) {
                self.pairs.push(Pair {
                    point,
                    coordinates: [a.coordinate, b.coordinate],
                    strains: [a.strain, b.strain],
                    phi: a.phi * b.phi,
                });
            }
        }
        self.points += 1;
    }

    /// ε, θ_y and θ_z at each Gauss point.
    pub fn strains(&self, q: &[f64], out: &mut Vec<[f64; 3]>) {
        out.clear();
        out.resize(self.points, [0.0; 3]);
        for Share { point, coordinate, strain, phi } in &self.shares {
            out[*point][*strain] += phi * q[*coordinate];
        }
    }

    /// Visits the generalised forces of forces at the Gauss points.
    pub fn for_each_force<'a>(
        &self,
        force: impl Fn(usize) -> &'a [f64; 3],
        mut visit: impl FnMut(usize, f64),
    ) {
        for Share { point, coordinate, strain, phi } in &self.shares {
            visit(*coordinate, phi * force(*point)[*strain]);
        }
    }

    /// Visits all pairs of coordinates of each Gauss point with their second derivative.
    pub fn for_each_pair(&self, points: &[PointForce], mut visit: impl FnMut(usize, usize, f64)) {
        for Pair { point, coordinates: [i, j], strains: [m, n], phi } in &self.pairs {
            visit(*i, *j, phi * points[*point].tangent[*m][*n]);
        }
    }
}

impl PointForce {
    /// Adds forces conjugate to the strains, and their derivative.
    #[inline]
    pub fn add(&mut self, force: [f64; 3], tangent: [[f64; 3]; 3]) {
        for m in 0..3 {
            self.force[m] += force[m];
            for n in 0..3 {
                self.tangent[m][n] += tangent[m][n];
            }
        }
    }

    /// The force under strains if this is that without, and returns ½ kᵢⱼ eᵢ eⱼ + fᵢ eᵢ.
    #[inline]
    pub fn strain(&mut self, e: &[f64; 3]) -> f64 {
        let mut energy = 0.0;
        for m in 0..3 {
            let more = (0..3).map(|n| self.tangent[m][n] * e[n]).sum::<f64>();
            energy += e[m] * (self.force[m] + 0.5 * more);
            self.force[m] += more;
        }
        energy
    }
}
