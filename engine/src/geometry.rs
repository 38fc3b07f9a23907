//! The geometry of one design: bodies, strains, points and spheres as functions of the parameters.

use crate::lie::LieGroup;
use crate::linalg::{LANES, Matrix, Vector};
use crate::tree::{Between, Link, Motion, Place, Shape, SphereRadius, Tree};

/// Geometric quantities derived from the parameters, refilled in place for each design.
#[derive(Clone, Debug)]
pub(crate) struct Geometry<G, const D: usize, const P: usize> {
    pub parameters: Vec<f64>,
    /// Constant offsets between frames: placement and tip of each body.
    pub rigid: Vec<G>,
    pub rods: Vec<RodStrain<D>>,
    /// Φ: from a frame's coordinates to the strains at both collocation points of its motion, in
    /// blocks of columns; a joint's are its twists.
    pub strain_maps: Vec<[Matrix<D, LANES>; 2]>,
    /// The frame of each point.
    pub frames: Vec<usize>,
    /// Frames whose Jacobian is kept, with their slot in the store.
    pub jacobian_slot: Vec<Option<usize>>,
    /// Local position of each point in its frame.
    pub points: Vec<Vector<P>>,
    /// Radius of each sphere.
    pub radii: Vec<f64>,
}

/// Strain of a rod in normalised form: angular components times L, linear components times L.
#[derive(Clone, Debug)]
pub(crate) struct RodStrain<const D: usize> {
    /// From coordinate to normalised strain: 1 for L·κ, L for linear strains.
    pub axis_scale: Vector<D>,
    pub reference: Vector<D>,
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> Geometry<G, D, P> {
    pub fn new(tree: &Tree<G, D, P>) -> Self {
        let mut geometry = Self {
            parameters: tree.parameters.clone(),
            rigid: vec![G::IDENTITY; 2 * tree.bodies.len()],
            rods: vec![RodStrain { axis_scale: Vector::ZERO, reference: Vector::ZERO }; tree.rods.len()],
            strain_maps: vec![[Matrix::ZERO; 2]; tree.frames.last().map_or(0, |f| f.blocks.end)],
            frames: tree.points.iter().map(|point| point.frame).collect(),
            jacobian_slot: tree.jacobian_slot.clone(),
            points: vec![Vector::ZERO; tree.points.len()],
            radii: vec![0.0; tree.spheres.len()],
        };
        geometry.update(tree);
        geometry
    }

    /// Recomputes everything from `self.parameters`, without allocating.
    pub fn update(&mut self, tree: &Tree<G, D, P>) {
        self.place_bodies(tree);
        self.scale_strains(tree);
        self.move_points(tree);
        self.map_strains(tree);
        self.place_points(tree);
        self.size_spheres(tree);
    }

    fn place_bodies(&mut self, tree: &Tree<G, D, P>) {
        let p = &self.parameters;
        for body in &tree.bodies {
            let three = |r: &std::ops::Range<usize>| [p[r.start], p[r.start + 1], p[r.start + 2]];
            let pose = G::from_spatial(&three(&body.translation), &three(&body.rotation));
            self.rigid[body.placement] = pose.unwrap_or(G::IDENTITY);
            if let Shape::Link(link) = &body.shape {
                let tip = G::from_spatial(&[p[link.length], 0.0, 0.0], &[0.0; 3]);
                self.rigid[link.tip] = tip.unwrap_or(G::IDENTITY);
            }
        }
    }

    fn scale_strains(&mut self, tree: &Tree<G, D, P>) {
        for (rod, out) in tree.rods.iter().zip(&mut self.rods) {
            let length = self.parameters[rod.length];
            for (axis, mode) in G::AXES.into_iter().enumerate() {
                out.axis_scale[axis] = if mode.is_angular() { 1.0 } else { length };
                out.reference[axis] = length * self.parameters[rod.reference_strain.start + mode.index()];
            }
        }
    }

    fn map_strains(&mut self, tree: &Tree<G, D, P>) {
        for frame in &tree.frames {
            let maps = &mut self.strain_maps[frame.blocks.clone()];
            match &frame.motion {
                Motion::Rigid(_) => {}
                Motion::Joint(columns) => {
                    for (m, column) in tree.joint_columns[columns.clone()].iter().enumerate() {
                        maps[m / LANES][0].set_column(m % LANES, &column.twist);
                    }
                }
                Motion::Strain(step) => {
                    let step = &tree.steps[*step];
                    let scale = &self.rods[step.rod].axis_scale;
                    for (m, column) in tree.strain_columns[step.columns.clone()].iter().enumerate() {
                        for (map, phi) in maps[m / LANES].iter_mut().zip(column.phi) {
                            map.0[column.axis][m % LANES] = phi * scale[column.axis];
                        }
                    }
                }
            }
        }
    }

    /// Finds the frames of points between sample points.
    fn move_points(&mut self, tree: &Tree<G, D, P>) {
        if tree.moving.is_empty() {
            return;
        }
        for (frame, point) in self.frames.iter_mut().zip(&tree.points) {
            if let Place::Between(between, side) = point.place {
                *frame = point.frame + between.interval(&tree.rods, &self.parameters).before + side;
            }
        }
        self.jacobian_slot.copy_from_slice(&tree.jacobian_slot);
        let fixed = tree.jacobian_slot.iter().flatten().count();
        for (k, point) in tree.moving.iter().enumerate() {
            self.jacobian_slot[self.frames[*point]].get_or_insert(fixed + k);
        }
    }

    fn place_points(&mut self, tree: &Tree<G, D, P>) {
        for (local, point) in self.points.iter_mut().zip(&tree.points) {
            *local = point.offset.map_or(Vector::ZERO, |slot| spatial::<G, D, P>(&self.parameters, slot));
            let (body, fraction) = link_fraction(tree, &self.parameters, point.place);
            if let Some(Shape::Link(link)) = body {
                local[0] += fraction * self.parameters[link.length];
            }
            if let Place::Between(between, side) = point.place {
                let length = self.parameters[tree.rods[between.rod].length];
                local[0] += between.interval(&tree.rods, &self.parameters).arm(side)[0] * length;
            }
            if let Some((radius, direction)) = &point.surface {
                *local += *direction * radius_of(tree, &self.parameters, *radius);
            }
        }
    }

    fn size_spheres(&mut self, tree: &Tree<G, D, P>) {
        for (radius, sphere) in self.radii.iter_mut().zip(&tree.spheres) {
            *radius = radius_of(tree, &self.parameters, sphere.radius);
        }
    }
}

/// The vector whose three components in space are parameters from `slot` on.
#[inline]
pub(crate) fn spatial<G: LieGroup<D, P>, const D: usize, const P: usize>(
    p: &[f64],
    slot: usize,
) -> Vector<P> {
    G::point_from_spatial(&[p[slot], p[slot + 1], p[slot + 2]]).unwrap_or(Vector::ZERO)
}

/// Adds to the derivatives by these parameters those by the vector.
#[inline]
pub(crate) fn add_spatial<G: LieGroup<D, P>, const D: usize, const P: usize>(
    gradient: &mut [f64],
    slot: usize,
    slope: &Vector<P>,
) {
    for (out, slope) in gradient[slot..slot + 3].iter_mut().zip(G::point_to_spatial(slope)) {
        *out += slope;
    }
}

/// The radius of a body at a place.
fn radius_of<G: LieGroup<D, P>, const D: usize, const P: usize>(
    tree: &Tree<G, D, P>,
    parameters: &[f64],
    radius: SphereRadius,
) -> f64 {
    match radius {
        SphereRadius::Parameter(k) => parameters[k],
        SphereRadius::Link(body, place) => {
            let (_, f) = link_fraction(tree, parameters, place);
            let Shape::Link(link) = &tree.bodies[body].shape else { return 0.0 };
            let (a, b) = (parameters[link.radius_base], parameters[link.radius_tip]);
            a + f * (b - a)
        }
        SphereRadius::Between(between, side) => parameters[radius_between(tree, parameters, between, side)],
    }
}

/// The parameter that holds the radius of a rod at the sample point before (0) or after (1) a place.
pub(crate) fn radius_between<G: LieGroup<D, P>, const D: usize, const P: usize>(
    tree: &Tree<G, D, P>,
    parameters: &[f64],
    between: Between,
    side: usize,
) -> usize {
    tree.rods[between.rod].radius.start + between.interval(&tree.rods, parameters).before + side
}

/// The link of a place and the fraction of its length, when it depends on a link.
pub(crate) fn link_fraction<'a, G: LieGroup<D, P>, const D: usize, const P: usize>(
    tree: &'a Tree<G, D, P>,
    parameters: &[f64],
    place: Place,
) -> (Option<&'a Shape>, f64) {
    match place {
        Place::Frame | Place::Between(..) => (None, 0.0),
        Place::Fraction(body, f) => (Some(&tree.bodies[body].shape), f),
        Place::Along(body, slot) => (Some(&tree.bodies[body].shape), parameters[slot]),
        Place::Centroid(body) => {
            let shape = &tree.bodies[body].shape;
            let Shape::Link(link) = shape else { return (None, 0.0) };
            let (a, b) = (parameters[link.radius_base], parameters[link.radius_tip]);
            let centroid = (a * a + 2.0 * a * b + 3.0 * b * b) / (4.0 * (a * a + a * b + b * b));
            (Some(shape), centroid)
        }
    }
}

/// Derivative of a place's fraction with respect to the link's radii (base, tip).
pub(crate) fn link_fraction_slope(p: &[f64], link: &Link, place: Place) -> [f64; 2] {
    let Place::Centroid(_) = place else { return [0.0; 2] };
    let (a, b) = (p[link.radius_base], p[link.radius_tip]);
    let (top, bottom) = (a * a + 2.0 * a * b + 3.0 * b * b, 4.0 * (a * a + a * b + b * b));
    let slope = |dt: f64, db: f64| (dt * bottom - top * db) / (bottom * bottom);
    [slope(2.0 * a + 2.0 * b, 4.0 * (2.0 * a + b)), slope(2.0 * a + 6.0 * b, 4.0 * (a + 2.0 * b))]
}

/// Adds `weight · dR/dp` of a sphere's radius R.
pub(crate) fn add_radius_slope<G: LieGroup<D, P>, const D: usize, const P: usize>(
    tree: &Tree<G, D, P>,
    parameters: &[f64],
    radius: SphereRadius,
    weight: f64,
    gradient: &mut [f64],
) {
    for_each_radius_slope(tree, parameters, radius, |slot, [a, b]| gradient[slot] += weight * a * b);
}

/// dR/dp of a sphere's radius R by one parameter.
pub(crate) fn radius_slope<G: LieGroup<D, P>, const D: usize, const P: usize>(
    tree: &Tree<G, D, P>,
    parameters: &[f64],
    radius: SphereRadius,
    wanted: usize,
) -> f64 {
    let mut sum = 0.0;
    for_each_radius_slope(tree, parameters, radius, |slot, [a, b]| {
        sum += if slot == wanted { a * b } else { 0.0 };
    });
    sum
}

/// Visits the parameters on which a sphere's radius depends, with its slopes, each as a product.
#[inline]
fn for_each_radius_slope<G: LieGroup<D, P>, const D: usize, const P: usize>(
    tree: &Tree<G, D, P>,
    parameters: &[f64],
    radius: SphereRadius,
    mut visit: impl FnMut(usize, [f64; 2]),
) {
    match radius {
        SphereRadius::Parameter(k) => visit(k, [1.0; 2]),
        SphereRadius::Link(body, place) => {
            let Shape::Link(link) = &tree.bodies[body].shape else { return };
            let (_, f) = link_fraction(tree, parameters, place);
            visit(link.radius_base, [1.0 - f, 1.0]);
            visit(link.radius_tip, [f, 1.0]);
            let taper = parameters[link.radius_tip] - parameters[link.radius_base];
            if let Place::Along(_, slot) = place {
                visit(slot, [taper, 1.0]);
            }
            // The centroid's fraction depends on the radii too.
            let [by_base, by_tip] = link_fraction_slope(parameters, link, place);
            visit(link.radius_base, [taper, by_base]);
            visit(link.radius_tip, [taper, by_tip]);
        }
        SphereRadius::Between(between, side) => {
            visit(radius_between(tree, parameters, between, side), [1.0; 2]);
        }
    }
}
