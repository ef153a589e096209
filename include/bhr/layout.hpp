// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/layout.hpp -- between the structs of C and those of C++, which have the same bytes. Include bhr.hpp. */
#ifndef BHR_LAYOUT_HPP
#define BHR_LAYOUT_HPP

#include "result.hpp"

#include <cstring>
#include <optional>
#include <type_traits>

namespace bhr {
namespace detail {

/// The C struct of the same layout. The bytes are copied, because C++ does not let one be used as the other.
template <class C, class T> C as_c(const T &object) noexcept {
    static_assert(sizeof(C) == sizeof(T) && alignof(C) == alignof(T), "the structs of bhr.hpp are those of bhr.h");
    static_assert(std::is_trivially_copyable_v<C> && std::is_trivially_copyable_v<T>);
    C copy;
    std::memcpy(&copy, &object, sizeof copy);
    return copy;
}

template <class T, class C> void take(T &object, const C &from) noexcept {
    static_assert(sizeof(C) == sizeof(T) && std::is_trivially_copyable_v<T>);
    std::memcpy(static_cast<void *>(&object), &from, sizeof from);
}

/// Fills in a struct by the function of bhr.h that has its defaults. They cannot fail with a struct of this size.
template <class T, class C> void defaults(T &object, BhrStatus (*init)(C *, std::size_t)) noexcept {
    C copy{};
    static_cast<void>(init(&copy, sizeof copy));
    take(object, copy);
}

/// Asks for a struct that begins with struct_size by a getter of bhr.h.
template <class T, class C, class Function> Result<T> ask_struct(Function &&function) {
    return ask(T(), [&](T &object) {
        C copy{};
        BHR_INIT(copy);
        const BhrStatus status = function(&copy);
        take(object, copy);
        return status;
    });
}

/// Asks for one that may not be there.
template <class T, class C, class Function> Result<std::optional<T>> ask_or_none(Function &&function) {
    std::int32_t    present = 0;
    const Result<T> value = ask_struct<T, C>([&](C *it) { return function(it, &present); });
    if (!value) {
        return value.error();
    }
    return present != 0 ? std::optional<T>(*value) : std::optional<T>();
}

} // namespace detail

} // namespace bhr

#endif
