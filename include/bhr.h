/* bhr.h -- the C API of bhr, the embeddable black-hole renderer.
 * SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Made by cbindgen from the Rust sources in src/capi; do not edit. A host developer needs to read nothing else: make a
 * context, set the hole and the camera, and render into memory of your own.
 *
 * Sections, in this order, each after a line "---- title ----"
 *   version; status, messages; log; adapters; windows of the host; context; the black hole;
 *   the camera: an observer with a lens; cameras as matrices; accretion disk; matter with depth: volumes and hot spots;
 *   images in the host's memory; sky; film; relativistic effects, time; presets: named looks; quality;
 *   what a pixel shows; parts of a larger frame; rendering into memory; rendering in the background;
 *   outputs beside the picture; the host's things before the camera; rendering into windows;
 *   rays: the same tracer, asked directly; points on the screen; the matter with depth along rays;
 *   numbers about the last finished frame.
 *
 * Example
 *   #include "bhr.h"
 *
 *   static uint8_t pixels[360][640][4];
 *
 *   int main(void)
 *   {
 *       BhrContext *context;
 *       BhrCamera camera;
 *       BhrImage image;
 *       if (bhr_context_create(BHR_ABI_VERSION, NULL, &context) < 0)
 *           return 1; // bhr_error_message() says why, here and below
 *       bhr_set_spin(context, 0.9);
 *       BHR_INIT(camera); // size and defaults
 *       bhr_camera_orbit(&camera, 20.0, 0.0, 0.1); // distance, azimuth, elevation
 *       bhr_set_camera(context, &camera);
 *       BHR_INIT(image); // RGBA8_SRGB, rows without gaps
 *       image.width = 640;
 *       image.height = 360;
 *       image.pixels = pixels;
 *       image.byte_size = sizeof pixels;
 *       BhrStatus status = bhr_render_image(context, &image);
 *       if (status == BHR_OK)
 *           status = bhr_image_save(&image, "hole.png");
 *       bhr_context_destroy(context);
 *       return status == BHR_OK ? 0 : 1;
 *   }
 *
 * Units
 *   Geometric, G = c = 1. The host chooses the unit of length of its scene; the mass M is given in it, so that the
 *   Schwarzschild radius is 2 M. Angles are in radians, temperatures in kelvin, times in scene lengths. Only lengths of
 *   the disk, of volumes and of hot spots are in units of M.
 *
 * Coordinates
 *   The hole sits at the origin of right-handed axes. r, th, ph are the Schwarzschild / Boyer-Lindquist coordinates
 *   about the spin axis: x = r sin(th) cos(ph), y = r sin(th) sin(ph), z = r cos(th). The spin axis is also the disk's
 *   normal, and is +z unless bhr_set_axis changes it.
 *
 *   With another axis the chart is the scene's axes under the shortest rotation that takes +z to it (about +x for -z).
 *   Then r, th, ph, the frames below and BhrCrossing.azimuth refer to the turned chart; positions and directions stay
 *   in scene axes.
 *
 *   A direction (or velocity) at a place is n = n_r e_r + n_th e_th + n_ph e_ph with the Euclidean unit vectors of
 *   spherical coordinates there (on the axis e_th = x, e_ph = y). Its components are those along the orthonormal frame
 *   of the local static observer (the ZAMO when the hole spins). A direction may have any non-zero length, and is
 *   normalised; a velocity is taken as it is. A moving camera's axes are that frame boosted without rotation. Inside a
 *   spin-0 horizon the frame is that of the observer falling from rest at infinity; inside a spinning hole's horizon
 *   everything is BHR_ERROR_UNSUPPORTED.
 *
 *   Prograde always means +ph about the axis, retrograde -ph; with spin < 0 the hole turns towards -ph.
 *
 * Errors
 *   Every call that can fail returns a BhrStatus; bhr_error_message says what was wrong, with the value and the limit.
 *   A message belongs to the thread that called; where calls move between threads, bhr_context_error_message and
 *   bhr_job_error_message have the last one of a context or a job.
 *   A failed setter leaves the context as it was. Whatever a call fills in is NULL or 0 after a failure. Setters check
 *   their own argument only; combinations that cannot be (a static camera inside the horizon, say) are
 *   BHR_ERROR_INVALID_STATE when a frame or rays are asked for. BHR_ERROR_INTERNAL means a bug in bhr: from then on
 *   only destroy calls are valid on that context, its jobs and its surfaces. With BHR_WARN_UNUSED defined before this
 *   header is included, compilers warn where a status is ignored.
 *
 *   Below, errors are named without BHR_ERROR_. Errors that any call may return, for NULL, from inside a callback or
 *   after BHR_ERROR_INTERNAL, are not named each time.
 *
 * Versions
 *   Until BHR_ABI_VERSION rises, a later library runs every program that was compiled against this header. (libbhr.so.N
 *   with N = BHR_ABI_VERSION is the name that programs ask the system for.) Versions add functions, constants, and
 *   fields at the end of structs that begin with struct_size; they remove and rename nothing, and what is there keeps
 *   its value and its meaning. A function that is better not used any more says "Deprecated since X.Y.Z", and works on.
 *   What was added says "Since X.Y.Z": a program that must run with an older library, too, compares bhr_version, and
 *   looks up by name (dlsym) what may not be there. docs/abi.md has the rules at length.
 *
 * Structs
 *   Structs that may grow begin with struct_size: sizeof the struct that the program was compiled with. A size smaller
 *   than in the library's first version is BHR_ERROR_INVALID_ARGUMENT. A field that a program's struct does not reach
 *   is not written as output, and as input means what the library did without it. A struct larger than this library's
 *   is accepted as input when the rest of it is zero, and as output the rest is zeroed. Fields named reserved are 0.
 *   The *_init functions clear struct_size bytes and fill in the defaults: of BhrDisk and BhrFilm those of the release
 *   whose struct has that size. BHR_INIT, at this header's end, is the same in one line: BHR_INIT(camera). Structs and
 *   arrays need no alignment; pixels do (BhrImage).
 *
 * Pointers
 *   A pointer is NULL only where this header says that it may be. Everything that is passed in is copied before the
 *   call returns; windows and pixels stay the host's own.
 *
 * Threads and callbacks
 *   Any thread may call. Contexts are independent of each other; calls on one context wait for each other. (macOS:
 *   surfaces on the main thread only.) Log callbacks may run on any thread, progress callbacks run on the calling
 *   thread.
 *
 *   From inside a callback, a call on a context, job or surface returns BHR_ERROR_INVALID_STATE, and so do
 *   bhr_adapter_count and bhr_adapter_info; calls on plain structs and images, versions and messages are allowed. A
 *   callback must not wait for another thread's call on the same context. No callback runs after the destroy call of
 *   its context has returned.
 *
 *   During a call, floating point on its thread has the default rounding, traps and treatment of subnormal numbers,
 *   whatever the host has set; after it, and in callbacks, the host's settings and flags are as they were. A thread is
 *   not cancelled (pthread_cancel, of deferred type) inside a call, nor in a callback from one: the request waits.
 *
 *   A call needs 64 KiB of stack on Linux (x86, x86-64, AArch64), also on fibers: where less than 512 KiB are known to
 *   be left, it continues on a stack of bhr's, and its callbacks run on the host's. Elsewhere it needs 512 KiB, because
 *   of drivers.
 *
 * Memory
 *   Large memory, of more than some tens of kilobytes (frames, maps, tables, rays, star fields), is asked for in such a
 *   way that a refusal is BHR_ERROR_OUT_OF_MEMORY, with the size; it is refused as well when less than a megabyte would
 *   be left. A thread that cannot be started is the same error. The context stays usable, and the call succeeds once
 *   there is memory again.
 *
 *   Four things cannot be caught, and end the process where no memory is left: small allocations of the Rust runtime
 *   and of the thread pool; those of graphics drivers and loaders; those of wgpu, through which GPUs are reached; and
 *   those of image codecs, when other threads take the memory that was found free before a file is read or written.
 *   Hosts that must survive this use BHR_BACKEND_CPU, or keep some memory in reserve and free it when this error comes.
 *
 * The process
 *   The library never writes to stdout or stderr, never calls exit or abort (but see Memory), installs no signal
 *   handler, and lets no Rust panic out. It stays mapped after dlclose: graphics drivers leave thread-exit handlers
 *   behind. After fork() the child may only exec: neither drivers nor threads live on in it.
 */

#ifndef BHR_H
#define BHR_H

#include <stddef.h>
#include <stdint.h>

/* A program that defines BHR_WARN_UNUSED before it includes this header is warned where it ignores a BhrStatus. It has
 * to ask, because programs whose warnings are errors must go on compiling. */
#if !defined(BHR_WARN_UNUSED)
#define BHR_NODISCARD
#elif defined(__cplusplus) && __cplusplus >= 201703L
#define BHR_NODISCARD [[nodiscard]]
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 202311L
#define BHR_NODISCARD [[nodiscard]]
#elif defined(__GNUC__)
#define BHR_NODISCARD __attribute__((warn_unused_result))
#else
#define BHR_NODISCARD
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- version ---- */

#define BHR_VERSION_MAJOR 0 /**< This header's major version. Before 1.0, minor versions only add. */
#define BHR_VERSION_MINOR 2 /**< This header's minor version. */
#define BHR_VERSION_PATCH 0 /**< This header's patch version. */
#define BHR_ABI_VERSION 0u  /**< The value to pass to bhr_context_create: N of libbhr.so.N. */

/** The loaded library's version: major << 16 | minor << 8 | patch. Any thread, inside callbacks too. */
uint32_t bhr_version(void);

/** BHR_ABI_VERSION of the loaded library. Any thread, inside callbacks too. */
uint32_t bhr_abi_version(void);

/** The loaded library's version, such as "0.2.0"; static. Any thread, inside callbacks too. */
const char *bhr_version_string(void);

/* ---- status, messages ---- */

/**
 * The result of a call: 0 is success, above 0 success with news, below 0 an error. bhr_error_message has the details.
 */
typedef int32_t BhrStatus;

#define BHR_OK 0                           /**< Success. */
#define BHR_NOT_READY 1                    /**< bhr_job_wait: the job was still running when the timeout ran out. */
#define BHR_FRAME_SKIPPED 2                /**< bhr_render_surface: the window is hidden or 0 x 0; nothing presented. */
#define BHR_ERROR_INVALID_ARGUMENT (0 - 1) /**< An argument is NULL, not finite, out of its range, or unknown. */
#define BHR_ERROR_INVALID_STATE (0 - 2)    /**< Wrong order, an impossible combination, or inside a callback. */
#define BHR_ERROR_INCOMPATIBLE_ABI (0 - 3) /**< The program was compiled for another BHR_ABI_VERSION. */
#define BHR_ERROR_UNSUPPORTED (0 - 4)      /**< Valid, but not on this adapter, platform or build. */
#define BHR_ERROR_NO_ADAPTER (0 - 5)       /**< No adapter of the kind asked for exists. */
#define BHR_ERROR_OUT_OF_MEMORY (0 - 6)    /**< Host or device memory ran out. */
#define BHR_ERROR_CANCELLED (0 - 7)        /**< The progress callback, or bhr_job_cancel, stopped the work. */
#define BHR_ERROR_SURFACE_LOST (0 - 8)     /**< A window is gone or its context recovered: destroy the surface. */
#define BHR_ERROR_DEVICE_LOST (0 - 9)      /**< The GPU device is gone: call bhr_context_recover. */
#define BHR_ERROR_IO (0 - 10)              /**< A file could not be read or written. */
#define BHR_ERROR_INTERNAL (0 - 99)        /**< A bug in bhr was caught; only destroy calls are valid now. */

/**
 * The message of the last call that failed on this thread: the function, the argument, its value and the limit. Never
 * NULL; "" when no call has failed. Valid until this thread's next failing call, or its end. May be called from inside
 * callbacks.
 */
const char *bhr_error_message(void);

/** The constant's name, such as "BHR_ERROR_DEVICE_LOST"; static, never NULL. May be called from inside callbacks. */
const char *bhr_status_name(BhrStatus status);

/* ---- log ---- */

/** How much a log callback is told: messages of this level and of the more severe ones. */
typedef int32_t BhrLogLevel;

#define BHR_LOG_OFF 0   /**< Nothing. */
#define BHR_LOG_ERROR 1 /**< Every failed call, but for cancels, and errors of the graphics stack. */
#define BHR_LOG_WARN 2  /**< Also trouble that failed no call, such as an adapter passed over. The default. */
#define BHR_LOG_INFO 3  /**< Also cancels, and the adapter that was chosen, and why. */
#define BHR_LOG_DEBUG 4 /**< Also what the graphics stack (wgpu) reports about itself. */
#define BHR_LOG_TRACE 5 /**< Everything: slow. */

/**
 * Gets bhr's messages and those of the graphics stack under it, one per call, without a line end. message lives for
 * the call only. A message that arises inside a bhr_ call on a context goes to that context's callback, on whichever
 * thread the call runs, or on a thread of the library that works for that context; one from another thread goes to
 * every context's callback. It may therefore run on several threads at once. It must not throw, unwind or longjmp.
 * Calls on a context from inside it return BHR_ERROR_INVALID_STATE. It may wait for other threads' calls on other
 * contexts, not for calls on its own. None runs after bhr_context_destroy has returned.
 */
typedef void (*BhrLogFn)(void *user, BhrLogLevel level, const char *message);

/* ---- adapters ---- */

#define BHR_ADAPTER_DISCRETE 1u /**< BhrAdapterInfo.flags: a GPU with memory of its own. */
#define BHR_ADAPTER_SOFTWARE 2u /**< BhrAdapterInfo.flags: a software driver, or the CPU tracer. */

/**
 * The interface to an adapter.
 *
 * BHR_BACKEND_AUTO takes the best GPU that Vulkan, Metal or Direct3D 12 reaches; else a GPU that only OpenGL reaches;
 * else a software driver for Vulkan (Mesa's lavapipe) or Direct3D 12; else the CPU tracer. Software OpenGL, which
 * needs seconds for its first frame, is never chosen.
 *
 * BHR_BACKEND_GL reaches OpenGL and OpenGL ES through EGL or WGL, hardware or software. A thread of the library makes
 * all its GL calls, and ends with the context: a GL context that is current on one of the host's threads stays
 * current. With Mesa, bhr's GL context uses EGL's surfaceless display. A process has only one of these, and bhr never
 * terminates it. If the host does (eglTerminate), all contexts on this backend return BHR_ERROR_DEVICE_LOST until
 * bhr_context_recover; a bhr_context_create or bhr_context_recover that is running meanwhile returns
 * BHR_ERROR_NO_ADAPTER. The host may call eglTerminate while a call or a job of one context is running, but not while
 * calls or jobs of several contexts on this backend are: EGL may give the handle of a context that has ended to
 * another one. Each time, some 10 MiB and a sleeping thread for each context may stay behind until the process ends,
 * because a context that has lost its display cannot be closed.
 */
typedef int32_t BhrBackend;

#define BHR_BACKEND_AUTO 0   /**< The best one there is, in the order above. */
#define BHR_BACKEND_CPU 1    /**< The built-in double-precision CPU tracer: needs no driver. */
#define BHR_BACKEND_VULKAN 2 /**< Vulkan. */
#define BHR_BACKEND_METAL 3  /**< Metal. */
#define BHR_BACKEND_D3D12 4  /**< Direct3D 12. */
#define BHR_BACKEND_GL 5     /**< OpenGL or OpenGL ES. */

/** One adapter. */
typedef struct BhrAdapterInfo {
    uint32_t struct_size; /**< sizeof(BhrAdapterInfo), set by the caller. */
    BhrBackend backend;   /**< BHR_BACKEND_*, never AUTO. */
    uint32_t flags;       /**< BHR_ADAPTER_* bits. */
    uint32_t vendor_id;   /**< PCI id of the vendor; 0 for the CPU tracer. */
    uint32_t device_id;   /**< PCI id of the device; 0 for the CPU tracer. */
    uint32_t reserved;    /**< Reserved: 0. */
    char name[256];       /**< UTF-8, cut where it is longer. */
    char driver[256];     /**< Name and version of the driver, UTF-8; "" where it is not known. */
} BhrAdapterInfo;

/**
 * Clears struct_size bytes and sets struct_size, which calls that fill the struct read. Any thread, inside callbacks
 * too. Since 0.2.0. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_adapter_info_init(BhrAdapterInfo *info, size_t struct_size);

/**
 * Counts the adapters of this machine: at least 1, because the CPU tracer is always there, and always last. Adapters
 * other than GL are looked for once in a process; bhr_context_recover looks again. Any thread, not inside callbacks.
 * Errors: INVALID_ARGUMENT for NULL.
 */
BHR_NODISCARD BhrStatus bhr_adapter_count(uint32_t *out_count);

/**
 * Fills in info for the adapter at index: GPUs come first, then software drivers, the CPU tracer last.
 * BHR_BACKEND_AUTO need not take the first one. Any thread, not inside callbacks. Errors: INVALID_ARGUMENT for NULL, a
 * wrong struct_size, or an index not below bhr_adapter_count.
 */
BHR_NODISCARD BhrStatus bhr_adapter_info(uint32_t index, BhrAdapterInfo *info);

/* ---- windows of the host ---- */

/** The kind of a BhrWindow. It decides which fields are read; the others are ignored. */
typedef int32_t BhrWindowKind;

#define BHR_WINDOW_XLIB 1        /**< X11 through Xlib: display = Display *, id = Window. */
#define BHR_WINDOW_XCB 2         /**< X11 through XCB: display = xcb_connection_t *, id = xcb_window_t. */
#define BHR_WINDOW_WAYLAND 3     /**< Wayland: display = wl_display *, handle = wl_surface *. */
#define BHR_WINDOW_WIN32 4       /**< Windows: handle = HWND, aux = HINSTANCE or NULL. */
#define BHR_WINDOW_APPKIT 5      /**< macOS: handle = NSView *. */
#define BHR_WINDOW_UIKIT 6       /**< iOS: handle = UIView *. */
#define BHR_WINDOW_METAL_LAYER 7 /**< macOS, iOS: handle = CAMetalLayer *. */
#define BHR_WINDOW_ANDROID 8     /**< Android: handle = ANativeWindow *. */

/**
 * A window of the host's. It stays the host's, and it and its display must outlive every surface made from it.
 * Begin with all bytes 0, then set struct_size, kind, and what the kind names. Handles are those of the
 * raw-window-handle crate.
 */
typedef struct BhrWindow {
    uint32_t struct_size; /**< sizeof(BhrWindow). */
    BhrWindowKind kind;   /**< BHR_WINDOW_*. */
    void *display;        /**< The connection to the display, where the kind has one. */
    void *handle;         /**< The window, view, layer or surface, where the kind has a pointer to it. */
    void *aux;            /**< A second pointer, for Windows only. */
    uint64_t id;          /**< X11: the id of the window. */
    uint64_t visual_id;   /**< X11: the id of the window's visual; may be 0. */
    int32_t screen;       /**< X11: the number of the window's screen; may be 0. */
    uint32_t reserved;    /**< Reserved: 0. */
} BhrWindow;

/**
 * Clears struct_size bytes and sets struct_size; kind and handles have no defaults. Any thread, inside callbacks too.
 * Since 0.2.0. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_window_init(BhrWindow *window, size_t struct_size);

/* ---- context ---- */

/**
 * A scene and what traces it. Contexts are independent of each other. Any thread may call; calls on one context
 * wait for each other.
 */
typedef struct BhrContext BhrContext;

/**
 * BhrContextOptions.flags: the driver's validation layers check bhr and report to the log. Slow. Ignored where they
 * are not installed, and by OpenGL, which has none.
 */
#define BHR_CONTEXT_VALIDATION 1u

/** How to make a context. Fill in with bhr_context_options_init first. */
typedef struct BhrContextOptions {
    uint32_t struct_size; /**< sizeof(BhrContextOptions). */
    uint32_t flags;       /**< BHR_CONTEXT_* bits. Default 0. */
    BhrBackend backend;   /**< Default BHR_BACKEND_AUTO. */
    /**
     * Index for bhr_adapter_info; its backend must be the one above, unless that is AUTO. -1 (default): the library
     * chooses. 0 is the first adapter, so that a struct which was zeroed instead of initialised asks for that one.
     */
    int32_t adapter_index;
    /** Threads of the CPU tracer, 0 .. 1024. 0 (default): one per core that this process may use. */
    uint32_t cpu_threads;
    /** The messages that log_fn is told: this level and the more severe ones. Default BHR_LOG_WARN. */
    BhrLogLevel log_level;
    BhrLogFn log_fn; /**< NULL (default): silent. */
    void *log_user;  /**< Handed to log_fn. */
    /**
     * A window that the adapter must be able to present to; it is looked at during the call only. With AUTO, adapters
     * that cannot are passed over; the CPU tracer always qualifies, because its frames reach windows in other ways.
     * NULL (default): any adapter; where it cannot present, surfaces work all the same, more slowly. GL adapters never
     * present.
     */
    const BhrWindow *compatible_window;
} BhrContextOptions;

/** Clears struct_size bytes and fills in the defaults. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size. */
BHR_NODISCARD BhrStatus bhr_context_options_init(BhrContextOptions *options, size_t struct_size);

/**
 * Makes a context with the default scene, that of BHR_PRESET_CINEMATIC: a hole of mass 1 without spin, a turbulent
 * golden disk with soft edges, glare, the stars and the Milky Way, and a camera at (0, 26, 2.5) that looks at the
 * hole. abi_version is BHR_ABI_VERSION; options NULL means all defaults. With BHR_BACKEND_AUTO it succeeds on every
 * machine: an adapter that cannot be opened is passed over, without a GPU or a driver the CPU tracer serves, and the
 * log says why. End *out_context with bhr_context_destroy. Any thread, not inside callbacks. Errors: INCOMPATIBLE_ABI;
 * INVALID_ARGUMENT for a bad option; UNSUPPORTED for a compatible_window of another platform, for any window in a
 * library that was built without the cargo feature window, and for BHR_BACKEND_GL in one that was built without the
 * feature gl; NO_ADAPTER when the backend or adapter asked for is not there, cannot be opened, or cannot present to
 * compatible_window.
 */
BHR_NODISCARD BhrStatus bhr_context_create(uint32_t abi_version,
                                           const BhrContextOptions *options,
                                           BhrContext **out_context);

/** Fills in info for the adapter that the context runs on. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size. */
BHR_NODISCARD BhrStatus bhr_context_adapter(const BhrContext *context, BhrAdapterInfo *info);

/**
 * Opens the device anew after BHR_ERROR_DEVICE_LOST, on the same adapter if it is still there. The scene stays, the
 * sky's map included, but for a sky or an occluder in a target (bhr_interop.h): set those anew. Surfaces made before
 * are lost: destroy them and make them again. Jobs that a loss of the
 * device left unfinished fail with DEVICE_LOST. Until this call every call that renders or traces returns
 * DEVICE_LOST; setters go on working. Errors: as bhr_context_create; the context then stays lost, and the call may
 * be tried again; UNSUPPORTED on a device of the host's (bhr_context_create_vulkan).
 */
BHR_NODISCARD BhrStatus bhr_context_recover(BhrContext *context);

/**
 * Copies the message of the last call that failed on this context or on a surface of its, whichever thread it was on,
 * into buffer. For hosts whose calls move between threads (goroutines, worker threads of Node or asyncio), where
 * bhr_error_message may tell of another call. At most size - 1 bytes, cut between characters, and a NUL are written,
 * nothing when buffer is NULL or size is 0. Returns the length of the whole message in bytes without its NUL, less
 * than 10,000; 0 when no call has failed, and for a NULL context. While other threads make calls that fail on the
 * context, the message may be that of one of theirs. Jobs have messages of their own: bhr_job_error_message. A call
 * that returns no context leaves its message with its thread alone. Any thread, inside callbacks too; it waits for no
 * other call. Since 0.2.0.
 */
size_t bhr_context_error_message(const BhrContext *context, char *buffer, size_t size);

/**
 * Ends a context: waits for a call that is running on it and for its jobs (bhr_job_cancel shortens that), and up to a
 * second for pipelines that are being compiled, then frees it. Its surfaces end too, but both they and its jobs must
 * still be destroyed, before or after. NULL is a no-op. No callback runs after it has returned. No other thread may
 * begin a call on it any more. From inside a callback it does nothing, as the context is in use: bhr_error_message
 * then says so.
 *
 * A process may end without it, by exit() or by returning from main, whatever jobs are under way. Drivers unload
 * parts of themselves then; so, where a GPU was used, a handler of bhr's (atexit) waits until bhr's own threads
 * have come out of their drivers, 10 s at most, and holds them up for 2 s. In handlers and destructors of static
 * objects that run later, calls on contexts and jobs return INVALID_STATE; destroying what uses a GPU frees nothing,
 * bhr's threads are held up for 10 s more, and calls and callbacks that are running are waited for 3 s at most each.
 * Threads of the host's go on, but wait if they wait for bhr's: end them before, if they call bhr. (Nothing of this on
 * Windows, where other threads end first.)
 */
void bhr_context_destroy(BhrContext *context);

/* ---- the black hole ---- */

/**
 * Sets the mass M in scene lengths (G = c = 1; the Schwarzschild radius is 2 M): finite, > 0. Default 1.
 * Errors: INVALID_ARGUMENT.
 */
BHR_NODISCARD BhrStatus bhr_set_mass(BhrContext *context, double mass);

/** Sets the spin a / M in [-0.999, 0.999]; < 0: the hole turns towards -ph. Default 0. Errors: INVALID_ARGUMENT. */
BHR_NODISCARD BhrStatus bhr_set_spin(BhrContext *context, double spin);

/**
 * Sets the spin axis, which is also the disk's normal: scene axes, any non-zero length. Default +z. Errors:
 * INVALID_ARGUMENT.
 */
BHR_NODISCARD BhrStatus bhr_set_axis(BhrContext *context, const double axis[3]);

/** Reads the mass, the spin and the axis (a unit vector) as they are set. Errors: INVALID_ARGUMENT for NULL. */
BHR_NODISCARD BhrStatus bhr_get_hole(const BhrContext *context, double *out_mass, double *out_spin, double out_axis[3]);

/** Numbers about the hole and the camera's observer. Lengths are in scene units; what is not defined is NaN. */
typedef struct BhrHoleInfo {
    uint32_t struct_size;                /**< sizeof(BhrHoleInfo), set by the caller. */
    uint32_t reserved;                   /**< Reserved: 0. */
    double horizon_radius;               /**< r+ = M + sqrt(M^2 - a^2). */
    double ergosphere_equatorial_radius; /**< 2 M, at every spin. */
    double photon_orbit_prograde;        /**< Equatorial circular photon orbit towards +ph. */
    double photon_orbit_retrograde;      /**< Equatorial circular photon orbit towards -ph. */
    double isco_prograde;                /**< Innermost stable circular orbit of matter towards +ph. */
    double isco_retrograde;              /**< Innermost stable circular orbit of matter towards -ph. */
    double critical_impact_parameter;    /**< Spin 0: 3 sqrt(3) M; NaN with spin. */
    /**
     * Spin 0: angular radius of the shadow as the camera's observer sees it, radians (Synge 1966, with
     * aberration); NaN with spin.
     */
    double shadow_angular_radius;
    double camera_radius;    /**< Boyer-Lindquist r of the camera. */
    double camera_time_rate; /**< d tau / d t, the rate of the clock of the camera's observer. */
} BhrHoleInfo;

/**
 * Clears struct_size bytes and sets struct_size, which calls that fill the struct read. Any thread, inside callbacks
 * too. Since 0.2.0. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_hole_info_init(BhrHoleInfo *info, size_t struct_size);

/**
 * Fills in info for the hole and the camera as they are set; where the camera's motion cannot be, its numbers are
 * NaN. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_hole_info(const BhrContext *context, BhrHoleInfo *info);

/**
 * Fills in the metric at a place in scene axes: out_metric[4 a + b] = g_ab in Boyer-Lindquist (t, r, th, ph),
 * signature - + + +. Errors: INVALID_ARGUMENT for NULL, a position that is not finite, the centre, or the horizon.
 */
BHR_NODISCARD BhrStatus bhr_metric_at(const BhrContext *context, const double position[3], double out_metric[16]);

/**
 * Fills in the Christoffel symbols at a place in scene axes: out_gamma[16 a + 4 b + c] = Gamma^a_bc in Boyer-Lindquist
 * (t, r, th, ph). Errors: INVALID_ARGUMENT as bhr_metric_at, and on the axis.
 */
BHR_NODISCARD BhrStatus bhr_christoffel_at(const BhrContext *context, const double position[3], double out_gamma[64]);

/* ---- the camera: an observer with a lens ---- */

/** The lens. Camera axes: right = forward x up, then up = right x forward. */
typedef int32_t BhrProjection;

/** A flat picture; fov_y in (0, pi). */
#define BHR_PROJECTION_PERSPECTIVE 0

/**
 * Dome master, equidistant: the angle from forward grows evenly with the distance from the frame's centre, to
 * fov_y / 2 (fov_y to 2 pi) at the circle inscribed in the frame. Outside the circle there is nothing: black, alpha
 * 0 in a TRANSPARENT image, NaN in views, rays without direction.
 */
#define BHR_PROJECTION_FISHEYE 1

/**
 * All-round picture, 360 x 180 degrees in even steps: longitude from forward (middle) to the right, latitude towards
 * up (top); fov_y is ignored. A frame that is not twice as wide as high is stretched. Within a pixel or two of the
 * poles, where pixels are far narrower than high, the light of single stars is not exact.
 */
#define BHR_PROJECTION_EQUIRECT 2

/**
 * Six faces of a cube side by side: right, left, up, down, front, back. The top of each face is up; of the up face it
 * is backward, of the down face forward. Each shows what a 90 degree PERSPECTIVE camera that looks that way sees, not
 * its mirror image; fov_y is ignored. The full frame's width must be 6 times its height, else INVALID_STATE when a
 * frame or rays are asked for. Stars keep their light across the borders of faces; within two pixels of the cube's
 * corners up to a quarter is lost.
 */
#define BHR_PROJECTION_CUBE 3

/**
 * A flat picture between four tangents, as the frustum of a projection matrix, of an eye before a lens (XrFovf) or
 * of a wall of a cave: tan_left, tan_right, tan_down, tan_up. fov_y is ignored, and the frame's shape may be any:
 * it is stretched to the tangents. With tan_up = -tan_down = tan(fov_y / 2) and tan_right = -tan_left = tan_up
 * times the frame's width / height it is PERSPECTIVE. Since 0.2.0.
 */
#define BHR_PROJECTION_FRUSTUM 4

/**
 * How the camera's observer moves. A motion that is not possible at the camera's place is INVALID_STATE when a frame
 * or rays are asked for. FREE_FALL falls radially from rest at infinity, inside a spin-0 horizon too. ORBIT moves on a
 * circle towards +ph: without spin at any latitude, with r > 3 M and beta = 1 / sqrt(r / M - 2); with spin on the
 * circular geodesic, in the equatorial plane only (to within 1e-12 of the radius).
 */
typedef int32_t BhrMotion;

#define BHR_MOTION_STATIC 0    /**< At rest; with spin, the zero angular momentum observer (ZAMO). */
#define BHR_MOTION_FREE_FALL 1 /**< Falls radially from rest at infinity. */
#define BHR_MOTION_ORBIT 2     /**< On a circular orbit towards +ph. */
#define BHR_MOTION_VELOCITY 3  /**< Moves with BhrCamera.velocity. */

/** The eye for which an EQUIRECT picture is made. Since 0.2.0. */
typedef int32_t BhrEye;

#define BHR_EYE_MIDDLE 0 /**< The camera's own place: no stereo picture. Since 0.2.0. */
#define BHR_EYE_LEFT 1   /**< The left eye. Since 0.2.0. */
#define BHR_EYE_RIGHT 2  /**< The right eye. Since 0.2.0. */

/** The camera: an observer with a lens. Positions and axes in scene axes and lengths. */
typedef struct BhrCamera {
    uint32_t struct_size;     /**< sizeof(BhrCamera). */
    BhrProjection projection; /**< BHR_PROJECTION_*. Default PERSPECTIVE. */
    double position[3];       /**< Default (0, 26, 2.5). Not (0, 0, 0). */
    double forward[3];        /**< Any non-zero length. Default: towards the hole. */
    double up[3];             /**< Any non-zero length, not parallel to forward. Default +z. */
    /**
     * Radians: full vertical angle, (0, pi), for PERSPECTIVE; across the circle, (0, 2 pi], for FISHEYE. Default
     * pi / 4.
     */
    double fov_y;
    BhrMotion motion;  /**< BHR_MOTION_*. Default STATIC. */
    uint32_t reserved; /**< Reserved: 0. */
    /**
     * For BHR_MOTION_VELOCITY: v / c against the local static observer (ZAMO), |v| < 1; components as for a
     * direction given at position. Default 0.
     */
    double velocity[3];
    /**
     * For FRUSTUM: the borders of the picture on the plane at distance 1 ahead, to the right and up, within +-1e9;
     * left less than right, down less than up. Default -1, 1, -1, 1. Other projections ignore them.
     * Since 0.2.0.
     */
    double tan_left;
    double tan_right; /**< The right border. Since 0.2.0. */
    double tan_down;  /**< The lower border. Since 0.2.0. */
    double tan_up;    /**< The upper border. Since 0.2.0. */
    /**
     * The whole picture moves by this many pixels to the right and down, as temporal antialiasing wants it; each
     * within +-1. For PERSPECTIVE and FRUSTUM; other projections ignore it. Default 0. Since 0.2.0.
     */
    double jitter[2];
    /**
     * For EQUIRECT with an eye: the distance of the two eyes, scene lengths, at least 0. Default 0. Since
     * 0.2.0.
     */
    double eye_distance;
    /**
     * BHR_EYE_*. With LEFT or RIGHT and an eye_distance above 0 an EQUIRECT picture is one of two for 360-degree
     * stereo (omnidirectional stereo, ODS): each column is seen from where the eye is when the head, which turns
     * about position and up, looks at that column. Columns share an eye, up to 64, where things half as far as the
     * hole do not leap by more than a tenth of a pixel for it; each such strip is rendered as a frame of its own,
     * so that a picture takes longer. The rays of bhr_camera_rays are those of its pixels. Bloom that the preset
     * has is left out; other bloom, and a beam, are INVALID_STATE; windows, bhr_project_point, outputs other than
     * LIGHT, occluders and targets on the GPU are UNSUPPORTED. Towards the poles, as in all such pictures, depth is
     * wrong. Other projections ignore it. Default MIDDLE. Since 0.2.0.
     */
    BhrEye eye;
    uint32_t reserved2; /**< Reserved: 0. Since 0.2.0. */
} BhrCamera;

/**
 * Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
 * for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_camera_init(BhrCamera *camera, size_t struct_size);

/**
 * Sets position, forward (towards target) and up of a camera; touches no context. Any thread, inside callbacks
 * too. On failure the camera stays as it was. Errors: INVALID_ARGUMENT for NULL, numbers not finite, position (0,
 * 0, 0) or equal to target, up zero or along the line of sight.
 */
BHR_NODISCARD BhrStatus bhr_camera_look_at(BhrCamera *camera,
                                           const double position[3],
                                           const double target[3],
                                           const double up[3]);

/**
 * Sets a camera at distance (> 0) from the hole, at azimuth from +x towards +y and elevation from the xy plane
 * towards +z (radians), looking at the hole: position = distance (cos el cos az, cos el sin az, sin el), up = +z.
 * Within 1e-6 of a pole up is the limit of what it is on the way there, -sin el (cos az, sin az, 0). Any thread,
 * inside callbacks too. On failure the camera stays as it was. Errors: INVALID_ARGUMENT for NULL, a number not
 * finite, distance <= 0.
 */
BHR_NODISCARD BhrStatus bhr_camera_orbit(BhrCamera *camera, double distance, double azimuth, double elevation);

/**
 * Sets the camera. Errors: INVALID_ARGUMENT for NULL, a number not finite, position (0, 0, 0), forward or up zero
 * or parallel, fov_y out of range, |velocity| >= 1, tangents, jitter or eye_distance that are out of range, an
 * unknown constant.
 */
BHR_NODISCARD BhrStatus bhr_set_camera(BhrContext *context, const BhrCamera *camera);

/** The camera as it is set. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size. */
BHR_NODISCARD BhrStatus bhr_get_camera(const BhrContext *context, BhrCamera *camera);

/**
 * Moves a camera along its own world line about the context's hole by proper_time (scene lengths, finite): a STATIC
 * one stays, a FREE_FALL one falls, an ORBIT one orbits, its axes carried along. The context's own camera stays where
 * it is. *out_coordinate_time, unless NULL, becomes the scene time that went by: add it to the time of bhr_set_time,
 * and a fall through a spin-0 horizon is seamless. It is the chart's t outside the horizon; from outside to inside (M
 * = 1, H as at bhr_set_time) it is proper_time + H(r at the begin); inside it is proper_time. On failure the camera
 * stays as it was. Errors: INVALID_ARGUMENT as bhr_set_camera; INVALID_STATE where the motion is not possible;
 * UNSUPPORTED for VELOCITY.
 */
BHR_NODISCARD BhrStatus bhr_camera_advance(const BhrContext *context,
                                           BhrCamera *camera,
                                           double proper_time,
                                           double *out_coordinate_time);

/* ---- cameras as matrices ---- */

/**
 * Matrices lie in memory row by row, else column by column. For matrices that multiply row vectors (DirectXMath,
 * Unreal) it is the other way round: those that lie there row by row are given without it. Since 0.2.0.
 */
#define BHR_MATRIX_ROW_MAJOR 1u

/**
 * Clip space's y = +1 is the image's bottom row, as in Vulkan; else its top row, as in OpenGL, Direct3D and Metal.
 * Since 0.2.0.
 */
#define BHR_MATRIX_Y_DOWN 2u

/**
 * Depths lie in 0 .. 1, else in -1 .. 1 (OpenGL). For bhr_camera_matrices; bhr_camera_from_matrices does not ask.
 * Since 0.2.0.
 */
#define BHR_MATRIX_ZERO_TO_ONE 4u

/** The near plane has the greatest depth, the far one the least. For bhr_camera_matrices. Since 0.2.0. */
#define BHR_MATRIX_REVERSED 8u

/**
 * The camera looks along its own +z, with x to the right and y up (Direct3D, Unreal), else along -z (OpenGL,
 * Vulkan, Unity). For bhr_camera_matrices; bhr_camera_from_matrices sees it in the projection. Since 0.2.0.
 */
#define BHR_MATRIX_FORWARD_Z 16u

/**
 * Sets position, forward, up and the picture (projection FRUSTUM, its tangents, jitter 0) of a camera from the
 * host's matrices; the rest of it, its motion for one, stays. Touches no context. Any thread, inside callbacks
 * too.
 *
 * view takes the world, whose origin is the hole's centre and whose lengths are scene lengths, to the camera: a
 * rotation and a shift, without scale. projection is any perspective one: of OpenGL, Vulkan, Direct3D or Metal,
 * off-axis, jittered, with reversed or infinite depths; its row of depths is not read. flags: BHR_MATRIX_ROW_MAJOR
 * and BHR_MATRIX_Y_DOWN as they are; the others do not matter here.
 *
 * bhr's scene is right-handed. For a left-handed world negate one axis: of the positions given to bhr, and of the
 * view that is passed here (no flags in both):
 *
 * - Unity, with positions (x, y, -z):
 *   `Matrix4x4 view = camera.worldToCameraMatrix * Matrix4x4.Scale(new Vector3(1, 1, -1));`
 *   `Matrix4x4 projection = camera.projectionMatrix;`
 * - Unreal, with positions (x, -y, z), in cm:
 *   `FMatrix view = FScaleMatrix(FVector(1, -1, 1)) * matrices.GetViewMatrix();`
 *   `FMatrix projection = matrices.GetProjectionMatrix();`
 *
 * On failure the camera stays as it was. Errors: INVALID_ARGUMENT for NULL, unknown flags, numbers not finite, a
 * view that is not rigid to 1e-4, a projection that is orthographic, sheared or rolled, matrices that mirror the
 * scene (left-handed worlds), the hole's centre as position, and a camera whose struct_size ends before jitter
 * does. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_camera_from_matrices(BhrCamera *camera,
                                                 const double view[16],
                                                 const double projection[16],
                                                 uint32_t flags);

/**
 * The view and the projection of a PERSPECTIVE or FRUSTUM camera, for hosts whose own things are to be seen where
 * bhr shows them: pixels of a width x height frame with the planes near_z > 0 and far_z > near_z, or INFINITY.
 * flags: any of BHR_MATRIX_*; the matrices are what bhr_camera_from_matrices takes. For a left-handed world
 * multiply the view by the same scale again. The camera's motion does not enter: an observer that moves sees
 * directions aberrated, which no matrix says. Touches no context. Any thread, inside callbacks too. Errors:
 * INVALID_ARGUMENT for NULL, a side of 0, another projection, planes out of range, unknown flags, a camera that
 * bhr_set_camera would refuse. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_camera_matrices(const BhrCamera *camera,
                                            uint32_t width,
                                            uint32_t height,
                                            double near_z,
                                            double far_z,
                                            uint32_t flags,
                                            double out_view[16],
                                            double out_projection[16]);

/* ---- accretion disk ---- */

/** BhrDisk.flags: the matter orbits towards -ph. */
#define BHR_DISK_RETROGRADE 1u

/**
 * BhrDisk.flags: matter shines on its way from the ISCO to the horizon, too. There it keeps the energy and the
 * angular momentum of the orbit at the ISCO and falls freely (Cunningham 1975, ApJ 202, 788): light, emission law,
 * views and the g of single rays are those of matter that moves so. Its flux is a model: inside the hottest
 * ring it is never less than half of that ring's, down to the horizon (that of Page and Thorne falls to 0 at the
 * ISCO). The disk is not translucent at its inner edge then, and
 * turbulence fades out within the outer third of the way from the ISCO to the centre. BHR_DISK_AT_MEDIAN means the
 * orbiting part of the disk, so that light from outside the hottest ring stays as it is without the flag. Rays are
 * integrated one by one, without lens tables, which takes longer. Since 0.2.0.
 */
#define BHR_DISK_PLUNGES 2u

/**
 * The ring at whose radius a disk has the stated temperature and brightness. Whichever it is, the
 * temperature goes along the radius as the fourth root of the Page-Thorne flux, and the luminance is that of a
 * blackbody so hot.
 * Since 0.2.0.
 */
typedef int32_t BhrDiskReference;

/**
 * The hottest ring of the profile: at spin 0 r = 9.55 M, at spin 0.998 r = 1.58 M. Where that ring moves inwards, the
 * rest of the disk darkens. Since 0.2.0.
 */
#define BHR_DISK_AT_HOTTEST 0

/**
 * The ring that halves the disk's area, r^2 = (inner^2 + outer^2) / 2, where of a soft outer edge the outermost
 * quarter of its fading does not count: the disk as a whole keeps its look when spin or edges change. (The median
 * luminance of the pixels of the default disk, seen from r = 30 M and 10 degrees above it, stays within a factor of
 * 1.5 from spin -0.998 to 0.998.) What is farther in is hotter and brighter, at high spin by far. Since 0.2.0.
 */
#define BHR_DISK_AT_MEDIAN 1

/**
 * How the disk's light depends on the angle to its normal, in the frame of its matter. The flux is the same.
 * Since 0.2.0.
 */
typedef int32_t BhrEmissionLaw;

/** The disk's surface shines alike in all directions. Since 0.2.0. */
#define BHR_DISK_ISOTROPIC 0

/**
 * As an atmosphere of free electrons, which is what the inner parts of bright disks are (Chandrasekhar 1960,
 * "Radiative Transfer", table XXIV, linear between its angles): 1.269 times as bright along the normal, 0.414 times at
 * grazing angles. Since 0.2.0.
 */
#define BHR_DISK_LIMB_DARKENED 1

/**
 * A geometrically thin disk in the equatorial plane, on circular geodesics, with the Page-Thorne flux. Radii in
 * units of M.
 */
typedef struct BhrDisk {
    uint32_t struct_size; /**< sizeof(BhrDisk). */
    uint32_t flags;       /**< Any of BHR_DISK_RETROGRADE | BHR_DISK_PLUNGES. Default 0. */
    /**
     * In M, 0 .. 1e6. The disk begins here, but not inside the ISCO, or with BHR_DISK_PLUNGES not inside the horizon.
     * Default 0: at the ISCO, or at the horizon.
     */
    double inner_radius;
    double outer_radius; /**< In M, greater than inner_radius, to 1e6. Default 17. */
    double temperature;  /**< Kelvin at the ring that `reference` says, 500 .. 1e9. Default 3500. */
    double opacity;      /**< 0 .. 1. Default 1. */
    double brightness;   /**< 0 .. 1e6: the luminance of that ring at rest. Default 0.6. */
    /**
     * Contrast of the structure that orbits with the matter, from 0, smooth, to 1 (default): streaks along the orbit,
     * lighter and darker by turns, with the smooth disk's light for their mean. bhr_set_time carries them along, at
     * any time to 1e9 M and more, forwards and backwards. At every radius a pattern lives for about one orbit
     * there, and fades into the next.
     */
    double turbulence;
    uint64_t seed; /**< Selects the turbulence: the same seed always gives the same pattern. Any number. Default 0. */
    /** BHR_DISK_AT_*. Default AT_MEDIAN; AT_HOTTEST in structs of 0.1.0's size. Since 0.2.0. */
    BhrDiskReference reference;
    BhrEmissionLaw emission_law; /**< BHR_DISK_ISOTROPIC (default), BHR_DISK_LIMB_DARKENED. Since 0.2.0. */
    /**
     * 0 sharp .. 1, default 0.4. Opacity and light fade to nothing over this share of the way from the inner edge (the
     * ISCO, if matter plunges) to the outer one, at its end. Near the ISCO opacity falls with the flux, where that is
     * less than this share of the hottest ring's. A disk that inner_radius cuts off outside the hottest ring is sharp
     * there. Since 0.2.0.
     */
    double edge_softness;
} BhrDisk;

/**
 * Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
 * for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_disk_init(BhrDisk *disk, size_t struct_size);

/**
 * Sets the disk; NULL: no disk. A new context has the default one. Errors: INVALID_ARGUMENT for a number outside
 * its range, or an unknown flag, reference or emission_law.
 */
BHR_NODISCARD BhrStatus bhr_set_disk(BhrContext *context, const BhrDisk *disk);

/**
 * Reads the disk as it is set. *out_present becomes 1 with a disk; without one it becomes 0, and disk gets the
 * defaults. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_get_disk(const BhrContext *context, BhrDisk *disk, int32_t *out_present);

/* ---- matter with depth: volumes and hot spots ---- */

/**
 * Where the matter of a volume is: its density n, with c = cos th, R = r sin th, z = r c, and lengths in M. n is 1
 * at inner_radius (DISK), at radius (JET; nearer to the hole it is greater than 1) or in the middle (TORUS, HALO),
 * but for soft edges: n is multiplied by a factor that goes from 0 to 1 between 0.9 and 1.25 of inner_radius, and
 * from 1 to 0 between 0.5 of outer_radius and all of it, by 3 t^2 - 2 t^3. Since 0.2.0.
 */
typedef int32_t BhrVolumeShape;

/**
 * About the equatorial plane: n = (r / inner_radius)^-slope e^(-(c / thickness)^2 / 2), with soft edges. Since 0.2.0.
 */
#define BHR_VOLUME_DISK 0

/** A ring about the axis: n = e^(-((R - radius) / width)^2 / 2 - (z / (thickness radius))^2 / 2). Since 0.2.0. */
#define BHR_VOLUME_TORUS 1

/**
 * About the hole: n = e^(-(r / radius)^2 / 2 - (c / thickness)^2 / 2), with thickness = 1e6 a sphere. It is the
 * model of Gold et al. 2020 (ApJ 897, 148) with thickness = 1 / h. Since 0.2.0.
 */
#define BHR_VOLUME_HALO 2

/**
 * A hollow jet along the axis and one opposite: matter in the wall of a cone about the axis. At r = radius the wall is
 * at the angle opening from the axis; nearer to the hole the cone is wider, farther out it is narrower, as a parabola
 * is: psi = opening sqrt(radius / r), at most pi / 2. thickness says how thick the wall is, slope how fast the matter
 * thins out: n = (r / radius)^-slope e^(-((|c| - cos psi) / thickness)^2 / 2), with soft edges. The shape alone moves
 * nothing: matter that flows along the jet has flow = BHR_FLOW_OUTFLOW; with the default, KEPLERIAN, it orbits.
 * Since 0.2.0.
 */
#define BHR_VOLUME_JET 3

/**
 * How the matter of a volume moves, by what the local ZAMO measures. Every flow is slower than light everywhere.
 * Since 0.2.0.
 */
typedef int32_t BhrFlow;

/**
 * On circles, inside the ISCO plunging with the energy and the angular momentum of the orbit there (Cunningham 1975,
 * ApJ 202, 788); off the plane with the angular and the radial velocity of the plane at the same r. sub_keplerian is
 * the share of the circular orbit's angular momentum that the matter has: with less it turns more slowly. infall goes
 * from these orbits, 0, to matter that falls from rest at infinity, 1: between them the angular velocity dph/dt is
 * (1 - infall) times that of the orbit plus infall times that of the fall, and so is the radial one, dr/d(tau).
 * Since 0.2.0.
 */
#define BHR_FLOW_KEPLERIAN 0

/**
 * -u_ph / u_t = angular_momentum R^(3/2) / (1 + R), without radial motion: the flow of Gold et al. 2020. Since 0.2.0.
 */
#define BHR_FLOW_ANGULAR_MOMENTUM 1

/**
 * Away from the hole, the faster the farther, as the matter of a jet: beyond r = inner_radius = s it moves outwards,
 * far away at speed (in c); at s it stands still; nearer to the hole it falls in: v_r = speed (r^2 - s^2) / (r^2 +
 * s^2). A spinning hole turns it, in the hole's own sense whatever BHR_VOLUME_RETROGRADE says: v_ph = sqrt(1 - v_r^2)
 * x / (1 + x^2), x = Omega sqrt(g_phph), with the angular velocity of the field lines of Blandford and Znajek
 * (1977, MNRAS 179, 433), Omega = a / (4 r+). It is a model with the right limits, no solution of equations of motion.
 * Since 0.2.0.
 */
#define BHR_FLOW_OUTFLOW 2

/** BhrVolume.flags: the matter moves towards -ph. Since 0.2.0. */
#define BHR_VOLUME_RETROGRADE 1u

/** BhrVolume.flags: the light is a power law of the frequency, not a blackbody's. Since 0.2.0. */
#define BHR_VOLUME_POWER_LAW 2u

/**
 * Matter with depth, which shines and absorbs by the equation of transfer; nothing is scattered. Radii are in units
 * of M, as those of BhrDisk are. Fields that shape and flow do not use are checked all the same.
 *
 * Thermal matter absorbs alike at all frequencies and is exact under every redshift g: its opaque light is a
 * blackbody's of g times its temperature. Without absorption it does not shine. A power law sends j = n (nu /
 * nu_camera)^-spectral_index per M and absorbs absorption n (nu / nu_camera)^-(2.5 + spectral_index) per M, nu being
 * the frequency that the matter measures: a picture shows its light at the one frequency nu_camera, in the colour
 * tint. Lengths are the matter's own. No matter is inside the horizon. Since 0.2.0.
 */
typedef struct BhrVolume {
    uint32_t struct_size; /**< sizeof(BhrVolume). */
    uint32_t flags;       /**< Any of BHR_VOLUME_RETROGRADE | BHR_VOLUME_POWER_LAW. Default 0. */
    BhrVolumeShape shape; /**< BHR_VOLUME_DISK (default), _TORUS, _HALO, _JET. */
    BhrFlow flow;         /**< BHR_FLOW_KEPLERIAN (default), _ANGULAR_MOMENTUM, _OUTFLOW. */
    /**
     * In M, 1e-6 .. 1e4. DISK, JET: the inner edge; OUTFLOW: where matter is at rest. Default 0: the ISCO of matter
     * that moves as flags say.
     */
    double inner_radius;
    /**
     * In M, greater than inner_radius, to 1e4. Nothing is beyond it, whatever the shape: a DISK or JET whose
     * outer_radius is less than 0.9 times its inner edge, the ISCO among them, shows nothing. Default 17.
     */
    double outer_radius;
    double radius; /**< In M, 0.1 .. 1e4. TORUS: the ring's; HALO: the scale; JET: where psi = opening. Default 8. */
    double width;  /**< In M, 1e-3 .. 1e4, of a TORUS at least radius / 100: its Gaussian width in R. Default 2. */
    /**
     * 0.01 .. 1e6: the Gaussian width in c; TORUS: in z, over radius. Default 0.05, a soft disk; 0.14 is a thick one.
     */
    double thickness;
    double opening;    /**< JET: radians, 0.01 .. 1.5. Default 0.3. */
    double slope;      /**< DISK, JET: 0 .. 4. Default 0.7. */
    double absorption; /**< Per M at density 1, 0 .. 1e6. Default 3; less than 0.5 is mist, more than 5 a surface. */
    /** Kelvin, 500 .. 1e9, at inner_radius (DISK, JET) or at radius (TORUS, HALO). Default 4800. */
    double temperature;
    /** 0 .. 2: the temperature goes as r^-temperature_slope. Default 0.35; 0.75 is like a thin disk. */
    double temperature_slope;
    double spectral_index; /**< POWER_LAW: -4 .. 4. Default 1. */
    /** POWER_LAW: the colour of its light at every shift, linear Rec. 709, each 0 .. 1. Default 1, 1, 1. */
    double tint[3];
    /**
     * A factor on the light, 0 .. 1e6: it changes how bright the matter is, but neither its colour nor how much it
     * absorbs. 1 is the luminance of white in a picture without exposure and tone map. Thermal: the luminance of
     * matter of `temperature` at rest that is so thick that nothing shines through. Power law: that of a layer of 1 M
     * of density 1 at rest which absorbs nothing; one twice as deep is twice as bright. Default 1.
     */
    double brightness;
    double sub_keplerian; /**< KEPLERIAN: the share of the orbit's angular momentum, 0 .. 1. Default 1. */
    /**
     * KEPLERIAN: a share without a unit, from 0, orbits (default), to 1, free fall. What falls moves away from an
     * observer on the near side and towards one on the far side, and its light is shifted by that.
     */
    double infall;
    double angular_momentum; /**< ANGULAR_MOMENTUM: 0 .. 1. Default 1. */
    double speed;            /**< OUTFLOW: the velocity far away in units of c, 0 .. 0.995. Default 0.9. */
    /**
     * 0 .. 1: the contrast of structure that the matter carries along, and that is renewed within about an orbit:
     * a pattern P = e^(turbulence G) over its mean, G being noise of mean 0 and about variance 1. Seen with its
     * delay where effects have BHR_EFFECT_LIGHT_DELAY. Default 1; 0 is even matter, as is that of a host whose
     * BhrVolume ends before this field.
     */
    double turbulence;
    /**
     * 0.5 .. 3: the density is multiplied by P^clumping over its mean, so that on average it is what it is without; a
     * larger number draws the matter together into filaments. Default 1.8.
     */
    double clumping;
    /** 0 .. 0.5: the temperature is multiplied by P^heating, so that dense matter is hotter. Default 0.15. */
    double heating;
    uint64_t seed; /**< Selects the structure: the same seed always gives the same one. Any number. Default 0. */
} BhrVolume;

/** Most volumes of a scene. Since 0.2.0. */
#define BHR_MAX_VOLUMES 4

/** BhrHotSpot.flags: the spot moves towards -ph. Since 0.2.0. */
#define BHR_HOT_SPOT_RETROGRADE 1u

/**
 * BhrHotSpot.flags: the light is a blackbody's, not a power law of the frequency; without absorption there is none.
 * Since 0.2.0.
 */
#define BHR_HOT_SPOT_THERMAL 2u

/**
 * A glowing blob on a circular geodesic in the equatorial plane: n = e^(-(d / size)^2 / 2), cut off at 7 sizes, d
 * being the distance from its centre in chart coordinates. It is rigid: all of it turns as its centre does, at dph/dt
 * = 1 / (radius^(3/2) + a), with RETROGRADE -1 / (radius^(3/2) - a), per M, so that it keeps its shape; parts that
 * would have to be faster than light, beside the hole, are left out. It shines and absorbs as BhrVolume says. With
 * BHR_EFFECT_LIGHT_DELAY each part of it is seen where it was when its light left, which for a moving blob is not a
 * detail: without spin, seen 60 degrees from the axis, the flux of one of radius 7 and size 0.7 changes by a factor
 * of about 21 in an orbit, without the delay by about 8. Since 0.2.0.
 */
typedef struct BhrHotSpot {
    uint32_t struct_size; /**< sizeof(BhrHotSpot). */
    uint32_t flags;       /**< Any of BHR_HOT_SPOT_RETROGRADE | BHR_HOT_SPOT_THERMAL. Default 0. */
    /** In M, 1 .. 1000. Inside the ISCO no orbit is stable: there the spot is taken to be at the ISCO. Default 8. */
    double radius;
    double size;           /**< In M, 0.05 .. radius / 4, and at least radius / 200. Default 0.8. */
    double azimuth;        /**< The centre at scene time 0, radians within +-1e6. Default 0. */
    double absorption;     /**< Per M at the centre, 0 .. 1e6. Default 0. */
    double temperature;    /**< Kelvin, 500 .. 1e9. Default 10000. */
    double spectral_index; /**< Without THERMAL: -4 .. 4. Default 1. */
    /** Without THERMAL: the colour of its light at every shift, linear Rec. 709, each 0 .. 1. Default 1, 1, 1. */
    double tint[3];
    double brightness; /**< 0 .. 1e6, as BhrVolume.brightness. Default 1. */
} BhrHotSpot;

#define BHR_MAX_HOT_SPOTS 8 /**< Most hot spots of a scene. Since 0.2.0. */

/**
 * Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
 * for NULL or a wrong struct_size. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_volume_init(BhrVolume *volume, size_t struct_size);

/**
 * Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
 * for NULL or a wrong struct_size. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_hot_spot_init(BhrHotSpot *hot_spot, size_t struct_size);

/**
 * Sets all volumes of the scene: count of them, packed, at most BHR_MAX_VOLUMES; 0: none, as a new context has it, and
 * then volumes may be NULL. They are copied, and may overlap each other, the thin disk and hot spots. volume_size =
 * sizeof(BhrVolume) as the caller was compiled; no volume's struct_size may be larger than volume_size. Frames that
 * are being rendered keep the volumes that they began with. Errors: INVALID_ARGUMENT for NULL, a count, a size or a
 * number outside its range, or an unknown flag, shape or flow; the scene then stays as it was. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_set_volumes(BhrContext *context,
                                        const BhrVolume *volumes,
                                        size_t volume_size,
                                        uint32_t count);

/**
 * Reads the volumes as they are set: *out_count becomes their number, and the first `capacity` of them are written,
 * packed, each with volume_size as its struct_size. With capacity 0 volumes may be NULL. Errors: INVALID_ARGUMENT for
 * NULL or a wrong volume_size; volumes are then as they were. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_get_volumes(const BhrContext *context,
                                        BhrVolume *volumes,
                                        size_t volume_size,
                                        uint32_t capacity,
                                        uint32_t *out_count);

/**
 * Sets all hot spots of the scene: count of them, packed, at most BHR_MAX_HOT_SPOTS; 0: none, as a new context has
 * it, and then hot_spots may be NULL. Otherwise as bhr_set_volumes. Errors: INVALID_ARGUMENT as there. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_set_hot_spots(BhrContext *context,
                                          const BhrHotSpot *hot_spots,
                                          size_t hot_spot_size,
                                          uint32_t count);

/**
 * Reads the hot spots as they are set, as bhr_get_volumes does the volumes. Errors: INVALID_ARGUMENT for NULL or a
 * wrong hot_spot_size. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_get_hot_spots(const BhrContext *context,
                                          BhrHotSpot *hot_spots,
                                          size_t hot_spot_size,
                                          uint32_t capacity,
                                          uint32_t *out_count);

/* ---- images in the host's memory ---- */

/**
 * BhrImage.flags: the sky is left out, and alpha is 1 - the sky's share, premultiplied. Without this flag alpha is 1.
 * Bloom adds light and leaves alpha as it is: glare over the host's own picture.
 */
#define BHR_IMAGE_TRANSPARENT 1u

/**
 * BhrImage.flags: the picture's bottom row comes first in memory, as OpenGL has it. pixels is then the lowest
 * address of the block, as without the flag, and row_stride, 0 or more, is the distance to the next row up. Since
 * 0.2.0.
 */
#define BHR_IMAGE_BOTTOM_UP 2u

/**
 * BhrImage.flags: for bhr_set_occluder, and flags of bhr_set_occluder_target: the host has drawn the things where bent
 * light shows them (BhrProjectedPoint.apparent), so bhr compares their distances with those along bent rays. Without
 * it the things lie on straight lines of sight. Since 0.2.0.
 */
#define BHR_IMAGE_LENSED 4u

/**
 * A pixel's bytes in memory order. A radiance of 1 is the luminance at rest of the ring
 * that BhrDisk.reference names, if the disk's brightness is 1.
 */
typedef int32_t BhrFormat;

#define BHR_FORMAT_RGBA8_SRGB 1 /**< 4 bytes: red, green, blue with the sRGB curve, alpha. */
#define BHR_FORMAT_BGRA8_SRGB 2 /**< 4 bytes: blue, green, red with the sRGB curve, alpha. */
#define BHR_FORMAT_RGBA16F 3    /**< 4 half floats: linear radiance, Rec. 709 primaries; alpha. */
#define BHR_FORMAT_RGBA32F 4    /**< 4 floats: linear radiance, Rec. 709 primaries; alpha. */
#define BHR_FORMAT_R32F 5       /**< 1 float: the value of a view or an output, or the distance of an occluder. */

/**
 * Pixels in memory. Bytes between rows are neither read nor written. Several images may share a block, side by
 * side or interleaved; different contexts may then render them at the same time.
 *
 * For rows from the bottom up, use BHR_IMAGE_BOTTOM_UP. A negative row_stride with pixels at the last row of the
 * block means the same. Beware: if pixels is left at the beginning of the block, all rows but one are written in
 * front of it, and no check can find that.
 */
typedef struct BhrImage {
    uint32_t struct_size; /**< sizeof(BhrImage). */
    BhrFormat format;     /**< BHR_FORMAT_*. Default RGBA8_SRGB. */
    uint32_t width;       /**< Pixels, 1 .. 2^20. */
    uint32_t height;      /**< Pixels, 1 .. 2^20. */
    /** The top-left pixel; with BHR_IMAGE_BOTTOM_UP the bottom-left one. Aligned to its channel: 1, 2 or 4 bytes. */
    void *pixels;
    /**
     * Bytes to the next row down, with BHR_IMAGE_BOTTOM_UP to the next row up; a multiple of the channel's size. 0
     * (default): packed. < 0: the next row down lies lower in memory, and pixels is the block's last row; not together
     * with BHR_IMAGE_BOTTOM_UP. |row_stride| must hold a row.
     */
    int64_t row_stride;
    /**
     * Size of the host's block in bytes. The block begins at pixels, or, where row_stride < 0, (height - 1)
     * |row_stride| bytes before it. Needed: (height - 1) |row_stride| + width bytes-per-pixel; checked.
     */
    uint64_t byte_size;
    /**
     * BHR_IMAGE_* bits. Default 0. BHR_IMAGE_TRANSPARENT does something in images that are rendered only, and
     * BHR_IMAGE_LENSED is for bhr_set_occluder only: elsewhere it is INVALID_ARGUMENT.
     */
    uint32_t flags;
    uint32_t reserved; /**< Reserved: 0. */
} BhrImage;

/**
 * Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
 * for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_image_init(BhrImage *image, size_t struct_size);

/**
 * Writes an image to a file: 8-bit formats to .png or .ppm (without alpha), float formats to .exr; R32F becomes
 * grey. Alpha is written as it is. The file is written as .bhr-*.tmp in the same folder, brought to the disk
 * (fsync), then renamed, so that it appears whole or not at all. A file that is replaced keeps its mode, and its
 * owner where the process may set it; where its group cannot be kept, the mode loses the group's rights. Where path
 * is a symbolic link, its target is written. Other hard links keep the old picture. A process that is killed leaves
 * the temporary file. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT for a bad image or NULL;
 * UNSUPPORTED for another extension, one that does not go with the format, or .exr in a library that was built
 * without EXR; OUT_OF_MEMORY; IO, with the path in the message, also for an older file that this process may not
 * write, for another user's symbolic link in a sticky folder that all may write (such as /tmp), and for a full disk,
 * a quota and RLIMIT_FSIZE (without SIGXFSZ).
 */
BHR_NODISCARD BhrStatus bhr_image_save(const BhrImage *image, const char *path);

/**
 * Reads a PNG, EXR or PNM file. The caller sets image->struct_size; the rest is filled in: packed rows from the top
 * down. 8-bit files give RGBA8_SRGB, others RGBA32F (16-bit files are made linear). From an EXR file the largest
 * level of the first part with channels R, G and B is read and cut to the display window; pixels that the data window
 * does not cover are 0. Headers may have 8 MiB, and a part 4096 channels. A block, whose channels are all unpacked
 * together, may have 64 MiB, or four times the bytes of the image if those are more, but at most 256 MiB; all blocks
 * that reach the display window may have 1 GiB, or four times the bytes of the image if those are more. Deep data and
 * subsampling are IO. The pixels are the library's: give them back with bhr_image_release, once. Any thread, inside
 * callbacks too. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size; UNSUPPORTED for EXR of the compressions
 * DWA and HTJ2K, or in a library that was built without EXR; OUT_OF_MEMORY; IO for a file that is not there, not
 * readable, broken, of more than 2^20 pixels a side, or of more than 4 GiB of pixels in memory, however small the
 * file is. What a file claims is checked before memory is taken for it.
 */
BHR_NODISCARD BhrStatus bhr_image_load(const char *path, BhrImage *image);

/**
 * Gives back the pixels of bhr_image_load and sets image->pixels to NULL and byte_size to 0. Any thread, inside
 * callbacks too. Errors: INVALID_ARGUMENT for pixels that are NULL, the host's, or were given back before.
 */
BHR_NODISCARD BhrStatus bhr_image_release(BhrImage *image);

/* ---- sky ---- */

/** BhrSky.flags: the real sky, from the embedded star catalogue. */
#define BHR_SKY_STARS 1u

/**
 * BhrSky.flags: a random star field of a million stars to V = 11, with the real sky's numbers in each magnitude, its
 * crowding towards the Milky Way, and its colours. The same seed gives the same stars on every machine. Together with
 * STARS it adds the stars that are fainter than the catalogue's (V > 8). It is made when it is first drawn, within
 * about a second, and takes 110 MB of device memory.
 */
#define BHR_SKY_PROCEDURAL 2u

/**
 * BhrSky.flags: the glow of the Milky Way, made from embedded outlines at first use (0.1 to 0.5 s). It is true to
 * about a degree, finer clouds and dust are made up, and next to the stars eight times as bright as the eye sees it.
 */
#define BHR_SKY_MILKY_WAY 4u

/** BhrSky.flags: the map that bhr_set_sky_map was given; nothing without one. */
#define BHR_SKY_MAP 8u

/**
 * BhrSky.flags: a grid in sky axes, which shows the lensing: right ascension every hour (15 degrees; every 6 hours
 * within 15 degrees of the poles), declination every 15 degrees, the equator and right ascension 0 in another
 * colour. Lines are 1.3 pixels wide and laid over the sky, whatever its brightness and the shift of its light; where
 * less than 10 pixels apart they fade into an even tint.
 */
#define BHR_SKY_GRID 16u

/** The sky: everything that lies at infinity. */
typedef struct BhrSky {
    uint32_t struct_size;    /**< sizeof(BhrSky). */
    uint32_t flags;          /**< BHR_SKY_* bits; 0: black. Default STARS | MILKY_WAY. */
    double stars_brightness; /**< 0 .. 1e6. Default 1. */
    double map_brightness;   /**< A factor on the light of the Milky Way and the map, 0 .. 1e6. Default 1. */
    /**
     * Unit quaternion x y z w that takes sky axes (J2000 equatorial: +x vernal equinox, +z north celestial pole)
     * to scene axes. Default (0, 0, 0, 1).
     */
    double orientation[4];
    uint64_t seed; /**< Selects the stars of BHR_SKY_PROCEDURAL: any number. Default 0. */
} BhrSky;

/**
 * Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
 * for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_sky_init(BhrSky *sky, size_t struct_size);

/**
 * Sets the sky; NULL: black. Errors: INVALID_ARGUMENT for a number outside its range, an orientation that is no
 * unit quaternion, or an unknown flag; UNSUPPORTED for flags that this version cannot draw.
 */
BHR_NODISCARD BhrStatus bhr_set_sky(BhrContext *context, const BhrSky *sky);

/** The sky as it is set. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size. */
BHR_NODISCARD BhrStatus bhr_get_sky(const BhrContext *context, BhrSky *sky);

/**
 * Gives BHR_SKY_MAP its picture, copied before return (a second or two for 16384 x 8192); NULL removes it. The next
 * frames that are asked for show it. It covers the whole sky whatever its aspect: at x of width and y of height, from
 * the top left, right ascension is 360 deg (1/2 - x / width), declination 180 deg (1/2 - y / height). So the north
 * pole is at the top, right ascension 0 (+x of the sky axes) in the middle, and +y at a quarter of the width: the
 * picture looks as the sky does from inside, as astronomers' maps do.
 *
 * Light at rest is what the picture holds, linear Rec. 709, 8-bit formats decoded, to within 0.2 % of the brightest
 * channel: black up to 2^-25, 65408 at most; NaN and negative numbers are 0, alpha is ignored. Its frequency shift
 * is that of the blackbody of its blue-to-red ratio, of 2500 K to 25000 K: each channel changes as that blackbody's
 * does. Pixels get the mean of the map over their patch of sky, the first and the last row in each case their mean.
 * Pictures of more than 16384 x 8192, or of more rows than 1024 and four times their columns, are reduced to that,
 * and on the device to its largest texture. Memory: 5.4 bytes a texel in the context and 6 on the device. Errors:
 * INVALID_ARGUMENT for a bad image or R32F; OUT_OF_MEMORY.
 */
BHR_NODISCARD BhrStatus bhr_set_sky_map(BhrContext *context, const BhrImage *equirect);

/* ---- film ---- */

/** The curve from light to pixels. */
typedef int32_t BhrToneMap;

/** No curve: light above 1 is clipped. */
#define BHR_TONE_MAP_NONE 0

/**
 * A filmic curve: the fit of ACES 1.0 by Stephen Hill (2015) after a factor 1 / 0.6, as three.js has it; middle grey,
 * 0.18, becomes 127 of 255.
 */
#define BHR_TONE_MAP_ACES 1

/**
 * AgX (T. Sobotka, 2022), base look, with the primaries of Blender's, as three.js has it; middle grey becomes 128 of
 * 255, and bright saturated light goes to white with less shift of its hue than under ACES.
 */
#define BHR_TONE_MAP_AGX 2

/** The colours of a picture. Since 0.2.0. */
typedef int32_t BhrColourMap;

/** The picture has the colours of the light. Since 0.2.0. */
#define BHR_COLOUR_MAP_NONE 0

/**
 * The map afmhot of matplotlib and gnuplot, in which the Event Horizon Telescope publishes its images: with s, the
 * luminance (Y of Rec. 709) of the exposed light after the tone map, 0 .. 1, red is 2 s, green 2 s - 1/2 and blue 2 s
 * - 1, each within 0 .. 1, in sRGB code values. With BHR_TONE_MAP_NONE s is linear in the light. Since 0.2.0.
 */
#define BHR_COLOUR_MAP_AFMHOT 1

/**
 * How light becomes pixels. It applies to 8-bit formats and windows only, because float formats hold linear radiance;
 * and to BHR_VIEW_LIGHT only, because the other views show values. In this order: exposure, bloom, beam, tone map, the
 * sRGB curve or the colour map, dithering.
 */
typedef struct BhrFilm {
    uint32_t struct_size; /**< sizeof(BhrFilm). */
    BhrToneMap tone_map;  /**< BHR_TONE_MAP_*. Default ACES. */
    double exposure_ev;   /**< Stops, -20 .. 20. Default 0. */
    /**
     * Glare: the share of the light that the eye's or a camera's optics scatter. 0 off .. 1, default 0.25. A pixel
     * keeps 1 - 0.4 bloom of its light L, and the rest spreads: out = (1 - s) L + s (L * K), s = 0.4 bloom, where K,
     * of integral 1, falls with the distance r as (r^2 + r0^2)^(-3/2) + (r^2 + r0^2)^-1 / r1, cut off smoothly about H
     * / 4: the eye's 10 / theta^3 + 10 / theta^2 (Spencer et al., SIGGRAPH 1995) for a frame of height H seen from 2 H
     * away, with r0 = H / 180, r1 = H / 28 = 1 degree. So it looks the same at every resolution. No light is lost:
     * what would leave the frame is reflected at its border. Light is limited to 65504 after exposure. In transparent
     * images glare is added light, and alpha stays coverage. Glare comes from the whole frame: with a region set,
     * 8-bit images of light are INVALID_STATE when they are rendered; but where no bhr_set_film came after the context
     * was made, or after the last bhr_set_preset, they are rendered without glare. It spreads over the
     * picture, not over the sphere: in EQUIRECT and CUBE frames seams and faces' borders interrupt it. Frames above 25
     * megapixels (12 on the CPU) are traced twice, as their light is not kept.
     */
    double bloom;
    /**
     * The full width at half maximum of a Gaussian that the picture is spread by, as by the beam of a telescope; in
     * frame heights, 0 off (default) .. 1. In a PERSPECTIVE frame an angle w at its middle is w / (2 tan(fov_y / 2))
     * heights. For how the Event Horizon Telescope saw M87*, take half the bright ring's diameter: the beam is
     * 20 microarcseconds wide, the ring 42. What would leave the frame is mirrored at its border, and alpha is left
     * alone. With a region set, 8-bit images of light are INVALID_STATE when they are rendered, also when a preset set
     * the beam; EQUIRECT and CUBE frames and large ones are as for bloom. Beams of less than 7 pixels are not quite
     * Gaussian, but of the right width. Since 0.2.0.
     */
    double beam_fwhm;
    BhrColourMap colour_map; /**< BHR_COLOUR_MAP_*. Default NONE. Since 0.2.0. */
    uint32_t reserved;       /**< 0. Since 0.2.0. */
} BhrFilm;

/**
 * Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
 * for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_film_init(BhrFilm *film, size_t struct_size);

/** Sets the film. Errors: INVALID_ARGUMENT for NULL, a number outside its range, an unknown tone map or colour map. */
BHR_NODISCARD BhrStatus bhr_set_film(BhrContext *context, const BhrFilm *film);

/** The film as it is set. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size. */
BHR_NODISCARD BhrStatus bhr_get_film(const BhrContext *context, BhrFilm *film);

/* ---- relativistic effects, time ---- */

#define BHR_EFFECT_DOPPLER_SHIFT 1u /**< The frequency shift by motion colours the light. */
#define BHR_EFFECT_GRAVITY_SHIFT 2u /**< The gravitational redshift colours the light. */
#define BHR_EFFECT_BEAMING 4u       /**< The intensity follows g^3 (I_nu), g^4 (bolometric). */
#define BHR_EFFECT_LIGHT_DELAY 8u   /**< Moving matter is seen at its retarded time. */
#define BHR_EFFECT_ALL 4294967295u  /**< All effects, as a new context has them. */

/**
 * Sets the effects that colour the light: BHR_EFFECT_* bits; unknown bits are ignored. Default BHR_EFFECT_ALL. Lensing
 * itself cannot be switched off. The redshift g = g_gravity g_doppler is split at the local static observers (ZAMO) of
 * emitter and camera. LIGHT_DELAY shows only where matter is not the same all around: in a turbulent disk, in the
 * structure of volumes and in hot spots, from inside a spin-0 horizon too; without it, all matter is seen as it is at
 * the t that bhr_set_time gives. Errors: INVALID_ARGUMENT for NULL.
 */
BHR_NODISCARD BhrStatus bhr_set_effects(BhrContext *context, uint32_t effects);

/** The effects as they are set. Since 0.2.0. Errors: INVALID_ARGUMENT for NULL. */
BHR_NODISCARD BhrStatus bhr_get_effects(const BhrContext *context, uint32_t *out_effects);

/**
 * Sets the scene's time in scene lengths, finite; it turns disk, volumes and spots. Default 0. It is the chart's t
 * at the camera, which ends at the horizon; for a camera at or inside a spin-0 horizon it is the rain
 * (Painleve-Gullstrand) time T = t + H(r), r in M, with H = 2 sqrt(2 r) + 2 ln((sqrt(r) - sqrt(2)) / (sqrt(r) +
 * sqrt(2))), which a clock that falls from rest at infinity shows. bhr_camera_advance tells how both go by. Errors:
 * INVALID_ARGUMENT.
 */
BHR_NODISCARD BhrStatus bhr_set_time(BhrContext *context, double time);

/** The time as it is set, scene lengths. Since 0.2.0. Errors: INVALID_ARGUMENT for NULL. */
BHR_NODISCARD BhrStatus bhr_get_time(const BhrContext *context, double *out_time);

/* ---- presets: named looks ---- */

/**
 * A named look: values for disk, sky, film and effects that setters can then change. Since 0.2.0.
 *
 * Each preset sets all of BhrDisk, all of BhrFilm, the effects, and flags and brightness of BhrSky. Hole, camera,
 * hot spots, time, view, quality, region, and the sky's orientation, seed and map stay as they are: a host that shows
 * its own map sets BHR_SKY_MAP again. bhr_set_preset_with can also show matter with depth, a volume, in place of the
 * thin disk. An empty cell has the first column's value.
 *
 * ```text
 * field                  if empty     CINEMATIC    PHYSICAL     OBSERVATORY  TEACHING
 * disk.flags             0
 * disk.inner_radius      0 (ISCO)
 * disk.outer_radius      20           17                        12           12
 * disk.temperature       6500         3500                      15000        5000
 * disk.opacity           1
 * disk.brightness        1            0.6                                    0.6
 * disk.turbulence        0            1
 * disk.seed              0
 * disk.reference         AT_MEDIAN
 * disk.emission_law      ISOTROPIC
 * disk.edge_softness     0            0.4
 * sky.flags              STARS        STARS        STARS        0            GRID
 *                        | MILKY_WAY  | MILKY_WAY  | MILKY_WAY
 * sky.stars_brightness   1
 * sky.map_brightness     1
 * film.tone_map          ACES                      NONE         NONE         NONE
 * film.exposure_ev       0                         -2           -0.5
 * film.bloom             0            0.25
 * film.beam_fwhm         0                                      0.15
 * film.colour_map        NONE                                   AFMHOT
 * effects                ALL                                                 DOPPLER_SHIFT | GRAVITY_SHIFT
 * ```
 */
typedef int32_t BhrPreset;

/**
 * The default: a golden disk with structure and soft edges, its approaching side nearly white, and glare, as a film
 * would show it. Since 0.2.0.
 */
#define BHR_PRESET_CINEMATIC 0

/**
 * As a physicist expects it: a smooth disk, no glare, no tone curve; light is shown as it is, two stops down, until it
 * clips. Since 0.2.0.
 */
#define BHR_PRESET_PHYSICAL 1

/**
 * As the Event Horizon Telescope shows its sources: a ring blurred by a Gaussian beam, its luminance in one colour
 * map, on a black sky. The beam is about half the bright ring's diameter, as for M87*, where that ring is 0.3 of the
 * frame's height: 30 M away at a fov_y of 60 degrees. M87* is seen from 73 degrees above the disk's
 * plane. Since 0.2.0.
 */
#define BHR_PRESET_OBSERVATORY 2

/**
 * For lessons: a grid on the sky, which shows the lensing, and a smooth disk whose colours are those of the frequency
 * shifts, but which motion makes neither brighter nor darker: beaming and light delay are off. Since 0.2.0.
 */
#define BHR_PRESET_TEACHING 3

/** The matter that bhr_set_preset_with shows. Since 0.2.0. */
typedef int32_t BhrPresetMatter;

/** DEEP where the adapter is fast enough for it, else THIN. Since 0.2.0. */
#define BHR_PRESET_MATTER_AUTO 0

/** The thin disk, as bhr_set_preset. Since 0.2.0. */
#define BHR_PRESET_MATTER_THIN 1

/**
 * One volume instead of the disk; sky, film and effects are as BhrPreset states. An empty cell has the first column's
 * value, and every field of BhrVolume that is not here that of bhr_volume_init. TEACHING, whose colours are the
 * frequency shifts of one plane, has no such look and stays THIN. Since 0.2.0.
 *
 * ```text
 * field                     if empty     CINEMATIC    PHYSICAL     OBSERVATORY
 * volume.flags              0                                      POWER_LAW
 * volume.shape              DISK                                   TORUS
 * volume.inner_radius       0 (ISCO)
 * volume.outer_radius       17                                     20
 * volume.radius             8                                      5
 * volume.width              2
 * volume.thickness          0.05                                   0.4
 * volume.slope              0.7
 * volume.absorption         3                                      0.05
 * volume.temperature        4800                      9000
 * volume.temperature_slope  0.35                      0.75
 * volume.spectral_index     1
 * volume.brightness         1            1.4          7            0.6
 * volume.sub_keplerian      1                                      0.8
 * volume.infall             0                                      0.2
 * volume.turbulence         0            1
 * ```
 */
#define BHR_PRESET_MATTER_DEEP 2

/** How bhr_set_preset_with chooses. Since 0.2.0. */
typedef struct BhrPresetOptions {
    uint32_t struct_size;   /**< sizeof(BhrPresetOptions). */
    BhrPresetMatter matter; /**< BHR_PRESET_MATTER_AUTO (default), _THIN, _DEEP. */
    /** AUTO: the width of the frames that are to be rendered, in pixels, 1 .. 1048576; 0 means the default, 1920. */
    uint32_t width;
    uint32_t height; /**< AUTO: their height, in pixels, 1 .. 1048576; 0 means the default, 1080. */
    /** AUTO: the time that such a frame may take, in milliseconds, 0.001 .. 1e9; 0 means the default, 16. */
    double frame_ms;
} BhrPresetOptions;

/**
 * Gives the scene a look: the values of BhrPreset, with the thin disk. A volume that bhr_set_preset_with set leaves
 * with the look that it belongs to, unless it was changed since; volumes of the host's own stay. Since 0.2.0. Errors:
 * INVALID_ARGUMENT for an unknown preset.
 */
BHR_NODISCARD BhrStatus bhr_set_preset(BhrContext *context, BhrPreset preset);

/**
 * Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
 * for NULL or a wrong struct_size. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_preset_options_init(BhrPresetOptions *options, size_t struct_size);

/**
 * Gives the scene a look, and decides its volumes as well: with DEEP they are that look's one, in place of the
 * thin disk; with THIN there are none. Volumes that were set before are gone; hot spots stay. options NULL: all
 * defaults. *out_matter becomes BHR_PRESET_MATTER_THIN or _DEEP, whichever the scene has now; out_matter may be
 * NULL.
 *
 * THIN and DEEP give the same picture on every machine. AUTO measures, and may choose otherwise on another
 * machine, or when the machine is busy: it renders the look with depth, as a new context's camera sees it, about a
 * hole of spin 0.5, with the context's BhrQuality, and throws it away. Frames of 4 x 2 come first, larger ones
 * follow, up to 1920 x 1080, until one of 480 x 270 or more takes 4 ms, and as long as the time allows. The
 * fastest of three counts, by the GPU's clock where BhrFrameStats has it (gpu_ns), else by the host's. DEEP is
 * chosen if width x height pixels take at most frame_ms by that. Each preset is measured once in a context, and
 * again when BhrQuality or, by bhr_context_recover, the device is another. Measuring takes about half a second at
 * most, whatever the quality; what comes on top is what the first frame of such a scene takes anyway: the sky's
 * pictures and tables of noise are made, and on GPUs and software drivers programs compiled. bhr_frame_stats does
 * not count these frames and the progress callback is not told of them; the call waits for a job that is being
 * rendered.
 *
 * Any thread, not inside callbacks. Errors: INVALID_ARGUMENT for an unknown preset or matter, or a number outside
 * its range; with AUTO also DEVICE_LOST and OUT_OF_MEMORY. The scene then stays as it was. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_set_preset_with(BhrContext *context,
                                            BhrPreset preset,
                                            const BhrPresetOptions *options,
                                            BhrPresetMatter *out_matter);

/* ---- quality ---- */

/**
 * How light is followed. Frames by different methods differ by less than these errors:
 *
 * | method                     | rays are                                | look direction | radius, redshift |
 * |----------------------------|-----------------------------------------|----------------|------------------|
 * | ADAPTIVE, double precision | integrated with error control           | 1e-8 rad       | 1e-8, relative   |
 * | ADAPTIVE, single precision | integrated with error control           | 2e-6 rad       | 2e-6             |
 * | RK4 with the default step  | integrated in fixed steps, fourth order | 2e-5 rad       | 2e-5             |
 * | AUTO                       | looked up in tables where that pays     | 5e-6 rad       | 1e-5             |
 *
 * An error of the look direction is how far the ray of a sky direction is off; each error is divided by (1 +
 * conditioning), as rays near the edge of the shadow magnify every rounding. The CPU tracer works in double precision,
 * GPUs in single.
 *
 * AUTO, the fastest, makes tables of the lens that the hole is for the camera's observer. They are made anew when the
 * observer moves, but not when the view turns or zooms, and they serve under these conditions:
 *
 * |                              | spin 0                       | with spin                                    |
 * |------------------------------|------------------------------|----------------------------------------------|
 * | samples in a frame, at least | 4096                         | 500000 on a GPU, 140000 on the CPU           |
 * | nearest observer             | 2.0005 M; in FREE_FALL 0.9 M | 1.03 retrograde photon orbits (3.1 to 4.1 M) |
 * | farthest observer            | 1e6 M                        | 1e5 M                                        |
 * | max_disk_order, at most      | 15                           | 15; beyond 1e4 M 11                          |
 * | ... of a turbulent disk      | 15                           | 3; beyond 1e4 M 2                            |
 *
 * Elsewhere AUTO integrates every ray in fixed steps of fifth order, as it always does for bhr_trace_rays,
 * BHR_VIEW_METRIC, disks with BHR_DISK_PLUNGES, and scenes with volumes or hot spots.
 */
typedef int32_t BhrMethod;

#define BHR_METHOD_AUTO 0     /**< Looked up in tables where that pays, else integrated. The fastest. */
#define BHR_METHOD_RK4 1      /**< Every ray integrated by fixed-step fourth-order Runge-Kutta. */
#define BHR_METHOD_ADAPTIVE 2 /**< Every ray integrated by embedded Runge-Kutta with error control. */

/** The rays that matter with depth, volumes and hot spots, is summed along. Since 0.2.0. */
typedef int32_t BhrVolumeResolution;

/** Those of all pixels. Since 0.2.0. */
#define BHR_VOLUME_RESOLUTION_FULL 0

/**
 * One ray of each block of 2 x 2 pixels, counted from the frame's top-left corner: a pixel's matter is found from the
 * twelve blocks about it by cubic interpolation. The pixel's own ray is summed instead where one of their rays had
 * another fate than the pixel's or met other images of the disk; and where linear interpolation, which is one order
 * less exact than what is shown, may be off by more than 1/64 (1/16 in scenes with turbulent matter) of the light (of
 * its brightest colour), of the share of light from behind that passes, or of the view's value. Light below 0.004 of
 * white counts as 0.004, a share below 0.05 as 0.05, an optical depth below 0.001 as 0.001. The rest of a pixel, and
 * the rays of pixels that an edge runs through, are as with FULL. What is narrower than a block, as a thin image or
 * fine turbulence, may lie between the rays and be missed: in a turbulent picture of 320 x 180 nine of ten pixels were
 * within 1/30 of those with FULL, all but 0.1 % within 1/6.
 * The same scene gives the same bytes, whole or in parts; both tracers do so. BhrFrameStats counts the steps of the
 * pixels' rays only. Since 0.2.0.
 */
#define BHR_VOLUME_RESOLUTION_HALF 1

/** How exactly to trace. */
typedef struct BhrQuality {
    uint32_t struct_size; /**< sizeof(BhrQuality). */
    BhrMethod method;     /**< BHR_METHOD_*. Default AUTO. */
    /**
     * Samples of each pixel, 1 (default) .. 256. More than one are drawn from, and so weighted by, a quadratic
     * B-spline 3 pixels wide about the pixel's centre. (CUBE: they lie evenly in the pixel, because another part of
     * the sky begins across a face's border.) Views other than BHR_VIEW_LIGHT take one. Where an edge of the disk, a
     * steep change or the edge of the shadow runs through the pixel, each sample is the mean of 4 or 32 rays over a
     * pixel's area; BhrFrameStats does not count those.
     */
    uint32_t samples_per_pixel;
    /** Steps of an integrated ray, 16 .. 100000. Default 2000. A ray that needs more is BHR_FATE_UNRESOLVED. */
    uint32_t max_steps;
    /** RK4: the step in sigma = S tau (Mino time scaled to the ray), 1e-3 .. 0.5; 0 means the default, 0.1. */
    double step;
    /**
     * ADAPTIVE: the relative tolerance, 1e-14 .. 1e-3; 0 means the default, 1e-10. Single-precision tracers use their
     * own.
     */
    double tolerance;
    uint32_t max_disk_order; /**< Images of the disk to follow, 0 (the direct one only) .. 15. Default 3. */
    uint32_t reserved;       /**< Reserved: 0. */
    double render_scale;     /**< Windows: traced size / window size, 0.1 .. 1. Default 1. */
    /** BHR_VOLUME_RESOLUTION_*. Default FULL. No effect without volumes and hot spots. Since 0.2.0. */
    BhrVolumeResolution volume_resolution;
    uint32_t reserved2; /**< Reserved: 0. Since 0.2.0. */
} BhrQuality;

/**
 * Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
 * for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_quality_init(BhrQuality *quality, size_t struct_size);

/**
 * Sets the quality. Errors: INVALID_ARGUMENT for NULL, a number outside its range, an unknown method or
 * an unknown resolution.
 */
BHR_NODISCARD BhrStatus bhr_set_quality(BhrContext *context, const BhrQuality *quality);

/** The quality as it is set. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size. */
BHR_NODISCARD BhrStatus bhr_get_quality(const BhrContext *context, BhrQuality *quality);

/* ---- what a pixel shows ---- */

/**
 * The quantity that pixels show. 8-bit formats and windows show it in false colour, without film; R32F holds its
 * value, NaN where there is none. RGBA16F and RGBA32F hold LIGHT only, R32F every view but LIGHT: else rendering is
 * INVALID_ARGUMENT. A backend may lack a view: then rendering is UNSUPPORTED.
 *
 * For a host's legend, the colours of values: s goes from 0 to 1 over the range that each view states, and stays at 0
 * and 1 beyond it. The sequential map is CIELAB L = 15 + 76 s, a = 11 + 56 cos w, b = 21 + 56 sin w, w = 4.76 + 3.78
 * s: from dark blue over purple, red and orange to light yellow. The diverging map, with m = |2 s - 1|, is L = 95 - 57
 * m and (a, b) = (52.00, 33.77) m below s = 1/2, red, (21.21, -58.26) m above it, blue, with light grey between them.
 * The white is that of Rec. 709, and colours are encoded as sRGB. Equal steps of s are equal steps of colour and of
 * lightness. NaN is grey, (128, 128, 128).
 */
typedef int32_t BhrView;

/** The picture. The default. */
#define BHR_VIEW_LIGHT 0

/**
 * The redshift g of the first crossing within the disk's radii, else that of the sky; NaN where the ray is captured
 * without such a crossing. Diverging map, s = 1/2 + ln(g) / (2 ln 3): g = 1/3 .. 3, light grey where nothing is
 * shifted, blue above 1, red below.
 */
#define BHR_VIEW_REDSHIFT 1

/**
 * The number of the image, 0, 1, 2 .., of the first crossing within the disk's radii; -1 sky; -2 captured. Sequential
 * map, s = (order + 2) / 5: order 3 and above are one colour.
 */
#define BHR_VIEW_ORDER 2

/**
 * The angle between look direction and sky direction, radians; NaN where the ray is captured. Sequential map, s = 1 +
 * log2(angle / pi) / 6: angles from pi / 64 to pi.
 */
#define BHR_VIEW_DEFLECTION 3

/**
 * The integration steps of the pixel's ray; 0 where it was looked up (BHR_METHOD_AUTO). Sequential map, s = log2(steps
 * / 8) / 6: 8 .. 512 steps.
 */
#define BHR_VIEW_STEPS 4

/**
 * -g_tt = 1 - 2 M / r at the first crossing of the equatorial plane; NaN without one. Sequential map, s = 1 - sqrt(1 -
 * value): 0, the static limit, and less are its dark end; 1, infinity, its light one.
 */
#define BHR_VIEW_METRIC 5

/**
 * The optical depth of all volumes and hot spots along the ray, at the camera's frequency, as in BhrTransfer; NaN
 * unless the ray escapes. The thin disk does not count. Sequential map, s = (log2(value) + 6) / 10: 1/64 .. 16.
 * Since 0.2.0.
 */
#define BHR_VIEW_OPTICAL_DEPTH 6

/**
 * The intensity at the camera's frequency of volumes and hot spots with a power law, where they send 1 per M at
 * density 1, as in BhrTransfer. It is what Gold et al. 2020 sum to a flux. The thin disk does not count. Sequential
 * map, s = (log2(value) + 6) / 12: 1/64 .. 64. Since 0.2.0.
 */
#define BHR_VIEW_INTENSITY 7

/** Sets the view. Default BHR_VIEW_LIGHT. Errors: INVALID_ARGUMENT for an unknown view. */
BHR_NODISCARD BhrStatus bhr_set_view(BhrContext *context, BhrView view);

/** The view as it is set. Since 0.2.0. Errors: INVALID_ARGUMENT for NULL. */
BHR_NODISCARD BhrStatus bhr_get_view(const BhrContext *context, BhrView *out_view);

/* ---- parts of a larger frame ---- */

/**
 * The part of a larger frame that an image holds: for tiles, dome walls and render farms. Tiles that are joined have
 * the same bytes as the frame, unless that has glare (BhrFilm.bloom).
 */
typedef struct BhrRegion {
    uint32_t struct_size; /**< sizeof(BhrRegion). */
    uint32_t full_width;  /**< Pixels of the whole frame, 1 .. 2^20. */
    uint32_t full_height; /**< Pixels of the whole frame, 1 .. 2^20. */
    uint32_t x;           /**< Column of the image's left pixels in the frame, < full_width. */
    uint32_t y;           /**< Row of the image's top pixels in the frame, < full_height. */
    uint32_t reserved;    /**< Reserved: 0. */
} BhrRegion;

/**
 * Clears struct_size bytes and sets struct_size. The frame's size has no default: it must be set. Any thread, inside
 * callbacks too. Since 0.2.0. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_region_init(BhrRegion *region, size_t struct_size);

/**
 * Sets the region; NULL: images are whole frames. Images, jobs and camera rays obey it, windows do not. Glare
 * and beams come from the whole frame: with a region, 8-bit images of light with a film that has either are
 * INVALID_STATE when they are rendered; of the default film the glare is left out (BhrFilm.bloom). An image that
 * reaches out of the frame (x + width > full_width) is INVALID_ARGUMENT when it is rendered. Errors:
 * INVALID_ARGUMENT.
 */
BHR_NODISCARD BhrStatus bhr_set_region(BhrContext *context, const BhrRegion *region);

/**
 * Reads the region as it is set. *out_present becomes 1 with a region; without one it becomes 0, and region gets the
 * values of bhr_region_init. Since 0.2.0. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_get_region(const BhrContext *context, BhrRegion *region, int32_t *out_present);

/* ---- rendering into memory ---- */

/**
 * Is told how much of a frame is done: fraction grows from 0 to 1. It returns 0 to cancel, anything else to go on; at
 * 1 the frame is complete and the answer is ignored. It runs inside a bhr_ call only, on the calling thread. It must
 * not throw, unwind or longjmp; calls on a context from inside it return BHR_ERROR_INVALID_STATE.
 */
typedef int32_t (*BhrProgressFn)(void *user, double fraction);

/**
 * Sets the callback that bhr_render_image and bhr_prepare report to, and, inside bhr_job_wait, the jobs that are begun
 * from now on. fn NULL: none (default). Errors: INVALID_ARGUMENT for a NULL context.
 */
BHR_NODISCARD BhrStatus bhr_set_progress(BhrContext *context, BhrProgressFn fn, void *user);

/**
 * Renders the scene as it is now into the host's memory and returns when it is there. Errors: INVALID_ARGUMENT for a
 * bad image, a format that does not go with the view, or an image that reaches out of the region's frame;
 * INVALID_STATE where the camera's motion cannot be, for a CUBE whose frame is not 6 times as wide as high, or for
 * bloom or a beam with a region set; UNSUPPORTED inside a spinning hole's horizon; CANCELLED by the progress callback;
 * DEVICE_LOST, OUT_OF_MEMORY. Until the first pixels are written an error leaves the target alone; after that the
 * message says so, and what is not yet rendered is untouched.
 */
BHR_NODISCARD BhrStatus bhr_render_image(BhrContext *context, const BhrImage *target);

/**
 * Makes everything that frames of the present scene need, so that the next frame is no slower than later ones: GPU
 * programs (a driver compiles one in 0.1 to 1 s if its cache lacks it), tables and the sky. A frame makes whatever
 * is still missing. Programs for likely changes of the scene (spin, view, glare, projection ...) are also made in
 * the background, at low priority: those of the default scene from bhr_context_create on, those of changes while
 * frames are rendered, on GPUs other than software drivers. With BHR_BACKEND_GL nothing is made in the background.
 *
 * target is an image as bhr_render_image would be given it; its pixels and byte_size are not looked at, and may be 0.
 * For RGBA8_SRGB without BHR_IMAGE_TRANSPARENT, frames in windows of that size are prepared too. NULL: only frames in
 * windows of 1920 x 1080, whatever region is set. Frames in windows are prepared as bhr_render_surface traces them: at
 * BhrQuality.render_scale times the window's size, and a CUBE's as large as the window holds it (an image of a CUBE
 * must be 6 times as wide as high).
 *
 * On a GPU it renders one frame that is thrown away. bhr_frame_stats does not count that frame, and the progress
 * callback may cancel it. The call waits for a job that is being rendered. Any thread, not inside callbacks. Errors:
 * as bhr_render_image. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_prepare(BhrContext *context, const BhrImage *target);

/* ---- rendering in the background ---- */

/**
 * A frame that is rendered in the background. Any thread may call; end it with bhr_job_destroy, before or after
 * its context.
 */
typedef struct BhrJob BhrJob;

/**
 * Begins a job, which renders an image in the background, and returns at once. The scene and the region are taken
 * as they are now; later setters neither change the job nor wait for it. Jobs of a context are made in their
 * order, by a thread of the library, several under way at a time: one is copied to the host while the next is
 * traced. Other calls that render wait for the job that is being traced. At most 64 jobs of a context may be
 * unfinished. target itself is copied; target->pixels is written until the job is done or destroyed, and must stay
 * valid, and be used by nobody else, so long. End *out_job with bhr_job_destroy. Errors: those of
 * bhr_render_image, some of which come from bhr_job_wait instead; INVALID_STATE for too many jobs; OUT_OF_MEMORY.
 */
BHR_NODISCARD BhrStatus bhr_render_image_async(BhrContext *context, const BhrImage *target, BhrJob **out_job);

/**
 * Waits until the job is done, at most timeout_ns nanoseconds: 0 polls, UINT64_MAX waits without limit. NOT_READY:
 * it is still running. OK: the image is complete. *out_fraction, unless NULL, becomes the part that is done, 0 ..
 * 1, and 0 after a failure: 0 until its turn has come; then by tiles, of which a small frame is one. A tile counts
 * half once the GPU has it, and wholly once its pixels are there; frames on the CPU and with GL, and those of
 * bhr_render_outputs, begin at 0.01. Meanwhile the progress callback that the context had when the job was begun is
 * called, on this thread. A job that failed returns its failure here, with its message, each time: CANCELLED after
 * bhr_job_cancel or by the progress callback; DEVICE_LOST, OUT_OF_MEMORY, INVALID_STATE and others as
 * bhr_render_image; the message says so if pixels were written. Errors otherwise: INVALID_ARGUMENT for NULL.
 */
BHR_NODISCARD BhrStatus bhr_job_wait(BhrJob *job, uint64_t timeout_ns, double *out_fraction);

/**
 * Copies the message of the last call that failed on this job, whichever thread it was on, into buffer, as
 * bhr_context_error_message does: after a bhr_job_wait that told of a failure, why the job failed. Returns its
 * length, 0 for NULL. Any thread, inside callbacks too; it waits for no other call. Since 0.2.0.
 */
size_t bhr_job_error_message(const BhrJob *job, char *buffer, size_t size);

/**
 * Asks a job to stop, and does not wait: bhr_job_wait then returns CANCELLED, or OK when the job was done before.
 * NULL is a no-op. Any thread, inside callbacks too.
 */
void bhr_job_cancel(BhrJob *job);

/**
 * Cancels a job, waits until it has stopped (a fraction of a frame at most) and frees it; target->pixels is the
 * host's again. Frames for targets (bhr_render_target) go on, but write no image any more. NULL is a no-op. No
 * other thread may use the job any more. From inside a callback it does nothing: bhr_error_message then says so.
 */
void bhr_job_destroy(BhrJob *job);

/* ---- outputs beside the picture ---- */

#define BHR_MAX_OUTPUTS 8u /**< Outputs of one call at most. Since 0.2.0. */

/**
 * A kind of output. All but LIGHT are numbers of the one ray through a pixel's centre: they are not filtered, and
 * not to be averaged across edges. Scene lengths and axes; crossings are those within the disk's radii, in the
 * order in which the ray from the camera meets them, so that without a disk there are none. Outside a fisheye's
 * circle SKY and TRANSMISSION are 0, the others NaN. Since 0.2.0.
 */
typedef int32_t BhrOutputKind;

/**
 * The picture, or with BhrView another than LIGHT its values: what bhr_render_image makes, byte for byte, in any
 * format that goes with the view. index: 0. Since 0.2.0.
 */
#define BHR_OUTPUT_LIGHT 0

/**
 * R32F: the distance from the camera to what the ray meets first. Of the direct image of the disk, a crossing of
 * order 0, that is the straight line's length, |x_hit - x_camera|. Light of higher orders, and captured rays, pass
 * the hole: the distance to the point of the line of sight that is nearest to the hole, 0 where it lies behind.
 * Infinity where the ray escapes without a crossing. Volumes and hot spots have none. A host's linear depth is
 * this times the cosine of the angle to its forward axis. index: 0. Since 0.2.0.
 */
#define BHR_OUTPUT_DEPTH 1

/**
 * RGBA32F, the lens map: the unit vector from which the light of the sky comes, and g = nu(camera) / nu(at
 * infinity). All 0 where the ray is captured, or unresolved. It is known behind the disk, too: TRANSMISSION, or
 * the picture's alpha, says how much of it is seen. A host samples its own surroundings along it. index: 0. Since
 * 0.2.0.
 */
#define BHR_OUTPUT_SKY 2

/**
 * R32F: the share of the sky's light that the disk, volumes and hot spots let pass, 0 .. 1; 0 where the ray is
 * captured. With BHR_IMAGE_TRANSPARENT the picture's alpha is 1 less the mean of this over a pixel. index: 0.
 * Since 0.2.0.
 */
#define BHR_OUTPUT_TRANSMISSION 3

/**
 * RGBA32F: x, y, z of crossing number index, and its order, 0 for the direct image. Without that crossing x, y, z
 * are NaN, and the fourth is -1 where the ray escapes, -2 where it is captured, NaN where it is unresolved. Since
 * 0.2.0.
 */
#define BHR_OUTPUT_POSITION 4

/**
 * RGBA32F: radius, azimuth, redshift and delay of crossing number index, as in BhrCrossing; NaN without that
 * crossing. The delay is NaN for cameras at or inside the photon sphere that fall. Since 0.2.0.
 */
#define BHR_OUTPUT_DISK 5

/**
 * R32F: the value of the view whose BHR_VIEW_* index is, but not LIGHT. REDSHIFT, ORDER and DEFLECTION come from
 * the same rays as other outputs; the others take as long as a frame of their own. Since 0.2.0.
 */
#define BHR_OUTPUT_VIEW 6

/** An output and where it goes. Begin with bhr_output_init. Since 0.2.0. */
typedef struct BhrOutput {
    uint32_t struct_size; /**< sizeof(BhrOutput). */
    BhrOutputKind kind; /**< BHR_OUTPUT_*. Default LIGHT. */
    uint32_t index; /**< POSITION, DISK: the number of a crossing, 0 .. 15. VIEW: BHR_VIEW_*. Otherwise 0. Default 0. */
    uint32_t reserved; /**< Reserved: 0. */
    /**
     * The image, in the format of its kind; NULL with target. Of its flags BHR_IMAGE_TRANSPARENT matters for LIGHT
     * only.
     */
    const BhrImage *image;
    /**
     * A BhrTarget on the GPU instead of image, for bhr_render_outputs_shared of bhr_interop.h, which takes both kinds
     * of places in one list; else NULL.
     */
    void *target;
} BhrOutput;

/**
 * Clears struct_size bytes and fills in the defaults. Any thread, inside callbacks too. Errors: INVALID_ARGUMENT
 * for NULL or a wrong struct_size. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_output_init(BhrOutput *output, size_t struct_size);

/**
 * Renders several outputs of the scene as it is now: count of them, packed, 1 .. BHR_MAX_OUTPUTS, whose images are
 * of one size; the region, if one is set, is theirs. All outputs but LIGHT and some views come from one pass over
 * the frame. LIGHT has the bytes that bhr_render_image makes. The others agree with bhr_trace_rays along
 * bhr_camera_rays to 5e-5 (1 + |value|), but for fewer than one number in 500, of rays that wind about the hole,
 * or pass the edge of the disk or of the shadow.
 *
 * out_job NULL: the call returns when all of it is there, and reports to the progress callback. Otherwise *out_job
 * becomes a job as bhr_render_image_async makes them; images are then written until it is done or destroyed.
 * output_size = sizeof(BhrOutput) as the caller was compiled; no output's struct_size may be larger. Errors: those
 * of bhr_render_image, or of bhr_render_image_async; INVALID_ARGUMENT for a count, a size, a kind or an index
 * outside its range, images of several sizes, a format that does not go with its kind, or a target; UNSUPPORTED for
 * outputs other than LIGHT where BhrCamera.eye has effect. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_render_outputs(BhrContext *context,
                                           const BhrOutput *outputs,
                                           size_t output_size,
                                           uint32_t count,
                                           BhrJob **out_job);

/**
 * Writes outputs that bhr_render_outputs has made to an .exr file: one part of scan lines, 32-bit floats (16-bit
 * ones of LIGHT in RGBA16F), ZIP, with the channels R, G, B, A (LIGHT), depth.Z, sky.x, .y, .z, .g,
 * transmission.Y, position.x, .y, .z, .order, disk.radius, .azimuth, .g, .delay, and .Y of redshift, order,
 * deflection, steps, metric, optical_depth, intensity (VIEW); of crossings beyond the first the layers are
 * position1, disk1 and so on. Alpha is written as it is. Its attributes name the library's version, the backend,
 * the adapter, and every parameter of the scene as it is now: bhr.version, bhr.hole.spin ... by the names of the
 * structs' fields here (bits of flags that are set by themselves, as bhr.disk.plunges; numbers are doubles; the first
 * volume is bhr.volume0). A file is replaced as bhr_image_save does it. Errors: INVALID_ARGUMENT as
 * bhr_render_outputs, for two outputs of the same channels, or LIGHT in R32F; UNSUPPORTED for another extension,
 * LIGHT in an 8-bit format, or a library that was built without EXR; IO; OUT_OF_MEMORY. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_save_outputs(const BhrContext *context,
                                         const BhrOutput *outputs,
                                         size_t output_size,
                                         uint32_t count,
                                         const char *path);

/* ---- the host's things before the camera ---- */

/**
 * Sets the host's things before the camera, for images of LIGHT that they are seen in: an image of R32F, as large as
 * those images, that holds for each pixel the distance to the host's thing along its line of sight, in scene lengths
 * (not along the forward axis, as depth buffers have it), and infinity where there is nothing. It is copied before
 * return. NULL (default): none.
 *
 * Crossings of the disk of order 0 that lie beyond the distance, as straight as BHR_OUTPUT_DEPTH measures it, are
 * left out. Where it is shorter than the way to the point of the line of sight that is nearest to the hole, the
 * ray ends there: higher orders, the hole and the sky are left out as well, and BHR_IMAGE_TRANSPARENT's alpha is
 * that of what lies before. So the picture goes over the host's, premultiplied. A thing behind the hole is hidden
 * by what bends its light; it belongs into the sky (BHR_OUTPUT_SKY). Lines of sight are straight here, and light
 * is not: things are where light shows them to about M / r of their angle from the hole.
 *
 * With BHR_IMAGE_LENSED the host has drawn its things at their lensed places, by bhr_project_points at order 0, and
 * each distance is BhrProjectedPoint.distance, from the camera straight to the thing itself. Then the ray ends at the
 * thing wherever it is, behind the hole as well: beyond it nothing is left, of orders above 0 nothing at all, because
 * their crossings lie beyond the direct images of all things. A distance of 1e15 M or more is nothing, as infinity is.
 *
 * Matter with depth, volumes and hot spots, counts up to where the ray's straight distance from the camera is that of
 * the thing, and where the ray does not end there also where it has come nearer again; each ray is summed by itself
 * then, whatever BhrQuality.volume_resolution says.
 *
 * Glare (BhrFilm.bloom) goes over things, too. Images of a region take distances for that region. Frames in windows,
 * views and the other outputs do not regard it. While it is set, images of another size are INVALID_ARGUMENT when
 * they are rendered; UNSUPPORTED are, on GPUs, sides of more than a texture may have: 16384, or less if the adapter
 * has less. Errors: INVALID_ARGUMENT for a bad image, another format, NaN, or a distance below 0; OUT_OF_MEMORY; the
 * occluder then stays as it was. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_set_occluder(BhrContext *context, const BhrImage *distances);

/* ---- rendering into windows ---- */

/**
 * A window that a context renders into. It belongs to that context; end it with bhr_surface_destroy, before or
 * after the context, before the window.
 */
typedef struct BhrSurface BhrSurface;

/** How frames reach the screen. */
typedef int32_t BhrPresentMode;

#define BHR_PRESENT_VSYNC 0     /**< Never torn: a frame waits for the display. Every window has this mode. */
#define BHR_PRESENT_IMMEDIATE 1 /**< Frames are shown at once, and may tear. */
#define BHR_PRESENT_MAILBOX 2   /**< Never torn: the newest frame at the display's rate; older ones are dropped. */

/**
 * Makes a surface of a window, width x height pixels (0 x 0: minimised; X11: else the window's own size counts), for
 * this context to render into. Call it on the thread that uses the display. A window takes one surface at a time.
 * The window and its display must outlive the surface. (Only on X11, where bhr presents through a connection of its
 * own, may they end first. On Wayland the driver crashes when a surface is destroyed after its display was closed.)
 * Where the context's adapter cannot present to the window, or traces on the CPU, another adapter presents the
 * frames, or they are put into the window as memory; the log (info) says which. macOS: on the main thread only. End
 * *out_surface with bhr_surface_destroy. Errors: INVALID_ARGUMENT for NULL, a bad window, one that does not exist
 * (X11), a side beyond 2^20 or an unknown mode; INVALID_STATE for a window that has a surface; UNSUPPORTED, with
 * every reason, for a kind of window that this platform does not have, for every window in a library that was built
 * without the cargo feature window, where nothing can present to the window, and for a side that the device's images
 * cannot have (mostly beyond 16384); DEVICE_LOST (also for images that do not fit into the device's memory),
 * OUT_OF_MEMORY. A host that holds XGrabServer must not call on surfaces: it would wait for itself.
 */
BHR_NODISCARD BhrStatus bhr_surface_create(BhrContext *context,
                                           const BhrWindow *window,
                                           uint32_t width,
                                           uint32_t height,
                                           BhrPresentMode mode,
                                           BhrSurface **out_surface);

/**
 * Tells a surface its window's new size in pixels; 0 x 0: minimised, frames are skipped. Cheap: images of the new
 * size are made by the next frame. (X11: frames have the size that the window really has; this call says that it
 * has changed. Wayland: call it also when a window that the host has hidden is shown again; VSYNC frames are skipped
 * until then.) Errors: INVALID_ARGUMENT for NULL or a side beyond 2^20; UNSUPPORTED for a side that the device's
 * images cannot have; SURFACE_LOST.
 */
BHR_NODISCARD BhrStatus bhr_surface_resize(BhrSurface *surface, uint32_t width, uint32_t height);

/**
 * Changes how frames reach the screen, from the next one on. A mode that the window does not have becomes VSYNC.
 * Errors: INVALID_ARGUMENT for NULL or an unknown mode; SURFACE_LOST.
 */
BHR_NODISCARD BhrStatus bhr_surface_set_present_mode(BhrSurface *surface, BhrPresentMode mode);

/**
 * Renders the scene into the surface's window and presents it, with the film, in sRGB; the region does not count.
 * The frame is traced at BhrQuality.render_scale times the window's size and stretched to it; a CUBE's faces too, if
 * the window is not 6 times as wide as high. Returns when the frame is on its way to the screen; bhr_frame_stats
 * tells of the last frame that is finished, which may be an earlier one. (Frames that go through the host's memory
 * are finished.) With VSYNC it first waits until the window takes another frame, at most a second, and so do calls
 * on the context and the surface from other threads. FRAME_SKIPPED: the window is 0 x 0, hidden as far as the
 * platform tells, or is being resized; nothing was presented: wait for the window's next event, or try again a
 * little later. Any thread (macOS: the main thread); two threads on one surface take turns. Errors: INVALID_ARGUMENT
 * for NULL or a surface of another context; INVALID_STATE and UNSUPPORTED as bhr_render_image; SURFACE_LOST, from
 * then on, when the window is gone or the context was recovered: destroy the surface, and make it again if there is
 * a window; DEVICE_LOST: see bhr_context_recover; OUT_OF_MEMORY.
 */
BHR_NODISCARD BhrStatus bhr_render_surface(BhrContext *context, BhrSurface *surface);

/**
 * Ends a surface; the window is free for another one. NULL is a no-op; its context may be gone. No other thread
 * may use the surface any more. From inside a callback it does nothing: bhr_error_message then says so.
 */
void bhr_surface_destroy(BhrSurface *surface);

/* ---- rays: the same tracer, asked directly ---- */

/**
 * A ray, followed backward in time from an observer. It does not grow within one BHR_ABI_VERSION, because some calls
 * that fill it in are not told its size.
 */
typedef struct BhrRay {
    double position[3]; /**< Scene axes and lengths. */
    /**
     * The direction in which the observer looks, opposite to the photon's momentum; any non-zero length. Components
     * are along the frame that the conventions above give: the local static observer's (ZAMO), inside a spin-0 horizon
     * the frame of the observer falling from rest at infinity.
     */
    double direction[3];
    /**
     * nu(camera) / nu(observer of the local frame), > 0; 1 for an observer at rest in it. Multiplies every
     * redshift of the hit.
     */
    double frequency_ratio;
} BhrRay;

#define BHR_MAX_CROSSINGS 4 /**< Crossings that a BhrHit lists. */

/** A crossing of the equatorial plane outside the horizon. Within one BHR_ABI_VERSION it does not grow. */
typedef struct BhrCrossing {
    double radius;  /**< Boyer-Lindquist r, scene lengths. */
    double azimuth; /**< Boyer-Lindquist ph in the chart, (-pi, pi]. */
    /**
     * g = nu(camera) / nu(emitter on the disk's circular orbit); inside the ISCO that of falling matter with
     * BHR_DISK_PLUNGES, else NaN.
     */
    double redshift;
    double delay; /**< Coordinate time since the photon left, scene lengths; NaN from inside the horizon. */
} BhrCrossing;

/** How a ray ends. */
typedef int32_t BhrFate;

#define BHR_FATE_CAPTURED 0   /**< The ray ends at the horizon. */
#define BHR_FATE_ESCAPED 1    /**< The ray reaches the sky. */
#define BHR_FATE_UNRESOLVED 2 /**< BhrQuality.max_steps ran out. */
#define BHR_FATE_INVALID 3    /**< The ray is not valid: not finite, direction zero, or no frame at its place. */

/**
 * The end of a ray, and its crossings of the equatorial plane. It may grow at its end: bhr_trace_rays is told
 * hit_size.
 */
typedef struct BhrHit {
    BhrFate fate; /**< BHR_FATE_*. */
    uint32_t crossing_count; /**< 0 .. BHR_MAX_CROSSINGS. */
    double sky_direction[3]; /**< Asymptotic, unit, scene axes; 0 unless escaped. */
    double sky_redshift; /**< nu(camera) / nu(at infinity); NaN unless escaped. */
    double swept_angle; /**< Spin 0: orbit angle to infinity, or to the horizon, radians; with spin NaN. */
    uint32_t steps; /**< Integration steps. */
    uint32_t reserved; /**< Reserved: 0. */
    BhrCrossing crossings[BHR_MAX_CROSSINGS]; /**< In order along the ray; 0 beyond crossing_count. */
} BhrHit;

/**
 * The rays of a width x height frame (with a region: of the image that is this part of it), row by row, through the
 * pixel centres; out_rays has room for width * height. Where a projection shows nothing (outside a FISHEYE's
 * circle): direction 0, frequency_ratio 1, which is traced to BHR_FATE_INVALID. Errors: INVALID_ARGUMENT for NULL, a
 * side of 0 or above 2^20, an image that reaches out of the region's frame; INVALID_STATE where the camera's motion
 * cannot be, or for a CUBE whose frame is not 6 times as wide as high; UNSUPPORTED inside a spinning hole's horizon.
 * out_rays is left alone by INVALID_ARGUMENT and cleared by other errors.
 */
BHR_NODISCARD BhrStatus bhr_camera_rays(const BhrContext *context, uint32_t width, uint32_t height, BhrRay *out_rays);

/**
 * One of those rays, at pixel position x, y: (0, 0) is the top-left corner of the frame (with a region: of the
 * image). Outside the frame the image plane, the angles (EQUIRECT) or the nearest face (CUBE) continue. Errors: as
 * bhr_camera_rays, and INVALID_ARGUMENT for x or y not finite.
 */
BHR_NODISCARD BhrStatus bhr_camera_ray(const BhrContext *context,
                                       uint32_t width,
                                       uint32_t height,
                                       double x,
                                       double y,
                                       BhrRay *out_ray);

/**
 * Traces count rays on the context's backend. The scene's disk does not matter: crossings are those of the bare
 * equatorial plane, down to r+ (1 + 1e-5), and the first BHR_MAX_CROSSINGS are listed. Their emitter moves as the
 * disk's flags say, prograde without a disk; a start in the plane is no crossing. One bad ray is BHR_FATE_INVALID, not
 * an error of the batch. ray_size = sizeof(BhrRay) and hit_size = sizeof(BhrHit) as the caller was compiled, at least
 * 56 and 184, the sizes of the first version; both arrays are packed. A ray that is longer than this library's must be
 * 0 beyond it; a longer hit is cleared there. With count 0 the call does nothing. Errors: INVALID_ARGUMENT for NULL or
 * a size below the first version's; UNSUPPORTED; DEVICE_LOST, OUT_OF_MEMORY. An error while tracing clears out_hits.
 */
BHR_NODISCARD BhrStatus bhr_trace_rays(BhrContext *context,
                                       const BhrRay *rays,
                                       size_t ray_size,
                                       size_t count,
                                       BhrHit *out_hits,
                                       size_t hit_size);

/**
 * Fills in the curve that a ray follows: x, y, z (scene axes) and t (scene lengths, t <= 0: backward) for each point.
 * out_points has room for 4 capacity doubles. *out_count becomes the number of points: 2 or more, at most capacity,
 * never more than 65536. The last point is the curve's end: just outside the horizon, or, for a ray that escapes, at
 * ten times the observer's radius, but at least 1000 M; a ray that needs more than max_steps ends where they ran out.
 * The curve is traced in double precision on the CPU, whatever the backend. Errors: INVALID_ARGUMENT for NULL,
 * capacity < 2, or a ray that is not valid; UNSUPPORTED inside a spinning hole's horizon.
 */
BHR_NODISCARD BhrStatus bhr_trace_path(BhrContext *context,
                                       const BhrRay *ray,
                                       uint32_t capacity,
                                       double *out_points,
                                       uint32_t *out_count);

/* ---- points on the screen ---- */

#define BHR_MAX_IMAGE_ORDER 3u /**< The highest order that bhr_project_point looks for. Since 0.2.0. */

/** An image of a point: where on the screen it appears, and how. Since 0.2.0. */
typedef struct BhrProjectedPoint {
    uint32_t struct_size; /**< sizeof(BhrProjectedPoint), set by the caller. */
    /**
     * 1: a ray to the point was found. 0: there is none (the point is in the hole, or where the camera is), or it is
     * lost; the numbers are then NaN, the ray's 0.
     */
    uint32_t found;
    /** 1: it is seen within the image, whatever matter or sky may be before it. 0: beside it, or not found. */
    uint32_t on_screen;
    uint32_t lost; /**< 1: none was found, though there may be one. */
    /**
     * Pixel position to the right, as of bhr_camera_ray; beyond the image where it is not on the screen. NaN where the
     * projection has no place for the direction: behind a PERSPECTIVE or FRUSTUM.
     */
    double x;
    double y;   /**< The same downwards. */
    BhrRay ray; /**< The ray from the camera to the point, on the screen or not: bhr_camera_ray at x, y. */
    /**
     * How much larger, in solid angle, something small at the point looks to the camera than it would without the
     * hole, the camera's motion included; negative where the image is mirrored, as those of odd orders are. It grows
     * without limit near a caustic, which without spin is the line straight behind the hole.
     */
    double magnification;
    double delay;    /**< Coordinate time since the light left the point, scene lengths; NaN from inside the horizon. */
    double redshift; /**< g = nu(camera) / nu(observer at rest at the point, with spin the ZAMO). */
    /**
     * The straight distance from the camera to the point, scene lengths: the depth of the image, as
     * BHR_OUTPUT_DEPTH and bhr_set_occluder measure it.
     */
    double distance;
    /**
     * Where the point seems to be, scene axes: as far from the camera as it is, in the direction in which the camera
     * sees its image. A rasteriser that draws a vertex here, with the camera's own matrices, draws it at x, y and
     * with the depth that belongs to it; so do cameras that move.
     */
    double apparent[3];
} BhrProjectedPoint;

/**
 * Clears struct_size bytes and fills in struct_size, which calls that fill the struct read, and what stands for no
 * image. Any thread, inside callbacks too. Since 0.2.0. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_projected_point_init(BhrProjectedPoint *point, size_t struct_size);

/**
 * Where in a width x height image (with a region: that is this part of a frame) a point of the scene appears: the
 * inverse of bhr_camera_ray. point: scene axes and lengths. order: how often the light went half round the hole; 0
 * is the direct image, 1 that on the hole's other side, to BHR_MAX_IMAGE_ORDER. With spin the image of an order is
 * the one that the image of this order without spin becomes as the spin grows from 0.
 *
 * Every point outside the horizon has an image of each order, also behind the hole. With spin some have more, by the
 * caustics that a spinning hole has; where the image has ended in another as the spin grew, it is the one of the same
 * orientation that took its place. Of 24,000 random points outside r+ + 1 M, seen from outside r+ + 2 M at spins up
 * to 0.999, all were found. The ray of an image that is found passes the point within 1e-6 of its distance, and as
 * bhr_trace_rays of a context on a GPU follows it, within 1e-4. Whether matter is before the point is for the host to
 * ask (bhr_trace_rays).
 *
 * It is computed in double precision on the CPU, on this thread, whatever the backend: in about 40 microseconds, at
 * order 1 with spin 0.2 ms, at orders 2 and 3 with spin in about 5 ms. Errors: INVALID_ARGUMENT for
 * NULL, a wrong struct_size, numbers not finite, an order above the highest; INVALID_STATE for a point farther
 * than 1e15 M; else as bhr_camera_ray. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_project_point(const BhrContext *context,
                                          uint32_t width,
                                          uint32_t height,
                                          const double point[3],
                                          uint32_t order,
                                          BhrProjectedPoint *out_image);

/**
 * bhr_project_point for many points, on as many threads as the machine has cores: the vertices of a mesh, say, so
 * that a host's things are where light shows them (docs/compositing.md). points: 3 count doubles, x, y, z of each.
 * image_size: sizeof(BhrProjectedPoint) as the caller was compiled; out_images has room for count, packed, and each
 * gets that size as its struct_size, which need not be set before. A point that is not finite, or farther than 1e15
 * M, has no image and is no error of the others. With count 0 the call does nothing. A point takes 20 to 40
 * microseconds of one core at order 0, 0.2 ms at order 1 with spin, 5 ms above. Other calls of the context wait until
 * it returns: a host with a thread that must not wait gives large meshes in parts. Errors: INVALID_ARGUMENT for NULL
 * or a size below the first version's; else as bhr_project_point. An error leaves out_images alone. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_project_points(const BhrContext *context,
                                           uint32_t width,
                                           uint32_t height,
                                           const double *points,
                                           size_t count,
                                           uint32_t order,
                                           BhrProjectedPoint *out_images,
                                           size_t image_size);

/* ---- the matter with depth along rays ---- */

/**
 * How the volumes and hot spots along a ray shine, and how much they absorb. nu_camera is the one frequency at which
 * a picture shows power laws (BhrVolume). It may grow at its end: bhr_transfer_rays is told its size. Since 0.2.0.
 */
typedef struct BhrTransfer {
    BhrFate fate;      /**< BHR_FATE_*. */
    uint32_t reserved; /**< Reserved: 0. */
    /**
     * The specific intensity I_nu of power laws at nu_camera where the ray begins, 0 and up. Its unit is the emission
     * of 1 M of matter at density 1 that is at rest: 2 is as bright as 2 M of such matter which absorbs nothing. A
     * host that knows that emission in W / (m^2 Hz sr) multiplies by it. brightness and tint do not count; thermal
     * matter absorbs this light and adds none. NaN for a ray that is not valid. A ray that is BHR_FATE_UNRESOLVED has
     * the part as far as it was followed, and so has its light.
     */
    double intensity;
    /**
     * At nu_camera, of all volumes and hot spots together, without a unit, 0 and up: of light from behind them the
     * share e^-optical_depth passes. Above 300 the number says only that it is more. NaN unless the ray is
     * BHR_FATE_ESCAPED: towards the horizon an outside observer's rays pass ever more of the matter that falls in.
     */
    double optical_depth;
    /**
     * The light that a picture shows of all volumes and hot spots, linear Rec. 709 before exposure, with brightness,
     * tint and the effects that are set. NaN for a ray that is not valid.
     */
    double light[3];
} BhrTransfer;

/**
 * Sums the matter of volumes and hot spots along count rays, the thin disk and the sky left out: intensities and
 * optical depths in double precision on the CPU, whatever the backend; on BHR_BACKEND_CPU on all of its threads, else
 * on the calling one. The scene's time is that of the rays' observers, at rest where they are; hot spots and the
 * structure of volumes are seen at their retarded time with BHR_EFFECT_LIGHT_DELAY. One bad ray is BHR_FATE_INVALID,
 * not an error of the batch. For even matter numbers agree with two independent codes to 1e-8 of a picture's peak, and
 * with the five fluxes that Gold et al. 2020 published: four to all digits, the first to 2e-4.
 *
 * ray_size = sizeof(BhrRay) and out_size = sizeof(BhrTransfer) as the caller was compiled, at least 56 and 48, the
 * sizes of the first version; both arrays are packed. A ray that is longer than this library's must be 0 beyond it; a
 * longer result is cleared there. With count 0 the call does nothing. Errors: INVALID_ARGUMENT for NULL or a size
 * below the first version's; OUT_OF_MEMORY. An error on the way clears out. Since 0.2.0.
 */
BHR_NODISCARD BhrStatus bhr_transfer_rays(BhrContext *context,
                                          const BhrRay *rays,
                                          size_t ray_size,
                                          size_t count,
                                          BhrTransfer *out,
                                          size_t out_size);

/* ---- numbers about the last finished frame ---- */

/** Numbers about the last finished frame; all 0 before the first. Times in nanoseconds. */
typedef struct BhrFrameStats {
    uint32_t struct_size;  /**< sizeof(BhrFrameStats), set by the caller. */
    uint32_t reserved;     /**< Reserved: 0. */
    uint64_t frame_index;  /**< Counts the finished frames of a context from 1: images, jobs and windows. */
    uint64_t rays;         /**< Pixels times samples. */
    uint64_t steps;        /**< Integration steps of all rays; rays that were looked up take none. */
    uint64_t cpu_ns;       /**< From the call's beginning to its end; for a job, from its request until it was done. */
    uint64_t gpu_ns;       /**< Time on the GPU; 0 where the adapter has no timestamps, or traces on the CPU. */
    uint64_t readback_ns;  /**< Time to copy pixels into the host's memory, without the wait for the GPU. */
    uint64_t device_bytes; /**< Device memory that the context holds. */
    /**
     * Lens tables made for this frame: 0 where those of an earlier frame served, which are kept for up to four
     * places of eyes that are shown by turns, or where none were needed. Since 0.2.0.
     */
    uint64_t lens_tables;
} BhrFrameStats;

/**
 * Clears struct_size bytes and sets struct_size, which calls that fill the struct read. Any thread, inside callbacks
 * too. Since 0.2.0. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size.
 */
BHR_NODISCARD BhrStatus bhr_frame_stats_init(BhrFrameStats *stats, size_t struct_size);

/** Numbers about the context's last finished frame. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size. */
BHR_NODISCARD BhrStatus bhr_frame_stats(const BhrContext *context, BhrFrameStats *stats);

/**
 * Numbers about the frame of a job that is done. Errors: INVALID_ARGUMENT for NULL or a wrong struct_size;
 * INVALID_STATE for a job that is not done, or that failed.
 */
BHR_NODISCARD BhrStatus bhr_job_stats(const BhrJob *job, BhrFrameStats *stats);

#ifdef __cplusplus
}
#endif

/**
 * BHR_INIT(camera); is bhr_camera_init(&camera, sizeof camera); and likewise for a variable of every other struct that
 * begins with struct_size: the variable's type says which. It takes no pointer: write BHR_INIT(*camera). It gives no
 * status, as nothing is wrong with a variable; a program that may meet a library older than the function calls that
 * itself. For C++, C from C11 on, and GCC's and Clang's C99; elsewhere it is not defined. Since 0.2.0.
 */
#if defined(__cplusplus)
#define BHR_INIT(variable) BhrInit(variable)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define BHR_INIT(variable) ((void)(BHR_INIT_BY_TYPE(variable) == BHR_OK))
#elif defined(__GNUC__)
#define BHR_INIT(variable) ((void)(__extension__ BHR_INIT_BY_TYPE(variable) == BHR_OK))
#endif

/** The structs that BHR_INIT knows, and their functions. */
#define BHR_INIT_STRUCTS(EACH) \
    EACH(BhrAdapterInfo, bhr_adapter_info_init) \
    EACH(BhrWindow, bhr_window_init) \
    EACH(BhrContextOptions, bhr_context_options_init) \
    EACH(BhrHoleInfo, bhr_hole_info_init) \
    EACH(BhrCamera, bhr_camera_init) \
    EACH(BhrDisk, bhr_disk_init) \
    EACH(BhrVolume, bhr_volume_init) \
    EACH(BhrHotSpot, bhr_hot_spot_init) \
    EACH(BhrImage, bhr_image_init) \
    EACH(BhrSky, bhr_sky_init) \
    EACH(BhrFilm, bhr_film_init) \
    EACH(BhrPresetOptions, bhr_preset_options_init) \
    EACH(BhrQuality, bhr_quality_init) \
    EACH(BhrRegion, bhr_region_init) \
    EACH(BhrOutput, bhr_output_init) \
    EACH(BhrProjectedPoint, bhr_projected_point_init) \
    EACH(BhrFrameStats, bhr_frame_stats_init)
/** The structs of bhr_interop.h, where that is included. */
#define BHR_INIT_MORE
/** The struct's case in BHR_INIT. */
#define BHR_INIT_CASE(Struct, init) , Struct : init
/** The function that the variable's type asks for, called. */
#define BHR_INIT_BY_TYPE(variable) \
    _Generic((variable)BHR_INIT_STRUCTS(BHR_INIT_CASE) BHR_INIT_MORE)(&(variable), sizeof(variable))
/** The struct's function in C++. */
#define BHR_INIT_FUNCTION(Struct, init) \
    inline void BhrInit(Struct &variable) { static_cast<void>(init(&variable, sizeof variable) == BHR_OK); }

#ifdef __cplusplus
BHR_INIT_STRUCTS(BHR_INIT_FUNCTION)
#endif

#endif
