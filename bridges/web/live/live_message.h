// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "bridges/web/daemon/hub.h"
#include "bridges/web/images/image_encoder.h"
#include "bridges/web/images/image_view.h"
#include "bridges/web/live/message_link.h"

/// The messages of the page's WebSocket, without I/O. docs/web.md defines them.
namespace disparityd::web {

/// What a page asks for.
struct LiveSubscription {
    std::vector<Image> images;
    Encoding encoding = Encoding::jpeg;
    int max_width = 640;  ///< px; 0 = as it is
    double max_rate = 0;  ///< frames per second; 0 = all
    std::optional<RangeM> range;
    int cloud_step = 0;  ///< 0 = no cloud
    bool scan = false;
    bool sensors = false;

    bool wants_frames() const { return !images.empty() || cloud_step > 0 || scan; }
};

/// The page has drawn a frame.
struct Seen {
    std::uint64_t publish_index = 0;
};

/// The page shows the values of a pixel of the whole rectified image; absent = of none.
struct Point {
    std::optional<std::pair<std::uint32_t, std::uint32_t>> pixel;
};

/// What was wrong with a message: one line.
struct WrongMessage {
    std::string error;
};

using LiveRequest = std::variant<LiveSubscription, Seen, Point, WrongMessage>;

/// Never throws: whatever comes is one of the above.
LiveRequest parse_live_request(std::string_view text);

/// What one connection is told of a frame.
struct LiveContents {
    std::vector<std::shared_ptr<const EncodedImage>> images;
    std::shared_ptr<const DepthGrid> cloud;
    Point point;
    bool scan = false;
    std::uint64_t skipped = 0;  ///< frames since the last one of this connection
    int scale = 1;              ///< the images are so many times smaller than asked
};

/// Returns the parts of the message: its length and header, then the payload.
std::vector<Bytes> frame_message(const LiveFrame& live, const LiveContents& contents);

/// What the link of one connection has carried.
struct LinkFacts {
    std::uint64_t sent_bytes = 0;
    std::uint64_t frames = 0;
    std::uint64_t skipped = 0;
    int scale = 1;
};

std::string hello_message(const DaemonState& state);
std::string status_message(const DaemonState& state, const LinkFacts& link);
std::string sensors_message(const disparity::SensorBatch& batch);
std::string error_message(const std::string& text);

}  // namespace disparityd::web
