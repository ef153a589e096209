// SPDX-License-Identifier: MIT OR Apache-2.0
//! Log and progress callbacks through the C API: who hears what, what a call back in gets, and silence after the end.

use bhr::capi::adapter::*;
use bhr::capi::context::*;
use bhr::capi::hole::*;
use bhr::capi::log::*;
use bhr::capi::status::*;
use bhr::capi::version::*;
use bhr::gpu::{Buffer, Device, Kernel, Loops, Search, adapters};
use bhr::renderer::Backend;
use std::ffi::{CStr, c_char, c_void};
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use std::sync::{Arc, Mutex, OnceLock, mpsc};
use std::thread::{ThreadId, current};
use std::time::Duration;

/// A callback's record: its messages, and what calls back into the library returned.
#[derive(Default)]
struct Heard {
    context: usize,
    messages: Vec<(BhrLogLevel, String)>,
    statuses: Vec<BhrStatus>,
}

unsafe extern "C" fn hear(user: *mut c_void, level: BhrLogLevel, message: *const c_char) {
    // SAFETY: the tests pass a Mutex<Heard> that outlives the context, and the library a C string.
    let (heard, text) = unsafe { (&*user.cast::<Mutex<Heard>>(), CStr::from_ptr(message)) };
    let mut heard = heard.lock().unwrap();
    heard.messages.push((level, text.to_str().unwrap().to_owned()));
    let context = heard.context as *mut BhrContext;
    let mut other = null_mut();
    let mut count = 0;
    // SAFETY: NULL, or the context that this callback belongs to; the call on it is running.
    unsafe {
        bhr_context_destroy(context);
        heard.statuses.push(bhr_set_mass(context, 2.0));
        heard.statuses.push(bhr_context_create(BHR_ABI_VERSION, null(), &mut other));
        heard.statuses.push(bhr_adapter_count(&mut count));
    }
}

fn create(heard: &Mutex<Heard>, level: BhrLogLevel) -> *mut BhrContext {
    let mut context = null_mut();
    // SAFETY: everything lives here, and `heard` outlives the context.
    unsafe {
        let mut options = std::mem::zeroed::<BhrContextOptions>();
        assert_eq!(bhr_context_options_init(&mut options, size_of_val(&options)), BHR_OK);
        options.backend = BHR_BACKEND_CPU;
        options.log_level = level;
        options.log_fn = Some(hear);
        options.log_user = (&raw const *heard).cast_mut().cast();
        assert_eq!(bhr_context_create(BHR_ABI_VERSION, &options, &mut context), BHR_OK);
    }
    heard.lock().unwrap().context = context.addr();
    heard.lock().unwrap().messages.clear();
    heard.lock().unwrap().statuses.clear();
    context
}

fn mass(context: *const BhrContext) -> f64 {
    let (mut mass, mut spin, mut axis) = (0.0, 0.0, [0.0; 3]);
    // SAFETY: everything lives here.
    assert_eq!(unsafe { bhr_get_hole(context, &mut mass, &mut spin, axis.as_mut_ptr()) }, BHR_OK);
    mass
}

#[test]
fn a_failed_call_is_logged_to_its_context_and_a_call_back_in_is_refused() {
    let (heard, others) = (Mutex::default(), Mutex::default());
    let (context, other) = (create(&heard, BHR_LOG_ERROR), create(&others, BHR_LOG_TRACE));
    // SAFETY: both contexts live until they are destroyed here.
    unsafe {
        assert_eq!(bhr_set_mass(context, -1.0), BHR_ERROR_INVALID_ARGUMENT);
        {
            let heard = heard.lock().unwrap();
            let [(level, message)] = heard.messages.as_slice() else { panic!("{:?}", heard.messages) };
            assert_eq!(*level, BHR_LOG_ERROR);
            assert!(message.contains("bhr_set_mass") && message.contains("-1"), "{message}");
            assert_eq!(heard.statuses, [BHR_ERROR_INVALID_STATE; 3]);
            assert!(others.lock().unwrap().messages.iter().all(|(_, text)| text != message));
        }
        assert_eq!(mass(context), 1.0);
        bhr_context_destroy(context);
        let count = heard.lock().unwrap().messages.len();
        assert_eq!(bhr_set_mass(null_mut(), 1.0), BHR_ERROR_INVALID_ARGUMENT);
        assert_eq!(heard.lock().unwrap().messages.len(), count, "a callback ran after its context's end");
        assert!(others.lock().unwrap().messages.iter().any(|(_, text)| text.contains("context is NULL")));
        bhr_context_destroy(other);
    }
}

#[test]
fn one_context_serves_four_threads() {
    let heard = Mutex::default();
    let context = create(&heard, BHR_LOG_OFF).addr();
    std::thread::scope(|scope| {
        for thread in 1..5 {
            scope.spawn(move || {
                let context = context as *mut BhrContext;
                for round in 0..1000 {
                    // SAFETY: the context lives until all threads have ended.
                    unsafe {
                        assert_eq!(bhr_set_mass(context, f64::from(thread)), BHR_OK);
                        assert_eq!(bhr_set_spin(context, 2.0 + f64::from(round)), BHR_ERROR_INVALID_ARGUMENT);
                        let message = CStr::from_ptr(bhr_error_message()).to_str().unwrap().to_owned();
                        assert!(message.contains(&format!("spin is {}", 2 + round)), "{message}");
                    }
                    assert!((1.0..=4.0).contains(&mass(context)));
                }
            });
        }
    });
    // SAFETY: no call runs any more.
    unsafe { bhr_context_destroy(context as *mut BhrContext) };
    assert!(heard.lock().unwrap().messages.is_empty());
}

const DOUBLE: &str = "
@group(0) @binding(0) var<storage, read_write> values: array<u32>;
@compute @workgroup_size(64)
fn double(@builtin(global_invocation_id) id: vec3<u32>) { values[id.x] *= 2u; }";

/// A device of which the callback of a context without one hears.
struct Watched {
    device: Device,
    layout: wgpu::BindGroupLayout,
    buffer: Buffer,
    /// The thread whose messages count, and how many came.
    thread: ThreadId,
    messages: AtomicU32,
    hung: AtomicU32,
}

impl Watched {
    /// Takes the locks of the device's shaders and uploads; wgpu has much to say meanwhile.
    fn use_device(&self) {
        let kernel = Kernel {
            label: "double",
            source: &[DOUBLE],
            loops: Loops::Counted,
            entry_point: "double",
            constants: &[],
            zero_workgroup_memory: false,
            groups: &[&self.layout],
        };
        self.device.compute_pipeline(&kernel).unwrap();
        self.device.write(&self.buffer, 0, &[0; 4]).unwrap();
    }
}

/// At some of the messages waits for another thread, which does what this one is doing.
unsafe extern "C" fn wait_for_another_thread(user: *mut c_void, _: BhrLogLevel, _: *const c_char) {
    // SAFETY: the test passes the Arc below, which outlives the context.
    let watched = unsafe { &*user.cast::<OnceLock<Arc<Watched>>>() };
    let Some(watched) = watched.get().filter(|watched| watched.thread == current().id()).cloned() else { return };
    if watched.hung.load(Relaxed) > 0 || watched.messages.fetch_add(1, Relaxed) % 4 != 0 {
        return;
    }
    let (tell, told) = mpsc::channel();
    let other = watched.clone();
    std::thread::spawn(move || {
        other.use_device();
        tell.send(()).unwrap();
    });
    if told.recv_timeout(Duration::from_secs(20)).is_err() {
        watched.hung.fetch_add(1, Relaxed);
    }
}

#[test]
fn a_callback_may_wait_for_who_uses_the_same_device() {
    let watched = OnceLock::<Arc<Watched>>::new();
    let mut context = null_mut();
    // SAFETY: everything lives here, and `watched` outlives the context.
    unsafe {
        let mut options = std::mem::zeroed::<BhrContextOptions>();
        assert_eq!(bhr_context_options_init(&mut options, size_of_val(&options)), BHR_OK);
        options.backend = BHR_BACKEND_CPU;
        options.log_level = BHR_LOG_TRACE;
        options.log_fn = Some(wait_for_another_thread);
        options.log_user = (&raw const watched).cast_mut().cast();
        assert_eq!(bhr_context_create(BHR_ABI_VERSION, &options, &mut context), BHR_OK);
    }
    let adapter = adapters(Search::Only(Backend::Vulkan), false).remove(0);
    let device = Device::open(&adapter).unwrap();
    let entry = wgpu::BindGroupLayoutEntry {
        binding: 0,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: false },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let descriptor = wgpu::BindGroupLayoutDescriptor { label: None, entries: &[entry] };
    let layout = device.scoped("layout", |d| d.create_bind_group_layout(&descriptor)).unwrap();
    let buffer = device.buffer("values", 64, wgpu::BufferUsages::COPY_DST).unwrap();
    let (messages, hung) = Default::default();
    let thread = current().id();
    let device = watched.get_or_init(|| Arc::new(Watched { device, layout, buffer, thread, messages, hung }));
    device.use_device();
    assert!(device.messages.load(Relaxed) > 3, "wgpu said {} things", device.messages.load(Relaxed));
    assert_eq!(device.hung.load(Relaxed), 0, "after {} messages", device.messages.load(Relaxed));
    // SAFETY: made above, destroyed once.
    unsafe { bhr_context_destroy(context) };
}
