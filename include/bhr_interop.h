/* bhr_interop.h -- frames that stay on the GPU: the part of bhr's C API for hosts that have a GPU of their own.
 * SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Made by cbindgen from the Rust sources in src/capi; do not edit. Experimental: what is here may change in a
 * release that does not change BHR_ABI_VERSION. What bhr.h says about errors, structs, pointers and threads holds
 * here too. No header of a graphics API is included: dispatchable handles are void *, VkImage and VkSemaphore
 * uint64_t, file descriptors int32_t.
 *
 * Two ways
 *   Shared memory: bhr has a device of its own on the host's GPU, and memory and semaphores are passed as handles of
 *   the operating system. Works with Vulkan, CUDA and OpenGL and between processes, asks nothing of how the host
 *   makes its device, needs no locks. Begin with this one: bhr_adapter_find, bhr_target_create, bhr_target_export.
 *   The host's device: bhr works on the host's VkDevice, in the host's own images: bhr_vulkan_requirements,
 *   bhr_context_create_vulkan, bhr_target_wrap_vulkan. The host must enable what bhr asks for, and lock its queue.
 *
 * Order of work
 *   A frame is submitted by bhr_render_target and runs on the GPU after every wait of its BhrSync; then it signals. The
 *   host waits for the signal before it reads the target, and signals in its turn when it has read it, which is what
 *   the next frame into this target waits for. Values of timelines grow with each signal, and a wait may be submitted
 *   before its signal. Each signal of a binary semaphore is waited for exactly once, and must have been submitted
 *   before the wait is. Frames of a context run one after another: a wait holds up all its later frames. One that is
 *   not signalled within 60 s loses the device (BHR_ERROR_DEVICE_LOST); other contexts go on.
 *
 * Layouts
 *   A frame overwrites all pixels of its target. Images are left in BhrTargetInfo.layout; those for OPAQUE_FD, buffers
 *   too, are released to VK_QUEUE_FAMILY_EXTERNAL, and a Vulkan host acquires them with the same layouts and families
 *   before it reads. To give an image back needs no barrier, only the semaphore, because bhr begins from
 *   VK_IMAGE_LAYOUT_UNDEFINED; a buffer whose bytes between rows matter is released to VK_QUEUE_FAMILY_EXTERNAL. On the
 *   host's device no family changes. After CANCELLED or an error the contents are undefined.
 *
 * Lifetimes
 *   A handle that bhr gives is the host's: to be passed to an import that takes it over, or closed. A file
 *   descriptor that the host gives is bhr's after OK, and the host's after an error. Memory lives until both sides
 *   have let go of it.
 *   Targets and semaphores belong to their context and must be destroyed, before or after it. After DEVICE_LOST and
 *   bhr_context_recover calls on them are BHR_ERROR_SURFACE_LOST: destroy them and make them again.
 */

#ifndef BHR_INTEROP_H
#define BHR_INTEROP_H

#include "bhr.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- what can be shared ---- */

/** A kind of handle that memory or a semaphore is passed by; the constants are bits. */
typedef uint32_t BhrHandleType;

/** Linux, Android: a file descriptor of the driver's, for the same driver only: Vulkan, CUDA, OpenGL. Any format. */
#define BHR_HANDLE_OPAQUE_FD 1u

/** Linux: a dma-buf, for EGL, GBM, Wayland, VA-API. Not built in yet: in no bits of BhrInteropInfo. */
#define BHR_HANDLE_DMA_BUF 2u

#define BHR_HANDLE_OPAQUE_WIN32 4u   /**< Windows: an NT handle of Vulkan's. Not built in yet. */
#define BHR_HANDLE_D3D12 8u          /**< Windows: an NT handle of a D3D12 resource or fence. Not built in yet. */
#define BHR_HANDLE_D3D11_TEXTURE 16u /**< Windows: an NT handle of a D3D11 texture. Not built in yet. */

/** macOS, iOS: an IOSurfaceRef as memory, an MTLSharedEvent as semaphore. Not built in yet. */
#define BHR_HANDLE_APPLE 32u

/** The host's own pixels, for bhr_target_import of buffers: BhrHandle.handle is their address. Address and
 * allocation_size are multiples of the device's minImportedHostPointerAlignment (4096 or 65536). They stay the
 * host's, must stay mapped until the target is destroyed and its frames are done, and are read after the frame's
 * job or signal. docs/gpu.md. */
#define BHR_HANDLE_HOST_POINTER 64u

/** The ways in which a context's device can share. All bits 0: the CPU tracer, OpenGL, Metal, Direct3D 12, or a
 * driver without the extensions; use bhr_render_image. @since 0.2.0 */
typedef struct BhrInteropInfo {
    uint32_t struct_size; /**< sizeof(BhrInteropInfo), set by the caller. */
    uint32_t export_images; /**< BHR_HANDLE_* bits that bhr_target_create gives for images. */
    uint32_t export_buffers; /**< BHR_HANDLE_* bits that bhr_target_create gives for buffers. */
    uint32_t import_images; /**< BHR_HANDLE_* bits that bhr_target_import takes for images. */
    uint32_t import_buffers; /**< BHR_HANDLE_* bits that bhr_target_import takes for buffers. */
    uint32_t semaphores[2]; /**< By BhrSemaphoreKind: BHR_HANDLE_* bits that semaphores are exported and imported by. */
    uint32_t luid_valid; /**< 1: luid is known, which it is on Windows. */
    uint8_t device_uuid[16]; /**< Vulkan's deviceUUID, GL_DEVICE_UUID_EXT, what cuDeviceGetUuid gives. 0: not known. */
    /** Vulkan's driverUUID, GL_DRIVER_UUID_EXT. OPAQUE handles go between equal pairs of both UUIDs only. */
    uint8_t driver_uuid[16];
    uint8_t luid[8];   /**< The adapter's LUID, as DXGI and cuDeviceGetLuid give it. */
    int64_t drm_major; /**< Linux: major number of the DRM render node, /dev/dri/renderD*; -1: not known. */
    int64_t drm_minor; /**< Its minor number; -1: not known. */
} BhrInteropInfo;

/** Sets struct_size and clears the rest. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_interop_info_init(BhrInteropInfo *info, size_t struct_size);

/** Fills in info for the context's device. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_interop_info(const BhrContext *context, BhrInteropInfo *info);

/** Finds the adapter to make a context on so that it can share with the host's device, for
 * BhrContextOptions.adapter_index (bhr_context_options_init sets the others). uuid is a deviceUUID of 16 bytes or
 * NULL, luid a LUID of 8 bytes or NULL; one of them at least is given, and both count that are. *out_index is -1
 * after an error.
 * Errors: NO_ADAPTER when bhr has none through Vulkan on that device. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_adapter_find(const uint8_t *uuid, const uint8_t *luid, int32_t *out_index);

/* ---- targets ---- */

/** A picture on the GPU that both sides reach. It belongs to its context; end it with bhr_target_destroy, before or
 * after the context. Frames into one target take turns. */
typedef struct BhrTarget BhrTarget;

/** The substance of a target. */
typedef int32_t BhrTargetKind;

#define BHR_TARGET_IMAGE 0  /**< A 2-D image, tiled as the driver likes: for sampling and drawing. */
#define BHR_TARGET_BUFFER 1 /**< Rows in linear memory: for CUDA, tensors, video encoders. */

/** BhrTargetOptions.flags, of wrapped images: frames are made in a buffer of bhr's and copied into the image on the
 * GPU, so that it needs TRANSFER_DST usage instead of STORAGE: any tiling, images of swapchains, BGRA8_SRGB. */
#define BHR_TARGET_COPY 256u

/** A target. Its first row is the picture's top one. Fill in with bhr_target_options_init first. @since 0.2.0 */
typedef struct BhrTargetOptions {
    uint32_t struct_size; /**< sizeof(BhrTargetOptions). */
    BhrTargetKind kind;   /**< Default IMAGE. */
    /** BHR_FORMAT_*. Default RGBA8_SRGB: an image is VK_FORMAT_R8G8B8A8_UNORM and holds sRGB codes, and the host may
     * view it as _SRGB, because images are made with MUTABLE_FORMAT. Images of BGRA8_SRGB are filled by a copy on
     * the GPU. */
    BhrFormat format;
    uint32_t width;  /**< Pixels, 1 .. 2^20. */
    uint32_t height; /**< Pixels, 1 .. 2^20. */
    uint32_t flags;  /**< BHR_IMAGE_TRANSPARENT, for LIGHT; BHR_TARGET_COPY, for wrapped images. Default 0. */
    /** The one kind of handle that the target's memory is passed by; 0 (default): none, for hosts on the same
     * VkDevice (bhr_target_vulkan). */
    BhrHandleType handle_type;
    /** VkImageLayout that frames leave an image in; 0 (default): VK_IMAGE_LAYOUT_GENERAL (1), as OpenGL and CUDA
     * want it. */
    int32_t layout;
    /** BUFFER: bytes from row to row, a multiple of 4; 0 (default): packed. Bytes between rows are not written. */
    uint64_t row_stride;
} BhrTargetOptions;

/** Fills in the defaults. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_target_options_init(BhrTargetOptions *options, size_t struct_size);

/** The numbers with which the other side imports a target. @since 0.2.0 */
typedef struct BhrTargetInfo {
    uint32_t struct_size; /**< sizeof(BhrTargetInfo), set by the caller. */
    BhrTargetKind kind;   /**< BHR_TARGET_*. */
    uint32_t width;       /**< Pixels. */
    uint32_t height;      /**< Pixels. */
    uint32_t vk_format;   /**< VkFormat of an image; 0 of a buffer. */
    /** VkImageUsageFlags or VkBufferUsageFlags: a VkImage that imports the memory must be created with the same. */
    uint32_t vk_usage;
    uint32_t vk_flags;  /**< VkImageCreateFlags: the same. */
    uint32_t vk_tiling; /**< VkImageTiling: the same. */
    int32_t layout;     /**< VkImageLayout after a frame. */
    /** 1: the memory is a dedicated allocation and must be imported as one (VkMemoryDedicatedAllocateInfo,
     * CUDA_EXTERNAL_MEMORY_DEDICATED, GL_DEDICATED_MEMORY_OBJECT_EXT). */
    uint32_t dedicated;
    uint32_t memory_type; /**< Index of the memory type in the device's list; the importer needs the same one. */
    uint32_t reserved;    /**< Reserved: 0. */
    /** Bytes of the whole allocation: allocationSize, and the size for CUDA and glImportMemoryFdEXT. */
    uint64_t allocation_size;
    uint64_t offset;     /**< Bytes from its begin to the target's. */
    uint64_t row_stride; /**< Bytes from row to row of a buffer. */
} BhrTargetInfo;

/** A handle on its way. @since 0.2.0 */
typedef struct BhrHandle {
    BhrHandleType type; /**< One BHR_HANDLE_* bit. */
    int32_t fd;         /**< OPAQUE_FD: the file descriptor; else -1. */
    void *handle;       /**< HOST_POINTER: the address; else NULL. */
} BhrHandle;

/** Makes a target in memory of bhr's. End *out_target with bhr_target_destroy.
 * Errors: INVALID_ARGUMENT also for a layout that an image cannot be left in; UNSUPPORTED for what the device
 * cannot make or share (format, kind, handle_type or side, which the message says), and always on the CPU tracer,
 * OpenGL, Metal and Direct3D 12. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_target_create(BhrContext *context, const BhrTargetOptions *options, BhrTarget **out_target);

/** Makes a target in memory of the host's. options describe the target (its handle_type is 0 or the handle's),
 * memory what is behind handle: allocation_size, offset, memory_type, dedicated, and for images vk_usage, vk_flags
 * and vk_tiling, with which the host created its VkImage: 2-D, one mip level, one layer, one sample, of the
 * target's size and format. An image needs STORAGE usage where bhr can store to its format, else TRANSFER_DST.
 * OPAQUE_FD: the descriptor is bhr's after OK, and the host's after an error. HOST_POINTER: memory_type and
 * dedicated do not count.
 * Errors: those of bhr_target_create; INVALID_ARGUMENT also for a descriptor that is not open or is no memory, and
 * for memory that is too small, ill placed, or of a type that the target cannot have. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_target_import(BhrContext *context, const BhrTargetOptions *options,
                                          const BhrTargetInfo *memory, const BhrHandle *handle, BhrTarget **out_target);

/** Sets struct_size and clears the rest. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_target_info_init(BhrTargetInfo *info, size_t struct_size);

/** Fills in info. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_target_info(const BhrTarget *target, BhrTargetInfo *info);

/** Gives a new handle of the target's memory, which is the host's: to be imported by what takes it over, or closed.
 * The memory lives until both sides have let go of it.
 * Errors: INVALID_STATE for a target that was not made for export; SURFACE_LOST. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_target_export(BhrTarget *target, BhrHandle *out_handle);

/** Gives the VkImage or the VkBuffer of a target, and 0 for the other, to a host on the same VkDevice. They live as
 * long as the target does. NULL: not wanted.
 * Errors: SURFACE_LOST. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_target_vulkan(const BhrTarget *target, uint64_t *out_image, uint64_t *out_buffer);

/** Ends a target and returns at once; its memory goes when the GPU has done with it. NULL is a no-op; its context
 * may be gone. No other thread may use the target any more. From inside a callback it does nothing:
 * bhr_error_message then says so. @since 0.2.0 */
void bhr_target_destroy(BhrTarget *target);

/* ---- semaphores ---- */

/** A semaphore that both sides reach. It belongs to its context; end it with bhr_semaphore_destroy, before or after
 * the context. */
typedef struct BhrSemaphore BhrSemaphore;

/** A semaphore's kind. */
typedef int32_t BhrSemaphoreKind;

#define BHR_SEMAPHORE_TIMELINE 0 /**< Has a value, which grows: Vulkan, CUDA, GL_NV_timeline_semaphore. */
#define BHR_SEMAPHORE_BINARY 1   /**< Each signal is waited for exactly once, after it was submitted: Vulkan, OpenGL. */

/** Makes a semaphore: of value 0, or not signalled. handle_type is the one handle that it is exported by; 0: none,
 * for hosts on the same VkDevice, and for bhr_semaphore_wait. End *out_semaphore with bhr_semaphore_destroy.
 * Errors: UNSUPPORTED for a handle that such semaphores are not exported by here, and always on the CPU tracer,
 * OpenGL, Metal and Direct3D 12. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_semaphore_create(BhrContext *context, BhrSemaphoreKind kind, BhrHandleType handle_type,
                                             BhrSemaphore **out_semaphore);

/** Gives a new handle of a semaphore, which is the host's: to be imported by what takes it over, or closed.
 * Errors: INVALID_STATE for one that was not made for export; SURFACE_LOST. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_semaphore_export(BhrSemaphore *semaphore, BhrHandle *out_handle);

/** Makes a semaphore of one of the host's, which is of this kind. The descriptor in handle is bhr's after OK, and
 * the host's after an error.
 * Errors: those of bhr_semaphore_create; INVALID_ARGUMENT also for a descriptor that is not open or is no
 * semaphore. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_semaphore_import(BhrContext *context, BhrSemaphoreKind kind, const BhrHandle *handle,
                                             BhrSemaphore **out_semaphore);

/** Gives the VkSemaphore to a host on the same VkDevice. It lives as long as the semaphore does.
 * Errors: SURFACE_LOST. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_semaphore_vulkan(const BhrSemaphore *semaphore, uint64_t *out_semaphore);

/** Waits on the CPU until a TIMELINE has reached value, at most timeout_ns nanoseconds: 0 looks, UINT64_MAX waits
 * without limit. NOT_READY: it has not.
 * Errors: UNSUPPORTED for a BINARY one; SURFACE_LOST when the context ends meanwhile. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_semaphore_wait(BhrSemaphore *semaphore, uint64_t value, uint64_t timeout_ns);

/** Signals a TIMELINE on the CPU.
 * Errors: INVALID_ARGUMENT for a value that is not greater than the present one, or not smaller than one that a
 * frame under way will signal; UNSUPPORTED for a BINARY one; SURFACE_LOST. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_semaphore_signal(BhrSemaphore *semaphore, uint64_t value);

/** Ends a semaphore and returns at once; bhr keeps it for the frames that were submitted with it. NULL is a no-op;
 * its context may be gone. No other thread may use it any more. From inside a callback it does nothing:
 * bhr_error_message then says so. @since 0.2.0 */
void bhr_semaphore_destroy(BhrSemaphore *semaphore);

/* ---- rendering into targets ---- */

/** A semaphore and a value of it. @since 0.2.0 */
typedef struct BhrSemaphoreValue {
    BhrSemaphore *semaphore; /**< One of the context that renders. */
    uint64_t value;          /**< TIMELINE: the value to wait for, or to signal. BINARY: ignored. */
} BhrSemaphoreValue;

/** The semaphores that a frame waits for before it reads the targets of occluder and sky and writes its own, and
 * those that it signals when it has done both. @since 0.2.0 */
typedef struct BhrSync {
    uint32_t struct_size;             /**< sizeof(BhrSync). */
    uint32_t wait_count;              /**< Entries of waits, 0 .. 8. */
    uint32_t signal_count;            /**< Entries of signals, 0 .. 8. */
    uint32_t reserved;                /**< Reserved: 0. */
    const BhrSemaphoreValue *waits;   /**< All of them are waited for; NULL where wait_count is 0. */
    const BhrSemaphoreValue *signals; /**< All of them are signalled; NULL where signal_count is 0. */
} BhrSync;

/** Sets struct_size and clears the rest: nothing is waited for or signalled. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_sync_init(BhrSync *sync, size_t struct_size);

/** Renders the scene as it is now into a target, and returns when the frame is submitted (docs/gpu.md). sync NULL:
 * no semaphores; then the host waits with the job. out_job NULL: no job; else the job ends when the GPU has made
 * the frame, with bhr_job_wait and bhr_job_stats as of images. bhr_job_cancel does not stop what is submitted, and
 * bhr_job_destroy neither cancels it nor waits for it. At most 64 frames and jobs may be unfinished. The region
 * counts. After an error no semaphore is waited for or signalled, unless steps were submitted: then all are.
 * Errors: those of bhr_render_image; INVALID_ARGUMENT for a target or semaphore of another context, a semaphore
 * that is twice in a list, and a signal whose value does not grow; INVALID_STATE for too many frames; UNSUPPORTED
 * for rows that kernels do not reach, and where BhrCamera.eye has effect; SURFACE_LOST. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_render_target(BhrContext *context, BhrTarget *target, const BhrSync *sync,
                                          BhrJob **out_job);

/** bhr_render_target as a job of bhr's threads, in their order, as bhr_render_image_async: the scene, the region and
 * the semaphores are taken as they are now, and the call returns at once. Only TIMELINE semaphores: a BINARY one is
 * INVALID_ARGUMENT. bhr_job_cancel stops what is not submitted, and bhr_job_destroy neither cancels nor waits.
 * Whatever becomes of the frame, its semaphores are waited for and signalled when its turn comes, unless the device
 * is lost. A host on whose own queue bhr works must not submit to that queue what waits for a frame before the
 * frame is submitted (docs/gpu.md). out_job NULL: no job.
 * Errors: those of bhr_render_target, some of which come from bhr_job_wait instead. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_render_target_async(BhrContext *context, BhrTarget *target, const BhrSync *sync,
                                                BhrJob **out_job);

/** Renders outputs of the scene as it is now (BhrOutput of bhr.h), each into its BhrOutput.target or its
 * BhrOutput.image, in one frame and with one set of semaphores. Otherwise as bhr_render_target; the bytes are those
 * of bhr_render_outputs. LIGHT, at most one, goes into any target that bhr_render_target takes, the others into
 * R32F or RGBA32F by their kind: a BUFFER, or an IMAGE with STORAGE usage. All places are of one size. Outputs with
 * an image need out_job, and are complete when bhr_job_wait says OK (docs/gpu.md).
 * Errors: those of bhr_render_target and of bhr_render_outputs; INVALID_ARGUMENT for an output without a place, or
 * with two, a target that is there twice, and views but REDSHIFT, ORDER and DEFLECTION (render them as LIGHT);
 * UNSUPPORTED for an output other than LIGHT in an image that a copy fills, and for more targets than a kernel of
 * the device binds. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_render_outputs_shared(BhrContext *context, const BhrOutput *outputs, size_t output_size,
                                                  uint32_t count, const BhrSync *sync, BhrJob **out_job);

/** bhr_render_outputs_shared as a job of bhr's threads, with TIMELINE semaphores only, as bhr_render_target_async.
 * Errors: those of both. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_render_outputs_shared_async(BhrContext *context, const BhrOutput *outputs,
                                                        size_t output_size, uint32_t count, const BhrSync *sync,
                                                        BhrJob **out_job);

/* ---- the host's things, from a target ---- */

/** bhr_set_occluder with distances on the GPU: target is one of R32F, made, imported or wrapped, of the frames'
 * size, that frames of LIGHT read anew each time, after every wait of their BhrSync. NULL: none; each of the two
 * functions replaces what the other has set. flags: 0, or BHR_IMAGE_LENSED. A buffer may have any row_stride. The
 * target must stay as long as it is set, and cannot be a frame's target as well: after bhr_target_destroy or
 * bhr_context_recover frames are SURFACE_LOST, until another occluder or NULL is set. Numbers on the GPU cannot be
 * checked: NaN hides nothing, and what is below 0 everything. docs/gpu.md says in which layout it is read.
 * Errors: INVALID_ARGUMENT for another format, or a target of another context; UNSUPPORTED for sides beyond the
 * device's textures (16384, or less), and for an image without TRANSFER_SRC usage; SURFACE_LOST; the occluder then
 * stays as it was. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_set_occluder_target(BhrContext *context, BhrTarget *target, uint32_t flags);

/* ---- the sky, from a target ---- */

/** bhr_set_sky_map with a picture on the GPU: target is an equirectangular one of RGBA16F or RGBA32F, made, imported
 * or wrapped, as wide as high at least, of 16384 x 8192 texels at most, laid out as bhr_set_sky_map has it, that
 * frames with BHR_SKY_MAP, in windows too, read anew each time. NULL: none; each of the functions replaces what
 * another has set. When and how it is read, and how long it must stay, is as with bhr_set_occluder_target
 * (docs/gpu.md). It cannot be a frame's target as well. A buffer may have any row_stride.
 * Errors: INVALID_ARGUMENT for another format or shape, or a target of another context; UNSUPPORTED for an image
 * without TRANSFER_SRC usage, and for a map that is larger than the device's textures (it takes one and a half
 * times its rows); SURFACE_LOST; the map then stays as it was. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_set_sky_target(BhrContext *context, BhrTarget *target);

/** bhr_set_sky_target of a picture in another layout: EQUIRECT is bhr_set_sky_target, CUBE six faces side by side, 6
 * times as wide as high, at most 2730 texels a side, as a picture with BHR_PROJECTION_CUBE of a camera that looks
 * along +x of the sky axes (right ascension 0) with +z (the north pole) up. docs/gpu.md.
 * Errors: those of bhr_set_sky_target; INVALID_ARGUMENT for another layout; UNSUPPORTED for rows so far apart that
 * a kernel's six bindings, of 128 MiB at least, do not hold them. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_set_sky_target_as(BhrContext *context, BhrTarget *target, BhrProjection layout);

/* ---- the host's Vulkan device ---- */

/** vkGetInstanceProcAddr, cast to this type. */
typedef void (*BhrGetInstanceProcAddr)(void);

/** Locks or unlocks the host's queue for the calling thread, which may be one of bhr's. It must not call bhr. */
typedef void (*BhrQueueLockFn)(void *user);

/** Tells the host that bhr uses one of its objects no more. It runs inside a bhr_ call or on a thread of bhr's, and
 * must not call bhr. */
typedef void (*BhrReleaseFn)(void *user);

/** The needs of bhr on an instance and a device of the host's. All that it points to is the library's and never
 * freed. @since 0.2.0 */
typedef struct BhrVulkanRequirements {
    uint32_t struct_size; /**< sizeof(BhrVulkanRequirements), set by the caller. */
    /** VkApplicationInfo.apiVersion at least: VK_API_VERSION_1_3, or the version of a device that has 1.2. */
    uint32_t api_version;
    const char *const *instance_extensions; /**< Names for VkInstanceCreateInfo, which must be enabled. */
    uint32_t instance_extension_count;      /**< How many. */
    uint32_t device_extension_count;        /**< How many device_extensions has. */
    /** Names for VkDeviceCreateInfo, which must be enabled (but for VK_KHR_external_semaphore_fd,
     * VK_EXT_queue_family_foreign and VK_EXT_external_memory_host, which add to BhrInteropInfo only). */
    const char *const *device_extensions;
    /** A VkPhysicalDeviceFeatures2 with its chain: features that must be on. It may be the pNext of
     * VkDeviceCreateInfo as it is; a host with features of its own ORs them in (where it has
     * VkPhysicalDeviceVulkan1xFeatures, into those: Vulkan forbids both). NULL without a physical device. */
    const void *features;
} BhrVulkanRequirements;

/** A Vulkan device of the host's. Cleared (memset) and filled in by the host. @since 0.2.0 */
typedef struct BhrVulkanDevice {
    uint32_t struct_size; /**< sizeof(BhrVulkanDevice). */
    uint32_t api_version; /**< VkApplicationInfo.apiVersion as vkCreateInstance was told, not what the loader has. */
    BhrGetInstanceProcAddr get_instance_proc_addr; /**< vkGetInstanceProcAddr. */
    void *instance; /**< VkInstance. */
    void *physical_device; /**< VkPhysicalDevice. */
    void *device; /**< VkDevice. */
    uint32_t queue_family; /**< The family of a queue with GRAPHICS and COMPUTE, which the device was created with. */
    uint32_t queue_index; /**< Its index in the family. */
    /** Names of the extensions that the instance has enabled. Read during the call only. */
    const char *const *instance_extensions;
    /** Names of the extensions that the device has enabled. Read during the call only. */
    const char *const *device_extensions;
    uint32_t instance_extension_count; /**< How many. */
    uint32_t device_extension_count;   /**< How many. */
    /** Called before and after all that bhr does to the queue (vkQueueSubmit, vkQueuePresentKHR, vkQueueWaitIdle),
     * from any thread, never nested. The host takes the same lock around its own use of the queue, and around
     * vkDeviceWaitIdle; it must not hold it while it calls bhr. NULL, both: nobody else uses the queue while a bhr_
     * call of this context runs or a job of it is unfinished. docs/gpu.md. */
    BhrQueueLockFn lock;
    BhrQueueLockFn unlock; /**< See lock. */
    void *lock_user;       /**< Handed to lock and unlock. */
    /** Called when device and instance may be destroyed. NULL: when bhr_context_destroy has returned. */
    BhrReleaseFn release;
    void *release_user; /**< Handed to release. */
} BhrVulkanDevice;

/** Sets struct_size and clears the rest. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_vulkan_requirements_init(BhrVulkanRequirements *requirements, size_t struct_size);

/** Says what bhr needs; physical_device NULL: of an instance only, and then instance may be NULL too. instance must
 * have been made with instance_extensions and api_version. A device that was made with all features and extensions
 * that the physical device has serves as well.
 * Errors: INVALID_ARGUMENT for a function that finds no functions, or a physical device that is not the instance's;
 * UNSUPPORTED, with the reason, for a physical device that cannot serve (Vulkan before 1.2, a first queue family
 * without GRAPHICS, too low limits), and on macOS and iOS. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_vulkan_requirements(BhrGetInstanceProcAddr get_instance_proc_addr, void *instance,
                                                void *physical_device, BhrVulkanRequirements *requirements);

/** Sets struct_size and clears the rest. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_vulkan_device_init(BhrVulkanDevice *device, size_t struct_size);

/** Makes a context, as bhr_context_create does, that works on a device of the host's: its frames go into the host's
 * own images. The device must have what bhr_vulkan_requirements says; a missing extension is found, and named, a
 * missing feature cannot be. Instance, device and queue must live until the release callback, or, without one,
 * until bhr_context_destroy has returned. options: backend AUTO or VULKAN, adapter_index -1, no
 * BHR_CONTEXT_VALIDATION, compatible_window NULL; NULL means all defaults. bhr_context_recover is UNSUPPORTED on
 * such a context: after DEVICE_LOST destroy it, and make the device anew. docs/gpu.md.
 * Errors: those of bhr_context_create; INVALID_ARGUMENT for what is not as it must be; UNSUPPORTED for a device
 * that cannot serve. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_context_create_vulkan(uint32_t abi_version, const BhrContextOptions *options,
                                                  const BhrVulkanDevice *device, BhrContext **out_context);

/** Makes a target of a VkImage of a host whose device the context is on. The image: 2-D, one sample, one mip level
 * and layer, of the size and format of options (RGBA8_SRGB: R8G8B8A8_UNORM; BGRA8_SRGB: B8G8R8A8_UNORM, with
 * BHR_TARGET_COPY), SHARING_MODE_EXCLUSIVE or concurrent with bhr's family. vk_usage is what it was created with:
 * STORAGE, or TRANSFER_DST for BHR_TARGET_COPY. options->kind is IMAGE and handle_type 0; frames leave the image in
 * options->layout, in bhr's queue family, and take it from any layout, without its contents. release, unless NULL,
 * is called when bhr uses the image no more; without one the image must live until bhr_context_destroy has
 * returned.
 * Errors: INVALID_STATE for a context that is not on a host's device; UNSUPPORTED for an image that the device does
 * not have so. release is not called after an error. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_target_wrap_vulkan(BhrContext *context, const BhrTargetOptions *options, uint64_t vk_image,
                                               uint32_t vk_usage, BhrReleaseFn release, void *release_user,
                                               BhrTarget **out_target);

/** Makes a semaphore of a VkSemaphore of a host whose device the context is on, which is of this kind. It must live
 * until bhr_context_destroy has returned, or until the semaphore is destroyed and every frame that uses it has
 * ended.
 * Errors: INVALID_STATE for a context that is not on a host's device. @since 0.2.0 */
BHR_NODISCARD BhrStatus bhr_semaphore_wrap_vulkan(BhrContext *context, BhrSemaphoreKind kind, uint64_t vk_semaphore,
                                                  BhrSemaphore **out_semaphore);

#ifdef __cplusplus
}
#endif

/** The structs of this header that BHR_INIT knows, and their functions. */
#define BHR_INIT_INTEROP(EACH) \
    EACH(BhrInteropInfo, bhr_interop_info_init) \
    EACH(BhrTargetOptions, bhr_target_options_init) \
    EACH(BhrTargetInfo, bhr_target_info_init) \
    EACH(BhrSync, bhr_sync_init) \
    EACH(BhrVulkanRequirements, bhr_vulkan_requirements_init) \
    EACH(BhrVulkanDevice, bhr_vulkan_device_init)
#ifdef __cplusplus
BHR_INIT_INTEROP(BHR_INIT_FUNCTION)
#else
#undef BHR_INIT_MORE
/** The structs of this header, which BHR_INIT knows as well. */
#define BHR_INIT_MORE BHR_INIT_INTEROP(BHR_INIT_CASE)
#endif

#endif
