/* SPDX-License-Identifier: MIT OR Apache-2.0 */
// handles.h -- the C API in C++ terms: handles that end what they own, structs that know their size, failures that keep
// their message. Knows neither scene nor window; a C++ host may copy it as it is.
#ifndef PANEL_HANDLES_H
#define PANEL_HANDLES_H

#include <bhr.h>
#include <memory>
#include <string>

struct EndContext {
    void operator()(BhrContext *context) const { bhr_context_destroy(context); }
};
struct EndJob {
    void operator()(BhrJob *job) const { bhr_job_destroy(job); }
};
using Context = std::unique_ptr<BhrContext, EndContext>;
using Job = std::unique_ptr<BhrJob, EndJob>;

// The message of a call. bhr_error_message lives until the thread's next failure only: a program that shows messages
// for longer must copy them at once.
struct Result {
    BhrStatus   status = BHR_OK;
    std::string message; // "" unless the call failed

    bool ok() const { return status >= 0; }
};

inline Result result_of(BhrStatus status) {
    return {status, status < 0 ? bhr_error_message() : ""};
}

// A struct that a call fills in: all zero but for its size.
template <class Struct> Struct sized() {
    Struct value{};
    value.struct_size = sizeof value;
    return value;
}

// A struct with the library's defaults: with_defaults(bhr_camera_init). These calls fail for a wrong size only.
template <class Struct> Struct with_defaults(BhrStatus (*init)(Struct *, size_t)) {
    Struct value{};
    init(&value, sizeof value);
    return value;
}

#endif
