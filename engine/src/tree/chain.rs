//! The longest rod as a chain of nodes, each of which moves only the frames beyond it.

use super::{Motion, Tree};
use crate::lie::LieGroup;

/// Coordinates of a chain below which a dense factorisation is as fast.
const MIN_CHAIN: usize = 96;
/// Largest border, as a fraction of the chain, with which the recursion is faster.
const MAX_BORDER: f64 = 0.25;

/// The order in which a rod's coordinates can be eliminated one node after another.
///
/// A coordinate deforms a few neighbouring runs of frames and moves everything beyond them as a rigid
/// body. Two coordinates without a common run are therefore coupled through a single twist.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Chain {
    /// The coordinates node by node from the base, then the border: all coordinates of other bodies.
    pub order: Vec<usize>,
    /// The start of each node in `order`, and of the border.
    pub starts: Vec<usize>,
    /// Frames that the rod moves.
    pub moved: Vec<bool>,
    /// For each coordinate, those coupled to it directly and not through that twist: the coordinates of its
    /// own node, of its neighbours and of the border.
    neighbours: Vec<Vec<usize>>,
}

impl Chain {
    /// The chain of the rod with most coordinates; `None` if they extend over more than two runs, as
    /// polynomials along the whole rod do.
    pub fn of<G: LieGroup<D, P>, const D: usize, const P: usize>(tree: &Tree<G, D, P>) -> Option<Self> {
        let longest = (0..tree.rods.len()).max_by_key(|r| tree.rods[*r].dofs.len())?;
        let rod = &tree.rods[longest];
        let own = |f: usize| match tree.frames[f].motion {
            Motion::Strain(step) => tree.steps[step].rod == longest,
            Motion::Joint(_) | Motion::Rigid(_) => false,
        };
        let mut node = vec![None; tree.dof];
        let mut last = vec![0; tree.dof];
        let mut moved = vec![false; tree.frames.len()];
        let (mut run, mut f) = (0, 1);
        while f < tree.frames.len() {
            let frame = &tree.frames[f];
            let moves = own(f) || moved[frame.parent];
            moved[f..frame.run_end].fill(moves);
            if own(f) {
                for &dof in &tree.column_dofs[frame.columns.clone()] {
                    node[dof].get_or_insert(run);
                    last[dof] = run;
                }
                run += 1;
            }
            f = frame.run_end;
        }
        let of = |dof: usize| node[dof].unwrap_or(usize::MAX);
        let neighbours = |i: usize, j: usize| of(i).abs_diff(of(j)) <= 1;
        let local = rod.dofs.clone().all(|i| node[i].is_some_and(|first| last[i] <= first + 1))
            && tree.stiffness_pattern.iter().all(|&(i, j)| !rod.dofs.contains(&i) || neighbours(i, j));
        let mut order: Vec<usize> = (0..tree.dof).collect();
        order.sort_by_key(|dof| of(*dof));
        let start = |k: usize| order.partition_point(|dof| of(*dof) < k);
        let starts = (0..run).map(start).chain([rod.dofs.len()]).collect();
        let chain = Self { order, starts, moved, neighbours: vec![vec![]; tree.dof] };
        local.then(|| chain.with_neighbours())
    }

    fn with_neighbours(mut self) -> Self {
        let nodes = self.starts.len() - 1;
        let border = self.starts[nodes];
        for k in 0..nodes {
            let near = self.starts[k.saturating_sub(1)]..self.starts[(k + 2).min(nodes)];
            let near = [&self.order[near], &self.order[border..]].concat();
            for i in &self.order[self.starts[k]..self.starts[k + 1]] {
                self.neighbours[*i].clone_from(&near);
            }
        }
        for i in &self.order[border..] {
            self.neighbours[*i].clone_from(&self.order);
        }
        self
    }

    /// Whether the recursion over the nodes is faster than a dense factorisation.
    pub fn is_efficient(&self) -> bool {
        let chain = self.starts[self.starts.len() - 1];
        chain >= MIN_CHAIN && (self.order.len() - chain) as f64 <= MAX_BORDER * chain as f64
    }

    /// The coordinates to which coordinate `i` is coupled other than through one twist, including `i`.
    #[inline]
    pub fn neighbours(&self, i: usize) -> &[usize] {
        &self.neighbours[i]
    }
}
