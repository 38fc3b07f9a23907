//! What must hold of every system in every state: its mirror image behaves alike, a residual is the
//! same with its tangent or without, and a descent never climbs.

use crate::trees::{
    SECTIONS, basis, planar_tree, planar_trees, spatial_tree, spatial_trees, with_round_cones,
};
use flexor_engine::Data;
use flexor_engine::equilibrium::{
    Continuation, ContinuationOptions, Event, PathSink, Status, StepReport, System,
};
use flexor_engine::lie::{LieGroup, SE2, SE3};
use flexor_engine::model::*;
use proptest::prelude::*;

/// A mirror through the origin: −1 for the axis that is turned over.
#[derive(Clone, Copy, Debug)]
struct Mirror([f64; 3]);

impl Mirror {
    /// Of places, forces, linear strains.
    fn polar(self, v: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| self.0[i] * v[i])
    }

    /// Of rotations, moments, curvatures, which a mirror turns the other way.
    fn axial(self, v: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| -self.0[i] * v[i])
    }

    fn offset(self, v: [f64; 2]) -> [f64; 2] {
        [self.0[1] * v[0], self.0[2] * v[1]]
    }

    fn attachment(self, at: &mut AttachmentDescription) {
        match at {
            AttachmentDescription::World { world } => *world = self.polar(*world),
            AttachmentDescription::Body { offset, surface, .. } => {
                (*offset, *surface) = (self.polar(*offset), self.polar(*surface));
            }
        }
    }

    /// The sign of a coordinate, from its name such as `arm.bend_y[3]`.
    fn sign(self, coordinate: &str) -> f64 {
        let name = coordinate.rsplit('.').next().unwrap().split('[').next().unwrap();
        if name == "theta" || name == "d" {
            return 1.0; // the axis is mirrored instead
        }
        let axis = "xyz".find(name.chars().last().unwrap()).unwrap();
        let axial = ["theta_", "twist_", "bend_"].iter().any(|kind| name.starts_with(kind));
        if axial { -self.0[axis] } else { self.0[axis] }
    }

    /// The mirror image of a system.
    fn image(self, d: &Description) -> Description {
        let mut d = d.clone();
        d.gravity = self.polar(d.gravity);
        for body in &mut d.bodies {
            body.placement.translation = self.polar(body.placement.translation);
            body.placement.rotation = self.axial(body.placement.rotation);
            let joint = &mut body.joint;
            match joint.kind {
                JointKind::Revolute => joint.axis = self.axial(joint.axis),
                JointKind::Prismatic => joint.axis = self.polar(joint.axis),
                _ => {
                    let names: &[&str] = match joint.kind {
                        JointKind::Universal => &["theta_y", "theta_z"],
                        JointKind::Spherical => &["theta_x", "theta_y", "theta_z"],
                        JointKind::Free if d.planar => &["theta_y", "x", "z"],
                        JointKind::Free => &["theta_x", "theta_y", "theta_z", "x", "y", "z"],
                        _ => &[],
                    };
                    for (k, _) in names.iter().enumerate().filter(|(_, name)| self.sign(name) < 0.0) {
                        if let Some(rest) = joint.rest.get_mut(k) {
                            *rest = -*rest;
                        }
                        if let (Some(low), Some(high)) = (joint.lower.get_mut(k), joint.upper.get_mut(k)) {
                            (*low, *high) = (high.map(|x| -x), low.map(|x| -x));
                        }
                    }
                }
            }
            if let ShapeDescription::Rod(rod) = &mut body.shape {
                let [a, b, c, x, y, z] = rod.reference_strain;
                let ([a, b, c], [x, y, z]) = (self.axial([a, b, c]), self.polar([x, y, z]));
                rod.reference_strain = [a, b, c, x, y, z];
            }
        }
        for actuator in &mut d.actuators {
            actuator.path.iter_mut().for_each(|v| *v = self.offset(*v));
            actuator.path_slope.iter_mut().for_each(|v| *v = self.offset(*v));
            actuator.lever = self.offset(actuator.lever);
        }
        for spring in &mut d.springs {
            self.attachment(&mut spring.first);
            self.attachment(&mut spring.second);
        }
        for wrench in &mut d.wrenches {
            self.attachment(&mut wrench.at);
            wrench.force = self.polar(wrench.force);
            wrench.moment = self.axial(wrench.moment);
        }
        d
    }
}

/// Energy, residual, tangent and frames of the image in the mirrored state are the mirrored ones.
fn check_mirror<G: LieGroup<D, P>, const D: usize, const P: usize>(
    description: &Description,
    mirror: Mirror,
    state: &[f64],
    load: &[f64],
) -> Result<(), TestCaseError> {
    let model = Model::<G, D, P>::new(description).unwrap();
    let image = Model::<G, D, P>::new(&mirror.image(description)).unwrap();
    let n = model.dof();
    let load = &load[..model.inputs().len()];
    let signs: Vec<f64> = model.coordinates().iter().map(|name| mirror.sign(name)).collect();
    let q: Vec<f64> = (0..n).map(|i| 0.25 * state[i % state.len()]).collect();
    let mirrored: Vec<f64> = q.iter().zip(&signs).map(|(q, s)| s * q).collect();
    let (mut one, mut other) = (Data::new(&model), Data::new(&image));
    one.evaluate(&model, &q, load);
    other.evaluate(&image, &mirrored, load);
    let near = |a: f64, b: f64, size: f64| (a - b).abs() <= 1e-10 * (1.0 + size);
    let size = |v: &[f64]| v.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    prop_assert!(near(one.energy(), other.energy(), one.energy().abs()));
    for i in 0..n {
        let (a, b) = (one.residual()[i], signs[i] * other.residual()[i]);
        prop_assert!(near(a, b, size(one.residual())), "residual {i}: {a} {b}");
        for j in 0..n {
            let (a, b) = (one.tangent()[i * n + j], signs[i] * signs[j] * other.tangent()[i * n + j]);
            prop_assert!(near(a, b, size(one.tangent())), "tangent {i}, {j}: {a} {b}");
        }
    }
    for (a, b) in one.homogeneous_frames().iter().zip(other.homogeneous_frames()) {
        let place = mirror.polar([a[0][3], a[1][3], a[2][3]]);
        prop_assert!((0..3).all(|i| near(place[i], b[i][3], 1.0)), "{place:?} {b:?}");
    }
    prop_assert_eq!(one.contact_summary(&model).pairs, other.contact_summary(&image).pairs);
    Ok(())
}

/// A residual does not depend on what was evaluated before it and leaves the tangent alone; the
/// tangent that follows it is that of its state.
fn check_parts<G: LieGroup<D, P>, const D: usize, const P: usize>(
    description: &Description,
    state: &[f64],
    load: &[f64],
) -> Result<(), TestCaseError> {
    let model = Model::<G, D, P>::new(description).unwrap();
    let load = &load[..model.inputs().len()];
    let scaled =
        |size: f64| -> Vec<f64> { (0..model.dof()).map(|i| size * state[i % state.len()]).collect() };
    let (first, second) = (scaled(0.5), scaled(-0.3));
    let (mut parts, mut whole) = (Data::new(&model), Data::new(&model));
    parts.evaluate(&model, &first, load);
    let before = parts.tangent().to_vec();
    parts.evaluate_residual(&model, &second, load);
    whole.evaluate(&model, &second, load);
    prop_assert_eq!(parts.energy(), whole.energy());
    prop_assert_eq!(parts.residual(), whole.residual());
    prop_assert_eq!(parts.tangent(), &before[..]);
    parts.evaluate_tangent(&model, &second, load);
    prop_assert_eq!(parts.tangent(), whole.tangent());
    Ok(())
}

/// Where one step of a path ended, and the residual then.
#[derive(Default)]
struct End {
    status: Option<Status>,
    q: Vec<f64>,
    residual: Vec<f64>,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> PathSink<G, D, P> for End {
    fn step(&mut self, _: usize, report: StepReport, system: &System<G, D, P>) {
        self.status = Some(report.status);
        self.q = report.q.to_vec();
        self.residual = system.data().residual().to_vec();
    }
    fn event(&mut self, _: Event) {}
}

/// A descent that is cut after one iteration, after two and so on never shows a higher energy. Where stiff
/// terms are softened first, it never shows a higher one than that of the start.
fn check_descent<G: LieGroup<D, P>, const D: usize, const P: usize>(
    description: &Description,
    state: &[f64],
    load: &[f64],
) -> Result<(), TestCaseError> {
    let model = Model::<G, D, P>::new(description).unwrap();
    let load = &load[..model.inputs().len()];
    let start: Vec<f64> = (0..model.dof()).map(|i| state[i % state.len()]).collect();
    let mut data = Data::new(&model);
    let mut at = |q: &[f64]| {
        data.evaluate(&model, q, load);
        (data.energy(), data.residual().to_vec())
    };
    let (first, _) = at(&start);
    let mut never_stiff = ContinuationOptions::default();
    never_stiff.mixed.stiffness = 1e300;
    for (options, monotonic) in [(never_stiff, true), (ContinuationOptions::default(), false)] {
        let mut energy = first;
        for max_iterations in 1..=40 {
            let options = ContinuationOptions { max_iterations, ..options };
            let mut path = Continuation::new(&model, options, None);
            let mut end = End::default();
            path.follow(&[load], &start, &mut end);
            let (now, residual) = at(&end.q);
            prop_assert_eq!(residual, end.residual, "the system has the residual of another state");
            // Close to the minimum the energy is lost in rounding.
            let noise = 1e-11 * (1.0 + first.abs() + energy.abs());
            let before = if monotonic { energy } else { first };
            prop_assert!(now <= before + noise, "iteration {max_iterations}: {before} to {now}");
            energy = now;
            match end.status {
                Some(Status::IterationLimit) => {}
                Some(Status::Converged) => break,
                other => prop_assert!(false, "ended {other:?}"),
            }
        }
        prop_assert!(energy < first, "from {first} to {energy}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn mirror_image_in_space(
        state in prop::collection::vec(-1.0..1.0f64, 97),
        tree in spatial_trees(),
        mirror in prop::sample::select(vec![Mirror([1.0, -1.0, 1.0]), Mirror([1.0, 1.0, -1.0])]),
        load in prop::collection::vec(-1.0..2.0f64, 5),
    ) {
        check_mirror::<SE3, 6, 3>(&tree, mirror, &state, &load)?;
    }

    #[test]
    fn mirror_image_in_the_plane(
        state in prop::collection::vec(-1.0..1.0f64, 53),
        tree in planar_trees(),
        load in prop::collection::vec(-1.0..2.0f64, 5),
    ) {
        check_mirror::<SE2, 3, 2>(&tree, Mirror([1.0, 1.0, -1.0]), &state, &load)?;
    }

    #[test]
    fn residual_and_tangent_in_space(
        state in prop::collection::vec(-1.0..1.0f64, 97),
        tree in spatial_trees(),
        load in prop::collection::vec(-1.0..2.0f64, 5),
    ) {
        check_parts::<SE3, 6, 3>(&tree, &state, &load)?;
    }

    #[test]
    fn residual_and_tangent_in_the_plane(
        state in prop::collection::vec(-1.0..1.0f64, 53),
        tree in planar_trees(),
        load in prop::collection::vec(-1.0..2.0f64, 5),
    ) {
        check_parts::<SE2, 3, 2>(&tree, &state, &load)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn descent_in_space(
        state in prop::collection::vec(-0.6..0.6f64, 97),
        bases in prop::array::uniform6(basis()),
        section in prop::sample::select(SECTIONS.to_vec()),
        cones: bool,
        load in prop::collection::vec(-0.2..0.2f64, 5),
    ) {
        let tree = spatial_tree(bases, section, 4, false);
        let tree = if cones { with_round_cones(tree) } else { tree };
        check_descent::<SE3, 6, 3>(&tree, &state, &load)?;
    }

    #[test]
    fn descent_in_the_plane(
        state in prop::collection::vec(-1.0..1.0f64, 53),
        bases in prop::array::uniform3(basis()),
        section in prop::sample::select(SECTIONS.to_vec()),
        cones: bool,
        load in prop::collection::vec(-0.2..0.2f64, 5),
    ) {
        let tree = planar_tree(bases, section, 4, false);
        let tree = if cones { with_round_cones(tree) } else { tree };
        check_descent::<SE2, 3, 2>(&tree, &state, &load)?;
    }
}
