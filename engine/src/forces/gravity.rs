//! Gravity on the masses of rods (Gauss points; the centroid of a section of fibres) and links (centroids):
//! −m g·r.

use super::element::{ForceElement, ForceMemory, Velocities, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::moments::Moments;
use super::state::State;
use super::terms::Terms;
use crate::geometry::{Geometry, add_spatial, spatial};
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::section;
use crate::tree::{ModelError, Place, Point, Rod, Shape, Tree, finite};

/// Uniform gravity and the masses on which it acts; none without gravity.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gravity {
    /// The first of three parameters that hold the acceleration, where there are masses.
    acceleration: usize,
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

/// Volume and mass at a point, and how far their centroid is from it in its frame.
#[derive(Clone, Debug)]
pub(crate) struct Weight<const P: usize> {
    volume: f64,
    mass: f64,
    centroid: Vector<P>,
}

impl Gravity {
    /// `weighs`: whether masses count even if there is no gravity.
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        acceleration: &[f64; 3],
        weighs: bool,
    ) -> Result<Self, ModelError> {
        finite("gravity", acceleration)?;
        G::point_from_spatial(acceleration)
            .ok_or_else(|| ModelError::new("gravity", "a planar system has no gravity along y"))?;
        let mut masses = vec![];
        if !weighs && *acceleration == [0.0; 3] {
            return Ok(Self { acceleration: 0, masses });
        }
        let slot = tree.slot("gravity".into(), "m/s^2", acceleration).start;
        let mut push = |part, frame, place| {
            masses.push(PointMass { point: tree.points.len(), part });
            tree.points.push(Point { frame, place, offset: None, surface: None });
        };
        for (b, body) in tree.bodies.iter().enumerate() {
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
        Ok(Self { acceleration: slot, masses })
    }

    /// The acceleration; none without masses.
    #[inline]
    fn acceleration<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        at: &State<G, D, P>,
    ) -> Vector<P> {
        if self.masses.is_empty() {
            Vector::ZERO
        } else {
            spatial::<G, D, P>(at.parameters(), self.acceleration)
        }
    }
}

/// Mass per length of a section of fibres with its first moments.
fn mass_per_length(rod: &Rod, gauss: usize, p: &[f64]) -> Moments {
    Moments::new(&p[rod.masses[gauss]..], p[rod.radius.start + rod.gauss[gauss].point])
}

/// Directions of y and z in a frame; a planar section has no moment along y.
fn across<G: LieGroup<D, P>, const D: usize, const P: usize>() -> [Vector<P>; 2] {
    [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| G::point_from_spatial(&axis).unwrap_or(Vector::ZERO))
}

impl<const P: usize> Weight<P> {
    /// Where the mass of a point is.
    #[inline]
    fn place<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>, point: usize) -> Vector<P> {
        *at.point(point) + at.kinematics.pose[at.frame(point)].rotate(&self.centroid)
    }
}

impl<const P: usize> ForceMemory<P> for Gravity {
    type Design = Vec<Weight<P>>;
    type State = ();
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Gravity {
    fn design(&self, _: &Tree<G, D, P>) -> Vec<Weight<P>> {
        vec![Weight { volume: 0.0, mass: 0.0, centroid: Vector::ZERO }; self.masses.len()]
    }

    fn state(&self, _: &Tree<G, D, P>) {}

    /// Volumes S² L for rods, L (a² + ab + b²) for links, up to a factor.
    fn update_design(
        &self,
        tree: &Tree<G, D, P>,
        geometry: &Geometry<G, D, P>,
        weights: &mut Vec<Weight<P>>,
    ) {
        let p = &geometry.parameters;
        for (weight, PointMass { part, .. }) in weights.iter_mut().zip(&self.masses) {
            let mut centroid = Vector::ZERO;
            let (volume, density) = match *part {
                Part::Rod(r, g) => {
                    let (rod, gauss) = (&tree.rods[r], &tree.rods[r].gauss[g]);
                    let factor = rod.factors.map_or(0.0, |factors| p[factors + section::AREA]);
                    let area = factor * p[rod.radius.start + gauss.point].powi(2);
                    (area * p[rod.length] * gauss.weight, p[rod.density])
                }
                Part::Fibres(r, g) => {
                    let (rod, weight) = (&tree.rods[r], tree.rods[r].gauss[g].weight);
                    let [mass, y, z] = mass_per_length(rod, g, p).value;
                    if mass > 0.0 {
                        let [along_y, along_z] = across::<G, D, P>();
                        centroid = along_y * (y / mass) + along_z * (z / mass);
                    }
                    (p[rod.length] * weight * mass, 1.0)
                }
                Part::Link(b) => {
                    let Shape::Link(link) = &tree.bodies[b].shape else { continue };
                    let (a, b) = (p[link.radius_base], p[link.radius_tip]);
                    let volume = std::f64::consts::PI / 3.0 * p[link.length] * (a * a + a * b + b * b);
                    (volume, p[link.density])
                }
            };
            *weight = Weight { volume, mass: density * volume, centroid };
        }
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        weights: &Vec<Weight<P>>,
        _: &mut (),
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        let acceleration = self.acceleration(at);
        for (PointMass { point, .. }, weight) in self.masses.iter().zip(weights) {
            let p = weight.place(at, *point);
            let gradient = acceleration * -weight.mass;
            out.energy += gradient.dot(&p);
            out.add_force::<G, P>(at.frame(*point), &p, &gradient);
        }
    }

    fn add_tangent(
        &self,
        at: &State<G, D, P>,
        weights: &Vec<Weight<P>>,
        _: &(),
        Terms { frames: out, .. }: &mut Terms<D>,
    ) {
        let acceleration = self.acceleration(at);
        for (PointMass { point, .. }, weight) in self.masses.iter().zip(weights) {
            let gradient = acceleration * -weight.mass;
            out.add_curvature::<G, P>(at.frame(*point), &weight.place(at, *point), &gradient);
        }
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, weights: &Vec<Weight<P>>, _: &(), out: &mut Magnitudes<P>) {
        let acceleration = self.acceleration(at).norm();
        for (PointMass { point, .. }, weight) in self.masses.iter().zip(weights) {
            let force = acceleration * weight.mass;
            out.add_at_place(at.frame(*point), weight.place(at, *point), force);
        }
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        weights: &Vec<Weight<P>>,
        _: &(),
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        let (p, acceleration) = (at.parameters(), self.acceleration(at));
        for (PointMass { point, part }, Weight { volume, mass, centroid }) in self.masses.iter().zip(weights)
        {
            let pose = &at.kinematics.pose[at.frame(*point)];
            // The work of a unit mass at the point, and what it is more elsewhere in the frame.
            let own = motion.velocities.points[*point];
            let beside_it = |place: &Vector<P>| {
                let place = pose.rotate(place);
                motion.velocities.shifted::<G>(at.frame(*point), &place)
            };
            let beside = |place: &Vector<P>| -acceleration.dot(&beside_it(place));
            let velocity = own + beside_it(centroid);
            add_spatial::<G, D, P>(gradient, self.acceleration, &(velocity * -*mass));
            let work = -acceleration.dot(&velocity);
            let mut relative = |i: usize, power: f64| gradient[i] += power * mass * work / p[i];
            match *part {
                Part::Rod(r, g) => {
                    let rod = &at.tree.rods[r];
                    relative(rod.radius.start + rod.gauss[g].point, 2.0);
                    relative(rod.length, 1.0);
                    if let Some(factors) = rod.factors {
                        relative(factors + section::AREA, 1.0);
                    }
                    gradient[rod.density] += volume * work;
                }
                Part::Fibres(r, g) => {
                    let rod = &at.tree.rods[r];
                    relative(rod.length, 1.0);
                    let radius = rod.radius.start + rod.gauss[g].point;
                    let by_radius = mass_per_length(rod, g, p).by_radius;
                    let [along_y, along_z] = across::<G, D, P>();
                    let mut first = rod.masses[g];
                    for (k, work) in
                        [-acceleration.dot(&own), beside(&along_y), beside(&along_z)].into_iter().enumerate()
                    {
                        let work = work * p[rod.length] * rod.gauss[g].weight;
                        gradient[radius] += by_radius[k] * work;
                        let count = if k == 0 { 3 } else { 4 };
                        let powers = std::iter::successors(Some(1.0), |power| Some(power * p[radius]));
                        for (out, power) in gradient[first..first + count].iter_mut().zip(powers) {
                            *out += power * work;
                        }
                        first += count;
                    }
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
        weights: &Vec<Weight<P>>,
        _: &(),
        motion: &VirtualMotion<D, P>,
        velocities: &Velocities<D, P>,
        work: &mut f64,
    ) {
        let acceleration = self.acceleration(at);
        for (PointMass { point, .. }, weight) in self.masses.iter().zip(weights) {
            let frame = at.frame(*point);
            let centroid = at.kinematics.pose[frame].rotate(&weight.centroid);
            let velocity = velocities.points[*point] + velocities.shifted::<G>(frame, &centroid);
            let shifted = motion.velocities.shifted::<G>(frame, &velocity);
            *work -= (acceleration * weight.mass).dot(&shifted);
        }
    }
}
