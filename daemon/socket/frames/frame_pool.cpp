// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/frames/frame_pool.h"

#include <cstring>
#include <utility>

namespace disparityd::daemon {

FramePool::FramePool(const StreamLayout& layout, std::size_t frames)
    : products_(layout.products), state_(std::make_shared<State>()) {
    state_->free.reserve(frames);
    for (std::size_t i = 0; i < frames; ++i) {
        auto frame = std::make_unique<FrameCopy>();
        for (const v1::Product product : products_) {
            frame->shapes[static_cast<std::size_t>(product)] = product_shape(layout, product);
            frame->planes[static_cast<std::size_t>(product)].resize(product_shape(layout, product).bytes());
        }
        state_->free.push_back(std::move(frame));
    }
}

FrameHandle FramePool::copy(const PublishedFrame& frame, std::uint32_t wanted) {
    std::unique_ptr<FrameCopy> target;
    {
        const std::lock_guard lock(state_->mutex);
        if (state_->free.empty()) {
            return nullptr;
        }
        target = std::move(state_->free.back());
        state_->free.pop_back();
    }
    target->info = frame.info;
    target->captured = frame.captured;
    target->published = frame.published;
    target->products = 0;
    for (std::size_t i = 0; i < products_.size(); ++i) {
        const auto& plane = frame.planes[i];
        if ((wanted & product_bit(products_[i])) == 0 || !plane) {
            continue;
        }
        target->products |= product_bit(products_[i]);
        std::uint8_t* row = target->planes[static_cast<std::size_t>(products_[i])].data();
        for (int y = 0; y < plane.height; ++y, row += plane.width) {
            std::memcpy(row, plane.row(y), static_cast<std::size_t>(plane.width));
        }
    }
    return {target.release(), [state = state_](FrameCopy* done) {
                std::unique_ptr<FrameCopy> owned(done);
                const std::lock_guard lock(state->mutex);
                state->free.push_back(std::move(owned));
            }};
}

}  // namespace disparityd::daemon
