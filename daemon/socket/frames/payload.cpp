// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/frames/payload.h"

#include <utility>

namespace disparityd::daemon {

Payload::Payload(std::vector<std::uint8_t> bytes) : bytes_(std::move(bytes)), size_(bytes_.size()) {
    parts_.emplace_back(bytes_);
}

Payload::Payload(std::vector<std::span<const std::uint8_t>> parts, FrameHandle frame)
    : parts_(std::move(parts)), frame_(std::move(frame)) {
    for (const auto& part : parts_) {
        size_ += part.size();
    }
}

void Payload::keep_copy() {
    if (!frame_) {
        return;
    }
    bytes_.reserve(size_);
    for (const auto& part : parts_) {
        bytes_.insert(bytes_.end(), part.begin(), part.end());
    }
    parts_ = {bytes_};
    frame_.reset();
}

}  // namespace disparityd::daemon
