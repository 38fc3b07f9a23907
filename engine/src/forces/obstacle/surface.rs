//! Surfaces of obstacles: distances of points, with their first and second derivatives.

use crate::linalg::{Matrix, Vector};
use crate::tolerances::SWITCHING_DISTANCE;
use serde::Deserialize;

/// A surface in the axes of its obstacle.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum SurfaceDescription {
    /// The half-space of all points x with n·x below `distance`.
    Plane {
        /// Unit vector n out of the obstacle.
        normal: [f64; 3],
        /// Distance of the plane from the origin along it [m].
        distance: f64,
    },
    /// All points within a radius of a box around the origin: a sphere around a point, a capsule around a
    /// segment, an endless cylinder around a line, a box with rounded edges around a box.
    Rounded {
        /// Half of the box's size along each axis [m]; none where it is endless.
        half: [Option<f64>; 3],
        /// The radius [m].
        radius: f64,
        /// Whether the obstacle is what lies outside: a sleeve.
        inside: bool,
    },
}

/// A surface in the axes of its obstacle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Surface<const P: usize> {
    Plane {
        normal: Vector<P>,
        distance: f64,
    },
    Rounded {
        /// Along which axes it is endless.
        endless: [bool; P],
        /// Parameters holding half of the box's size along the others.
        half: usize,
        /// Parameter holding the radius.
        radius: usize,
        /// −1 if the obstacle is what lies outside, otherwise 1.
        side: f64,
    },
}

/// How the distance of a point from a surface changes as the point moves.
#[derive(Clone, Debug)]
pub(crate) struct Slopes<const P: usize> {
    /// Gradient: unit vector out of the obstacle.
    pub normal: Vector<P>,
    /// Hessian, where it is not zero.
    pub curvature: Option<Matrix<P, P>>,
}

impl<const P: usize> Surface<P> {
    /// Distance of a place, given in the obstacle's axes, from the surface; negative in the obstacle.
    ///
    /// Outside a box it is ‖(|x| − b)₊‖ and continuously differentiable; in it, max(|x| − b).
    #[inline]
    pub fn distance(&self, parameters: &[f64], place: &Vector<P>) -> f64 {
        match self {
            Self::Plane { normal, distance } => normal.dot(place) - distance,
            Self::Rounded { radius, side, .. } => {
                let beyond = self.beyond(parameters, place);
                let squared: f64 = beyond.iter().map(|x| x.max(0.0).powi(2)).sum();
                let from_box = if squared > 0.0 {
                    squared.sqrt()
                } else {
                    beyond.into_iter().fold(f64::NEG_INFINITY, f64::max)
                };
                side * (from_box - parameters[*radius])
            }
        }
    }

    /// Its derivatives, in the world in which the obstacle's axes are these.
    pub fn slopes(&self, parameters: &[f64], axes: &[Vector<P>; P], place: &Vector<P>) -> Slopes<P> {
        match self {
            Self::Plane { normal, .. } => {
                let along = axes.iter().enumerate().map(|(i, axis)| *axis * normal[i]);
                Slopes { normal: along.fold(Vector::ZERO, |sum, part| sum + part), curvature: None }
            }
            Self::Rounded { side, .. } => {
                let beyond = self.beyond(parameters, place);
                let outside = (0..P).filter(|i| beyond[*i] > 0.0);
                let away = |i: usize| axes[i] * 1f64.copysign(place[i]);
                let normal = outside.clone().fold(Vector::ZERO, |sum, i| sum + away(i) * beyond[i]);
                let length = normal.norm();
                if length == 0.0 {
                    return Slopes { normal: away(nearest(&beyond)) * *side, curvature: None };
                }
                let normal = normal * (1.0 / length);
                let curved = outside.clone().count() > 1;
                let curvature = curved.then(|| {
                    let across = outside.fold(Matrix::ZERO, |sum, i| sum + axes[i].outer(&axes[i]));
                    (across - normal.outer(&normal)) * (side / length)
                });
                Slopes { normal: normal * *side, curvature }
            }
        }
    }

    /// The parameter holding its radius, with the derivative of the distance by it.
    pub fn radius(&self) -> Option<(usize, f64)> {
        match self {
            Self::Plane { .. } => None,
            Self::Rounded { radius, side, .. } => Some((*radius, -side)),
        }
    }

    /// The axes along which a face is on whose place the distance depends, with the parameter holding its
    /// distance from the middle and the derivative of that place by it.
    pub fn faces(&self, parameters: &[f64], place: &Vector<P>) -> impl Iterator<Item = (usize, usize, f64)> {
        let beyond = self.beyond(parameters, place);
        let inside = beyond.iter().all(|x| *x <= 0.0);
        let nearest = nearest(&beyond);
        let first = match self {
            Self::Plane { .. } => None,
            Self::Rounded { half, .. } => Some(*half),
        };
        let signs: [f64; P] = std::array::from_fn(|i| 1f64.copysign(place[i]));
        (0..P).filter_map(move |i| {
            let acts = if inside { i == nearest } else { beyond[i] > 0.0 };
            first.filter(|_| acts).map(|first| (i, first + i, signs[i]))
        })
    }

    /// How deep what lies behind the surface is at most; `None` where it has no other side.
    pub fn thickness(&self, parameters: &[f64]) -> Option<f64> {
        match self {
            Self::Rounded { endless, half, radius, side } if *side > 0.0 => {
                let halves = (0..P).filter(|i| !endless[*i]).map(|i| parameters[half + i]);
                Some(parameters[*radius] + halves.fold(f64::INFINITY, f64::min))
            }
            _ => None,
        }
    }

    /// Whether its parameters are physically meaningful.
    pub fn is_admissible(&self, parameters: &[f64]) -> bool {
        match self {
            Self::Plane { .. } => true,
            Self::Rounded { half, radius, .. } => {
                parameters[*radius] >= 0.0 && parameters[*half..*half + P].iter().all(|size| *size >= 0.0)
            }
        }
    }

    /// The axes along which a place is where a face or side ends and an edge or cap begins, at which the
    /// curvature jumps.
    pub fn seams(&self, parameters: &[f64], place: &Vector<P>, size: f64) -> impl Iterator<Item = usize> {
        let beyond = self.beyond(parameters, place);
        let long: [bool; P] = std::array::from_fn(|i| place[i].abs() - beyond[i] > 0.0);
        (0..P).filter(move |i| {
            let others = (0..P).any(|j| j != *i && beyond[j] > 0.0);
            others && long[*i] && beyond[*i].abs() < SWITCHING_DISTANCE * size
        })
    }

    /// How far a place is beyond the faces of its box, along each axis.
    #[inline]
    fn beyond(&self, parameters: &[f64], place: &Vector<P>) -> [f64; P] {
        match self {
            Self::Plane { .. } => [f64::NEG_INFINITY; P],
            Self::Rounded { endless, half, .. } => std::array::from_fn(|i| {
                if endless[i] { f64::NEG_INFINITY } else { place[i].abs() - parameters[half + i] }
            }),
        }
    }
}

/// The axis along which a place is least far behind a face.
fn nearest<const P: usize>(beyond: &[f64; P]) -> usize {
    (1..P).fold(0, |best, i| if beyond[i] > beyond[best] { i } else { best })
}
