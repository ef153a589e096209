// SPDX-License-Identifier: MIT OR Apache-2.0
// The exposure that metering found for a frame; it stays for the next one.

struct Exposure {
    // The stops that are added, once a frame has been measured.
    stops: f32,
    measured: u32,
}
