//! What tendons report: lengths, tensions, moment arms and paths.

use super::{Course, Tendons, Wrap};
use crate::forces::differential::Differential;
use crate::forces::state::State;
use crate::lie::LieGroup;
use crate::linalg::Vector;

impl<const P: usize> Tendons<P> {
    /// Length of each tendon [m].
    pub fn lengths<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>) -> Vec<f64> {
        self.tendons.iter().map(|tendon| self.length(at, tendon)).collect()
    }

    /// Tension of each tendon [N].
    pub fn tensions<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>) -> Vec<f64> {
        self.tendons.iter().map(|tendon| self.pull(at, tendon).tension).collect()
    }

    /// −∂ℓ/∂q of each tendon by each coordinate: of an angle the moment arm, positive where the tendon
    /// increases it.
    pub fn arms<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>) -> Vec<f64> {
        let n = at.tree.dof;
        let mut arms = vec![0.0; n * self.tendons.len()];
        for (tendon, arms) in self.tendons.iter().zip(arms.chunks_mut(n.max(1))) {
            for &frame in &tendon.frames {
                let wrench = self.wrench(at, tendon, frame) * -1.0;
                at.kinematics.add_generalised_force(at.tree, at.geometry, frame, &wrench, arms);
            }
        }
        arms
    }

    /// Adds a multiple of the change of the length of one tendon.
    pub fn add_length<G: LieGroup<D, P>, const D: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        for leg in &self.tendons[index].legs {
            let weight = weight / leg.divisor;
            match self.course(at, leg) {
                Course::Free(_, along) => {
                    out.points.push((leg.points[0], along * weight));
                    out.points.push((leg.points[1], along * -weight));
                }
                Course::Wrapped(around) => {
                    let Some((wrap, _)) = leg.wrap else { continue };
                    let Wrap { point: centre, frame, radius, .. } = self.wraps[wrap];
                    let mut turning = Vector::<D>::ZERO;
                    for (point, slope) in leg.points.into_iter().zip(around.gradient) {
                        let slope = slope * weight;
                        out.points.push((point, slope));
                        out.points.push((centre, -slope));
                        let arm = *at.point(point) - *at.point(centre);
                        let turned = G::point_jacobian(&arm) - G::point_jacobian(&Vector::ZERO);
                        turning += turned.transpose_times(&slope) * -1.0;
                    }
                    out.frames.push((frame, turning));
                    out.parameters[radius] += around.by_radius * weight;
                }
            }
        }
    }

    /// Adds a multiple of the change of the tension of one tendon.
    pub fn add_tension<G: LieGroup<D, P>, const D: usize>(
        &self,
        index: usize,
        at: &State<G, D, P>,
        weight: f64,
        out: &mut Differential<D, P>,
    ) {
        let tendon = &self.tendons[index];
        let stiffness = self.pull(at, tendon).stiffness;
        if stiffness != 0.0 {
            self.add_length(index, at, weight * stiffness, out);
        }
        let length = self.length(at, tendon);
        out.loads
            .extend(tendon.tension.by_input(at.parameters(), length).map(|(i, slope)| (i, weight * slope)));
        tendon.tension.by_parameters(at.parameters(), at.load, length, |parameter, slope| {
            out.parameters[parameter] += weight * slope;
        });
    }

    /// Places along each tendon from end to end, in branches; arcs in short pieces.
    pub fn paths<G: LieGroup<D, P>, const D: usize>(&self, at: &State<G, D, P>) -> Vec<Vec<Vec<Vector<P>>>> {
        let of = |tendon: &super::Tendon| {
            let mut branches: Vec<Vec<Vector<P>>> = vec![];
            let mut last = None;
            for leg in &tendon.legs {
                let [a, b] = leg.points.map(|point| *at.point(point));
                if last != Some(leg.points[0]) {
                    branches.push(vec![a]);
                }
                last = Some(leg.points[1]);
                let Some(branch) = branches.last_mut() else { continue };
                if let (Some((wrap, _)), Course::Wrapped(around)) = (leg.wrap, self.course(at, leg)) {
                    let centre = *at.point(self.wraps[wrap].point);
                    around.trace(&(a - centre), |place| branch.push(place + centre));
                }
                branch.push(b);
            }
            branches
        };
        self.tendons.iter().map(of).collect()
    }
}
