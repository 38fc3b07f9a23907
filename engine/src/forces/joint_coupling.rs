//! Joints that move together, as those of a finger's end do: `½ k (θ₂ − r θ₁ − θ₀)²`.

use super::element::{ForceElement, ForceMemory, VirtualMotion};
use super::magnitudes::Magnitudes;
use super::state::State;
use super::terms::Terms;
use crate::geometry::Geometry;
use crate::lie::LieGroup;
use crate::tree::{ModelError, Tree, finite, not_negative};
use serde::Deserialize;

/// A spring between the coordinates of two joints.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointCouplingDescription {
    /// Unique name.
    pub name: String,
    /// The bodies with the joints that lead and follow.
    pub bodies: [String; 2],
    /// Their coordinates, such as `theta`.
    pub coordinates: [String; 2],
    /// r.
    pub ratio: f64,
    /// θ₀ [rad or m].
    pub offset: f64,
    /// k [N·m/rad or N/m].
    pub stiffness: f64,
}

#[derive(Clone, Debug, PartialEq)]
struct JointCoupling {
    first: usize,
    second: usize,
    /// Parameters: r, θ₀ and k.
    ratio: usize,
    offset: usize,
    stiffness: usize,
}

impl JointCoupling {
    /// r, k and the difference θ₂ − r θ₁ − θ₀.
    fn difference(&self, p: &[f64], q: &[f64]) -> [f64; 3] {
        let (ratio, stiffness) = (p[self.ratio], p[self.stiffness]);
        [ratio, stiffness, q[self.second] - ratio * q[self.first] - p[self.offset]]
    }
}

/// All couplings of joints.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JointCouplings(Vec<JointCoupling>);

impl JointCouplings {
    pub fn build<G: LieGroup<D, P>, const D: usize, const P: usize>(
        tree: &mut Tree<G, D, P>,
        couplings: &[JointCouplingDescription],
    ) -> Result<Self, ModelError> {
        let mut built = vec![];
        for coupling in couplings {
            let field = |f: &str| format!("couplings.{}.{f}", coupling.name);
            let [first, second] = [0, 1].map(|end| {
                tree.joint_coordinate(&field("bodies"), &coupling.bodies[end], &coupling.coordinates[end])
            });
            let (first, second) = (first?, second?);
            if first == second {
                return Err(ModelError::new(field("bodies"), "are one and the same joint"));
            }
            finite(field("ratio"), &[coupling.ratio, coupling.offset])?;
            not_negative(field("stiffness"), coupling.stiffness)?;
            let mut slot =
                |what: &str, value: f64| tree.slot(format!("{}.{what}", coupling.name), None, &[value]).start;
            built.push(JointCoupling {
                first,
                second,
                ratio: slot("ratio", coupling.ratio),
                offset: slot("offset", coupling.offset),
                stiffness: slot("stiffness", coupling.stiffness),
            });
        }
        Ok(Self(built))
    }
}

impl<const P: usize> ForceMemory<P> for JointCouplings {
    type Design = ();
    type State = ();
    type Sensitivity = ();
}

impl<G: LieGroup<D, P>, const D: usize, const P: usize> ForceElement<G, D, P> for JointCouplings {
    fn design(&self, _: &Tree<G, D, P>) {}

    fn state(&self, _: &Tree<G, D, P>) {}

    fn add_elastic_stiffness(
        &self,
        _: &Tree<G, D, P>,
        geometry: &Geometry<G, D, P>,
        _: &(),
        stiffness: &mut [f64],
    ) {
        for coupling in &self.0 {
            let [ratio, k] = [coupling.ratio, coupling.stiffness].map(|i| geometry.parameters[i]);
            stiffness[coupling.first] += k * ratio * ratio;
            stiffness[coupling.second] += k;
        }
    }

    fn add_residual(
        &self,
        at: &State<G, D, P>,
        _: &(),
        _: &mut (),
        Terms { coordinates: out, .. }: &mut Terms<D>,
    ) {
        for coupling in &self.0 {
            let [ratio, k, difference] = coupling.difference(at.parameters(), at.q);
            out.energy += 0.5 * k * difference * difference;
            out.gradient[coupling.first] -= k * ratio * difference;
            out.gradient[coupling.second] += k * difference;
        }
    }

    fn add_tangent(&self, at: &State<G, D, P>, _: &(), _: &(), out: &mut Terms<D>) {
        for coupling in &self.0 {
            let [ratio, k] = [coupling.ratio, coupling.stiffness].map(|i| at.parameters()[i]);
            let (i, j) = (coupling.first.min(coupling.second), coupling.first.max(coupling.second));
            out.coordinates.add_diagonal(coupling.first, k * ratio * ratio);
            out.coordinates.add_diagonal(coupling.second, k);
            out.coordinates.add_stiffness(i, j, -k * ratio);
        }
    }

    fn add_magnitudes(&self, at: &State<G, D, P>, _: &(), _: &(), out: &mut Magnitudes<P>) {
        for coupling in &self.0 {
            let [ratio, k] = [coupling.ratio, coupling.stiffness].map(|i| at.parameters()[i]);
            // Its two angles may be large and nearly cancel.
            for angle in [ratio * at.q[coupling.first], at.q[coupling.second]] {
                out.add(coupling.first, k * ratio * angle);
                out.add(coupling.second, k * angle);
            }
        }
    }

    fn is_admissible(&self, parameters: &[f64]) -> bool {
        self.0.iter().all(|coupling| {
            parameters[coupling.stiffness] >= 0.0
                && [coupling.ratio, coupling.offset].iter().all(|i| parameters[*i].is_finite())
        })
    }

    fn add_parameter_work(
        &self,
        at: &State<G, D, P>,
        _: &(),
        _: &(),
        _: &(),
        motion: &VirtualMotion<D, P>,
        gradient: &mut [f64],
    ) {
        for coupling in &self.0 {
            let [ratio, k, difference] = coupling.difference(at.parameters(), at.q);
            let (one, two) = (motion.coordinates[coupling.first], motion.coordinates[coupling.second]);
            let along = two - ratio * one;
            gradient[coupling.stiffness] += difference * along;
            gradient[coupling.offset] -= k * along;
            gradient[coupling.ratio] -= k * (at.q[coupling.first] * along + difference * one);
        }
    }
}
