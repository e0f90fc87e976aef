// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <istream>
#include <optional>
#include <span>
#include <string_view>

namespace disparityd::capture {

/// The size of an image in pixels.
struct ImageSize {
    int width = 0;
    int height = 0;
    bool operator==(const ImageSize&) const = default;
};

/// Returns the size in the header of an image: PNG, JPEG, PBM, PGM, PPM, PFM, BMP, TIFF or WebP. Returns nullopt for
/// any other file, and where the header is damaged. Sides beyond 2^31 - 1 are returned as that. Of a TIFF in tiles, a
/// tile larger than the image counts as its size: decoders take memory for it. Reads a few KiB, decodes nothing.
std::optional<ImageSize> read_image_header(std::istream& file);

/// Returns how an image is to be turned or mirrored before it is shown: 1 to 8, as EXIF and TIFF number it, 1 = as it
/// is stored. Looks at the EXIF data of JPEG, PNG and WebP and at the tag of TIFF; 1 where there is none. Decodes
/// nothing.
int read_image_orientation(std::istream& file);

/// Returns the largest value that a PGM or PPM states for its pixels; nothing for all other files.
std::optional<std::uint64_t> read_largest_value(std::istream& file);

/// Reads the numbers behind the magic number of a PBM, PGM or PPM, with comments between. Returns where the last of
/// them ends; 0 where one is missing.
std::size_t read_pnm_numbers(std::string_view head, std::span<std::uint64_t> numbers);

}  // namespace disparityd::capture
