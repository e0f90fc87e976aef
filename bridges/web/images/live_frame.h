// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>

#include "bridges/web/foxglove/encoded_frame.h"
#include "bridges/web/images/image_view.h"
#include "clients/cpp/disparity_client.hpp"

namespace disparityd::web {

/// A thinned depth image for a cloud of points: pixel (i, j) is the nearest of `step` columns and rows of the whole
/// image from (i * step, j * step) on, so that nothing thin is lost.
struct DepthGrid {
    int step = 1;
    int width = 0;
    int height = 0;
    std::shared_ptr<const std::string> bytes;  ///< u16, mm; 0 = unknown, 65535 = too far; zlib's format
};

/// A frame of the daemon on its way to the connections. `frame` does not change any more.
struct LiveFrame {
    disparity::Frame frame;
    std::chrono::steady_clock::time_point received;
    /// What was encoded of the frame: connections that ask for the same share it. Only the encoding thread touches it.
    mutable std::map<ImageView, std::shared_ptr<const EncodedImage>> encoded;
    mutable std::map<int, std::shared_ptr<const DepthGrid>> grids;  ///< by their step
    mutable std::unique_ptr<foxglove::EncodedFrame> foxglove;       ///< the same for Foxglove's viewers
};

/// Returns the age of the frame now, from its capture, in ms: by this machine's clock where it agrees with the age that
/// the daemon told; a replayed frame has the time of its recording.
double age_ms(const LiveFrame& live);

}  // namespace disparityd::web
