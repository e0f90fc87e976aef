// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/mjpeg_session.h"

#include <algorithm>
#include <exception>
#include <string>
#include <utility>

#include <boost/asio/post.hpp>

#include "bridges/web/images/image_encoder.h"
#include "bridges/web/images/no_picture.h"

namespace disparityd::web {
namespace {

using std::chrono::steady_clock;

/// So long no frame has come when a stream is told to have none: three times the last pause, within these.
constexpr std::chrono::seconds shortest_silence{5};
constexpr std::chrono::seconds longest_silence{60};

}  // namespace

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
    if (!place_.hub.state().there) {
        return;  // it was on its way when its daemon went, and none would follow it
    }
    gap_ = came_ == steady_clock::time_point() ? steady_clock::duration() : now - came_;
    came_ = now;
    silent_ = false;
    notices_due_ = 0;
    if (now >= next_) {
        // Half an interval of slack: a source of the same rate loses no frame to its jitter.
        next_ = std::max(next_ + interval_, now + interval_ / 2);
        waiting_ = frame;
        send_next();
    }
}

void MjpegSession::on_state(const DaemonState& state) {
    const auto patience = std::clamp<steady_clock::duration>(3 * gap_, shortest_silence, longest_silence);
    const bool none_come = !state.there || steady_clock::now() - came_ > patience;
    if (came_ != steady_clock::time_point() && none_come && !std::exchange(silent_, true)) {
        waiting_ = nullptr;
        notices_due_ = 2;  // Chromium shows a picture when the next one begins
    }
    send_next();
}

void MjpegSession::send_next() {
    if (!takes_a_part()) {
        return;
    }
    if (const auto live = std::exchange(waiting_, nullptr)) {
        make_and_send([view = view_, live] {
            const std::shared_ptr<const EncodedImage> image = encode(*live, view);
            if (image == nullptr) {
                return Part{};
            }
            const double captured_s = static_cast<double>(live->frame.realtime_ns) / 1e9;
            return Part{image->bytes, image->width, image->height, 1,
                        "X-Timestamp: " + std::to_string(captured_s) + "\r\n"};
        });
    } else if (notices_due_ > 0 && width_ > 0) {
        --notices_due_;
        make_and_send([width = width_, height = height_] {
            return Part{std::make_shared<const std::string>(no_picture_jpeg(width, height)), width, height, 0,
                        "X-No-Picture: no frame comes\r\n"};
        });
    }
}

/// `make` is called in the encoding thread.
void MjpegSession::make_and_send(std::function<Part()> make) {
    encoding_ = true;
    place_.encoding.add(peer_, [self = shared_from_this(), make = std::move(make)] {
        Part part;
        try {
            part = make();
        } catch (const std::exception&) {
            // A frame that cannot be encoded is left out; the next one comes soon.
        }
        boost::asio::post(self->place_.network, [self, part] { self->send(part); });
    });
}

void MjpegSession::send(const Part& part) {
    encoding_ = false;
    if (link_ == nullptr || part.jpeg == nullptr) {
        return;
    }
    width_ = part.width;
    height_ = part.height;
    place_.counters.bytes_sent += part.jpeg->size();
    place_.counters.frames_sent += part.frames;
    const std::string head = std::string("--") + boundary +
                             "\r\nContent-Type: image/jpeg\r\nContent-Length: " + std::to_string(part.jpeg->size()) +
                             "\r\n" + part.facts + "\r\n";
    link_->send_binary(
        {std::make_shared<const std::string>(head), part.jpeg, std::make_shared<const std::string>("\r\n")});
}

}  // namespace disparityd::web
