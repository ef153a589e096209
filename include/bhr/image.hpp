// SPDX-License-Identifier: MIT OR Apache-2.0
/* bhr/image.hpp -- pixels in C++: views of the host's memory, frames that own theirs, pictures from files, and spans.
 * Include bhr.hpp. */
#ifndef BHR_IMAGE_HPP
#define BHR_IMAGE_HPP

#include "scene.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <string>
#if __has_include(<span>)
#include <span>
#endif

namespace bhr {

#ifdef __cpp_lib_span
template <class T> using span = std::span<T>;
#else
/// The part of C++20's std::span that bhr.hpp needs: elements that lie one after the other, and belong to others.
template <class T> class span {
  public:
    using element_type = T;
    constexpr span() noexcept = default;
    constexpr span(T *data, std::size_t size) noexcept : data_(data), size_(size) {}
    template <std::size_t N> constexpr span(T (&array)[N]) noexcept : data_(array), size_(N) {}
    /// A vector, an array, or any other that has data() and size(); or a span of elements that are not const.
    template <class Container, class = std::enable_if_t<std::is_convertible_v<
                                   std::remove_pointer_t<decltype(std::declval<Container &>().data())> (*)[], T (*)[]>>>
    constexpr span(Container &&container) noexcept : data_(container.data()), size_(container.size()) {}

    constexpr T *data() const noexcept { return data_; }
    constexpr std::size_t size() const noexcept { return size_; }
    constexpr bool empty() const noexcept { return size_ == 0; }
    constexpr T &operator[](std::size_t index) const noexcept { return data_[index]; }
    constexpr T *begin() const noexcept { return data_; }
    constexpr T *end() const noexcept { return data_ + size_; }
    constexpr std::size_t size_bytes() const noexcept { return size_ * sizeof(T); }

  private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};
#endif

/// The bytes of a pixel; 0 for a format that this header does not know.
constexpr std::size_t bytes_per_pixel(Format format) noexcept {
    switch (format) {
    case Format::rgba8_srgb:
    case Format::bgra8_srgb:
    case Format::r32f:
    case Format::rgb10a2_pq:
    case Format::rgb10a2_hlg:
        return 4;
    case Format::rgba16f:
        return 8;
    case Format::rgba32f:
        return 16;
    }
    return 0;
}

/// BhrImage, with the defaults of bhr_image_init: pixels in memory of the host's, which it does not own.
struct Image {
    std::uint32_t struct_size;
    Format format;
    std::uint32_t width;
    std::uint32_t height;
    void *pixels;
    std::int64_t row_stride;
    std::uint64_t byte_size;
    ImageFlags flags;
    std::uint32_t reserved;
    ColourSpace colour_space;
    std::uint32_t reserved2;

    Image() noexcept { detail::defaults(*this, bhr_image_init); }

    /// Packed rows in `memory`: a vector, an array or a span of plain values. The library checks its size.
    template <class Memory, class T = std::remove_pointer_t<decltype(std::data(std::declval<Memory &>()))>>
    Image(Memory &&memory, std::uint32_t columns, std::uint32_t rows, Format pixel_format = Format::rgba8_srgb) noexcept
        : Image() {
        static_assert(!std::is_const_v<T> && std::is_trivially_copyable_v<T>, "pixels are written as bytes");
        format = pixel_format;
        width = columns;
        height = rows;
        pixels = std::data(memory);
        byte_size = std::size(memory) * sizeof(T);
    }

    BhrImage c() const noexcept { return detail::as_c<BhrImage>(*this); }

    /// bhr_image_convert: the pixels, and colour_space with them.
    Result<void> convert(ColourSpace to) {
        BhrImage image = c();
        Result<void> converted =
            detail::call([&] { return bhr_image_convert(&image, static_cast<BhrColourSpace>(to)); });
        colour_space = static_cast<ColourSpace>(image.colour_space);
        return converted;
    }

    /// bhr_image_save.
    Result<void> save(const char *path) const {
        const BhrImage image = c();
        return detail::call([&] { return bhr_image_save(&image, path); });
    }
    Result<void> save(const std::string &path) const { return save(path.c_str()); }
};

/// A picture that owns its pixels, packed rows from the top down. Move-only; one that was moved from has no pixels, and
/// is refused wherever an image is asked for.
class Frame {
  public:
    /// All bytes 0. It has no pixels, and bytes() is empty, where there is no memory for them.
    Frame(std::uint32_t width, std::uint32_t height, Format format = Format::rgba8_srgb) noexcept
        : width_(width), height_(height), format_(format) {
        const std::uint64_t row = static_cast<std::uint64_t>(width) * bytes_per_pixel(format);
        if (row > 0 && height > 0 && row <= SIZE_MAX / 2) {
            memory_.reset(static_cast<std::byte *>(std::calloc(height, static_cast<std::size_t>(row))));
        }
    }
    Frame(Frame &&) noexcept = default;
    Frame &operator=(Frame &&) noexcept = default;
    Frame(const Frame &) = delete;
    Frame &operator=(const Frame &) = delete;

    std::uint32_t width() const noexcept { return width_; }
    std::uint32_t height() const noexcept { return height_; }
    Format format() const noexcept { return format_; }
    span<std::byte> bytes() noexcept { return span<std::byte>(memory_.get(), size()); }
    span<const std::byte> bytes() const noexcept { return span<const std::byte>(memory_.get(), size()); }

    /// A view of the pixels, valid until the frame ends or is assigned to; moving it leaves them where they are. Its
    /// flags are the caller's to set.
    Image image() noexcept { return Image(bytes(), width_, height_, format_); }

    /// A channel, 0 to 3 in their order in memory, of the pixel at x, y, both within the frame. T is a channel's type.
    template <class T> T channel(std::uint32_t x, std::uint32_t y, std::size_t index = 0) const noexcept {
        const std::size_t pixel = static_cast<std::size_t>(y) * width_ + x;
        T value;
        std::memcpy(&value, memory_.get() + pixel * bytes_per_pixel(format_) + index * sizeof(T), sizeof(T));
        return value;
    }

    /// Whether the colours are premultiplied by alpha, as rendered ones of ImageFlags::transparent are: save() then
    /// writes PNG files with straight ones.
    bool is_transparent() const noexcept { return transparent_; }
    void set_transparent(bool transparent) noexcept { transparent_ = transparent; }

    /// bhr_image_save, which reads the pixels only.
    Result<void> save(const char *path) const {
        Image image(span<std::byte>(memory_.get(), size()), width_, height_, format_);
        image.flags = transparent_ ? ImageFlags::transparent : ImageFlags::none;
        return image.save(path);
    }
    Result<void> save(const std::string &path) const { return save(path.c_str()); }

  private:
    struct Free {
        void operator()(std::byte *memory) const noexcept { std::free(memory); }
    };
    std::size_t size() const noexcept {
        return memory_ ? static_cast<std::size_t>(width_) * bytes_per_pixel(format_) * height_ : 0;
    }

    std::uint32_t width_;
    std::uint32_t height_;
    Format format_;
    bool transparent_ = false;
    std::unique_ptr<std::byte[], Free> memory_; // of calloc, which says so where there is none
};

/// A picture that bhr_image_load has read; bhr_image_release gives it back. Move-only.
class LoadedImage {
  public:
    static Result<LoadedImage> load(const char *path) {
        BhrImage image{};
        image.struct_size = sizeof image;
        const BhrStatus status = bhr_image_load(path, &image);
        if (status < 0) {
            return Error::last(status);
        }
        return LoadedImage(image);
    }
    static Result<LoadedImage> load(const std::string &path) { return load(path.c_str()); }

    LoadedImage(LoadedImage &&other) noexcept : image_(std::exchange(other.image_, BhrImage{})) {}
    LoadedImage &operator=(LoadedImage &&other) noexcept {
        if (this != &other) {
            end();
            image_ = std::exchange(other.image_, BhrImage{});
        }
        return *this;
    }
    LoadedImage(const LoadedImage &) = delete;
    LoadedImage &operator=(const LoadedImage &) = delete;
    ~LoadedImage() { end(); }

    /// A view of the pixels, valid as long as this lives.
    Image image() const noexcept {
        Image view;
        detail::take(view, image_);
        return view;
    }

  private:
    explicit LoadedImage(const BhrImage &image) noexcept : image_(image) {}
    void end() noexcept {
        if (image_.pixels != nullptr) {
            static_cast<void>(bhr_image_release(&image_));
        }
    }

    BhrImage image_;
};

} // namespace bhr

#endif
