//! The interface between the engine and its forces.

use super::crossing::{Crossing, Motion};
use super::magnitudes::Magnitudes;
use super::state::State;
use super::terms::Terms;
use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tree::Tree;
use std::fmt::Debug;

/// Velocities of everything on the tree: under a virtual motion, or as a parameter changes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Velocities<'a, const D: usize, const P: usize> {
    /// World twist of each frame.
    pub twists: &'a [Vector<D>],
    /// Velocity of each point.
    pub points: &'a [Vector<P>],
}

impl<const D: usize, const P: usize> Velocities<'_, D, P> {
    /// How the velocity of a point under these twists, held fixed, changes as the point is displaced.
    #[inline]
    pub fn shifted<G: LieGroup<D, P>>(&self, frame: usize, displacement: &Vector<P>) -> Vector<P> {
        // A point's velocity under a fixed twist is affine in the point.
        (G::point_jacobian(displacement) - G::point_jacobian(&Vector::ZERO)) * self.twists[frame]
    }
}

/// A virtual motion λ of the coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VirtualMotion<'a, const D: usize, const P: usize> {
    pub coordinates: &'a [f64],
    pub velocities: Velocities<'a, D, P>,
}

/// A term `½ k d₊²` that switches on and off with the sign of d, linearised in the positions of the
/// points p, a and b: d changes at the rate −n·(ṗ − (1 − t) ȧ − t ḃ).
#[derive(Clone, Debug)]
pub(crate) struct Switch<const P: usize> {
    /// p, a, b.
    pub points: [usize; 3],
    pub t: f64,
    /// The frame that carries p, if p is no point of the tree but a place of this frame, given by `carrier`.
    pub own: Option<usize>,
    /// The frame that carries what p touches, and where p is, if that moves other than by a and b.
    pub carrier: Option<(usize, Vector<P>)>,
    pub normal: Vector<P>,
    /// d.
    pub depth: f64,
    /// k; negative if it subtracts what the two preceding switches count twice.
    pub stiffness: f64,
}

impl<const P: usize> Switch<P> {
    /// The rate of d for these velocities.
    #[inline]
    pub fn rate<G: LieGroup<D, P>, const D: usize>(&self, velocities: &Velocities<D, P>) -> f64 {
        let [p, a, b] = self.points.map(|i| velocities.points[i]);
        if let Some((frame, place)) = &self.carrier {
            let moved = |frame: usize| G::point_jacobian(place) * velocities.twists[frame];
            return -self.normal.dot(&(self.own.map_or(p, moved) - moved(*frame)));
        }
        -self.normal.dot(&(p - a * (1.0 - self.t) - b * self.t))
    }
}

/// One contact force.
#[derive(Clone, Debug)]
pub struct ContactForce<const P: usize> {
    /// The sphere of the first group.
    pub first: usize,
    /// The touched sphere, twice, or the spheres at the ends of the touched round cone; none for contact
    /// with an obstacle.
    pub second: Option<[usize; 2]>,
    /// The nearer of these.
    pub nearest: Option<usize>,
    /// The obstacle that it touches, if it is one.
    pub obstacle: Option<usize>,
    /// Whether it touches a round cone.
    pub cone: bool,
    /// Force on the first [N].
    pub force: Vector<P>,
    /// Overlap d [m].
    pub depth: f64,
    /// Largest pressure [Pa], on an elastic foundation.
    pub pressure: Option<f64>,
    /// Middle of the overlap [m].
    pub point: Vector<P>,
}

/// Memory of all forces of one kind.
pub(crate) trait ForceMemory<const P: usize> {
    /// Quantities that depend on the parameters only.
    type Design: Clone + Debug + Send;
    /// Results of the residual that the tangent and the derivatives use.
    type State: Clone + Debug + Send;
    /// Quantities shared by the derivatives of all outputs.
    type Sensitivity: Clone + Debug + Default + Send;
}

/// All forces of one kind in a model.
///
/// Residual, tangent, derivatives and switches of a force are defined here together; the registry in
/// `model/forces.rs` lists the kinds, and the rest of the engine uses forces through it only.
pub(crate) trait ForceElement<G: LieGroup<D, P>, const D: usize, const P: usize>:
    ForceMemory<P>
{
    /// Memory for one design.
    fn design(&self, tree: &Tree<G, D, P>) -> Self::Design;

    /// Memory for one state.
    fn state(&self, tree: &Tree<G, D, P>) -> Self::State;

    /// Computes the quantities that do not depend on the state.
    fn update_design(
        &self,
        _tree: &Tree<G, D, P>,
        _geometry: &Geometry<G, D, P>,
        _design: &mut Self::Design,
    ) {
    }

    /// Adds the diagonal elastic stiffness of each coordinate, which sets its scale.
    fn add_elastic_stiffness(
        &self,
        _tree: &Tree<G, D, P>,
        _geometry: &Geometry<G, D, P>,
        _design: &Self::Design,
        _stiffness: &mut [f64],
    ) {
    }

    /// Adds energy, where there is one, and residual.
    fn add_residual(
        &self,
        at: &State<G, D, P>,
        design: &Self::Design,
        state: &mut Self::State,
        out: &mut Terms<D>,
    );

    /// Adds the derivative of the residual at the state of the last residual.
    fn add_tangent(
        &self,
        at: &State<G, D, P>,
        design: &Self::Design,
        state: &Self::State,
        out: &mut Terms<D>,
    );

    /// Adds the magnitudes of its forces at the state of the last residual.
    fn add_magnitudes(
        &self,
        at: &State<G, D, P>,
        design: &Self::Design,
        state: &Self::State,
        out: &mut Magnitudes<P>,
    );

    /// Adds the derivative of the residual along a change of load; `project` adds Jᵀw of a frame whose
    /// Jacobian is kept.
    fn add_load_derivative(
        &self,
        _at: &State<G, D, P>,
        _design: &Self::Design,
        _change: &[f64],
        _out: &mut [f64],
        _project: &impl Fn(usize, &Vector<D>, &mut [f64]),
    ) {
    }

    /// Whether the force has a potential.
    fn is_conservative(&self) -> bool {
        true
    }

    /// Whether its parameters are physically meaningful.
    fn is_admissible(&self, _parameters: &[f64]) -> bool {
        true
    }

    /// Largest number of couplings between frames, or of terms without a potential, in one tangent.
    fn max_couplings(&self) -> usize {
        0
    }

    /// Whether it has terms that switch on and off.
    fn has_switches(&self) -> bool {
        false
    }

    /// Number of those that are on at the state of the last residual.
    fn switched_on(&self, _at: &State<G, D, P>, _state: &Self::State) -> usize {
        0
    }

    /// Visits the terms that are on, or within `margin` of switching on.
    fn for_each_switch(
        &self,
        _at: &State<G, D, P>,
        _state: &Self::State,
        _margin: f64,
        _visit: &mut impl FnMut(Switch<P>),
    ) {
    }

    /// Whether bodies meet others by it.
    fn has_solids(&self) -> bool {
        false
    }

    /// Smallest thickness of a solid and what meets it; zero where solids turn of themselves, so that the
    /// ways of points do not tell how the bodies move relative to each other.
    fn thinnest(&self, _at: &State<G, D, P>) -> f64 {
        f64::INFINITY
    }

    /// Whether a motion in which bodies turn by less than half a turn may lead one through another.
    fn may_cross(&self, _motion: &Motion<G, D, P>) -> bool {
        self.has_solids()
    }

    /// Visits what a motion leads through.
    fn for_each_crossing(&self, _motion: &Motion<G, D, P>, _visit: &mut impl FnMut(Crossing)) {}

    /// Visits the parameters of the stiffnesses of springs and contacts, with their multipliers.
    fn for_each_stiffness(&self, _parameters: &[f64], _visit: &mut impl FnMut(usize, f64)) {}

    /// Stores the forces that stiff terms have after a motion of the points, with distances to first
    /// order, for [`Law::Kept`](super::state::Law).
    fn keep(&self, _at: &State<G, D, P>, _motion: &Velocities<D, P>, _state: &mut Self::State) {}

    /// Whether the state is where the residual has one-sided derivatives only, for a motion of some of
    /// the points along a direction that `moves` confirms.
    fn at_threshold(&self, _at: &State<G, D, P>, _moves: &impl Fn(&[usize], &Vector<P>) -> bool) -> bool {
        false
    }

    /// Appends the contact forces, from what the residual left and the poses: coordinates and load are
    /// not given.
    fn contact_forces(&self, _at: &State<G, D, P>, _state: &Self::State, _out: &mut Vec<ContactForce<P>>) {}

    /// Computes the quantities shared by all outputs; `wanted`: the parameters by which they are differentiated.
    fn update_sensitivity(
        &self,
        _at: &State<G, D, P>,
        _design: &Self::Design,
        _state: &Self::State,
        _wanted: &[bool],
        _sensitivity: &mut Self::Sensitivity,
    ) {
    }

    /// Adds λᵀ∂g/∂p, with frames and points held, to every parameter that the force depends on.
    #[allow(clippy::too_many_arguments)]
    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        design: &Self::Design,
        state: &Self::State,
        sensitivity: &Self::Sensitivity,
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    );

    /// Adds the change of the virtual work as frames and points move with a parameter at `velocities`,
    /// the twists of the virtual motion held.
    fn add_geometric_work(
        &self,
        _at: &State<G, D, P>,
        _design: &Self::Design,
        _state: &Self::State,
        _motion: &VirtualMotion<D, P>,
        _velocities: &Velocities<D, P>,
        _work: &mut f64,
    ) {
    }
}
