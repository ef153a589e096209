// SPDX-License-Identifier: MIT OR Apache-2.0
// The moment at which the sample at hand sees matter that moves: Shutter::moment of src/emit/moment.rs.

// Its time less that of the frame, M. Kernels set it from pass_.moment.
var<private> moment: f32;
