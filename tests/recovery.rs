// SPDX-License-Identifier: MIT OR Apache-2.0
//! A GPU device that is really destroyed under a running context: every call that needs it says so until the context
//! is recovered, and the scene comes back. Through the C API. Needs a Vulkan and a GL adapter (Mesa's software drivers
//! will do); the tests with a window need an X server too and are run by tests/windows/run.
#![cfg(target_os = "linux")]

use bhr::capi::adapter::*;
use bhr::capi::camera::*;
use bhr::capi::context::*;
use bhr::capi::hole::*;
use bhr::capi::image::*;
use bhr::capi::job::*;
use bhr::capi::preset::*;
use bhr::capi::rays::*;
use bhr::capi::render::*;
use bhr::capi::stats::*;
use bhr::capi::status::*;
use bhr::capi::surface::*;
use bhr::capi::version::*;
use bhr::capi::window::*;
use std::ffi::CStr;
use std::ptr::{null, null_mut};
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt, CreateWindowAux, ImageFormat, WindowClass};
use x11rb::xcb_ffi::XCBConnection;

const SIZE: [u16; 2] = [160, 90];
const BYTES: usize = SIZE[0] as usize * SIZE[1] as usize * 4;

/// A context on a GPU, with a scene of its own. The calls on it are safe: it lives as long as this does, and all else
/// is of the test's.
struct Context(*mut BhrContext);

impl Context {
    fn new(backend: BhrBackend) -> Self {
        let mut context = null_mut();
        // SAFETY: everything lives here.
        unsafe {
            let mut options = std::mem::zeroed::<BhrContextOptions>();
            assert_eq!(bhr_context_options_init(&mut options, size_of_val(&options)), BHR_OK);
            options.backend = backend;
            assert_eq!(bhr_context_create(BHR_ABI_VERSION, &options, &mut context), BHR_OK, "{}", message());
            assert_eq!(bhr_set_mass(context, 1.5), BHR_OK);
            assert_eq!(bhr_set_spin(context, 0.6), BHR_OK);
            let mut camera = std::mem::zeroed::<BhrCamera>();
            assert_eq!(bhr_camera_init(&mut camera, size_of_val(&camera)), BHR_OK);
            assert_eq!(bhr_camera_orbit(&mut camera, 30.0, 0.3, 0.2), BHR_OK);
            assert_eq!(bhr_set_camera(context, &camera), BHR_OK);
        }
        Self(context)
    }

    fn lose_device(&self) {
        // SAFETY: see `Context`.
        assert_eq!(unsafe { lose_device(self.0) }, BHR_OK);
    }

    fn recover(&self) {
        // SAFETY: see `Context`.
        assert_eq!(unsafe { bhr_context_recover(self.0) }, BHR_OK, "{}", message());
    }

    fn render(&self, format: BhrFormat) -> Result<Vec<u8>, BhrStatus> {
        let mut pixels = vec![0; BYTES];
        let image = image(&mut pixels, format);
        // SAFETY: see `Context`; the pixels outlive the call.
        match unsafe { bhr_render_image(self.0, &image) } {
            BHR_OK => Ok(pixels),
            status => Err(status),
        }
    }

    fn trace(&self) -> BhrStatus {
        // SAFETY: see `Context`; plain data.
        unsafe {
            let mut ray = std::mem::zeroed::<BhrRay>();
            let mut hit = std::mem::zeroed::<BhrHit>();
            assert_eq!(bhr_camera_ray(self.0, 160, 90, 80.0, 45.0, &mut ray), BHR_OK);
            bhr_trace_rays(self.0, &ray, size_of::<BhrRay>(), 1, &mut hit, size_of::<BhrHit>())
        }
    }

    fn order(&self, pixels: &mut [u8]) -> Result<*mut BhrJob, BhrStatus> {
        let image = image(pixels, BHR_FORMAT_RGBA8_SRGB);
        let mut job = null_mut();
        // SAFETY: see `Context`; the tests keep the pixels until they destroy the job.
        match unsafe { bhr_render_image_async(self.0, &image, &mut job) } {
            BHR_OK => Ok(job),
            status => Err(status),
        }
    }

    fn frames(&self) -> u64 {
        // SAFETY: see `Context`; plain data.
        unsafe {
            let mut stats = std::mem::zeroed::<BhrFrameStats>();
            stats.struct_size = size_of::<BhrFrameStats>() as u32;
            assert_eq!(bhr_frame_stats(self.0, &mut stats), BHR_OK);
            stats.frame_index
        }
    }
}

impl Drop for Context {
    fn drop(&mut self) {
        // SAFETY: made by `new`, destroyed once.
        unsafe { bhr_context_destroy(self.0) };
    }
}

fn image(pixels: &mut [u8], format: BhrFormat) -> BhrImage {
    // SAFETY: plain data.
    let mut image = unsafe { std::mem::zeroed::<BhrImage>() };
    image.struct_size = size_of::<BhrImage>() as u32;
    image.format = format;
    (image.width, image.height) = (SIZE[0].into(), SIZE[1].into());
    image.pixels = pixels.as_mut_ptr().cast();
    image.byte_size = pixels.len() as u64;
    image
}

fn message() -> String {
    // SAFETY: a C string of this thread's.
    unsafe { CStr::from_ptr(bhr_error_message()) }.to_str().unwrap().to_owned()
}

#[test]
fn a_lost_device_is_said_until_it_is_recovered_and_the_scene_comes_back() {
    recovers(BHR_BACKEND_VULKAN);
}

#[test]
fn a_lost_device_of_gl_comes_back_too() {
    recovers(BHR_BACKEND_GL);
}

fn recovers(backend: BhrBackend) {
    let context = Context::new(backend);
    let before = context.render(BHR_FORMAT_RGBA8_SRGB).unwrap();
    assert_eq!(context.trace(), BHR_OK);
    for round in 0..2 {
        context.lose_device();
        for _ in 0..2 {
            assert_eq!(context.render(BHR_FORMAT_RGBA8_SRGB).unwrap_err(), BHR_ERROR_DEVICE_LOST);
            assert!(message().contains("lost"), "{}", message());
            assert_eq!(context.trace(), BHR_ERROR_DEVICE_LOST);
            assert_eq!(context.order(&mut vec![0; BYTES]).unwrap_err(), BHR_ERROR_DEVICE_LOST);
            // A look that would have to be timed, in a scene that stays as it is.
            // SAFETY: the context lives, and the options and the choice may be NULL.
            unsafe {
                let status = bhr_set_preset_with(context.0, BHR_PRESET_OBSERVATORY, null(), null_mut());
                assert_eq!(status, BHR_ERROR_DEVICE_LOST, "{}", message());
            }
        }
        let frames = context.frames();
        // Calls that need no device go on.
        unsafe {
            assert_eq!(bhr_set_spin(context.0, 0.1), BHR_OK);
            assert_eq!(bhr_set_spin(context.0, 0.6), BHR_OK);
        }
        context.recover();
        assert_eq!(context.render(BHR_FORMAT_RGBA8_SRGB).unwrap(), before, "round {round}");
        assert_eq!(context.trace(), BHR_OK);
        assert_eq!(context.frames(), frames + 1);
    }
    // A healthy one may be recovered too.
    context.recover();
    assert_eq!(context.render(BHR_FORMAT_RGBA8_SRGB).unwrap(), before);
}

#[test]
fn jobs_of_a_lost_device_end() {
    jobs_end(BHR_BACKEND_VULKAN);
}

#[test]
fn jobs_of_a_lost_device_of_gl_end() {
    jobs_end(BHR_BACKEND_GL);
}

fn jobs_end(backend: BhrBackend) {
    let context = Context::new(backend);
    let before = context.render(BHR_FORMAT_RGBA8_SRGB).unwrap();
    let mut targets = (0..8).map(|_| vec![0; BYTES]).collect::<Vec<_>>();
    let jobs = targets.iter_mut().map(|pixels| context.order(pixels).unwrap()).collect::<Vec<_>>();
    context.lose_device();
    let mut lost = 0;
    for (job, pixels) in jobs.iter().zip(&targets) {
        // SAFETY: the jobs live until the end of this loop's body.
        let status = unsafe { bhr_job_wait(*job, 60_000_000_000, null_mut()) };
        match status {
            BHR_OK => assert_eq!(pixels, &before),
            BHR_ERROR_DEVICE_LOST => lost += 1,
            other => panic!("{other}: {}", message()),
        }
    }
    assert!(lost > 0, "eight frames were traced faster than a device was destroyed");
    context.recover();
    let mut pixels = vec![0; BYTES];
    let after = context.order(&mut pixels).unwrap();
    // SAFETY: as above; each is destroyed once.
    unsafe {
        assert_eq!(bhr_job_wait(after, u64::MAX, null_mut()), BHR_OK, "{}", message());
        assert_eq!(bhr_job_wait(jobs[7], 0, null_mut()), BHR_ERROR_DEVICE_LOST, "an old job keeps its end");
        jobs.into_iter().chain([after]).for_each(|job| bhr_job_destroy(job));
    }
    assert_eq!(pixels, before);
}

/// Waits for the jobs, which are finished or lost, and destroys them.
fn finish(jobs: Vec<*mut BhrJob>) {
    for job in jobs {
        // SAFETY: each job is destroyed once, here.
        unsafe {
            let status = bhr_job_wait(job, 60_000_000_000, null_mut());
            assert!([BHR_OK, BHR_ERROR_DEVICE_LOST].contains(&status), "{status}: {}", message());
            bhr_job_destroy(job);
        }
    }
}

/// While jobs are traced and copied, and other threads trace rays and watch the jobs.
#[test]
fn the_device_may_end_at_any_moment_of_jobs() {
    struct Shared<'a>(&'a Context);
    // SAFETY: any thread may call the API.
    unsafe impl Sync for Shared<'_> {}
    let context = Context::new(BHR_BACKEND_VULKAN);
    assert!(context.render(BHR_FORMAT_RGBA8_SRGB).is_ok());
    for round in 0..8_u64 {
        let mut targets = (0..4).map(|_| vec![0; BYTES]).collect::<Vec<_>>();
        let jobs = targets.iter_mut().map(|pixels| context.order(pixels).unwrap()).collect::<Vec<_>>();
        let shared = Shared(&context);
        let shared = &shared;
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(move || {
                    let statuses = (0..1000).map(|_| shared.0.trace()).find(|status| *status != BHR_OK);
                    assert!(
                        statuses.is_none_or(|status| status == BHR_ERROR_DEVICE_LOST),
                        "{statuses:?}: {}",
                        message()
                    );
                });
            }
            std::thread::sleep(std::time::Duration::from_micros(1500 * round));
            shared.0.lose_device();
            finish(jobs);
        });
        context.recover();
        assert!(context.render(BHR_FORMAT_RGBA8_SRGB).is_ok(), "round {round}: {}", message());
    }
}

/// A window on the X server that the environment names.
struct XWindow {
    connection: XCBConnection,
    id: u32,
}

impl XWindow {
    fn new() -> Self {
        let (connection, screen) = XCBConnection::connect(None).expect("an X server: tests/windows/run starts one");
        let id = connection.generate_id().unwrap();
        let screen = &connection.setup().roots[screen];
        let [width, height] = SIZE;
        let (root, visual, copy) = (screen.root, screen.root_visual, x11rb::COPY_DEPTH_FROM_PARENT);
        let class = WindowClass::INPUT_OUTPUT;
        let extras = CreateWindowAux::new().override_redirect(1);
        connection.create_window(copy, id, root, 0, 0, width, height, 0, class, visual, &extras).unwrap();
        connection.map_window(id).unwrap().check().unwrap();
        Self { connection, id }
    }

    /// BGRX, row by row.
    fn grab(&self) -> Vec<u8> {
        let [width, height] = SIZE;
        let got = self.connection.get_image(ImageFormat::Z_PIXMAP, self.id, 0, 0, width, height, !0).unwrap();
        got.reply().unwrap().data
    }

    fn surface(&self, context: &Context) -> *mut BhrSurface {
        // SAFETY: plain data.
        let mut window = unsafe { std::mem::zeroed::<BhrWindow>() };
        window.struct_size = size_of::<BhrWindow>() as u32;
        window.kind = BHR_WINDOW_XCB;
        window.display = self.connection.get_raw_xcb_connection();
        window.id = self.id.into();
        let mut surface = null_mut();
        let [width, height] = SIZE.map(u32::from);
        // SAFETY: the window outlives the surfaces of these tests.
        let status =
            unsafe { bhr_surface_create(context.0, &window, width, height, BHR_PRESENT_IMMEDIATE, &mut surface) };
        assert_eq!(status, BHR_OK, "{}", message());
        surface
    }
}

/// Windows of two tests at once would lie over each other.
fn alone_on_the_display() -> std::sync::MutexGuard<'static, ()> {
    static DISPLAY: std::sync::Mutex<()> = std::sync::Mutex::new(());
    DISPLAY.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

#[test]
#[ignore = "needs an X server: run by tests/windows/run"]
fn a_window_is_shown_again_after_the_recovery() {
    let _alone = alone_on_the_display();
    let window = XWindow::new();
    let context = Context::new(BHR_BACKEND_VULKAN);
    let wanted = context.render(BHR_FORMAT_BGRA8_SRGB).unwrap();
    let mut surface = window.surface(&context);
    // SAFETY: context and surfaces live where they are used; each surface is destroyed once.
    unsafe {
        for round in 0..3 {
            assert_eq!(bhr_render_surface(context.0, surface), BHR_OK, "{}", message());
            context.lose_device();
            assert_eq!(bhr_render_surface(context.0, surface), BHR_ERROR_DEVICE_LOST, "{}", message());
            assert_eq!(bhr_render_surface(context.0, surface), BHR_ERROR_DEVICE_LOST, "{}", message());
            context.recover();
            assert_eq!(bhr_render_surface(context.0, surface), BHR_ERROR_SURFACE_LOST);
            assert_eq!(bhr_surface_resize(surface, 10, 10), BHR_ERROR_SURFACE_LOST);
            // Before the old one is destroyed, or after it.
            let old = surface;
            if round % 2 == 0 {
                surface = window.surface(&context);
                bhr_surface_destroy(old);
            } else {
                bhr_surface_destroy(old);
                surface = window.surface(&context);
            }
            for _ in 0..3 {
                assert_eq!(bhr_render_surface(context.0, surface), BHR_OK, "{}", message());
            }
            let mut shown = window.grab();
            // Presenting is not waited for.
            for _ in 0..50 {
                shown.iter_mut().skip(3).step_by(4).for_each(|x| *x = 255);
                if shown == wanted {
                    break;
                }
                std::thread::sleep(std::time::Duration::from_millis(20));
                shown = window.grab();
            }
            let far = shown.iter().zip(&wanted).filter(|(a, b)| a.abs_diff(**b) > 1).count();
            assert_eq!(far, 0, "round {round}: {far} bytes differ by more than a step");
        }
        context.lose_device();
        bhr_surface_destroy(surface);
    }
}

/// While a window is shown and jobs run beside it.
#[test]
#[ignore = "needs an X server: run by tests/windows/run"]
fn the_device_may_end_at_any_moment_of_a_window() {
    let _alone = alone_on_the_display();
    let window = XWindow::new();
    let context = Context::new(BHR_BACKEND_VULKAN);
    let mut shown = 0;
    for round in 0..8_u64 {
        let surface = window.surface(&context);
        let mut targets = (0..4).map(|_| vec![0; BYTES]).collect::<Vec<_>>();
        let jobs = targets.iter_mut().map(|pixels| context.order(pixels).unwrap()).collect::<Vec<_>>();
        let loser = context.0 as usize;
        let losing = std::thread::spawn(move || {
            std::thread::sleep(std::time::Duration::from_micros(1500 * round));
            // SAFETY: the context lives until this thread was joined.
            assert_eq!(unsafe { lose_device(loser as *mut BhrContext) }, BHR_OK);
        });
        // SAFETY: context and surface live; the surface is destroyed once.
        unsafe {
            let mut status = BHR_OK;
            while status == BHR_OK || status == BHR_FRAME_SKIPPED {
                status = bhr_render_surface(context.0, surface);
                shown += u32::from(status == BHR_OK);
            }
            assert_eq!(status, BHR_ERROR_DEVICE_LOST, "round {round}: {}", message());
            losing.join().unwrap();
            if round % 2 == 0 {
                bhr_surface_destroy(surface);
                finish(jobs);
            } else {
                finish(jobs);
                bhr_surface_destroy(surface);
            }
        }
        context.recover();
    }
    assert!(shown > 0);
}
