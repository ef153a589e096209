// SPDX-License-Identifier: MIT OR Apache-2.0
//! Places on lattices that go around, for gradient noise of two and of three dimensions (`streaks`, `filaments`). Knows
//! no noise.

/// A place between the lines or planes of a lattice along one direction: the two, the distance from the first, and its
/// smooth share.
#[derive(Clone, Copy)]
pub struct Between {
    pub sides: [usize; 2],
    pub offset: f32,
    pub share: f32,
}

impl Between {
    /// `cells`: the place in cells, from 0 on; `count` of them make a period.
    pub fn new(cells: f32, count: usize) -> Self {
        let whole = cells as usize;
        let offset = cells - whole as f32;
        let first = whole % count;
        // Goes from 0 to 1 with two continuous derivatives (Perlin 2002).
        let share = offset * offset * offset * (offset * (offset * 6.0 - 15.0) + 10.0);
        Self { sides: [first, (first + 1) % count], offset, share }
    }
}
