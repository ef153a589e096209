// SPDX-License-Identifier: MIT OR Apache-2.0
//! Three-dimensional lookup tables (LUTs): the colours that take the places of colours, at the nodes of a cube, as
//! colourists deliver looks. Knows neither files nor how colours between the nodes are found.

use super::kept::KeptFile;
use crate::allocate::with_room;
use crate::error::{Error, Number, Result};

/// Colours at the nodes of a cube of colours.
#[derive(Debug)]
pub struct Lut {
    side: u32,
    domain: [[f32; 3]; 2],
    nodes: Vec<[f32; 4]>,
}

/// A table with the file that it is from.
pub type LutFile = KeptFile<Lut>;

/// The name of their memory in out-of-memory errors.
pub(super) const NODES: &str = "the nodes of a LUT";

/// The bounds that a domain may have, and the least that it may be wide: beyond, places in the cube would be no numbers
/// of 32 bits.
const MOST_BOUND: f32 = 1e6;
const LEAST_WIDTH: f32 = 1e-6;

impl Lut {
    /// Nodes along each side of the cube. 65 is the most that programs for colourists usually write.
    pub const LEAST_SIDE: u32 = 2;
    pub const MOST_SIDE: u32 = 65;

    /// Components that colours are given by: those from 0 to 1.
    pub const UNIT: [[f32; 3]; 2] = [[0.0; 3], [1.0; 3]];

    /// Errors: INVALID_ARGUMENT.
    pub fn check_side(side: u32) -> Result<()> {
        match (Self::LEAST_SIDE..=Self::MOST_SIDE).contains(&side) {
            true => Ok(()),
            false => Err(Error::argument(format!(
                "side is {side}; it must lie in [{}, {}]",
                Self::LEAST_SIDE,
                Self::MOST_SIDE
            ))),
        }
    }

    /// The nodes of a cube whose side passes [`Self::check_side`].
    pub fn node_count(side: u32) -> usize {
        (side as usize).pow(3)
    }

    /// A table whose nodes, red, green and blue, red changing fastest, are spread evenly over colours from 0 to 1.
    /// Errors: INVALID_ARGUMENT for a side out of its range, another number of numbers than 3 side^3, and one that is
    /// not finite; OUT_OF_MEMORY.
    pub fn new(side: u32, numbers: impl ExactSizeIterator<Item = f32>) -> Result<Self> {
        Self::check_side(side)?;
        let (count, wanted) = (numbers.len(), 3 * Self::node_count(side));
        if count != wanted {
            return Err(Error::argument(format!("count is {count}; for a side of {side} it must be {wanted}")));
        }
        let mut numbers = numbers.enumerate().map(|(index, number)| match number.is_finite() {
            true => Ok(number),
            false => {
                let number = Number(number.into());
                Err(Error::argument(format!("nodes[{index}] is {number}; it must be finite")))
            }
        });
        let mut next = || numbers.next().unwrap_or(Ok(0.0));
        let mut nodes = with_room(Self::node_count(side), NODES)?;
        for _ in 0..Self::node_count(side) {
            nodes.push([next()?, next()?, next()?, 0.0]);
        }
        Ok(Self { side, domain: Self::UNIT, nodes })
    }

    /// A table of `Self::node_count` nodes, all of them finite, over a domain that passes [`Self::check_domain`].
    pub(crate) fn over(side: u32, domain: [[f32; 3]; 2], nodes: Vec<[f32; 4]>) -> Self {
        Self { side, domain, nodes }
    }

    /// Errors: INVALID_ARGUMENT for a bound that is out of range, and for a lower one that is not below the upper.
    pub(super) fn check_domain([low, high]: [[f32; 3]; 2]) -> Result<()> {
        for (component, (low, high)) in ["red", "green", "blue"].into_iter().zip(low.into_iter().zip(high)) {
            for (name, bound) in [("DOMAIN_MIN", low), ("DOMAIN_MAX", high)] {
                if !(-MOST_BOUND..=MOST_BOUND).contains(&bound) {
                    return Err(Error::argument(format!(
                        "{name} of {component} is {bound:?}; it must lie in [-{MOST_BOUND}, {MOST_BOUND}]"
                    )));
                }
            }
            if high - low < LEAST_WIDTH {
                return Err(Error::argument(format!(
                    "DOMAIN_MIN of {component} is {low:?} and DOMAIN_MAX {high:?}; it must be less, by {LEAST_WIDTH:?} \
                     at least"
                )));
            }
        }
        Ok(())
    }

    /// Nodes along each side.
    pub fn side(&self) -> u32 {
        self.side
    }

    /// The colours of the first node and of the last one.
    pub fn domain(&self) -> [[f32; 3]; 2] {
        self.domain
    }

    /// Red, green, blue and 0, as textures have them; red changes fastest, then green.
    pub fn nodes(&self) -> &[[f32; 4]] {
        &self.nodes
    }
}
