//! Point loads: forces and moments, fixed in the world or following their body.
//!
//! A dead force has the potential −f·p. The other loads have the generalised force −Jᵀw, too, but their
//! tangent has an antisymmetric part ∓½ Jᵀ M(w) J, so that they have no potential.

use super::element::{ForceElement, ForceMemory, Velocities, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::state::State;
use super::terms::Terms;
use crate::geometry::{add_spatial, spatial};
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::strain::Mode;
use crate::tree::description::AttachmentDescription;
use crate::tree::{ModelError, Tree, finite};
use serde::Deserialize;

/// The frame in which the direction of a point load is constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WrenchFrame {
    /// Fixed in the world.
    World,
    /// Follows the body.
    Body,
}

/// A force and a moment at a point.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WrenchDescription {
    /// Unique name.
    pub name: String,
    /// Where it acts.
    pub at: AttachmentDescription,
    /// Force [N].
    pub force: [f64; 3],
    /// Moment [N·m].
    pub moment: [f64; 3],
    /// Fixed in the world or following the body.
    pub frame: WrenchFrame,
    /// Whether it is scaled by a load input, of its name unless it shares one.
    #[serde(default)]
    pub input: bool,
    /// Whether it may have a moment though it has none here.
    #[serde(default)]
    pub turns: bool,
}

/// A force and moment at a point.
#[derive(Clone, Debug, PartialEq)]
struct Wrench {
    point: usize,
    frame: usize,
    /// The first of three parameters each.
    force: usize,
    moment: usize,
    /// Whether it may have a moment.
    turns: bool,
    follower: bool,
    /// Load input that scales it.
    input: Option<usize>,
}

/// All point loads.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Wrenches(Vec<Wrench>);

impl Wrenches {
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        wrenches: &[WrenchDescription],
    ) -> Result<Self, ModelError> {
        let mut built = vec![];
        for wrench in wrenches {
            let field = |f: &str| format!("wrenches.{}.{f}", wrench.name);
            finite(field("force"), &wrench.force)?;
            finite(field("moment"), &wrench.moment)?;
            let point = tree.attach(&field("at"), &wrench.at)?;
            G::point_from_spatial(&wrench.force)
                .ok_or_else(|| ModelError::new(field("force"), "leaves the x–z plane of a planar system"))?;
            if P == 2 && (wrench.moment[0] != 0.0 || wrench.moment[2] != 0.0) {
                return Err(ModelError::new(field("moment"), "a planar system turns about y only"));
            }
            let input = wrench.input.then(|| tree.input(&wrench.name));
            let frame = tree.points[point].frame;
            tree.keep_jacobian(frame);
            let follower = wrench.frame == WrenchFrame::Body;
            let mut slot = |what: &str, unit: &'static str, values: &[f64; 3]| {
                tree.slot(format!("{}.{what}", wrench.name), unit, values).start
            };
            let force = slot("force", "N", &wrench.force);
            let moment = slot("moment", "N*m", &wrench.moment);
            let turns = wrench.turns || wrench.moment != [0.0; 3];
            built.push(Wrench { point, frame, force, moment, turns, follower, input });
        }
        Ok(Self(built))
    }

    /// The parameters of the loads that have no potential.
    pub fn without_potential<const P: usize>(&self) -> impl Iterator<Item = usize> {
        let without = self.0.iter().filter(|wrench| !wrench.is_conservative::<P>());
        without.flat_map(|wrench| {
            let force = wrench.force..wrench.force + if wrench.follower { 3 } else { 0 };
            force.chain(wrench.moment..wrench.moment + 3)
        })
    }
}

impl Wrench {
    /// A dead force has a potential; followers have none, and a dead moment only in the plane.
    fn is_conservative<const P: usize>(&self) -> bool {
        !self.follower && (P == 2 || !self.turns)
    }

    /// The multiple of the load.
    fn magnitude(&self, load: &[f64]) -> f64 {
        self.input.map_or(1.0, |i| load[i])
    }

    /// Its force per unit of load.
    fn force<G: LieGroup<D, P>, const D: usize, const P: usize>(&self, p: &[f64]) -> Vector<P> {
        spatial::<G, D, P>(p, self.force)
    }

    /// Its moment per unit of load, as a wrench.
    fn moment<G: LieGroup<D, P>, const D: usize, const P: usize>(&self, p: &[f64]) -> Vector<D> {
        let mut w = Vector::ZERO;
        for (axis, mode) in rotations::<G, D, P>() {
            w[axis] = p[self.moment + mode];
        }
        w
    }

    /// World wrench per unit of load; the sign convention is that of an applied load.
    fn world_wrench<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
    ) -> Vector<D> {
        let p = at.parameters();
        let (force, moment) = (self.force::<G, D, P>(p), self.moment::<G, D, P>(p));
        if !self.follower {
            return G::point_jacobian(at.point(self.point)).transpose_times(&force) + moment;
        }
        let local = &at.geometry.points[self.point];
        let body = G::point_jacobian(local).transpose_times(&force) + moment;
        at.kinematics.pose[self.frame].inverse().adjoint().transpose_times(&body)
    }

    /// The part of the wrench whose tangent has an antisymmetric half, and the sign of that half.
    fn circulatory<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
    ) -> (Vector<D>, f64) {
        if self.follower {
            (self.world_wrench(at), -0.5)
        } else {
            (self.moment::<G, D, P>(at.parameters()), 0.5)
        }
    }
}

impl<const P: usize> ForceMemory<P> for Wrenches {
    type Design = ();
    type State = ();
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Wrenches {
    fn design(&self, _: &Tree<G, D, P>) {}

    fn state(&self, _: &Tree<G, D, P>) {}

    fn is_conservative(&self) -> bool {
        self.0.iter().all(Wrench::is_conservative::<P>)
    }

    fn max_couplings(&self) -> usize {
        self.0.len()
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        _: &(),
        _: &mut (),
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        for wrench in &self.0 {
            let size = wrench.magnitude(at.load);
            let p = at.point(wrench.point);
            if wrench.follower {
                out.wrench[wrench.frame] -= wrench.world_wrench(at) * size;
                out.loaded[wrench.frame] = true;
            } else {
                let force = wrench.force::<G, D, P>(at.parameters()) * size;
                out.energy -= force.dot(p);
                out.add_force::<G, P>(wrench.frame, p, &-force);
                out.wrench[wrench.frame] -= wrench.moment::<G, D, P>(at.parameters()) * size;
                let about_y = at.parameters()[wrench.moment + 1];
                if P == 2 && about_y != 0.0 {
                    out.energy -= size * about_y * at.kinematics.planar_angle(at.tree, wrench.frame);
                }
            }
        }
    }

    fn add_tangent(&self, at: &State<G, D, P>, _: &(), _: &(), Terms { frames: out, .. }: &mut Terms<D>) {
        for wrench in &self.0 {
            let size = wrench.magnitude(at.load);
            if !wrench.follower {
                let force = wrench.force::<G, D, P>(at.parameters());
                out.add_curvature::<G, P>(wrench.frame, at.point(wrench.point), &(force * -size));
            }
            if !wrench.is_conservative::<P>() {
                let (w, sign) = wrench.circulatory(at);
                out.circulatory.push((wrench.frame, G::bracket_form(&w) * (sign * size)));
            }
        }
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, _: &(), _: &(), out: &mut Magnitudes<P>) {
        for wrench in &self.0 {
            let (size, p) = (wrench.magnitude(at.load), at.parameters());
            out.add_at_point(at, wrench.point, size * wrench.force::<G, D, P>(p).norm());
            out.add_moment(wrench.frame, size * wrench.moment::<G, D, P>(p).norm());
        }
    }

    fn add_load_derivative(
        &self,
        at: &State<G, D, P>,
        _: &(),
        change: &[f64],
        out: &mut [f64],
        project: &impl Fn(usize, &Vector<D>, &mut [f64]),
    ) {
        for wrench in &self.0 {
            let Some(input) = wrench.input else { continue };
            project(wrench.frame, &(wrench.world_wrench(at) * -change[input]), out);
        }
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        _: &(),
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        for wrench in &self.0 {
            let size = wrench.magnitude(at.load);
            let Velocities { twists, points } = motion.velocities;
            let (mut velocity, mut twist) = (points[wrench.point], twists[wrench.frame]);
            if wrench.follower {
                let back = at.kinematics.pose[wrench.frame].inverse();
                (velocity, twist) = (back.rotate(&velocity), back.adjoint() * twist);
            }
            add_spatial::<G, D, P>(gradient, wrench.force, &(velocity * -size));
            for (axis, mode) in rotations::<G, D, P>() {
                gradient[wrench.moment + mode] -= size * twist[axis];
            }
        }
    }

    fn add_geometric_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        _: &(),
        motion: &VirtualMotion<D, P>,
        velocities: &Velocities<D, P>,
        work: &mut f64,
    ) {
        let VirtualMotion { velocities: virtual_motion, .. } = motion;
        for wrench in &self.0 {
            let (size, frame) = (wrench.magnitude(at.load), wrench.frame);
            let velocity = &velocities.points[wrench.point];
            if wrench.follower {
                // The wrench is carried along with its frame; its point may slide along the body.
                let twist = &velocities.twists[frame];
                let carried = G::bracket(twist, &virtual_motion.twists[frame]);
                let slide = *velocity - G::point_jacobian(at.point(wrench.point)) * *twist;
                let force = at.kinematics.pose[frame].rotate(&wrench.force::<G, D, P>(at.parameters()));
                *work += size
                    * (wrench.world_wrench(at).dot(&carried)
                        - force.dot(&virtual_motion.shifted::<G>(frame, &slide)));
            } else {
                let force = wrench.force::<G, D, P>(at.parameters());
                *work -= size * force.dot(&virtual_motion.shifted::<G>(frame, velocity));
            }
        }
    }
}

/// The rotations that the group has: the axis of each, and which of the three in space it is.
fn rotations<G: LieGroup<D, P>, const D: usize, const P: usize>() -> impl Iterator<Item = (usize, usize)> {
    let modes = [Mode::TwistX, Mode::BendY, Mode::BendZ];
    modes.into_iter().filter_map(|mode| Some((G::axis(mode)?, mode.index())))
}
