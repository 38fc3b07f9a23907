//! Changes of contact along a straight motion of the coordinates: contacts that open and close, and springs
//! that become taut or slack.

use super::options::PredictorOptions;
use super::point_motion::PointMotion;
use super::system::System;
use crate::forces::element::Switch;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::Model;

/// A sphere that touches another body or may come to, or a spring that is taut or may become so.
#[derive(Clone, Debug)]
struct Pair<const P: usize> {
    /// The contact, with its overlap as it changes; negative while they are apart.
    switch: Switch<P>,
    /// Rate of the overlap.
    rate: f64,
    touching: bool,
    /// Whether it has changed already; a first-order prediction changes each pair once at most.
    changed: bool,
}

/// The pairs that may change, with a workspace that grows to the size that the model needs.
#[derive(Clone, Debug)]
pub(super) struct ContactChanges<const D: usize, const P: usize> {
    pairs: Vec<Pair<P>>,
    wrenches: Vec<Vector<D>>,
    motion: PointMotion<D, P>,
}

impl<const D: usize, const P: usize> ContactChanges<D, P> {
    pub fn new<G: LieGroup<D, P>>(model: &Model<G, D, P>) -> Self {
        Self {
            pairs: vec![],
            wrenches: vec![Vector::ZERO; model.frames.len()],
            motion: PointMotion::new(model),
        }
    }

    /// Starts at the equilibrium of `system` with a dimensionless velocity of its coordinates, and finds
    /// the pairs that may change within `h`.
    pub fn start<G: LieGroup<D, P>>(
        &mut self,
        system: &System<G, D, P>,
        velocity: &[f64],
        h: f64,
        options: &PredictorOptions,
    ) {
        self.motion.update(system, velocity);
        self.pairs.clear();
        let model = system.model();
        let data = system.data();
        let velocities = self.motion.velocities();
        let fastest = velocities.points.iter().map(|v| v.dot(v)).fold(0.0, f64::max).sqrt();
        // Pairs further apart do not meet at this speed; those accelerated by a change may be missed.
        let margin = fastest * h;
        let [rate_margin, speed_margin] = [options.closing_rate_margin, options.point_speed_margin];
        data.for_each_switch(model, system.state(), system.load(), margin, |switch| {
            if switch.stiffness.is_sign_negative() {
                // The sphere that two round cones share: one of them is enough.
                if self.pairs.last().is_some_and(|last| last.switch.points == switch.points) {
                    self.pairs.pop();
                }
                return;
            }
            let rate = switch.rate::<G, D>(&velocities);
            // Far apart and not approaching.
            if -switch.depth > (rate_margin * rate.max(0.0) + speed_margin * fastest) * h {
                return;
            }
            let touching = switch.depth > 0.0;
            self.pairs.push(Pair { switch, rate, touching, changed: false });
        });
    }

    /// The next pair that changes after `start` and up to `limit`, and when.
    pub fn next(&self, start: f64, limit: f64) -> Option<(f64, usize)> {
        let mut first = None;
        let mut nearest = limit - start;
        for (i, pair) in self.pairs.iter().enumerate() {
            let (way, speed) =
                if pair.touching { (pair.switch.depth, -pair.rate) } else { (-pair.switch.depth, pair.rate) };
            if speed > 0.0 && !pair.changed && way < nearest * speed {
                nearest = (way / speed).max(0.0);
                first = Some(i);
            }
        }
        first.map(|i| (start + nearest, i))
    }

    /// Lets the overlaps change over `h`.
    pub fn advance(&mut self, h: f64) {
        self.pairs.iter_mut().for_each(|p| p.switch.depth += h * p.rate);
    }

    /// Continues with another velocity of the coordinates.
    pub fn set_velocity<G: LieGroup<D, P>>(&mut self, system: &System<G, D, P>, velocity: &[f64]) {
        self.motion.update(system, velocity);
        for pair in &mut self.pairs {
            pair.rate = pair.switch.rate::<G, D>(&self.motion.velocities());
        }
    }

    /// Opens or closes a pair. Returns the stiffness that this adds to the tangent, negative where it
    /// opens, and leaves in `gradient` the dimensionless gradient of its overlap.
    pub fn switch<G: LieGroup<D, P>>(
        &mut self,
        system: &System<G, D, P>,
        pair: usize,
        gradient: &mut [f64],
    ) -> f64 {
        let (model, data) = (system.model(), system.data());
        let pair = &mut self.pairs[pair];
        let Switch { points, t, own, carrier, normal, stiffness, .. } = &pair.switch;
        let stiffness = if pair.touching { -stiffness } else { *stiffness };
        pair.touching = !pair.touching;
        pair.changed = true;
        self.wrenches.fill(Vector::ZERO);
        let mut push = |frame: usize, place: &Vector<P>, share: f64| {
            self.wrenches[frame] += G::point_jacobian(place).transpose_times(normal) * share;
        };
        let shares = [-1.0, 1.0 - t, *t];
        let moving = match (own, carrier) {
            (Some(_), _) => 0,
            (None, Some(_)) => 1,
            (None, None) => 3,
        };
        for (&point, share) in points.iter().zip(shares).take(moving) {
            push(data.design.geometry.frames[point], &data.kinematics.points[point], share);
        }
        if let Some((frame, place)) = carrier {
            push(*frame, place, 1.0);
            own.iter().for_each(|own| push(*own, place, -1.0));
        }
        gradient.fill(0.0);
        data.assembly.add_forces(model, &mut self.wrenches, gradient);
        gradient.iter_mut().zip(&data.design.units.scale).for_each(|(g, s)| *g *= s);
        stiffness
    }
}
