//! Units of the coordinates, and of energy, from the stiffnesses and forces that act on them.
//!
//! With its own stiffness K, one unit of a coordinate, √(E/K), stores the energy E of one radian of the
//! softest angle that acts on the same bodies. An elastic model thus has the same path in these units
//! regardless of its size and modulus. Coordinates without elasticity are measured in radians or by the
//! length of the bodies; without any elasticity the energy is that of the forces at the start of a path.

use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::model::Model;
use crate::tolerances::{MIN_ELASTIC_STIFFNESS, MIN_ENERGY};
use crate::tree::Shape;

/// The natural unit of a coordinate, before stiffnesses are known.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Angle,
    Strain,
    Length,
}

/// Units of one design.
#[derive(Clone, Debug)]
pub(crate) struct Units {
    /// A coordinate is its dimensionless value times this times √`energy`.
    pub scale: Vec<f64>,
    /// The unit of energy [J], the smallest of `own_energy`.
    pub energy: f64,
    /// Energy E of the bodies that act on the same bodies as each coordinate.
    pub own_energy: Vec<f64>,
    /// Whether the coordinate is elastic.
    pub elastic: Vec<bool>,
    all_elastic: bool,
    /// Whether there are ties.
    in_loops: bool,
    /// One radian, a strain of one, or for a translation the length of the longest of these bodies.
    pub natural: Vec<f64>,
    /// Unit of a coordinate without elasticity: the natural one or, if that is shorter, the motion by which it
    /// moves the ends of a spring as far as the spring is long.
    local: Vec<f64>,
    kind: Vec<Kind>,
    /// Diagonal elastic stiffness of each coordinate; without elasticity, force by natural unit.
    pub stiffness: Vec<f64>,
}

impl Units {
    pub fn new<G: LieGroup<D, P>, const D: usize, const P: usize>(model: &Model<G, D, P>) -> Self {
        let n = model.dof();
        let mut kind = vec![Kind::Length; n];
        for rod in &model.rods {
            for (dof, angular) in rod.dofs.clone().zip(&rod.angular) {
                kind[dof] = if *angular { Kind::Angle } else { Kind::Strain };
            }
        }
        for joint in model.joints.iter().filter(|joint| joint.angular) {
            kind[joint.dof] = Kind::Angle;
        }
        Self {
            scale: vec![1.0; n],
            energy: 1.0,
            own_energy: vec![1.0; n],
            elastic: vec![false; n],
            all_elastic: false,
            in_loops: model.tie_count() > 0,
            natural: vec![1.0; n],
            local: vec![1.0; n],
            kind,
            stiffness: vec![0.0; n],
        }
    }

    /// Updates the units for a new design, whose stiffnesses `add_elastic` adds.
    pub fn update<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        geometry: &Geometry<G, D, P>,
        add_elastic: impl FnOnce(&mut [f64]),
    ) {
        self.stiffness.fill(0.0);
        add_elastic(&mut self.stiffness);
        let components = &model.components;
        for i in 0..self.natural.len() {
            self.natural[i] = 1.0;
            if self.kind[i] == Kind::Length {
                let bodies = model.bodies.iter().zip(&components.of_body);
                let beside = bodies.filter(|(_, of)| **of == components.of_coordinate[i]);
                let lengths = beside.map(|(body, _)| match &body.shape {
                    Shape::Rod(rod) => geometry.parameters[model.rods[*rod].length],
                    Shape::Link(link) => geometry.parameters[link.length],
                });
                self.natural[i] = lengths.fold(0.0, f64::max);
            }
        }
        for component in 0..components.count {
            let of = &components.of_coordinate;
            let angles = (0..of.len()).filter(|i| of[*i] == component && self.kind[*i] == Kind::Angle);
            let stiffest = angles.map(|i| self.stiffness[i]).fold(0.0, f64::max);
            for i in (0..of.len()).filter(|i| of[*i] == component) {
                let limit = if self.kind[i] == Kind::Angle { MIN_ELASTIC_STIFFNESS * stiffest } else { 0.0 };
                self.elastic[i] = self.stiffness[i] > limit;
            }
        }
        self.all_elastic = self.elastic.iter().all(|elastic| *elastic);
        self.local.copy_from_slice(&self.natural);
        self.set_scale(model);
    }

    /// Whether a coordinate is a length.
    pub fn is_length(&self, coordinate: usize) -> bool {
        self.kind[coordinate] == Kind::Length
    }

    /// The force that one natural unit of an elastic coordinate takes; zero of others.
    pub fn elastic_force(&self, coordinate: usize) -> f64 {
        if self.elastic[coordinate] { self.stiffness[coordinate] * self.natural[coordinate] } else { 0.0 }
    }

    /// Whether every coordinate is elastic.
    pub fn all_elastic(&self) -> bool {
        self.all_elastic
    }

    /// Sets the stiffness of coordinates without elasticity to the force per natural unit, or where there
    /// is none to the curvature, which in the presence of a stiff spring says little about large motions. By
    /// `reach` a coordinate moves the ends of a spring as far as the spring is long.
    pub fn measure<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        curvature: &[f64],
        force: &[f64],
        reach: &[f64],
    ) {
        for (local, (natural, reach)) in self.local.iter_mut().zip(self.natural.iter().zip(reach)) {
            *local = natural.min(*reach);
        }
        for i in (0..self.stiffness.len()).filter(|i| !self.elastic[*i]) {
            let by_force = force[i] / self.natural[i];
            self.stiffness[i] = if by_force > 0.0 { by_force } else { curvature[i] };
        }
        self.set_scale(model);
    }

    /// Energies and scales from the stiffnesses.
    fn set_scale<G: LieGroup<D, P>, const D: usize, const P: usize>(&mut self, model: &Model<G, D, P>) {
        let of_coordinate = &model.components.of_coordinate;
        self.energy = f64::INFINITY;
        for component in 0..model.components.count {
            let kinds = [Kind::Angle, Kind::Strain, Kind::Length];
            let found =
                kinds.into_iter().find_map(|kind| self.smallest_energy(of_coordinate, component, kind));
            for (own, of) in self.own_energy.iter_mut().zip(of_coordinate) {
                if *of == component {
                    *own = found.unwrap_or(f64::INFINITY);
                }
            }
            self.energy = self.energy.min(found.unwrap_or(f64::INFINITY));
        }
        if !self.energy.is_finite() {
            self.energy = 1.0;
        }
        for i in 0..self.scale.len() {
            if !self.own_energy[i].is_finite() {
                self.own_energy[i] = self.energy;
            }
            let by_stiffness = (self.own_energy[i] / self.energy).sqrt() / self.stiffness[i].sqrt();
            let local = self.local[i] / self.energy.sqrt();
            self.scale[i] = if self.elastic[i] { by_stiffness } else { local };
        }
    }

    /// The smallest energy of a natural unit of one kind of coordinate, if a component has any with
    /// stiffness.
    fn smallest_energy(&self, of_coordinate: &[usize], component: usize, kind: Kind) -> Option<f64> {
        let (mut elastic, mut other, mut largest) = (f64::INFINITY, f64::INFINITY, 0.0f64);
        for (i, of) in of_coordinate.iter().enumerate() {
            if *of != component || self.kind[i] != kind || !(self.stiffness[i] > 0.0) {
                continue;
            }
            let energy = self.stiffness[i] * self.natural[i] * self.natural[i];
            let least = if self.elastic[i] { &mut elastic } else { &mut other };
            *least = least.min(energy);
            largest = largest.max(energy);
        }
        // In a loop a body that has no stiffness of its own moves with those that have.
        let own = elastic.is_infinite() || !self.in_loops;
        let smallest = if own { elastic.min(other.max(MIN_ENERGY * largest)) } else { elastic };
        smallest.is_finite().then_some(smallest)
    }
}
