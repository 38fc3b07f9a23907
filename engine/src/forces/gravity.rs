//! Gravity on the masses of rods (at Gauss points) and links (at centroids): −m g·r.

use super::element::{ForceElement, ForceMemory, Velocities, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::state::State;
use super::terms::Terms;
use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::section;
use crate::tree::{ModelError, Place, Point, Rod, Shape, Tree, finite};

/// Uniform gravity and the masses on which it acts; none without gravity.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gravity<const P: usize> {
    acceleration: Vector<P>,
    masses: Vec<PointMass>,
}

#[derive(Clone, Debug, PartialEq)]
struct PointMass {
    point: usize,
    part: Part,
}

/// The body with the mass.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    /// A Gauss point of a rod (rod, Gauss point).
    Rod(usize, usize),
    /// The same, with a section of fibres.
    Fibres(usize, usize),
    /// A link (body).
    Link(usize),
}

/// Volume and mass at a point.
#[derive(Clone, Debug, Default)]
pub(crate) struct Weight {
    volume: f64,
    mass: f64,
}

impl<const P: usize> Gravity<P> {
    pub fn build<G: LieGroup<D, P>, const D: usize>(
        tree: &mut Tree<G, D, P>,
        acceleration: &[f64; 3],
    ) -> Result<Self, ModelError> {
        finite("gravity", acceleration)?;
        let acceleration = G::point_from_spatial(acceleration)
            .ok_or_else(|| ModelError::new("gravity", "a planar system has no gravity along y"))?;
        let mut masses = vec![];
        let bodies = if acceleration == Vector::ZERO { &[][..] } else { &tree.bodies };
        let mut push = |part, frame, place| {
            masses.push(PointMass { point: tree.points.len(), part });
            tree.points.push(Point { frame, place, offset: Vector::ZERO, surface: None });
        };
        for (b, body) in bodies.iter().enumerate() {
            match &body.shape {
                Shape::Rod(r) => {
                    for (g, gauss) in tree.rods[*r].gauss.iter().enumerate() {
                        let part = if tree.rods[*r].masses.is_empty() { Part::Rod } else { Part::Fibres };
                        push(part(*r, g), body.base_frame + gauss.point, Place::Frame);
                    }
                }
                Shape::Link(_) => push(Part::Link(b), body.base_frame, Place::Centroid(b)),
            }
        }
        Ok(Self { acceleration, masses })
    }
}

/// Mass per length of a section of fibres and its derivative with respect to S, and the powers of S.
fn mass_per_length(rod: &Rod, gauss: usize, p: &[f64]) -> ([f64; 2], [f64; 3]) {
    let (s, first) = (p[rod.radius.start + rod.gauss[gauss].point], rod.masses[gauss]);
    let [a, b, c] = [p[first], p[first + 1], p[first + 2]];
    ([a + s * (b + s * c), b + 2.0 * s * c], [1.0, s, s * s])
}

impl<const P: usize> ForceMemory<P> for Gravity<P> {
    type Design = Vec<Weight>;
    type State = ();
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Gravity<P> {
    fn design(&self, _: &Tree<G, D, P>) -> Vec<Weight> {
        vec![Weight::default(); self.masses.len()]
    }

    fn state(&self, _: &Tree<G, D, P>) {}

    /// Volumes S² L for rods, L (a² + ab + b²) for links, up to a factor.
    fn update_design(&self, tree: &Tree<G, D, P>, geometry: &Geometry<G, D, P>, weights: &mut Vec<Weight>) {
        let p = &geometry.parameters;
        for (weight, PointMass { part, .. }) in weights.iter_mut().zip(&self.masses) {
            let (volume, density) = match *part {
                Part::Rod(r, g) => {
                    let (rod, gauss) = (&tree.rods[r], &tree.rods[r].gauss[g]);
                    let area = section::factors(rod.section)[3] * p[rod.radius.start + gauss.point].powi(2);
                    (area * p[rod.length] * gauss.weight, p[rod.density])
                }
                Part::Fibres(r, g) => {
                    let (rod, weight) = (&tree.rods[r], tree.rods[r].gauss[g].weight);
                    let ([mass, _], _) = mass_per_length(rod, g, p);
                    (p[rod.length] * weight * mass, 1.0)
                }
                Part::Link(b) => {
                    let Shape::Link(link) = &tree.bodies[b].shape else { continue };
                    let (a, b) = (p[link.radius_base], p[link.radius_tip]);
                    let volume = std::f64::consts::PI / 3.0 * p[link.length] * (a * a + a * b + b * b);
                    (volume, p[link.density])
                }
            };
            *weight = Weight { volume, mass: density * volume };
        }
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        weights: &Vec<Weight>,
        _: &mut (),
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        for (PointMass { point, .. }, weight) in self.masses.iter().zip(weights) {
            let p = at.point(*point);
            let gradient = self.acceleration * -weight.mass;
            out.energy += gradient.dot(p);
            out.add_force::<G, P>(at.frame(*point), p, &gradient);
        }
    }

    fn add_tangent(
        &self,
        at: &State<G, D, P>,
        weights: &Vec<Weight>,
        _: &(),
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        for (PointMass { point, .. }, weight) in self.masses.iter().zip(weights) {
            let gradient = self.acceleration * -weight.mass;
            out.add_curvature::<G, P>(at.frame(*point), at.point(*point), &gradient);
        }
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, weights: &Vec<Weight>, _: &(), out: &mut Magnitudes<P>) {
        for (PointMass { point, .. }, weight) in self.masses.iter().zip(weights) {
            out.add_at_point(at, *point, self.acceleration.norm() * weight.mass);
        }
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        weights: &Vec<Weight>,
        _: &(),
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        let p = at.parameters();
        for (PointMass { point, part }, Weight { volume, mass }) in self.masses.iter().zip(weights) {
            let work = -self.acceleration.dot(&motion.velocities.points[*point]);
            let mut relative = |i: usize, power: f64| gradient[i] += power * mass * work / p[i];
            match *part {
                Part::Rod(r, g) => {
                    let rod = &at.tree.rods[r];
                    relative(rod.radius.start + rod.gauss[g].point, 2.0);
                    relative(rod.length, 1.0);
                    gradient[rod.density] += volume * work;
                }
                Part::Fibres(r, g) => {
                    let rod = &at.tree.rods[r];
                    relative(rod.length, 1.0);
                    let ([_, slope], powers) = mass_per_length(rod, g, p);
                    let work = work * p[rod.length] * rod.gauss[g].weight;
                    gradient[rod.radius.start + rod.gauss[g].point] += slope * work;
                    let coefficients = &mut gradient[rod.masses[g]..];
                    coefficients.iter_mut().zip(powers).for_each(|(out, power)| *out += power * work);
                }
                Part::Link(b) => {
                    let Shape::Link(link) = &at.tree.bodies[b].shape else { continue };
                    relative(link.length, 1.0);
                    gradient[link.density] += volume * work;
                    let (a, b) = (p[link.radius_base], p[link.radius_tip]);
                    let sum = a * a + a * b + b * b;
                    gradient[link.radius_base] += mass * work * (2.0 * a + b) / sum;
                    gradient[link.radius_tip] += mass * work * (a + 2.0 * b) / sum;
                }
            }
        }
    }

    fn add_geometric_work(
        &self,
        at: &State<G, D, P>,
        weights: &Vec<Weight>,
        _: &(),
        motion: &VirtualMotion<D, P>,
        velocities: &Velocities<D, P>,
        work: &mut f64,
    ) {
        for (PointMass { point, .. }, weight) in self.masses.iter().zip(weights) {
            let shifted = motion.velocities.shifted::<G>(at.frame(*point), &velocities.points[*point]);
            *work -= (self.acceleration * weight.mass).dot(&shifted);
        }
    }
}
