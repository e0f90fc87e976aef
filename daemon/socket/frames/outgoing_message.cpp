// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/frames/outgoing_message.h"

#include <algorithm>
#include <span>
#include <utility>

namespace disparityd::daemon {

std::vector<std::uint8_t>& OutgoingMessage::start(std::shared_ptr<const EncodedPlanes> planes) {
    planes_ = std::move(planes);
    sent_ = 0;
    head_.clear();
    return head_;
}

OutgoingMessage::Buffers OutgoingMessage::rest() const {
    Buffers buffers;
    std::size_t count = 0;
    std::size_t skip = sent_;
    const auto add = [&](std::span<const std::uint8_t> part) {
        const std::size_t skipped = std::min(skip, part.size());
        skip -= skipped;
        buffers.at(count++) = boost::asio::buffer(part.data() + skipped, part.size() - skipped);
    };
    add(head_);
    if (planes_) {
        for (const auto& part : planes_->bytes.parts()) {
            add(part);
        }
    }
    return buffers;
}

}  // namespace disparityd::daemon
