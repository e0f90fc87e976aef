// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <istream>
#include <optional>

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

}  // namespace disparityd::capture
