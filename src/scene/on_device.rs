// SPDX-License-Identifier: MIT OR Apache-2.0
//! A picture on a tracer's device that a scene holds for it: that tracer alone knows what it is, and reads it anew for
//! each frame. Knows no tracers.

use std::any::Any;
use std::sync::Arc;

#[derive(Clone)]
pub struct OnDevice(pub Arc<dyn Any + Send + Sync>);

impl std::fmt::Debug for OnDevice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("OnDevice")
    }
}
