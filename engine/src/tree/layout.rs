//! The flat vector of a model's continuous numbers, and the names and units of its slots.

use std::ops::Range;

/// Names, units and ranges of the parameters of a model, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    slots: Vec<Slot>,
    len: usize,
}

#[derive(Clone, Debug, PartialEq)]
struct Slot {
    name: String,
    /// SI; `None` for numbers of several units.
    unit: Option<&'static str>,
    range: Range<usize>,
}

impl Layout {
    /// Appends a slot with its unit (`None` for several) and its default values.
    pub(crate) fn push(
        &mut self,
        values: &mut Vec<f64>,
        name: String,
        unit: Option<&'static str>,
        defaults: &[f64],
    ) -> Range<usize> {
        let range = self.len..self.len + defaults.len();
        values.extend_from_slice(defaults);
        self.len = range.end;
        self.slots.push(Slot { name, unit, range: range.clone() });
        range
    }

    /// All slots.
    pub fn iter(&self) -> impl Iterator<Item = (&str, Range<usize>)> {
        self.slots.iter().map(|slot| (slot.name.as_str(), slot.range.clone()))
    }

    /// The SI units of all slots, `None` where a slot has numbers of several.
    pub fn units(&self) -> impl Iterator<Item = (&str, Option<&'static str>)> {
        self.slots.iter().map(|slot| (slot.name.as_str(), slot.unit))
    }

    /// The range of a slot.
    pub fn get(&self, name: &str) -> Option<Range<usize>> {
        self.slots.iter().find(|slot| slot.name == name).map(|slot| slot.range.clone())
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
