// SPDX-License-Identifier: MIT OR Apache-2.0
//! The scene as plain validated data: hole, camera, disk, sky, film, quality, view. A tracer works on a snapshot of it.
//! May use `physics`, `sky` and `emit`; may not know of C, of pointers or of the GPU.

pub mod film;
pub mod hole;
mod on_device;
pub mod quality;
pub mod rays;
pub mod cell;
pub mod refine;
pub mod sky;
mod spread;
pub mod chart;
pub mod bodies;
pub mod camera;
pub mod occluder;
pub mod record;
pub mod frame;
pub mod matrices;
mod content;
pub mod projection;
pub mod eyes;
mod thin_lens;
pub mod host_rays;
pub mod lensing;
pub mod observer;
mod made;
pub mod preset;
pub mod output;
pub mod query;
pub mod trace;
pub mod project;
#[cfg(test)]
mod rain_tests;

pub use crate::emit::disk::{Disk, DiskReference, EmissionLaw};
pub use crate::emit::effects::{EffectStrengths, Effects};
pub use crate::emit::hot_spot::HotSpot;
pub use crate::emit::volume::{FlowLaw, Shape, Volume};
pub use bodies::{Body, BodyEvent, WorldLineEnd};
pub use camera::{Camera, Eye, Frustum, Motion, Projection, Transport};
pub use chart::Chart;
pub use content::{Scene, SkyPicture, View};
pub use film::{AutoExposure, ColourMap, Film, Filmic, Grade, Optics, ToneMap};
pub use frame::Region;
pub use hole::Hole;
pub use lensing::{KerrThreshold, Lensing};
pub use made::Made;
pub use occluder::{Distances, Occluder};
pub use on_device::OnDevice;
pub use output::{MOST_CROSSINGS, MOST_OUTPUTS, Output, RayOutput, RayOutputKind};
pub use preset::{Preset, PresetMatter};
pub use quality::{LensTables, Method, Quality, VolumeResolution};
pub use rays::{Crossing, Fate, Hit, MAX_CROSSINGS, Ray, Transfer};
pub use sky::Sky;
pub use thin_lens::ThinLens;
