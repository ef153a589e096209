// SPDX-License-Identifier: MIT OR Apache-2.0
//! A host that draws with GL keeps its context while bhr looks for adapters. Needs EGL with a surfaceless platform,
//! as Mesa has.
#![cfg(target_os = "linux")]

use bhr::gpu::{Search, adapters};
use bhr::renderer::Backend;
use khronos_egl as egl;

/// EGL_PLATFORM_SURFACELESS_MESA of the extension EGL_MESA_platform_surfaceless.
const SURFACELESS: egl::Enum = 0x31DD;

#[test]
fn a_search_leaves_the_hosts_gl_context_current() {
    // SAFETY: loads the system's libEGL, whose initialisers are as sound as those of any system library.
    let host = unsafe { egl::DynamicInstance::<egl::EGL1_5>::load_required() }.expect("libEGL");
    // SAFETY: the surfaceless platform takes the default display alone.
    let display = unsafe { host.get_platform_display(SURFACELESS, egl::DEFAULT_DISPLAY, &[egl::ATTRIB_NONE]) }.unwrap();
    host.initialize(display).unwrap();
    host.bind_api(egl::OPENGL_ES_API).unwrap();
    let wanted = [egl::SURFACE_TYPE, egl::PBUFFER_BIT, egl::RENDERABLE_TYPE, egl::OPENGL_ES2_BIT, egl::NONE];
    let config = host.choose_first_config(display, &wanted).unwrap().expect("a GL ES configuration");
    let version = [egl::CONTEXT_CLIENT_VERSION, 2, egl::NONE];
    let context = host.create_context(display, config, None, &version).unwrap();
    host.make_current(display, None, None, Some(context)).unwrap();

    let found = adapters(Search::All, false);
    assert!(found.iter().any(|a| a.info.backend == Backend::Gl), "no GL adapter, so nothing was tried");
    drop(found);
    assert_eq!(host.get_current_context(), Some(context));
    host.make_current(display, None, None, Some(context)).expect("the host's display still works");
}
