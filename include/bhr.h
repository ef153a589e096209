/* bhr.h -- the C API of bhr, the embeddable black-hole renderer.
 * SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Made by cbindgen from the Rust sources in src/capi; do not edit. A host developer needs to read nothing else: make a
 * context, set the hole and the camera, and render into memory of your own.
 *
 * Sections, in this order, each after a line "---- title ----"
 *   version; status, messages; log; adapters; windows of the host; context; the black hole; charts;
 *   the camera: an observer with a lens; cameras as matrices; accretion disk; matter with depth: volumes and hot spots;
 *   images in the host's memory; sky; film; relativistic effects, time; presets: named looks; quality;
 *   what a pixel shows; parts of a larger frame; scenes as text; rendering into memory; the mean of several frames;
 *   rendering in the background; outputs beside the picture; the host's things before the camera;
 *   rendering into windows; rays: the same tracer, asked directly; points on the screen;
 *   the matter with depth along rays; bodies in free fall; numbers about the last finished frame.
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
 *   normal, and is +z unless bhr_set_axis changes it. Then the chart is the scene's axes under the shortest rotation
 *   that takes +z to it (about +x for -z): r, th, ph, the frames below and BhrCrossing.azimuth refer to the turned
 *   chart; positions and directions stay in scene axes. Prograde always means +ph about the axis, retrograde -ph; with
 *   spin < 0 the hole turns towards -ph.
 *
 * Directions
 *   A direction (or velocity) at a place is n = n_r e_r + n_th e_th + n_ph e_ph with the Euclidean unit vectors of
 *   spherical coordinates there (on the axis e_th = x, e_ph = y). Its components are those along the orthonormal frame
 *   of the local static observer (the ZAMO when the hole spins). A direction may have any non-zero length, and is
 *   normalised; a velocity is taken as it is. A moving camera's axes are that frame boosted without rotation. Inside a
 *   spin-0 horizon, and everywhere in BHR_CHART_RAIN, the frame is that of the observer falling from rest at infinity.
 *   In BHR_CHART_STATIC there is none inside a spinning hole's horizon: a camera there is BHR_ERROR_UNSUPPORTED, a ray
 *   from there BHR_FATE_INVALID.
 *
 * Errors
 *   Every call that can fail returns a BhrStatus; bhr_error_message tells the thread that called what was wrong, with
 *   the value and the limit. bhr_context_error_message and bhr_job_error_message have the last one of a context or a
 *   job. A failed setter leaves the context as it was; a bhr_camera_* function that fails leaves the camera as it was.
 *   Whatever else a call fills in is NULL or 0 after a failure. Setters check their own argument only; impossible
 *   combinations (such as a static camera inside the horizon) are BHR_ERROR_INVALID_STATE when a frame or rays are
 *   asked for.
 *
 *   Below, errors are named without BHR_ERROR_. Not named each time are INVALID_ARGUMENT for NULL, a wrong struct_size
 *   or size of an array's elements, a number that is not finite or outside its range, and an unknown constant or flag;
 *   INVALID_STATE inside callbacks; OUT_OF_MEMORY and DEVICE_LOST, where something is made, rendered or traced;
 *   INTERNAL, a bug in bhr, after which only destroy calls are valid on that context, its jobs and its surfaces.
 *
 * Versions
 *   Until BHR_ABI_VERSION rises, a later library runs every program that was compiled against this header. Versions add
 *   functions, constants, and fields at the end of structs that begin with struct_size; they remove and rename nothing,
 *   and what is there keeps its value and its meaning. "@since X.Y.Z" marks additions, a type's with all its constants
 *   and fields: a program that must run with an older library, too, compares bhr_version, and looks up by name (dlsym)
 *   what may not be there. "@deprecated" marks functions that are better not used any more, and that work on.
 *   docs/abi.md has the rules at length.
 *
 * Structs
 *   Structs that may grow begin with struct_size: sizeof the struct that the program was compiled with. The caller sets
 *   it before every call that reads or fills the struct, getters too; less than in the library's first version is
 *   INVALID_ARGUMENT. A field that a program's struct does not reach is not written as output, and as input means what
 *   the library did without it. A struct larger than this library's is accepted as input when the rest of it is zero,
 *   and as output the rest is zeroed. Fields named reserved are 0. The *_init functions clear struct_size bytes, set
 *   struct_size, and fill in the defaults: of BhrDisk and BhrFilm those of the release whose struct has that size.
 *   BHR_INIT(camera), at this header's end, does so in one line. Structs and arrays need no alignment; pixels do
 *   (BhrImage).
 *
 * Pointers
 *   A pointer is NULL only where this header says that it may be. Everything that is passed in is copied before the
 *   call returns; windows and pixels stay the host's own. Strings are UTF-8 and end with a NUL; a path may hold any
 *   other bytes on Unix.
 *
 * Threads and callbacks
 *   Any thread may call. Contexts are independent of each other; calls on one context wait for each other. (macOS:
 *   surfaces on the main thread only.) Log callbacks may run on any thread, progress callbacks run on the calling
 *   thread.
 *
 *   From inside a callback, a call on a context, job or surface returns INVALID_STATE, and so do bhr_adapter_count and
 *   bhr_adapter_info; calls on plain structs and images, versions and messages are allowed. A callback must not throw,
 *   unwind or longjmp, nor wait for another thread's call on the same context. None runs after the destroy call of its
 *   context has returned.
 *
 * The calling thread
 *   During a call, floating point on its thread has the default rounding, traps and treatment of subnormal numbers,
 *   whatever the host has set; after it, and in callbacks, the host's settings and flags are as they were. A thread is
 *   not cancelled (pthread_cancel, of deferred type) inside a call, nor in a callback from one: the request waits.
 *
 *   A call needs 64 KiB of stack on Linux (x86, x86-64, AArch64), also on fibers: where less than 512 KiB are known to
 *   be left, it continues on a stack of bhr's, and its callbacks run on the host's. A callback must not switch to
 *   another fiber. Elsewhere a call needs 512 KiB, because of drivers.
 *
 * Memory
 *   Where memory is refused a call returns OUT_OF_MEMORY, with the size, and the context stays usable. The same error
 *   comes when less than a megabyte would be left, and when a thread cannot be started. Small allocations of drivers,
 *   of wgpu and of the Rust runtime cannot be caught, and end the process: docs/process.md says what a host can do.
 *
 * The process
 *   The library never writes to stdout or stderr, never calls exit or abort (but see Memory), installs no signal
 *   handler, and lets no Rust panic out. It stays mapped after dlclose, and after FreeLibrary once it was called.
 *   After fork() the child may only exec. docs/process.md says more, and what happens when a process ends while frames
 *   are rendered.
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

/** The loaded library's version: major << 16 | minor << 8 | patch. */
uint32_t bhr_version(void);

/** BHR_ABI_VERSION of the loaded library. */
uint32_t bhr_abi_version(void);

/** The loaded library's version, such as "0.2.0"; static. */
const char *bhr_version_string(void);

/* ---- status, messages ---- */

/** The result of a call: 0 is success, above 0 success with news, below 0 an error. bhr_error_message says more. */
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

/** The message of the last call that failed on this thread: the function, the argument, its value and the limit.
 * Never NULL; "" when no call has failed. Valid until this thread's next failing call, or its end. */
const char *bhr_error_message(void);

/** The constant's name, such as "BHR_ERROR_DEVICE_LOST"; static, never NULL. */
const char *bhr_status_name(BhrStatus status);

/* ---- log ---- */

/** How much a log callback is told: messages of this level and of the more severe ones. */
typedef int32_t BhrLogLevel;

#define BHR_LOG_OFF 0   /**< No messages. */
#define BHR_LOG_ERROR 1 /**< Every failed call, but for cancels, and errors of the graphics stack. */
#define BHR_LOG_WARN 2  /**< Also trouble that failed no call, such as an adapter passed over. The default. */
#define BHR_LOG_INFO 3  /**< Also cancels, why an adapter was chosen, and errors of the graphics stack about others. */
#define BHR_LOG_DEBUG 4 /**< Also what the graphics stack (wgpu) reports about itself. */
#define BHR_LOG_TRACE 5 /**< Everything: slow. */

/** Gets bhr's messages and those of the graphics stack under it, one per call, without a line end. message lives for
 * the call only. A message that arises inside a bhr_ call on a context goes to that context's callback, on
 * whichever thread the call runs, or on a thread of the library that works for that context; one from another
 * thread goes to every context's callback: it may therefore run on several threads at once. It may wait for other
 * threads' calls on other contexts, not for calls on its own. */
typedef void (*BhrLogFn)(void *user, BhrLogLevel level, const char *message);

/* ---- adapters ---- */

#define BHR_ADAPTER_DISCRETE 1u /**< BhrAdapterInfo.flags: a GPU with memory of its own. */
#define BHR_ADAPTER_SOFTWARE 2u /**< BhrAdapterInfo.flags: a software driver, or the CPU tracer. */

/** The interface to an adapter. AUTO takes the best GPU that Vulkan, Metal or, with DXC, Direct3D 12 reaches; else one
 * that only OpenGL reaches, or Direct3D 12 with FXC; else a software driver for Vulkan (Mesa's lavapipe) or Direct3D
 * 12; else the CPU tracer. It never takes software OpenGL. */
typedef int32_t BhrBackend;

#define BHR_BACKEND_AUTO 0   /**< The best one there is, in the order above. */
#define BHR_BACKEND_CPU 1    /**< The built-in double-precision CPU tracer: needs no driver. */
#define BHR_BACKEND_VULKAN 2 /**< Vulkan. */
#define BHR_BACKEND_METAL 3  /**< Metal. */
#define BHR_BACKEND_D3D12 4  /**< Direct3D 12, never tried on Windows itself; its compiler: docs/platforms.md. */

#define BHR_BACKEND_GL 5 /**< OpenGL or OpenGL ES, by EGL or WGL. A host that ends EGL's display: docs/adapters.md. */

/** One adapter. */
typedef struct BhrAdapterInfo {
    uint32_t struct_size; /**< sizeof(BhrAdapterInfo), set by the caller. */
    BhrBackend backend;   /**< BHR_BACKEND_*, never AUTO. */
    uint32_t flags;       /**< BHR_ADAPTER_* bits. */
    uint32_t vendor_id;   /**< PCI id of the vendor; 0 for the CPU tracer. */
    uint32_t device_id;   /**< PCI id of the device; 0 for the CPU tracer. */
    uint32_t reserved;    /**< Reserved: 0. */
    char name[256];       /**< UTF-8, cut where it is longer. */
    /** Name and version of the driver, UTF-8; "" where it is not known. D3D12: and who compiles kernels, DXC or FXC. */
    char driver[256];
} BhrAdapterInfo;

/** Sets struct_size, which calls that fill the struct read, and clears the rest. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_adapter_info_init(BhrAdapterInfo *info, size_t struct_size);

/** Counts the adapters of this machine: at least 1, because the CPU tracer is always there, and always last.
 * Adapters other than GL are looked for once in a process; bhr_context_recover looks again. */
BHR_NODISCARD BhrStatus bhr_adapter_count(uint32_t *out_count);

/** Fills in info for the adapter at index, below bhr_adapter_count: GPUs come first, then software drivers, the CPU
 * tracer last. BHR_BACKEND_AUTO need not take the first one. */
BHR_NODISCARD BhrStatus bhr_adapter_info(uint32_t index, BhrAdapterInfo *info);

/* ---- windows of the host ---- */

/** The kind of a BhrWindow. It decides which fields are read; the others are ignored. */
typedef int32_t BhrWindowKind;

#define BHR_WINDOW_XLIB 1        /**< X11 through Xlib: display = Display *, id = Window. */
#define BHR_WINDOW_XCB 2         /**< X11 through XCB: display = xcb_connection_t *, id = xcb_window_t. */
#define BHR_WINDOW_WAYLAND 3     /**< Wayland: display = wl_display *, handle = wl_surface *. */
#define BHR_WINDOW_WIN32 4       /**< Windows: handle = HWND, aux = HINSTANCE; NULL: the window's own. */
#define BHR_WINDOW_APPKIT 5      /**< macOS: handle = NSView *. */
#define BHR_WINDOW_UIKIT 6       /**< iOS: handle = UIView *. */
#define BHR_WINDOW_METAL_LAYER 7 /**< macOS, iOS: handle = CAMetalLayer *. */
#define BHR_WINDOW_ANDROID 8     /**< Android: handle = ANativeWindow *. */

/** A window of the host's. It stays the host's, and it and its display must outlive every surface made from it.
 * Begin with bhr_window_init, or with all bytes 0 and struct_size, then set kind and what the kind names. Handles
 * are those of the raw-window-handle crate. */
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

/** Sets struct_size and clears the rest: kind and handles have no defaults. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_window_init(BhrWindow *window, size_t struct_size);

/* ---- context ---- */

/** A scene and what traces it. */
typedef struct BhrContext BhrContext;

/** BhrContextOptions.flags: the driver's validation layers check bhr and report to the log. Slow. Ignored where they
 * are not installed, and by OpenGL, which has none. */
#define BHR_CONTEXT_VALIDATION 1u

/** How to make a context. Fill in with bhr_context_options_init first. */
typedef struct BhrContextOptions {
    uint32_t struct_size; /**< sizeof(BhrContextOptions). */
    uint32_t flags;       /**< BHR_CONTEXT_* bits. Default 0. */
    BhrBackend backend;   /**< Default BHR_BACKEND_AUTO. */
    /** Index for bhr_adapter_info; its backend must be the one above, unless that is AUTO. -1 (default): the library
     * chooses. A struct that was zeroed instead of initialised asks for adapter 0. */
    int32_t adapter_index;
    /** Threads of the CPU tracer, 0 .. 1024. 0 (default): one per core that this process may use. */
    uint32_t cpu_threads;
    /** The messages that log_fn is told: this level and the more severe ones. Default BHR_LOG_WARN. */
    BhrLogLevel log_level;
    BhrLogFn log_fn; /**< NULL (default): silent. */
    void *log_user;  /**< Handed to log_fn. */
    /** A window that the adapter must be able to present to; it is looked at during the call only. With AUTO,
     * adapters that cannot are passed over; the CPU tracer always qualifies. NULL (default): any adapter; where it
     * cannot present, surfaces work all the same, more slowly. GL adapters never present. docs/window.md. */
    const BhrWindow *compatible_window;
} BhrContextOptions;

/** Fills in the defaults. */
BHR_NODISCARD BhrStatus bhr_context_options_init(BhrContextOptions *options, size_t struct_size);

/** Makes a context with the default scene: BHR_PRESET_CINEMATIC about a hole of mass 1 without spin, with a camera
 * at (0, 26, 2.5) that looks at it. abi_version is BHR_ABI_VERSION; options NULL means all defaults. With
 * BHR_BACKEND_AUTO it succeeds on every machine: an adapter that cannot be opened is passed over, and the log says
 * why. End *out_context with bhr_context_destroy.
 * Errors: INCOMPATIBLE_ABI; INVALID_ARGUMENT for a compatible_window that does not exist (X11, Windows); UNSUPPORTED
 * for a compatible_window of another platform, for any in a library built without the cargo feature window, and for
 * BHR_BACKEND_GL in one built without gl; NO_ADAPTER when the backend or adapter asked for is not there, cannot be
 * opened, or cannot present to compatible_window. */
BHR_NODISCARD BhrStatus bhr_context_create(uint32_t abi_version, const BhrContextOptions *options,
                                           BhrContext **out_context);

/** Fills in info for the adapter that the context runs on. */
BHR_NODISCARD BhrStatus bhr_context_adapter(const BhrContext *context, BhrAdapterInfo *info);

/** Opens the device anew after DEVICE_LOST, on the same adapter if it is still there; until then every call that
 * renders or traces returns DEVICE_LOST, while setters go on working. The scene stays, the sky's map included, but
 * for a sky or an occluder in a target (bhr_interop.h): set those anew. Surfaces made before are lost: destroy them
 * and make them again. Jobs that were unfinished fail with DEVICE_LOST.
 * Errors: those of bhr_context_create, after which the context stays lost, and the call may be tried again;
 * UNSUPPORTED on a device of the host's (bhr_context_create_vulkan). */
BHR_NODISCARD BhrStatus bhr_context_recover(BhrContext *context);

/** Copies the message of the last call that failed on this context or on one of its surfaces, on whichever thread,
 * into buffer: at most size - 1 bytes, cut between characters, and a NUL; nothing when buffer is NULL or size
 * is 0. Returns the length of the whole message in bytes without its NUL, less than 10,000; 0 when no call has
 * failed, and for a NULL context. It waits for no other call. Where other threads make failing calls meanwhile, the
 * message may be one of theirs. For hosts whose calls move between threads: docs/errors.md. @since 0.2.0 */
size_t bhr_context_error_message(const BhrContext *context, char *buffer, size_t size);

/** Ends a context and frees it, when a call that is running on it and its jobs are done (bhr_job_cancel shortens
 * that); pipelines that are being compiled may take up to a second more. Its surfaces end too, but both they and
 * its jobs must still be destroyed, before or after. NULL is a no-op. No callback runs after it has returned, and
 * no other thread may begin a call on it any more. From inside a callback it does nothing, as the context is in
 * use: bhr_error_message then says so. A process may also end without it: docs/process.md. */
void bhr_context_destroy(BhrContext *context);

/* ---- the black hole ---- */

/** Sets the mass M in scene lengths, finite and above 0. Default 1. */
BHR_NODISCARD BhrStatus bhr_set_mass(BhrContext *context, double mass);

/** Sets the spin a / M, -1 .. 1; below 0 the hole turns towards -ph. Default 0. Beyond +-0.9999 frames
 * and bhr_transfer_rays are UNSUPPORTED; single rays, points, world lines and camera moves go on to +-1. */
BHR_NODISCARD BhrStatus bhr_set_spin(BhrContext *context, double spin);

/** Sets the spin axis, which is also the disk's normal: scene axes, any non-zero length. Default +z. */
BHR_NODISCARD BhrStatus bhr_set_axis(BhrContext *context, const double axis[3]);

/** Reads the mass, the spin and the axis (a unit vector) as they are set. */
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
    /** Spin 0: angular radius of the shadow as the camera's observer sees it, radians; NaN with spin. */
    double shadow_angular_radius;
    double camera_radius; /**< Boyer-Lindquist r of the camera. */
    /** d tau / d t, the rate of the clock of the camera's observer; t is the time of BhrCamera.chart. */
    double camera_time_rate;
    /** r- = M - sqrt(M^2 - a^2), down to which the inside of a spinning hole is known; 0 without spin. @since 0.2.0 */
    double inner_horizon_radius;
} BhrHoleInfo;

/** Sets struct_size, which calls that fill the struct read, and clears the rest. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_hole_info_init(BhrHoleInfo *info, size_t struct_size);

/** Fills in info for hole and camera as they are set; where its motion is not possible, the camera's are NaN. */
BHR_NODISCARD BhrStatus bhr_hole_info(const BhrContext *context, BhrHoleInfo *info);

/** Fills in the metric at a place in scene axes: out_metric[4 a + b] = g_ab in Boyer-Lindquist (t, r, th, ph) of
 * signature - + + +, inside horizons too.
 * Errors: INVALID_ARGUMENT at the centre and on a horizon. */
BHR_NODISCARD BhrStatus bhr_metric_at(const BhrContext *context, const double position[3], double out_metric[16]);

/** Fills in the Christoffel symbols at a place in scene axes: out_gamma[16 a + 4 b + c] = Gamma^a_bc in
 * Boyer-Lindquist (t, r, th, ph), inside horizons too.
 * Errors: INVALID_ARGUMENT at the centre, on a horizon and on the axis. */
BHR_NODISCARD BhrStatus bhr_christoffel_at(const BhrContext *context, const double position[3], double out_gamma[64]);

/* ---- charts ---- */

/** How azimuths and times are told, and the triad that directions and velocities are told along. Radii and polar
 * angles are Boyer and Lindquist's in both. RAIN is regular at both horizons for all that falls in, and needed at and
 * inside a spinning hole's. Without spin azimuths do not differ, and the triad at and inside the horizon is that of
 * RAIN. docs/cameras.md. @since 0.2.0 */
typedef int32_t BhrChart;

#define BHR_CHART_STATIC 0 /**< Boyer and Lindquist's ph and t, and the triad of the static observer (ZAMO). */
#define BHR_CHART_RAIN 1   /**< Doran's, and the triad of the rain observer, who falls from rest at infinity. */

/* ---- the camera: an observer with a lens ---- */

/** The lens. Camera axes: right = forward x up, then up = right x forward. */
typedef int32_t BhrProjection;

#define BHR_PROJECTION_PERSPECTIVE 0 /**< A flat picture; fov_y in (0, pi). */

/** Dome master, equidistant: the angle from forward grows evenly with the distance from the frame's centre, to fov_y
 * / 2 (fov_y to 2 pi) at the circle inscribed in the frame. Outside the circle there is nothing: black, alpha 0 in
 * a TRANSPARENT image, NaN in views, rays without direction. */
#define BHR_PROJECTION_FISHEYE 1

/** All-round picture, 360 x 180 degrees in even steps: longitude from forward (middle) to the right, latitude
 * towards up (top); fov_y is ignored. A frame that is not twice as wide as high is stretched. */
#define BHR_PROJECTION_EQUIRECT 2

/** Six faces of a cube side by side: right, left, up, down, front, back. The top of each face is up; of the up face
 * it is backward, of the down face forward. Each is what a 90 degree PERSPECTIVE camera sees, not its mirror image;
 * fov_y is ignored. The full frame's width must be 6 times its height, else rendering is INVALID_STATE. */
#define BHR_PROJECTION_CUBE 3

/** A flat picture between four tangents, as the frustum of a projection matrix: tan_left, tan_right, tan_down,
 * tan_up. fov_y is ignored, and the frame's shape may be any: it is stretched to the tangents. @since 0.2.0 */
#define BHR_PROJECTION_FRUSTUM 4

/** How the camera's observer moves. A motion that is not possible at the camera's place is INVALID_STATE when a
 * frame or rays are asked for. */
typedef int32_t BhrMotion;

#define BHR_MOTION_STATIC 0 /**< At rest, outside the horizon; with spin, the zero angular momentum observer (ZAMO). */

/** Falls from rest at infinity with E = 1 and L = Q = 0, inside the horizon too (with spin in chart RAIN). */
#define BHR_MOTION_FREE_FALL 1

/** On a circle towards +ph: without spin at any latitude, with r > 3 M and beta = 1 / sqrt(r / M - 2); with spin on
 * the circular geodesic, in the equatorial plane only (to within 1e-12 of the radius). */
#define BHR_MOTION_ORBIT 2

#define BHR_MOTION_VELOCITY 3 /**< Moves with BhrCamera.velocity. */

/** The eye for which an EQUIRECT picture is made. @since 0.2.0 */
typedef int32_t BhrEye;

#define BHR_EYE_MIDDLE 0 /**< The camera's own place: no stereo picture. */
#define BHR_EYE_LEFT 1   /**< The left eye. */
#define BHR_EYE_RIGHT 2  /**< The right eye. */

/** How bhr_camera_advance carries a camera's axes along. @since 0.2.0 */
typedef int32_t BhrTransport;

#define BHR_TRANSPORT_TRIAD 0 /**< Forward and up keep their angles to e_r, e_th and e_ph. */

/** Forward and up stay parallel to themselves along the world line, as the axes of gyroscopes do. For cameras in free
 * fall: FREE_FALL, ORBIT and VELOCITY. */
#define BHR_TRANSPORT_PARALLEL 1

/** The camera: an observer with a lens. Positions and axes in scene axes and lengths. */
typedef struct BhrCamera {
    uint32_t struct_size;     /**< sizeof(BhrCamera). */
    BhrProjection projection; /**< BHR_PROJECTION_*. Default PERSPECTIVE. */
    double position[3];       /**< Default (0, 26, 2.5). Not (0, 0, 0). */
    double forward[3];        /**< Any non-zero length. Default: towards the hole. */
    double up[3];             /**< Any non-zero length, not parallel to forward. Default +z. */
    /** Radians: full vertical angle, (0, pi), for PERSPECTIVE; across the circle, (0, 2 pi], for FISHEYE. Default pi
     * / 4. */
    double fov_y;
    BhrMotion motion;  /**< BHR_MOTION_*. Default STATIC. */
    uint32_t reserved; /**< Reserved: 0. */
    /** For BHR_MOTION_VELOCITY: v / c against the observer of the chart's triad (by default the local static one, the
     * ZAMO), |v| < 1; components as for a direction given at position. Default 0. */
    double velocity[3];
    /** For FRUSTUM: the borders of the picture on the plane at distance 1 ahead, to the right and up, within +-1e9;
     * left less than right, down less than up. Default -1, 1, -1, 1. Other projections ignore them. @since 0.2.0 */
    double tan_left;
    double tan_right; /**< The right border. @since 0.2.0 */
    double tan_down;  /**< The lower border. @since 0.2.0 */
    double tan_up;    /**< The upper border. @since 0.2.0 */
    /** Pixels that the whole picture moves to the right and down, each within +-1, for temporal antialiasing. For
     * PERSPECTIVE and FRUSTUM; other projections ignore it. Default 0. @since 0.2.0 */
    double jitter[2];
    /** For EQUIRECT with an eye: the distance of the two eyes, scene lengths, at least 0. Default 0. @since 0.2.0 */
    double eye_distance;
    /** BHR_EYE_*. With LEFT or RIGHT and an eye_distance above 0 an EQUIRECT picture is one of two for 360-degree
     * stereo (omnidirectional stereo, ODS), and takes longer. Bloom of a preset is then left out; other bloom, and
     * all else of a film that regions cannot have, are INVALID_STATE; windows, bhr_project_point, outputs other than
     * LIGHT, occluders and targets on the GPU are UNSUPPORTED. Other projections ignore it. Default MIDDLE.
     * docs/cameras.md. @since 0.2.0 */
    BhrEye eye;
    uint32_t reserved2; /**< Reserved: 0. @since 0.2.0 */
    /** BHR_CHART_*: that of position, forward, up and velocity, of the time of bhr_set_time, and of the rays, paths
     * and points that this context is asked for. RAIN is needed at and inside a spinning hole's horizon; a fall that
     * is to go there must be told in it from the start. Default STATIC. @since 0.2.0 */
    BhrChart chart;
    BhrTransport transport; /**< BHR_TRANSPORT_*. Default TRIAD. @since 0.2.0 */
} BhrCamera;

/** Fills in the defaults. */
BHR_NODISCARD BhrStatus bhr_camera_init(BhrCamera *camera, size_t struct_size);

/** Sets position, forward (towards target) and up of a camera; touches no context.
 * Errors: INVALID_ARGUMENT for position (0, 0, 0) or equal to target, up zero or along the line of sight. */
BHR_NODISCARD BhrStatus bhr_camera_look_at(BhrCamera *camera, const double position[3], const double target[3],
                                           const double up[3]);

/** Sets a camera at distance (> 0) from the hole, at azimuth from +x towards +y and elevation from the xy plane
 * towards +z (radians), looking at the hole: position = distance (cos el cos az, cos el sin az, sin el), up = +z.
 * Within 1e-6 of a pole up is the limit of what it is on the way there, -sin el (cos az, sin az, 0). */
BHR_NODISCARD BhrStatus bhr_camera_orbit(BhrCamera *camera, double distance, double azimuth, double elevation);

/** For depth of field: moves a PERSPECTIVE or FRUSTUM camera to place index (from 0) of count (1 to 65536) on a thin
 * lens of the diameter aperture (>= 0), and makes it a FRUSTUM one in which what lies at the distance focus (> 0)
 * ahead keeps its place. Frames from all places, each made from the same camera, add up by bhr_accumulate, with equal
 * weights (docs/motion-blur.md). aperture and focus are scene lengths; aspect (> 0) is the frame's width / height.
 * Errors: INVALID_ARGUMENT also for another projection, and for a struct_size without tan_up. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_camera_through_lens(BhrCamera *camera, double aperture, double focus, double aspect,
                                                uint32_t index, uint32_t count);

/** Sets the camera.
 * Errors: INVALID_ARGUMENT also for position (0, 0, 0), and forward or up that are zero or parallel. */
BHR_NODISCARD BhrStatus bhr_set_camera(BhrContext *context, const BhrCamera *camera);

/** Reads the camera as it is set. */
BHR_NODISCARD BhrStatus bhr_get_camera(const BhrContext *context, BhrCamera *camera);

/** Moves a camera along its own world line about the context's hole by proper_time (scene lengths, of any sign): a
 * STATIC one stays, a FREE_FALL one falls, an ORBIT one orbits, a VELOCITY one falls freely, which changes its
 * velocity. BhrCamera.transport says how axes go along. The context's own camera stays where it is.
 * *out_coordinate_time, unless NULL, becomes the time of the camera's chart that went by: add it to the time of
 * bhr_set_time. In chart RAIN a fall is seamless through the horizon, without spin in STATIC too (docs/cameras.md).
 * Errors: INVALID_ARGUMENT as bhr_set_camera; INVALID_STATE where the motion is not possible, and for a fall that
 * ends before: in the centre, at r- (1 + 1e-6), or in STATIC at the horizon; UNSUPPORTED for a STATIC camera with
 * PARALLEL axes, and for more than 300,000 steps. */
BHR_NODISCARD BhrStatus bhr_camera_advance(const BhrContext *context, BhrCamera *camera, double proper_time,
                                           double *out_coordinate_time);

/* ---- cameras as matrices ---- */

/** Matrices lie in memory row by row, else column by column. For matrices that multiply row vectors (DirectXMath,
 * Unreal) it is the other way round: those that lie in memory row by row are given without this flag. */
#define BHR_MATRIX_ROW_MAJOR 1u

/** Clip space's y = +1 is the image's bottom row, as in Vulkan; else its top row, as in OpenGL, Direct3D and Metal. */
#define BHR_MATRIX_Y_DOWN 2u

/** Depths lie in 0 .. 1, else in -1 .. 1 (OpenGL). bhr_camera_from_matrices does not ask for it. */
#define BHR_MATRIX_ZERO_TO_ONE 4u

/** The near plane has the greatest depth, the far one the least. bhr_camera_from_matrices does not ask for it. */
#define BHR_MATRIX_REVERSED 8u

/** The camera looks along its own +z, with x to the right and y up (Direct3D, Unreal), else along -z (OpenGL,
 * Vulkan, Unity). bhr_camera_from_matrices sees it in the projection. */
#define BHR_MATRIX_FORWARD_Z 16u

/** Sets position, forward, up and the picture (projection FRUSTUM, its tangents, jitter 0) of a camera from the
 * host's matrices; the rest of it, such as its motion, stays. Touches no context.
 *
 * view takes the world, whose origin is the hole's centre and whose lengths are scene lengths, to the camera: a
 * rotation and a shift, without scale. projection is any perspective one, off-axis, jittered, with reversed or
 * infinite depths; its row of depths is not read. flags: BHR_MATRIX_ROW_MAJOR and BHR_MATRIX_Y_DOWN. The world is
 * right-handed: docs/cameras.md says how Unity and Unreal, whose worlds are not, negate an axis.
 * Errors: INVALID_ARGUMENT also for a view that is not rigid to 1e-4, a projection that is orthographic, sheared or
 * rolled, matrices that mirror the scene (left-handed worlds), the hole's centre as position, and a camera whose
 * struct_size ends before jitter does. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_camera_from_matrices(BhrCamera *camera, const double view[16], const double projection[16],
                                                 uint32_t flags);

/** The view and the projection of a PERSPECTIVE or FRUSTUM camera, as bhr_camera_from_matrices takes them: for
 * pixels of a width x height frame with the planes near_z > 0 and far_z > near_z, or INFINITY. flags: any of
 * BHR_MATRIX_*. For a left-handed world multiply the view by the same scale again. The camera's motion does not
 * enter: an observer that moves sees directions aberrated, which no matrix says. Touches no context.
 * Errors: INVALID_ARGUMENT also for another projection, and a camera that bhr_set_camera would refuse. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_camera_matrices(const BhrCamera *camera, uint32_t width, uint32_t height, double near_z,
                                            double far_z, uint32_t flags, double out_view[16],
                                            double out_projection[16]);

/* ---- accretion disk ---- */

#define BHR_DISK_RETROGRADE 1u /**< BhrDisk.flags: the matter orbits towards -ph. */

/** BhrDisk.flags: matter shines on its way from the ISCO to the horizon, too, where it falls freely. Rays are
 * integrated one by one, which takes longer. docs/matter.md has the model. @since 0.2.0 */
#define BHR_DISK_PLUNGES 2u

/** The ring at whose radius a disk has the stated temperature and brightness. @since 0.2.0 */
typedef int32_t BhrDiskReference;

/** The hottest ring of the profile: at spin 0 r = 9.55 M, at spin 0.998 r = 1.58 M. Where that ring moves inwards,
 * the rest of the disk darkens. */
#define BHR_DISK_AT_HOTTEST 0

/** The ring that halves the disk's area, r^2 = (inner^2 + outer^2) / 2, but for the outermost quarter of a soft
 * outer edge's fading: the disk as a whole keeps its look when spin or edges change. */
#define BHR_DISK_AT_MEDIAN 1

/** How the disk's light depends on the angle to its normal, in the frame of its matter. The flux is the same.
 * @since 0.2.0 */
typedef int32_t BhrEmissionLaw;

#define BHR_DISK_ISOTROPIC 0 /**< The disk's surface shines alike in all directions. */

/** Like an atmosphere of free electrons: 1.269 times as bright along the normal, 0.414 times at grazing angles. */
#define BHR_DISK_LIMB_DARKENED 1

/** A geometrically thin disk in the equatorial plane, on circular geodesics, with the Page-Thorne flux. Radii in
 * units of M. docs/matter.md has the model. */
typedef struct BhrDisk {
    uint32_t struct_size; /**< sizeof(BhrDisk). */
    uint32_t flags;       /**< Any of BHR_DISK_RETROGRADE | BHR_DISK_PLUNGES. Default 0. */
    /** In M, 0 .. 1e6. The disk begins here, but not inside the ISCO, or with BHR_DISK_PLUNGES not inside the
     * horizon. Default 0: at the ISCO, or at the horizon. */
    double inner_radius;
    double outer_radius; /**< In M, 0 .. 1e6, greater than inner_radius. Default 17. */
    double temperature;  /**< Kelvin at the ring that `reference` says, 500 .. 1e9. Default 3500. */
    double opacity;      /**< 0 .. 1. Default 1. */
    double brightness;   /**< 0 .. 1e6: the luminance of that ring at rest. Default 0.6. */
    /** Contrast of the structure that orbits with the matter, 0 .. 1; 0 is smooth. Default 1. Its mean is the smooth
     * disk's light. bhr_set_time carries it along, forwards and backwards, at any time to 1e9 M and more. */
    double turbulence;
    uint64_t seed; /**< Selects the turbulence: the same seed always gives the same pattern. Any number. Default 0. */
    /** BHR_DISK_AT_*. Default AT_MEDIAN; AT_HOTTEST in structs of 0.1.0's size. @since 0.2.0 */
    BhrDiskReference reference;
    BhrEmissionLaw emission_law; /**< BHR_DISK_ISOTROPIC (default), BHR_DISK_LIMB_DARKENED. @since 0.2.0 */
    /** 0 .. 1, default 0.4, 0 is sharp: opacity and light fade to nothing over this share of the way from the inner
     * edge to the outer one, at its end, and near the ISCO. A disk that inner_radius cuts off outside the hottest
     * ring is sharp there. @since 0.2.0 */
    double edge_softness;
} BhrDisk;

/** Fills in the defaults. */
BHR_NODISCARD BhrStatus bhr_disk_init(BhrDisk *disk, size_t struct_size);

/** Sets the disk; NULL: no disk. A new context has the default one. */
BHR_NODISCARD BhrStatus bhr_set_disk(BhrContext *context, const BhrDisk *disk);

/** Reads the disk as it is set. *out_present becomes 1 with a disk; without one it becomes 0, and disk gets the
 * defaults. */
BHR_NODISCARD BhrStatus bhr_get_disk(const BhrContext *context, BhrDisk *disk, int32_t *out_present);

/* ---- matter with depth: volumes and hot spots ---- */

/** The place of a volume's matter: its density n, with c = cos th, R = r sin th, z = r c, and lengths in M. n is 1
 * at inner_radius (DISK), at radius (JET) or in the middle (TORUS, HALO), but for soft edges at inner_radius and
 * outer_radius (docs/matter.md). @since 0.2.0 */
typedef int32_t BhrVolumeShape;

/** About the equatorial plane: n = (r / inner_radius)^-slope e^(-(c / thickness)^2 / 2), with soft edges. */
#define BHR_VOLUME_DISK 0

/** A ring about the axis: n = e^(-((R - radius) / width)^2 / 2 - (z / (thickness radius))^2 / 2). */
#define BHR_VOLUME_TORUS 1

/** About the hole: n = e^(-(r / radius)^2 / 2 - (c / thickness)^2 / 2), with thickness = 1e6 a sphere. */
#define BHR_VOLUME_HALO 2

/** A hollow jet along the axis and one opposite: matter in the wall of a cone about the axis, n = (r /
 * radius)^-slope e^(-((|c| - cos psi) / thickness)^2 / 2), psi = opening sqrt(radius / r), at most pi / 2, with
 * soft edges. With the default flow its matter orbits: BHR_FLOW_OUTFLOW moves it along the jet. */
#define BHR_VOLUME_JET 3

/** The motion of a volume's matter. Every flow is slower than light everywhere; docs/matter.md has the laws.
 * @since 0.2.0 */
typedef int32_t BhrFlow;

/** On circles, inside the ISCO plunging with the energy and the angular momentum of the orbit there. sub_keplerian
 * takes angular momentum from it, infall goes over to free fall. */
#define BHR_FLOW_KEPLERIAN 0

/** -u_ph / u_t = angular_momentum R^(3/2) / (1 + R), without radial motion: the flow of Gold et al. 2020. */
#define BHR_FLOW_ANGULAR_MOMENTUM 1

/** Away from the hole, the faster the farther, as the matter of a jet: at rest at r = inner_radius, at speed far
 * away, falling in nearer to the hole. A spinning hole turns it in the hole's own sense, whatever
 * BHR_VOLUME_RETROGRADE says. */
#define BHR_FLOW_OUTFLOW 2

#define BHR_VOLUME_RETROGRADE 1u /**< BhrVolume.flags: the matter moves towards -ph. */
#define BHR_VOLUME_POWER_LAW 2u  /**< BhrVolume.flags: the light is a power law of the frequency, not a blackbody's. */

/** Matter with depth, which shines and absorbs by the equation of transfer; nothing is scattered. Radii are in units
 * of M, other lengths those that the matter itself measures. Thermal matter absorbs alike at all frequencies, and
 * without absorption does not shine. A power law emits j = n (nu / nu_camera)^-spectral_index per M, and its
 * absorption per M is absorption n (nu / nu_camera)^-(2.5 + spectral_index), nu being the frequency that the matter
 * measures: a picture shows its light at the one frequency nu_camera, in the colour tint. No matter is inside the
 * horizon. Fields that shape and flow do not use are checked all the same. docs/matter.md. @since 0.2.0 */
typedef struct BhrVolume {
    uint32_t struct_size; /**< sizeof(BhrVolume). */
    uint32_t flags;       /**< Any of BHR_VOLUME_RETROGRADE | BHR_VOLUME_POWER_LAW. Default 0. */
    BhrVolumeShape shape; /**< BHR_VOLUME_DISK (default), _TORUS, _HALO, _JET. */
    BhrFlow flow;         /**< BHR_FLOW_KEPLERIAN (default), _ANGULAR_MOMENTUM, _OUTFLOW. */
    /** In M, 1e-6 .. 1e4, or 0 (default): the ISCO of matter that moves as flags say. DISK, JET: the inner edge;
     * OUTFLOW: the place where matter is at rest. */
    double inner_radius;
    /** In M, 0 .. 1e4, greater than inner_radius. There is nothing beyond it, whatever the shape, and nothing at all
     * of a DISK or JET whose outer_radius is less than 0.9 times its inner edge, be that the ISCO. Default 17. */
    double outer_radius;
    double radius; /**< In M, 0.1 .. 1e4. TORUS: the ring's; HALO: the scale; JET: where psi = opening. Default 8. */
    double width;  /**< In M, 1e-3 .. 1e4, of a TORUS at least radius / 100: its Gaussian width in R. Default 2. */
    /** 0.01 .. 1e6: the Gaussian width in c; TORUS: in z, over radius. Default 0.05, a soft disk; 0.14 is thick. */
    double thickness;
    double opening;    /**< JET: the wall's angle from the axis at `radius`, radians, 0.01 .. 1.5. Default 0.3. */
    double slope;      /**< DISK, JET: 0 .. 4. Default 0.7. */
    double absorption; /**< Per M at density 1, 0 .. 1e6. Default 3; less than 0.5 is mist, more than 5 a surface. */
    /** Kelvin, 500 .. 1e9, at inner_radius (DISK, JET) or at radius (TORUS, HALO). Default 4800. */
    double temperature;
    /** 0 .. 2: the temperature goes as r^-temperature_slope. Default 0.35; 0.75 is like a thin disk. */
    double temperature_slope;
    double spectral_index; /**< POWER_LAW: -4 .. 4. Default 1. */
    /** POWER_LAW: the colour of its light at every shift, linear Rec. 709, each 0 .. 1. Default 1, 1, 1. */
    double tint[3];
    /** A factor on the light, 0 .. 1e6, which changes neither its colour nor what is absorbed. At 1 the light is as
     * bright as white without exposure and tone map: of thermal matter of `temperature` at rest that is so thick
     * that nothing shines through; of a power law, of 1 M of density 1 at rest which absorbs nothing. Default 1. */
    double brightness;
    double sub_keplerian; /**< KEPLERIAN: the share of the orbit's angular momentum, 0 .. 1. Default 1. */
    /** KEPLERIAN: a share without a unit, 0 .. 1: 0 (default) is orbits, 1 free fall from rest at infinity. */
    double infall;
    double angular_momentum; /**< ANGULAR_MOMENTUM: 0 .. 1. Default 1. */
    double speed;            /**< OUTFLOW: the velocity far away in units of c, 0 .. 0.995. Default 0.9. */
    /** 0 .. 1: the contrast of structure that the matter carries along: a pattern P = e^(turbulence G) over its
     * mean, G being noise of mean 0 and about variance 1. Default 1; 0 is even matter, as is that of a host whose
     * BhrVolume ends before this field. */
    double turbulence;
    /** 0.5 .. 3: the density is multiplied by P^clumping over its mean; more makes filaments. Default 1.8. */
    double clumping;
    /** 0 .. 0.5: the temperature is multiplied by P^heating, so that dense matter is hotter. Default 0.15. */
    double heating;
    uint64_t seed; /**< Selects the structure: the same seed always gives the same one. Any number. Default 0. */
} BhrVolume;

#define BHR_MAX_VOLUMES 4          /**< Most volumes of a scene. @since 0.2.0 */
#define BHR_HOT_SPOT_RETROGRADE 1u /**< BhrHotSpot.flags: the spot moves towards -ph. */

/** BhrHotSpot.flags: the light is a blackbody's, not a power law's; without absorption there is none. */
#define BHR_HOT_SPOT_THERMAL 2u

/** BhrHotSpot.flags: the centre is a body in free fall, which position, velocity and time tell; radius, azimuth and
 * RETROGRADE have no meaning. */
#define BHR_HOT_SPOT_FREE 4u

/** BhrHotSpot.flags: with FREE, these are told in BHR_CHART_RAIN instead of BHR_CHART_STATIC. */
#define BHR_HOT_SPOT_RAIN 8u

/** A glowing blob, by default on a circular geodesic in the equatorial plane: n = e^(-(d / size)^2 / 2), cut off at 7
 * sizes, d being the distance from its centre in chart coordinates. It is rigid: all of it turns as its centre does,
 * at dph/dt = 1 / (radius^(3/2) + a), with RETROGRADE -1 / (radius^(3/2) - a), per M; parts that would be faster than
 * light, beside the hole, are left out. It shines and absorbs as BhrVolume says, and its delay matters
 * (docs/matter.md).
 *
 * With BHR_HOT_SPOT_FREE the centre moves on any geodesic, for some six hundred turns about the hole before and
 * after `time` and out to 1e4 M, and distances are those of Doran's chart. @since 0.2.0 */
typedef struct BhrHotSpot {
    uint32_t struct_size; /**< sizeof(BhrHotSpot). */
    /** Any of BHR_HOT_SPOT_RETROGRADE | BHR_HOT_SPOT_THERMAL | BHR_HOT_SPOT_FREE | BHR_HOT_SPOT_RAIN. Default 0. */
    uint32_t flags;
    /** In M, 1 .. 1000. Inside the ISCO no orbit is stable: there the spot is taken to be at the ISCO. Default 8. */
    double radius;
    double size; /**< In M, 0.05 .. radius / 4, and at least radius / 200; FREE: from 0.05 to 250. Default 0.8. */
    double azimuth; /**< The centre at scene time 0, radians within +-1e6. Default 0. */
    double absorption; /**< Per M at the centre, 0 .. 1e6. Default 0. */
    double temperature; /**< Kelvin, 500 .. 1e9. Default 10000. */
    double spectral_index; /**< Without THERMAL: -4 .. 4. Default 1. */
    /** Without THERMAL: the colour of its light at every shift, linear Rec. 709, each 0 .. 1. Default 1, 1, 1. */
    double tint[3];
    double brightness; /**< 0 .. 1e6, as BhrVolume.brightness. Default 1. */
    /** FREE: where the centre is at `time`, scene axes and lengths, as BhrBody has it. Default 0, 0, 0, which FREE
     * refuses. */
    double position[3];
    /** FREE: its velocity there in units of c, |v| < 1, scene axes, as BhrBody has it. Default 0, 0, 0. */
    double velocity[3];
    /** FREE: scene time, in scene lengths, that position and velocity are of; RAIN: rain time. Default 0. */
    double time;
} BhrHotSpot;

#define BHR_MAX_HOT_SPOTS 8 /**< Most hot spots of a scene. @since 0.2.0 */

/** Fills in the defaults. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_volume_init(BhrVolume *volume, size_t struct_size);

/** Fills in the defaults. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_hot_spot_init(BhrHotSpot *hot_spot, size_t struct_size);

/** Sets all volumes of the scene: count of them, packed, at most BHR_MAX_VOLUMES; 0: none, as a new context has it,
 * and then volumes may be NULL. They may overlap each other, the thin disk and hot spots. volume_size =
 * sizeof(BhrVolume) as the caller was compiled; no volume's struct_size may be larger. Frames that are being
 * rendered keep the volumes that they began with. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_set_volumes(BhrContext *context, const BhrVolume *volumes, size_t volume_size,
                                        uint32_t count);

/** Reads the volumes as they are set: *out_count becomes their number, and the first `capacity` of them are written,
 * packed, each with volume_size as its struct_size. With capacity 0 volumes may be NULL. After an error volumes are
 * as they were. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_get_volumes(const BhrContext *context, BhrVolume *volumes, size_t volume_size,
                                        uint32_t capacity, uint32_t *out_count);

/** Sets all hot spots of the scene, at most BHR_MAX_HOT_SPOTS, as bhr_set_volumes does the volumes. One in free fall
 * is checked against the hole as it is, with bhr_world_line's errors; where a later hole has no such place it is not
 * shown. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_set_hot_spots(BhrContext *context, const BhrHotSpot *hot_spots, size_t hot_spot_size,
                                          uint32_t count);

/** Reads the hot spots as they are set, as bhr_get_volumes does the volumes. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_get_hot_spots(const BhrContext *context, BhrHotSpot *hot_spots, size_t hot_spot_size,
                                          uint32_t capacity, uint32_t *out_count);

/* ---- images in the host's memory ---- */

/** BhrImage.flags: the sky is left out, and alpha is 1 - the sky's share, premultiplied. Without this flag alpha is
 * 1. Bloom adds light and leaves alpha as it is. */
#define BHR_IMAGE_TRANSPARENT 1u

/** BhrImage.flags: the picture's bottom row comes first in memory, as OpenGL has it. pixels is then the lowest
 * address of the block, as without the flag, and row_stride, 0 or more, is the distance to the next row up.
 * @since 0.2.0 */
#define BHR_IMAGE_BOTTOM_UP 2u

/** BhrImage.flags: for bhr_set_occluder, and flags of bhr_set_occluder_target: the host has drawn the things where
 * bent light shows them (BhrProjectedPoint.apparent). Without it they lie on straight lines of sight. @since 0.2.0 */
#define BHR_IMAGE_LENSED 4u

/** A pixel's bytes in memory order. A radiance of 1 is the luminance at rest of the ring that BhrDisk.reference
 * names, if the disk's brightness is 1. */
typedef int32_t BhrFormat;

#define BHR_FORMAT_RGBA8_SRGB 1 /**< 4 bytes: red, green, blue with the sRGB curve, alpha. */
#define BHR_FORMAT_BGRA8_SRGB 2 /**< 4 bytes: blue, green, red with the sRGB curve, alpha. */
#define BHR_FORMAT_RGBA16F 3    /**< 4 half floats: linear radiance, Rec. 709 primaries; alpha. */
#define BHR_FORMAT_RGBA32F 4    /**< 4 floats: linear radiance, Rec. 709 primaries; alpha. */
#define BHR_FORMAT_R32F 5       /**< 1 float: the value of a view or an output, or the distance of an occluder. */

/** A uint32_t: from the lowest bit on 10 bits of red, green and blue, and 2 of alpha, as in R10G10B10A2 of DXGI and
 * A2B10G10R10 of Vulkan. High dynamic range by the curve PQ (SMPTE ST 2084), as in HDR10, primaries of Rec. 2020,
 * full range. Light has the film but its tone map, LUT and colour map; BhrFilm.paper_white and peak say how bright
 * it is. @since 0.2.0 */
#define BHR_FORMAT_RGB10A2_PQ 6

/** The bits of RGB10A2_PQ by the curve HLG (ITU-R BT.2100), for a display whose peak is that of the film. @since 0.2.0
 */
#define BHR_FORMAT_RGB10A2_HLG 7

/** The primaries of linear light in RGBA16F and RGBA32F. @since 0.2.0 */
typedef int32_t BhrColourSpace;

#define BHR_COLOUR_SPACE_REC709 0  /**< Rec. 709, white D65. */
#define BHR_COLOUR_SPACE_P3_D65 1  /**< DCI-P3, white D65 (SMPTE EG 432-1). */
#define BHR_COLOUR_SPACE_REC2020 2 /**< Rec. 2020, white D65. */
#define BHR_COLOUR_SPACE_ACESCG 3  /**< ACEScg: AP1, the white of ACES (Academy S-2014-004). */

/** Pixels in memory. Bytes between rows are neither read nor written. Several images may share a block, side by side
 * or interleaved; different contexts may then render them at the same time. Rows from the bottom up are best asked
 * for by BHR_IMAGE_BOTTOM_UP. A negative row_stride with pixels at the last row of the block means the same; if
 * pixels is left at the block's beginning, rows are written in front of it, and no check can find that. */
typedef struct BhrImage {
    uint32_t struct_size; /**< sizeof(BhrImage). */
    BhrFormat format;     /**< BHR_FORMAT_*. Default RGBA8_SRGB. */
    uint32_t width;       /**< Pixels, 1 .. 2^20. */
    uint32_t height;      /**< Pixels, 1 .. 2^20. */
    /** The top-left pixel; with BHR_IMAGE_BOTTOM_UP the bottom-left one. Aligned to its channel: 1, 2 or 4 bytes. */
    void *pixels;
    /** Bytes to the next row down, with BHR_IMAGE_BOTTOM_UP to the next row up; a multiple of the channel's size, of
     * which |row_stride| must hold a row. 0 (default): packed. < 0: the next row down lies lower in memory, and
     * pixels is the block's last row; not together with BHR_IMAGE_BOTTOM_UP. */
    int64_t row_stride;
    /** Size of the host's block in bytes. The block begins at pixels, or, where row_stride < 0, (height - 1)
     * |row_stride| bytes before it. At least (height - 1) |row_stride| + width times the bytes of a pixel. */
    uint64_t byte_size;
    /** BHR_IMAGE_* bits. Default 0. BHR_IMAGE_TRANSPARENT matters to images that are rendered or saved only;
     * BHR_IMAGE_LENSED is for bhr_set_occluder only, and elsewhere INVALID_ARGUMENT. */
    uint32_t flags;
    uint32_t reserved; /**< Reserved: 0. */
    /** BHR_COLOUR_SPACE_*. Default REC709. Others matter to bhr_image_convert and bhr_image_save only; elsewhere they
     * are INVALID_ARGUMENT. @since 0.2.0 */
    BhrColourSpace colour_space;
    uint32_t reserved2; /**< Reserved: 0. @since 0.2.0 */
} BhrImage;

/** Fills in the defaults. */
BHR_NODISCARD BhrStatus bhr_image_init(BhrImage *image, size_t struct_size);

/** Converts the linear light of an image of RGBA16F or RGBA32F in place, from its colour_space to another, which
 * becomes its colour_space; white stays white (Bradford's adaptation), alpha stays. All light of bhr lies within
 * REC709, and so within P3_D65, REC2020 and ACESCG: nothing becomes negative there.
 * Errors: INVALID_ARGUMENT also for other formats, and for a struct_size without colour_space. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_image_convert(BhrImage *image, BhrColourSpace colour_space);

/** Writes an image to a file: 8-bit formats to .png or .ppm (without alpha), RGB10A2 to .png of 16 bits without
 * alpha, float formats to .exr, which says what its primaries are; R32F becomes grey. Alpha is written as it is. A
 * .png's colours are not premultiplied: with BHR_IMAGE_TRANSPARENT in the flags they are divided by alpha. The file
 * appears whole or not at all; one that is replaced keeps its mode and, where possible, its owner, and a symbolic
 * link's target is written (docs/files.md).
 * Errors: UNSUPPORTED for another extension, one that does not go with the format, or .exr in a library that was
 * built without EXR; IO, with the path in the message, also for an older file that this process may not write, for
 * another user's symbolic link in a sticky folder that all may write, and for a full disk or a quota. */
BHR_NODISCARD BhrStatus bhr_image_save(const BhrImage *image, const char *path);

/** Reads a PNG, EXR, PNM or KTX2 file. The caller sets image->struct_size; the rest is filled in: packed rows from
 * the top down, RGBA8_SRGB for 8-bit files in sRGB, else RGBA32F, which is linear light in Rec. 709, converted from
 * the colours that the file states. The pixels are the library's: give them back with bhr_image_release, once.
 * docs/files.md says how files are read, and which bounds they have.
 * Errors: UNSUPPORTED for EXR of the compressions DWA and HTJ2K, for colours of a PNG that are not known, for texels,
 * primaries, curves or compressions of a KTX2 file that docs/files.md does not name, or in a library built without
 * EXR; IO for a file that is not there, not readable, broken, of more than 2^20 pixels a side, or of more than 4 GiB
 * of pixels in memory. Memory is taken after the file's claims are checked. */
BHR_NODISCARD BhrStatus bhr_image_load(const char *path, BhrImage *image);

/** Gives back the pixels of bhr_image_load and sets image->pixels to NULL and byte_size to 0.
 * Errors: INVALID_ARGUMENT for pixels that are NULL, the host's, or were given back before. */
BHR_NODISCARD BhrStatus bhr_image_release(BhrImage *image);

/* ---- sky ---- */

#define BHR_SKY_STARS 1u /**< BhrSky.flags: the real sky, from the embedded star catalogue. */

/** BhrSky.flags: a random field of a million stars to V = 11, with the real sky's numbers and colours, the same on
 * every machine for the same seed. Together with STARS only those fainter than V = 8. 110 MB of device memory.
 * docs/maps.md. */
#define BHR_SKY_PROCEDURAL 2u

/** BhrSky.flags: the glow of the Milky Way, true to about a degree, and next to the stars eight times as bright as
 * the eye sees it. docs/maps.md. */
#define BHR_SKY_MILKY_WAY 4u

#define BHR_SKY_MAP 8u /**< BhrSky.flags: the map that bhr_set_sky_map was given; nothing without one. */

/** BhrSky.flags: a grid in sky axes, which shows the lensing: right ascension every hour, declination every 15
 * degrees, lines 1.3 pixels wide. docs/maps.md. */
#define BHR_SKY_GRID 16u

/** The sky: everything that lies at infinity. */
typedef struct BhrSky {
    uint32_t struct_size;    /**< sizeof(BhrSky). */
    uint32_t flags;          /**< BHR_SKY_* bits; 0: black. Default STARS | MILKY_WAY. */
    double stars_brightness; /**< A factor on the light of the stars, 0 .. 1e6. Default 1. */
    double map_brightness;   /**< A factor on the light of the Milky Way and the map, 0 .. 1e6. Default 1. */
    /** Unit quaternion x y z w that takes sky axes (J2000 equatorial: +x vernal equinox, +z north celestial pole) to
     * scene axes. Default (0, 0, 0, 1). */
    double orientation[4];
    uint64_t seed; /**< Selects the stars of BHR_SKY_PROCEDURAL: any number. Default 0. */
} BhrSky;

/** Fills in the defaults. */
BHR_NODISCARD BhrStatus bhr_sky_init(BhrSky *sky, size_t struct_size);

/** Sets the sky; NULL: black.
 * Errors: INVALID_ARGUMENT also for an orientation whose length is not 1 to within 1e-3. */
BHR_NODISCARD BhrStatus bhr_set_sky(BhrContext *context, const BhrSky *sky);

/** Reads the sky as it is set. */
BHR_NODISCARD BhrStatus bhr_get_sky(const BhrContext *context, BhrSky *sky);

/** Gives BHR_SKY_MAP its picture, copied before return (a second or two for 16384 x 8192); NULL removes it. The next
 * frames that are asked for show it. It covers the whole sky whatever its aspect: at x of width and y of height,
 * from the top left, right ascension is 360 deg (1/2 - x / width), declination 180 deg (1/2 - y / height). Light is
 * linear Rec. 709, 8-bit formats are decoded; NaN and negative numbers are 0, alpha is ignored. Pictures of more
 * than 16384 x 8192, or of more rows than 1024 and four times their columns, are reduced to that, and on the device
 * to its largest texture. Memory a texel: 5.4 bytes in the context and on a GPU, 6 on a software device; 1.34 for
 * maps in blocks (bhr_save_sky_map), until a tracer unpacks them. docs/maps.md.
 * Errors: INVALID_ARGUMENT for R32F and RGB10A2. */
BHR_NODISCARD BhrStatus bhr_set_sky_map(BhrContext *context, const BhrImage *equirect);

/** Gives BHR_SKY_MAP the picture in a file that bhr_image_load reads, as bhr_set_sky_map does one in memory. The path
 * is kept, so that bhr_scene_save can name it; a file that is given again and has not changed is not read again.
 * Blocks of BC6H in a .ktx2 file stay blocks, in the context and on most GPUs (docs/maps.md).
 * Errors: those of bhr_image_load and bhr_set_sky_map, after which the map is as it was. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_set_sky_map_file(BhrContext *context, const char *path);

/** Writes the map that bhr_set_sky_map or bhr_set_sky_map_file gave to a .ktx2 file in blocks of BC6H with all its
 * levels: 1.34 bytes a texel. bhr_set_sky_map_file and GPUs take the blocks as they are; docs/maps.md says how exact
 * they are. A map of 16384 x 8192 takes some seconds. Errors: INVALID_STATE without a map, or with one on the GPU
 * (bhr_interop.h); UNSUPPORTED for another ending of the path; IO, after which an older file is as it was.
 * @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_save_sky_map(const BhrContext *context, const char *path);

/* ---- film ---- */

/** The curve from light to pixels. */
typedef int32_t BhrToneMap;

#define BHR_TONE_MAP_NONE 0 /**< No curve: light above 1 is clipped. */

/** A filmic curve, the fit of ACES 1.0 by Stephen Hill; middle grey, 0.18, becomes 127 of 255. */
#define BHR_TONE_MAP_ACES 1

/** AgX, base look; middle grey becomes 128 of 255, and bright saturated light shifts its hue less than under ACES. */
#define BHR_TONE_MAP_AGX 2

/** A filmic curve with settings, John Hable's of three powers: `toe_strength` to `shoulder_angle`. @since 0.2.0 */
#define BHR_TONE_MAP_FILMIC 3

/** The colours of a picture. @since 0.2.0 */
typedef int32_t BhrColourMap;

#define BHR_COLOUR_MAP_NONE 0 /**< The picture has the colours of the light. */

/** The map afmhot, in which the Event Horizon Telescope publishes its images, of the luminance after the tone map:
 * red 2 s, green 2 s - 1/2, blue 2 s - 1, each within 0 .. 1, in sRGB code values. With BHR_TONE_MAP_NONE s is
 * linear in the light. */
#define BHR_COLOUR_MAP_AFMHOT 1

/** How light becomes pixels, in formats of 8 and 10 bits and windows of BHR_VIEW_LIGHT only: float formats hold
 * linear radiance, and other views show values. In this order: exposure, bloom, beam, flare, spikes and streak,
 * auto exposure, highlights and shadows, vignette, white balance, contrast, saturation, grain, tone map, the sRGB
 * curve and the LUT, or the colour map, dithering. */
typedef struct BhrFilm {
    uint32_t struct_size; /**< sizeof(BhrFilm). */
    BhrToneMap tone_map;  /**< BHR_TONE_MAP_*. Default ACES. */
    double exposure_ev;   /**< Stops, -20 .. 20. Default 0. */
    /** Glare, 0 .. 1, 0 off, default 0.25: optics scatter 0.4 bloom of each pixel's light over its surroundings, alike
     * at every resolution. No light is lost, and transparent images keep their alpha. With a region set, 8- and 10-bit
     * images of light are INVALID_STATE when they are rendered; but where no bhr_set_film came after the context
     * was made, or after the last bhr_set_preset, they are rendered without glare. docs/colour-and-film.md. */
    double bloom;
    /** The full width at half maximum of a Gaussian that the picture is spread by, as by a telescope's beam; in
     * frame heights, 0 .. 1, 0 off (default). Alpha is left alone. With a region set, 8- and 10-bit images of
     * light are INVALID_STATE when they are rendered, also when a preset set the beam.
     * docs/colour-and-film.md. @since 0.2.0 */
    double beam_fwhm;
    BhrColourMap colour_map; /**< BHR_COLOUR_MAP_*. Default NONE. @since 0.2.0 */
    /** Blades of the lens's aperture, 3 .. 8: an even number of them makes as many spikes, an odd one twice as many.
     * 0, the default, stands for 6. @since 0.2.0 */
    uint32_t spike_blades;
    /** Kelvin, 1667 .. 25000, of the blackbody whose light is to look white: the lower, the bluer the picture. Default
     * 0: colours stay as they are. @since 0.2.0 */
    double white_balance;
    /** -1 .. 1: the picture turns towards magenta above 0, towards green below. Default 0. The light that is to look
     * white has a Duv of 0.02 tint (CIE 1960): above 0 it is greener than a blackbody's. @since 0.2.0 */
    double tint;
    /** 0.25 .. 4, the exponent of light; light of 0.18, middle grey, stays as it is. Default 1. @since 0.2.0 */
    double contrast;
    /** 0 .. 4, a factor on how far colours are from the grey of their luminance; 0 is grey. Default 1. @since 0.2.0 */
    double saturation;
    /** FILMIC, 0 .. 1: at 0 dark light stays linear, at 1 all of the toe, the curve's dark end, is black. Default 0.5.
     * @since 0.2.0 */
    double toe_strength;
    double toe_length; /**< FILMIC: 0 .. 1; the toe ends at light toe_length^2.2 / 2. Default 0.5. @since 0.2.0 */
    /** FILMIC: stops, 0 .. 16; light from about 2^shoulder_strength on is white. Default 2. @since 0.2.0 */
    double shoulder_strength;
    /** FILMIC, 0 .. 1: the share that the shoulder, the curve's bright end, has of all that is above the toe. Default
     * 0.5. @since 0.2.0 */
    double shoulder_length;
    /** FILMIC: how steep the shoulder still is at white, 0 .. 1; at 0 it ends flat. Default 1. @since 0.2.0 */
    double shoulder_angle;
    /** 0 .. 1, the share of a lens' natural darkening, cos^4 of an angle whose tangent is 1 in the corners of the whole
     * frame: at 1, light is a quarter there. Default 0. @since 0.2.0 */
    double vignette;
    /** Auto exposure, 0 .. 1: how far the exposure goes to where auto_percentile is auto_target. Default 0: off. The
     * frame's luminance is measured after exposure_ev and bloom, in small cells; cells darker than 2^-16 do not count.
     * exposure_ev is taken back by it: auto_target is what makes the picture brighter. bhr_frame_stats has what was
     * added. With a region set, 8- and 10-bit images of light are INVALID_STATE when they are rendered. @since 0.2.0 */
    double auto_exposure;
    /** The percentile of the frame's luminance that auto exposure goes by, 0 .. 100. Default 90. @since 0.2.0 */
    double auto_percentile;
    /** The luminance that auto exposure brings the percentile to, 0.001 .. 1000; middle grey is 0.18. Default 0.5.
     * @since 0.2.0 */
    double auto_target;
    double auto_least_ev; /**< The least that auto exposure adds, stops, -20 .. 20. Default -8. @since 0.2.0 */
    /** The most that auto exposure adds, stops, -20 .. 20. Default 8. If it is below auto_least_ev, this is what is
     * added. @since 0.2.0 */
    double auto_most_ev;
    /** 0.000001 .. 1: the share of the way that a frame goes from the exposure of the last frame of its size that this
     * context measured. Default 1: all of it, so that a picture depends on its scene alone. For frames t apart and a
     * time constant T it is 1 - exp(-t / T). @since 0.2.0 */
    double auto_adaptation;
    /** Local tone mapping, 0 .. 1: how much nearer to middle grey, by the logarithm, bright parts of the
     * picture come; their structure stays. Default 0: off. With a region set, 8- and 10-bit images of light
     * are INVALID_STATE when they are rendered. @since 0.2.0 */
    double highlights;
    /** Local tone mapping, 0 .. 1: how much nearer to middle grey, by the logarithm, dark parts of the picture come.
     * Default 0: off. Black stays black, but glare over it is lifted like other light: use less bloom with it. With a
     * region set, 8- and 10-bit images of light are INVALID_STATE when they are rendered. @since 0.2.0 */
    double shadows;
    /** Grain, 0 .. 1: light varies at random from place to place, with a standard deviation of 0.25 grain of itself.
     * Default 0: off. The mean light stays. Its cells are a 1080th of the frame's height wide, but no smaller than a
     * pixel. @since 0.2.0 */
    double grain;
    /** Any number within +-1e15: each is another grain, for instance that of a film's frame. Default 0. @since 0.2.0 */
    double grain_seed;
    /** 0 .. 1, the share of the colours that the LUT of bhr_set_film_lut has in the picture; 0 off. Default 1.
     * @since 0.2.0 */
    double lut_strength;
    /** Diffraction spikes, 0 .. 1, 0 off (default): the lens throws 0.4 spikes of each pixel's light along
     * lines that lie across the edges of the aperture's blades; they are reddish. No light is lost. With a
     * region set, 8- and 10-bit images of light are INVALID_STATE when they are rendered.
     * docs/colour-and-film.md. @since 0.2.0 */
    double spikes;
    /** The direction of one spike, radians anticlockwise from upright, -2 pi .. 2 pi. Default 0. @since 0.2.0 */
    double spike_angle;
    /** In frame heights, 0.01 .. 2: the length of the spikes' faint tails, which fall off by exp(-distance /
     * spike_length). Default 0.25. @since 0.2.0 */
    double spike_length;
    /** The horizontal streak of an anamorphic lens, 0 .. 1, 0 off (default): 0.4 streak of each pixel's light
     * is thrown to its left and right. No light is lost. With a region set, 8- and 10-bit images of light are
     * INVALID_STATE when they are rendered. docs/colour-and-film.md. @since 0.2.0 */
    double streak;
    /** In frame heights, 0.01 .. 4: the length of the streak's tails, which fall off by exp(-distance / streak_length).
     * Default 0.5. @since 0.2.0 */
    double streak_length;
    /** The streak's colour, -1 .. 1: -1 is amber, 0 that of the light, 1 blue. Default 0. @since 0.2.0 */
    double streak_tint;
    /** BHR_FORMAT_RGB10A2_*: what the display shows for light of 1, diffuse white; cd/m^2, 10 .. 1000. Default 203,
     * as in ITU-R BT.2408. @since 0.2.0 */
    double paper_white;
    /** BHR_FORMAT_RGB10A2_*: the brightest that the display shows, cd/m^2, 100 .. 10000, to which brighter light is
     * rolled off. Default 1000. @since 0.2.0 */
    double peak;
    /** Lens flare, 0 .. 1, 0 off (default): the lens reflects 0.15 flare of each pixel's light into ghosts, blurred
     * images of its aperture (spike_blades, spike_angle) in several colours, on the line from that pixel through the
     * middle of the frame. Ghosts of lights near the border are faint: that light is lost, no other. With a region
     * set, 8- and 10-bit images of light are INVALID_STATE when they are rendered. docs/colour-and-film.md.
     * @since 0.2.0 */
    double flare;
    uint32_t flare_ghosts; /**< How many ghosts each light has, 0 .. 8; 0, the default, stands for 5. @since 0.2.0 */
    uint32_t reserved;     /**< Reserved: 0. @since 0.2.0 */
} BhrFilm;

/** Fills in the defaults. */
BHR_NODISCARD BhrStatus bhr_film_init(BhrFilm *film, size_t struct_size);

/** Sets the film. */
BHR_NODISCARD BhrStatus bhr_set_film(BhrContext *context, const BhrFilm *film);

/** Reads the film as it is set. */
BHR_NODISCARD BhrStatus bhr_get_film(const BhrContext *context, BhrFilm *film);

/** Gives the film a LUT, a table of colours, copied before return: side^3 nodes of red, green and blue, red changing
 * fastest, spread evenly over sRGB-encoded colours from 0 to 1, which become the nodes' colours, by tetrahedral
 * interpolation between them, limited to 0 .. 1. side: 2 .. 65; count = 3 side^3, the number of floats; 0 takes the
 * LUT away, and then nodes may be NULL. It works where the film does, but with no colour map, and stays when film or
 * preset change. Black becomes what the LUT has for it, in transparent images as well. Memory: 16 bytes a node in the
 * context and on the device. docs/colour-and-film.md.
 * Errors: INVALID_ARGUMENT also for a node that is not finite; the LUT is then as it was. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_set_film_lut(BhrContext *context, const float *nodes, size_t count, uint32_t side);

/** Gives the film the LUT in a .cube file (Adobe's Cube LUT Specification 1.0), as bhr_set_film_lut does one in
 * memory; over its DOMAIN_MIN and DOMAIN_MAX, or LUT_3D_INPUT_RANGE, beyond which colours become those at the edge.
 * The path is kept, so that bhr_scene_save can name it; a file that is given again and has not changed is not read
 * again.
 * Errors, after which the LUT is as it was: IO, with the line, for a file that is not there, not readable, not UTF-8,
 * larger than 32 MiB, or no LUT of three dimensions and 2 to 65 nodes a side. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_set_film_lut_file(BhrContext *context, const char *path);

/* ---- relativistic effects, time ---- */

#define BHR_EFFECT_DOPPLER_SHIFT 1u /**< The frequency shift by motion colours the light. */
#define BHR_EFFECT_GRAVITY_SHIFT 2u /**< The gravitational redshift colours the light. */
#define BHR_EFFECT_BEAMING 4u       /**< The intensity follows g^3 (I_nu), g^4 (bolometric). */
#define BHR_EFFECT_LIGHT_DELAY 8u   /**< Moving matter is seen at its retarded time. */
#define BHR_EFFECT_ALL 4294967295u  /**< All effects, as a new context has them. */

/** Sets the effects that colour the light: BHR_EFFECT_* bits; unknown bits are ignored. Default BHR_EFFECT_ALL.
 * Lensing itself cannot be switched off. LIGHT_DELAY shows where matter is not the same all around (turbulence,
 * structure, hot spots); without it all matter is seen as it is at the time of bhr_set_time. docs/physics.md. */
BHR_NODISCARD BhrStatus bhr_set_effects(BhrContext *context, uint32_t effects);

/** Reads the effects as they are set. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_get_effects(const BhrContext *context, uint32_t *out_effects);

/** Sets how strongly effects show: strength, 0 (not at all) .. 1 (default: as physics has it), for those of
 * BHR_EFFECT_DOPPLER_SHIFT, GRAVITY_SHIFT and BEAMING whose bits are in effects; others stay as they are. The
 * effect's factor counts to the power of the strength, for colours its part of the ratio of frequencies g, for BEAMING
 * all of g: at 0.5 light shifts by half as much in log frequency. What bhr_set_effects switches off does not show;
 * bhr_set_preset sets all strengths to 1. Like effects, they change light alone, not g as views, rays and crossings
 * tell it. docs/physics.md.
 * Errors: INVALID_ARGUMENT for no bit, LIGHT_DELAY or an unknown bit, or a strength beyond its range. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_set_effect_strength(BhrContext *context, uint32_t effects, double strength);

/** Reads the strength of the effect whose bit is given, as it is set, whether or not it is switched on.
 * Errors: INVALID_ARGUMENT for other bits than those of bhr_set_effect_strength, or several. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_get_effect_strength(const BhrContext *context, uint32_t effect, double *out_strength);

/** Sets the scene's time in scene lengths; it turns disk, volumes and spots. Default 0. It is the time of the camera's
 * chart at the camera: t, or in chart RAIN, and in STATIC for a camera at or inside a spin-0 horizon, rain time.
 * bhr_camera_advance tells how both go by (docs/cameras.md). */
BHR_NODISCARD BhrStatus bhr_set_time(BhrContext *context, double time);

/** Reads the time as it is set, scene lengths. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_get_time(const BhrContext *context, double *out_time);

/** Sets how long the shutter is open, as scene lengths: from half of it before the scene's time to half of it after.
 * 0 .. 1e300; default 0, one moment. While it is open a pixel's samples (BhrQuality.samples_per_pixel) are moments,
 * evenly over the time, at which disk, volumes and spots are seen through the pixel's middle, so that they blur as
 * they move; one sample sees the middle. Camera and hole are as at the scene's time. More than 1000 M acts as 1000 M.
 * docs/motion-blur.md.
 * Errors: INVALID_ARGUMENT for a value out of range. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_set_shutter(BhrContext *context, double shutter);

/** Reads how long the shutter is open as it is set, scene lengths. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_get_shutter(const BhrContext *context, double *out_shutter);

/* ---- presets: named looks ---- */

/** A named look: values for all of BhrDisk, all of BhrFilm, the effects, and flags and brightness of BhrSky, which
 * setters can then change. Hole, camera, hot spots, time, shutter, view, quality, region, and the sky's orientation,
 * seed and map stay as they are: a host that shows its own map sets BHR_SKY_MAP again. docs/presets.md has the tables
 * of the values. @since 0.2.0 */
typedef int32_t BhrPreset;

/** The default: a golden disk with structure and soft edges, its approaching side nearly white, and glare. */
#define BHR_PRESET_CINEMATIC 0

/** A smooth disk, no glare, no tone curve; light is shown as it is, two stops down, until it clips. */
#define BHR_PRESET_PHYSICAL 1

/** The look of the Event Horizon Telescope's sources: a ring blurred by a beam, in one colour map, on black. */
#define BHR_PRESET_OBSERVATORY 2

/** For lessons: a grid on the sky, and a smooth disk in the colours of its shifts, without beaming and delay. */
#define BHR_PRESET_TEACHING 3

/** The matter that bhr_set_preset_with shows. @since 0.2.0 */
typedef int32_t BhrPresetMatter;

#define BHR_PRESET_MATTER_AUTO 0 /**< DEEP where the adapter is fast enough for it, else THIN. */
#define BHR_PRESET_MATTER_THIN 1 /**< The thin disk, as bhr_set_preset. */
#define BHR_PRESET_MATTER_DEEP 2 /**< One volume in place of the disk; TEACHING has no such look and stays THIN. */

/** Settings of bhr_set_preset_with. @since 0.2.0 */
typedef struct BhrPresetOptions {
    uint32_t struct_size;   /**< sizeof(BhrPresetOptions). */
    BhrPresetMatter matter; /**< BHR_PRESET_MATTER_AUTO (default), _THIN, _DEEP. */
    /** AUTO: the width of the frames that are to be rendered, in pixels, 1 .. 1048576; 0 means the default, 1920. */
    uint32_t width;
    uint32_t height; /**< AUTO: their height, in pixels, 1 .. 1048576; 0 means the default, 1080. */
    /** AUTO: the time that such a frame may take, in milliseconds, 0.001 .. 1e9; 0 means the default, 16. */
    double frame_ms;
    uint32_t measure_anew; /**< AUTO: 1 forgets what was measured for the preset before; 0 (default) keeps it. */
    /** AUTO: 1 takes DEEP at half resolution where FULL is too slow, and sets BhrQuality.volume_resolution to what
     * DEEP fits with; 0 (default) leaves that as it is. */
    uint32_t may_halve;
} BhrPresetOptions;

/** Gives the scene a look, with the thin disk. A volume that bhr_set_preset_with set leaves with the look that it
 * belongs to, unless it was changed since; volumes of the host's own stay. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_set_preset(BhrContext *context, BhrPreset preset);

/** Fills in the defaults. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_preset_options_init(BhrPresetOptions *options, size_t struct_size);

/** Gives the scene a look, and decides its volumes as well: with DEEP the scene has the look's one volume in place
 * of the thin disk, with THIN none. Volumes that were set before are gone; hot spots stay. options NULL: all
 * defaults. *out_matter, unless NULL, becomes BHR_PRESET_MATTER_THIN or _DEEP, whichever the scene has now.
 *
 * THIN and DEEP give the same picture on every machine. AUTO measures, once for each preset and resolution in a
 * context, for about half a second at most, logs at INFO what it took, and may choose otherwise on another machine, or
 * when the machine is busy (docs/presets.md). The call waits for a job that is being rendered. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_set_preset_with(BhrContext *context, BhrPreset preset, const BhrPresetOptions *options,
                                            BhrPresetMatter *out_matter);

/* ---- quality ---- */

/** The way in which light is followed. Frames by different methods differ by less than their errors, which
 * docs/quality.md states: 2e-6 to 2e-5 of look directions and radii on GPUs, which work in single precision, 1e-8
 * by the CPU tracer's ADAPTIVE. */
typedef int32_t BhrMethod;

#define BHR_METHOD_AUTO 0     /**< The fastest: rays are looked up in tables where that pays, else integrated. */
#define BHR_METHOD_RK4 1      /**< Every ray integrated by fixed-step fourth-order Runge-Kutta. */
#define BHR_METHOD_ADAPTIVE 2 /**< Every ray integrated by embedded Runge-Kutta with error control. */

/** The rays along which volumes and hot spots are summed. @since 0.2.0 */
typedef int32_t BhrVolumeResolution;

#define BHR_VOLUME_RESOLUTION_FULL 0 /**< The rays of all pixels. */

/** One ray of each block of 2 x 2 pixels, and those of pixels that interpolation would get wrong. Faster; fine
 * turbulence and thin images may be missed. docs/quality.md states errors. */
#define BHR_VOLUME_RESOLUTION_HALF 1

/** How exactly to trace. */
typedef struct BhrQuality {
    uint32_t struct_size; /**< sizeof(BhrQuality). */
    BhrMethod method;     /**< BHR_METHOD_*. Default AUTO. */
    /** Samples of each pixel, 1 .. 256. Default 1. More than one are weighted by a B-spline 3 pixels wide; in a
     * CUBE they lie evenly in the pixel; while a shutter is open they are moments, all through the pixel's middle.
     * Views other than BHR_VIEW_LIGHT take one. Pixels that an edge runs through get more rays in any case. */
    uint32_t samples_per_pixel;
    /** Steps of an integrated ray, 16 .. 100000. Default 2000. A ray that needs more is BHR_FATE_UNRESOLVED. */
    uint32_t max_steps;
    /** RK4: the step, 1e-3 .. 0.5, in Mino time scaled to the ray (docs/numerics.md); 0 means the default, 0.1. */
    double step;
    /** ADAPTIVE: the relative tolerance, 1e-14 .. 1e-3; 0: the default, 1e-10. Single-precision tracers use their
     * own. */
    double tolerance;
    uint32_t max_disk_order; /**< Images of the disk to follow, 0 .. 15; 0: the direct one only. Default 3. */
    uint32_t reserved;       /**< Reserved: 0. */
    double render_scale;     /**< Windows: traced size / window size, 0.1 .. 1. Default 1. */
    /** BHR_VOLUME_RESOLUTION_*. Default FULL. No effect without volumes and hot spots. @since 0.2.0 */
    BhrVolumeResolution volume_resolution;
    uint32_t reserved2; /**< Reserved: 0. @since 0.2.0 */
} BhrQuality;

/** Fills in the defaults. */
BHR_NODISCARD BhrStatus bhr_quality_init(BhrQuality *quality, size_t struct_size);

/** Sets the quality. */
BHR_NODISCARD BhrStatus bhr_set_quality(BhrContext *context, const BhrQuality *quality);

/** Reads the quality as it is set. */
BHR_NODISCARD BhrStatus bhr_get_quality(const BhrContext *context, BhrQuality *quality);

/* ---- what a pixel shows ---- */

/** The quantity that pixels show. 8-bit formats and windows show it in false colour, without film; R32F holds its
 * value, NaN where there is none. RGBA16F and RGBA32F hold LIGHT only, R32F every view but LIGHT: else rendering is
 * INVALID_ARGUMENT. A backend may lack a view: then rendering is UNSUPPORTED. docs/views.md has the colours. */
typedef int32_t BhrView;

#define BHR_VIEW_LIGHT 0 /**< The picture. The default. */

/** The redshift g of the first crossing within the disk's radii, else that of the sky; NaN where the ray is captured
 * without such a crossing. */
#define BHR_VIEW_REDSHIFT 1

/** The number of the image, 0, 1, 2 ..., of the first crossing within the disk's radii; -1 sky; -2 captured. */
#define BHR_VIEW_ORDER 2

/** The angle between look direction and sky direction, radians; NaN where the ray is captured. */
#define BHR_VIEW_DEFLECTION 3

#define BHR_VIEW_STEPS 4  /**< The integration steps of the pixel's ray; 0 where it was looked up (BHR_METHOD_AUTO). */
#define BHR_VIEW_METRIC 5 /**< -g_tt = 1 - 2 M / r at the first crossing of the equatorial plane; NaN without one. */

/** The optical depth of all volumes and hot spots, as in BhrTransfer; NaN unless the ray escapes. @since 0.2.0 */
#define BHR_VIEW_OPTICAL_DEPTH 6

/** The intensity of volumes and hot spots with a power law, as in BhrTransfer. @since 0.2.0 */
#define BHR_VIEW_INTENSITY 7

/** Sets the view. Default BHR_VIEW_LIGHT. */
BHR_NODISCARD BhrStatus bhr_set_view(BhrContext *context, BhrView view);

/** Reads the view as it is set. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_get_view(const BhrContext *context, BhrView *out_view);

/* ---- parts of a larger frame ---- */

/** The part of a larger frame that an image holds: for tiles, dome walls and render farms. Tiles that are joined
 * have the same bytes as the frame, unless its film needs the light of the whole frame (see bhr_set_region). */
typedef struct BhrRegion {
    uint32_t struct_size; /**< sizeof(BhrRegion). */
    uint32_t full_width;  /**< Pixels of the whole frame, 1 .. 2^20. */
    uint32_t full_height; /**< Pixels of the whole frame, 1 .. 2^20. */
    uint32_t x;           /**< Column of the image's left pixels in the frame, < full_width. */
    uint32_t y;           /**< Row of the image's top pixels in the frame, < full_height. */
    uint32_t reserved;    /**< Reserved: 0. */
} BhrRegion;

/** Sets struct_size and clears the rest: the frame's size has no default. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_region_init(BhrRegion *region, size_t struct_size);

/** Sets the region; NULL: images are whole frames. Images, jobs and camera rays obey it, windows do not.
 * Rendering is INVALID_ARGUMENT for an image that reaches out of the frame (x + width > full_width), and
 * INVALID_STATE for 8- and 10-bit images of light with a film that needs the light of the whole frame: bloom
 * (see there), a beam, spikes, a streak, a flare, auto exposure, highlights or shadows. */
BHR_NODISCARD BhrStatus bhr_set_region(BhrContext *context, const BhrRegion *region);

/** Reads the region as it is set. *out_present becomes 1 with a region; without one it becomes 0, and region gets the
 * values of bhr_region_init. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_get_region(const BhrContext *context, BhrRegion *region, int32_t *out_present);

/* ---- scenes as text ---- */

/** Sets the whole scene from text: everything that setters take, under the names of this header, in TOML, as
 * docs/scenes.md describes it. What it does not name has the value of a new context, or of the preset that it names;
 * values may change with time, and the scene is that of 0 seconds. Frames show all of it or nothing. The text has
 * size bytes of UTF-8, at most 4 MiB. Paths are relative to the current folder. Occluders and callbacks are left
 * alone.
 * Errors, after which the scene is as it was: INVALID_ARGUMENT, with line and column, for text that is no TOML, an
 * unknown name, a value of another type or out of its range, at any of the times that it names; INVALID_STATE and
 * UNSUPPORTED for a camera that cannot move as it is to; IO and those of bhr_set_sky_map for map and LUT.
 * @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_scene_load(BhrContext *context, const char *text, size_t size);

/** Sets the whole scene from a file, as bhr_scene_load does from text. Paths in it are relative to its folder. A struct
 * is a table, a field a line, a constant the end of its name; what changes with time has keys of [seconds, value]:
 * ```toml
 * preset = "cinematic"
 * [hole]
 * spin = { keys = [[0, 0.0], [10, 0.9]] }
 * [camera]
 * motion = "static"
 * orbit = { distance = 20, azimuth = 0, elevation = "8 deg" }
 * ```
 * Errors: those of bhr_scene_load; IO for a file that is not there, not readable, not UTF-8 or larger than 4 MiB.
 * @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_scene_load_file(BhrContext *context, const char *path);

/** Sets the scene to a time, in seconds: what changes with time in the text that was loaded last gets its value of that
 * time, whatever setters have made of it since, and nothing else changes; a camera whose place moves is set as a
 * whole. Before the first key of a value it is the first one's, after the last key the last one's. This is the time of
 * a film; the scene's own time, which bhr_set_time takes, is one of the values that may change with it.
 * Errors, after which the scene is as it was: INVALID_STATE where no scene was loaded, where a camera cannot move as
 * it is to, and where a disk, a volume or a spot that changes is no longer there; INVALID_ARGUMENT for values that
 * leave their range between their keys. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_scene_at(BhrContext *context, double seconds);

/** Reads the pictures that the text that was loaded last asks for: their size in pixels, their number, 1 for one that
 * does not move, and the rate of the film. Picture n, from 0, shows the scene at n / rate seconds. Where the text says
 * nothing of it they are 1920 x 1080, 1 picture, 24 a second. Pointers may be NULL.
 * Errors: INVALID_STATE where no scene was loaded. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_scene_pictures(const BhrContext *context, uint32_t *out_width, uint32_t *out_height,
                                           uint32_t *out_count, double *out_rate);

/** Writes the scene as it is set as text that bhr_scene_load reads back bit by bit: *out_size becomes the length of the
 * text in bytes without the NUL that ends it, and buffer, unless it is NULL, gets both. What changes with time in the
 * text that was loaded last is written as it was read, so that the scene that is read is that of 0 seconds. Occluders
 * are not part of it; paths are absolute.
 * Errors: INVALID_ARGUMENT for a buffer of fewer than *out_size + 1 bytes, which then stays as it was; UNSUPPORTED
 * for a map of the sky or a LUT whose path is not UTF-8, or that has none: one that was set from memory or by
 * bhr_set_sky_target. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_scene_save(const BhrContext *context, char *buffer, size_t size, size_t *out_size);

/** Writes the scene as it is set to a file, as bhr_scene_save does to memory. Paths of a map and a LUT in the file's
 * folder, or below it, are relative to that. A file is replaced as bhr_image_save does it.
 * Errors: UNSUPPORTED as bhr_scene_save; IO. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_scene_save_file(const BhrContext *context, const char *path);

/* ---- rendering into memory ---- */

/** Is told how much of a frame is done: fraction grows from 0 to 1. It returns 0 to cancel, anything else to go on;
 * at 1 the frame is complete and the answer is ignored. It runs inside a bhr_ call only, on the calling thread. */
typedef int32_t (*BhrProgressFn)(void *user, double fraction);

/** Sets the callback that bhr_render_image, bhr_accumulate and bhr_prepare report to, and, inside bhr_job_wait, the
 * jobs that are begun from now on. fn NULL: none (default). */
BHR_NODISCARD BhrStatus bhr_set_progress(BhrContext *context, BhrProgressFn fn, void *user);

/** Renders the scene as it is now into the host's memory and returns when it is there. Until the first pixels are
 * written an error leaves the target alone; after that the message says so, and what is not yet rendered is
 * untouched.
 * Errors: INVALID_ARGUMENT also for a format that does not go with the view, or an image that reaches out of the
 * region's frame; INVALID_STATE where the camera's motion is not possible, for a CUBE whose frame is not 6 times
 * as wide as high, or for bloom, a beam, spikes, a streak, a flare, auto_exposure, highlights or shadows with a
 * region set; UNSUPPORTED inside a spinning hole's horizon in chart STATIC, and at r- (1 + 1e-6); CANCELLED by
 * the progress callback. */
BHR_NODISCARD BhrStatus bhr_render_image(BhrContext *context, const BhrImage *target);

/** Makes everything that frames of the present scene need, so that the next frame is no slower than later ones: GPU
 * programs, tables and the sky. target is an image as bhr_render_image would be given it; its pixels and byte_size
 * are not looked at, and may be 0. For RGBA8_SRGB without BHR_IMAGE_TRANSPARENT, frames in windows of that size are
 * prepared too; NULL: only frames in windows of 1920 x 1080, whatever region is set. The progress callback may
 * cancel it. The call waits for a job that is being rendered, and bhr_frame_stats does not count it. docs/jobs.md
 * says what is made when.
 * Errors: those of bhr_render_image. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_prepare(BhrContext *context, const BhrImage *target);

/* ---- the mean of several frames ---- */

/** Begins to add the light of frames up: for motion blur (the host moves time, camera and bodies between them), depth
 * of field (the camera moves across a lens), or finer pixels. width and height in pixels, flags 0 or
 * BHR_IMAGE_TRANSPARENT, as the image will have it. Frames that were added before are forgotten. Takes 32 bytes a
 * pixel until bhr_end_accumulation, which takes some more; other calls render meanwhile as ever.
 * Errors: INVALID_ARGUMENT for a size that no image has, or an unknown flag; OUT_OF_MEMORY. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_begin_accumulation(BhrContext *context, uint32_t width, uint32_t height, uint32_t flags);

/** Renders a whole frame of the scene as it is now, and adds its light times weight, 0.000001 .. 1000000: always 1 for
 * a shutter that opens and shuts at once. The view must be LIGHT; the film does not matter yet. Up to 65536 frames.
 * After an error nothing is added.
 * Errors: INVALID_STATE without bhr_begin_accumulation, with a region set, or after too many frames; INVALID_ARGUMENT
 * for a weight out of range or another view; those of bhr_render_image. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_accumulate(BhrContext *context, double weight);

/** Develops the weighted mean of the frames that were added, by the film as it is now, into an image of the size and
 * the BHR_IMAGE_TRANSPARENT that they were begun with, on the processor; then forgets them. Auto exposure does not
 * adapt: the mean gets its own exposure. target NULL: forgets the frames, if there are any. After an error they are
 * kept. bhr_frame_stats then has the auto_ev and the cpu_ns of this call.
 * Errors: INVALID_STATE where no frame was added; INVALID_ARGUMENT for another size or transparency, or R32F;
 * OUT_OF_MEMORY. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_end_accumulation(BhrContext *context, const BhrImage *target);

/* ---- rendering in the background ---- */

/** A frame that is rendered in the background. End it with bhr_job_destroy, before or after its context. */
typedef struct BhrJob BhrJob;

/** Begins a job, which renders an image in the background, and returns at once. The scene and the region are taken
 * as they are now; later setters neither change the job nor wait for it. Jobs of a context are made in their order;
 * other calls that render wait for the job that is being traced. At most 64 jobs of a context may be unfinished.
 * target itself is copied; target->pixels is written until the job is done or destroyed, and must stay valid, and
 * be used by nobody else, so long. End *out_job with bhr_job_destroy. docs/jobs.md.
 * Errors: those of bhr_render_image, some of which come from bhr_job_wait instead; INVALID_STATE for too many jobs. */
BHR_NODISCARD BhrStatus bhr_render_image_async(BhrContext *context, const BhrImage *target, BhrJob **out_job);

/** Waits until the job is done, at most timeout_ns nanoseconds: 0 polls, UINT64_MAX waits without limit. NOT_READY:
 * it is still running. OK: the image is complete. *out_fraction, unless NULL, becomes the part that is done, 0 ..
 * 1, by tiles, of which a small frame is one (docs/jobs.md), and 0 after a failure. Meanwhile the progress callback
 * that the context had when the job was begun is called, on this thread.
 * Errors: the job's failure, with its message, each time, which says so if pixels were written: CANCELLED after
 * bhr_job_cancel or by the progress callback, others as bhr_render_image. */
BHR_NODISCARD BhrStatus bhr_job_wait(BhrJob *job, uint64_t timeout_ns, double *out_fraction);

/** Copies the message of the last call that failed on this job, whichever thread it was on, into buffer, as
 * bhr_context_error_message does: after a bhr_job_wait that told of a failure, why the job failed. Returns its
 * length, 0 for NULL. It waits for no other call. @since 0.2.0 */
size_t bhr_job_error_message(const BhrJob *job, char *buffer, size_t size);

/** Asks a job to stop, and does not wait: bhr_job_wait then returns CANCELLED, or OK when the job was done before.
 * NULL is a no-op. Allowed inside callbacks. */
void bhr_job_cancel(BhrJob *job);

/** Cancels a job, waits until it has stopped (a fraction of a frame at most) and frees it; target->pixels is the
 * host's again. Frames for targets (bhr_render_target) go on, but write no image any more. NULL is a no-op. No
 * other thread may use the job any more. From inside a callback it does nothing: bhr_error_message then says so. */
void bhr_job_destroy(BhrJob *job);

/* ---- outputs beside the picture ---- */

#define BHR_MAX_OUTPUTS 8u /**< Outputs of one call at most. @since 0.2.0 */

/** A kind of output. All but LIGHT are numbers of the one ray through a pixel's centre: they are not filtered, and
 * not to be averaged across edges. Scene lengths and axes; crossings are those within the disk's radii, in the
 * order in which the ray from the camera meets them, so that without a disk there are none. Outside a fisheye's
 * circle SKY and TRANSMISSION are 0, the others NaN. @since 0.2.0 */
typedef int32_t BhrOutputKind;

/** The picture, or with BhrView another than LIGHT its values: what bhr_render_image makes, byte for byte, in any
 * format that goes with the view. index: 0. */
#define BHR_OUTPUT_LIGHT 0

/** R32F: the distance from the camera to what the ray meets first: along a straight line to the direct image of the
 * disk; for light of higher orders, and captured rays, to the point of the line of sight that is nearest to the
 * hole, 0 where that lies behind; infinity where the ray escapes without a crossing. Volumes and hot spots have
 * none. A linear depth is this times the cosine of the angle to the forward axis. index: 0. */
#define BHR_OUTPUT_DEPTH 1

/** RGBA32F, the lens map: the unit vector from which the light of the sky comes, and g = nu(camera) / nu(at
 * infinity). All 0 where the ray is captured or unresolved. The disk does not hide it (see TRANSMISSION). index: 0. */
#define BHR_OUTPUT_SKY 2

/** R32F: the share of the sky's light that the disk, volumes and hot spots let pass, 0 .. 1; 0 where the ray is
 * captured. The alpha of a TRANSPARENT picture is 1 less the mean of this over a pixel. index: 0. */
#define BHR_OUTPUT_TRANSMISSION 3

/** RGBA32F: x, y, z of crossing number index, and its order, 0 for the direct image. Without that crossing x, y, z
 * are NaN, and the fourth is -1 where the ray escapes, -2 where it is captured, NaN where it is unresolved. */
#define BHR_OUTPUT_POSITION 4

/** RGBA32F: radius, azimuth, redshift and delay of crossing number index, as in BhrCrossing; NaN without that
 * crossing. The delay is NaN for cameras in chart STATIC at or inside the photon sphere that fall. */
#define BHR_OUTPUT_DISK 5

/** R32F: the value of the view whose BHR_VIEW_* index is, but not LIGHT. Views but REDSHIFT, ORDER and DEFLECTION
 * take as long as a frame of their own. */
#define BHR_OUTPUT_VIEW 6

/** An output and where it goes. Begin with bhr_output_init. @since 0.2.0 */
typedef struct BhrOutput {
    uint32_t struct_size; /**< sizeof(BhrOutput). */
    BhrOutputKind kind; /**< BHR_OUTPUT_*. Default LIGHT. */
    uint32_t index; /**< POSITION, DISK: the number of a crossing, 0 .. 15. VIEW: BHR_VIEW_*. Otherwise 0. Default 0. */
    uint32_t reserved; /**< Reserved: 0. */
    /** The image, in the format of its kind; NULL with target. Of its flags BHR_IMAGE_TRANSPARENT matters for LIGHT
     * only. */
    const BhrImage *image;
    /** A BhrTarget on the GPU instead of image, for bhr_render_outputs_shared of bhr_interop.h; else NULL. */
    void *target;
} BhrOutput;

/** Fills in the defaults. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_output_init(BhrOutput *output, size_t struct_size);

/** Renders several outputs of the scene as it is now: count of them, packed, 1 .. BHR_MAX_OUTPUTS, whose images are
 * of one size; the region, if one is set, is theirs. LIGHT has the bytes that bhr_render_image makes;
 * docs/compositing.md says how exact the others are. out_job NULL: the call returns when all of it is there, and
 * reports to the progress callback. Otherwise *out_job becomes a job as bhr_render_image_async makes them; images
 * are then written until it is done or destroyed. output_size = sizeof(BhrOutput) as the caller was compiled; no
 * output's struct_size may be larger.
 * Errors: those of bhr_render_image, or of bhr_render_image_async; INVALID_ARGUMENT for images of several sizes, a
 * format that does not go with its kind, or a target; UNSUPPORTED for outputs other than LIGHT where BhrCamera.eye
 * has effect. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_render_outputs(BhrContext *context, const BhrOutput *outputs, size_t output_size,
                                           uint32_t count, BhrJob **out_job);

/** Writes outputs that bhr_render_outputs has made to an .exr file: one part with a layer for each, and among its
 * attributes every parameter of the scene that the frame of the first output showed; for pixels that are not of the
 * last 512 images of this context, of the scene as it is now. docs/files.md lists channels and attributes. Alpha is
 * written as it is. A file is replaced as bhr_image_save does it.
 * Errors: INVALID_ARGUMENT as bhr_render_outputs, for two outputs of the same channels, or LIGHT in R32F;
 * UNSUPPORTED for another extension, LIGHT in a format of 8 or 10 bits, or a library that was built without EXR; IO.
 * @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_save_outputs(const BhrContext *context, const BhrOutput *outputs, size_t output_size,
                                         uint32_t count, const char *path);

/* ---- the host's things before the camera ---- */

/** Sets the host's things before the camera, for images of LIGHT that they are seen in: an image of R32F, as large
 * as those images, with each pixel's distance to the host's thing along its line of sight, in scene lengths (not
 * along the forward axis, as depth buffers have it), and infinity where there is nothing. NULL (default): none.
 * docs/compositing.md says what things hide.
 *
 * With BHR_IMAGE_LENSED the things are drawn at their lensed places, and each distance is
 * BhrProjectedPoint.distance at order 0; 1e15 M or more is nothing.
 *
 * With a region the distances are that region's. Windows, views and other outputs do not regard it. While it is
 * set, rendering images of another size is INVALID_ARGUMENT, and on GPUs UNSUPPORTED for sides beyond a texture's
 * (16384, or less).
 * Errors: INVALID_ARGUMENT for another format, NaN, or a distance below 0; the occluder then stays as it was.
 * @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_set_occluder(BhrContext *context, const BhrImage *distances);

/* ---- rendering into windows ---- */

/** A window that a context renders into. It belongs to that context; end it with bhr_surface_destroy, before or
 * after the context, before the window. */
typedef struct BhrSurface BhrSurface;

/** How frames reach the screen. */
typedef int32_t BhrPresentMode;

#define BHR_PRESENT_VSYNC 0     /**< Never torn: a frame waits for the display. Every window has this mode. */
#define BHR_PRESENT_IMMEDIATE 1 /**< Frames are shown at once, and may tear. */
#define BHR_PRESENT_MAILBOX 2   /**< Never torn: the newest frame at the display's rate; older ones are dropped. */

/** Makes a surface of a window, width x height pixels (0 x 0: minimised; else, on X11, the window's own size
 * counts). Call it on the thread that uses the display. A window takes one surface at a time; it and its display
 * must outlive that. Where the context's adapter cannot present to the window, another one does, or frames are put
 * there as memory; the log (info) says which. A host that holds XGrabServer must not call on surfaces. End
 * *out_surface with bhr_surface_destroy. docs/window.md.
 * Errors: INVALID_ARGUMENT for a window that does not exist (X11, Windows), or a side beyond 2^20; INVALID_STATE for a
 * window that has a surface; UNSUPPORTED, with every reason, for a kind of window that this platform or build does
 * not have, where nothing can present, and for sides beyond the device's images (mostly 16384); DEVICE_LOST also
 * for images that do not fit into its memory. */
BHR_NODISCARD BhrStatus bhr_surface_create(BhrContext *context, const BhrWindow *window, uint32_t width,
                                           uint32_t height, BhrPresentMode mode, BhrSurface **out_surface);

/** Tells a surface its window's new size in pixels; 0 x 0: minimised, frames are skipped. Cheap: images of the new
 * size are made by the next frame. X11: frames have the size that the window really has; this call says that it has
 * changed. Wayland: call it also when a window that the host has hidden is shown again; VSYNC frames are skipped
 * until then. Windows: call it on the thread that renders, not on the window's, if these are two: it waits for a
 * frame on its way, which may wait for the window's messages.
 * Errors: INVALID_ARGUMENT for a side beyond 2^20; UNSUPPORTED for one that the device's images cannot have;
 * SURFACE_LOST. */
BHR_NODISCARD BhrStatus bhr_surface_resize(BhrSurface *surface, uint32_t width, uint32_t height);

/** Changes how frames reach the screen, from the next one on. A mode that the window does not have becomes VSYNC.
 * Errors: SURFACE_LOST. */
BHR_NODISCARD BhrStatus bhr_surface_set_present_mode(BhrSurface *surface, BhrPresentMode mode);

/** Renders the scene into the surface's window and presents it, with the film, in sRGB; the region does not count.
 * The frame is traced at BhrQuality.render_scale times the window's size and stretched to it; a CUBE's faces too,
 * if the window is not 6 times as wide as high. Returns when the frame is on its way to the screen. With VSYNC it
 * first waits until the window takes another frame, at most a second, and so do calls on the context and the
 * surface from other threads. FRAME_SKIPPED: the window is 0 x 0, hidden as far as the platform tells, or being
 * resized: wait for its next event, or try again a little later.
 * Errors: INVALID_ARGUMENT for a surface of another context; INVALID_STATE and UNSUPPORTED as bhr_render_image;
 * SURFACE_LOST, from then on, when the window is gone or the context was recovered: destroy the surface. */
BHR_NODISCARD BhrStatus bhr_render_surface(BhrContext *context, BhrSurface *surface);

/** Ends a surface; the window is free for another one. NULL is a no-op; its context may be gone. No other thread may
 * use the surface any more. From inside a callback it does nothing: bhr_error_message then says so. */
void bhr_surface_destroy(BhrSurface *surface);

/* ---- rays: the same tracer, asked directly ---- */

/** A ray, followed backward in time from an observer. It does not grow within one BHR_ABI_VERSION. */
typedef struct BhrRay {
    double position[3]; /**< Scene axes and lengths. */
    /** The direction in which the observer looks, opposite to the photon's momentum; any non-zero length. Components
     * are along the frame that Directions, above, gives, in the chart of the context's camera. */
    double direction[3];
    /** nu(camera) / nu(observer of the local frame), > 0; 1 for an observer at rest in it. Multiplies the hit's
     * redshifts. */
    double frequency_ratio;
} BhrRay;

#define BHR_MAX_CROSSINGS 4 /**< Crossings that a BhrHit lists. */

/** A crossing of the equatorial plane outside the horizon. Within one BHR_ABI_VERSION it does not grow. */
typedef struct BhrCrossing {
    double radius;  /**< Boyer-Lindquist r, scene lengths. */
    double azimuth; /**< Boyer-Lindquist ph in the chart, (-pi, pi], of rays in chart RAIN too. */
    /** g = nu(camera) / nu(emitter on the disk's circular orbit); inside the ISCO that of falling matter with
     * BHR_DISK_PLUNGES, else NaN. */
    double redshift;
    /** Coordinate time since the photon left, scene lengths; NaN from inside the horizon. In chart RAIN: rain time T
     * at the ray's begin less the coordinate time t at which the photon left. */
    double delay;
} BhrCrossing;

/** How a ray ends. */
typedef int32_t BhrFate;

#define BHR_FATE_CAPTURED 0   /**< The ray ends at the horizon. */
#define BHR_FATE_ESCAPED 1    /**< The ray reaches the sky. */
#define BHR_FATE_UNRESOLVED 2 /**< BhrQuality.max_steps ran out. */
#define BHR_FATE_INVALID 3    /**< The ray is not valid: not finite, direction zero, or no frame at its place. */

/** The end of a ray, and its crossings of the equatorial plane. It may grow: bhr_trace_rays is told hit_size. */
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

/** The rays of a width x height frame (with a region: of the image that is this part of it), row by row, through the
 * pixel centres; out_rays has room for width * height. Where a projection shows nothing (outside a FISHEYE's
 * circle): direction 0, frequency_ratio 1, which is traced to BHR_FATE_INVALID. out_rays is left alone by
 * INVALID_ARGUMENT and cleared by other errors.
 * Errors: INVALID_ARGUMENT for a side of 0 or above 2^20, or an image that reaches out of the region's frame;
 * INVALID_STATE and UNSUPPORTED as bhr_render_image. */
BHR_NODISCARD BhrStatus bhr_camera_rays(const BhrContext *context, uint32_t width, uint32_t height, BhrRay *out_rays);

/** One of those rays, at pixel position x, y: (0, 0) is the top-left corner of the frame (with a region: of the
 * image). Outside the frame the image plane, the angles (EQUIRECT) or the nearest face (CUBE) continue.
 * Errors: those of bhr_camera_rays. */
BHR_NODISCARD BhrStatus bhr_camera_ray(const BhrContext *context, uint32_t width, uint32_t height, double x, double y,
                                       BhrRay *out_ray);

/** Traces count rays on the context's backend. The scene's disk does not matter: crossings are those of the bare
 * equatorial plane, down to r+ (1 + 1e-5), and the first BHR_MAX_CROSSINGS are listed. Their emitter moves as the
 * disk's flags say, prograde without a disk; a start in the plane is no crossing. One bad ray is BHR_FATE_INVALID,
 * not an error of the batch. ray_size = sizeof(BhrRay) and hit_size = sizeof(BhrHit) as the caller was compiled, at
 * least 56 and 184; both arrays are packed. A ray that is longer than this library's must be 0 beyond it; a longer
 * hit is cleared there. With count 0 the call does nothing. An error while tracing clears out_hits. */
BHR_NODISCARD BhrStatus bhr_trace_rays(BhrContext *context, const BhrRay *rays, size_t ray_size, size_t count,
                                       BhrHit *out_hits, size_t hit_size);

/** Fills in the curve that a ray follows: x, y, z (scene axes) and t (scene lengths, t <= 0: backward) for each
 * point. out_points has room for 4 capacity doubles. *out_count becomes the number of points: 2 or more, at most
 * capacity, never more than 65536. The last point is the curve's end: just outside the horizon, or, for a ray that
 * escapes, at ten times the observer's radius, but at least 1000 M; a ray that needs more than max_steps ends where
 * they ran out. The curve is traced in double precision on the CPU, whatever the backend.
 * Errors: INVALID_ARGUMENT for capacity < 2, or a ray that is not valid, as from inside a spinning hole's horizon
 * in chart STATIC. */
BHR_NODISCARD BhrStatus bhr_trace_path(BhrContext *context, const BhrRay *ray, uint32_t capacity, double *out_points,
                                       uint32_t *out_count);

/* ---- points on the screen ---- */

#define BHR_MAX_IMAGE_ORDER 3u /**< The highest order that bhr_project_point looks for. @since 0.2.0 */

/** An image of a point: where on the screen it appears, and how. @since 0.2.0 */
typedef struct BhrProjectedPoint {
    uint32_t struct_size; /**< sizeof(BhrProjectedPoint), set by the caller. */
    /** 1: a ray to the point was found. 0: there is none (the point is in the hole, or where the camera is), or it
     * is lost; the numbers are then NaN, the ray's 0. */
    uint32_t found;
    /** 1: it is within the image, whatever matter or sky may be before it. 0: beside it, or not found. */
    uint32_t on_screen;
    uint32_t lost; /**< 1: none was found, though there may be one. */
    /** Pixel position to the right, as of bhr_camera_ray; beyond the image where it is not on the screen. NaN where
     * the projection has no place for the direction: behind a PERSPECTIVE or FRUSTUM. */
    double x;
    double y;   /**< Pixel position downwards, likewise. */
    BhrRay ray; /**< The ray from the camera to the point, on the screen or not: bhr_camera_ray at x, y. */
    /** The solid angle in which the camera, moving as it does, sees something small at the point, over A / distance^2,
     * that without the hole; negative where the image is mirrored. A is its area square to the light, as the ZAMO
     * there measures it (any observer there finds the same); its area in chart coordinates is less near the hole,
     * without spin by sqrt(1 - 2 M / r) where it lies along the radius. It grows without limit near a caustic. */
    double magnification;
    /** Coordinate time (in chart RAIN rain time) since the light left the point, scene lengths; NaN from inside the
     * horizon in chart STATIC. */
    double delay;
    double redshift; /**< g = nu(camera) / nu(observer at rest at the point, with spin the ZAMO). */
    /** The straight distance from the camera to the point, scene lengths: its depth for BHR_OUTPUT_DEPTH and
     * bhr_set_occluder. */
    double distance;
    /** Where the point seems to be, scene axes: as far from the camera as it is, in the direction of its image. A
     * vertex that is drawn here with the camera's own matrices appears at x, y, with the depth that belongs to it. */
    double apparent[3];
} BhrProjectedPoint;

/** Fills in struct_size, which calls that fill the struct read, and what stands for no image. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_projected_point_init(BhrProjectedPoint *point, size_t struct_size);

/** Where in a width x height image (with a region: that is this part of a frame) a point of the scene appears: the
 * inverse of bhr_camera_ray. point: scene axes and lengths. order: how often the light went half round the hole; 0
 * is the direct image, 1 that on the hole's other side, to BHR_MAX_IMAGE_ORDER. Every point outside the horizon has
 * an image of each order, also behind the hole; whether matter is before it is for the host to ask
 * (bhr_trace_rays). Computed in double precision on this thread. docs/cameras.md has times and accuracy, and what
 * becomes of images with spin.
 * Errors: INVALID_STATE for a point farther than 1e15 M; else those of bhr_camera_ray. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_project_point(const BhrContext *context, uint32_t width, uint32_t height,
                                          const double point[3], uint32_t order, BhrProjectedPoint *out_image);

/** bhr_project_point for many points, such as the vertices of a mesh, on as many threads as the machine has cores.
 * points: 3 count doubles, x, y, z of each. image_size: sizeof(BhrProjectedPoint) as the caller was compiled;
 * out_images has room for count, packed, and each gets that size as its struct_size, which need not be set before.
 * A point that is not finite, or farther than 1e15 M, has no image and is no error of the others. With count 0 the
 * call does nothing. Other calls of the context wait until it returns. An error leaves out_images alone.
 * docs/compositing.md.
 * Errors: those of bhr_project_point. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_project_points(const BhrContext *context, uint32_t width, uint32_t height,
                                           const double *points, size_t count, uint32_t order,
                                           BhrProjectedPoint *out_images, size_t image_size);

/* ---- the matter with depth along rays ---- */

/** How the volumes and hot spots along a ray shine, and how much they absorb. nu_camera is the one frequency at
 * which a picture shows power laws (BhrVolume). It may grow: bhr_transfer_rays is told its size. @since 0.2.0 */
typedef struct BhrTransfer {
    BhrFate fate;      /**< BHR_FATE_*. */
    uint32_t reserved; /**< Reserved: 0. */
    /** The specific intensity I_nu of power laws at nu_camera where the ray begins, 0 and up, in units of the
     * emission of 1 M of matter at density 1 that is at rest; brightness and tint do not count, and thermal matter
     * adds none. NaN for a ray that is not valid; a BHR_FATE_UNRESOLVED one has the part as far as it was followed,
     * and so has its light. */
    double intensity;
    /** At nu_camera, of all volumes and hot spots together, 0 and up: of light from behind them the share
     * e^-optical_depth passes. Above 300 the number says only that it is more. NaN unless the ray is
     * BHR_FATE_ESCAPED. */
    double optical_depth;
    /** The light that a picture shows of all volumes and hot spots, linear Rec. 709 before exposure, with
     * brightness, tint and the effects that are set. NaN for a ray that is not valid. */
    double light[3];
} BhrTransfer;

/** Sums the matter of volumes and hot spots along count rays, the thin disk and the sky left out, in double
 * precision on the CPU, whatever the backend; on BHR_BACKEND_CPU on all of its threads, else on the calling one.
 * The scene's time is that of the rays' observers, at rest where they are; hot spots and structure are seen at
 * their retarded time with BHR_EFFECT_LIGHT_DELAY. ray_size = sizeof(BhrRay) and out_size = sizeof(BhrTransfer) as
 * the caller was compiled, at least 56 and 48; otherwise the arrays are as for bhr_trace_rays. An error on the way
 * clears out. docs/matter.md says how exact it is. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_transfer_rays(BhrContext *context, const BhrRay *rays, size_t ray_size, size_t count,
                                          BhrTransfer *out, size_t out_size);

/* ---- bodies in free fall ---- */

/** Whether and where a world line has ended. @since 0.2.0 */
typedef int32_t BhrWorldLineEnd;

#define BHR_WORLD_LINE_GOES_ON 0       /**< The line goes on. */
#define BHR_WORLD_LINE_INNER_HORIZON 1 /**< At r- (1 + 1e-6); without spin in the centre, at r = 1e-9 M. */
#define BHR_WORLD_LINE_HORIZON 2       /**< At r+, within 1e-6 of it: in STATIC, or backward in time. */

/** A body in free fall, at an event. bhr_world_line gives all its fields. @since 0.2.0 */
typedef struct BhrBody {
    uint32_t struct_size; /**< sizeof(BhrBody). */
    BhrChart chart;       /**< BHR_CHART_*; at r <= r+ (1 + 1e-6) RAIN, without spin too. */
    double position[3];   /**< Scene axes and lengths, in that chart. */
    double velocity[3];   /**< v / c against the chart's observer, |v| < 1; components as for a direction. */
    double time;          /**< The chart's time, scene lengths. */
    double proper_time;   /**< Output: scene lengths since the start: as asked for, or of the line's end. */
    BhrWorldLineEnd end;  /**< Output: BHR_WORLD_LINE_*. */
    uint32_t reserved;    /**< Reserved: 0. */
} BhrBody;

/** Sets struct_size and clears the rest: chart STATIC; the position has no default. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_body_init(BhrBody *body, size_t struct_size);

/** Where a body in free fall is, and how it moves, after each of count proper times: scene lengths, any sign and order,
 * within 1e12 M. body_size: sizeof(BhrBody) as the caller was compiled; out_bodies has room for count, packed, each
 * in body's chart, and gets that size as its struct_size; body may be one of them. A line that ends before gives its
 * end. With count 0 the call does nothing. Computed in double precision on this thread; other calls of the context
 * wait until it returns. Errors of body, of a time and of the line clear out_bodies, others leave them alone.
 * docs/cameras.md.
 * Errors: INVALID_ARGUMENT for a place beyond 1e12 M; UNSUPPORTED for one that the chart does not hold, or at or
 * inside r- (1 + 1e-6), and for lines of more than 300,000 steps. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_world_line(const BhrContext *context, const BhrBody *body, const double *proper_times,
                                       size_t count, BhrBody *out_bodies, size_t body_size);

/* ---- numbers about the last finished frame ---- */

/** Numbers about the last finished frame; all 0 before the first. Times in nanoseconds. */
typedef struct BhrFrameStats {
    uint32_t struct_size; /**< sizeof(BhrFrameStats), set by the caller. */
    uint32_t reserved;    /**< Reserved: 0. */
    /** Counts the finished frames of a context from 1: images, jobs, windows, and each call that accumulates or ends.
     */
    uint64_t frame_index;
    uint64_t rays;         /**< Pixels times samples. */
    uint64_t steps;        /**< Integration steps of all rays; rays that were looked up take none. */
    uint64_t cpu_ns;       /**< From the call's beginning to its end; for a job, from its request until it was done. */
    uint64_t gpu_ns;       /**< Time on the GPU; 0 where the adapter has no timestamps, or traces on the CPU. */
    uint64_t readback_ns;  /**< Time to copy pixels into the host's memory, without the wait for the GPU. */
    uint64_t device_bytes; /**< Device memory that the context holds. */
    /** Lens tables made for this frame: 0 where those of an earlier one served, or none were needed. @since 0.2.0 */
    uint64_t lens_tables;
    /** Stops that auto exposure (BhrFilm.auto_exposure) added to the film's exposure_ev; 0 without it. @since 0.2.0 */
    double auto_ev;
} BhrFrameStats;

/** Sets struct_size, which calls that fill the struct read, and clears the rest. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_frame_stats_init(BhrFrameStats *stats, size_t struct_size);

/** Numbers about the context's last finished frame. */
BHR_NODISCARD BhrStatus bhr_frame_stats(const BhrContext *context, BhrFrameStats *stats);

/** Numbers about the frame of a job that is done.
 * Errors: INVALID_STATE for a job that is not done, or that failed. */
BHR_NODISCARD BhrStatus bhr_job_stats(const BhrJob *job, BhrFrameStats *stats);

#ifdef __cplusplus
}
#endif

/**
 * BHR_INIT(camera); is bhr_camera_init(&camera, sizeof camera); and likewise for a variable of every other struct that
 * begins with struct_size: the variable's type says which. It takes no pointer: write BHR_INIT(*camera). It gives no
 * status, because it cannot fail. A program that must run with an older library, which may lack the _init function,
 * sets such a struct up itself. For C++, C from C11 on, and GCC's and Clang's C99; elsewhere it is not defined.
 * @since 0.2.0
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
    EACH(BhrBody, bhr_body_init) \
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
