//! Pressure in the cavities of rods: −p V with V = ∫ A (ξ_x + κ_y z − κ_z y) dX, where A and (y, z) are the
//! area and centroid on which the pressure acts; by the theorem of Pappus this is the volume swept by A.
//!
//! A and its first moments are polynomials of S, so V is linear in the coordinates.

use super::differential::Differential;
use super::element::{ForceElement, ForceMemory, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::moments::{MOMENTS, Moments};
use super::state::State;
use super::terms::Terms;
use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::tree::{ModelError, Tree, finite};
use serde::Deserialize;
use std::ops::Range;

/// A pressurised cavity along a rod.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PressureDescription {
    /// Unique name, also that of its load input [Pa] unless it shares one.
    pub name: String,
    /// The rod.
    pub rod: String,
    /// Sections that the pressure acts on: the area's coefficients of 1, S, S², then those of 1, S, S²,
    /// S³ of its first moments ∫ y dA and ∫ z dA.
    pub sections: Vec<[f64; MOMENTS]>,
    /// Which of these each Gauss point has.
    pub of_gauss: Vec<usize>,
    /// Share of each Gauss point's length that is under pressure.
    pub share: Vec<f64>,
    /// Volume of the wall around the cavity inside those sections in the reference state, along the length
    /// of each Gauss point [m³].
    pub enclosed: Vec<f64>,
}

#[derive(Clone, Debug, PartialEq)]
struct Pressure {
    rod: usize,
    input: usize,
    sections: Vec<Range<usize>>,
    of_gauss: Vec<usize>,
    /// Slots of the shares and the volumes of each Gauss point.
    share: Range<usize>,
    enclosed: Range<usize>,
}

/// All pressures.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pressures(Vec<Pressure>);

/// The volumes of a design: each is its first number plus the sum of these multiples of coordinates.
#[derive(Clone, Debug, Default)]
pub(crate) struct Volumes {
    /// One for each pressure: reference volume and number of its columns.
    fixed: Vec<(f64, usize)>,
    columns: Vec<(usize, f64)>,
}

/// Area or moment that a strain mode multiplies in the volume, with the power of L; none for torsion
/// and shear.
fn by_mode([area, y, z]: [f64; 3], mode: usize) -> Option<(f64, i32)> {
    match mode {
        1 => Some((z, 0)),
        2 => Some((-y, 0)),
        3 => Some((area, 1)),
        _ => None,
    }
}

/// Adds derivatives of what is linear in area and first moments, given those by these.
fn add_of_moments(
    work: [f64; 3],
    moments: &Moments,
    s: f64,
    radius: usize,
    slot: Range<usize>,
    gradient: &mut [f64],
) {
    for (work, slope) in work.iter().zip(moments.by_radius) {
        gradient[radius] += work * slope;
    }
    let powers = [1.0, s, s * s, s * s * s];
    let of = |k: usize| if k < 3 { (0, k) } else { (1 + (k - 3) / 4, (k - 3) % 4) };
    for (k, out) in gradient[slot].iter_mut().enumerate() {
        let (part, power) = of(k);
        *out += work[part] * powers[power];
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Volumes {
    /// The columns of one volume.
    fn of(&self, pressure: usize) -> &[(usize, f64)] {
        let before: usize = self.fixed[..pressure].iter().map(|(_, count)| count).sum();
        &self.columns[before..before + self.fixed[pressure].1]
    }
}

impl Pressures {
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        pressures: &[PressureDescription],
    ) -> Result<Self, ModelError> {
        let mut built = vec![];
        for pressure in pressures {
            let field = |f: &str| format!("pressures.{}.{f}", pressure.name);
            let rod = tree.rod(&field("rod"), &pressure.rod)?;
            let points = tree.rods[rod].gauss.len();
            for (what, found) in [
                ("of_gauss", pressure.of_gauss.len()),
                ("share", pressure.share.len()),
                ("enclosed", pressure.enclosed.len()),
            ] {
                if found != points {
                    let problem = format!("found {found} values, the rod has {points} Gauss points");
                    return Err(ModelError::new(field(what), problem));
                }
            }
            if pressure.of_gauss.iter().any(|i| *i >= pressure.sections.len()) {
                return Err(ModelError::new(field("of_gauss"), "there are fewer sections"));
            }
            finite(field("sections"), pressure.sections.as_flattened())?;
            finite(field("share"), &pressure.share)?;
            finite(field("enclosed"), &pressure.enclosed)?;
            let named = |(i, section)| tree.slot(format!("{}.moments[{i}]", pressure.name), None, section);
            let sections = pressure.sections.iter().map(|s| &s[..]).enumerate().map(named).collect();
            let share = tree.slot(format!("{}.share", pressure.name), None, &pressure.share);
            let enclosed = tree.slot(format!("{}.enclosed", pressure.name), "m^3", &pressure.enclosed);
            let input = tree.input(&pressure.name);
            built.push(Pressure {
                rod,
                input,
                sections,
                of_gauss: pressure.of_gauss.clone(),
                share,
                enclosed,
            });
        }
        Ok(Self(built))
    }

    /// Volume of each cavity [m³].
    pub fn volumes(&self, q: &[f64], volumes: &Volumes, out: &mut [f64]) {
        let mut columns = volumes.columns.iter();
        for (out, (fixed, count)) in out.iter_mut().zip(&volumes.fixed) {
            *out = columns.by_ref().take(*count).fold(*fixed, |sum, (dof, size)| sum + size * q[*dof]);
        }
    }

    /// The volume of one cavity in the reference state [m³].
    pub fn reference(pressure: usize, volumes: &Volumes) -> f64 {
        volumes.fixed[pressure].0
    }

    /// Change of the volume of one cavity from the reference state [m³].
    pub fn change_of_volume(&self, pressure: usize, q: &[f64], volumes: &Volumes) -> f64 {
        volumes.of(pressure).iter().map(|(dof, size)| size * q[*dof]).sum()
    }

    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Adds the derivative of `factor` times the work of one volume's gradient on a motion; for the motion
    /// from the reference state, this is the derivative of the change of volume.
    pub fn add_parameter_work_of<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        pressure: usize,
        tree: &Tree<G, D, P>,
        p: &[f64],
        motion: &[f64],
        factor: f64,
        gradient: &mut [f64],
    ) {
        let pressure = &self.0[pressure];
        let rod = &tree.rods[pressure.rod];
        let length = p[rod.length];
        for (g, gauss) in rod.gauss.iter().enumerate() {
            let radius = rod.radius.start + gauss.point;
            let slot = pressure.sections[pressure.of_gauss[g]].clone();
            let s = p[radius];
            let moments = Moments::new(&p[slot.clone()], s);
            // Work by area and by moments.
            let mut work = [0.0; 3];
            let (weight, share) = (factor * gauss.weight, p[pressure.share.start + g]);
            for (dof, mode, phi) in &gauss.columns {
                let moved = weight * phi * motion[*dof];
                match mode {
                    1 => work[2] += moved,
                    2 => work[1] -= moved,
                    3 => {
                        work[0] += moved * length;
                        gradient[rod.length] += share * moved * moments.value[0];
                    }
                    _ => {}
                }
            }
            gradient[pressure.share.start + g] += dot(&work, &moments.value);
            add_of_moments(work.map(|each| share * each), &moments, s, radius, slot, gradient);
        }
    }

    /// Adds a multiple of the change of one volume.
    pub fn add_volume<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
        volumes: &Volumes,
        factor: f64,
        out: &mut Differential<D, P>,
    ) {
        let (p, pressure) = (at.parameters(), &self.0[index]);
        for (dof, size) in volumes.of(index) {
            out.coordinates[*dof] += factor * size;
        }
        self.add_parameter_work_of(index, at.tree, p, at.q, factor, &mut out.parameters);
        let rod = &at.tree.rods[pressure.rod];
        for (g, gauss) in rod.gauss.iter().enumerate() {
            let radius = rod.radius.start + gauss.point;
            let slot = pressure.sections[pressure.of_gauss[g]].clone();
            let (s, weight) = (p[radius], factor * gauss.weight);
            let (share, enclosed) = (pressure.share.start + g, pressure.enclosed.start + g);
            let moments = Moments::new(&p[slot.clone()], s);
            let strain = &p[rod.reference_strain.clone()];
            let by_moments = [weight * strain[3], -weight * strain[2], weight * strain[1]];
            let by_length = dot(&by_moments, &moments.value);
            out.parameters[rod.length] += p[share] * by_length;
            for mode in 0..6 {
                let size = by_mode(moments.value, mode).map_or(0.0, |(size, _)| size);
                out.parameters[rod.reference_strain.start + mode] += weight * p[share] * p[rod.length] * size;
            }
            out.parameters[share] += by_length * p[rod.length] - factor * p[enclosed];
            out.parameters[enclosed] -= factor * p[share];
            let work = by_moments.map(|work| work * p[share] * p[rod.length]);
            add_of_moments(work, &moments, s, radius, slot, &mut out.parameters);
        }
    }

    /// Visits the columns of each pressure's volume.
    #[inline]
    fn for_each_column(&self, volumes: &Volumes, mut visit: impl FnMut(&Pressure, usize, f64)) {
        let mut columns = volumes.columns.iter();
        for (pressure, (_, count)) in self.0.iter().zip(&volumes.fixed) {
            columns.by_ref().take(*count).for_each(|(dof, size)| visit(pressure, *dof, *size));
        }
    }
}

impl<const P: usize> ForceMemory<P> for Pressures {
    type Design = Volumes;
    type State = ();
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Pressures {
    fn design(&self, _: &Tree<G, D, P>) -> Volumes {
        Volumes::default()
    }

    fn state(&self, _: &Tree<G, D, P>) {}

    fn update_design(&self, tree: &Tree<G, D, P>, geometry: &Geometry<G, D, P>, volumes: &mut Volumes) {
        let p = &geometry.parameters;
        volumes.fixed.clear();
        volumes.columns.clear();
        for pressure in &self.0 {
            let rod = &tree.rods[pressure.rod];
            let length = p[rod.length];
            let first = volumes.columns.len();
            volumes.columns.extend(rod.dofs.clone().map(|dof| (dof, 0.0)));
            let (shares, enclosed) = (&p[pressure.share.clone()], &p[pressure.enclosed.clone()]);
            let mut fixed = -dot(shares, enclosed);
            for (g, gauss) in rod.gauss.iter().enumerate() {
                let s = p[rod.radius.start + gauss.point];
                let moments = Moments::new(&p[pressure.sections[pressure.of_gauss[g]].clone()], s).value;
                let weight = gauss.weight * shares[g];
                for (mode, strain) in p[rod.reference_strain.clone()].iter().enumerate() {
                    fixed += by_mode(moments, mode).map_or(0.0, |(size, _)| weight * length * size * strain);
                }
                for (dof, mode, phi) in &gauss.columns {
                    if let Some((size, power)) = by_mode(moments, *mode) {
                        volumes.columns[first + dof - rod.dofs.start].1 +=
                            weight * phi * size * length.powi(power);
                    }
                }
            }
            volumes.fixed.push((fixed, rod.dofs.len()));
        }
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        volumes: &Volumes,
        _: &mut (),
        Terms { coordinates: out, .. }: &mut Terms<D>,
    ) {
        for (pressure, (fixed, _)) in self.0.iter().zip(&volumes.fixed) {
            out.energy -= at.load[pressure.input] * fixed;
        }
        self.for_each_column(volumes, |pressure, dof, size| {
            let force = at.load[pressure.input] * size;
            out.gradient[dof] -= force;
            out.energy -= force * at.q[dof];
        });
    }

    fn add_tangent(&self, _: &State<G, D, P>, _: &Volumes, _: &(), _: &mut Terms<D>) {}

    fn add_magnitudes(&self, at: &State<G, D, P>, volumes: &Volumes, _: &(), out: &mut Magnitudes<P>) {
        self.for_each_column(volumes, |pressure, dof, size| out.add(dof, at.load[pressure.input] * size));
    }

    fn add_load_derivative(
        &self,
        _: &State<G, D, P>,
        volumes: &Volumes,
        change: &[f64],
        out: &mut [f64],
        _: &impl Fn(usize, &Vector<D>, &mut [f64]),
    ) {
        self.for_each_column(volumes, |pressure, dof, size| out[dof] -= change[pressure.input] * size);
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &Volumes,
        _: &(),
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        for (index, pressure) in self.0.iter().enumerate() {
            let factor = -at.load[pressure.input];
            self.add_parameter_work_of(index, at.tree, at.parameters(), motion.coordinates, factor, gradient);
        }
    }
}
