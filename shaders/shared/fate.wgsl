// SPDX-License-Identifier: MIT OR Apache-2.0
// The fate of a ray that is not known yet: a later kernel finds out. The other fates, FATE_*, are those of
// src/physics/trace.rs.

// Not known yet: a later kernel finds out.
const FATE_PENDING: u32 = 4u;
