//! The class `Model`.

use crate::dispatch::{AnyModel, ContactForce, ElementForces, State, on_model};
use crate::error::value_error;
use crate::interrupt::interruptible;
use crate::{friction, options, structure};
use flexor_engine::model::{Description, Structure};
use flexor_engine::sensitivity::{HistoryPart, KnownEquilibria, output_groups};
use flexor_engine::{Batch, PathEvent, PathFriction, PathResults};
use numpy::{
    AllowTypeChange, IntoPyArray, PyArray1, PyArray2, PyArrayLike1, PyArrayLike2, PyArrayMethods, ToPyArray,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::HashMap;

/// Anything NumPy makes an array of numbers from.
type Numbers<'py> = PyArrayLike1<'py, f64, AllowTypeChange>;
type Table<'py> = PyArrayLike2<'py, f64, AllowTypeChange>;
type Indices<'py> = PyArrayLike1<'py, i64, AllowTypeChange>;

/// A built model: immutable, shared by all threads.
#[pyclass(frozen, module = "flexor._engine")]
pub struct Model {
    inner: AnyModel,
    structure: Structure,
}

#[pymethods]
impl Model {
    #[new]
    fn new(description: &str) -> PyResult<Self> {
        let description: Description = match serde_json::from_str(description) {
            Ok(d) => d,
            Err(error) => return value_error(error),
        };
        match AnyModel::new(&description) {
            Ok(inner) => Ok(Self { structure: inner.structure(&description), inner }),
            Err(error) => value_error(error),
        }
    }

    #[getter]
    fn planar(&self) -> bool {
        matches!(self.inner, AnyModel::Planar(_))
    }

    #[getter]
    fn dof(&self) -> usize {
        on_model!(&self.inner, m => m.dof())
    }

    #[getter]
    fn coordinates(&self) -> Vec<String> {
        on_model!(&self.inner, m => m.coordinates().to_vec())
    }

    #[getter]
    fn inputs(&self) -> Vec<String> {
        on_model!(&self.inner, m => m.inputs().to_vec())
    }

    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        on_model!(&self.inner, m => m.parameters().to_pyarray(py))
    }

    #[getter]
    fn slots<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let slots = PyDict::new(py);
        on_model!(&self.inner, m => {
            for (name, range) in m.layout().iter() {
                slots.set_item(name, (range.start, range.end))?;
            }
        });
        Ok(slots)
    }

    #[getter]
    fn slot_units(&self) -> HashMap<&str, Option<&str>> {
        self.structure.slot_units.iter().map(|(name, unit)| (name.as_str(), *unit)).collect()
    }

    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.structure.joints.iter().map(|joint| structure::joint(py, joint)).collect()
    }

    #[getter]
    fn body_frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        structure::ranges(py, &self.structure.body_frames)
    }

    #[getter]
    fn sphere_groups<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        structure::ranges(py, &self.structure.sphere_groups)
    }

    /// Whether the models are the same but for the values of their parameters.
    fn has_structure_of(&self, other: &Self) -> bool {
        self.inner.has_structure_of(&other.inner)
    }

    fn frame_names(&self) -> Vec<String> {
        on_model!(&self.inner, m => m.frame_names().to_vec())
    }

    fn energy(&self, parameters: Numbers<'_>, q: Numbers<'_>, u: Numbers<'_>) -> PyResult<f64> {
        Ok(self.state(&parameters, &q, Some(&u))?.energy)
    }

    fn residual<'py>(
        &self,
        py: Python<'py>,
        parameters: Numbers<'_>,
        q: Numbers<'_>,
        u: Numbers<'_>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(self.state(&parameters, &q, Some(&u))?.residual.into_pyarray(py))
    }

    fn tangent<'py>(
        &self,
        py: Python<'py>,
        parameters: Numbers<'_>,
        q: Numbers<'_>,
        u: Numbers<'_>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let n = self.dof();
        self.state(&parameters, &q, Some(&u))?.tangent.into_pyarray(py).reshape([n, n])
    }

    fn actuator_lengths<'py>(
        &self,
        py: Python<'py>,
        parameters: Numbers<'_>,
        q: Numbers<'_>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(self.state(&parameters, &q, None)?.lengths.into_pyarray(py))
    }

    fn volumes<'py>(
        &self,
        py: Python<'py>,
        parameters: Numbers<'_>,
        q: Numbers<'_>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(self.state(&parameters, &q, None)?.volumes.into_pyarray(py))
    }

    /// Forces of springs, loops and obstacles, as results of paths have them.
    fn element_forces<'py>(
        &self,
        py: Python<'py>,
        parameters: Numbers<'_>,
        q: Numbers<'_>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let ElementForces { springs, loops, obstacles } = self.state(&parameters, &q, None)?.forces;
        let out = PyDict::new(py);
        out.set_item("spring_tension", springs.into_pyarray(py))?;
        out.set_item("loop_tension", loops.into_pyarray(py))?;
        out.set_item("obstacle_force", obstacles.into_pyarray(py))?;
        Ok(out)
    }

    /// Length of each tendon.
    fn tendon_lengths<'py>(
        &self,
        py: Python<'py>,
        parameters: Numbers<'_>,
        q: Numbers<'_>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(self.state(&parameters, &q, None)?.tendons.lengths.into_pyarray(py))
    }

    /// Tension of each tendon under loads.
    fn tendon_tensions<'py>(
        &self,
        py: Python<'py>,
        parameters: Numbers<'_>,
        q: Numbers<'_>,
        u: Numbers<'_>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(self.state(&parameters, &q, Some(&u))?.tendons.tensions.into_pyarray(py))
    }

    /// Minus the derivative of the length of each tendon by each coordinate.
    fn tendon_arms<'py>(
        &self,
        py: Python<'py>,
        parameters: Numbers<'_>,
        q: Numbers<'_>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let tendons = on_model!(&self.inner, m => m.tendon_count());
        let arms = self.state(&parameters, &q, None)?.tendons.arms;
        arms.into_pyarray(py).reshape([tendons, self.dof()])
    }

    /// Places along each tendon, branch by branch.
    fn tendon_paths(&self, parameters: Numbers<'_>, q: Numbers<'_>) -> PyResult<Vec<Vec<Vec<[f64; 3]>>>> {
        Ok(self.state(&parameters, &q, None)?.tendons.paths)
    }

    /// Frames where each material is stretched least and most; −1 where it is not.
    fn stretch_frames<'py>(
        &self,
        py: Python<'py>,
        parameters: Numbers<'_>,
        q: Numbers<'_>,
    ) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let frames = self.state(&parameters, &q, None)?.stretch_frames;
        frames.as_flattened().to_pyarray(py).reshape([frames.len(), 2])
    }

    fn frames<'py>(
        &self,
        py: Python<'py>,
        parameters: Numbers<'_>,
        q: Numbers<'_>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let frames = self.state(&parameters, &q, None)?.frames;
        let flat: Vec<f64> = frames.iter().flatten().flatten().copied().collect();
        Ok(flat.into_pyarray(py).reshape([frames.len(), 4, 4])?.into_any())
    }

    fn spheres<'py>(
        &self,
        py: Python<'py>,
        parameters: Numbers<'_>,
        q: Numbers<'_>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let spheres = self.state(&parameters, &q, None)?.spheres;
        spheres.as_flattened().to_pyarray(py).reshape([spheres.len(), 4])
    }

    fn contacts<'py>(
        &self,
        py: Python<'py>,
        parameters: Numbers<'_>,
        q: Numbers<'_>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let contacts = self.state(&parameters, &q, None)?.contacts;
        let vectors = |pick: fn(&ContactForce) -> [f64; 3]| {
            let flat: Vec<f64> = contacts.iter().flat_map(pick).collect();
            flat.into_pyarray(py).reshape([contacts.len(), 3])
        };
        let out = PyDict::new(py);
        out.set_item("first", contacts.iter().map(|t| t.first).collect::<Vec<_>>().into_pyarray(py))?;
        out.set_item("second", contacts.iter().map(|t| t.second).collect::<Vec<_>>().into_pyarray(py))?;
        out.set_item("cone", contacts.iter().map(|t| t.cone).collect::<Vec<_>>().into_pyarray(py))?;
        out.set_item("force", vectors(|t| t.force)?)?;
        out.set_item("point", vectors(|t| t.point)?)?;
        out.set_item("depth", contacts.iter().map(|t| t.depth).collect::<Vec<_>>().into_pyarray(py))?;
        out.set_item("pressure", contacts.iter().map(|t| t.pressure).collect::<Vec<_>>().into_pyarray(py))?;
        Ok(out)
    }

    /// Solves a batch of designs along a list of loads, the same for all or, of so many `steps` each, of one
    /// design after another.
    #[pyo3(signature = (slot_indices, values, loads, threads=0, *, steps=None, base=None, start=None, slips=None, **solver_options))]
    #[allow(clippy::too_many_arguments)]
    fn path<'py>(
        &self,
        py: Python<'py>,
        slot_indices: Indices<'_>,
        values: Table<'_>,
        loads: Table<'_>,
        threads: usize,
        steps: Option<usize>,
        base: Option<Numbers<'_>>,
        start: Option<Numbers<'_>>,
        slips: Option<Table<'_>>,
        solver_options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let paths = self.paths((&slot_indices, &values, &loads), steps, (base, start, slips))?;
        let options = options::read(solver_options)?;
        let batch = paths.batch();
        let pieces = interruptible(py, batch.is_parallel(threads), |cancel| {
            let batch = Batch { cancel: Some(cancel), ..batch };
            on_model!(&self.inner, m => m.solve_in_pieces(batch, options, threads))
        })?;
        let result = py.detach(|| on_model!(&self.inner, m => m.join(pieces)));
        self.results(py, result, [batch.designs, batch.steps])
    }

    /// Follows the same paths again and differentiates numbers of each, weighted sums of outputs at several of
    /// its steps.
    #[pyo3(signature = (slot_indices, values, loads, parts, weights, numbers, wanted, threads=0, *, steps=None, base=None, start=None, slips=None, **solver_options))]
    #[allow(clippy::too_many_arguments)]
    fn differentiate_paths<'py>(
        &self,
        py: Python<'py>,
        slot_indices: Indices<'_>,
        values: Table<'_>,
        loads: Table<'_>,
        parts: PyArrayLike2<'_, i64, AllowTypeChange>,
        weights: Table<'_>,
        numbers: usize,
        wanted: Indices<'_>,
        threads: usize,
        steps: Option<usize>,
        base: Option<Numbers<'_>>,
        start: Option<Numbers<'_>>,
        slips: Option<Table<'_>>,
        solver_options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let paths = self.paths((&slot_indices, &values, &loads), steps, (base, start, slips))?;
        let options = options::read(solver_options)?;
        let (batch, wanted) = (paths.batch(), indices(&wanted));
        let outputs: usize = on_model!(&self.inner, m => output_groups(m)).iter().map(|(_, n)| n).sum();
        let (table, weighed) = (parts.as_array(), weights.as_array());
        if table.ncols() != 3 || weighed.dim() != (table.nrows(), outputs) {
            return value_error(format!(
                "parts, weights: found the shapes {:?} and {:?}, expected three columns and {outputs}",
                table.dim(),
                weighed.dim()
            ));
        }
        let weights = numbers_of(&weights);
        let index = |row: usize, column: usize| usize::try_from(table[[row, column]]).unwrap_or(usize::MAX);
        let parts: Vec<HistoryPart> = (0..table.nrows())
            .map(|row| HistoryPart {
                design: index(row, 0),
                number: index(row, 1),
                step: index(row, 2),
                weights: &weights[row * outputs..(row + 1) * outputs],
            })
            .collect();
        let inside = |part: &HistoryPart| {
            part.design < batch.designs && part.number < numbers && part.step < batch.steps
        };
        if !parts.iter().all(inside) || !parts.is_sorted_by_key(|part| part.design) {
            return value_error("parts: must be of these designs, in increasing order, numbers and steps");
        }
        if let Some(i) = wanted.iter().find(|i| **i >= batch.base.len()) {
            return value_error(format!("wanted: found {i}, there are {}", batch.base.len()));
        }
        let found = interruptible(py, batch.designs > 1 && threads != 1, |cancel| {
            let batch = Batch { cancel: Some(cancel), ..batch };
            let sums = (numbers, &parts[..]);
            on_model!(&self.inner, m => m.differentiate_histories(batch, options, sums, &wanted, threads))
        })?;
        let inputs = on_model!(&self.inner, m => m.inputs().len());
        let out = PyDict::new(py);
        let shape = [batch.designs, numbers, wanted.len()];
        out.set_item("by_parameters", found.by_parameters.into_pyarray(py).reshape(shape)?)?;
        let shape = [batch.designs, numbers, batch.steps, inputs];
        out.set_item("by_loads", found.by_loads.into_pyarray(py).reshape(shape)?)?;
        out.set_item("regularity", found.regularity.into_pyarray(py).reshape([batch.designs, numbers])?)?;
        Ok(out)
    }

    /// Names and ranges of the numbers that can be differentiated.
    #[getter]
    fn outputs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (outputs, mut first) = (PyDict::new(py), 0);
        for (name, count) in on_model!(&self.inner, m => output_groups(m)) {
            outputs.set_item(name, (first, first + count))?;
            first += count;
        }
        Ok(outputs)
    }

    /// Differentiates weighted sums of outputs at known equilibria of designs.
    #[pyo3(signature = (slot_indices, values, designs, q, applied, sums, weights, wanted, threads=0))]
    #[allow(clippy::too_many_arguments)]
    fn differentiate<'py>(
        &self,
        py: Python<'py>,
        slot_indices: Indices<'_>,
        values: Table<'_>,
        designs: Indices<'_>,
        q: Table<'_>,
        applied: Table<'_>,
        sums: Indices<'_>,
        weights: Table<'_>,
        wanted: Indices<'_>,
        threads: usize,
    ) -> PyResult<Bound<'py, PyDict>> {
        let base = on_model!(&self.inner, m => m.parameters().to_vec());
        let (inputs, dof) = on_model!(&self.inner, m => (m.inputs().len(), m.dof()));
        let outputs: usize = on_model!(&self.inner, m => output_groups(m)).iter().map(|(_, n)| n).sum();
        let shape = |table: &Table<'_>| [table.as_array().nrows(), table.as_array().ncols()];
        let [varied, designs, sums, wanted] = [&slot_indices, &designs, &sums, &wanted].map(indices);
        let (equilibria, count) = (designs.len(), sums.len());
        let rows = shape(&values)[0];
        for (what, found, expected) in [
            ("values", shape(&values), [rows, varied.len()]),
            ("q", shape(&q), [equilibria, dof]),
            ("applied", shape(&applied), [equilibria, inputs]),
            ("weights", shape(&weights), [count, outputs]),
        ] {
            if found != expected {
                return value_error(format!("{what}: found the shape {found:?}, expected {expected:?}"));
            }
        }
        for (what, found, bound) in [
            ("slot_indices", &varied, base.len()),
            ("wanted", &wanted, base.len()),
            ("designs", &designs, rows),
            ("sums", &sums, equilibria),
        ] {
            if let Some(i) = found.iter().find(|i| **i >= bound) {
                return value_error(format!("{what}: found {i}, there are {bound}"));
            }
        }
        if !sums.is_sorted() {
            return value_error("sums: must be in increasing order");
        }
        let [values, q, applied, weights] = [&values, &q, &applied, &weights].map(numbers_of);
        let known = KnownEquilibria {
            base: &base,
            varied: &varied,
            values: &values,
            designs: &designs,
            q: &q,
            applied: &applied,
            sums: &sums,
            weights: &weights,
            wanted: &wanted,
            cancel: None,
        };
        let found = interruptible(py, known.is_parallel(threads), |cancel| {
            let known = KnownEquilibria { cancel: Some(cancel), ..known };
            on_model!(&self.inner, m => m.differentiate(known, threads))
        })?;
        let out = PyDict::new(py);
        let by_parameters = found.by_parameters.into_pyarray(py);
        out.set_item("by_parameters", by_parameters.reshape([count, wanted.len()])?)?;
        out.set_item("by_loads", found.by_loads.into_pyarray(py).reshape([count, inputs])?)?;
        out.set_item("regularity", found.regularity.into_pyarray(py))?;
        Ok(out)
    }

    /// Follows the branch of one design by arc length from the first load to the last.
    #[pyo3(signature = (parameters, loads, *, start=None, **solver_options))]
    fn branch<'py>(
        &self,
        py: Python<'py>,
        parameters: Numbers<'_>,
        loads: Table<'_>,
        start: Option<Numbers<'_>>,
        solver_options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (slots, inputs, dof) =
            on_model!(&self.inner, m => (m.parameters().len(), m.inputs().len(), m.dof()));
        let parameters = parameters.as_array().to_vec();
        let loads = loads.as_array();
        if parameters.len() != slots {
            return value_error(format!("parameters: found {}, the model has {slots}", parameters.len()));
        }
        if loads.ncols() != inputs {
            return value_error(format!(
                "loads: found {} columns, the model has {inputs} inputs",
                loads.ncols()
            ));
        }
        if loads.iter().any(|u| !u.is_finite()) {
            return value_error("loads: must be finite numbers");
        }
        let rows: Vec<Vec<f64>> = loads.rows().into_iter().map(|row| row.to_vec()).collect();
        let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        let start = self.start(start)?.unwrap_or_else(|| vec![0.0; dof]);
        let options = options::read(solver_options)?;
        let found = interruptible(
            py,
            false,
            |cancel| on_model!(&self.inner, m => m.follow_branch(&parameters, &rows, &start, options, Some(cancel))),
        )?;
        let Some(found) = found else { return value_error("the design is not admissible") };

        let points = found.results.status.len();
        let out = self.results(py, found.results, [1, points])?;
        out.set_item("loads", found.loads.into_pyarray(py).reshape([points, inputs])?)?;
        Ok(out)
    }
}

fn indices(array: &Indices<'_>) -> Vec<usize> {
    array.as_array().iter().map(|i| usize::try_from(*i).unwrap_or(usize::MAX)).collect()
}

fn numbers_of(table: &Table<'_>) -> Vec<f64> {
    table.as_array().iter().copied().collect()
}

/// Paths of designs, as read.
struct GivenPaths {
    base: Vec<f64>,
    varied: Vec<usize>,
    values: Vec<f64>,
    designs: usize,
    loads: Vec<f64>,
    steps: usize,
    start: Option<Vec<f64>>,
    slips: Vec<PathFriction>,
}

impl GivenPaths {
    fn batch(&self) -> Batch<'_> {
        Batch {
            base: &self.base,
            varied: &self.varied,
            values: &self.values,
            designs: self.designs,
            loads: &self.loads,
            steps: self.steps,
            start: self.start.as_deref(),
            slips: &self.slips,
            cancel: None,
        }
    }
}

impl Model {
    /// Reads and checks the paths of designs.
    fn paths(
        &self,
        (slot_indices, values, loads): (&Indices<'_>, &Table<'_>, &Table<'_>),
        steps: Option<usize>,
        (base, start, slips): (Option<Numbers<'_>>, Option<Numbers<'_>>, Option<Table<'_>>),
    ) -> PyResult<GivenPaths> {
        let default = on_model!(&self.inner, m => m.parameters().to_vec());
        let base = base.map_or(default, |b| b.as_array().to_vec());
        let (inputs, slots) = on_model!(&self.inner, m => (m.inputs().len(), m.parameters().len()));
        let varied = indices(slot_indices);
        let [designs, columns] = [values.as_array().nrows(), values.as_array().ncols()];
        let [rows, load_inputs] = [loads.as_array().nrows(), loads.as_array().ncols()];
        let steps = steps.unwrap_or(rows);
        if rows != steps && rows != designs * steps {
            return value_error(format!("loads: found {rows} rows for {designs} designs of {steps} steps"));
        }
        if base.len() != slots {
            return value_error(format!("base: found {} parameters, the model has {slots}", base.len()));
        }
        if columns != varied.len() {
            return value_error(format!("values: found {columns} columns for {} slots", varied.len()));
        }
        if let Some(i) = varied.iter().find(|i| **i >= slots) {
            return value_error(format!("slot_indices: found {i}, the model has {slots} parameters"));
        }
        if load_inputs != inputs {
            return value_error(format!("loads: found {load_inputs} columns, the model has {inputs} inputs"));
        }
        if loads.as_array().iter().any(|u| !u.is_finite()) {
            return value_error("loads: must be finite numbers");
        }
        let (start, slips) = (self.start(start)?, friction::slips(slips)?);
        let [values, loads] = [values, loads].map(numbers_of);
        Ok(GivenPaths { base, varied, values, designs, loads, steps, start, slips })
    }

    /// Arrays over (design, step) by name.
    fn results<'py>(
        &self,
        py: Python<'py>,
        found: PathResults,
        shape: [usize; 2],
    ) -> PyResult<Bound<'py, PyDict>> {
        let (inputs, dof) = on_model!(&self.inner, m => (m.inputs().len(), m.dof()));
        let (volumes, materials) = on_model!(&self.inner, m => (m.pressure_count(), m.material_count()));
        let (springs, loops, obstacles) =
            on_model!(&self.inner, m => (m.spring_count(), m.loop_count(), m.obstacle_count()));
        let rods = on_model!(&self.inner, m => m.rod_count());
        let [designs, steps] = shape;
        let out = PyDict::new(py);
        for (name, codes) in [("status", found.status), ("stability", found.stability)] {
            out.set_item(name, codes.into_pyarray(py).reshape(shape)?)?;
        }
        for (name, counts) in
            [("iterations", found.iterations), ("pairs", found.pairs), ("touching", found.touching)]
        {
            out.set_item(name, counts.into_pyarray(py).reshape(shape)?)?;
        }
        for (name, values) in [
            ("residual", found.residual),
            ("tolerance", found.tolerance),
            ("energy", found.energy),
            ("tip_force", found.tip_force),
            ("max_overlap", found.overlap),
            ("max_centreline_depth", found.centreline),
            ("max_contact_pressure", found.pressure),
            ("dissipated", found.dissipated),
        ] {
            out.set_item(name, values.into_pyarray(py).reshape(shape)?)?;
        }
        for (name, values, width) in [
            ("q", found.q, dof),
            ("applied", found.applied, inputs),
            ("volume", found.volume, volumes),
            ("rod_bending", found.rod_bending, rods),
            ("spring_tension", found.spring_tension, springs),
            ("loop_tension", found.loop_tension, loops),
            ("obstacle_force", found.obstacle_force, obstacles),
        ] {
            out.set_item(name, values.into_pyarray(py).reshape([designs, steps, width])?)?;
        }
        let stretch = found.stretch.into_pyarray(py);
        out.set_item("stretch", stretch.reshape([designs, steps, materials, 2])?)?;
        let ties = on_model!(&self.inner, m => m.tie_count());
        for (name, values, width) in [("tie_loads", found.ties, 7), ("tie_gaps", found.tie_gaps, 2)] {
            out.set_item(name, values.into_pyarray(py).reshape([designs, steps, ties, width])?)?;
        }
        let per_tie = [("tie_redundancy", found.tie_redundancy), ("tie_singularity", found.tie_singularity)];
        for (name, values) in per_tie {
            out.set_item(name, values.into_pyarray(py).reshape([designs, steps, ties])?)?;
        }
        out.set_item("friction", friction::rows(py, &found.frictions)?)?;
        out.set_item("free", found.free.as_flattened().to_pyarray(py).reshape([found.free.len(), 3])?)?;
        out.set_item("events", events(py, &found.events, inputs, dof)?)?;
        Ok(out)
    }

    /// Checks a state to start from.
    fn start(&self, start: Option<Numbers<'_>>) -> PyResult<Option<Vec<f64>>> {
        let Some(start) = start.map(|q| q.as_array().to_vec()) else { return Ok(None) };
        if start.len() != self.dof() {
            return value_error(format!(
                "start: found {} coordinates, the model has {}",
                start.len(),
                self.dof()
            ));
        }
        if start.iter().any(|q| !q.is_finite()) {
            return value_error("start: must be finite numbers");
        }
        Ok(Some(start))
    }

    fn state(&self, parameters: &Numbers<'_>, q: &Numbers<'_>, u: Option<&Numbers<'_>>) -> PyResult<State> {
        let parameters = parameters.as_array().to_vec();
        let q = q.as_array().to_vec();
        let (slots, inputs) = on_model!(&self.inner, m => (m.parameters().len(), m.inputs().len()));
        let load = u.map_or(vec![0.0; inputs], |u| u.as_array().to_vec());
        let lengths =
            [("parameters", parameters.len(), slots), ("q", q.len(), self.dof()), ("u", load.len(), inputs)];
        for (name, found, needed) in lengths {
            if found != needed {
                return value_error(format!("{name}: found {found} numbers, the model has {needed}"));
            }
        }
        Ok(self.inner.state(&parameters, &q, &load))
    }
}

fn events<'py>(
    py: Python<'py>,
    events: &[PathEvent],
    inputs: usize,
    dof: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    let count = events.len();
    let rows =
        |pick: fn(&PathEvent) -> &[f64]| events.iter().flat_map(|e| pick(e).to_vec()).collect::<Vec<f64>>();
    out.set_item("design", events.iter().map(|e| e.design).collect::<Vec<_>>().into_pyarray(py))?;
    out.set_item("step", events.iter().map(|e| e.step).collect::<Vec<_>>().into_pyarray(py))?;
    out.set_item("kind", events.iter().map(|e| e.kind as u8).collect::<Vec<_>>().into_pyarray(py))?;
    out.set_item("load", rows(|e| &e.load).into_pyarray(py).reshape([count, inputs])?)?;
    out.set_item("before", rows(|e| &e.before).into_pyarray(py).reshape([count, dof])?)?;
    out.set_item("after", rows(|e| &e.after).into_pyarray(py).reshape([count, dof])?)?;
    Ok(out)
}
