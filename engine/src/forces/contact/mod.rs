//! Contact of spheres with spheres and round cones (8): ½ k w max(d, 0)², d the overlap.

mod definition;
mod enclosure;
mod pair;
mod round_cone;
mod sliding;
mod sphere;
mod threshold;

pub(crate) use definition::{Contact, RoundCone, round_cones};
pub use definition::{ContactDescription, RoundConeDescription};
pub(crate) use pair::ContactPair;
use pair::KeptForce;
pub(crate) use round_cone::{Closest, MovingCone, PlacedCone};
pub(crate) use sphere::direction;

use super::crossing::{Crossing, Motion, thinnest_pair};
use super::differential::{Depth, Differential};
use super::element::{ContactForce, ForceElement, ForceMemory, Switch, Velocities, VirtualMotion};
use super::friction::{Direction, Pressed, PressedChange};
use super::magnitudes::Magnitudes;
use super::state::{Law, State};
use super::terms::Terms;
use crate::geometry::{add_radius_slope, radius_slope};
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tolerances::SAME_FORCE;
use crate::tree::{ModelError, Tree};
use enclosure::Ball;

/// All contacts.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Contacts(Vec<Contact>);

/// The contacts of a state.
#[derive(Clone, Debug)]
pub(crate) struct ContactState<const P: usize> {
    /// Bounding balls of contacts with many spheres.
    balls: Vec<Ball<P>>,
    /// The pairs that touch, with the index of their contact.
    pairs: Vec<(usize, ContactPair<P>)>,
    /// The kept forces, with the index of their contact.
    kept: Vec<(usize, KeptForce)>,
}

/// A summary of the contacts of a state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactSummary {
    /// Touching pairs of a sphere with a sphere or round cone.
    pub pairs: u32,
    /// Spheres of the contacts' first groups that touch.
    pub touching: u32,
    /// Magnitude of the resultant contact force on the tip [N].
    pub tip_force: f64,
    /// Largest overlap [m].
    pub overlap: f64,
    /// How deep the centreline of a rod is in what it touches at most [m]; negative outside, none where no rod
    /// of a first group touches.
    pub centreline: Option<f64>,
    /// Largest pressure on an elastic foundation [Pa].
    pub pressure: f64,
}

impl ContactSummary {
    /// Counts the overlap of a sphere in.
    pub(crate) fn add_overlap<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        at: &State<G, D, P>,
        sphere: usize,
        depth: f64,
    ) {
        self.overlap = self.overlap.max(depth);
        if at.tree.spheres[sphere].is_on_rod() {
            let centre = depth - at.geometry.radii[sphere];
            self.centreline = Some(self.centreline.map_or(centre, |deepest| deepest.max(centre)));
        }
    }
}

impl Contacts {
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        contacts: &[ContactDescription],
    ) -> Result<Self, ModelError> {
        let mut built = vec![];
        let mut balls = 0;
        for contact in contacts {
            let mut contact = Contact::build(tree, contact)?;
            contact.balls = balls..balls + enclosure::count(&contact);
            balls = contact.balls.end;
            built.push(contact);
        }
        Ok(Self(built))
    }

    /// The touching pairs with their contact and their stiffness k w.
    pub fn pairs<'a, const P: usize>(
        &'a self,
        parameters: &'a [f64],
        state: &'a ContactState<P>,
    ) -> impl Iterator<Item = (&'a Contact, f64, &'a ContactPair<P>)> {
        state.pairs.iter().map(|(contact, pair)| {
            let contact = &self.0[*contact];
            (contact, parameters[contact.stiffness] * pair.weight, pair)
        })
    }

    /// The pairs of tip spheres among them.
    pub fn tip_pairs<'a, const P: usize>(
        &'a self,
        parameters: &'a [f64],
        state: &'a ContactState<P>,
    ) -> impl Iterator<Item = (&'a Contact, f64, &'a ContactPair<P>)> {
        self.pairs(parameters, state).filter(|(contact, _, pair)| contact.is_tip(pair.first))
    }

    /// Counts touching pairs and spheres and sums the force on the tip, without allocating.
    pub fn summarise<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        state: &ContactState<P>,
        summary: &mut ContactSummary,
        tip: &mut Vector<P>,
    ) {
        let mut last = None;
        for (contact, k, pair) in self.pairs(at.parameters(), state) {
            let this = Some((std::ptr::from_ref(contact), pair.first));
            summary.pairs += u32::from(pair.weight > 0.0);
            summary.touching += u32::from(this != last);
            last = this;
            summary.add_overlap(at, pair.first, pair.overlap);
            if contact.is_tip(pair.first) {
                *tip += pair.normal * (k * pair.overlap);
            }
        }
    }

    /// Visits the pairs of a contact that touch, or whose gap, a negative overlap, is below
    /// `margin`, in the order of the first group.
    #[inline]
    fn for_each_near<G: LieGroup<D, P>, const D: usize, const P: usize>(
        at: &State<G, D, P>,
        balls: &[Ball<P>],
        contact: &Contact,
        margin: f64,
        visit: impl FnMut(ContactPair<P>),
    ) {
        if contact.cones.is_empty() {
            sphere::for_each_near(at, balls, contact, margin, visit);
        } else {
            round_cone::for_each_near(at, contact, margin, visit);
        }
    }
}

/// The kept forces of one contact.
fn of_contact(kept: &[(usize, KeptForce)], contact: usize) -> impl Iterator<Item = &KeptForce> {
    kept.iter().filter(move |(index, _)| *index == contact).map(|(_, force)| force)
}

/// λ-weighted rates of a pair: the overlap's, and what the radii add to it where t follows the points.
fn add_pair_parameters<G: LieGroup<D, P>, const D: usize, const P: usize>(
    at: &State<G, D, P>,
    contact: &Contact,
    pair: &ContactPair<P>,
    k: f64,
    [normal, slide]: [f64; 2],
    gradient: &mut [f64],
) {
    let p = at.parameters();
    gradient[contact.stiffness] += pair.weight * pair.overlap * normal;
    if let Some(length) = contact.lengths.get(pair.first - contact.first.start) {
        gradient[*length] += k * pair.overlap * normal / p[*length];
    }
    let [a, b] = pair.second;
    for (i, sphere) in [pair.first, a, b].into_iter().enumerate() {
        let weight = pair.by_radii()[i] * normal + pair.slide_by_radii()[i] * slide;
        add_radius_slope(at.tree, p, at.tree.spheres[sphere].radius, k * weight, gradient);
    }
}

impl<const P: usize> ForceMemory<P> for Contacts {
    type Design = ();
    type State = ContactState<P>;
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Contacts {
    fn design(&self, _: &Tree<G, D, P>) {}

    fn state(&self, _: &Tree<G, D, P>) -> ContactState<P> {
        ContactState {
            balls: vec![Ball::POINT; self.0.last().map_or(0, |c| c.balls.end)],
            pairs: Vec::with_capacity(self.0.iter().map(Contact::max_couplings).sum()),
            kept: vec![],
        }
    }

    fn is_admissible(&self, parameters: &[f64]) -> bool {
        self.0.iter().all(|contact| parameters[contact.stiffness] >= 0.0)
    }

    fn max_couplings(&self) -> usize {
        self.0.iter().map(Contact::max_couplings).sum()
    }

    fn has_switches(&self) -> bool {
        !self.0.is_empty()
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &mut ContactState<P>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        enclosure::update(at, &self.0, &mut state.balls);
        let ContactState { balls, pairs, kept } = state;
        pairs.clear();
        for (index, contact) in self.0.iter().enumerate() {
            let k = at.parameters()[contact.stiffness];
            let margin = if at.law == Law::Actual { 0.0 } else { contact.reach(&at.geometry.radii) };
            Self::for_each_near(at, balls, contact, margin, |mut pair| {
                let k = k * pair.weight;
                if at.law != Law::Actual && !pair.take_force(at.law, k, of_contact(kept, index)) {
                    return;
                }
                out.energy += 0.5 * k * pair.overlap * pair.overlap;
                let force = pair.normal * (-k * pair.overlap);
                let [p, a, b] = pair.points(at.tree);
                let mut push = |point: usize, force: &Vector<P>| {
                    out.add_force::<G, P>(at.frame(point), at.point(point), force);
                };
                push(p, &force);
                if a == b {
                    push(a, &-force);
                } else {
                    push(a, &(force * (pair.t - 1.0)));
                    push(b, &(force * -pair.t));
                }
                pairs.push((index, pair));
            });
        }
    }

    fn add_tangent(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &ContactState<P>,
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        for (_, k, pair) in self.pairs(at.parameters(), state) {
            if pair.slip > 0.0 {
                sliding::add_tangent(at, pair, k, out);
            } else {
                let force = pair.normal * (-k * pair.overlap);
                let tangential = -k * pair.overlap / pair.curvature_radius();
                let [p, end, _] = pair.points(at.tree);
                let frames = [p, end].map(|point| at.frame(point));
                let ends = [p, end].map(|point| at.point(point));
                out.add_pair::<G, P>(frames, ends, &force, &pair.normal, [k, tangential]);
            }
        }
    }

    fn for_each_stiffness(&self, parameters: &[f64], visit: &mut impl FnMut(usize, f64)) {
        for contact in &self.0 {
            let weights = contact.first.clone().map(|first| contact.weight(parameters, first));
            visit(contact.stiffness, weights.fold(0.0, f64::max));
        }
    }

    fn keep(&self, at: &State<G, D, P>, motion: &Velocities<D, P>, state: &mut ContactState<P>) {
        let ContactState { balls, kept, .. } = state;
        let before = std::mem::take(kept);
        for (index, contact) in self.0.iter().enumerate() {
            let k = at.parameters()[contact.stiffness];
            Self::for_each_near(at, balls, contact, contact.reach(&at.geometry.radii), |pair| {
                let depth = pair.overlap + pair.closing(&pair.motion(at.tree, motion.points));
                let acts = pair.overlap > 0.0 || pair.is_among(of_contact(&before, index));
                if acts && depth > 0.0 {
                    kept.push((index, KeptForce::new(&pair, k * pair.weight * depth)));
                }
            });
        }
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, _: &(), state: &ContactState<P>, out: &mut Magnitudes<P>) {
        for (_, k, pair) in self.pairs(at.parameters(), state) {
            let force = k * pair.overlap;
            let [p, a, b] = pair.points(at.tree);
            let places = at.point(p).norm() + at.point(a).norm() + pair.overlap + pair.distance;
            for (point, share) in [(p, 1.0), (a, 1.0 - pair.t), (b, pair.t)] {
                out.add_of_distance(at, point, force * share, [k * share, places]);
            }
        }
    }

    fn for_each_switch(
        &self,
        at: &State<G, D, P>,
        state: &ContactState<P>,
        margin: f64,
        visit: &mut impl FnMut(Switch<P>),
    ) {
        for contact in &self.0 {
            let k = at.parameters()[contact.stiffness];
            Self::for_each_near(at, &state.balls, contact, margin, |pair| {
                visit(Switch {
                    points: pair.points(at.tree),
                    t: pair.t,
                    own: None,
                    carrier: None,
                    normal: pair.normal,
                    depth: pair.overlap,
                    stiffness: k * pair.weight,
                });
            });
        }
    }

    fn has_solids(&self) -> bool {
        !self.0.is_empty()
    }

    fn switched_on(&self, _: &State<G, D, P>, state: &ContactState<P>) -> usize {
        state.pairs.len()
    }

    fn thinnest(&self, at: &State<G, D, P>) -> f64 {
        let pairs = self.0.iter().map(|contact| [&contact.first, &contact.second]);
        pairs.map(|groups| thinnest_pair(at, groups)).fold(f64::INFINITY, f64::min)
    }

    fn may_cross(&self, motion: &Motion<G, D, P>) -> bool {
        self.0.iter().any(|contact| !contact.cones.is_empty() || sphere::may_cross(motion, contact))
    }

    fn for_each_crossing(&self, motion: &Motion<G, D, P>, visit: &mut impl FnMut(Crossing)) {
        let parameters = motion.ends[0].parameters();
        for contact in self.0.iter().filter(|contact| parameters[contact.stiffness] > 0.0) {
            if contact.cones.is_empty() {
                sphere::for_each_crossing(motion, contact, visit);
            } else {
                round_cone::for_each_crossing(motion, contact, visit);
            }
        }
    }

    fn at_threshold(&self, at: &State<G, D, P>, moves: &impl Fn(&[usize], &Vector<P>) -> bool) -> bool {
        self.0.iter().any(|contact| {
            if contact.cones.is_empty() {
                threshold::of_spheres(at, contact, moves)
            } else {
                threshold::of_round_cones(at, contact, moves)
            }
        })
    }

    /// Contact of two joined round cones at their common sphere counts once.
    fn contact_forces(&self, at: &State<G, D, P>, state: &ContactState<P>, out: &mut Vec<ContactForce<P>>) {
        for (contact, k, pair) in self.pairs(at.parameters(), state) {
            let force = pair.normal * (k * pair.overlap);
            let same = |f: &ContactForce<P>| {
                f.first == pair.first && (f.force + force).norm() <= SAME_FORCE * force.norm()
            };
            let shared = out.iter().rposition(same).filter(|_| pair.weight < 0.0);
            if let Some(i) = shared {
                out.remove(i);
                continue;
            }
            let inward = at.geometry.radii[pair.first] - 0.5 * pair.overlap;
            out.push(ContactForce {
                first: pair.first,
                second: Some(pair.second),
                obstacle: None,
                cone: !contact.cones.is_empty(),
                nearest: Some(pair.second[usize::from(pair.t >= 0.5)]),
                force,
                depth: pair.overlap,
                pressure: None,
                point: *at.centre(pair.first) - pair.normal * inward,
            });
        }
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &ContactState<P>,
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        for (contact, k, pair) in self.pairs(at.parameters(), state) {
            let velocity = pair.motion(at.tree, motion.velocities.points);
            let slide = pair.overlap * pair.slip * pair.slide(&velocity);
            add_pair_parameters(at, contact, pair, k, [pair.closing(&velocity), slide], gradient);
        }
    }

    fn add_geometric_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        state: &ContactState<P>,
        motion: &VirtualMotion<D, P>,
        velocities: &Velocities<D, P>,
        work: &mut f64,
    ) {
        let mut sum = 0.0;
        for (_, k, pair) in self.pairs(at.parameters(), state) {
            let change = pair.motion(at.tree, velocities.points);
            let velocity = pair.motion(at.tree, motion.velocities.points);
            let shifted = pair
                .points(at.tree)
                .map(|point| motion.velocities.shifted::<G>(at.frame(point), &velocities.points[point]));
            let closing = pair.closing(&change) * pair.closing(&velocity);
            sum +=
                k * (closing + pair.overlap * (pair.curvature(&change, &velocity) + pair.closing(&shifted)));
        }
        *work += sum;
    }
}

/// What is reported of contacts.
impl Contacts {
    /// Visits what presses on each other in one of them; with a margin also what rests on each other, at a gap
    /// below that, as if it were so deep.
    pub fn for_each_pressed<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
        state: &ContactState<P>,
        margin: f64,
        visit: &mut impl FnMut(Pressed<P>),
    ) {
        let mut press = |pair: &ContactPair<P>| {
            let stiffness = at.parameters()[self.0[index].stiffness] * pair.weight;
            let [p, a, b] = pair.points(at.tree);
            let second = at.frame(if pair.t < 0.5 { a } else { b });
            let depth = pair.overlap.max(margin);
            let inward = at.geometry.radii[pair.first] - 0.5 * pair.overlap;
            visit(Pressed {
                sphere: pair.first,
                other: at.tree.frames[second].body,
                frames: [at.frame(p), second],
                place: *at.point(p) - pair.normal * inward,
                force: pair.normal * (stiffness * depth),
                stiffness,
                depth,
            });
        };
        if margin > 0.0 {
            Self::for_each_near(at, &state.balls, &self.0[index], margin, |pair| press(&pair));
        } else {
            state.pairs.iter().filter(|(contact, _)| *contact == index).for_each(|(_, pair)| press(pair));
        }
    }

    /// Visits the changes of these, in the same order.
    pub fn for_each_pressed_change<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
        state: &ContactState<P>,
        direction: &Direction<D, P>,
        visit: &mut impl FnMut(PressedChange<P>),
    ) {
        let (contact, p) = (&self.0[index], at.parameters());
        for (_, pair) in state.pairs.iter().filter(|(contact, _)| *contact == index) {
            let [a, b] = pair.second;
            let radii = [pair.first, a, b].map(|sphere| match direction.parameter {
                Some(slot) => radius_slope(at.tree, p, at.tree.spheres[sphere].radius, slot),
                None => 0.0,
            });
            let weigh = |weights: [f64; 3]| weights.iter().zip(&radii).map(|(w, r)| w * r).sum::<f64>();
            let motion = pair.motion(at.tree, direction.velocities.points);
            let depth = pair.closing(&motion) + weigh(pair.by_radii());
            let along = pair.across * (weigh(pair.slide_by_radii()) * pair.slip / pair.distance);
            let normal = pair.turning(&motion) + along;
            let length = contact.lengths.get(pair.first - contact.first.start);
            let scaled = length.map_or(0.0, |length| direction.of(*length) / p[*length]);
            let k = p[contact.stiffness] * pair.weight;
            let stiffness = direction.of(contact.stiffness) * pair.weight + k * scaled;
            let inward = at.geometry.radii[pair.first] - 0.5 * pair.overlap;
            visit(PressedChange {
                place: motion[0] - normal * inward - pair.normal * (radii[0] - 0.5 * depth),
                force: pair.normal * (stiffness * pair.overlap + k * depth) + normal * (k * pair.overlap),
                stiffness,
                depth,
            });
        }
    }

    /// Visits the overlaps of all pairs.
    pub fn for_each_depth<const P: usize>(&self, state: &ContactState<P>, mut visit: impl FnMut(Depth<P>)) {
        for (_, pair) in &state.pairs {
            let [a, b] = pair.second;
            let (depth, t, normal) = (pair.overlap, pair.t, pair.normal);
            visit(Depth { depth, spheres: [pair.first, a, b], t, normal });
        }
    }

    /// Adds a multiple of the change of the force on the tip along a direction.
    pub fn add_tip_force<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
        state: &ContactState<P>,
        direction: &Vector<P>,
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        for (contact, k, pair) in self.tip_pairs(at.parameters(), state) {
            let along = weight * direction.dot(&pair.normal);
            let turned = weight * direction.dot(&pair.across) * pair.overlap * pair.slip / pair.distance;
            add_pair_parameters(at, contact, pair, k, [along, turned], &mut out.parameters);
            let [a, b] = pair.second;
            let changes = force_change(pair, k * weight, direction);
            out.add_points(at.tree, [pair.first, a, b], changes);
        }
    }
}

/// Slopes of the force k d n along a direction by the three points of a pair.
fn force_change<const P: usize>(pair: &ContactPair<P>, k: f64, direction: &Vector<P>) -> [Vector<P>; 3] {
    let mut changes = [Vector::ZERO; 3];
    for (i, change) in changes.iter_mut().enumerate() {
        for axis in 0..P {
            let mut motion = [Vector::ZERO; 3];
            motion[i] = Vector::unit(axis);
            let pressed = pair.normal * pair.closing(&motion) + pair.turning(&motion) * pair.overlap;
            change[axis] = k * direction.dot(&pressed);
        }
    }
    changes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Data;
    use crate::lie::SE2;
    use crate::model::{Model, SphereDescription, Station};
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
        let contacts = &model.forces.contacts.0;
        assert!(contacts.iter().all(|c| !c.balls.is_empty()));
        let mut data = Data::new(&model);
        let mut seen = [0, 0];
        for state in 0..20 {
            let wave = |i: usize| ((i + 1) as f64 * (1.1 + 0.23 * f64::from(state))).sin();
            let q: Vec<f64> = (0..model.dof()).map(|i| 0.6 * wave(i)).collect();
            data.evaluate(&model, &q, &[0.0]);
            let at = data.state(&model, &q, &[0.0]);
            let balls = &data.assembly.forces.contacts.balls;
            for (c, contact) in contacts.iter().enumerate() {
                let mut each = contact.clone();
                each.balls = 0..0;
                for margin in [0.0, 1e-3, 2e-2] {
                    let pairs = |contact| {
                        let mut pairs = vec![];
                        let visit = |p: ContactPair<2>| pairs.push((p.first, p.second[0], p.overlap));
                        Contacts::for_each_near(&at, balls, contact, margin, visit);
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
