// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "proto/disparity.pb.h"
#include "proto/text.h"

namespace disparityd::proto {

/// Returns the message about a recording. `numbers` is any structure with frames, dropped, lost, bytes, seconds and
/// error.
template <typename Numbers>
v1::RecordStatus record_message(const Numbers& numbers, const std::string& path, bool active) {
    v1::RecordStatus message;
    message.set_active(active);
    message.set_path(to_valid_utf8(path));
    message.set_frames(numbers.frames);
    message.set_dropped(numbers.dropped);
    message.set_lost(numbers.lost);
    message.set_bytes(numbers.bytes);
    message.set_seconds(numbers.seconds);
    message.set_error(to_valid_utf8(numbers.error));
    return message;
}

}  // namespace disparityd::proto
