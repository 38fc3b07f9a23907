//! The structure of a built model by name, to interpret its arrays.

use super::{Description, JointKind, Model};
use crate::lie::LieGroup;
use crate::strain::Mode;
use crate::tree::Motion;
use std::ops::Range;

/// A coordinate of a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct JointStructure {
    /// Name of the coordinate, such as `ph_1.theta`.
    pub name: String,
    /// The body that the joint carries.
    pub body: String,
    /// Kind of the joint.
    pub kind: JointKind,
    /// Index among the coordinates.
    pub coordinate: usize,
    /// Axis of the rotation or translation in the joint's frame.
    pub axis: [f64; 3],
    /// Whether it is an angle [rad]; otherwise a length [m].
    pub angular: bool,
}

/// Joints, frames, spheres and parameters of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Structure {
    /// All joint coordinates, in order.
    pub joints: Vec<JointStructure>,
    /// Frames along each body, base to tip: the sample points of a rod, both ends of a link.
    pub body_frames: Vec<(String, Range<usize>)>,
    /// Spheres of each group.
    pub sphere_groups: Vec<(String, Range<usize>)>,
    /// Units of the parameter slots; `None` where the entries of a slot differ in theirs.
    pub slot_units: Vec<(String, Option<&'static str>)>,
}

impl Structure {
    /// The structure of a model, given the description that it was built from.
    pub fn new<G: LieGroup<D, P>, const D: usize, const P: usize>(
        model: &Model<G, D, P>,
        description: &Description,
    ) -> Self {
        let bodies = model.bodies.iter().map(|b| (b.name.clone(), b.base_frame..b.tip_frame + 1));
        let mut end = 0;
        let groups = description.spheres.iter().map(|group| {
            let start = end;
            end += group.spheres.len();
            (group.name.clone(), start..end)
        });
        Self {
            sphere_groups: groups.collect(),
            body_frames: bodies.collect(),
            joints: joints(model, description),
            slot_units: model.layout.units().map(|(name, unit)| (name.into(), unit)).collect(),
        }
    }
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Model<G, D, P> {
    /// Whether two models differ only in the values of their parameters.
    pub fn has_structure_of(&self, other: &Self) -> bool {
        let mut same_parameters = self.clone();
        same_parameters.tree.parameters.clone_from(&other.tree.parameters);
        same_parameters == *other
    }
}

fn joints<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    description: &Description,
) -> Vec<JointStructure> {
    let mut found = vec![];
    for frame in &model.frames {
        let Motion::Joint(columns) = &frame.motion else { continue };
        let body = &description.bodies[frame.body];
        for column in &model.joint_columns[columns.clone()] {
            let mut axis = [0.0; 3];
            let mut angular = false;
            for (i, mode) in Mode::ALL.into_iter().enumerate() {
                let component = G::axis(mode).map_or(0.0, |a| column.twist[a]);
                axis[i % 3] += component;
                angular |= component != 0.0 && mode.is_angular();
            }
            found.push(JointStructure {
                name: model.coordinates[column.dof].clone(),
                body: body.name.clone(),
                kind: body.joint.kind,
                coordinate: column.dof,
                axis,
                angular,
            });
        }
    }
    found.sort_by_key(|joint| joint.coordinate);
    found
}

impl JointKind {
    /// Its name in descriptions.
    pub fn name(self) -> &'static str {
        match self {
            JointKind::Fixed => "fixed",
            JointKind::Revolute => "revolute",
            JointKind::Prismatic => "prismatic",
            JointKind::Universal => "universal",
            JointKind::Spherical => "spherical",
            JointKind::Free => "free",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lie::{SE2, SE3};
    use crate::strain::BasisKind;
    use crate::systems::finger;
    use crate::tree::description::ShapeDescription;
    use crate::trees::{SECTIONS, spatial_tree};

    #[test]
    fn a_finger_has_three_hinges() {
        let description = finger();
        let model = Model::<SE2, 3, 2>::new(&description).unwrap();
        let structure = Structure::new(&model, &description);
        let names: Vec<&str> = structure.joints.iter().map(|j| j.name.as_str()).collect();
        assert_eq!(names, ["ph_1.theta", "ph_2.theta", "ph_3.theta"]);
        for joint in &structure.joints {
            assert_eq!((joint.kind, joint.angular), (JointKind::Revolute, true));
            assert_eq!(joint.axis, [0.0, 1.0, 0.0]);
            assert_eq!(model.coordinates()[joint.coordinate], joint.name);
        }
        let spheres = structure.sphere_groups.last().map(|(_, range)| range.end);
        assert_eq!(spheres, Some(model.sphere_count()));
    }

    #[test]
    fn models_that_differ_in_parameters_have_the_same_structure() {
        let description = finger();
        let build = |d: &Description| Model::<SE2, 3, 2>::new(d).unwrap();
        let model = build(&description);
        let mut other = description.clone();
        other.contacts[0].stiffness *= 2.0;
        other.bodies[0].placement.translation[0] += 0.01;
        assert!(build(&other).has_structure_of(&model));
        other.gravity[2] = -9.81;
        let heavy = build(&other);
        assert!(!heavy.has_structure_of(&model));
        other.gravity[2] = 0.0;
        other.weighs = true;
        assert!(build(&other).has_structure_of(&heavy));
        let mut other = description.clone();
        other.bodies[1].joint.rest = vec![0.1];
        assert!(build(&other).has_structure_of(&model));
        other.bodies[1].joint.upper = vec![Some(1.0)];
        let limited = build(&other);
        assert!(!limited.has_structure_of(&model));
        other.bodies[1].joint.upper = vec![Some(0.5)];
        assert!(build(&other).has_structure_of(&limited));
    }

    #[test]
    fn every_part_of_a_tree_is_found() {
        let description = spatial_tree([BasisKind::NodalLinear; 6], SECTIONS[0], 2, false);
        let model = Model::<SE3, 6, 3>::new(&description).unwrap();
        let structure = Structure::new(&model, &description);
        assert_eq!(structure.joints.len(), model.joints.len());
        for (joint, built) in structure.joints.iter().zip(&model.joints) {
            assert_eq!((joint.coordinate, joint.angular), (built.dof, built.angular));
            let length: f64 = joint.axis.iter().map(|a| a * a).sum();
            assert!((length - 1.0).abs() < 1e-12, "{joint:?}");
        }
        for ((name, frames), body) in structure.body_frames.iter().zip(&description.bodies) {
            assert_eq!(name, &body.name);
            for frame in frames.clone() {
                let owner = model.frame_names()[frame].split(['.', '[']).next();
                assert_eq!(owner, Some(name.as_str()));
            }
        }
        let unknown = structure.slot_units.iter().filter(|(_, unit)| unit.is_none());
        for (slot, _) in unknown {
            let (owner, what) = slot.rsplit_once('.').unwrap();
            // Their units are those of the joints.
            let couplings = description.joint_couplings.iter().map(|coupling| &coupling.name);
            if description.joint_torques.iter().map(|t| &t.name).chain(couplings).any(|name| name == owner) {
                continue;
            }
            let body = description.bodies.iter().find(|b| b.name == owner);
            let body = body.unwrap_or_else(|| panic!("{slot}"));
            let rod = matches!(body.shape, ShapeDescription::Rod(_));
            let free = body.joint.kind == JointKind::Free;
            let of_joint = what.starts_with("joint_") || what.starts_with("limit_");
            assert!(what == "reference_strain" && rod || of_joint && free, "{slot}");
        }
    }
}
