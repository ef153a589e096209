// SPDX-License-Identifier: MIT OR Apache-2.0
//! The library's parts that a build may go without (Cargo.toml, features): what is missing is UNSUPPORTED and says so,
//! and nothing else is.

use bhr::capi::adapter::*;
use bhr::capi::context::*;
use bhr::capi::image::*;
use bhr::capi::status::*;
use bhr::capi::surface::*;
use bhr::capi::version::*;
use bhr::capi::window::*;
use std::ffi::{CStr, CString};
use std::ptr::{null_mut, without_provenance_mut};

fn message() -> String {
    // SAFETY: the library gives a C string.
    unsafe { CStr::from_ptr(bhr_error_message()) }.to_str().unwrap().to_owned()
}

/// A context of `backend`, or what there was against it.
fn context(backend: BhrBackend, window: Option<&BhrWindow>) -> Result<*mut BhrContext, (BhrStatus, String)> {
    let mut context = null_mut();
    // SAFETY: everything lives here.
    let status = unsafe {
        let mut options = std::mem::zeroed::<BhrContextOptions>();
        assert_eq!(bhr_context_options_init(&mut options, size_of_val(&options)), BHR_OK);
        options.backend = backend;
        options.compatible_window = window.map_or(std::ptr::null(), |window| window);
        bhr_context_create(BHR_ABI_VERSION, &options, &mut context)
    };
    if status == BHR_OK { Ok(context) } else { Err((status, message())) }
}

/// A window that is nowhere; nothing behind its handles is looked at, as no platform has all kinds.
fn window(kind: BhrWindowKind) -> BhrWindow {
    // SAFETY: zeros are a valid BhrWindow.
    let mut window = unsafe { std::mem::zeroed::<BhrWindow>() };
    window.struct_size = size_of::<BhrWindow>() as u32;
    window.kind = kind;
    (window.display, window.handle, window.id) = (without_provenance_mut(64), without_provenance_mut(64), 7);
    window
}

/// Whether a refusal is one for what the library was built without.
fn was_built_without(refused: &(BhrStatus, String), feature: &str) -> bool {
    refused.0 == BHR_ERROR_UNSUPPORTED && refused.1.contains("built without") && refused.1.contains(feature)
}

#[test]
fn windows_are_the_feature_window() {
    // Without the feature no kind is looked at; with it, one of another platform.
    let foreign = if cfg!(windows) { BHR_WINDOW_XCB } else { BHR_WINDOW_WIN32 };
    let kinds = if cfg!(feature = "window") { foreign..=foreign } else { BHR_WINDOW_XLIB..=BHR_WINDOW_ANDROID };
    let cpu = context(BHR_BACKEND_CPU, None).unwrap();
    for kind in kinds {
        let window = window(kind);
        let mut surface = null_mut();
        // SAFETY: everything lives here.
        let status = unsafe { bhr_surface_create(cpu, &window, 64, 48, BHR_PRESENT_VSYNC, &mut surface) };
        let refusals = [(status, message()), context(BHR_BACKEND_AUTO, Some(&window)).unwrap_err()];
        for refused in refusals {
            assert_eq!(refused.0, BHR_ERROR_UNSUPPORTED, "{refused:?}");
            assert_eq!(was_built_without(&refused, "window"), !cfg!(feature = "window"), "{refused:?}");
        }
        assert!(surface.is_null());
    }
    // SAFETY: it was made above.
    unsafe { bhr_context_destroy(cpu) };
}

/// With the feature, GL serves or is not there; without, it is not listed either, and AUTO does without.
#[test]
fn opengl_is_the_feature_gl() {
    match context(BHR_BACKEND_GL, None) {
        // SAFETY: it was made here.
        Ok(context) => unsafe { bhr_context_destroy(context) },
        Err(refused) if cfg!(feature = "gl") => assert_eq!(refused.0, BHR_ERROR_NO_ADAPTER, "{refused:?}"),
        Err(refused) => assert!(was_built_without(&refused, "gl"), "{refused:?}"),
    }
    if cfg!(feature = "gl") {
        return;
    }
    let mut count = 0;
    // SAFETY: everything lives here.
    unsafe {
        assert_eq!(bhr_adapter_count(&mut count), BHR_OK);
        assert!(count >= 1);
        for index in 0..count {
            let mut info = std::mem::zeroed::<BhrAdapterInfo>();
            info.struct_size = size_of_val(&info) as u32;
            assert_eq!(bhr_adapter_info(index, &mut info), BHR_OK);
            assert_ne!(info.backend, BHR_BACKEND_GL);
        }
        bhr_context_destroy(context(BHR_BACKEND_AUTO, None).unwrap());
    }
}

#[test]
fn exr_files_are_the_feature_exr() {
    let path = std::env::temp_dir().join(format!("bhr-features-{}.exr", std::process::id()));
    let name = CString::new(path.to_str().unwrap()).unwrap();
    let mut pixels = [0.5_f32, 1.0, 2.0, 1.0];
    // SAFETY: zeros are a valid BhrImage, and everything lives here.
    let (saved, loaded) = unsafe {
        let mut image = std::mem::zeroed::<BhrImage>();
        assert_eq!(bhr_image_init(&mut image, size_of_val(&image)), BHR_OK);
        (image.format, image.width, image.height) = (BHR_FORMAT_RGBA32F, 1, 1);
        (image.pixels, image.byte_size) = (pixels.as_mut_ptr().cast(), size_of_val(&pixels) as u64);
        let saved = (bhr_image_save(&image, name.as_ptr()), message());
        if !cfg!(feature = "exr") {
            assert!(!path.exists());
            std::fs::write(&path, [0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]).unwrap();
        }
        let loaded = (bhr_image_load(name.as_ptr(), &mut image), message());
        if loaded.0 == BHR_OK {
            assert_eq!(std::slice::from_raw_parts(image.pixels.cast::<f32>(), 4), pixels);
            assert_eq!(bhr_image_release(&mut image), BHR_OK);
        }
        (saved, loaded)
    };
    std::fs::remove_file(&path).unwrap();
    for done in [saved, loaded] {
        match cfg!(feature = "exr") {
            true => assert_eq!(done.0, BHR_OK, "{done:?}"),
            false => assert!(was_built_without(&done, "exr"), "{done:?}"),
        }
    }
}
