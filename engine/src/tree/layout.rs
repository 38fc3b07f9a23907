//! The flat vector of a model's continuous numbers and the names of its slots.

use std::ops::Range;

/// Names and ranges of the parameters of a model, in order.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    slots: Vec<(String, Range<usize>)>,
    len: usize,
}

impl Layout {
    /// Appends a slot and its default values.
    pub(crate) fn push(&mut self, values: &mut Vec<f64>, name: String, defaults: &[f64]) -> Range<usize> {
        let range = self.len..self.len + defaults.len();
        values.extend_from_slice(defaults);
        self.len = range.end;
        self.slots.push((name, range.clone()));
        range
    }

    /// All slots.
    pub fn iter(&self) -> impl Iterator<Item = (&str, Range<usize>)> {
        self.slots.iter().map(|(name, range)| (name.as_str(), range.clone()))
    }

    /// The range of a slot.
    pub fn get(&self, name: &str) -> Option<Range<usize>> {
        self.slots.iter().find(|(n, _)| n == name).map(|(_, range)| range.clone())
    }

    /// Number of parameters.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}
