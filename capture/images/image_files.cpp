// SPDX-License-Identifier: Apache-2.0
#include "capture/images/image_files.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <new>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/failure_text.h"
#include "base/file_kind.h"
#include "base/message_text.h"
#include "capture/images/image_decoders.h"

namespace disparityd::capture {
namespace {

constexpr const char* kinds = "PNG, JPEG, PBM, PGM, PPM, BMP, TIFF, WebP";

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
    throw std::invalid_argument(path + ": " + why);
}

struct OpenImage {
    std::ifstream file;
    ImageSize size;
};

/// Reads the header, and refuses images that are too large or not as they are to be seen.
ImageSize checked_size(std::istream& file, const std::string& path) {
    const std::optional<ImageSize> size = read_image_header(file);
    if (!size) {
        refuse(path, std::string("is not an image that can be read (") + kinds + "), or is damaged");
    }
    if (size->width > largest_image_side || size->height > largest_image_side) {
        refuse(path,
               "found " + base::size_text(size->width, size->height) + " pixels, allowed are up to 8192 on a side");
    }
    if (const int orientation = read_image_orientation(file); orientation != 1) {
        refuse_turned_image(path, orientation);
    }
    return *size;
}

/// Opens a file that must be an image, and reads its header.
OpenImage open_image(const std::string& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (status.type() == std::filesystem::file_type::not_found) {
        refuse(path, "no such file");
    }
    // Opening a pipe or a device may never end.
    if (!error && !std::filesystem::is_regular_file(status)) {
        refuse(path, "is not a file");
    }
    errno = error.value();
    std::ifstream file;
    if (!error) {
        file.open(path, std::ios::binary);
    }
    if (!file.is_open()) {
        refuse(path, "cannot be read: " + base::error_text(errno));
    }
    const ImageSize size = checked_size(file, path);
    return {std::move(file), size};
}

std::vector<std::uint8_t> all_bytes(std::ifstream& file, const std::string& path) {
    file.clear();
    file.seekg(0, std::ios::end);
    const std::streamoff size = file.tellg();
    std::vector<std::uint8_t> bytes(size > 0 ? static_cast<std::size_t>(size) : 0);
    file.seekg(0);
    if (!file.read(reinterpret_cast<char*>(bytes.data()), size)) {
        refuse(path, "cannot be read: " + base::error_text(errno));
    }
    return bytes;
}

/// Decodes a file that read_image_header() knows.
cv::Mat decode(const std::vector<std::uint8_t>& bytes, const std::string& path) {
    constexpr std::size_t least = 8;  // it may be another file by now
    if (bytes.size() < least) {
        refuse_cut_image(path, bytes.size(), least);
    }
    switch (bytes[0]) {
        case 0x89: return decode_png(bytes, path);
        case 0xff: return decode_jpeg(bytes, path);
        case 'P': return decode_pnm(bytes, path);
        case 'B': return decode_bmp(bytes, path);
        case 'R': return decode_webp(bytes, path);
        default: return decode_tiff(bytes, path);  // it begins with the byte order, II or MM
    }
}

/// Decodes the bytes of an image whose header was checked. `take_bytes` may want more memory than there is, too.
template <class TakeBytes>
cv::Mat decode_of_size(TakeBytes&& take_bytes, ImageSize size, const std::string& path) {
    const auto no_memory = [&] {
        return std::runtime_error(path + ": there is not enough memory for an image of " +
                                  base::size_text(size.width, size.height) + " pixels");
    };
    try {
        cv::Mat image = decode(take_bytes(), path);
        if (image.empty()) {
            refuse(path, "is damaged: it has no pixels");
        }
        return image;
    } catch (const std::bad_alloc&) {
        throw no_memory();
    } catch (const cv::Exception& error) {
        if (error.code == cv::Error::StsNoMem) {
            throw no_memory();
        }
        throw;
    }
}

}  // namespace

void refuse_cut_image(const std::string& path, std::uint64_t found, std::uint64_t least) {
    refuse(path, "is damaged: the file was cut off, " + std::to_string(found) + " of " + std::to_string(least) +
                     " bytes are there");
}

void refuse_turned_image(const std::string& path, int orientation) {
    refuse(path, "declares that it is to be turned or mirrored before it is shown (orientation " +
                     std::to_string(orientation) +
                     " of EXIF or TIFF), which is not done here: turn the pixels of both eyes (jpegtran, "
                     "ImageMagick's -auto-orient), or remove the tag");
}

std::optional<ImageSize> peek_image_size(const std::string& path) {
    if (!base::is_file(path)) {
        return std::nullopt;
    }
    std::ifstream file(path, std::ios::binary);
    return file ? read_image_header(file) : std::nullopt;
}

int bits_of_values(const std::string& path) {
    constexpr int least = 9, most = 16;
    std::ifstream file(path, std::ios::binary);
    const auto largest = read_largest_value(file);
    return largest ? std::clamp(static_cast<int>(std::bit_width(*largest)), least, most) : most;
}

cv::Mat decode_image(const std::string& path) {
    OpenImage opened = open_image(path);
    return decode_of_size([&] { return all_bytes(opened.file, path); }, opened.size, path);
}

cv::Mat decode_image(std::span<const std::uint8_t> bytes, const std::string& name) {
    std::istringstream file(std::string(bytes.begin(), bytes.end()));
    const ImageSize size = checked_size(file, name);
    return decode_of_size([&] { return std::vector<std::uint8_t>(bytes.begin(), bytes.end()); }, size, name);
}

cv::Mat as_8_bits(const cv::Mat& image, const std::string& path, DeepPixels deep) {
    if (image.depth() != CV_8U && image.depth() != CV_16U) {
        refuse(path, "found pixels of " + std::to_string(8 * image.elemSize1()) +
                         " bits that are no whole numbers from 0, allowed are 8 and 16 bits per channel: convert it");
    }
    if (image.channels() != 1 && image.channels() != 3 && image.channels() != 4) {
        refuse(path, "found " + std::to_string(image.channels()) + " channels, allowed are grey and colour");
    }
    cv::Mat result = image;
    if (image.depth() == CV_16U) {
        const int shift = (deep.bits == 0 ? bits_of_values(path) : deep.bits) - 8;
        result.create(image.rows, image.cols, CV_8UC(image.channels()));
        for (int y = 0; y < image.rows; ++y) {
            const auto* from = image.ptr<std::uint16_t>(y);
            std::transform(from, from + image.cols * image.channels(), result.ptr<std::uint8_t>(y),
                           [shift](int value) { return static_cast<std::uint8_t>(std::min(value >> shift, 255)); });
        }
    }
    if (result.channels() == 4) {
        cv::cvtColor(result, result, cv::COLOR_BGRA2BGR);
    }
    return result;
}

cv::Mat read_image(const std::string& path, DeepPixels deep) {
    return as_8_bits(decode_image(path), path, deep);
}

std::string unequal_sizes(const std::string& first, ImageSize first_size, const std::string& second,
                          ImageSize second_size) {
    return "images of unequal sizes: " + first + " is " + base::size_text(first_size.width, first_size.height) + ", " +
           second + " is " + base::size_text(second_size.width, second_size.height) + "; all must be alike";
}

}  // namespace disparityd::capture
