//! Bodies and joints.

use super::super::description::{
    BodyDescription, JointDescription, JointKind, LinkDescription, ShapeDescription,
};
use super::super::{
    Body, Frame, JointColumn, JointCoordinate, JointLimits, Link, ModelError, Motion, Shape, Tree, finite,
    not_negative, positive,
};
use crate::lie::LieGroup;
use crate::linalg::{LANES, Vector};
use crate::strain::Mode;
use crate::tolerances::{MAX_PLACEMENT_ROTATION, UNIT_NORM};

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Tree<G, D, P> {
    pub(super) fn add_body(&mut self, body: &BodyDescription) -> Result<(), ModelError> {
        let name = &body.name;
        let field = |f: &str| format!("{name}.{f}");
        if self.bodies.iter().any(|b| b.name == *name) {
            return Err(ModelError::new(name, "two bodies have this name"));
        }
        let parent = match &body.parent {
            None => 0,
            Some(parent) => {
                let found = self.bodies.iter().find(|b| b.name == *parent);
                found
                    .ok_or_else(|| {
                        ModelError::new(field("parent"), format!("no earlier body is named `{parent}`"))
                    })?
                    .tip_frame
            }
        };
        let placement = &body.placement;
        finite(field("placement.translation"), &placement.translation)?;
        finite(field("placement.rotation"), &placement.rotation)?;
        if let Some(angle) = placement.rotation.iter().find(|angle| angle.abs() > MAX_PLACEMENT_ROTATION) {
            let problem =
                format!("found {angle:e} rad, must be at most {MAX_PLACEMENT_ROTATION:e} rad either way");
            return Err(ModelError::new(field("placement.rotation"), problem));
        }
        if G::from_spatial(&placement.translation, &placement.rotation).is_none() {
            return Err(ModelError::new(field("placement"), "leaves the x–z plane of a planar system"));
        }
        let translation = self.slot(field("translation"), "m", &placement.translation);
        let rotation = self.slot(field("rotation"), "rad", &placement.rotation);
        let index = self.bodies.len();
        let rigid = 2 * index;
        let placed = self.push_frame(parent, index, Motion::Rigid(rigid), format!("{name}.placement"));
        let base_frame = self.add_joint(name, &body.joint, placed, index)?;
        let (tip_frame, shape) = match &body.shape {
            ShapeDescription::Rod(rod) => {
                let tip = self.add_rod(name, rod, base_frame, index)?;
                (tip, Shape::Rod(self.rods.len() - 1))
            }
            ShapeDescription::Link(link) => {
                let link = self.link(name, link, rigid + 1)?;
                let tip = self.push_frame(base_frame, index, Motion::Rigid(rigid + 1), format!("{name}.tip"));
                (tip, Shape::Link(link))
            }
        };
        let name = name.clone();
        self.bodies.push(Body {
            name,
            placement: rigid,
            translation,
            rotation,
            base_frame,
            tip_frame,
            shape,
        });
        Ok(())
    }

    /// Appends a frame; coordinates of its own motion must already be counted in `self.dof`.
    pub(super) fn push_frame(&mut self, parent: usize, body: usize, motion: Motion, name: String) -> usize {
        let mut path = self.frames[parent].path.clone();
        let own: Vec<usize> = match &motion {
            Motion::Rigid(_) => vec![],
            Motion::Joint(columns) => self.joint_columns[columns.clone()].iter().map(|c| c.dof).collect(),
            Motion::Strain(step) => {
                self.strain_columns[self.steps[*step].columns.clone()].iter().map(|c| c.dof).collect()
            }
        };
        for dof in &own {
            path = if path.is_empty() { *dof..dof + 1 } else { path.start.min(*dof)..path.end.max(dof + 1) };
        }
        let last = &self.frames[self.frames.len() - 1];
        let (column, block) = (last.columns.end, last.blocks.end);
        let columns = column..column + own.len();
        let blocks = block..block + own.len().div_ceil(LANES);
        self.frames.push(Frame {
            parent,
            body,
            motion,
            path,
            columns,
            blocks,
            coordinates: 0..0,
            run_end: 0,
        });
        self.column_dofs.extend(own);
        self.frame_names.push(name);
        self.frames.len() - 1
    }

    /// Marks runs of frames, each the child of the one before, that share all their coordinates.
    pub(super) fn find_runs(&mut self) {
        let dofs = |f: usize| match &self.frames[f].motion {
            Motion::Strain(_) => &self.column_dofs[self.frames[f].columns.clone()],
            Motion::Rigid(_) | Motion::Joint(_) => &[],
        };
        let follows = |f: usize| f + 1 < self.frames.len() && self.frames[f + 1].parent == f;
        let same: Vec<bool> = (0..self.frames.len())
            .map(|f| follows(f) && !dofs(f).is_empty() && dofs(f) == dofs(f + 1))
            .collect();
        for f in (0..self.frames.len()).rev() {
            self.frames[f].run_end = if same[f] { self.frames[f + 1].run_end } else { f + 1 };
        }
        for f in 1..self.frames.len() {
            self.frames[f].coordinates = if same[f - 1] {
                self.frames[f - 1].coordinates.clone()
            } else {
                self.coordinate_blocks.push(&self.column_dofs[self.frames[f].columns.clone()])
            };
        }
    }

    fn add_joint(
        &mut self,
        name: &str,
        joint: &JointDescription,
        parent: usize,
        body: usize,
    ) -> Result<usize, ModelError> {
        let field = |f: &str| format!("{name}.joint.{f}");
        let planar =
            |kind: &str| ModelError::new(field("kind"), format!("a planar system has no {kind} joint"));
        let unit = |mode: Mode| G::axis(mode).map(Vector::<D>::unit);
        // Each group of twists is one exponential: one frame.
        let groups: Vec<Vec<(Vector<D>, &str, bool)>> = match joint.kind {
            JointKind::Fixed => vec![],
            JointKind::Revolute | JointKind::Prismatic => {
                let angular = joint.kind == JointKind::Revolute;
                vec![vec![(
                    self.axis_twist(&field("axis"), joint.axis, angular)?,
                    if angular { "theta" } else { "d" },
                    angular,
                )]]
            }
            JointKind::Universal => {
                let y = unit(Mode::BendY).ok_or_else(|| planar("universal"))?;
                let z = unit(Mode::BendZ).ok_or_else(|| planar("universal"))?;
                vec![vec![(y, "theta_y", true)], vec![(z, "theta_z", true)]]
            }
            JointKind::Spherical => {
                let axes = [(Mode::TwistX, "theta_x"), (Mode::BendY, "theta_y"), (Mode::BendZ, "theta_z")];
                let twists = axes.map(|(mode, n)| unit(mode).map(|t| (t, n, true)));
                vec![twists.into_iter().collect::<Option<Vec<_>>>().ok_or_else(|| planar("spherical"))?]
            }
            JointKind::Free => {
                let names = ["theta_x", "theta_y", "theta_z", "x", "y", "z"];
                let twist =
                    |m: Mode| (Vector::<D>::unit(G::axis(m).unwrap_or(0)), names[m.index()], m.is_angular());
                let (turns, moves): (Vec<Mode>, Vec<Mode>) =
                    G::AXES.into_iter().partition(|mode| mode.is_angular());
                [turns, moves].map(|modes| modes.into_iter().map(twist).collect()).into()
            }
        };
        // A free body is moved before it is turned, so that it may be anywhere after any turn.
        let moves_first = joint.kind == JointKind::Free;
        let count: usize = groups.iter().map(Vec::len).sum();
        let lengths = [
            ("stiffness", joint.stiffness.len()),
            ("rest", joint.rest.len()),
            ("lower", joint.lower.len()),
            ("upper", joint.upper.len()),
        ];
        for (what, found) in lengths {
            if found != 0 && found != count {
                return Err(ModelError::new(
                    field(what),
                    format!("found {found} values, the joint has {count} coordinates"),
                ));
            }
        }
        finite(field("rest"), &joint.rest)?;
        let mut stiffness = joint.stiffness.clone();
        stiffness.resize(count, 0.0);
        for k in &stiffness {
            not_negative(field("stiffness"), *k)?;
        }
        let limited = joint.lower.iter().chain(&joint.upper).any(Option::is_some);
        let (unit, of_stiffness) = match joint.kind {
            JointKind::Free => (None, None),
            JointKind::Prismatic => (Some("m"), Some("N/m")),
            _ => (Some("rad"), Some("N*m/rad")),
        };
        let mut rest = joint.rest.clone();
        rest.resize(count, 0.0);
        let stiffness = self.slot(format!("{name}.joint_stiffness"), of_stiffness, &stiffness).start;
        let rest = self.slot(format!("{name}.joint_rest"), unit, &rest).start;
        let limits = if limited { Some(self.joint_limits(name, joint, [unit, of_stiffness])?) } else { None };

        let mut k = 0;
        let mut motions = vec![];
        for group in groups {
            let start = self.joint_columns.len();
            for (twist, label, angular) in group {
                let dof = self.dof;
                self.dof += 1;
                self.coordinates.push(format!("{name}.{label}"));
                self.joint_columns.push(JointColumn { dof, twist });
                self.joints.push(JointCoordinate {
                    dof,
                    angular,
                    stiffness: stiffness + k,
                    rest: rest + k,
                    limits: limits.as_ref().and_then(|limits| limits[k]),
                });
                k += 1;
            }
            motions.push(Motion::Joint(start..self.joint_columns.len()));
        }
        if moves_first {
            motions.reverse();
        }
        let push = |frame, motion| self.push_frame(frame, body, motion, format!("{name}.joint"));
        Ok(motions.into_iter().fold(parent, push))
    }

    /// The limits of each coordinate of a joint that has some, given the units of a limit and of its stiffness.
    fn joint_limits(
        &mut self,
        name: &str,
        joint: &JointDescription,
        [unit, of_stiffness]: [Option<&'static str>; 2],
    ) -> Result<Vec<Option<JointLimits>>, ModelError> {
        let field = |f: &str| format!("{name}.joint.{f}");
        let stiffness = positive(field("limit_stiffness"), joint.limit_stiffness)?;
        let width = positive(field("limit_width"), joint.limit_width)?;
        let stiffness = self.slot(format!("{name}.limit_stiffness"), of_stiffness, &[stiffness]).start;
        let width = self.slot(format!("{name}.limit_width"), unit, &[width]).start;
        let bounds = [("lower", &joint.lower), ("upper", &joint.upper)];
        let [lower, upper] = bounds.map(|(end, values)| {
            let given: Vec<f64> = values.iter().copied().flatten().collect();
            let mut slots = self.slot(format!("{name}.joint_{end}"), unit, &given);
            let of_each: Vec<_> = values.iter().map(|value| value.and_then(|_| slots.next())).collect();
            of_each
        });
        let mut found = vec![];
        for k in 0..joint.lower.len().max(joint.upper.len()) {
            let [lower, upper] = [&lower, &upper].map(|slots| slots.get(k).copied().flatten());
            let [low, high] = [lower, upper].map(|slot| slot.map(|slot| self.parameters[slot]));
            finite(field("limits"), &[low.unwrap_or(0.0), high.unwrap_or(0.0)])?;
            if low.zip(high).is_some_and(|(low, high)| low >= high) {
                return Err(ModelError::new(field("lower"), "the lower limit is not below the upper one"));
            }
            let any = lower.or(upper).is_some();
            found.push(any.then_some(JointLimits { lower, upper, stiffness, width }));
        }
        Ok(found)
    }

    /// The twist of a unit rotation about, or translation along, `axis`.
    fn axis_twist(&self, field: &str, axis: [f64; 3], angular: bool) -> Result<Vector<D>, ModelError> {
        finite(field, &axis)?;
        let norm = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
        if (norm - 1.0).abs() > UNIT_NORM {
            return Err(ModelError::new(
                field,
                format!("found {axis:?} of norm {norm}, must be a unit vector"),
            ));
        }
        let mut twist = Vector::ZERO;
        for (i, mode) in Mode::ALL.into_iter().enumerate() {
            let component = if mode.is_angular() == angular { axis[i % 3] } else { 0.0 };
            match G::axis(mode) {
                Some(a) => twist[a] = component,
                None if component != 0.0 => {
                    return Err(ModelError::new(
                        field,
                        format!("found {axis:?}, a planar system moves in x–z and turns about y"),
                    ));
                }
                None => {}
            }
        }
        Ok(twist)
    }

    fn link(&mut self, name: &str, link: &LinkDescription, tip: usize) -> Result<Link, ModelError> {
        let field = |f: &str| format!("{name}.{f}");
        let length = positive(field("length"), link.length)?;
        let radius_base = positive(field("radius_base"), link.radius_base)?;
        let radius_tip = positive(field("radius_tip"), link.radius_tip)?;
        let density = not_negative(field("density"), link.density)?;
        let mut one = |f: &str, unit: &'static str, value: f64| self.slot(field(f), unit, &[value]).start;
        Ok(Link {
            tip,
            length: one("length", "m", length),
            radius_base: one("radius_base", "m", radius_base),
            radius_tip: one("radius_tip", "m", radius_tip),
            density: one("density", "kg/m^3", density),
        })
    }
}
