// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/mjpeg_session.h"

#include <exception>
#include <string>
#include <utility>

#include <boost/asio/post.hpp>

#include "bridges/web/images/image_encoder.h"

namespace disparityd::web {

using std::chrono::steady_clock;

MjpegSession::MjpegSession(const Workplace& workplace, std::string peer, const ImageView& view, double rate)
    : place_(workplace), peer_(std::move(peer)), view_(view) {
    if (rate > 0) {
        interval_ = std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(1 / rate));
    }
}

void MjpegSession::on_open(MessageLink& link) {
    link_ = &link;
    ++place_.counters.clients;
    place_.hub.add(weak_from_this());
}

void MjpegSession::on_closed() {
    link_ = nullptr;
    --place_.counters.clients;
    place_.hub.update_wants();
}

Wants MjpegSession::wants() const {
    Wants wants;
    if (link_ != nullptr) {
        wants.products.merge(products_of(view_.image));
    }
    return wants;
}

void MjpegSession::on_frame(const std::shared_ptr<const LiveFrame>& frame) {
    const auto now = steady_clock::now();
    if (now >= next_) {
        // Half an interval of slack: a source of the same rate loses no frame to its jitter.
        next_ = std::max(next_ + interval_, now + interval_ / 2);
        waiting_ = frame;
        send_next();
    }
}

void MjpegSession::send_next() {
    if (link_ == nullptr || waiting_ == nullptr || encoding_ || link_->busy()) {
        return;
    }
    encoding_ = true;
    place_.encoding.add(peer_, [self = shared_from_this(), live = std::exchange(waiting_, nullptr)] {
        std::shared_ptr<const EncodedImage> image;
        try {
            image = encode(*live, self->view_);
        } catch (const std::exception&) {
            // A frame that cannot be encoded is left out; the next one comes soon.
        }
        const double captured_s = static_cast<double>(live->frame.realtime_ns) / 1e9;
        boost::asio::post(self->place_.network, [self, image, captured_s] { self->send(image, captured_s); });
    });
}

void MjpegSession::send(const std::shared_ptr<const EncodedImage>& image, double captured_s) {
    encoding_ = false;
    if (link_ == nullptr || image == nullptr) {
        return;
    }
    place_.counters.bytes_sent += image->bytes->size();
    ++place_.counters.frames_sent;
    const std::string head = std::string("--") + boundary +
                             "\r\nContent-Type: image/jpeg\r\nContent-Length: " + std::to_string(image->bytes->size()) +
                             "\r\nX-Timestamp: " + std::to_string(captured_s) + "\r\n\r\n";
    link_->send_binary(
        {std::make_shared<const std::string>(head), image->bytes, std::make_shared<const std::string>("\r\n")});
}

}  // namespace disparityd::web
