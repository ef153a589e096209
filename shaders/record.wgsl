// The ray record of a pixel: the one interface between lensing and shading. src/cpu/record.rs has the same fields.
//
// The record of pixel i: word k is records[k * pixels + i].
const RECORD_DIRECTION: u32 = 0u;
const RECORD_SKY_REDSHIFT: u32 = 3u;
// Bits 0 .. 1 the fate, of a ray that ended on the opaque disk FATE_HIDDEN; bit 16 + k: the crossing of order k is the disk's.
const RECORD_META: u32 = 4u;
// E and L, scaled so that the local frame's observer measures 1; of frames with an effect switched off.
const RECORD_ENERGY: u32 = 5u;
const RECORD_ANGULAR_MOMENTUM: u32 = 6u;
const RECORD_STEPS: u32 = 7u;
// 1/r of the first crossing of the plane wherever it is, 0 without one; of frames that show it.
const RECORD_PLANE: u32 = 8u;
// u, g, azimuth, delay of each crossing within the disk, in order.
const RECORD_CROSSINGS: u32 = 9u;
const RECORD_CROSSING_WORDS: u32 = 4u;
