// SPDX-License-Identifier: Apache-2.0
#include "formats/pictures/png_writer.h"

#include <csetjmp>
#include <new>
#include <stdexcept>
#include <utility>

#include <png.h>
#include <zlib.h>

#include "formats/pictures/png_errors.h"

namespace disparityd::formats {
namespace {

/// Owns libpng's state.
class PngWriter {
public:
    PngWriter() : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, &errors_, PngErrors::refuse, PngErrors::ignore)) {
        info_ = png_ == nullptr ? nullptr : png_create_info_struct(png_);
        if (info_ == nullptr) {
            png_destroy_write_struct(&png_, nullptr);
            throw std::bad_alloc();
        }
        png_set_write_fn(png_, this, take, nullptr);
    }
    ~PngWriter() { png_destroy_write_struct(&png_, &info_); }
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;

    /// Returns false where libpng refuses, or memory ended.
    bool write(const PngPixels& pixels, PngContent content) {
        if (setjmp(png_jmpbuf(png_)) != 0) {
            return false;
        }
        const int colours = pixels.channels == 1   ? PNG_COLOR_TYPE_GRAY
                            : pixels.channels == 3 ? PNG_COLOR_TYPE_RGB
                                                   : PNG_COLOR_TYPE_RGB_ALPHA;
        png_set_IHDR(png_, info_, static_cast<png_uint_32>(pixels.width), static_cast<png_uint_32>(pixels.height),
                     pixels.bits, colours, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
        const bool picture = content == PngContent::picture;
        png_set_compression_level(png_, Z_BEST_SPEED);
        png_set_compression_strategy(png_, picture ? Z_RLE : Z_DEFAULT_STRATEGY);
        png_set_filter(png_, PNG_FILTER_TYPE_BASE, picture ? PNG_FILTER_SUB : PNG_FILTER_NONE);
        png_write_info(png_, info_);
        if (pixels.bits == 16) {
            png_set_swap(png_);
        }
        if (pixels.channels > 1) {
            png_set_bgr(png_);
        }
        for (int y = 0; y < pixels.height; ++y) {
            png_write_row(png_, pixels.data + static_cast<std::size_t>(y) * pixels.row_bytes);
        }
        png_write_end(png_, info_);
        return true;
    }

    std::string& bytes() { return bytes_; }
    bool memory_ended() const { return memory_ended_; }
    const char* why() const { return errors_.why(); }

private:
    static void take(png_structp png, png_bytep from, std::size_t size) {
        auto* const self = static_cast<PngWriter*>(png_get_io_ptr(png));
        try {
            self->bytes_.append(reinterpret_cast<const char*>(from), size);
        } catch (const std::bad_alloc&) {
            self->memory_ended_ = true;
        }
        if (self->memory_ended_) {
            png_error(png, "no memory");
        }
    }

    std::string bytes_;
    PngErrors errors_;
    bool memory_ended_ = false;
    png_structp png_;
    png_infop info_ = nullptr;
};

}  // namespace

std::string png_of(const PngPixels& pixels, PngContent content) {
    PngWriter writer;
    if (!writer.write(pixels, content)) {
        if (writer.memory_ended()) {
            throw std::bad_alloc();
        }
        throw std::runtime_error("a picture of " + std::to_string(pixels.width) + " x " +
                                 std::to_string(pixels.height) +
                                 " pixels cannot be stored as PNG: libpng says: " + writer.why());
    }
    return std::move(writer.bytes());
}

}  // namespace disparityd::formats
