//! Balls around blocks of spheres: what is far from a ball is far from all that it holds.

use crate::design::Design;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::{Contact, Model};
use std::ops::Range;

/// Spheres of one block, neighbours in their group.
const BLOCK: usize = 8;
/// With fewer pairs of spheres testing each is as fast.
const MANY: usize = 1_000;

/// A ball that holds a block of spheres of a contact's second group.
#[derive(Clone, Debug)]
pub(crate) struct Ball<const P: usize> {
    pub centre: Vector<P>,
    pub radius: f64,
}

impl<const P: usize> Ball<P> {
    pub const POINT: Self = Self { centre: Vector::ZERO, radius: 0.0 };
}

/// How many balls a contact needs.
pub(crate) fn count(contact: &Contact) -> usize {
    let few = contact.first.len() * contact.second.len() < MANY;
    if few || !contact.cones.is_empty() { 0 } else { contact.second.len().div_ceil(BLOCK) }
}

/// The `k`-th block of so many spheres.
#[inline]
pub(crate) fn block(spheres: usize, k: usize) -> Range<usize> {
    k * BLOCK..((k + 1) * BLOCK).min(spheres)
}

/// Encloses the blocks of all contacts that need it.
pub(crate) fn update<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    design: &Design<G, D, P>,
    points: &[Vector<P>],
    balls: &mut [Ball<P>],
) {
    for contact in &model.contacts {
        let centres = contact.second_centres(&model.spheres, points).chunks(BLOCK);
        let radii = design.radii[contact.second.clone()].chunks(BLOCK);
        for (ball, (centres, radii)) in balls[contact.balls.clone()].iter_mut().zip(centres.zip(radii)) {
            ball.centre = (centres[0] + centres[centres.len() - 1]) * 0.5;
            let spheres = centres.iter().zip(radii);
            let reach = spheres.map(|(centre, radius)| (*centre - ball.centre).norm() + radius);
            // No rounding may leave a sphere outside.
            ball.radius = reach.fold(0.0, f64::max) * (1.0 + 1e-12);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::Data;
    use crate::lie::SE2;
    use crate::model::{Model, SphereDescription, Station};
    use crate::potential::touch;
    use crate::systems::finger;

    #[test]
    fn blocks_hide_no_pair() {
        let mut d = finger();
        let on = |body: &str, k: usize| SphereDescription {
            body: body.into(),
            station: Station::Fraction(k as f64 / 30.0),
        };
        let links = ["ph_1", "ph_2", "ph_3"];
        d.spheres[1].spheres = links.iter().flat_map(|body| (0..30).map(|k| on(body, k))).collect();
        let mut own = d.contacts[0].clone();
        (own.name, own.second, own.skip) = ("own".into(), own.first.clone(), 3);
        d.contacts.push(own);
        let model = Model::<SE2, 3, 2>::new(&d).unwrap();
        assert!(model.contacts.iter().all(|c| !c.balls.is_empty()));
        let mut data = Data::new(&model);
        let mut seen = [0, 0];
        for state in 0..20 {
            let wave = |i: usize| ((i + 1) as f64 * (1.1 + 0.23 * f64::from(state))).sin();
            let q: Vec<f64> = (0..model.dof()).map(|i| 0.6 * wave(i)).collect();
            data.evaluate(&model, &q, &[0.0]);
            for (c, contact) in model.contacts.iter().enumerate() {
                let mut each = contact.clone();
                each.balls = 0..0;
                for margin in [0.0, 1e-3, 2e-2] {
                    let pairs = |contact| {
                        let mut pairs = vec![];
                        let visit = |t: touch::Touch<2>| pairs.push((t.first, t.second[0], t.overlap));
                        touch::for_each_near(&model, &data.design, &data.kinematics, contact, margin, visit);
                        pairs
                    };
                    let found = pairs(contact);
                    assert_eq!(found, pairs(&each));
                    seen[c] += found.len();
                }
            }
        }
        assert!(seen.iter().all(|pairs| *pairs > 100), "{seen:?}");
    }
}
