// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/output.hpp -- what a program can have of a frame beside its picture. Include bhr.hpp. */
#ifndef BHR_OUTPUT_HPP
#define BHR_OUTPUT_HPP

#include "image.hpp"

namespace bhr {

/// The format that a kind takes: of light any that goes with the view, here four floats.
constexpr Format output_format(OutputKind kind) noexcept {
    switch (kind) {
    case OutputKind::depth:
    case OutputKind::transmission:
    case OutputKind::view:
        return Format::r32f;
    case OutputKind::light:
    case OutputKind::sky:
    case OutputKind::position:
    case OutputKind::disk:
        break;
    }
    return Format::rgba32f;
}

/// BhrOutput, with the defaults of bhr_output_init.
struct Output {
    std::uint32_t struct_size;
    OutputKind kind;
    std::uint32_t index;
    std::uint32_t reserved;
    const BhrImage *image;
    void *target;

    Output() noexcept { detail::defaults(*this, bhr_output_init); }
    /// `into`, of Image::c(), is read by the call that gets the output.
    Output(OutputKind of, const BhrImage &into, std::uint32_t number = 0) noexcept : Output() {
        kind = of;
        index = number;
        image = &into;
    }
    /// The values of a view.
    Output(View view, const BhrImage &into) noexcept
        : Output(OutputKind::view, into, static_cast<std::uint32_t>(view)) {}

    BhrOutput c() const noexcept { return detail::as_c<BhrOutput>(*this); }
};

} // namespace bhr

#endif
