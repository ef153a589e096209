//! Log and progress callbacks through the C API: who hears what, what a call back in gets, and silence after the end.

use bhr::capi::adapter::*;
use bhr::capi::context::*;
use bhr::capi::hole::*;
use bhr::capi::log::*;
use bhr::capi::status::*;
use bhr::capi::version::*;
use std::ffi::{CStr, c_char, c_void};
use std::ptr::{null, null_mut};
use std::sync::Mutex;

/// What a callback saw: its messages, and what calls back in returned.
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
