//! Π, its gradient and its Hessian at a state: potentials on frames carried back to coordinates.
//!
//! With world twists the columns of a chain simply add, exp(Σ ζ_i + ½ Σ_{i<j} [ζ_i, ζ_j] + …), so
//! for coordinates i before j the second derivative is S_iᵀ (H̄_j + ½ M(w̄_j)) S_j, with w̄_j and H̄_j
//! the sums of wrenches and stiffness forms over all frames that j carries. A frame's own block adds
//! the curvature of its exponential and, on rods, that of the Magnus commutator.

use crate::design::Design;
use crate::kinematics::Kinematics;
use crate::lie::LieGroup;
use crate::linalg::{Matrix, Vector};
use crate::model::{JointColumn, Model, Motion};
use crate::potential::{self, CoordinateTerms, FrameTerms};

/// Workspace of the assembly.
#[derive(Clone, Debug)]
pub(crate) struct Assembly<const D: usize> {
    pub coordinates: CoordinateTerms,
    pub frames: FrameTerms<D>,
    pub energy: f64,
    pub gradient: Vec<f64>,
    /// The full tangent, row-major.
    pub tangent: Vec<f64>,
    /// World columns S of each frame's own coordinates, at `model.frames[f].columns`.
    columns: Vec<(usize, Vector<D>)>,
    /// The same columns as changes dΩ of the frame's motion.
    motions: Vec<Vector<D>>,
    run: Run<D>,
    /// Σ of the columns met so far, one D × dof block per body.
    prefix: Vec<f64>,
    /// Jacobians of the kept frames, one D × dof block each.
    kept: Vec<f64>,
    /// Σ of coupling forms times column Jacobians, one D × coupled block per frame.
    coupled: Vec<f64>,
}

/// Sums over one run of frames that share their coordinates.
#[derive(Clone, Debug)]
struct Run<const D: usize> {
    /// Σ S.
    columns: Vec<Vector<D>>,
    /// Σ (H̄ + ½ M(w̄)) S.
    rows: Vec<Vector<D>>,
    /// The run's columns with one another.
    own: Vec<f64>,
    /// The run's columns with the other side of couplings.
    coupled: Vec<f64>,
}

impl<const D: usize> Assembly<D> {
    pub fn new<G: LieGroup<D, P>, const P: usize>(model: &Model<G, D, P>) -> Self {
        let n = model.dof;
        let pairs: usize = model.contacts.iter().map(potential::touch::most_couplings).sum();
        let columns = model.frames.last().map_or(0, |f| f.columns.end);
        let widest = model.frames.iter().map(|f| f.columns.len()).max().unwrap_or(0);
        Self {
            coordinates: CoordinateTerms::new(n),
            frames: FrameTerms::new(model.frames.len(), pairs + model.springs.len()),
            energy: 0.0,
            gradient: vec![0.0; n],
            tangent: vec![0.0; n * n],
            columns: vec![(0, Vector::ZERO); columns],
            motions: vec![Vector::ZERO; columns],
            run: Run {
                columns: vec![Vector::ZERO; widest],
                rows: vec![Vector::ZERO; widest],
                own: vec![0.0; widest * widest],
                coupled: vec![0.0; widest * model.coupled.len()],
            },
            prefix: vec![0.0; model.bodies.len() * D * n],
            kept: vec![0.0; model.jacobian_slot.iter().flatten().count() * D * n],
            coupled: vec![0.0; model.frames.len() * D * model.coupled.len()],
        }
    }

    /// Energy, gradient (the residual of (9)) and tangent at the state held by `kinematics`.
    pub fn update<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        kinematics: &Kinematics<G, D, P>,
        q: &[f64],
        load: &[f64],
    ) {
        let coordinates = &mut self.coordinates;
        coordinates.clear();
        potential::elastic::add(model, design, q, coordinates);
        potential::joint::add(model, design, q, coordinates);
        potential::actuator::add(model, design, q, load, coordinates);
        let frames = &mut self.frames;
        frames.clear();
        potential::gravity::add(model, design, &kinematics.points, frames);
        potential::spring::add(model, design, &kinematics.points, frames);
        potential::contact::add(model, design, &kinematics.points, frames);
        potential::round_cone::add(model, design, &kinematics.points, frames);
        potential::wrench::add(model, design, kinematics, load, frames);
        self.energy = coordinates.energy + frames.energy;

        self.carry_back(model);
        self.expand_motions(model, design, kinematics);
        self.keep_jacobians(model);
        let coupled = self.carry_couplings(model);
        self.march(model, coupled);
        self.symmetrise(model.dof);
        self.circulate(model, design, kinematics, load);
    }

    /// World columns of a frame's own coordinates; zero where the frame carries nothing.
    pub fn columns(&self, range: std::ops::Range<usize>) -> impl Iterator<Item = &(usize, Vector<D>)> {
        self.columns[range].iter()
    }

    /// Sums wrenches and stiffness forms over all frames that each frame carries.
    fn carry_back<G: LieGroup<D, P>, const P: usize>(&mut self, model: &Model<G, D, P>) {
        let frames = &mut self.frames;
        for f in (1..model.frames.len()).rev() {
            let parent = model.frames[f].parent;
            if frames.loaded[f] && parent != 0 {
                frames.loaded[parent] = true;
                let (wrench, stiffness) = (frames.wrench[f], frames.stiffness[f]);
                frames.wrench[parent] += wrench;
                frames.stiffness[parent] += stiffness;
            }
        }
    }

    /// Columns and own block of every motion that carries something or is asked for its Jacobian.
    fn expand_motions<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        kinematics: &Kinematics<G, D, P>,
    ) {
        for f in 1..model.frames.len() {
            if !self.frames.loaded[f] && !model.leads_to_kept[f] {
                continue;
            }
            let frame = &model.frames[f];
            let operator =
                || kinematics.pose[f].adjoint() * G::tangent(&kinematics.omega[f], &kinematics.stumpff[f]);
            match &frame.motion {
                Motion::Rigid(_) => {}
                Motion::Joint(columns) => {
                    let columns = &model.joint_columns[columns.clone()];
                    self.expand_joint(columns, frame.columns.start, f, kinematics, &operator());
                }
                Motion::Strain(step) => {
                    self.expand_step(model, design, kinematics, f, *step, &operator());
                }
            }
        }
    }

    fn expand_joint<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        columns: &[JointColumn<D>],
        start: usize,
        f: usize,
        kinematics: &Kinematics<G, D, P>,
        operator: &Matrix<D, D>,
    ) {
        for (m, column) in columns.iter().enumerate() {
            self.motions[start + m] = column.twist;
            self.columns[start + m] = (column.dof, *operator * column.twist);
        }
        if self.frames.loaded[f] {
            self.curve(f, start..start + columns.len(), kinematics);
        }
    }

    #[inline]
    fn expand_step<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        kinematics: &Kinematics<G, D, P>,
        f: usize,
        step: usize,
        operator: &Matrix<D, D>,
    ) {
        let magnus = &model.steps[step];
        let scale = &design.rods[magnus.rod].axis_scale;
        let columns = &model.strain_columns[magnus.columns.clone()];
        let own = model.frames[f].columns.clone();
        let (a1, a2, commutator) = kinematics.magnus_derivative(model, step);
        let out = self.columns[own.clone()].iter_mut().zip(&mut self.motions[own.clone()]);
        for ((column, motion), c) in out.zip(columns) {
            let [p1, p2] = c.phi.map(|p| p * scale[c.axis]);
            *motion = a1.column(c.axis) * p1 + a2.column(c.axis) * p2;
            *column = (c.dof, *operator * *motion);
        }
        if !self.frames.loaded[f] {
            return;
        }
        self.curve(f, own, kinematics);
        // Ω itself is quadratic in the strains: κ [dξ₁, dξ₂].
        let n = self.gradient.len();
        let form = G::bracket_form(&operator.transpose_times(&self.frames.wrench[f])) * commutator;
        for (m, a) in columns.iter().enumerate() {
            for b in &columns[..m] {
                let bracket = form.0[a.axis][b.axis] * (scale[a.axis] * scale[b.axis]);
                self.coordinates.half_tangent[a.dof * n + b.dof] +=
                    bracket * (a.phi[0] * b.phi[1] - a.phi[1] * b.phi[0]);
            }
        }
    }

    /// Adds the curvature of a motion's exponential, dΩᵀ Q dΩ, to its own block.
    #[inline]
    fn curve<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        f: usize,
        own: std::ops::Range<usize>,
        kinematics: &Kinematics<G, D, P>,
    ) {
        let n = self.gradient.len();
        let body_wrench = kinematics.pose[f].adjoint().transpose_times(&self.frames.wrench[f]);
        let form = G::tangent_curvature(&kinematics.omega[f], &body_wrench, &kinematics.stumpff[f]);
        for a in own.clone() {
            let row = form * self.motions[a];
            let i = self.columns[a].0;
            for b in own.start..a {
                self.coordinates.half_tangent[i * n + self.columns[b].0] += row.dot(&self.motions[b]);
            }
            self.coordinates.half_tangent[i * n + i] += 0.5 * row.dot(&self.motions[a]);
        }
    }

    /// Jacobians of the frames that couplings and follower loads refer to.
    fn keep_jacobians<G: LieGroup<D, P>, const P: usize>(&mut self, model: &Model<G, D, P>) {
        let n = model.dof;
        self.kept.fill(0.0);
        for (frame, slot) in model.jacobian_slot.iter().enumerate() {
            let Some(slot) = slot else { continue };
            let jacobian = &mut self.kept[slot * D * n..(slot + 1) * D * n];
            let mut f = frame;
            while f != 0 {
                for (dof, column) in &self.columns[model.frames[f].columns.clone()] {
                    for d in 0..D {
                        jacobian[d * n + dof] += column[d];
                    }
                }
                f = model.frames[f].parent;
            }
        }
    }

    /// Sums X J_column of all couplings over what each frame carries; `false` when there are none.
    fn carry_couplings<G: LieGroup<D, P>, const P: usize>(&mut self, model: &Model<G, D, P>) -> bool {
        let (n, span) = (model.dof, model.coupled.clone());
        let width = span.len();
        if self.frames.couplings.is_empty() || width == 0 {
            return false;
        }
        self.coupled.fill(0.0);
        for coupling in &self.frames.couplings {
            let Some(slot) = model.jacobian_slot[coupling.column] else { continue };
            let rows = &mut self.coupled[coupling.row * D * width..(coupling.row + 1) * D * width];
            let jacobian = &self.kept[slot * D * n..(slot + 1) * D * n];
            for r in 0..D {
                for d in 0..D {
                    let x = coupling.form.0[r][d];
                    let source = &jacobian[d * n + span.start..d * n + span.end];
                    for (out, j) in rows[r * width..(r + 1) * width].iter_mut().zip(source) {
                        *out += x * j;
                    }
                }
            }
        }
        for f in (1..model.frames.len()).rev() {
            let parent = model.frames[f].parent;
            if self.frames.loaded[f] && parent != 0 {
                let (head, tail) = self.coupled.split_at_mut(f * D * width);
                for (p, c) in
                    head[parent * D * width..(parent + 1) * D * width].iter_mut().zip(&tail[..D * width])
                {
                    *p += c;
                }
            }
        }
        true
    }

    /// Goes outward along the tree, pairing each frame's columns with all before them.
    ///
    /// The frames of one rod element move with the same coordinates; such a run meets the columns
    /// before it once, with its rows summed, and pairs its own columns among themselves.
    fn march<G: LieGroup<D, P>, const P: usize>(&mut self, model: &Model<G, D, P>, coupled: bool) {
        let block = D * model.dof;
        let mut f = 1;
        while f < model.frames.len() {
            let frame = &model.frames[f];
            if !self.frames.loaded[f] {
                f += 1;
                continue;
            }
            let parent = &model.frames[frame.parent];
            if frame.parent == 0 {
                self.prefix[frame.body * block..][..block].fill(0.0);
            } else if parent.body != frame.body {
                self.prefix.copy_within(parent.body * block..(parent.body + 1) * block, frame.body * block);
            }
            let end = frame.run_end;
            if !frame.columns.is_empty() {
                self.pair_run::<G, P>(model, f..end, coupled);
            }
            f = end;
        }
    }

    #[inline]
    fn pair_run<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        run: std::ops::Range<usize>,
        coupled: bool,
    ) {
        let (n, span) = (model.dof, model.coupled.clone());
        let width = span.len();
        let first = &model.frames[run.start];
        let count = first.columns.len();
        let Run { columns: sums, rows, own, coupled: coupled_rows } = &mut self.run;
        let (sums, rows) = (&mut sums[..count], &mut rows[..count]);
        let (own, coupled_rows) = (&mut own[..count * count], &mut coupled_rows[..count * width]);
        sums.fill(Vector::ZERO);
        rows.fill(Vector::ZERO);
        own.fill(0.0);
        coupled_rows.fill(0.0);
        for f in run {
            if !self.frames.loaded[f] {
                break;
            }
            let wrench = self.frames.wrench[f];
            let form = self.frames.stiffness[f] + G::bracket_form(&wrench) * 0.5;
            let columns = &self.columns[model.frames[f].columns.clone()];
            for ((dof, column), (row, own)) in
                columns.iter().zip(rows.iter_mut().zip(own.chunks_exact_mut(count)))
            {
                let y = form * *column;
                *row += y;
                self.coordinates.gradient[*dof] += wrench.dot(column);
                for (o, ((_, other), before)) in own.iter_mut().zip(columns.iter().zip(sums.iter())) {
                    *o += y.dot(&(*before + *other * 0.5));
                }
            }
            if coupled {
                let carried = &self.coupled[f * D * width..(f + 1) * D * width];
                for ((_, column), out) in columns.iter().zip(coupled_rows.chunks_exact_mut(width)) {
                    for (d, carried) in carried.chunks_exact(width).enumerate() {
                        for (o, z) in out.iter_mut().zip(carried) {
                            *o += column[d] * z;
                        }
                    }
                }
            }
            for ((_, column), sum) in columns.iter().zip(sums.iter_mut()) {
                *sum += *column;
            }
        }

        let prefix = &mut self.prefix[first.body * D * n..(first.body + 1) * D * n];
        let path = model.frames[first.parent].path.clone();
        let columns = &self.columns[first.columns.clone()];
        for (c, ((dof, _), y)) in columns.iter().zip(rows.iter()).enumerate() {
            let row = &mut self.coordinates.half_tangent[dof * n..(dof + 1) * n];
            for d in 0..D {
                let before = &prefix[d * n + path.start..d * n + path.end];
                for (r, p) in row[path.clone()].iter_mut().zip(before) {
                    *r += y[d] * p;
                }
            }
            for ((other, _), value) in columns.iter().zip(&own[c * count..(c + 1) * count]) {
                row[*other] += value;
            }
            for (r, z) in row[span.clone()].iter_mut().zip(&coupled_rows[c * width..(c + 1) * width]) {
                *r += z;
            }
        }
        for ((dof, _), sum) in columns.iter().zip(sums.iter()) {
            for d in 0..D {
                prefix[d * n + dof] += sum[d];
            }
        }
    }

    /// Adds Jᵀw for a frame whose Jacobian is kept.
    pub fn add_generalised_force<G: LieGroup<D, P>, const P: usize>(
        &self,
        model: &Model<G, D, P>,
        frame: usize,
        wrench: &Vector<D>,
        out: &mut [f64],
    ) {
        let Some(slot) = model.jacobian_slot[frame] else { return };
        let n = model.dof;
        for d in 0..D {
            let row = &self.kept[(slot * D + d) * n..(slot * D + d + 1) * n];
            for (o, j) in out.iter_mut().zip(row) {
                *o += j * wrench[d];
            }
        }
    }

    fn symmetrise(&mut self, n: usize) {
        let half = &self.coordinates.half_tangent;
        for i in 0..n {
            for j in 0..=i {
                let value = half[i * n + j] + half[j * n + i];
                self.tangent[i * n + j] = value;
                self.tangent[j * n + i] = value;
            }
        }
        self.gradient.copy_from_slice(&self.coordinates.gradient);
    }

    /// The antisymmetric part of the tangent under loads without a potential.
    fn circulate<G: LieGroup<D, P>, const P: usize>(
        &mut self,
        model: &Model<G, D, P>,
        design: &Design<G, D, P>,
        kinematics: &Kinematics<G, D, P>,
        load: &[f64],
    ) {
        let n = model.dof;
        for wrench in model.wrenches.iter().filter(|w| !w.is_conservative()) {
            let Some(slot) = model.jacobian_slot[wrench.frame] else { continue };
            let (w, sign) = potential::wrench::circulatory(wrench, design, kinematics);
            let form = G::bracket_form(&w) * (sign * wrench.input.map_or(1.0, |i| load[i]));
            let jacobian = &self.kept[slot * D * n..(slot + 1) * D * n];
            let column = |j: usize| {
                let mut c = Vector::<D>::ZERO;
                for d in 0..D {
                    c[d] = jacobian[d * n + j];
                }
                c
            };
            for i in 0..n {
                let row = form.transpose_times(&column(i));
                for j in 0..n {
                    self.tangent[i * n + j] += row.dot(&column(j));
                }
            }
        }
    }
}
