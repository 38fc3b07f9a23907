//! Chambers and cables: −u ℓ(q), with ℓ the length of a path in the rod's cross-sections.
//!
//! The gradient of ℓ is the actuation matrix B(q) of (9): at each Gauss point the unit tangent
//! τ̂ of the path, τ = ξ_lin + ξ_ang × d + d′ in normalised strains.

mod path;

use super::element::{ForceElement, ForceMemory, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::state::State;
use super::terms::Terms;
use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::linalg::Vector;
use crate::strain::Mode;
use crate::tree::{GaussPoint, ModelError, Rod, Tree, finite};
pub(crate) use path::Paths;
use path::{
    Actuator, PathColumn, PathPoint, add_strain, add_tangent_of, dot, tangent_by_offset, tangent_of,
    unit_tangent,
};
use serde::Deserialize;

/// The effect of a positive input of a thread-like actuator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ActuatorKind {
    /// Pushes its ends apart.
    Chamber,
    /// Pulls its ends together.
    Cable,
}

/// A thread-like actuator at the local offset `path(X) + lever · S(X)` in a rod's cross-sections.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ActuatorDescription {
    /// Unique name, also that of its load input unless it shares one.
    pub name: String,
    /// Chamber or cable.
    pub kind: ActuatorKind,
    /// The rod.
    pub rod: String,
    /// Offset (y, z) at the sample points [m].
    pub path: Vec<[f64; 2]>,
    /// Its derivative with respect to X ∈ [0, 1] [m].
    pub path_slope: Vec<[f64; 2]>,
    /// Multiple of S(X) added to the offset (y, z).
    pub lever: [f64; 2],
}

/// All chambers and cables.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Actuators(Vec<Actuator>);

impl Actuators {
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        actuators: &[ActuatorDescription],
    ) -> Result<Self, ModelError> {
        let mut built = vec![];
        for actuator in actuators {
            let field = |f: &str| format!("actuators.{}.{f}", actuator.name);
            let rod = tree.rod(&field("rod"), &actuator.rod)?;
            let needed = tree.rods[rod].x.len();
            for (what, list) in [("path", &actuator.path), ("path_slope", &actuator.path_slope)] {
                if list.len() != needed {
                    let problem = format!("found {} values, the rod has {needed} sample points", list.len());
                    return Err(ModelError::new(field(what), problem));
                }
                finite(field(what), list.as_flattened())?;
            }
            finite(field("lever"), &actuator.lever)?;
            let at = |gauss: &GaussPoint| [actuator.path[gauss.point], actuator.path_slope[gauss.point]];
            let path: Vec<[[f64; 2]; 2]> = tree.rods[rod].gauss.iter().map(at).collect();
            let path = tree.slot(format!("{}.path", actuator.name), "m", path.as_flattened().as_flattened());
            let routing = path.step_by(4).collect();
            let lever = tree.slot(format!("{}.lever", actuator.name), "m", &actuator.lever).start;
            let sign = if actuator.kind == ActuatorKind::Chamber { 1.0 } else { -1.0 };
            let input = tree.input(&actuator.name);
            built.push(Actuator { rod, input, sign, lever, routing });
        }
        Ok(Self(built))
    }

    /// Length of each actuator's path.
    pub fn lengths(&self, q: &[f64], paths: &Paths) -> Vec<f64> {
        let mut lengths = vec![0.0; self.0.len()];
        self.conjugates(q, paths, &mut lengths);
        lengths.iter_mut().for_each(|length| *length = length.abs());
        lengths
    }

    /// What each input multiplies: the length of a chamber's path, and minus that of a cable's.
    pub fn conjugates(&self, q: &[f64], paths: &Paths, out: &mut [f64]) {
        out.fill(0.0);
        self.for_each_point(q, paths, |actuator, weight, _, norm, _| {
            out[actuator] += self.0[actuator].sign * weight * norm;
        });
    }

    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Adds the derivative of `factor` times one of these with respect to the parameters.
    pub fn add_parameters_of_conjugate<G: LieGroup<D, P>, const D: usize, const P: usize>(
        &self,
        actuator: usize,
        tree: &Tree<G, D, P>,
        p: &[f64],
        q: &[f64],
        factor: f64,
        gradient: &mut [f64],
    ) {
        let actuator = &self.0[actuator];
        let rod = &tree.rods[actuator.rod];
        for (routing, gauss) in actuator.routing.iter().copied().zip(&rod.gauss) {
            let path = actuator.path(rod, gauss, routing, p);
            let point = PointSensitivity::of::<G, D, P>(rod, gauss, path, p, q);
            let weight = factor * actuator.sign * gauss.weight;
            let by_offset = point.by_offset.map(|by| weight * dot(&point.unit, &by));
            let by_slope = [1, 2].map(|i| weight * point.unit[i]);
            actuator.add_by_path(rod, gauss, routing, p, [by_offset, by_slope], gradient);
            gradient[rod.length] += weight * dot(&point.unit, &point.by_length);
            for mode in G::AXES {
                let tau = by_strain::<G, D, P>(mode, point.offset);
                gradient[rod.reference_strain.start + mode.index()] +=
                    weight * p[rod.length] * dot(&point.unit, &tau);
            }
        }
    }

    /// Visits each Gauss point of each actuator with (actuator, weight, τ̂, |τ|, columns along each axis).
    #[inline]
    fn for_each_point(
        &self,
        q: &[f64],
        paths: &Paths,
        mut visit: impl FnMut(usize, f64, [f64; 3], f64, [&[PathColumn]; 3]),
    ) {
        let (mut point, mut start) = (0, 0);
        for (index, actuator) in self.0.iter().enumerate() {
            for path in &paths.points[point..point + actuator.routing.len()] {
                let columns = path.ends.map(|end| &paths.columns[std::mem::replace(&mut start, end)..end]);
                let mut tau = path.base;
                for (tau, columns) in tau.iter_mut().zip(columns) {
                    columns.iter().for_each(|column| *tau += q[column.dof] * column.size);
                }
                let (unit, norm) = unit_tangent(tau, path.base);
                visit(index, path.weight, unit, norm, columns);
            }
            point += actuator.routing.len();
        }
    }
}

/// Intermediate results of the residual that the tangent reuses.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tangents {
    /// Tension by |τ| of each Gauss point.
    curvature: Vec<f64>,
    /// The part of each point's unit tangent along each of its columns.
    along: Vec<f64>,
}

/// A Gauss point in the current state.
#[derive(Clone, Debug)]
pub(crate) struct PointSensitivity {
    /// (y, z) of the path in the cross-section.
    offset: [f64; 2],
    /// τ̂ and |τ|.
    unit: [f64; 3],
    norm: f64,
    /// −u w.
    tension: f64,
    /// Derivatives of τ with respect to the offset and to L.
    by_offset: [[f64; 3]; 2],
    by_length: [f64; 3],
}

impl PointSensitivity {
    /// At the coordinates `q`, without tension.
    fn of<G: LieGroup<D, P>, const D: usize, const P: usize>(
        rod: &Rod,
        gauss: &GaussPoint,
        [offset, path_slope]: [[f64; 2]; 2],
        p: &[f64],
        q: &[f64],
    ) -> Self {
        let length = p[rod.length];
        // Normalised strains of the state, mode by mode.
        let mut strain = [0.0; 6];
        for mode in G::AXES {
            strain[mode.index()] = length * p[rod.reference_strain.start + mode.index()];
        }
        add_strain(&mut strain, &gauss.columns, length, q);
        let mut tau = tangent_of::<G, D, P>(&strain, offset);
        for i in 0..2 {
            tau[i + 1] += path_slope[i];
        }
        let (unit, norm) = unit_tangent(tau, reference_tangent(rod, p, [offset, path_slope]));
        let by_offset = tangent_by_offset::<G, D, P>(&strain);
        // L scales linear strains and the whole reference strain.
        for mode in G::AXES {
            let m = mode.index();
            let reference = p[rod.reference_strain.start + m];
            strain[m] = if mode.is_angular() { reference } else { strain[m] / length };
        }
        let by_length = tangent_of::<G, D, P>(&strain, offset);
        Self { offset, unit, norm, tension: 0.0, by_offset, by_length }
    }
}

/// The derivative of τ with respect to the strain of a mode.
fn by_strain<G: LieGroup<D, P>, const D: usize, const P: usize>(mode: Mode, offset: [f64; 2]) -> [f64; 3] {
    let mut strain = [0.0; 6];
    strain[mode.index()] = 1.0;
    tangent_of::<G, D, P>(&strain, offset)
}

/// τ of a path, given by its offset and slope, in the reference state.
fn reference_tangent(rod: &Rod, p: &[f64], [offset, slope]: [[f64; 2]; 2]) -> [f64; 3] {
    let mut tau = [0.0, slope[0], slope[1]];
    let strain = std::array::from_fn(|mode| p[rod.length] * p[rod.reference_strain.start + mode]);
    add_tangent_of(&strain, &Mode::ALL, offset, &mut tau);
    tau
}

impl<const P: usize> ForceMemory<P> for Actuators {
    type Design = Paths;
    type State = Tangents;
    type Sensitivity = Vec<PointSensitivity>;
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for Actuators {
    fn design(&self, _: &Tree<G, D, P>) -> Paths {
        Paths::default()
    }

    fn state(&self, _: &Tree<G, D, P>) -> Tangents {
        Tangents::default()
    }

    fn update_design(&self, tree: &Tree<G, D, P>, geometry: &Geometry<G, D, P>, paths: &mut Paths) {
        let p = &geometry.parameters;
        paths.clear();
        for actuator in &self.0 {
            let rod = &tree.rods[actuator.rod];
            let length = p[rod.length];
            for (routing, gauss) in actuator.routing.iter().zip(&rod.gauss) {
                let [d, slope] = actuator.path(rod, gauss, *routing, p);
                let base = reference_tangent(rod, p, [d, slope]);
                let ends = paths.push_columns(gauss, length, d, tree.dof);
                paths.points.push(PathPoint { base, weight: gauss.weight, ends });
            }
        }
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        paths: &Paths,
        state: &mut Tangents,
        Terms { coordinates: out, .. }: &mut Terms<D>,
    ) {
        let Tangents { curvature, along } = state;
        curvature.resize(paths.points.len(), 0.0);
        along.resize(paths.columns.len(), 0.0);
        let (mut curvature, mut along) = (curvature.iter_mut(), along.iter_mut());
        self.for_each_point(at.q, paths, |actuator, weight, unit, norm, columns| {
            let tension = -self.0[actuator].sign * at.load[self.0[actuator].input] * weight;
            out.energy += tension * norm;
            if let Some(curvature) = curvature.next() {
                *curvature = tension / norm;
            }
            for (unit, columns) in unit.iter().zip(columns) {
                for (column, along) in columns.iter().zip(along.by_ref()) {
                    *along = unit * column.size;
                    out.gradient[column.dof] += tension * *along;
                }
            }
        });
    }

    fn add_tangent(&self, _: &State<G, D, P>, paths: &Paths, state: &Tangents, out: &mut Terms<D>) {
        let half_tangent = &mut out.coordinates.half_tangent;
        let mut pairs = paths.pairs.iter();
        let mut start = 0;
        for (point, curvature) in paths.points.iter().zip(&state.curvature) {
            let along = &state.along[start..point.ends[2]];
            start = point.ends[2];
            for (m, one) in along.iter().enumerate() {
                // (1 − τ̂τ̂ᵀ)/|τ|, projected on both columns.
                for (other, pair) in along.iter().zip(pairs.by_ref().take(m + 1)) {
                    half_tangent[pair.entry] += *curvature * pair.share * (pair.product - one * other);
                }
            }
        }
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, paths: &Paths, _: &Tangents, out: &mut Magnitudes<P>) {
        self.for_each_point(at.q, paths, |actuator, weight, _, _, columns| {
            for column in columns.into_iter().flatten() {
                out.add(column.dof, at.load[self.0[actuator].input] * weight * column.size);
            }
        });
    }

    /// `−Σ_a du_a ∂ℓ_a/∂q`.
    fn add_load_derivative(
        &self,
        at: &State<G, D, P>,
        paths: &Paths,
        change: &[f64],
        out: &mut [f64],
        _: &impl Fn(usize, &Vector<D>, &mut [f64]),
    ) {
        self.for_each_point(at.q, paths, |actuator, weight, unit, _, columns| {
            let tension = -self.0[actuator].sign * change[self.0[actuator].input] * weight;
            for (unit, columns) in unit.iter().zip(columns) {
                for column in columns {
                    out[column.dof] += tension * unit * column.size;
                }
            }
        });
    }

    fn update_sensitivity(
        &self,
        at: &State<G, D, P>,
        _: &Paths,
        _: &Tangents,
        _: &[bool],
        points: &mut Vec<PointSensitivity>,
    ) {
        points.clear();
        for actuator in &self.0 {
            let load = at.load[actuator.input];
            let rod = &at.tree.rods[actuator.rod];
            for (routing, gauss) in actuator.routing.iter().zip(&rod.gauss) {
                let path = actuator.path(rod, gauss, *routing, at.parameters());
                let mut point = PointSensitivity::of::<G, D, P>(rod, gauss, path, at.parameters(), at.q);
                point.tension = -actuator.sign * load * gauss.weight;
                points.push(point);
            }
        }
    }

    /// Derivatives of the path's tangent τ and its arms with respect to S, S′, the lever and L.
    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &Paths,
        _: &Tangents,
        points: &Vec<PointSensitivity>,
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        let p = at.parameters();
        let mut points = points.iter();
        for actuator in &self.0 {
            let rod = &at.tree.rods[actuator.rod];
            let length = p[rod.length];
            let routing = actuator.routing.iter().copied();
            for ((gauss, routing), point) in rod.gauss.iter().zip(routing).zip(points.by_ref()) {
                let PointSensitivity { offset, unit, norm, tension, by_offset, by_length } = point;
                let mut strain = [0.0; 6];
                add_strain(&mut strain, &gauss.columns, length, motion.coordinates);
                let v = tangent_of::<G, D, P>(&strain, *offset);
                let v_by_offset = tangent_by_offset::<G, D, P>(&strain);
                // d(τ̂·v) for a change (dτ, dv).
                let work = |dtau: [f64; 3], dv: [f64; 3]| {
                    tension * ((dot(&dtau, &v) - dot(&dtau, unit) * dot(unit, &v)) / norm + dot(unit, &dv))
                };
                let by_offset = [0, 1].map(|i| work(by_offset[i], v_by_offset[i]));
                let by_slope = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|sideways| work(sideways, [0.0; 3]));
                actuator.add_by_path(rod, gauss, routing, p, [by_offset, by_slope], gradient);
                for mode in G::AXES {
                    let m = mode.index();
                    strain[m] = if mode.is_angular() { 0.0 } else { strain[m] / length };
                }
                gradient[rod.length] += work(*by_length, tangent_of::<G, D, P>(&strain, *offset));
                for mode in G::AXES {
                    let tau = by_strain::<G, D, P>(mode, *offset);
                    gradient[rod.reference_strain.start + mode.index()] += length * work(tau, [0.0; 3]);
                }
            }
        }
    }
}
