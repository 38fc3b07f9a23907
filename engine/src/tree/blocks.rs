//! Coordinates in blocks, in the layout of the columns of the frames.

use crate::linalg::{LANES, Vector};

/// The position of each coordinate of a frame's own motion in the blocks. The frames of a run share
/// their blocks; lanes without a coordinate remain zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CoordinateBlocks {
    /// Block, lane and coordinate.
    places: Vec<(usize, usize, usize)>,
    count: usize,
}

impl CoordinateBlocks {
    /// Appends blocks for these coordinates.
    pub fn push(&mut self, dofs: &[usize]) -> std::ops::Range<usize> {
        let start = self.count;
        self.places.extend(dofs.iter().enumerate().map(|(m, dof)| (start + m / LANES, m % LANES, *dof)));
        self.count += dofs.len().div_ceil(LANES);
        start..self.count
    }

    /// Empty blocks.
    pub fn zeros(&self) -> Vec<Vector<LANES>> {
        vec![Vector::ZERO; self.count]
    }

    /// Reads the coordinates into blocks made by [`CoordinateBlocks::zeros`].
    #[inline]
    pub fn gather(&self, coordinates: &[f64], blocks: &mut [Vector<LANES>]) {
        self.places.iter().for_each(|(block, lane, dof)| blocks[*block][*lane] = coordinates[*dof]);
    }

    /// Adds the blocks to the coordinates.
    #[inline]
    pub fn scatter(&self, blocks: &[Vector<LANES>], coordinates: &mut [f64]) {
        self.places.iter().for_each(|(block, lane, dof)| coordinates[*dof] += blocks[*block][*lane]);
    }
}
