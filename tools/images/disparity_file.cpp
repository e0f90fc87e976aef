// SPDX-License-Identifier: Apache-2.0
#include "tools/images/disparity_file.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <locale>
#include <stdexcept>

#include "base/failure_text.h"
#include "tools/images/image_file.h"
#include "tools/images/picture.h"

namespace disparityd::images {
namespace {

constexpr float rejected = std::numeric_limits<float>::infinity();
constexpr int png_scale = 256;
constexpr int png_max = 65535;

std::uint32_t swapped(std::uint32_t word) {
    return word >> 24 | (word >> 8 & 0xff00U) | (word << 8 & 0xff0000U) | word << 24;
}

std::uint32_t little_endian(std::uint32_t word) {
    return std::endian::native == std::endian::little ? word : swapped(word);
}

[[noreturn]] void refuse_pfm(const std::string& path, const std::string& found) {
    throw std::invalid_argument(path + ": found " + found +
                                "; allowed: a grey PFM picture (\"Pf\", width, height, scale, then 32-bit floats)");
}

}  // namespace

bool fits_png(DisparityRange range) {
    return range.first >= 0 && (range.first + range.count - 1) * png_scale <= png_max;
}

cv::Mat disparity_picture(const DisparityMap& map) {
    cv::Mat picture(map.d16.height, map.d16.width, CV_16UC1);
    for (int y = 0; y < map.d16.height; ++y) {
        auto* row = picture.ptr<std::uint16_t>(y);
        for (int x = 0; x < map.d16.width; ++x) {
            const std::int16_t d16 = map.d16.at(x, y);
            row[x] = d16 == map.invalid() ? std::uint16_t{0}
                                          : static_cast<std::uint16_t>(std::clamp(d16 * (png_scale / 16), 1, png_max));
        }
    }
    return picture;
}

void write_disparity_png(const std::string& path, const DisparityMap& map) {
    write_png(path, disparity_picture(map));
}

void write_disparity_pfm(const std::string& path, const DisparityMap& map) {
    write_disparity_pfm(path, to_float(map));
}

void write_disparity_pfm(const std::string& path, const FloatMap& values) {
    const std::string header = "Pf\n" + std::to_string(values.width) + ' ' + std::to_string(values.height) + "\n-1.0\n";
    std::vector<std::uint8_t> bytes(header.size() + values.values.size() * 4);
    std::memcpy(bytes.data(), header.data(), header.size());
    std::uint8_t* to = bytes.data() + header.size();
    for (int y = values.height - 1; y >= 0; --y) {
        for (int x = 0; x < values.width; ++x, to += 4) {
            const std::uint32_t word = little_endian(std::bit_cast<std::uint32_t>(values.at(x, y)));
            std::memcpy(to, &word, 4);
        }
    }
    write_file(path, bytes);
}

void write_depth_png(const std::string& path, Plane<const std::uint16_t> depth) {
    write_png(path, depth_view(depth));
}

FloatMap read_disparity_png(const std::string& path) {
    const cv::Mat picture = read_image(path);
    if (picture.type() != CV_16UC1) {
        throw std::invalid_argument(path + ": found " + std::to_string(picture.channels()) + " channels of " +
                                    std::to_string(picture.elemSize1() * 8) +
                                    " bits; allowed: one channel of 16 bits, disparity x 256");
    }
    FloatMap map{picture.cols, picture.rows, {}};
    for (int y = 0; y < map.height; ++y) {
        std::transform(picture.ptr<std::uint16_t>(y), picture.ptr<std::uint16_t>(y) + map.width,
                       std::back_inserter(map.values), [](std::uint16_t value) {
                           return value == 0 ? rejected : static_cast<float>(value) / static_cast<float>(png_scale);
                       });
    }
    return map;
}

FloatMap read_disparity_pfm(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        refuse_pfm(path, std::string("nothing to read: ") + base::error_text(errno));
    }
    std::string kind;
    FloatMap map;
    double scale = 0;
    file.imbue(std::locale::classic());
    file >> kind >> map.width >> map.height >> scale;
    constexpr int largest = 8192;
    if (!file || kind != "Pf" || map.width < 1 || map.height < 1 || map.width > largest || map.height > largest ||
        scale == 0 || !std::isfinite(scale)) {
        refuse_pfm(path, "another header");
    }
    const int line_end = file.get();
    const std::size_t count = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
    std::error_code error;
    const auto length = std::filesystem::file_size(path, error);
    // A header with the line ends of Windows has a byte more; a pixel may begin with that value, too.
    if (line_end == '\r' && file.peek() == '\n' && !error &&
        length == static_cast<std::uintmax_t>(file.tellg()) + 1 + 4 * count) {
        file.get();
    }
    if (!error && length < 4 * count) {
        refuse_pfm(path, std::to_string(length) + " bytes in all where the pixels alone should be " +
                             std::to_string(4 * count));  // before memory is taken for them
    }
    std::vector<std::uint32_t> words(count);
    file.read(reinterpret_cast<char*>(words.data()), static_cast<std::streamsize>(count * 4));
    if (static_cast<std::size_t>(file.gcount()) != count * 4) {
        refuse_pfm(path, std::to_string(file.gcount()) + " bytes of pixels where " + std::to_string(count * 4) +
                             " are announced");
    }
    map.values.resize(count);
    const bool foreign = (scale < 0) != (std::endian::native == std::endian::little);
    for (int y = 0; y < map.height; ++y) {
        const auto from = static_cast<std::size_t>(map.height - 1 - y) * static_cast<std::size_t>(map.width);
        const auto to = static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width);
        for (std::size_t x = 0; x < static_cast<std::size_t>(map.width); ++x) {
            const std::uint32_t word = words[from + x];
            const float value = std::bit_cast<float>(foreign ? swapped(word) : word);
            map.values[to + x] = std::isfinite(value) ? value : rejected;
        }
    }
    return map;
}

}  // namespace disparityd::images
