//! On which side of a wrap a tendon passes, and whether it touches.

use crate::linalg::Vector;
use std::f64::consts::TAU;

/// The plane in which a path goes around: of a sphere that of both ends and the centre, of a cylinder the
/// one across its axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane<const P: usize> {
    /// Distances of both ends from the centre.
    pub distances: [f64; 2],
    /// Unit vectors from the centre to each end.
    pub normals: [Vector<P>; 2],
    /// Perpendicular to these, each towards the other end.
    pub tangents: [Vector<P>; 2],
    /// Angle between them.
    pub angle: f64,
}

/// How a path touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Way {
    /// It turns at one point of the inner side.
    Inside,
    /// It winds around, with the angle between its ends or against it, and full turns beyond.
    Outside { sign: f64, turns: f64 },
}

impl<const P: usize> Plane<P> {
    /// None if an end is at the centre.
    pub fn new(ends: [Vector<P>; 2], axis: Option<Vector<P>>, side: Option<Vector<P>>) -> Option<Self> {
        let distances = ends.map(|x| x.norm());
        if distances.contains(&0.0) {
            return None;
        }
        let normals = [0, 1].map(|i| ends[i] * (1.0 / distances[i]));
        let cosine = normals[0].dot(&normals[1]);
        let away = normals[1] - normals[0] * cosine;
        let sine = away.norm();
        let first = if sine > 0.0 { away * (1.0 / sine) } else { perpendicular(&normals[0], axis, side) };
        let second = normals[0] * sine - first * cosine;
        Some(Self { distances, normals, tangents: [first, second], angle: sine.atan2(cosine) })
    }

    /// Coordinates of a vector along the first end and across it.
    fn coordinates(&self, x: &Vector<P>) -> [f64; 2] {
        [self.normals[0].dot(x), self.tangents[0].dot(x)]
    }
}

/// A unit vector across `n`: across the axis too, or towards the side, or any.
fn perpendicular<const P: usize>(
    n: &Vector<P>,
    axis: Option<Vector<P>>,
    side: Option<Vector<P>>,
) -> Vector<P> {
    let candidates = side.into_iter().chain((0..P).map(Vector::unit));
    let across = |x: Vector<P>| {
        let x = x - *n * n.dot(&x);
        axis.map_or(x, |axis| x - axis * axis.dot(&x))
    };
    let best = candidates.map(across).fold(
        Vector::ZERO,
        |best: Vector<P>, x| {
            if x.norm() > best.norm() { x } else { best }
        },
    );
    best * (1.0 / best.norm())
}

/// How a path between the ends touches the circle, if it does.
///
/// It touches where the straight one would pass through the circle, or on the side away from `side`; without
/// a side it takes the shorter way.
pub(super) fn choose<const P: usize>(
    plane: &Plane<P>,
    side: Option<Vector<P>>,
    inside: bool,
    r: f64,
) -> Option<Way> {
    let [rho0, rho1] = plane.distances;
    if rho0 <= r || rho1 <= r {
        return None;
    }
    let (sine, cosine) = plane.angle.sin_cos();
    let ends = [[rho0, 0.0], [rho1 * cosine, rho1 * sine]];
    let (nearest, share) = nearest_to_centre(ends);
    let distance = nearest[0].hypot(nearest[1]);
    if inside {
        let crosses = share > 0.0 && share < 1.0 && distance <= r;
        return (!crosses && plane.angle > 0.0).then_some(Way::Inside);
    }
    let side = side.map(|side| plane.coordinates(&side)).filter(|side| side[0].hypot(side[1]) > 0.0);
    let towards = |x: [f64; 2]| side.map(|side| side[0] * x[0] + side[1] * x[1]);
    if distance > r && towards(nearest).is_none_or(|along| along >= 0.0) {
        return None;
    }
    let tangent = [rho0, rho1].map(|rho| ((rho - r) * (rho + r)).sqrt());
    let alpha = tangent.map(|s| (s / r).atan());
    let mut best: Option<(f64, Way)> = None;
    for sign in [-1.0, 1.0] {
        let theta = if sign > 0.0 { plane.angle } else { TAU - plane.angle };
        let mut arc = theta - alpha[0] - alpha[1];
        let mut turns = 0.0;
        if arc < 0.0 {
            // Its straight parts cross, unless one is too short for that.
            let pole = r * (0.5 * -arc).tan();
            if pole >= 0.0 && pole <= tangent[0].min(tangent[1]) {
                continue;
            }
            arc += TAU;
            turns = 1.0;
        }
        let [first, last] = [sign * alpha[0], plane.angle - sign * alpha[1]];
        let middle = [first.cos() + last.cos(), first.sin() + last.sin()];
        let good = match towards(middle) {
            Some(along) => along / middle[0].hypot(middle[1]).max(f64::MIN_POSITIVE),
            None => -arc,
        };
        if best.is_none_or(|(other, _)| good >= other) {
            best = Some((good, Way::Outside { sign, turns }));
        }
    }
    best.map(|(_, way)| way)
}

/// The point of a segment nearest to the origin, and where on the segment it is.
fn nearest_to_centre([a, b]: [[f64; 2]; 2]) -> ([f64; 2], f64) {
    let d = [b[0] - a[0], b[1] - a[1]];
    let squared = d[0] * d[0] + d[1] * d[1];
    let share = if squared > 0.0 { -(d[0] * a[0] + d[1] * a[1]) / squared } else { 0.0 };
    let t = share.clamp(0.0, 1.0);
    ([a[0] + t * d[0], a[1] + t * d[1]], share)
}
