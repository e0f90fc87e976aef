// SPDX-License-Identifier: Apache-2.0
#include "capture/bag/bag_source.h"

#include <optional>

#include "capture/bag/bag_reader.h"
#include "capture/bag/bag_uri.h"
#include "capture/recording/recording_source.h"

namespace disparityd::capture {

std::unique_ptr<FrameSource> open_bag(const SourceOptions& options) {
    // What the first round has found holds for the others: to find it, much of a bag may have to be read.
    const auto topics = std::make_shared<std::optional<ChosenTopics>>();
    return play(options, [uri = parse_bag_uri(options.uri),
                          calibrated = options.calibrated && options.calibration_path.empty(), topics] {
        auto reader = std::make_unique<BagReader>(uri, calibrated && !*topics, *topics);
        *topics = reader->topics();
        return reader;
    });
}

}  // namespace disparityd::capture
