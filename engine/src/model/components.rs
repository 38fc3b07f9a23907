//! Groups of bodies that interact, directly or through others.

use super::description::{AttachmentDescription, Description, SpringDescription, StageDescription};
use crate::tree::Tree;

/// Coordinates in groups that do not interact.
///
/// Trees of bodies, joined where contacts, springs, tendons and ties connect them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Components {
    /// The component of each coordinate.
    pub of_coordinate: Vec<usize>,
    /// The component of each body.
    pub of_body: Vec<usize>,
    pub count: usize,
}

impl Components {
    pub fn of<G, const D: usize, const P: usize>(tree: &Tree<G, D, P>, d: &Description) -> Self {
        let index = |name: &str| d.bodies.iter().position(|body| body.name == name);
        let mut root: Vec<usize> = (0..d.bodies.len()).collect();
        let mut join = |names: &mut dyn Iterator<Item = &str>| {
            let mut bodies = names.filter_map(index);
            let Some(first) = bodies.next() else { return };
            for other in bodies {
                let (to, from) = (root[first], root[other]);
                root.iter_mut().filter(|r| **r == from).for_each(|r| *r = to);
            }
        };
        for body in &d.bodies {
            join(&mut [Some(&body.name), body.parent.as_ref()].into_iter().flatten().map(String::as_str));
        }
        for SpringDescription { first, second, .. } in &d.springs {
            join(&mut [first, second].into_iter().filter_map(body_of));
        }
        for tendon in &d.tendons {
            let stages = tendon.path.iter().filter_map(|stage| match stage {
                StageDescription::Point(at) => Some(at),
                StageDescription::Wrap { name, .. } => {
                    d.wraps.iter().find(|wrap| wrap.name == *name).map(|wrap| &wrap.at)
                }
                StageDescription::Branch(_) => None,
            });
            join(&mut stages.filter_map(body_of));
        }
        for coupling in &d.joint_couplings {
            join(&mut coupling.bodies.iter().map(String::as_str));
        }
        for tie in &d.ties {
            join(&mut [&tie.first, &tie.second].into_iter().filter_map(body_of));
        }
        let contacts = d.contacts.iter().map(|contact| [&contact.first, &contact.second]);
        let foundations = d.foundations.iter().map(|f| [&f.first, &f.second]);
        let loops = d.loops.iter().map(|strap| [&strap.spheres; 2]);
        for groups in contacts.chain(foundations).chain(loops) {
            let touching = d.spheres.iter().filter(|group| groups.contains(&&group.name));
            join(&mut touching.flat_map(|group| &group.spheres).map(|sphere| sphere.body.as_str()));
        }
        for obstacle in &d.obstacles {
            let touching = d.spheres.iter().filter(|group| obstacle.spheres.contains(&group.name));
            let spheres = touching.flat_map(|group| &group.spheres).map(|sphere| sphere.body.as_str());
            if let AttachmentDescription::Body { body, .. } = &obstacle.at {
                join(&mut spheres.chain([body.as_str()]));
            }
        }
        let mut roots = root.clone();
        roots.sort_unstable();
        roots.dedup();
        let of_body: Vec<usize> = root.iter().map(|r| roots.partition_point(|other| other < r)).collect();
        let mut of_coordinate = vec![0; tree.dof];
        for frame in &tree.frames {
            for dof in &tree.column_dofs[frame.columns.clone()] {
                of_coordinate[*dof] = of_body[frame.body];
            }
        }
        Self { of_coordinate, of_body, count: roots.len() }
    }
}

/// The body that an attachment is on.
fn body_of(end: &AttachmentDescription) -> Option<&str> {
    match end {
        AttachmentDescription::World { .. } => None,
        AttachmentDescription::Body { body, .. } => Some(body),
    }
}
