// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrContext: one `Renderer` behind a lock, with its region, callbacks and log. Makes and ends it; what is drawn
//! is set elsewhere.

use super::adapter::{self, BHR_BACKEND_AUTO, BhrAdapterInfo, BhrBackend};
use super::call::{Locked, on_context};
use super::entry::{anywhere, destroy, finish, outside_callbacks};
use super::gate::{AT_THE_END, Gate};
use super::log::{self, BHR_LOG_WARN, BhrLogFn, BhrLogLevel, Registered, Sink};
use super::message::{LastMessage, copy_last};
use super::panic::guarded_always;
use super::pointer::{Out, check_flags};
use super::state::{Files, State};
use super::status::BhrStatus;
use super::version::BHR_ABI_VERSION;
use super::versioned::{self, OutStruct, POINTER, Versioned};
use super::window::{self, BhrWindow};
use crate::error::{Error, ErrorKind, Result};
use crate::gpu::{HostVulkan, ReleaseGuard, process_end};
use crate::renderer::{Renderer, RendererOptions};
use crate::tracer::Backend;
use ::log::LevelFilter;
use parking_lot::Mutex;
use std::ffi::{c_char, c_void};
use std::ptr::{null, null_mut};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A scene and what traces it.
pub struct BhrContext {
    pub(super) state: Mutex<State>,
    /// A call, or a job, failed internally.
    pub(super) broken: Arc<AtomicBool>,
    /// The gate that progress callbacks of jobs pass through; jobs may outlive the context.
    pub(super) progress_gate: Arc<Gate>,
    /// The message of the last call that failed on this context or on a surface of its; surfaces may outlive it.
    pub(super) message: Arc<LastMessage>,
    /// Dropped after `state`, so that a renderer's last messages are still heard.
    log: Option<Registered>,
}

// Any thread may call.
const _: () = {
    const fn shared<T: Send + Sync>() {}
    shared::<BhrContext>();
};

impl BhrContext {
    pub(super) fn sink(&self) -> Option<Arc<Sink>> {
        self.log.as_ref().map(Registered::sink)
    }
}

impl Locked for BhrContext {
    fn state(&self) -> &Mutex<State> {
        &self.state
    }

    fn broken(&self) -> &AtomicBool {
        &self.broken
    }

    fn message(&self) -> &Arc<LastMessage> {
        &self.message
    }

    fn log_sink(&self) -> Option<Arc<Sink>> {
        self.sink()
    }
}

/// BhrContextOptions.flags: the driver's validation layers check bhr and report to the log. Slow. Ignored where they
/// are not installed, and by OpenGL, which has none.
pub const BHR_CONTEXT_VALIDATION: u32 = 1u32;

/// How to make a context. Fill in with bhr_context_options_init first.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct BhrContextOptions {
    /// sizeof(BhrContextOptions).
    pub struct_size: u32,
    /// BHR_CONTEXT_* bits. Default 0.
    pub flags: u32,
    /// Default BHR_BACKEND_AUTO.
    pub backend: BhrBackend,
    /// Index for bhr_adapter_info; its backend must be the one above, unless that is AUTO. -1 (default): the library
    /// chooses. A struct that was zeroed instead of initialised asks for adapter 0.
    pub adapter_index: i32,
    /// Threads of the CPU tracer, 0 .. 1024. 0 (default): one per core that this process may use.
    pub cpu_threads: u32,
    /// The messages that log_fn is told: this level and the more severe ones. Default BHR_LOG_WARN.
    pub log_level: BhrLogLevel,
    /// NULL (default): silent.
    pub log_fn: BhrLogFn,
    /// Handed to log_fn.
    pub log_user: *mut c_void,
    /// A window that the adapter must be able to present to; it is looked at during the call only. With AUTO,
    /// adapters that cannot are passed over; the CPU tracer always qualifies. NULL (default): any adapter; where it
    /// cannot present, surfaces work all the same, more slowly. GL adapters never present. docs/window.md.
    pub compatible_window: *const BhrWindow,
}

const MAX_CPU_THREADS: u32 = 1024;

// SAFETY: repr(C), size first, no padding, integers and nullable pointers.
unsafe impl Versioned for BhrContextOptions {
    const NAME: &'static str = "BhrContextOptions";
    const SIZES: &'static [usize] = &[24 + 3 * POINTER];
    fn defaults() -> Self {
        Self {
            struct_size: 0,
            flags: 0,
            backend: BHR_BACKEND_AUTO,
            adapter_index: -1,
            cpu_threads: 0,
            log_level: BHR_LOG_WARN,
            log_fn: None,
            log_user: null_mut(),
            compatible_window: null(),
        }
    }
}

impl BhrContextOptions {
    /// # Safety
    /// `compatible_window` is NULL or points to a BhrWindow.
    unsafe fn check(&self) -> Result<(RendererOptions, LevelFilter)> {
        let flags = check_flags(self.flags, BHR_CONTEXT_VALIDATION, "options flags")?;
        let backend = adapter::backend(self.backend)?;
        let adapter_index = match self.adapter_index {
            -1 => None,
            index => Some(u32::try_from(index).map_err(|_| {
                Error::argument(format!(
                    "options adapter_index is {index}; it must be -1 or an index for bhr_adapter_info"
                ))
            })?),
        };
        if self.cpu_threads > MAX_CPU_THREADS {
            return Err(Error::argument(format!(
                "options cpu_threads is {}; it must lie in [0, {MAX_CPU_THREADS}]",
                self.cpu_threads
            )));
        }
        // SAFETY: this function's contract.
        let compatible_window = (!self.compatible_window.is_null())
            .then(|| unsafe { window::read(self.compatible_window, "options compatible_window") })
            .transpose()?;
        let options = RendererOptions {
            backend,
            adapter_index,
            cpu_threads: self.cpu_threads,
            validation: flags & BHR_CONTEXT_VALIDATION != 0,
            compatible_window,
        };
        Ok((options, log::level_filter(self.log_level)?))
    }

    fn register_log(&self, level: LevelFilter) -> Option<Registered> {
        let function = self.log_fn?;
        (level > LevelFilter::Off).then(|| Registered::new(level, function, self.log_user))
    }
}

/// Fills in the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_context_options_init(options: *mut BhrContextOptions, struct_size: usize) -> BhrStatus {
    // SAFETY: NULL or struct_size writable bytes, by the header's conventions.
    anywhere("bhr_context_options_init", || unsafe { versioned::init(options, "options", struct_size) })
}

/// Makes a context with the default scene: BHR_PRESET_CINEMATIC about a hole of mass 1 without spin, with a camera
/// at (0, 26, 2.5) that looks at it. abi_version is BHR_ABI_VERSION; options NULL means all defaults. With
/// BHR_BACKEND_AUTO it succeeds on every machine: an adapter that cannot be opened is passed over, and the log says
/// why. End *out_context with bhr_context_destroy.
/// Errors: INCOMPATIBLE_ABI; INVALID_ARGUMENT for a compatible_window that does not exist (X11, Windows); UNSUPPORTED
/// for a compatible_window of another platform, for any in a library built without the cargo feature window, and for
/// BHR_BACKEND_GL in one built without gl; NO_ADAPTER when the backend or adapter asked for is not there, cannot be
/// opened, or cannot present to compatible_window.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_context_create(
    abi_version: u32,
    options: *const BhrContextOptions,
    out_context: *mut *mut BhrContext,
) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let out = Out::cleared(out_context);
        outside_callbacks("bhr_context_create", || {
            out.required("out_context")?;
            check_abi(abi_version)?;
            let given =
                if options.is_null() { BhrContextOptions::defaults() } else { versioned::read(options, "options")? };
            let (options, level) = given.check()?;
            out.set(Box::into_raw(create(options, given.register_log(level))?));
            Ok(())
        })
    }
}

fn check_abi(abi_version: u32) -> Result<()> {
    if abi_version == BHR_ABI_VERSION {
        return Ok(());
    }
    Err(Error::new(
        ErrorKind::IncompatibleAbi,
        format!("abi_version is {abi_version}, this library's is {BHR_ABI_VERSION}: compile against its own bhr.h"),
    ))
}

/// On a device of the host's. Errors: as `bhr_context_create_vulkan`.
///
/// # Safety
/// `options` is NULL or valid.
pub(super) unsafe fn create_on_host(
    abi_version: u32,
    options: *const BhrContextOptions,
    host: HostVulkan,
    release: &Arc<ReleaseGuard>,
) -> Result<Box<BhrContext>> {
    check_abi(abi_version)?;
    // SAFETY: this function's contract.
    let given = match options.is_null() {
        true => BhrContextOptions::defaults(),
        false => unsafe { versioned::read(options, "options") }?,
    };
    // SAFETY: as above.
    let (options, level) = unsafe { given.check() }?;
    if !matches!(options.backend, None | Some(Backend::Vulkan)) {
        let backend = given.backend;
        return Err(Error::argument(format!("options backend is {backend}; here it must be AUTO (0) or VULKAN (2)")));
    }
    if options.adapter_index.is_some() || options.validation || options.compatible_window.is_some() {
        return Err(Error::argument(
            "options must have adapter_index -1, no BHR_CONTEXT_VALIDATION and compatible_window NULL here: the host's \
             instance decides",
        ));
    }
    create_with(given.register_log(level), || Renderer::on_host(options, host, release))
}

fn create(options: RendererOptions, log: Option<Registered>) -> Result<Box<BhrContext>> {
    create_with(log, || Renderer::new(options))
}

fn create_with(log: Option<Registered>, make: impl FnOnce() -> Result<Renderer>) -> Result<Box<BhrContext>> {
    let scope = log::Scope::enter(log.as_ref().map(Registered::sink));
    // Outside this scope the new callback would not hear why there is no context.
    let renderer = make().inspect_err(|error| ::log::error!(target: "bhr", "no context: {error}"))?;
    let adapter = renderer.adapter();
    ::log::info!(target: "bhr", "context on {} ({})", adapter.name, adapter.backend);
    drop(scope);
    let state = Mutex::new(State { renderer, region: None, progress: None, loaded: None, files: Files::default() });
    let message = Arc::new(LastMessage::new());
    Ok(Box::new(BhrContext { state, broken: Arc::default(), progress_gate: Arc::default(), message, log }))
}

/// Fills in info for the adapter that the context runs on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_context_adapter(context: *const BhrContext, info: *mut BhrAdapterInfo) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let info = OutStruct::cleared(info, "info");
        on_context("bhr_context_adapter", context, |state| info.set(&BhrAdapterInfo::from(state.renderer.adapter())))
    }
}

/// Opens the device anew after DEVICE_LOST, on the same adapter if it is still there; until then every call that
/// renders or traces returns DEVICE_LOST, while setters go on working. The scene stays, the sky's map included, but
/// for a sky or an occluder in a target (bhr_interop.h): set those anew. Surfaces made before are lost: destroy them
/// and make them again. Jobs that were unfinished fail with DEVICE_LOST.
/// Errors: those of bhr_context_create, after which the context stays lost, and the call may be tried again;
/// UNSUPPORTED on a device of the host's (bhr_context_create_vulkan).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_context_recover(context: *mut BhrContext) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe { on_context("bhr_context_recover", context, |state| state.renderer.recover()) }
}

/// For tests: from now on a submission that takes longer than this has hung, instead of 60 s.
#[doc(hidden)]
pub fn hangs_after(time: std::time::Duration) {
    crate::gpu::set_hangs_after(time);
}

/// Destroys the GPU device under a context, as a driver may at any time: for tests of the recovery.
#[doc(hidden)]
pub unsafe fn lose_device(context: *mut BhrContext) -> BhrStatus {
    // SAFETY: NULL or valid, as for the API.
    unsafe { on_context("lose_device", context, |state| state.renderer.lose_device()) }
}

/// Has a call of a context's GPU device fail, `passing` calls of the name `what` from now: for tests.
#[doc(hidden)]
pub unsafe fn fail_device(context: *mut BhrContext, what: &'static str, passing: u32) -> BhrStatus {
    // SAFETY: NULL or valid, as for the API.
    unsafe {
        on_context("fail_device", context, |state| {
            state.renderer.fail_device(what, passing);
            Ok(())
        })
    }
}

/// Copies the message of the last call that failed on this context or on one of its surfaces, on whichever thread,
/// into buffer: at most size - 1 bytes, cut between characters, and a NUL; nothing when buffer is NULL or size
/// is 0. Returns the length of the whole message in bytes without its NUL, less than 10,000; 0 when no call has
/// failed, and for a NULL context. It waits for no other call. Where other threads make failing calls meanwhile, the
/// message may be one of theirs. For hosts whose calls move between threads: docs/errors.md. @since 0.2.0
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_context_error_message(
    context: *const BhrContext,
    buffer: *mut c_char,
    size: usize,
) -> usize {
    // SAFETY: NULL or alive, and size writable bytes, by the header's conventions.
    unsafe { copy_last(context.as_ref().map(|context| &*context.message), buffer, size) }
}

/// Ends a context and frees it, when a call that is running on it and its jobs are done (bhr_job_cancel shortens
/// that); pipelines that are being compiled may take up to a second more. Its surfaces end too, but both they and
/// its jobs must still be destroyed, before or after. NULL is a no-op. No callback runs after it has returned, and
/// no other thread may begin a call on it any more. From inside a callback it does nothing, as the context is in
/// use: bhr_error_message then says so. A process may also end without it: docs/process.md.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_context_destroy(context: *mut BhrContext) {
    const NAME: &str = "bhr_context_destroy";
    // SAFETY: bhr_context_create made it with Box::into_raw, and the host destroys it once.
    unsafe { destroy(NAME, context, |context| end(NAME, context)) }
}

fn end(function: &str, context: Box<BhrContext>) {
    let scope = log::Scope::enter(context.sink());
    let ending = process_end::is_here();
    // A running call holds the lock. In the end of the process it may wait for what does not come any more.
    let idle = if ending { context.state.try_lock_for(AT_THE_END) } else { Some(context.state.lock()) };
    let Some(uses_driver) = idle.map(|state| state.renderer.adapter().backend != Backend::Cpu) else {
        context.progress_gate.close();
        context.log.iter().for_each(Registered::end);
        return process_end::keep(context);
    };
    let BhrContext { state, log, progress_gate, .. } = *context;
    if uses_driver && ending {
        process_end::keep(state);
    } else {
        let result = guarded_always(|| {
            drop(state);
            Ok(())
        });
        finish(function, result);
    }
    progress_gate.close();
    drop(scope);
    drop(log);
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::capi::adapter::BHR_BACKEND_CPU;
    use crate::capi::status::{BHR_ERROR_INCOMPATIBLE_ABI, BHR_OK};

    /// A context on the CPU tracer for the tests of this room.
    pub struct Owned(*mut BhrContext);

    impl Owned {
        pub fn get(&self) -> *mut BhrContext {
            self.0
        }
    }

    impl Drop for Owned {
        fn drop(&mut self) {
            // SAFETY: made by `cpu_context`, destroyed once.
            unsafe { bhr_context_destroy(self.0) };
        }
    }

    pub fn cpu_context() -> Owned {
        let options = BhrContextOptions {
            struct_size: size_of::<BhrContextOptions>() as u32,
            backend: BHR_BACKEND_CPU,
            ..BhrContextOptions::defaults()
        };
        let mut context = null_mut();
        // SAFETY: both live here.
        let status = unsafe { bhr_context_create(BHR_ABI_VERSION, &options, &mut context) };
        assert_eq!(status, BHR_OK);
        Owned(context)
    }

    #[test]
    fn another_abi_is_refused_and_the_out_parameter_cleared() {
        let mut context = std::ptr::dangling_mut();
        // SAFETY: the out-parameter lives here.
        let status = unsafe { bhr_context_create(BHR_ABI_VERSION + 1, null(), &mut context) };
        assert_eq!((status, context.is_null()), (BHR_ERROR_INCOMPATIBLE_ABI, true));
    }
}
