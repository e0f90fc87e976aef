// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/frames/frame_ring.h"

#include <algorithm>
#include <utility>

namespace disparityd::daemon {

void FrameRing::set_capacity(std::size_t capacity) {
    capacity_ = capacity;
    shrink_to(capacity_);
}

void FrameRing::put(FrameHandle frame) {
    end_ = frame->info.publish_index + 1;
    entries_.push_back({std::move(frame), {}});
    shrink_to(capacity_);
}

void FrameRing::clear() {
    shrink_to(0);
}

void FrameRing::shrink_to(std::size_t frames) {
    while (entries_.size() > frames) {
        for (const Entry::Variant& variant : entries_.front().variants) {
            if (const auto planes = variant.planes.lock()) {
                planes->bytes.keep_copy();
            }
        }
        entries_.pop_front();
    }
}

FrameHandle FrameRing::next(std::uint64_t publish_index) const {
    const auto entry = std::find_if(entries_.begin(), entries_.end(), [publish_index](const Entry& candidate) {
        return candidate.frame->info.publish_index >= publish_index;
    });
    return entry == entries_.end() ? nullptr : entry->frame;
}

std::shared_ptr<const EncodedPlanes> FrameRing::encoded(const FrameHandle& frame, const Selection& selection) {
    const auto entry = std::find_if(entries_.begin(), entries_.end(),
                                    [&frame](const Entry& candidate) { return candidate.frame == frame; });
    std::erase_if(entry->variants, [](const Entry::Variant& variant) { return variant.planes.expired(); });
    for (const Entry::Variant& variant : entry->variants) {
        if (variant.selection == selection) {
            if (auto planes = variant.planes.lock()) {
                return planes;
            }
        }
    }
    auto planes = std::make_shared<EncodedPlanes>(encoder_.encode(frame, selection));
    entry->variants.push_back({selection, planes});
    return planes;
}

}  // namespace disparityd::daemon
