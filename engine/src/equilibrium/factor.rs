//! The factorised tangent of a state, symmetric or not.

use super::general::GeneralFactor;
use super::projection::{ProjectedMatrix, Projection};
use super::semidefinite::SemidefiniteFactor;
use super::stability::Stability;
use crate::Data;
use crate::lie::LieGroup;
use crate::linalg::{ChainCholesky, Cholesky};
use crate::model::Model;

/// `S A S + λ` in factors.
#[derive(Clone, Debug, Default)]
pub(super) struct Factor<const D: usize> {
    cholesky: Cholesky,
    /// For a tangent in chain form, if the model has a long chain.
    chain: Option<ChainCholesky<D>>,
    /// Whether that was used last.
    chained: bool,
    /// For matrices that are only tested.
    tested: (Cholesky, Option<ChainCholesky<D>>),
    /// For loads without a potential, whose tangent is not symmetric.
    general: Option<GeneralFactor>,
    /// For the tangent of a step in which friction is renewed, which is not symmetric either.
    renewed: Option<GeneralFactor>,
    /// Whether adjoints are those of that tangent.
    adjoints_renewed: bool,
    /// For a tangent with null modes; allocated when one occurs.
    semidefinite: Option<Box<SemidefiniteFactor>>,
    /// Whether that is the current factor.
    is_semidefinite: bool,
    /// Of a model with ties, the matrix on the motions that these allow.
    projected: Option<Box<ProjectedMatrix>>,
    /// Whether that is the current matrix.
    is_projected: bool,
    /// Its null modes.
    null_modes: Vec<Vec<f64>>,
}

impl<const D: usize> Factor<D> {
    pub fn new<G: LieGroup<D, P>, const P: usize>(model: &Model<G, D, P>) -> Self {
        let n = model.dof();
        let general = (n > 0 && !model.is_conservative()).then(|| GeneralFactor::new(n));
        let chain = model.chain.as_ref().map(|c| ChainCholesky::new(&c.order, &c.starts));
        Self {
            cholesky: Cholesky::new(n),
            tested: (Cholesky::new(n), chain.clone()),
            chain,
            chained: false,
            general,
            renewed: (n > 0 && model.friction_count() > 0).then(|| GeneralFactor::new(n)),
            adjoints_renewed: false,
            semidefinite: None,
            is_semidefinite: false,
            projected: (model.tie_count() > 0).then(Box::default),
            is_projected: false,
            null_modes: vec![],
        }
    }

    /// Takes the current tangent for the next factors: with a projection, on the motions that ties allow.
    pub fn project<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        data: &Data<G, D, P>,
        projection: Option<&Projection>,
    ) {
        self.is_projected = false;
        if let (Some(projected), Some(projection)) = (&mut self.projected, projection) {
            projected.update(projection, data.tangent(), &data.design.units.scale);
            self.is_projected = true;
        }
    }

    /// The matrix on the motions that ties allow, if it is the current one.
    pub fn projected(&self) -> Option<&ProjectedMatrix> {
        self.projected.as_deref().filter(|_| self.is_projected)
    }

    /// The same, to be changed.
    pub fn projected_mut(&mut self) -> Option<&mut ProjectedMatrix> {
        self.projected.as_deref_mut().filter(|_| self.is_projected)
    }

    /// Whether the tangent is the second derivative of a potential.
    pub fn is_symmetric(&self) -> bool {
        self.general.is_none()
    }

    /// Exchanges the factor for loads without a potential; without one the tangent is taken to be symmetric.
    pub fn swap_general(&mut self, general: &mut Option<GeneralFactor>) {
        std::mem::swap(&mut self.general, general);
    }

    /// Factorises the current tangent, `S A S + shift`; `false` when it is not positive definite or,
    /// without a potential, when the determinant of `S A S` is not positive.
    pub fn factorise<G: LieGroup<D, P>, const P: usize>(&mut self, data: &Data<G, D, P>, shift: f64) -> bool {
        self.is_semidefinite = false;
        if let Some(projected) = self.projected.as_deref().filter(|_| self.is_projected) {
            self.chained = false;
            return match &mut self.general {
                Some(general) => general.factorise(&projected.free, &projected.ones, shift),
                None => self.cholesky.factorise(&projected.free, &projected.ones, shift),
            };
        }
        let (tangent, scale) = (data.tangent(), &data.design.units.scale);
        if let Some(general) = &mut self.general {
            return general.factorise(tangent, scale, shift);
        }
        let matrix = data.assembly.chain_matrix(scale);
        self.chained = matrix.is_some();
        match (&mut self.chain, matrix) {
            (Some(chain), Some(matrix)) => chain.factorise(matrix, shift),
            _ => self.cholesky.factorise(tangent, scale, shift),
        }
    }

    /// Whether all eigenvalues of the current tangent, which has a potential, exceed `slack`; its factor is kept.
    pub fn exceeds<G: LieGroup<D, P>, const P: usize>(&mut self, data: &Data<G, D, P>, slack: f64) -> bool {
        if self.is_semidefinite {
            return false;
        }
        let swap = |factor: &mut Self| {
            std::mem::swap(&mut factor.cholesky, &mut factor.tested.0);
            std::mem::swap(&mut factor.chain, &mut factor.tested.1);
        };
        swap(self);
        let definite = self.factorise(data, -slack);
        swap(self);
        definite
    }

    /// Factorises the current tangent as one that is not symmetric; whether its determinant is positive or, to
    /// rounding, zero.
    pub fn factorise_renewed<G: LieGroup<D, P>, const P: usize>(&mut self, data: &Data<G, D, P>) -> bool {
        let projected = self.projected.as_deref().filter(|_| self.is_projected);
        let Some(renewed) = &mut self.renewed else { return false };
        match projected {
            Some(projected) => renewed.factorise(&projected.free, &projected.ones, 0.0),
            None => renewed.factorise(data.tangent(), &data.design.units.scale, 0.0),
        }
    }

    /// Solves in place with that factor.
    pub fn solve_renewed(&self, b: &mut [f64]) {
        let Some(renewed) = &self.renewed else { return };
        match self.projected() {
            Some(projected) => projected.solve(b, |b| renewed.solve(b)),
            None => renewed.solve(b),
        }
    }

    /// The coordinate whose pivot vanished, to rounding, in the last factorisation.
    pub fn null_pivot(&self) -> Option<usize> {
        match (&self.general, self.chain()) {
            (Some(_), _) => None,
            (None, Some(chain)) => chain.null_pivot(),
            (None, None) => self.cholesky.null_pivot(),
        }
    }

    /// Factorises a complete, positive semidefinite tangent with some coordinates, among them `first`,
    /// pinned; `false` if it is not positive semidefinite to the rounding of the terms of its diagonal,
    /// whose magnitudes are `sizes`.
    pub fn factorise_semidefinite<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        data: &Data<G, D, P>,
        first: &[usize],
        sizes: &[f64],
    ) -> bool {
        let scale = &data.design.units.scale;
        let factor = self.semidefinite.get_or_insert_with(|| Box::new(SemidefiniteFactor::new(scale.len())));
        self.is_semidefinite = match self.projected.as_deref().filter(|_| self.is_projected) {
            Some(projected) => factor.factorise(&projected.free, &projected.ones, first, &[]),
            None => factor.factorise(data.tangent(), scale, first, sizes),
        };
        self.null_modes.clear();
        if let Some(projected) = self.projected.as_deref().filter(|_| self.is_projected) {
            self.null_modes.extend_from_slice(factor.null_modes());
            self.null_modes.iter_mut().for_each(|mode| projected.turn_back(mode));
        }
        self.is_semidefinite
    }

    /// The null modes, dimensionless.
    pub fn null_modes(&self) -> &[Vec<f64>] {
        match self.semidefinite() {
            Some(_) if self.is_projected => &self.null_modes,
            factor => factor.map_or(&[], SemidefiniteFactor::null_modes),
        }
    }

    /// Pinned coordinates; of a matrix on the motions that ties allow these are none of the model's.
    pub fn pinned(&self) -> &[usize] {
        self.semidefinite().filter(|_| !self.is_projected).map_or(&[], SemidefiniteFactor::pinned)
    }

    /// Whether there are null modes.
    pub fn is_singular(&self) -> bool {
        self.general.as_ref().map_or(self.is_semidefinite, GeneralFactor::is_singular)
    }

    /// The static stability of the tangent; overwrites its factor. Eigenvalues within `slack` of zero
    /// count as zero.
    pub fn stability<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        data: &Data<G, D, P>,
        slack: f64,
    ) -> Stability {
        if let Some(general) = &mut self.general {
            return match self.projected.as_deref().filter(|_| self.is_projected) {
                Some(projected) => general.stability(&projected.free, &projected.ones, slack),
                None => general.stability(data.tangent(), &data.design.units.scale, slack),
            };
        }
        if self.factorise(data, -slack) {
            Stability::Stable
        } else if self.factorise(data, slack) {
            Stability::Neutral
        } else {
            Stability::Unstable
        }
    }

    fn semidefinite(&self) -> Option<&SemidefiniteFactor> {
        self.semidefinite.as_deref().filter(|_| self.is_semidefinite)
    }

    /// The factor of the chain, if it is the current one.
    fn chain(&self) -> Option<&ChainCholesky<D>> {
        self.chain.as_ref().filter(|_| self.chained)
    }

    /// Solves in place.
    pub fn solve(&self, b: &mut [f64]) {
        match self.projected() {
            Some(projected) => projected.solve(b, |b| self.solve_matrix(b)),
            None => self.solve_matrix(b),
        }
    }

    fn solve_matrix(&self, b: &mut [f64]) {
        if let Some(factor) = self.semidefinite() {
            return factor.solve(b);
        }
        match (&self.general, self.chain()) {
            (Some(general), _) => general.solve(b),
            (None, Some(chain)) => chain.solve(b),
            (None, None) => self.cholesky.solve(b),
        }
    }

    /// Solves in place with a triangular factor L, L Lᵀ being the tangent, its rows in some order; with a projection,
    /// the tangent on the motions that ties allow.
    pub fn solve_lower(&self, b: &mut [f64]) {
        if let Some(projected) = self.projected() {
            projected.turn_free(b);
        }
        if let Some(factor) = self.semidefinite() {
            return factor.solve_lower(b);
        }
        match self.chain() {
            Some(chain) => chain.solve_lower(b),
            None => self.cholesky.solve_lower(b),
        }
    }

    /// Solves with the transposed matrix, in place.
    pub fn solve_transposed(&self, b: &mut [f64]) {
        match self.projected() {
            Some(projected) => projected.solve_transposed(b, |b| self.solve_matrix_transposed(b)),
            None => self.solve_matrix_transposed(b),
        }
    }

    /// Lets adjoints be those of the tangent with friction renewed from now on.
    pub fn solve_adjoints_renewed(&mut self) {
        self.adjoints_renewed = true;
    }

    fn solve_matrix_transposed(&self, b: &mut [f64]) {
        match self.unsymmetric() {
            None => self.solve_matrix(b),
            Some(general) => general.solve_transposed(b),
        }
    }

    /// Solves for the adjoint of an output, given its derivatives by the state and by the reactions of
    /// ties; see [`ProjectedMatrix::solve_adjoint`].
    pub fn solve_adjoint(&self, by_state: &mut [f64], by_reactions: &mut [f64]) {
        match self.projected() {
            Some(projected) => {
                projected.solve_adjoint(by_state, by_reactions, |b| self.solve_matrix_transposed(b));
            }
            None => self.solve_matrix_transposed(by_state),
        }
    }

    /// Ratio of the smallest to the largest pivot of the matrix of adjoints, if that is not symmetric.
    pub fn pivot_ratio(&self) -> Option<f64> {
        let matrix = self.unsymmetric()?;
        Some(if matrix.is_singular() { 0.0 } else { matrix.pivot_ratio() })
    }

    /// The matrix of adjoints, if it is not symmetric.
    fn unsymmetric(&self) -> Option<&GeneralFactor> {
        self.renewed.as_ref().filter(|_| self.adjoints_renewed).or(self.general.as_ref())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lie::{SE2, SE3};
    use crate::model::Description;
    use crate::strain::BasisKind;
    use crate::systems::{finger, refined, tendon_rod};
    use crate::trees::{BASES, SECTIONS, planar_tree, spatial_tree, with_round_cones};

    /// Compares the chain's factor with the dense one at several states; how often it could be used.
    fn compare<G: LieGroup<D, P>, const D: usize, const P: usize>(d: &Description) -> usize {
        let mut model = Model::<G, D, P>::new(d).unwrap();
        model.chain = crate::tree::Chain::of(&model.tree);
        let n = model.dof();
        let mut factor = Factor::new(&model);
        factor.general = None;
        let mut data = Data::new(&model);
        let load = vec![0.7; model.inputs().len()];
        let mut used = 0;
        for state in 0..6 {
            let wave = |i: usize| ((i + 1) as f64 * (1.3 + 0.37 * state as f64)).sin();
            let root = data.design.units.energy.sqrt();
            let q: Vec<f64> =
                (0..n).map(|i| 0.1 * state as f64 * wave(i) * data.design.units.scale[i] * root).collect();
            data.evaluate(&model, &q, &load);
            if data.assembly.chain_matrix(&data.design.units.scale).is_none() {
                continue;
            }
            used += 1;
            let mut plain = model.clone();
            plain.chain = None;
            let mut paired = Data::new(&plain);
            paired.evaluate(&plain, &q, &load);
            let most = paired.tangent().iter().fold(0.0f64, |m, a| m.max(a.abs()));
            for (m, (a, b)) in data.tangent().iter().zip(paired.tangent()).enumerate() {
                assert!((a - b).abs() < 1e-12 * most, "{a} {b} at {}, {} of {n}", m / n, m % n);
            }
            let scale = &data.design.units.scale;
            let entries = data.tangent().iter().enumerate();
            let exact = entries.map(|(m, a)| (a * scale[m / n] * scale[m % n]).powi(2)).sum::<f64>().sqrt();
            let found = data.assembly.chain_norm(&model, scale).unwrap();
            assert!((found - exact).abs() < 1e-9 * exact, "norm {found} {exact} of {n}");
            let mut dense = Cholesky::new(n);
            let mut verdicts = [0, 0];
            for k in 0..24 {
                let shift = 1e-3 * 2.0f64.powi(k);
                let definite = dense.factorise(data.tangent(), &data.design.units.scale, shift);
                assert_eq!(factor.factorise(&data, shift), definite, "shift {shift} of {n}");
                verdicts[usize::from(definite)] += 1;
                if !definite {
                    continue;
                }
                let b: Vec<f64> = (0..n).map(wave).collect();
                let (mut x, mut y, mut exact) = (b.clone(), b.clone(), b);
                dense.solve(&mut exact);
                factor.solve(&mut x);
                factor.solve_lower(&mut y);
                let size = exact.iter().fold(0.0f64, |m, e| m.max(e.abs()));
                for (x, e) in x.iter().zip(&exact) {
                    assert!((x - e).abs() < 1e-8 * size, "{x} {e} at shift {shift} of {n}");
                }
                let energy: f64 = (0..n).map(|i| wave(i) * exact[i]).sum();
                let of_lower: f64 = y.iter().map(|y| y * y).sum();
                assert!((of_lower - energy).abs() < 1e-8 * energy, "{of_lower} {energy}");
            }
            assert!(verdicts[1] > 3);
        }
        used
    }

    #[test]
    fn a_chain_has_the_factor_of_its_tangent() {
        assert_eq!(compare::<SE2, 3, 2>(&finger()), 6);
        assert_eq!(compare::<SE3, 6, 3>(&tendon_rod()), 6);
        for (i, basis) in BASES.into_iter().enumerate() {
            let nodal = i < 4;
            let section = SECTIONS[i % 3];
            let other = BASES[(i + usize::from(nodal)) % 4];
            let mut plane = planar_tree([basis, other, basis], section, 4, false);
            let mut space = spatial_tree([basis, basis, other, basis, basis, basis], section, 2, false);
            space.contacts.retain(|c| c.first != c.second);
            space.springs.retain(|s| !["s3", "s4", "s5"].contains(&s.name.as_str()));
            // A spring at a point between two frames of a rod moves with both.
            plane.springs.retain(|s| !["between", "to pad"].contains(&s.name.as_str()));
            let cones = with_round_cones(plane.clone());
            let used = [
                compare::<SE2, 3, 2>(&refined(plane, 5)),
                compare::<SE2, 3, 2>(&refined(cones, 4)),
                compare::<SE3, 6, 3>(&refined(space, 4)),
            ];
            assert_eq!(used.map(|u| u > 0), [nodal; 3], "{basis:?} {used:?}");
        }
    }

    #[test]
    fn a_rod_that_touches_itself_is_no_chain() {
        let tree = spatial_tree([BasisKind::NodalLinear; 6], SECTIONS[0], 4, false);
        assert_eq!(compare::<SE3, 6, 3>(&refined(tree, 4)), 0);
    }
}
