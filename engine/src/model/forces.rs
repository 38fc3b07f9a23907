//! The registry: the forces of a model, one line each.

use super::description::Description;
use crate::forces::actuator::Actuators;
use crate::forces::contact::Contacts;
use crate::forces::crossing::{Crossing, Motion};
use crate::forces::elasticity::Elasticity;
use crate::forces::element::{ContactForce, ForceElement, ForceMemory, Switch, Velocities, VirtualMotion};
use crate::forces::fibres::FibreSections;
use crate::forces::foundation::{Foundations, StrapLoops};
use crate::forces::friction::{Direction, Frictions, PressedChange, Source};
use crate::forces::gravity::Gravity;
use crate::forces::joint::Joints;
use crate::forces::joint_coupling::JointCouplings;
use crate::forces::joint_torque::JointTorques;
use crate::forces::magnitudes::Magnitudes;
use crate::forces::obstacle::Obstacles;
use crate::forces::pressure::Pressures;
use crate::forces::spring::Springs;
use crate::forces::state::State;
use crate::forces::tendon::Tendons;
use crate::forces::terms::Terms;
use crate::forces::tie::Ties;
use crate::forces::wrench::Wrenches;
use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tree::{ModelError, Tree};

/// Each line: a name, the force element and how it is built from a description. Forces are built, and
/// their contributions summed, in this order.
macro_rules! registry {
    ($($name:ident: $force:ty = |$tree:pat_param, $description:pat_param| $build:expr;)*) => {
        /// The forces of a model.
        #[derive(Clone, Debug, PartialEq)]
        pub(crate) struct Forces<const P: usize> {
            $(pub $name: $force,)*
        }

        /// Quantities that the forces derive from the parameters.
        #[derive(Clone, Debug)]
        pub(crate) struct Designs<const P: usize> {
            $(pub $name: <$force as ForceMemory<P>>::Design,)*
        }

        /// Intermediate results of the residuals that tangents and derivatives reuse.
        #[derive(Clone, Debug)]
        pub(crate) struct States<const P: usize> {
            $(pub $name: <$force as ForceMemory<P>>::State,)*
        }

        /// Quantities that the derivatives of all outputs have in common.
        #[derive(Clone, Debug)]
        pub(crate) struct Sensitivities<const P: usize> {
            $($name: <$force as ForceMemory<P>>::Sensitivity,)*
        }

        impl<const P: usize> Default for Sensitivities<P> {
            fn default() -> Self {
                Self { $($name: Default::default(),)* }
            }
        }

        impl<const P: usize> Forces<P> {
            pub fn build<G: LieGroup<D, P>, const D: usize>(
                tree: &mut Tree<G, D, P>,
                description: &Description,
            ) -> Result<Self, ModelError> {
                $(let $name = {
                    let ($tree, $description) = (&mut *tree, description);
                    $build
                };)*
                Ok(Self { $($name,)* })
            }

            pub fn designs<G: LieGroup<D, P>, const D: usize>(&self, tree: &Tree<G, D, P>) -> Designs<P> {
                Designs { $($name: self.$name.design(tree),)* }
            }

            pub fn states<G: LieGroup<D, P>, const D: usize>(&self, tree: &Tree<G, D, P>) -> States<P> {
                States { $($name: self.$name.state(tree),)* }
            }

            pub fn update_designs<G: LieGroup<D, P>, const D: usize>(
                &self,
                tree: &Tree<G, D, P>,
                geometry: &Geometry<G, D, P>,
                designs: &mut Designs<P>,
            ) {
                $(self.$name.update_design(tree, geometry, &mut designs.$name);)*
            }

            pub fn add_elastic_stiffness<G: LieGroup<D, P>, const D: usize>(
                &self,
                tree: &Tree<G, D, P>,
                geometry: &Geometry<G, D, P>,
                designs: &Designs<P>,
                out: &mut [f64],
            ) {
                $(self.$name.add_elastic_stiffness(tree, geometry, &designs.$name, out);)*
            }

            #[inline]
            pub fn add_residual<G: LieGroup<D, P>, const D: usize>(
                &self,
                at: &State<G, D, P>,
                designs: &Designs<P>,
                states: &mut States<P>,
                out: &mut Terms<D>,
            ) {
                $(self.$name.add_residual(at, &designs.$name, &mut states.$name, out);)*
            }

            #[inline]
            pub fn add_tangent<G: LieGroup<D, P>, const D: usize>(
                &self,
                at: &State<G, D, P>,
                designs: &Designs<P>,
                states: &States<P>,
                out: &mut Terms<D>,
            ) {
                $(self.$name.add_tangent(at, &designs.$name, &states.$name, out);)*
            }

            pub fn add_magnitudes<G: LieGroup<D, P>, const D: usize>(
                &self,
                at: &State<G, D, P>,
                designs: &Designs<P>,
                states: &States<P>,
                out: &mut Magnitudes<P>,
            ) {
                $(self.$name.add_magnitudes(at, &designs.$name, &states.$name, out);)*
            }

            pub fn add_load_derivative<G: LieGroup<D, P>, const D: usize>(
                &self,
                at: &State<G, D, P>,
                designs: &Designs<P>,
                change: &[f64],
                out: &mut [f64],
                project: &impl Fn(usize, &Vector<D>, &mut [f64]),
            ) {
                $(self.$name.add_load_derivative(at, &designs.$name, change, out, project);)*
            }

            pub fn is_conservative<G: LieGroup<D, P>, const D: usize>(&self) -> bool {
                true $(&& ForceElement::<G, D, P>::is_conservative(&self.$name))*
            }

            pub fn are_admissible<G: LieGroup<D, P>, const D: usize>(&self, parameters: &[f64]) -> bool {
                true $(&& ForceElement::<G, D, P>::is_admissible(&self.$name, parameters))*
            }

            pub fn max_couplings<G: LieGroup<D, P>, const D: usize>(&self) -> usize {
                0 $(+ ForceElement::<G, D, P>::max_couplings(&self.$name))*
            }

            pub fn have_switches<G: LieGroup<D, P>, const D: usize>(&self) -> bool {
                false $(|| ForceElement::<G, D, P>::has_switches(&self.$name))*
            }

            pub fn switched_on<G: LieGroup<D, P>, const D: usize>(
                &self,
                at: &State<G, D, P>,
                states: &States<P>,
            ) -> usize {
                0 $(+ ForceElement::<G, D, P>::switched_on(&self.$name, at, &states.$name))*
            }

            pub fn for_each_switch<G: LieGroup<D, P>, const D: usize>(
                &self,
                at: &State<G, D, P>,
                states: &States<P>,
                margin: f64,
                visit: &mut impl FnMut(Switch<P>),
            ) {
                $(self.$name.for_each_switch(at, &states.$name, margin, visit);)*
            }

            pub fn have_solids<G: LieGroup<D, P>, const D: usize>(&self) -> bool {
                false $(|| ForceElement::<G, D, P>::has_solids(&self.$name))*
            }

            pub fn thinnest<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>) -> f64 {
                [$(ForceElement::<G, D, P>::thinnest(&self.$name, at)),*].into_iter().fold(f64::INFINITY, f64::min)
            }

            pub fn may_cross<G: LieGroup<D, P>, const D: usize>(&self, motion: &Motion<G, D, P>) -> bool {
                false $(|| self.$name.may_cross(motion))*
            }

            pub fn for_each_crossing<G: LieGroup<D, P>, const D: usize>(
                &self,
                motion: &Motion<G, D, P>,
                visit: &mut impl FnMut(Crossing),
            ) {
                $(self.$name.for_each_crossing(motion, visit);)*
            }

            pub fn for_each_stiffness<G: LieGroup<D, P>, const D: usize>(
                &self,
                parameters: &[f64],
                visit: &mut impl FnMut(usize, f64),
            ) {
                $(ForceElement::<G, D, P>::for_each_stiffness(&self.$name, parameters, visit);)*
            }

            pub fn keep<G: LieGroup<D, P>, const D: usize>(
                &self,
                at: &State<G, D, P>,
                motion: &Velocities<D, P>,
                states: &mut States<P>,
            ) {
                $(self.$name.keep(at, motion, &mut states.$name);)*
            }

            pub fn are_at_threshold<G: LieGroup<D, P>, const D: usize>(
                &self,
                at: &State<G, D, P>,
                moves: &impl Fn(&[usize], &Vector<P>) -> bool,
            ) -> bool {
                false $(|| self.$name.at_threshold(at, moves))*
            }

            pub fn contact_forces<G: LieGroup<D, P>, const D: usize>(
                &self,
                at: &State<G, D, P>,
                states: &States<P>,
            ) -> Vec<ContactForce<P>> {
                let mut forces = vec![];
                $(self.$name.contact_forces(at, &states.$name, &mut forces);)*
                forces
            }

            pub fn update_sensitivities<G: LieGroup<D, P>, const D: usize>(
                &self,
                at: &State<G, D, P>,
                (designs, states): (&Designs<P>, &States<P>),
                wanted: &[bool],
                sensitivities: &mut Sensitivities<P>,
            ) {
                $(self.$name.update_sensitivity(at, &designs.$name, &states.$name, wanted, &mut sensitivities.$name);)*
            }

            pub fn add_parameter_work<G: LieGroup<D, P>, const D: usize>(
                &self,
                at: &State<G, D, P>,
                (designs, states): (&Designs<P>, &States<P>),
                sensitivities: &Sensitivities<P>,
                motion: &VirtualMotion<D, P>,
                gradient: &mut [f64],
            ) {
                $(self.$name.add_parameter_work(
                    at, &designs.$name, &states.$name, &sensitivities.$name, motion, gradient,
                );)*
            }

            pub fn geometric_work<G: LieGroup<D, P>, const D: usize>(
                &self,
                at: &State<G, D, P>,
                (designs, states): (&Designs<P>, &States<P>),
                motion: &VirtualMotion<D, P>,
                velocities: &Velocities<D, P>,
            ) -> f64 {
                let mut work = 0.0;
                $(self.$name.add_geometric_work(
                    at, &designs.$name, &states.$name, motion, velocities, &mut work,
                );)*
                work
            }
        }
    };
}

registry! {
    elasticity: Elasticity = |_, _| Elasticity;
    joints: Joints = |_, _| Joints;
    joint_torques: JointTorques = |tree, description| JointTorques::build(tree, &description.joint_torques)?;
    joint_couplings: JointCouplings = |tree, description| {
        JointCouplings::build(tree, &description.joint_couplings)?
    };
    fibres: FibreSections = |tree, description| {
        FibreSections::build(tree, &description.materials, &description.fibres)?
    };
    actuators: Actuators = |tree, description| Actuators::build(tree, &description.actuators)?;
    pressures: Pressures = |tree, description| Pressures::build(tree, &description.pressures)?;
    gravity: Gravity = |tree, description| Gravity::build(tree, &description.gravity, description.weighs)?;
    springs: Springs = |tree, description| Springs::build(tree, &description.springs)?;
    contacts: Contacts = |tree, description| Contacts::build(tree, &description.contacts)?;
    foundations: Foundations = |tree, description| Foundations::build(tree, &description.foundations)?;
    loops: StrapLoops = |tree, description| StrapLoops::build(tree, &description.loops)?;
    obstacles: Obstacles<P> = |tree, description| Obstacles::build(tree, &description.obstacles)?;
    tendons: Tendons<P> = |tree, description| {
        Tendons::build(tree, &description.tendons, &description.wraps)?
    };
    wrenches: Wrenches = |tree, description| Wrenches::build(tree, &description.wrenches)?;
    ties: Ties<P> = |tree, description| Ties::build(tree, &description.ties)?;
    frictions: Frictions = |tree, description| Frictions::build(tree, description)?;
}

impl<const P: usize> Forces<P> {
    /// Renews what friction holds in a step, from what the residual left; with a margin also where bodies rest on
    /// each other, at a gap below that, except through skins, whose stiffness vanishes as they open.
    pub fn renew_friction<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        states: &mut States<P>,
        margin: f64,
    ) {
        let States { frictions: memory, contacts, foundations, obstacles, .. } = states;
        self.frictions.renew(at, memory, |visit| {
            for (friction, source) in self.frictions.sources().enumerate() {
                let mut visit = |pressed| visit(friction, pressed);
                match source {
                    Source::Contact(i) => self.contacts.for_each_pressed(i, at, contacts, margin, &mut visit),
                    Source::Foundation(i) => {
                        self.foundations.for_each_pressed(i, at, foundations, &mut visit)
                    }
                    Source::Obstacle(i) => {
                        self.obstacles.for_each_pressed(i, at, obstacles, margin, &mut visit);
                    }
                }
            }
        });
    }

    /// How what presses on points with friction changes in a direction, in the state in which it was renewed.
    pub fn pressed_changes<G: LieGroup<D, P>, const D: usize>(
        &self,
        at: &State<G, D, P>,
        states: &States<P>,
        direction: &Direction<D, P>,
        out: &mut Vec<PressedChange<P>>,
    ) {
        let States { frictions: memory, contacts, foundations, obstacles, .. } = states;
        Frictions::merge_changes(memory, out, |mut visit| {
            for source in self.frictions.sources() {
                match source {
                    Source::Contact(i) => {
                        self.contacts.for_each_pressed_change(i, at, contacts, direction, &mut visit);
                    }
                    Source::Foundation(i) => {
                        self.foundations.for_each_pressed_change(i, at, foundations, direction, &mut visit);
                    }
                    Source::Obstacle(i) => {
                        self.obstacles.for_each_pressed_change(i, at, obstacles, direction, &mut visit);
                    }
                }
            }
        });
    }
}
