// SPDX-License-Identifier: Apache-2.0
#include "capture/images/png_image.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string_view>

#include <zlib.h>

namespace disparityd::capture {
namespace {

constexpr std::size_t signature_size = 8;
constexpr std::size_t frame_size = 12;  // of a chunk: length, name, checksum
constexpr std::array<std::string_view, 5> of_pixels{"IHDR", "PLTE", "tRNS", "IDAT", "IEND"};

std::uint32_t big_endian_number(std::span<const std::uint8_t> bytes) {
    return std::uint32_t{bytes[0]} << 24U | std::uint32_t{bytes[1]} << 16U | std::uint32_t{bytes[2]} << 8U | bytes[3];
}

}  // namespace

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

}  // namespace disparityd::capture
