// SPDX-License-Identifier: Apache-2.0
#include "capture/bag/bag_source.h"

#include "capture/bag/bag_reader.h"
#include "capture/bag/bag_uri.h"
#include "capture/recording/recording_source.h"

namespace disparityd::capture {

std::unique_ptr<FrameSource> open_bag(const SourceOptions& options) {
    return play(options, [uri = parse_bag_uri(options.uri), calibrated = !options.calibration_path.empty()] {
        return std::make_unique<BagReader>(uri, !calibrated);
    });
}

}  // namespace disparityd::capture
