//! Elastic foundations: closed forms by hand, continuity, and derivatives against differences.

use crate::systems::differences::{derivatives, of_output};
use crate::systems::{body, empty, joint, rod, strain};
use flexor_engine::equilibrium::{ContinuationOptions, Status};
use flexor_engine::lie::{LieGroup, SE2, SE3};
use flexor_engine::model::*;
use flexor_engine::strain::{BasisKind, Mode};
use flexor_engine::{Batch, ContactForce, Data};

fn link(length: f64, radius_base: f64, radius_tip: f64) -> ShapeDescription {
    ShapeDescription::Link(LinkDescription { length, radius_base, radius_tip, density: 0.0 })
}

fn group(name: &str, spheres: Vec<(&str, Station)>) -> SphereGroupDescription {
    let sphere = |(body, station): (&str, Station)| SphereDescription { body: body.into(), station };
    SphereGroupDescription { name: name.into(), spheres: spheres.into_iter().map(sphere).collect() }
}

/// The foundation of the rod `suit` on links, with equal weights at its Gauss points.
fn foundation(d: &mut Description, links: &[(&str, bool)], stiffness: Vec<f64>) {
    let suit = d.bodies.iter().find(|b| b.name == "suit").unwrap();
    let ShapeDescription::Rod(rod) = &suit.shape else { panic!("a rod") };
    let (elements, gauss) = (rod.elements, rod.gauss_points);
    let points = (0..elements).flat_map(|e| (1..=gauss).map(move |g| e * (gauss + 1) + g));
    let skin: Vec<_> = points.map(|k| ("suit", Station::Point(k))).collect();
    let count = skin.len();
    let ends = links.iter().flat_map(|(n, _)| [(*n, Station::Fraction(0.0)), (*n, Station::Fraction(1.0))]);
    d.spheres.push(group("suit skin", skin));
    d.spheres.push(group("limb skin", ends.collect()));
    let cones = links.iter().enumerate();
    d.foundations.push(FoundationDescription {
        name: "skin".into(),
        first: "suit skin".into(),
        weights: vec![1.0 / count as f64; count],
        tip: (0..count).map(|k| if 2 * k < count { 0.0 } else { 0.7 }).collect(),
        half_width: vec![0.0; count],
        half_width_multiple: vec![1.0; count],
        roundness: 1.0,
        crown: 0.0,
        second: "limb skin".into(),
        stiffness,
        cones: cones
            .map(|(c, (_, j))| RoundConeDescription { ends: [2 * c, 2 * c + 1], joined: *j })
            .collect(),
        alignment: 1.0,
    });
}

/// A straight rod of radius 8 mm and length 5 cm that slides along z above a link of radius 1 cm.
fn pressed(planar: bool) -> Description {
    let mut d = empty(planar);
    d.bodies.push(body("limb", None, [-0.05, 0.0, 0.0], joint(JointKind::Fixed), link(0.15, 0.01, 0.01)));
    let mut slider = joint(JointKind::Prismatic);
    slider.axis = [0.0, 0.0, 1.0];
    slider.stiffness = vec![0.0];
    let mut suit = rod(0.05, [0.008, 0.008], vec![strain(Mode::BendY, BasisKind::NodalLinear)], 4, 2);
    suit.young_modulus = 1e12;
    d.bodies.push(body("suit", None, [0.0, 0.0, 0.018], slider, ShapeDescription::Rod(suit)));
    foundation(&mut d, &[("limb", false)], vec![1e7; 2]);
    d
}

/// Energy, normal force and pressure at a depth.
fn at_depth<G: LieGroup<D, P>, const D: usize, const P: usize>(d: &Description, depth: f64) -> [f64; 3] {
    let model = Model::<G, D, P>::new(d).unwrap();
    let mut q = vec![0.0; model.dof()];
    q[0] = -depth;
    let mut data = Data::new(&model);
    data.evaluate(&model, &q, &[]);
    let summary = data.contact_summary(&model);
    assert!((summary.overlap - depth.max(0.0)).abs() < 1e-15);
    let forces = data.contact_forces(&model);
    let up: f64 = forces.iter().map(|f| G::point_to_spatial(&f.force)[2]).sum();
    assert!((up + data.residual()[0]).abs() < 1e-12);
    [data.energy(), up, summary.pressure]
}

fn by_hand<G: LieGroup<D, P>, const D: usize, const P: usize>() {
    let mut d = pressed(D == 3);
    // Round on round: 1/R = 1/8 mm + 1/10 mm, so R = 4.4444 mm; at 0.5 mm a = √(2 R d) = 2.1082 mm,
    // f = 4/3 k_f a d = 14.0546 N/m and 8/15 k_f a d² = 2.81091 mJ/m, over 5 cm.
    let [energy, force, pressure] = at_depth::<G, D, P>(&d, 0.5e-3);
    assert!((energy - 2.810_91e-3 * 0.05).abs() < 1e-8 * 0.05, "{energy}");
    assert!((force - 14.054_6 * 0.05).abs() < 1e-4 * 0.05, "{force}");
    assert!((pressure - 5e3).abs() < 1e-9);
    // A flat underside 2 b = 6 mm wide on the cylinder of 10 mm: at 0.5 mm a = 3.1623 mm > b,
    // f = 2 k_f (b d − b³/(6 R)) = 2e7 (1.5e-6 − 4.5e-7) = 21 N/m,
    // k_f (b d² − b³ d/(3 R) + b⁵/(20 R²)) = 1e7 (7.5e-10 − 4.5e-10 + 1.215e-10) = 4.215 mJ/m.
    let skin = &mut d.foundations[0];
    (skin.roundness, skin.crown) = (0.0, 1e-30);
    skin.half_width.fill(3e-3);
    skin.half_width_multiple.fill(0.0);
    let [energy, force, _] = at_depth::<G, D, P>(&d, 0.5e-3);
    assert!((energy - 4.215e-3 * 0.05).abs() < 1e-12, "{energy}");
    assert!((force - 21.0 * 0.05).abs() < 1e-12, "{force}");
    // Across the limb, cos φ = 0, and flat: a punch, f = 2 k_f b d but for its crown.
    let skin = &mut d.foundations[0];
    (skin.alignment, skin.crown) = (0.0, 1e-9);
    let [_, force, _] = at_depth::<G, D, P>(&d, 0.5e-3);
    assert!((force - 30.0 * 0.05).abs() < 1e-5, "{force}");
    assert_eq!(at_depth::<G, D, P>(&d, -1e-9), [0.0; 3]);
}

#[test]
fn forces_on_a_straight_link_are_those_by_hand() {
    by_hand::<SE2, 3, 2>();
    by_hand::<SE3, 6, 3>();
}

/// A rod over two tapered links that are joined by a hinge, pressed into both.
fn limb(planar: bool) -> Description {
    let mut d = empty(planar);
    let hinge = || {
        let mut hinge = joint(JointKind::Revolute);
        hinge.stiffness = vec![0.3];
        hinge
    };
    d.bodies.push(body("upper", None, [0.0; 3], hinge(), link(0.1, 0.03, 0.02)));
    d.bodies.push(body("lower", Some("upper"), [0.0; 3], hinge(), link(0.1, 0.02, 0.012)));
    let modes: &[Mode] = if planar { &[Mode::BendY, Mode::ExtendX] } else { &Mode::ALL };
    let modes = modes.iter().map(|m| strain(*m, BasisKind::NodalLinear)).collect();
    let suit = rod(0.18, [0.012, 0.008], modes, 4, 3);
    let place = if planar { [0.0, 0.0, 0.04] } else { [0.0, 0.006, 0.039] };
    d.bodies.push(body("suit", None, place, joint(JointKind::Fixed), ShapeDescription::Rod(suit)));
    foundation(&mut d, &[("upper", false), ("lower", true)], vec![2e6, 3e6, 3e6, 1e6]);
    d
}

fn differences<G: LieGroup<D, P>, const D: usize, const P: usize>() {
    let mut d = limb(D == 3);
    d.bodies[2].placement.translation[2] = 0.033;
    let enough = |contacts: &[ContactForce<P>]| {
        let lower = contacts.iter().filter(|c| c.nearest.is_some_and(|n| n >= 14)).count();
        contacts.len() > 5 && lower > 0
    };
    assert!(derivatives::<G, D, P>(&d, -0.08, enough) > 20);
    let skin = &mut d.foundations[0];
    (skin.roundness, skin.crown, skin.alignment) = (0.0, 2e-4, 0.8);
    skin.half_width.iter_mut().enumerate().for_each(|(i, b)| *b = 1e-3 * (1.0 + 0.3 * i as f64));
    skin.half_width_multiple.fill(0.2);
    assert!(derivatives::<G, D, P>(&d, -0.08, enough) > 20);
}

#[test]
fn derivatives_are_those_of_differences() {
    differences::<SE2, 3, 2>();
    differences::<SE3, 6, 3>();
}

/// A strap around the upper link pulls it towards a point of the suit.
fn looped(planar: bool) -> Description {
    let mut d = limb(planar);
    d.foundations.clear();
    let spheres = vec![
        ("suit", Station::Point(5)),
        ("upper", Station::Fraction(0.0)),
        ("upper", Station::Fraction(1.0)),
    ];
    d.spheres.push(group("strap", spheres));
    d.loops.push(StrapLoopDescription {
        name: "strap".into(),
        spheres: "strap".into(),
        stiffness: 300.0,
        rest_length: -0.03,
    });
    d
}

fn loop_differences<G: LieGroup<D, P>, const D: usize, const P: usize>() {
    assert!(derivatives::<G, D, P>(&looped(D == 3), 0.1, |_| true) > 20);
    let model = Model::<G, D, P>::new(&looped(D == 3)).unwrap();
    let mut data = Data::new(&model);
    data.evaluate(&model, &vec![0.1; model.dof()], &[]);
    let mut tensions = [0.0];
    data.loop_tensions(&model, &mut tensions);
    let [tension] = tensions;
    assert!(tension > 1.0);
    assert!((data.energy() - tension * tension / 600.0).abs() < 1e-12 * data.energy() + elastic::<G, D, P>());
}

/// The energy of the same without strap.
fn elastic<G: LieGroup<D, P>, const D: usize, const P: usize>() -> f64 {
    let mut d = looped(D == 3);
    d.loops.clear();
    let model = Model::<G, D, P>::new(&d).unwrap();
    let mut data = Data::new(&model);
    data.evaluate(&model, &vec![0.1; model.dof()], &[]);
    data.energy() * (1.0 + 1e-12)
}

#[test]
fn a_strap_that_slides_has_exact_derivatives() {
    loop_differences::<SE2, 3, 2>();
    loop_differences::<SE3, 6, 3>();
}

/// The suit pushes the limb down by a force on its tip.
fn pushed(planar: bool) -> Description {
    let mut d = limb(planar);
    d.wrenches.push(WrenchDescription {
        name: "push".into(),
        at: AttachmentDescription::Body {
            body: "suit".into(),
            station: Station::Point(16),
            offset: [0.0; 3],
            surface: [0.0; 3],
        },
        force: [0.0, 0.0, -1.0],
        moment: [0.0; 3],
        frame: WrenchFrame::World,
        input: true,
        turns: false,
    });
    d
}

/// The tip force of an equilibrium and its derivatives with respect to `gradient`.
fn tip_force<G: LieGroup<D, P>, const D: usize, const P: usize>(
    model: &Model<G, D, P>,
    base: &[f64],
    gradient: &[usize],
) -> (f64, Vec<f64>) {
    let (varied, values, loads) = (&[], &[], &[0.0, 2.0]);
    let (designs, steps, start, cancel) = (1, 2, None, None);
    let batch = Batch { base, varied, values, designs, loads, steps, start, slips: &[], cancel };
    let result = model.solve_batch(batch, ContinuationOptions::default(), 1);
    assert!(result.status.iter().all(|s| *s == Status::Converged as u8));
    let slopes = of_output(model, base, &result, ("tip_force", 0), gradient);
    (result.tip_force[1], slopes.by_parameters)
}

fn tip_force_gradient<G: LieGroup<D, P>, const D: usize, const P: usize>() {
    let model = Model::<G, D, P>::new(&pushed(D == 3)).unwrap();
    let p = model.parameters().to_vec();
    let slots = ["suit.length", "suit.radius", "lower.length", "lower.radius_tip", "skin.foundation"];
    let wanted: Vec<usize> = slots.iter().flat_map(|s| model.layout().get(s).unwrap()).collect();
    let (force, exact) = tip_force(&model, &p, &wanted);
    assert!(force > 0.1, "{force}");
    let scale = exact.iter().zip(&wanted).fold(0.0f64, |m, (g, i)| m.max((g * p[*i]).abs()));
    for (i, exact) in wanted.iter().zip(exact) {
        let h = 4e-5 * p[*i];
        let at = |step: f64| {
            let mut moved = p.clone();
            moved[*i] += step * h;
            tip_force(&model, &moved, &[]).0
        };
        let difference = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
        let error = (difference - exact).abs() * p[*i];
        assert!(error < 1e-6 * scale, "parameter {i}: {difference} {exact}");
    }
}

#[test]
fn the_tip_force_has_exact_derivatives() {
    tip_force_gradient::<SE2, 3, 2>();
    tip_force_gradient::<SE3, 6, 3>();
}

/// A point that is drawn over the joint of a bent limb feels no jump of its force.
#[test]
fn the_force_along_a_bent_limb_is_continuous() {
    let mut d = empty(true);
    d.bodies.push(body("upper", None, [0.0; 3], joint(JointKind::Fixed), link(0.1, 0.03, 0.02)));
    let mut bent = body("lower", Some("upper"), [0.0; 3], joint(JointKind::Fixed), link(0.1, 0.02, 0.012));
    bent.placement.rotation = [0.0, 0.5, 0.0];
    d.bodies.push(bent);
    let mut slider = joint(JointKind::Prismatic);
    slider.axis = [1.0, 0.0, 0.0];
    let suit = rod(1e-3, [0.008, 0.008], vec![strain(Mode::BendY, BasisKind::NodalLinear)], 1, 2);
    d.bodies.push(body("suit", None, [0.0, 0.0, 0.0265], slider, ShapeDescription::Rod(suit)));
    foundation(&mut d, &[("upper", false), ("lower", true)], vec![2e6, 3e6, 3e6, 1e6]);
    let model = Model::<SE2, 3, 2>::new(&d).unwrap();
    let mut data = Data::new(&model);
    let mut force = |x: f64| {
        let mut q = vec![0.0; model.dof()];
        q[0] = x;
        data.evaluate_residual(&model, &q, &[]);
        data.residual()[0]
    };
    let (step, mut before, mut largest) = (2e-6, force(0.06), 0.0f64);
    let mut x = 0.06;
    while x < 0.12 {
        x += step;
        let now = force(x);
        largest = largest.max((now - before).abs());
        before = now;
    }
    let range = (0..60).map(|i| force(0.06 + 1e-3 * f64::from(i)).abs()).fold(0.0, f64::max);
    assert!(range > 1e-3 && largest < 2e-3 * range, "{largest} {range}");
}

#[test]
fn what_makes_no_foundation_is_refused() {
    let refused = |change: &dyn Fn(&mut Description)| {
        let mut d = limb(true);
        change(&mut d);
        Model::<SE2, 3, 2>::new(&d).unwrap_err().to_string()
    };
    let count = refused(&|d| d.foundations[0].weights.truncate(3));
    assert_eq!(count, "foundations.skin.weights: found 3 values, the group has 12 spheres");
    let negative = refused(&|d| d.foundations[0].stiffness[1] = -1.0);
    assert!(negative.starts_with("foundations.skin.stiffness: found -1"), "{negative}");
    let flat = refused(&|d| d.foundations[0].roundness = 0.0);
    assert!(flat.starts_with("foundations.skin.roundness: found 0"), "{flat}");
    let apart = refused(&|d| d.foundations[0].cones[0].ends = [0, 2]);
    assert_eq!(apart, "foundations.skin.cones: the ends of a round cone must be on one link");
    let links = refused(&|d| d.foundations[0].first = "limb skin".into());
    assert!(links.starts_with("foundations.skin."), "{links}");
}
