// How a ray ends. src/physics/trace.rs has the same.

const FATE_CAPTURED: u32 = 0u;
const FATE_ESCAPED: u32 = 1u;
const FATE_UNRESOLVED: u32 = 2u;
// On something opaque in the plane.
const FATE_HIDDEN: u32 = 3u;
// Not known yet: a later kernel finds out.
const FATE_PENDING: u32 = 4u;
