// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <csetjmp>
#include <new>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <png.h>
#include <zlib.h>

#include "capture/images/image_decoders.h"
#include "formats/pictures/png_errors.h"

namespace disparityd::capture {
namespace {

constexpr std::size_t signature_size = 8;
constexpr std::size_t frame_size = 12;  // of a chunk: length, name, checksum
constexpr std::array<std::string_view, 5> of_pixels{"IHDR", "PLTE", "tRNS", "IDAT", "IEND"};

std::uint32_t big_endian_number(std::span<const std::uint8_t> bytes) {
    return std::uint32_t{bytes[0]} << 24U | std::uint32_t{bytes[1]} << 16U | std::uint32_t{bytes[2]} << 8U | bytes[3];
}

[[noreturn]] void refuse_png(const std::string& path, const std::string& why) {
    throw std::invalid_argument(path + ": is damaged: " + why);
}

/// Returns a PNG without the chunks that say nothing about its pixels (colour profiles, texts, times). Throws where the
/// file was cut off or a checksum of it is wrong.
std::vector<std::uint8_t> checked_png(std::span<const std::uint8_t> file, const std::string& path) {
    std::vector<std::uint8_t> kept(file.begin(), file.begin() + signature_size);
    for (std::size_t at = signature_size;;) {
        const std::size_t left = file.size() - at;
        if (left < frame_size || big_endian_number(file.subspan(at)) > left - frame_size) {
            refuse_png(path, "the PNG file was cut off after " + std::to_string(file.size()) + " bytes");
        }
        const std::size_t size = big_endian_number(file.subspan(at));
        const auto chunk = file.subspan(at, frame_size + size);
        const auto checked = chunk.subspan(4, 4 + size);
        const std::string_view name(reinterpret_cast<const char*>(checked.data()), 4);
        const bool wanted = std::find(of_pixels.begin(), of_pixels.end(), name) != of_pixels.end();
        if (wanted && ::crc32_z(0, checked.data(), checked.size()) != big_endian_number(chunk.last(4))) {
            refuse_png(path, "a checksum of the PNG file is wrong, at byte " + std::to_string(at));
        }
        if (wanted) {
            kept.insert(kept.end(), chunk.begin(), chunk.end());
        }
        if (name == "IEND") {
            return kept;
        }
        at += chunk.size();
    }
}

/// Owns libpng's state.
class PngReader {
public:
    explicit PngReader(std::span<const std::uint8_t> file)
        : left_(file),
          png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &errors_, formats::PngErrors::refuse,
                                      formats::PngErrors::ignore)) {
        info_ = png_ == nullptr ? nullptr : png_create_info_struct(png_);
        if (info_ == nullptr) {
            png_destroy_read_struct(&png_, nullptr, nullptr);
            throw std::bad_alloc();
        }
        png_set_read_fn(png_, this, take);
        png_set_user_limits(png_, largest_image_side, largest_image_side);
    }
    ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    /// Reads what is before the pixels. Returns their type in OpenCV's words; -1 where libpng refuses.
    int read_head() {
        if (setjmp(png_jmpbuf(png_)) != 0) {
            return -1;
        }
        png_read_info(png_, info_);
        const int colours = png_get_color_type(png_, info_);
        const int bits = png_get_bit_depth(png_, info_);
        const bool transparent = png_get_valid(png_, info_, PNG_INFO_tRNS) != 0;
        const bool palette = colours == PNG_COLOR_TYPE_PALETTE;
        if (palette) {
            png_set_palette_to_rgb(png_);
        }
        if (colours == PNG_COLOR_TYPE_GRAY && bits < 8) {
            png_set_expand_gray_1_2_4_to_8(png_);
        }
        if (colours == PNG_COLOR_TYPE_GRAY_ALPHA) {
            png_set_gray_to_rgb(png_);
        }
        const bool one_channel = colours == PNG_COLOR_TYPE_GRAY;
        // A grey value that stands for "transparent" says nothing of a camera's picture.
        const bool alpha = (colours & PNG_COLOR_MASK_ALPHA) != 0 || (transparent && !one_channel);
        if (alpha && transparent) {
            png_set_tRNS_to_alpha(png_);
        }
        if (!one_channel) {
            png_set_bgr(png_);
        }
        if (bits == 16) {
            png_set_swap(png_);  // every machine that the project is built for is little endian
        }
        png_set_interlace_handling(png_);
        png_read_update_info(png_, info_);
        return CV_MAKETYPE(bits == 16 ? CV_16U : CV_8U, one_channel ? 1 : alpha ? 4 : 3);
    }

    cv::Size size() const {
        return {static_cast<int>(png_get_image_width(png_, info_)),
                static_cast<int>(png_get_image_height(png_, info_))};
    }
    std::size_t row_bytes() const { return png_get_rowbytes(png_, info_); }

    /// Reads the pixels. Returns false where libpng refuses.
    bool read_pixels(png_bytepp rows) {
        if (setjmp(png_jmpbuf(png_)) != 0) {
            return false;
        }
        png_read_image(png_, rows);
        png_read_end(png_, nullptr);
        return true;
    }

    /// What libpng refused.
    const char* why() const { return errors_.why(); }

private:
    static void take(png_structp png, png_bytep to, std::size_t bytes) {
        auto* const self = static_cast<PngReader*>(png_get_io_ptr(png));
        if (bytes > self->left_.size()) {
            png_error(png, "pixels are missing");
        }
        std::copy_n(self->left_.begin(), bytes, to);
        self->left_ = self->left_.subspan(bytes);
    }

    std::span<const std::uint8_t> left_;
    formats::PngErrors errors_;
    png_structp png_;
    png_infop info_ = nullptr;
};

}  // namespace

cv::Mat decode_png(std::span<const std::uint8_t> file, const std::string& path) {
    const std::vector<std::uint8_t> checked = checked_png(file, path);
    PngReader reader(checked);
    const int type = reader.read_head();
    if (type < 0) {
        refuse_png(path, std::string("libpng says: ") + reader.why());
    }
    cv::Mat image(reader.size(), type);
    if (reader.row_bytes() != static_cast<std::size_t>(image.cols) * image.elemSize()) {
        refuse_png(path, "the header of the PNG file says two things of its pixels");
    }
    std::vector<png_bytep> rows(static_cast<std::size_t>(image.rows));
    for (int y = 0; y < image.rows; ++y) {
        rows[static_cast<std::size_t>(y)] = image.ptr(y);
    }
    if (!reader.read_pixels(rows.data())) {
        refuse_png(path, std::string("libpng says: ") + reader.why());
    }
    return image;
}

}  // namespace disparityd::capture
