// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_checksum.h"

#include <zlib.h>

#include "base/little_endian.h"
#include "capture/pixel_format.h"

namespace disparityd::capture::recording {
namespace {

constexpr std::size_t checksum_size = 4;

}  // namespace

std::uint32_t checksum(std::span<const std::uint8_t> bytes) {
    return static_cast<std::uint32_t>(::crc32_z(0, bytes.data(), bytes.size()));
}

std::uint32_t checksum(const RawImage& image) {
    const auto row =
        2 * static_cast<std::size_t>(image.eye_width) * static_cast<std::size_t>(bytes_per_pixel(image.format));
    uLong sum = 0;
    for (int y = 0; y < image.height; ++y) {
        sum = ::crc32_z(sum, image.data + y * image.stride, row);
    }
    return static_cast<std::uint32_t>(sum);
}

void put_checksums(std::uint32_t picture, std::span<std::uint8_t> addition) {
    const std::span<std::uint8_t> before = addition.first(addition.size() - checksum_size);
    base::put_little_endian(&before[before.size() - checksum_size], picture, checksum_size);
    base::put_little_endian(&addition[before.size()], checksum(before), checksum_size);
}

std::optional<StoredChecksums> get_checksums(std::span<const std::uint8_t> addition) {
    if (addition.size() < checksums_size) {
        return std::nullopt;
    }
    const std::span<const std::uint8_t> before = addition.first(addition.size() - checksum_size);
    const auto number = [&addition](std::size_t at) {
        return static_cast<std::uint32_t>(base::get_little_endian(&addition[at], checksum_size));
    };
    return StoredChecksums{number(before.size()) == checksum(before), number(before.size() - checksum_size)};
}

}  // namespace disparityd::capture::recording
