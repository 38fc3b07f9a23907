//! Bounding balls of blocks of spheres, to reject distant pairs.

use super::super::state::State;
use super::definition::Contact;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use std::ops::Range;

/// Number of consecutive spheres that share a ball.
pub(crate) const BLOCK_SIZE: usize = 8;
/// Number of pairs below which testing each pair is as fast.
const MIN_PAIRS: usize = 1_000;

/// A ball that contains a block of spheres of a contact's second group.
#[derive(Clone, Debug)]
pub(crate) struct Ball<const P: usize> {
    pub centre: Vector<P>,
    pub radius: f64,
}

impl<const P: usize> Ball<P> {
    pub const POINT: Self = Self { centre: Vector::ZERO, radius: 0.0 };

    /// That of spheres, of which there is at least one.
    #[inline]
    pub fn around(centres: &[Vector<P>], radii: &[f64]) -> Self {
        let centre = (centres[0] + centres[centres.len() - 1]) * 0.5;
        let larger = |a: f64, b: f64| if a > b { a } else { b };
        let squares = centres.iter().map(|each| (*each - centre).dot(&(*each - centre)));
        let (farthest, widest) = (squares.fold(0.0, larger).sqrt(), radii.iter().copied().fold(0.0, larger));
        // A margin for rounding errors.
        Self { centre, radius: (farthest + widest) * (1.0 + 1e-12) }
    }
}

/// Number of balls of a contact.
pub(crate) fn count(contact: &Contact) -> usize {
    let few = contact.first.len() * contact.second.len() < MIN_PAIRS;
    if few || !contact.cones.is_empty() { 0 } else { contact.second.len().div_ceil(BLOCK_SIZE) }
}

/// The `k`-th block of `count` spheres.
#[inline]
pub(crate) fn block(spheres: usize, k: usize) -> Range<usize> {
    k * BLOCK_SIZE..((k + 1) * BLOCK_SIZE).min(spheres)
}

/// Updates the balls of all contacts.
pub(crate) fn update<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    contacts: &[Contact],
    balls: &mut [Ball<P>],
) {
    for contact in contacts {
        let centres = contact.second_centres(&at.tree.spheres, &at.kinematics.points).chunks(BLOCK_SIZE);
        let radii = at.geometry.radii[contact.second.clone()].chunks(BLOCK_SIZE);
        for (ball, (centres, radii)) in balls[contact.balls.clone()].iter_mut().zip(centres.zip(radii)) {
            *ball = Ball::around(centres, radii);
        }
    }
}
