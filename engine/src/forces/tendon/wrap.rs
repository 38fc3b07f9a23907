//! The shortest path between two points around a circle, a sphere or a cylinder.
//!
//! With ρ₀ and ρ₁ the distances of its ends from the centre or the axis, and θ the angle between them on the
//! side on which the path passes, its length ahead of the radius r is
//! Λ = √(ρ₀² − r²) + √(ρ₁² − r²) + r (θ − arccos r/ρ₀ − arccos r/ρ₁): two tangents and an arc. A path that
//! has to pass inside touches at the one point where |x₀ − t| + |x₁ − t| is least. A cylinder unrolls: there
//! the length is √(Λ² + h²), h the distance of the ends along the axis.

use super::choice::{Plane, Way, choose};
use crate::linalg::{Matrix, Vector};
use std::f64::consts::TAU;

/// What a path is around, with both its ends relative to the centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends<const P: usize> {
    pub ends: [Vector<P>; 2],
    /// Unit vector along a cylinder; none for a sphere, and in the plane.
    pub axis: Option<Vector<P>>,
    /// A point on the side on which the path passes.
    pub side: Option<Vector<P>>,
    pub radius: f64,
}

/// Λ(ρ₀, ρ₁, θ, r), with its derivatives by the first three and by r.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reduced {
    pub value: f64,
    pub first: [f64; 3],
    pub second: [[f64; 3]; 3],
    pub by_radius: f64,
    pub first_by_radius: [f64; 3],
}

/// A path that touches.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around<const P: usize> {
    pub length: f64,
    /// By the places of both ends.
    pub gradient: [Vector<P>; 2],
    pub by_radius: f64,
    plane: Plane<P>,
    /// +1 where θ is the angle between the ends, −1 where it is what that leaves of a turn.
    sign: f64,
    pub way: Way,
    reduced: Reduced,
    /// Distance along the axis.
    rise: f64,
    axis: Option<Vector<P>>,
    radius: f64,
}

/// Second derivatives of the length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curvature<const P: usize> {
    /// By the first end twice, by both, and by the second twice.
    pub hessian: [Matrix<P, P>; 3],
    pub gradient_by_radius: [Vector<P>; 2],
}

impl<const P: usize> Ends<P> {
    /// The path around, or none where the straight one is free.
    pub fn around(&self) -> Option<Around<P>> {
        let across = |x: Vector<P>| self.axis.map_or(x, |axis| x - axis * axis.dot(&x));
        let flat = self.ends.map(across);
        let plane = Plane::new(flat, self.axis, self.side.map(across))?;
        let inside = self.side.is_some_and(|side| side.norm() < self.radius);
        let way = choose(&plane, self.side.map(across), inside, self.radius)?;
        let (sign, theta) = match way {
            Way::Inside => (1.0, plane.angle),
            Way::Outside { sign, turns } => {
                (sign, turns * TAU + if sign > 0.0 { plane.angle } else { TAU - plane.angle })
            }
        };
        let reduced = match way {
            Way::Inside => Reduced::inside(plane.distances, theta, self.radius),
            Way::Outside { .. } => Reduced::outside(plane.distances, theta, self.radius),
        };
        let rise = self.axis.map_or(0.0, |axis| axis.dot(&(self.ends[1] - self.ends[0])));
        let length = reduced.value.hypot(rise);
        let mut around = Around {
            length,
            gradient: [Vector::ZERO; 2],
            by_radius: reduced.value * reduced.by_radius / length,
            plane,
            sign,
            way,
            reduced,
            rise,
            axis: self.axis,
            radius: self.radius,
        };
        let flat = around.flat_gradient(&reduced.first);
        around.gradient = [0, 1].map(|i| around.raised(flat[i], i));
        Some(around)
    }
}

impl<const P: usize> Around<P> {
    /// ∇Λ of something with these derivatives by ρ₀, ρ₁ and θ.
    fn flat_gradient(&self, first: &[f64; 3]) -> [Vector<P>; 2] {
        let Plane { normals, tangents, distances, .. } = &self.plane;
        [0, 1].map(|i| normals[i] * first[i] - tangents[i] * (self.sign * first[2] / distances[i]))
    }

    /// The gradient of √(Λ² + h²) by an end, from that of Λ.
    fn raised(&self, flat: Vector<P>, end: usize) -> Vector<P> {
        let Some(axis) = self.axis else { return flat };
        let rising = axis * if end == 0 { -self.rise } else { self.rise };
        (flat * self.reduced.value + rising) * (1.0 / self.length)
    }

    pub fn curvature(&self) -> Curvature<P> {
        let Plane { normals, tangents, distances, angle, .. } = &self.plane;
        let Reduced { value, first, second, by_radius, first_by_radius } = &self.reduced;
        let flat = self.flat_gradient(first);
        // Gradients of ρ₀, ρ₁ and θ by each end.
        let zero = Vector::<P>::ZERO;
        let by_end = [0, 1].map(|i| {
            let turning = tangents[i] * (-self.sign / distances[i]);
            if i == 0 { [normals[0], zero, turning] } else { [zero, normals[1], turning] }
        });
        let product = |i: usize, j: usize| {
            let mut sum = Matrix::<P, P>::ZERO;
            for (a, row) in second.iter().enumerate() {
                for (b, entry) in row.iter().enumerate().filter(|(_, entry)| **entry != 0.0) {
                    sum += by_end[i][a].outer(&by_end[j][b]) * *entry;
                }
            }
            sum
        };
        let space = self.axis.map_or(Matrix::identity(), |axis| Matrix::identity() - axis.outer(&axis));
        let spherical = P == 3 && self.axis.is_none();
        let (sine, cosine) = angle.sin_cos();
        let sine = sine.max(f64::EPSILON);
        let own = |i: usize| {
            let (n, t, rho) = (&normals[i], &tangents[i], distances[i]);
            let across = space - n.outer(n);
            let mut turned = n.outer(t) + t.outer(n);
            if spherical {
                // Perpendicular to the plane of both ends.
                turned += (across - t.outer(t)) * (cosine / sine);
            }
            product(i, i) + across * (first[i] / rho) + turned * (self.sign * first[2] / (rho * rho))
        };
        let mut mixed = product(0, 1);
        if spherical {
            let out = space - normals[0].outer(&normals[0]) - tangents[0].outer(&tangents[0]);
            mixed += out * (-self.sign * first[2] / (distances[0] * distances[1] * sine));
        }
        let mut hessian = [own(0), mixed, own(1)];
        let flat_by_radius = self.flat_gradient(first_by_radius);
        let mut gradient_by_radius = flat_by_radius;
        if let Some(axis) = self.axis {
            for (entry, (i, j)) in hessian.iter_mut().zip([(0, 0), (0, 1), (1, 1)]) {
                let rising = if i == j { 1.0 } else { -1.0 };
                let sum = flat[i].outer(&flat[j]) + *entry * *value + axis.outer(&axis) * rising;
                *entry = (sum - self.gradient[i].outer(&self.gradient[j])) * (1.0 / self.length);
            }
            for i in 0..2 {
                let change = flat[i] * *by_radius + flat_by_radius[i] * *value;
                gradient_by_radius[i] = (change - self.gradient[i] * self.by_radius) * (1.0 / self.length);
            }
        }
        Curvature { hessian, gradient_by_radius }
    }

    /// Points of the path on the surface, relative to the centre, of a path that starts at `start`.
    pub fn trace(&self, start: &Vector<P>, mut visit: impl FnMut(Vector<P>)) {
        let Plane { normals, tangents, distances, .. } = &self.plane;
        let (first, arc) = match self.way {
            Way::Inside => (Incidence::new(*distances, self.plane.angle, self.radius).central[0], 0.0),
            Way::Outside { .. } => {
                let alpha = (self.radius / distances[0]).acos();
                let straight = distances.map(|rho| (rho * rho - self.radius * self.radius).max(0.0).sqrt());
                (alpha, (self.reduced.value - straight[0] - straight[1]) / self.radius)
            }
        };
        let before = match self.way {
            Way::Inside => separation(distances[0], first, self.radius),
            Way::Outside { .. } => (distances[0] * distances[0] - self.radius * self.radius).max(0.0).sqrt(),
        };
        let steps = (arc / FACET).ceil().max(0.0);
        for k in 0..=steps as usize {
            let along = if steps > 0.0 { arc * k as f64 / steps } else { 0.0 };
            let (sine, cosine) = (self.sign * (first + along)).sin_cos();
            let around = (normals[0] * cosine + tangents[0] * sine) * self.radius;
            visit(match self.axis {
                None => around,
                Some(axis) => {
                    let share = (before + self.radius * along) / self.reduced.value;
                    around + axis * (axis.dot(start) + self.rise * share)
                }
            });
        }
    }
}

/// Largest angle of one piece of a path that is drawn [rad].
const FACET: f64 = 0.1;

/// |x − t| of a point at the distance ρ from the centre and one on the circle, at an angle.
fn separation(rho: f64, angle: f64, r: f64) -> f64 {
    // By the half angle, without cancellation where they are close.
    (rho - r).hypot(2.0 * (rho * r).sqrt() * (0.5 * angle).sin())
}

impl Reduced {
    fn outside(rho: [f64; 2], theta: f64, r: f64) -> Self {
        let tangent = rho.map(|rho| ((rho - r) * (rho + r)).max(0.0).sqrt());
        let arc = theta - (tangent[0] / r).atan() - (tangent[1] / r).atan();
        let mut second = [[0.0; 3]; 3];
        let mut first_by_radius = [0.0, 0.0, 1.0];
        for i in 0..2 {
            // An end on the surface itself has no curvature of the tangent to it.
            let s = tangent[i].max(f64::EPSILON * r);
            second[i][i] = r * r / (rho[i] * rho[i] * s);
            first_by_radius[i] = -r / (rho[i] * s);
        }
        Self {
            value: tangent[0] + tangent[1] + r * arc,
            first: [tangent[0] / rho[0], tangent[1] / rho[1], r],
            second,
            by_radius: arc,
            first_by_radius,
        }
    }

    fn inside(rho: [f64; 2], theta: f64, r: f64) -> Self {
        let central = Incidence::new(rho, theta, r).central;
        // a(ρ, φ, r) = |x − t|.
        let part = |i: usize| {
            let (a, (s, c)) = (separation(rho[i], central[i], r), central[i].sin_cos());
            let (by_rho, by_phi, by_r) = ((rho[i] - r * c) / a, rho[i] * r * s / a, (r - rho[i] * c) / a);
            let second = [
                (1.0 - by_rho * by_rho) / a,
                (r * s - by_rho * by_phi) / a,
                (rho[i] * r * c - by_phi * by_phi) / a,
            ];
            let mixed = [(-c - by_rho * by_r) / a, (rho[i] * s - by_phi * by_r) / a];
            (a, [by_rho, by_phi, by_r], second, mixed)
        };
        let (a0, first0, [rr0, rp0, pp0], [ri0, pi0]) = part(0);
        let (a1, first1, [rr1, rp1, pp1], [ri1, pi1]) = part(1);
        // t moves so that its own derivative stays zero.
        let stiff = pp0 + pp1;
        let moved = [rp0, -rp1, -pp1];
        let mut second = [[rr0, 0.0, 0.0], [0.0, rr1, rp1], [0.0, rp1, pp1]];
        for (row, a) in second.iter_mut().zip(moved) {
            row.iter_mut().zip(moved).for_each(|(entry, b)| *entry -= a * b / stiff);
        }
        let by_r = pi0 - pi1;
        let direct = [ri0, ri1, pi1];
        Self {
            value: a0 + a1,
            first: [first0[0], first1[0], first1[1]],
            second,
            by_radius: first0[2] + first1[2],
            first_by_radius: std::array::from_fn(|i| direct[i] - moved[i] * by_r / stiff),
        }
    }
}

/// Where a path that passes inside touches: both straight parts meet the normal at the same angle β.
struct Incidence {
    /// Angle at the centre between t and each end.
    central: [f64; 2],
}

impl Incidence {
    fn new(rho: [f64; 2], theta: f64, r: f64) -> Self {
        // Grows with β, from zero at zero: in the triangle of the centre, t and an end.
        let central = |beta: f64| rho.map(|rho| beta - (r / rho * beta.sin()).asin());
        let (mut low, mut high) = (0.0, 0.5 * std::f64::consts::PI);
        let mut beta = high;
        for _ in 0..ITERATIONS {
            let [a, b] = central(beta);
            let excess = a + b - theta;
            *(if excess > 0.0 { &mut high } else { &mut low }) = beta;
            let slope: f64 = rho
                .iter()
                .map(|rho| {
                    let k = r / rho;
                    1.0 - k * beta.cos() / (1.0 - (k * beta.sin()).powi(2)).max(f64::MIN_POSITIVE).sqrt()
                })
                .sum();
            let newton = beta - excess / slope;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if (next - beta).abs() <= f64::EPSILON * beta {
                break;
            }
            beta = next;
        }
        let [a, b] = central(beta);
        // What rounding leaves is shared.
        let rest = 0.5 * (theta - a - b);
        Self { central: [a + rest, b + rest] }
    }
}

/// More than Newton's method, or halving, ever needs.
const ITERATIONS: usize = 64;
