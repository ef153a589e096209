// SPDX-License-Identifier: MIT OR Apache-2.0
//! The values that tracers take and give: frames asked for, tiles, numbers, and the adapters that they run on. The
//! tracers themselves (`cpu`, `gpu`) lie above this room; nothing here knows them.

mod adapter;
mod request;
mod stats;

pub use adapter::{AdapterInfo, Backend};
pub use request::{FrameRequest, OutputSink, Progress, Tile, TileSink};
pub use stats::{FrameStats, PASSES, StatsBoard};
