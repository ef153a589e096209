// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/result.hpp -- errors of bhr.hpp: statuses, Error, Result, and how exceptions get around C. Include bhr.hpp. */
#ifndef BHR_RESULT_HPP
#define BHR_RESULT_HPP

#include "../bhr.h"

#include <cstdint>
#include <cstdlib>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>

#if !defined(BHR_NO_EXCEPTIONS) && !defined(__cpp_exceptions) && !defined(_CPPUNWIND)
#define BHR_NO_EXCEPTIONS
#endif

namespace bhr {

/// BhrStatus. (Xlib has a macro named Status.)
enum class StatusCode : std::int32_t {
    ok = BHR_OK,
    not_ready = BHR_NOT_READY,
    frame_skipped = BHR_FRAME_SKIPPED,
    invalid_argument = BHR_ERROR_INVALID_ARGUMENT,
    invalid_state = BHR_ERROR_INVALID_STATE,
    incompatible_abi = BHR_ERROR_INCOMPATIBLE_ABI,
    unsupported = BHR_ERROR_UNSUPPORTED,
    no_adapter = BHR_ERROR_NO_ADAPTER,
    out_of_memory = BHR_ERROR_OUT_OF_MEMORY,
    cancelled = BHR_ERROR_CANCELLED,
    surface_lost = BHR_ERROR_SURFACE_LOST,
    device_lost = BHR_ERROR_DEVICE_LOST,
    io = BHR_ERROR_IO,
    internal = BHR_ERROR_INTERNAL,
};

/// The constant's name, such as "BHR_ERROR_DEVICE_LOST" (bhr_status_name).
inline const char *name(StatusCode status) noexcept {
    return bhr_status_name(static_cast<BhrStatus>(status));
}

/// A call that failed: its status, and its message as what().
class Error : public std::runtime_error {
  public:
    Error(StatusCode status, const char *message) : std::runtime_error(message), status_(status) {}

    /// The failure of the last call on this thread, which returned `status` (bhr_error_message).
    static Error last(BhrStatus status) {
        return Error(static_cast<StatusCode>(status), bhr_error_message());
    }

    StatusCode status() const noexcept { return status_; }

  private:
    StatusCode status_;
};

/// Without exceptions: called with the error when value() has none to return; std::abort follows where it returns. Set
/// it before threads use bhr. nullptr, the default, calls nothing.
inline void (*failure_hook)(const Error &error) = nullptr;

namespace detail {

[[noreturn]] inline void fail(const Error &error) {
#ifdef BHR_NO_EXCEPTIONS
    if (failure_hook != nullptr) {
        failure_hook(error);
    }
    std::abort();
#else
    throw error;
#endif
}

#ifndef BHR_NO_EXCEPTIONS
/// An exception that a functor threw inside a call of this thread's, and how many calls this thread is in.
struct Pending {
    std::exception_ptr thrown;
    int depth = 0;
};

inline Pending &pending() noexcept {
    static thread_local Pending own;
    return own;
}
#endif

/// How many functors of callbacks this thread is in.
inline int &functors_running() noexcept {
    static thread_local int count = 0;
    return count;
}

/// Lives while a functor runs.
struct FunctorRuns {
    FunctorRuns() noexcept { functors_running()++; }
    FunctorRuns(const FunctorRuns &) = delete;
    FunctorRuns &operator=(const FunctorRuns &) = delete;
    ~FunctorRuns() { functors_running()--; }
};

/// Ends a functor, but not inside one: there C ignores the end of its context, which goes on calling it.
struct EndFunctor {
    template <class Functor> void operator()(Functor *functor) const noexcept {
        if (functors_running() == 0) {
            delete functor;
        }
    }
};

template <class T> using Functor = std::unique_ptr<T, EndFunctor>;

/// Runs a functor inside C: its exception is kept for the C++ call that this thread is in. Whether it threw none.
template <class Functor> bool shielded(Functor &&functor) noexcept {
    const FunctorRuns inside;
#ifdef BHR_NO_EXCEPTIONS
    functor();
    return true;
#else
    try {
        functor();
        return true;
    } catch (...) {
        Pending &own = pending();
        if (own.depth > 0 && own.thrown == nullptr) {
            own.thrown = std::current_exception();
        }
        return false;
    }
#endif
}

/// Lives while this thread is in a call that may run functors.
class Call {
  public:
#ifdef BHR_NO_EXCEPTIONS
    Call() noexcept {}
    void rethrow() const noexcept {}
#else
    Call() noexcept { pending().depth++; }
    Call(const Call &) = delete;
    Call &operator=(const Call &) = delete;
    /// An exception that was not thrown again is dropped: destructors do not throw.
    ~Call() {
        Pending &own = pending();
        own.depth--;
        if (own.depth == 0) {
            own.thrown = nullptr;
        }
    }
    /// Throws what a functor threw, out of the outermost call; to be called when nothing is left to lose.
    void rethrow() const {
        if (pending().depth > 1) {
            return;
        }
        if (std::exception_ptr thrown = std::exchange(pending().thrown, nullptr)) {
            std::rethrow_exception(std::move(thrown));
        }
    }
#endif
};

} // namespace detail

/// A value, or the error for which there is none.
template <class T> class [[nodiscard]] Result {
  public:
    Result(T value) : held_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : held_(std::in_place_index<1>, std::move(error)) {}

    bool has_value() const noexcept { return held_.index() == 0; }
    explicit operator bool() const noexcept { return has_value(); }

    /// The value; without one it throws the error, or ends the program (failure_hook).
    T &value() & {
        check();
        return *std::get_if<0>(&held_);
    }
    const T &value() const & {
        check();
        return *std::get_if<0>(&held_);
    }
    T &&value() && {
        check();
        return std::move(*std::get_if<0>(&held_));
    }
    template <class U> T value_or(U &&otherwise) && {
        return has_value() ? std::move(*std::get_if<0>(&held_)) : static_cast<T>(std::forward<U>(otherwise));
    }

    /// Only where there is a value.
    T &operator*() noexcept { return *std::get_if<0>(&held_); }
    const T &operator*() const noexcept { return *std::get_if<0>(&held_); }
    T *operator->() noexcept { return std::get_if<0>(&held_); }
    const T *operator->() const noexcept { return std::get_if<0>(&held_); }

    /// Only where there is no value.
    const Error &error() const noexcept { return *std::get_if<1>(&held_); }
    /// StatusCode::ok where there is a value.
    StatusCode status() const noexcept { return has_value() ? StatusCode::ok : error().status(); }

  private:
    void check() const {
        if (!has_value()) {
            detail::fail(error());
        }
    }

    std::variant<T, Error> held_;
};

/// Success without a value, or the error.
template <> class [[nodiscard]] Result<void> {
  public:
    Result() noexcept = default;
    Result(Error error) : error_(std::move(error)) {}

    bool has_value() const noexcept { return !error_.has_value(); }
    explicit operator bool() const noexcept { return has_value(); }
    /// Throws the error, or ends the program (failure_hook), where there is one.
    void value() const {
        if (error_) {
            detail::fail(*error_);
        }
    }
    /// Only after a failure.
    const Error &error() const noexcept { return *error_; }
    StatusCode status() const noexcept { return has_value() ? StatusCode::ok : error_->status(); }

  private:
    std::optional<Error> error_;
};

namespace detail {

/// The result of a C function that gives nothing but a status.
inline Result<void> result(BhrStatus status) {
    if (status < 0) {
        return Error::last(status);
    }
    return {};
}

/// The value that a call has filled in, or the error of its status.
template <class T> Result<T> result(BhrStatus status, T value) {
    if (status < 0) {
        return Error::last(status);
    }
    return Result<T>(std::move(value));
}

/// Calls a C function, which may run functors.
template <class Function> Result<void> call(Function &&function) {
    const Call inside;
    Result<void> done = result(function());
    inside.rethrow();
    return done;
}

/// Calls a C function that fills in `value`, and may run functors: the value, or the error of its status.
template <class T, class Function> Result<T> ask(T value, Function &&function) {
    const Call inside;
    const BhrStatus status = function(value);
    Result<T> answer = result(status, std::move(value));
    inside.rethrow();
    return answer;
}

} // namespace detail

/// The loaded library's version: major << 16 | minor << 8 | patch (bhr_version).
inline std::uint32_t version() noexcept { return bhr_version(); }

/// BHR_ABI_VERSION of the loaded library (bhr_abi_version).
inline std::uint32_t abi_version() noexcept { return bhr_abi_version(); }

/// The loaded library's version, such as "0.2.0" (bhr_version_string).
inline const char *version_string() noexcept { return bhr_version_string(); }

} // namespace bhr

#endif
