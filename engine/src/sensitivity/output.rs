//! Numbers that an equilibrium gives and that can be differentiated.

use crate::data::Data;
use crate::forces::differential::{Depth, Differential, Largest, is_tied};
use crate::forces::tie::TieOutput;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::model::Model;

/// What an equilibrium gives. Of the largest of several numbers the derivative is that of the one that is
/// largest, as long as no other equals it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Output {
    /// A coordinate of a joint.
    Joint(usize),
    /// The force of contact on the tip; zero while nothing touches it.
    TipForce,
    /// The largest overlap of contacts.
    Overlap,
    /// How deep the centreline of a rod is at most in what it touches.
    Centreline,
    /// The largest pressure on elastic foundations.
    Pressure,
    /// The least or greatest stretch of the fibres of a material.
    Stretch(usize, f64),
    /// The tension of a spring.
    Spring(usize),
    /// The length of a tendon.
    TendonLength(usize),
    /// The tension of a tendon.
    TendonTension(usize),
    /// The tension of a strap around a link.
    Loop(usize),
    /// The force on an obstacle.
    Obstacle(usize),
    /// The volume of a cavity.
    Volume(usize),
    /// The angle between both ends of a rod.
    RodBending(usize),
    /// What a tie gives.
    Tie(usize, TieOutput),
    /// The load that an input has.
    Applied(usize),
}

/// Names of groups of outputs with the number of each, in their order.
pub fn output_groups<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
) -> [(&'static str, usize); 15] {
    [
        ("joints", model.joints.len()),
        ("tip_force", 1),
        ("max_overlap", 1),
        ("max_centreline_depth", 1),
        ("max_contact_pressure", 1),
        ("stretch", 2 * model.material_count()),
        ("springs", model.forces.springs.count()),
        ("loops", model.forces.loops.count()),
        ("obstacles", model.forces.obstacles.count()),
        ("volume", model.pressure_count()),
        ("rod_bending", model.rod_count()),
        ("ties", TieOutput::ALL.len() * model.tie_count()),
        ("tendon_lengths", model.tendon_count()),
        ("tendon_tensions", model.tendon_count()),
        ("applied", model.inputs().len()),
    ]
}

impl Output {
    /// All outputs, in the order of [`output_groups`].
    pub fn all<G: LieGroup<D, P>, const D: usize, const P: usize>(model: &Model<G, D, P>) -> Vec<Self> {
        let of = |group: usize, index: usize| match group {
            0 => Self::Joint(index),
            1 => Self::TipForce,
            2 => Self::Overlap,
            3 => Self::Centreline,
            4 => Self::Pressure,
            5 => Self::Stretch(index / 2, if index % 2 == 0 { -1.0 } else { 1.0 }),
            6 => Self::Spring(index),
            7 => Self::Loop(index),
            8 => Self::Obstacle(index),
            9 => Self::Volume(index),
            10 => Self::RodBending(index),
            11 => {
                let each = TieOutput::ALL;
                Self::Tie(index / each.len(), each[index % each.len()])
            }
            12 => Self::TendonLength(index),
            13 => Self::TendonTension(index),
            _ => Self::Applied(index),
        };
        let groups = output_groups(model);
        groups.iter().enumerate().flat_map(|(g, (_, count))| (0..*count).map(move |i| of(g, i))).collect()
    }

    /// Adds a multiple of its change at the state evaluated last, the loads held.
    pub fn add<G: LieGroup<D, P>, const D: usize, const P: usize>(
        self,
        model: &Model<G, D, P>,
        data: &Data<G, D, P>,
        [q, load]: [&[f64]; 2],
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        let (at, states) = (data.state(model, q, load), &data.assembly.forces);
        let forces = &model.forces;
        match self {
            Self::Joint(joint) => out.coordinates[model.joints[joint].dof] += weight,
            Self::TipForce => {
                let Some(direction) = data.tip_direction(model) else { return };
                forces.contacts.add_tip_force(&at, &states.contacts, &direction, weight, out);
                forces.foundations.add_tip_force(&at, &states.foundations, &direction, weight, out);
            }
            Self::Overlap => {
                let largest = deepest(model, data, |depth| Some(depth.depth));
                if let Some(depth) = largest.place {
                    out.tied |= largest.tied;
                    depth.add(&model.tree, at.parameters(), weight, out);
                }
            }
            Self::Centreline => {
                let radii = &data.design.geometry.radii;
                let largest = deepest(model, data, |Depth { depth, spheres: [sphere, ..], .. }| {
                    model.spheres[*sphere].is_on_rod().then(|| depth - radii[*sphere])
                });
                if let Some(depth) = largest.place {
                    out.tied |= largest.tied;
                    depth.add(&model.tree, at.parameters(), weight, out);
                    out.add_radius(&model.tree, at.parameters(), depth.spheres[0], -weight);
                }
            }
            Self::Pressure => {
                let [bodies, obstacles] = [
                    forces.foundations.largest_pressure(&at),
                    forces.obstacles.largest_pressure(&states.obstacles),
                ];
                out.tied |= is_tied(bodies, obstacles);
                if bodies >= obstacles {
                    forces.foundations.add_pressure(&at, weight, out);
                } else {
                    forces.obstacles.add_pressure(&at, &states.obstacles, weight, out);
                }
            }
            Self::Stretch(material, sign) => forces.fibres.add_stretch(material, sign, &at, weight, out),
            Self::Spring(spring) => forces.springs.add_tension(spring, &at, weight, out),
            Self::TendonLength(tendon) => forces.tendons.add_length(tendon, &at, weight, out),
            Self::TendonTension(tendon) => forces.tendons.add_tension(tendon, &at, weight, out),
            Self::Loop(strap) => forces.loops.add_tension(strap, &at, &states.loops, weight, out),
            Self::Obstacle(index) => {
                forces.obstacles.add_force(index, &at, &states.obstacles, weight, out);
            }
            Self::Volume(index) => {
                forces.pressures.add_volume(index, &at, &data.design.forces.pressures, weight, out);
            }
            Self::RodBending(rod) => {
                let (frames, axis) = data.rod_axis(model, rod);
                out.tied |= axis == Vector::ZERO;
                for (frame, sign) in frames.into_iter().zip([-weight, weight]) {
                    out.frames.push((frame, axis * sign));
                }
            }
            Self::Tie(tie, output) => forces.ties.add_output(tie, output, at.load, weight, out),
            // With the state only if it is found; see `HeldConjugates`.
            Self::Applied(_) => {}
        }
    }
}

/// The largest of numbers that some contacts have, with its contact.
fn deepest<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    data: &Data<G, D, P>,
    number: impl Fn(&Depth<P>) -> Option<f64>,
) -> Largest<Depth<P>> {
    let mut largest = Largest::new();
    let mut offer = |depth: Depth<P>| {
        if let Some(value) = number(&depth) {
            largest.offer(value, depth, |other| other.is_same(&depth));
        }
    };
    model.forces.contacts.for_each_depth(&data.assembly.forces.contacts, &mut offer);
    model.forces.foundations.for_each_depth(&data.state(model, &[], &[]), &mut offer);
    largest
}
