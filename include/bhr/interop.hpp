// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/interop.hpp -- bhr_interop.h for C++17: targets and semaphores on the GPU as objects that end themselves, and
 * contexts on a Vulkan device of the host's. bhr.hpp does without it; include it where it is needed. Functions do what
 * those of bhr_interop.h do that they name, which that header documents; errors and exceptions are as in bhr.hpp. */
#ifndef BHR_INTEROP_HPP
#define BHR_INTEROP_HPP

#include "../bhr.hpp"
#include "../bhr_interop.h"

#include <utility>

#ifndef _WIN32
#include <unistd.h>
#endif

namespace bhr {

/// BhrHandleType; as bits in InteropInfo.
enum class HandleType : std::uint32_t {
    none = 0,
    opaque_fd = BHR_HANDLE_OPAQUE_FD,
    dma_buf = BHR_HANDLE_DMA_BUF,
    opaque_win32 = BHR_HANDLE_OPAQUE_WIN32,
    d3d12 = BHR_HANDLE_D3D12,
    d3d11_texture = BHR_HANDLE_D3D11_TEXTURE,
    apple = BHR_HANDLE_APPLE,
    host_pointer = BHR_HANDLE_HOST_POINTER,
};

/// BhrTargetKind.
enum class TargetKind : std::int32_t { image = BHR_TARGET_IMAGE, buffer = BHR_TARGET_BUFFER };

/// BhrSemaphoreKind.
enum class SemaphoreKind : std::int32_t { timeline = BHR_SEMAPHORE_TIMELINE, binary = BHR_SEMAPHORE_BINARY };

/// BHR_TARGET_COPY, among TargetOptions::flags.
inline constexpr ImageFlags target_copy = static_cast<ImageFlags>(BHR_TARGET_COPY);

/// Structs of numbers that mean the same here: Vulkan's, and bits of BHR_HANDLE_*.
using InteropInfo = BhrInteropInfo;
using TargetInfo = BhrTargetInfo;
using SemaphoreValue = BhrSemaphoreValue;
using VulkanRequirements = BhrVulkanRequirements;
/// Cleared by `VulkanDevice device = {};`. Functors that are passed beside it take the place of its callbacks.
using VulkanDevice = BhrVulkanDevice;

/// BhrTargetOptions, with the defaults of bhr_target_options_init.
struct TargetOptions {
    std::uint32_t struct_size;
    TargetKind kind;
    Format format;
    std::uint32_t width;
    std::uint32_t height;
    ImageFlags flags;
    HandleType handle_type;
    std::int32_t layout;
    std::uint64_t row_stride;

    TargetOptions() noexcept { detail::defaults(*this, bhr_target_options_init); }
    TargetOptions(TargetKind of, Format pixels, std::uint32_t columns, std::uint32_t rows,
                  HandleType exported_by = HandleType::none) noexcept
        : TargetOptions() {
        kind = of;
        format = pixels;
        width = columns;
        height = rows;
        handle_type = exported_by;
    }
    BhrTargetOptions c() const noexcept { return detail::as_c<BhrTargetOptions>(*this); }
};

/// A handle of memory or of a semaphore, on its way from one side to the other (BhrHandle). It owns a descriptor, and
/// closes it unless somebody takes it over: import_ where it succeeds, or who calls release. Move-only.
class SharedHandle {
  public:
    SharedHandle() noexcept = default;
    /// The descriptor is this object's from here on.
    static SharedHandle opaque_fd(int fd) noexcept {
        return SharedHandle({BHR_HANDLE_OPAQUE_FD, static_cast<std::int32_t>(fd), nullptr});
    }
    /// Memory of the host's, which it goes on owning.
    static SharedHandle host_pointer(void *memory) noexcept {
        return SharedHandle({BHR_HANDLE_HOST_POINTER, -1, memory});
    }
    explicit SharedHandle(const BhrHandle &handle) noexcept : handle_(handle) {}
    SharedHandle(SharedHandle &&other) noexcept : handle_(other.release()) {}
    SharedHandle &operator=(SharedHandle &&other) noexcept {
        if (this != &other) {
            close();
            handle_ = other.release();
        }
        return *this;
    }
    ~SharedHandle() { close(); }

    HandleType type() const noexcept { return static_cast<HandleType>(handle_.type); }
    /// OPAQUE_FD: the descriptor, still this object's; else -1.
    int fd() const noexcept { return handle_.fd; }
    const BhrHandle &get() const noexcept { return handle_; }
    /// Gives the handle to the caller, who owns it from here on; the object is empty then.
    BhrHandle release() noexcept { return std::exchange(handle_, BhrHandle{0, -1, nullptr}); }

  private:
    void close() noexcept {
#ifndef _WIN32
        if (handle_.type == BHR_HANDLE_OPAQUE_FD && handle_.fd >= 0) {
            ::close(handle_.fd);
        }
#endif
        handle_ = {0, -1, nullptr};
    }

    BhrHandle handle_ = {0, -1, nullptr};
};

/// Is called once, when bhr does not use a thing of the host's any more (BhrReleaseFn), on any thread. What it throws
/// leaves the call that it runs in, if that is one of this header's on the same thread, and is dropped otherwise.
using ReleaseFunction = std::function<void()>;

/// Take and give back the lock of the host's queue (BhrVulkanDevice.lock); on any thread. They should not throw: what
/// they throw goes where that of a ReleaseFunction does, the queue is used all the same, and a lock that threw is not
/// given back.
struct QueueLock {
    std::function<void()> lock;
    std::function<void()> unlock;
};

namespace detail {

/// The parts of a context that this header needs.
struct Access {
    template <class Create>
    static Result<Context> context(const ContextOptions &options, LogFunction log, Create &&create) {
        return Context::made(options, std::move(log), std::forward<Create>(create));
    }
    template <class Create> static Result<Job> job(Context &context, Create &&create) {
        return context.new_job(std::forward<Create>(create));
    }
    template <class T> static std::vector<BhrOutput> copied(const T &outputs) {
        return Context::copied<BhrOutput>(outputs);
    }
};

inline void on_release(void *user) noexcept {
    const std::unique_ptr<ReleaseFunction> release(static_cast<ReleaseFunction *>(user));
    if (*release) {
        shielded([&] { (*release)(); });
    }
}

/// The functors that a context on the host's device calls. They live until bhr has called `release`.
struct DeviceCallbacks {
    QueueLock queue;
    ReleaseFunction release;
    // The host's own, called where there is no functor.
    BhrReleaseFn raw_release;
    void *raw_release_user;
};

/// Whether the last lock of this thread's threw. Locks are never nested.
inline bool &lock_threw() noexcept {
    static thread_local bool threw = false;
    return threw;
}

inline void on_lock(void *user) noexcept {
    lock_threw() = !shielded([&] { static_cast<DeviceCallbacks *>(user)->queue.lock(); });
}

inline void on_unlock(void *user) noexcept {
    if (!lock_threw()) {
        shielded([&] { static_cast<DeviceCallbacks *>(user)->queue.unlock(); });
    }
}

inline void on_device_release(void *user) noexcept {
    const std::unique_ptr<DeviceCallbacks> callbacks(static_cast<DeviceCallbacks *>(user));
    if (callbacks->release) {
        shielded([&] { callbacks->release(); });
    } else if (callbacks->raw_release != nullptr) {
        callbacks->raw_release(callbacks->raw_release_user);
    }
}

} // namespace detail

/// A semaphore that both sides reach (BhrSemaphore). Move-only; it may outlive its context.
class Semaphore {
  public:
    /// bhr_semaphore_create.
    static Result<Semaphore> create(Context &context, SemaphoreKind kind = SemaphoreKind::timeline,
                                    HandleType exported_by = HandleType::none) {
        return made([&](BhrSemaphore **handle) {
            return bhr_semaphore_create(context.get(), static_cast<BhrSemaphoreKind>(kind),
                                        static_cast<BhrHandleType>(exported_by), handle);
        });
    }

    /// bhr_semaphore_import. A descriptor is taken over where it succeeds; else `handle` keeps it.
    static Result<Semaphore> import_(Context &context, SemaphoreKind kind, SharedHandle &&handle) {
        return made([&](BhrSemaphore **semaphore) {
            const BhrStatus status = bhr_semaphore_import(context.get(), static_cast<BhrSemaphoreKind>(kind),
                                                          &handle.get(), semaphore);
            if (status >= 0) {
                handle.release();
            }
            return status;
        });
    }

    /// bhr_semaphore_wrap_vulkan.
    static Result<Semaphore> wrap_vulkan(Context &context, SemaphoreKind kind, std::uint64_t vk_semaphore) {
        return made([&](BhrSemaphore **handle) {
            return bhr_semaphore_wrap_vulkan(context.get(), static_cast<BhrSemaphoreKind>(kind), vk_semaphore, handle);
        });
    }

    /// bhr_semaphore_export.
    Result<SharedHandle> export_() {
        return detail::ask(SharedHandle(), [&](SharedHandle &to) {
            BhrHandle handle = {0, -1, nullptr};
            const BhrStatus status = bhr_semaphore_export(get(), &handle);
            to = SharedHandle(handle);
            return status;
        });
    }

    /// bhr_semaphore_vulkan.
    Result<std::uint64_t> vulkan() const {
        return detail::ask(std::uint64_t(0), [&](std::uint64_t &to) { return bhr_semaphore_vulkan(get(), &to); });
    }

    /// bhr_semaphore_wait, without limit.
    Result<void> wait(std::uint64_t value) {
        return detail::call([&] { return bhr_semaphore_wait(get(), value, UINT64_MAX); });
    }
    /// bhr_semaphore_wait: so long at most, 0 looks. Whether the semaphore has the value.
    template <class Rep, class Period>
    Result<bool> wait_for(std::uint64_t value, const std::chrono::duration<Rep, Period> &timeout) {
        return detail::ask(false, [&](bool &reached) {
            const BhrStatus status = bhr_semaphore_wait(get(), value, detail::timeout_of(timeout));
            reached = status == BHR_OK;
            return status;
        });
    }

    /// bhr_semaphore_signal.
    Result<void> signal(std::uint64_t value) {
        return detail::call([&] { return bhr_semaphore_signal(get(), value); });
    }

    /// For Sync; of a BINARY one the value is ignored.
    SemaphoreValue at(std::uint64_t value = 0) const noexcept { return {get(), value}; }

    BhrSemaphore *get() const noexcept { return handle_.get(); }

  private:
    explicit Semaphore(BhrSemaphore *handle) noexcept : handle_(handle) {}
    template <class Create> static Result<Semaphore> made(Create &&create) {
        return detail::made<BhrSemaphore>(create, [](BhrSemaphore *handle) { return Semaphore(handle); });
    }

    detail::Handle<BhrSemaphore, bhr_semaphore_destroy> handle_;
};

/// The semaphores of a frame (BhrSync); the lists are read by the call that gets them.
struct Sync {
    span<const SemaphoreValue> waits;
    span<const SemaphoreValue> signals;

    BhrSync c() const noexcept {
        // A count that does not fit is more than the library takes, which says so.
        const auto count = [](std::size_t n) { return static_cast<std::uint32_t>(n < UINT32_MAX ? n : UINT32_MAX); };
        return {sizeof(BhrSync), count(waits.size()), count(signals.size()), 0, waits.data(), signals.data()};
    }
};

/// The handles of a target on the host's own VkDevice; one of them is 0.
struct VulkanTarget {
    std::uint64_t image = 0;
    std::uint64_t buffer = 0;
};

/// A picture on the GPU that both sides reach (BhrTarget). Move-only; it may outlive its context.
class Target {
  public:
    /// bhr_target_create.
    static Result<Target> create(Context &context, const TargetOptions &options) {
        const BhrTargetOptions raw = options.c();
        return made([&](BhrTarget **handle) { return bhr_target_create(context.get(), &raw, handle); });
    }

    /// bhr_target_import. A descriptor is taken over where it succeeds; else `handle` keeps it.
    static Result<Target> import_(Context &context, const TargetOptions &options, const TargetInfo &memory,
                                  SharedHandle &&handle) {
        const BhrTargetOptions raw = options.c();
        return made([&](BhrTarget **target) {
            const BhrStatus status = bhr_target_import(context.get(), &raw, &memory, &handle.get(), target);
            if (status >= 0) {
                handle.release();
            }
            return status;
        });
    }

    /// bhr_target_wrap_vulkan. `release` is not called where it fails.
    static Result<Target> wrap_vulkan(Context &context, const TargetOptions &options, std::uint64_t vk_image,
                                      std::uint32_t vk_usage, ReleaseFunction release = {}) {
        const BhrTargetOptions raw = options.c();
        std::unique_ptr<ReleaseFunction> kept(release ? new ReleaseFunction(std::move(release)) : nullptr);
        const BhrReleaseFn function = kept ? detail::on_release : nullptr;
        return made([&](BhrTarget **target) {
            const BhrStatus status =
                bhr_target_wrap_vulkan(context.get(), &raw, vk_image, vk_usage, function, kept.get(), target);
            if (status >= 0) {
                static_cast<void>(kept.release()); // on_release ends it
            }
            return status;
        });
    }

    /// bhr_target_info.
    Result<TargetInfo> info() const {
        return detail::ask(TargetInfo(), [&](TargetInfo &info) {
            BHR_INIT(info);
            return bhr_target_info(get(), &info);
        });
    }

    /// bhr_target_export.
    Result<SharedHandle> export_() {
        return detail::ask(SharedHandle(), [&](SharedHandle &to) {
            BhrHandle handle = {0, -1, nullptr};
            const BhrStatus status = bhr_target_export(get(), &handle);
            to = SharedHandle(handle);
            return status;
        });
    }

    /// bhr_target_vulkan.
    Result<VulkanTarget> vulkan() const {
        return detail::ask(VulkanTarget(), [&](VulkanTarget &to) {
            return bhr_target_vulkan(get(), &to.image, &to.buffer);
        });
    }

    BhrTarget *get() const noexcept { return handle_.get(); }

  private:
    explicit Target(BhrTarget *handle) noexcept : handle_(handle) {}
    template <class Create> static Result<Target> made(Create &&create) {
        return detail::made<BhrTarget>(create, [](BhrTarget *handle) { return Target(handle); });
    }

    detail::Handle<BhrTarget, bhr_target_destroy> handle_;
};

/// An output that goes into a target, for render_outputs_shared, which takes those into images as well, with a job.
inline Output output_into(OutputKind kind, const Target &target, std::uint32_t number = 0) noexcept {
    Output output;
    output.kind = kind;
    output.index = number;
    output.target = target.get();
    return output;
}

/// bhr_interop_info.
inline Result<InteropInfo> interop_info(const Context &context) {
    return detail::ask(InteropInfo(), [&](InteropInfo &info) {
        BHR_INIT(info);
        return bhr_interop_info(context.get(), &info);
    });
}

/// bhr_adapter_find, by Vulkan's deviceUUID: ContextOptions::adapter_index.
inline Result<std::int32_t> find_adapter(const std::array<std::uint8_t, 16> &uuid) {
    return detail::ask(std::int32_t(-1), [&](std::int32_t &to) { return bhr_adapter_find(uuid.data(), nullptr, &to); });
}
/// bhr_adapter_find, by the LUID of Windows.
inline Result<std::int32_t> find_adapter(const std::array<std::uint8_t, 8> &luid) {
    return detail::ask(std::int32_t(-1), [&](std::int32_t &to) { return bhr_adapter_find(nullptr, luid.data(), &to); });
}

/* ---- frames ---- */

/// bhr_render_target without a job: the host waits for the signals.
inline Result<void> render_target(Context &context, Target &target, const Sync &sync = {}) {
    const BhrSync raw = sync.c();
    return detail::call([&] { return bhr_render_target(context.get(), target.get(), &raw, nullptr); });
}
/// bhr_render_target with a job, which ends when the GPU has made the frame. The end of a Job leaves its frame alone.
inline Result<Job> render_target_job(Context &context, Target &target, const Sync &sync = {}) {
    const BhrSync raw = sync.c();
    return detail::Access::job(context, [&](BhrJob **job) {
        return bhr_render_target(context.get(), target.get(), &raw, job);
    });
}
/// bhr_render_target_async.
inline Result<Job> render_target_async(Context &context, Target &target, const Sync &sync = {}) {
    const BhrSync raw = sync.c();
    return detail::Access::job(context, [&](BhrJob **job) {
        return bhr_render_target_async(context.get(), target.get(), &raw, job);
    });
}

/// bhr_render_outputs_shared without a job.
inline Result<void> render_outputs_shared(Context &context, span<const Output> outputs, const Sync &sync = {}) {
    const std::vector<BhrOutput> list = detail::Access::copied(outputs);
    const BhrSync raw = sync.c();
    return detail::call([&] {
        const std::uint32_t count = std::uint32_t(list.size());
        return bhr_render_outputs_shared(context.get(), list.data(), sizeof(BhrOutput), count, &raw, nullptr);
    });
}
/// bhr_render_outputs_shared with a job.
inline Result<Job> render_outputs_shared_job(Context &context, span<const Output> outputs, const Sync &sync = {}) {
    const std::vector<BhrOutput> list = detail::Access::copied(outputs);
    const BhrSync raw = sync.c();
    return detail::Access::job(context, [&](BhrJob **job) {
        const std::uint32_t count = std::uint32_t(list.size());
        return bhr_render_outputs_shared(context.get(), list.data(), sizeof(BhrOutput), count, &raw, job);
    });
}
/// bhr_render_outputs_shared_async.
inline Result<Job> render_outputs_shared_async(Context &context, span<const Output> outputs, const Sync &sync = {}) {
    const std::vector<BhrOutput> list = detail::Access::copied(outputs);
    const BhrSync raw = sync.c();
    return detail::Access::job(context, [&](BhrJob **job) {
        const std::uint32_t count = std::uint32_t(list.size());
        return bhr_render_outputs_shared_async(context.get(), list.data(), sizeof(BhrOutput), count, &raw, job);
    });
}

/* ---- what frames read ---- */

/// bhr_set_occluder_target; nullptr: none. The target must stay as long as it is set.
inline Result<void> set_occluder_target(Context &context, const Target *target, ImageFlags flags = ImageFlags::none) {
    return detail::call([&] {
        return bhr_set_occluder_target(context.get(), target != nullptr ? target->get() : nullptr,
                                       static_cast<std::uint32_t>(flags));
    });
}

/// bhr_set_sky_target; nullptr: none. The target must stay as long as it is set.
inline Result<void> set_sky_target(Context &context, const Target *target) {
    return detail::call([&] {
        return bhr_set_sky_target(context.get(), target != nullptr ? target->get() : nullptr);
    });
}
/// bhr_set_sky_target_as, for a picture laid out as Projection::equirect or Projection::cube.
inline Result<void> set_sky_target_as(Context &context, const Target *target, Projection layout) {
    return detail::call([&] {
        return bhr_set_sky_target_as(context.get(), target != nullptr ? target->get() : nullptr,
                                     static_cast<BhrProjection>(layout));
    });
}

/* ---- the host's Vulkan device ---- */

/// bhr_vulkan_requirements. The lists live as long as the library is loaded.
inline Result<VulkanRequirements> vulkan_requirements(BhrGetInstanceProcAddr get_instance_proc_addr,
                                                      void *instance = nullptr, void *physical_device = nullptr) {
    return detail::ask(VulkanRequirements(), [&](VulkanRequirements &to) {
        BHR_INIT(to);
        return bhr_vulkan_requirements(get_instance_proc_addr, instance, physical_device, &to);
    });
}

/// bhr_context_create_vulkan. `queue`: both functions, or neither, and then those of `device` count, if it has any.
/// The same goes for `release`, which is not called where this fails; `queue` lives until then.
inline Result<Context> create_on_vulkan(const VulkanDevice &device, const ContextOptions &options = {},
                                        QueueLock queue = {}, ReleaseFunction release = {}, LogFunction log = {}) {
    BhrVulkanDevice raw = device;
    raw.struct_size = sizeof raw;
    const bool locks = queue.lock && queue.unlock;
    if (!locks && (queue.lock || queue.unlock)) {
        return Error(StatusCode::invalid_argument, "bhr::create_on_vulkan: queue has one function; it takes both");
    }
    std::unique_ptr<detail::DeviceCallbacks> kept(
        new detail::DeviceCallbacks{std::move(queue), std::move(release), raw.release, raw.release_user});
    if (locks) {
        raw.lock = detail::on_lock;
        raw.unlock = detail::on_unlock;
        raw.lock_user = kept.get();
    }
    raw.release = detail::on_device_release;
    raw.release_user = kept.get();
    return detail::Access::context(options, std::move(log), [&](const BhrContextOptions &of, BhrContext **handle) {
        const BhrStatus status = bhr_context_create_vulkan(BHR_ABI_VERSION, &of, &raw, handle);
        if (status >= 0) {
            static_cast<void>(kept.release()); // on_device_release ends it
        }
        return status;
    });
}

} // namespace bhr

#endif
