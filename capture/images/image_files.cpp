// SPDX-License-Identifier: Apache-2.0
#include "capture/images/image_files.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <new>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <turbojpeg.h>
#include <zlib.h>

#include "base/failure_text.h"
#include "base/file_kind.h"
#include "base/message_text.h"

namespace disparityd::capture {
namespace {

constexpr std::size_t signature_size = 8;
constexpr std::size_t frame_size = 12;  // of a chunk: length, name, checksum
constexpr std::array<std::string_view, 5> of_pixels{"IHDR", "PLTE", "tRNS", "IDAT", "IEND"};

std::uint32_t big_endian_number(std::span<const std::uint8_t> bytes) {
    return std::uint32_t{bytes[0]} << 24U | std::uint32_t{bytes[1]} << 16U | std::uint32_t{bytes[2]} << 8U | bytes[3];
}

/// Returns a PNG without the chunks that say nothing about its pixels (colour profiles, texts, times), of which the
/// decoder would write warnings of its own to stderr. Throws std::invalid_argument with one line, for which `path` is,
/// where the file was cut off or a checksum of it is wrong.
std::vector<std::uint8_t> checked_png(std::span<const std::uint8_t> file, const std::string& path) {
    const auto refuse = [&path](const std::string& why) { throw std::invalid_argument(path + ": is damaged: " + why); };
    std::vector<std::uint8_t> kept(file.begin(), file.begin() + signature_size);
    for (std::size_t at = signature_size;;) {
        const std::size_t left = file.size() - at;
        if (left < frame_size || big_endian_number(file.subspan(at)) > left - frame_size) {
            refuse("the PNG file was cut off after " + std::to_string(file.size()) + " bytes");
        }
        const std::size_t size = big_endian_number(file.subspan(at));
        const auto chunk = file.subspan(at, frame_size + size);
        const auto checked = chunk.subspan(4, 4 + size);
        const std::string_view name(reinterpret_cast<const char*>(checked.data()), 4);
        const bool wanted = std::find(of_pixels.begin(), of_pixels.end(), name) != of_pixels.end();
        if (wanted && ::crc32_z(0, checked.data(), checked.size()) != big_endian_number(chunk.last(4))) {
            refuse("a checksum of the PNG file is wrong, at byte " + std::to_string(at));
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

struct DestroyDecoder {
    void operator()(void* decoder) const { tjDestroy(decoder); }
};

/// Decodes a JPEG: grey as CV_8UC1, colour as CV_8UC3 (blue, green, red). A file that was cut off or is damaged gives
/// grey areas and shifted blocks without an error of the decoder, which only warns: it is refused here. Throws
/// std::invalid_argument with one line; `path` is for it.
cv::Mat decode_jpeg(std::span<const std::uint8_t> file, const std::string& path) {
    const std::unique_ptr<void, DestroyDecoder> decoder(tjInitDecompress());
    if (decoder == nullptr) {
        throw std::bad_alloc();
    }
    const auto refuse = [&](const std::string& why) { throw std::invalid_argument(path + ": " + why); };
    const auto size = static_cast<unsigned long>(file.size());
    int width = 0, height = 0, subsampling = 0, space = 0;
    if (tjDecompressHeader3(decoder.get(), file.data(), size, &width, &height, &subsampling, &space) != 0) {
        refuse(std::string("is a JPEG that cannot be read: ") + tjGetErrorStr2(decoder.get()));
    }
    if (space == TJCS_CMYK || space == TJCS_YCCK) {
        refuse("found a JPEG of four inks (CMYK), allowed are grey and colour: convert it");
    }
    const bool grey = space == TJCS_GRAY;
    cv::Mat image(height, width, grey ? CV_8UC1 : CV_8UC3);
    if (tjDecompress2(decoder.get(), file.data(), size, image.data, width, static_cast<int>(image.step), height,
                      grey ? TJPF_GRAY : TJPF_BGR, TJFLAG_ACCURATEDCT) != 0) {
        refuse(std::string("is damaged: ") + tjGetErrorStr2(decoder.get()));
    }
    return image;
}

constexpr int largest_side = 8192;
constexpr const char* kinds = "PNG, JPEG, PBM, PGM, PPM, PFM, BMP, TIFF, WebP";

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
    if (size->width > largest_side || size->height > largest_side) {
        refuse(path,
               "found " + base::size_text(size->width, size->height) + " pixels, allowed are up to 8192 on a side");
    }
    if (const int orientation = read_image_orientation(file); orientation != 1) {
        refuse(path, "declares that it is to be turned or mirrored before it is shown (orientation " +
                         std::to_string(orientation) +
                         " of EXIF or TIFF), which is not done here: turn the pixels of both eyes (jpegtran, "
                         "ImageMagick's -auto-orient), or remove the tag");
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

bool begins_with(const std::vector<std::uint8_t>& bytes, std::string_view text) {
    return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

/// The decoders of OpenCV write lines of their own to stderr. What they would complain of is looked for before.
cv::Mat decode(std::vector<std::uint8_t> bytes, const std::string& path) {
    if (begins_with(bytes, "\xff\xd8")) {
        return decode_jpeg(bytes, path);
    }
    if (begins_with(bytes, "\x89PNG\r\n\x1a\n")) {
        bytes = checked_png(bytes, path);
    } else if (const auto least = least_size(bytes); least && bytes.size() < *least) {
        refuse(path, "is damaged: the file was cut off, " + std::to_string(bytes.size()) + " of " +
                         std::to_string(*least) + " bytes are there");
    }
    if (is_text_image(bytes)) {
        if (is_cut_text_image(bytes)) {
            refuse(path, "is damaged: the file was cut off, values are missing");
        }
        bytes.push_back('\n');  // OpenCV wants to read on behind the last number
    }
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
}

/// Decodes the bytes of an image whose header was checked. `take_bytes` may want more memory than there is, too.
template <class TakeBytes>
cv::Mat decode_of_size(TakeBytes&& take_bytes, ImageSize size, const std::string& path) {
    cv::Mat image;
    const auto no_memory = [&] {
        return std::runtime_error(path + ": there is not enough memory for an image of " +
                                  base::size_text(size.width, size.height) + " pixels");
    };
    try {
        image = decode(take_bytes(), path);
    } catch (const std::bad_alloc&) {
        throw no_memory();
    } catch (const cv::Exception& error) {
        if (error.code == cv::Error::StsNoMem) {
            throw no_memory();
        }
    }
    if (image.empty()) {
        refuse(path, std::string("is damaged, or no image of a kind that can be read (") + kinds + ")");
    }
    return image;
}

}  // namespace

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
