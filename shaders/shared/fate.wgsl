// How a ray ends. src/physics/trace.rs has the same.

// Not known yet: a later kernel finds out.
const FATE_PENDING: u32 = 4u;
