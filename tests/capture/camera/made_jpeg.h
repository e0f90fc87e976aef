// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace disparityd::capture::test {

using Bytes = std::vector<std::uint8_t>;

/// A JPEG of a made picture with edges and noise, which `seed` chooses. `subsampling` is one of TurboJPEG's TJSAMP,
/// `flags` are its own (TJFLAG_PROGRESSIVE).
Bytes made_jpeg(int width, int height, int subsampling, unsigned seed, int flags = 0);

/// The values of a JPEG as TurboJPEG decodes them.
struct Planes {
    Bytes luma, u, v;
    int columns = 0;  ///< of a row of u and v
    int rows = 0;
    bool clean = false;  ///< without a warning
};
Planes planes_of(const Bytes& jpeg, int width, int height);

/// The frame of YUYV that these planes are, each pair of pixels by itself. The width is a multiple of 4.
Bytes yuyv_of(const Planes& planes, int width, int height);

}  // namespace disparityd::capture::test
