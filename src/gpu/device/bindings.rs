// SPDX-License-Identifier: MIT OR Apache-2.0
//! Bind groups, kept from frame to frame: the frames of a setup bind the same resources again and again. Knows no
//! kernel.

use crate::deferred::hold;
use std::num::NonZeroU64;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Groups kept at most: some 10 for each setup that takes turns.
const MOST: usize = 64;

/// A device's bind groups. As groups keep alive what they bind, all are let go whenever a buffer or a texture is made,
/// which steady frames do not do: what a new one takes the place of must be gone before, since both together need not
/// fit. And whenever a target goes: the frame that lets go of it last may have bound it after its host ended it.
#[derive(Default)]
pub(in crate::gpu) struct BindGroupCache(Mutex<Vec<CachedGroup>>);

struct CachedGroup {
    layout: wgpu::BindGroupLayout,
    resources: Vec<Resource>,
    group: wgpu::BindGroup,
}

/// A `wgpu::BindingResource` of its own.
enum Resource {
    Buffer(wgpu::Buffer, u64, Option<NonZeroU64>),
    View(wgpu::TextureView),
    Sampler(wgpu::Sampler),
}

impl Resource {
    /// `None` for kinds that bhr does not bind.
    fn of(resource: &wgpu::BindingResource<'_>) -> Option<Self> {
        match resource {
            wgpu::BindingResource::Buffer(part) => Some(Self::Buffer(part.buffer.clone(), part.offset, part.size)),
            wgpu::BindingResource::TextureView(view) => Some(Self::View((*view).clone())),
            wgpu::BindingResource::Sampler(sampler) => Some(Self::Sampler((*sampler).clone())),
            _ => None,
        }
    }

    fn is(&self, resource: &wgpu::BindingResource<'_>) -> bool {
        match (self, resource) {
            (Self::Buffer(buffer, offset, size), wgpu::BindingResource::Buffer(part)) => {
                buffer == part.buffer && *offset == part.offset && *size == part.size
            }
            (Self::View(view), wgpu::BindingResource::TextureView(other)) => view == *other,
            (Self::Sampler(sampler), wgpu::BindingResource::Sampler(other)) => sampler == *other,
            _ => false,
        }
    }
}

impl CachedGroup {
    fn is(&self, layout: &wgpu::BindGroupLayout, resources: &[wgpu::BindingResource<'_>]) -> bool {
        self.layout == *layout
            && self.resources.len() == resources.len()
            && self.resources.iter().zip(resources).all(|(kept, resource)| kept.is(resource))
    }
}

impl BindGroupCache {
    fn lock(&self) -> MutexGuard<'_, Vec<CachedGroup>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The group that was made of these before, if it is still kept.
    pub fn find(
        &self,
        layout: &wgpu::BindGroupLayout,
        resources: &[wgpu::BindingResource<'_>],
    ) -> Option<wgpu::BindGroup> {
        self.lock().iter().find(|kept| kept.is(layout, resources)).map(|kept| kept.group.clone())
    }

    /// Keeps a group, if it binds nothing but what bhr binds.
    pub fn keep(
        &self,
        layout: &wgpu::BindGroupLayout,
        resources: &[wgpu::BindingResource<'_>],
        group: &wgpu::BindGroup,
    ) {
        let Some(resources) = resources.iter().map(Resource::of).collect() else { return };
        // Messages about groups that go wait until the lock is released.
        let _holding = hold();
        let mut kept = self.lock();
        if kept.len() >= MOST {
            kept.clear();
        }
        kept.push(CachedGroup { layout: layout.clone(), resources, group: group.clone() });
    }

    /// Lets all go.
    pub fn clear(&self) {
        let all = std::mem::take(&mut *self.lock());
        drop(all);
    }
}
