// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/handles.hpp -- jobs and surfaces of bhr.h as C++ objects that end themselves, and the functors that contexts
 * call. Include bhr.hpp. */
#ifndef BHR_HANDLES_HPP
#define BHR_HANDLES_HPP

#include "image.hpp"
#include "scene.hpp"

#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace bhr {

/// Is told how much of a frame is done, 0 to 1; false cancels it (BhrProgressFn).
using ProgressFunction = std::function<bool(double fraction)>;

/// Is told messages; on any thread, on several at once (BhrLogFn). The text lives for the call only.
using LogFunction = std::function<void(LogLevel level, std::string_view message)>;

namespace detail {

inline std::int32_t on_progress(void *user, double fraction) noexcept {
    bool goes_on = false;
    const bool whole = shielded([&] { goes_on = (*static_cast<ProgressFunction *>(user))(fraction); });
    return whole && goes_on ? 1 : 0;
}

inline void on_log(void *user, BhrLogLevel level, const char *message) noexcept {
    shielded([&] { (*static_cast<LogFunction *>(user))(static_cast<LogLevel>(level), message); });
}

/// A handle of C that is ended once.
template <class C, void (*destroy)(C *)> struct Destroy {
    void operator()(C *handle) const noexcept {
        const Call inside;
        destroy(handle);
    }
};
template <class C, void (*destroy)(C *)> using Handle = std::unique_ptr<C, Destroy<C, destroy>>;

/// A new object of the handle that `create` fills in; `make` makes it.
template <class C, class Create, class Make>
auto made(Create &&create, Make &&make) -> Result<decltype(make(static_cast<C *>(nullptr)))> {
    const Call inside;
    C *handle = nullptr;
    const BhrStatus status = create(&handle);
    if (status < 0) {
        Error error = Error::last(status);
        inside.rethrow();
        return error;
    }
    auto object = make(handle);
    inside.rethrow();
    return object;
}

struct Access; // of interop.hpp

/// The time in nanoseconds, for bhr_job_wait: rounded up; at the longest without limit.
template <class Rep, class Period>
std::uint64_t timeout_of(const std::chrono::duration<Rep, Period> &timeout) noexcept {
    using Seconds = std::chrono::duration<long double>;
    const long double seconds = std::chrono::duration_cast<Seconds>(timeout).count();
    if (!(seconds > 0.0L)) {
        return 0;
    }
    const long double most = 9.0e9L; // about 285 years
    if (seconds >= most) {
        return UINT64_MAX;
    }
    return static_cast<std::uint64_t>(std::ceil(seconds * 1.0e9L));
}

/// The message that bhr_context_error_message or bhr_job_error_message has for the handle.
template <class C> std::string message_of(std::size_t (*ask)(const C *, char *, std::size_t), const C *handle) {
    std::string text(ask(handle, nullptr, 0), '\0');
    // Another thread's call may have failed in between, with a message of another length.
    ask(handle, text.data(), text.size() + 1);
    text.resize(std::strlen(text.c_str()));
    return text;
}

} // namespace detail

/// The pictures that a scene's text asks for (bhr_scene_pictures).
struct ScenePictures {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t count = 0;
    double rate = 0.0;
};

/// How far a job is (bhr_job_wait).
struct JobProgress {
    bool done = false;
    double fraction = 0.0;
};

/// A frame that is rendered in the background (BhrJob). The memory of its target must outlive it.
class Job {
  public:
    /// Waits for the end; a job that failed gives its failure.
    Result<void> wait() {
        return detail::call([&] { return bhr_job_wait(handle_.get(), UINT64_MAX, nullptr); });
    }

    /// Waits so long at most; 0 asks how far it is. Done means that the image is complete.
    template <class Rep, class Period>
    Result<JobProgress> wait_for(const std::chrono::duration<Rep, Period> &timeout) {
        return detail::ask(JobProgress(), [&](JobProgress &progress) {
            const BhrStatus status = bhr_job_wait(handle_.get(), detail::timeout_of(timeout), &progress.fraction);
            progress.done = status == BHR_OK;
            return status;
        });
    }

    /// bhr_job_error_message: of the last call that failed on this job, on whichever thread.
    [[nodiscard]] std::string error_message() const {
        return detail::message_of(bhr_job_error_message, handle_.get());
    }

    /// bhr_job_cancel. Any thread, inside callbacks too.
    void cancel() noexcept { bhr_job_cancel(handle_.get()); }

    /// bhr_job_stats.
    Result<FrameStats> stats() const {
        return detail::ask_struct<FrameStats, BhrFrameStats>([&](BhrFrameStats *it) {
            return bhr_job_stats(handle_.get(), it);
        });
    }

    BhrJob *get() const noexcept { return handle_.get(); }

  private:
    friend class Context;
    friend detail::Access;
    Job(BhrJob *handle, std::shared_ptr<ProgressFunction> progress) noexcept
        : progress_(std::move(progress)), handle_(handle) {}

    std::shared_ptr<ProgressFunction> progress_; // the job calls it until it has ended, so that it ends after it
    detail::Handle<BhrJob, bhr_job_destroy> handle_;
};

/// A window that a context renders into (BhrSurface). The window and its display must outlive it.
class Surface {
  public:
    /// bhr_surface_resize.
    Result<void> resize(std::uint32_t width, std::uint32_t height) {
        return detail::call([&] { return bhr_surface_resize(handle_.get(), width, height); });
    }

    /// bhr_surface_set_present_mode.
    Result<void> set_present_mode(PresentMode mode) {
        return detail::call([&] {
            return bhr_surface_set_present_mode(handle_.get(), static_cast<BhrPresentMode>(mode));
        });
    }

    BhrSurface *get() const noexcept { return handle_.get(); }

  private:
    friend class Context;
    explicit Surface(BhrSurface *handle) noexcept : handle_(handle) {}

    detail::Handle<BhrSurface, bhr_surface_destroy> handle_;
};

/// The end of a frame for a window: skipped where the window is hidden or 0 x 0.
enum class Presented { yes, skipped };

} // namespace bhr

#endif
