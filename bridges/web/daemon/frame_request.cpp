// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon/frame_request.h"

#include <algorithm>
#include <utility>

namespace disparityd::web {

void FrameRequest::start(boost::asio::io_context& network, Hub& hub, std::set<disparity::Product> needed,
                         const std::set<disparity::Product>& welcome, Answer answer) {
    constexpr std::chrono::seconds patience{3};
    const std::shared_ptr<FrameRequest> request(new FrameRequest(network, hub));
    request->wanted_ = needed;
    request->wanted_.insert(welcome.begin(), welcome.end());
    request->needed_ = std::move(needed);
    request->answer_ = std::move(answer);
    request->timer_.expires_after(patience);
    // The timer keeps the request alive.
    request->timer_.async_wait([request](const boost::system::error_code&) { request->finish(nullptr); });
    hub.add(request);
}

void FrameRequest::on_frame(const std::shared_ptr<const LiveFrame>& frame) {
    const auto has = [&](disparity::Product product) { return frame->frame.plane(product) != nullptr; };
    if (std::all_of(needed_.begin(), needed_.end(), has)) {
        finish(frame);
    }
}

Wants FrameRequest::wants() const {
    return answer_ ? Wants{wanted_, false} : Wants{};
}

void FrameRequest::finish(const std::shared_ptr<const LiveFrame>& frame) {
    if (const Answer answer = std::exchange(answer_, nullptr)) {
        timer_.cancel();
        hub_.update_wants();
        answer(frame);
    }
}

}  // namespace disparityd::web
