// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/live_session.h"

#include <algorithm>
#include <exception>
#include <utility>

#include <boost/asio/post.hpp>

namespace disparityd::web {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds sensors_interval{100};

}  // namespace

void LiveSession::on_open(MessageLink& link) {
    link_ = &link;
    ++place_.counters.clients;
    greet(place_.hub.state());
    on_state(place_.hub.state());
    place_.hub.add(weak_from_this());
}

void LiveSession::greet(const DaemonState& state) {
    told_products_ = state.products;
    link_->send_text(hello_message(state));
}

void LiveSession::on_closed() {
    link_ = nullptr;
    timer_.cancel();
    --place_.counters.clients;
    place_.hub.update_wants();
}

void LiveSession::on_text(std::string_view text) {
    std::visit([this](const auto& request) { handle(request); }, parse_live_request(text));
}

void LiveSession::handle(const LiveSubscription& subscription) {
    if (subscription.encoding != subscription_.encoding) {
        pace_.forget_way(steady_clock::now());
    }
    subscription_ = subscription;
    pace_.set_max_rate(subscription.max_rate);
    if (!subscription.wants_frames()) {
        waiting_ = nullptr;
    }
    place_.hub.update_wants();
}

void LiveSession::handle(const Seen& seen) {
    pace_.seen(seen.publish_index, steady_clock::now());
    send_next();
}

void LiveSession::handle(const Point& point) {
    point_ = point;
    place_.hub.update_wants();
}

void LiveSession::handle(const WrongMessage& wrong) {
    link_->send_text(error_message(wrong.error));
}

Wants LiveSession::wants() const {
    Wants wants;
    if (link_ == nullptr) {
        return wants;
    }
    for (const Image image : subscription_.images) {
        wants.products.merge(products_of(image));
    }
    if (subscription_.cloud_step > 0) {
        wants.products.insert(disparity::Product::disparity);
    }
    if (subscription_.scan) {
        wants.products.insert(disparity::Product::scan);
    }
    if (point_.pixel && subscription_.wants_frames()) {
        wants.products.insert(
            {disparity::Product::disparity, disparity::Product::confidence, disparity::Product::depth_error});
    }
    wants.sensors = subscription_.sensors;
    wants.status = true;
    return wants;
}

void LiveSession::on_frame(const std::shared_ptr<const LiveFrame>& frame) {
    if (link_ == nullptr || !subscription_.wants_frames()) {
        return;
    }
    waiting_ = frame;
    ++passed_;
    send_next();
}

void LiveSession::on_state(const DaemonState& state) {
    if (link_ != nullptr) {
        if (state.there && state.products != told_products_) {
            greet(state);
        }
        facts_.scale = scale();
        link_->send_text(status_message(state, facts_));
    }
}

void LiveSession::on_sensors(const disparity::SensorBatch& batch) {
    const auto now = steady_clock::now();
    if (link_ != nullptr && subscription_.sensors && !batch.samples.empty() && now >= sensors_next_) {
        sensors_next_ = now + sensors_interval;
        link_->send_text(sensors_message(batch));
    }
}

/// Returns how many times smaller than asked images are made. Values are wanted whole, or not at all.
int LiveSession::scale() const {
    return subscription_.encoding == Encoding::jpeg ? pace_.scale() : 1;
}

std::vector<ImageView> LiveSession::views() const {
    std::vector<ImageView> views;
    for (const Image image : subscription_.images) {
        ImageView view{image, subscription_.encoding, subscription_.max_width, 80, std::nullopt};
        if (facts_of(image).view == v1::DISTANCE) {
            view.range = subscription_.range;
        }
        if (scale() > 1) {
            const int width = static_cast<int>(waiting_->frame.width);
            const int asked = view.max_width > 0 ? std::min(view.max_width, width) : width;
            view.max_width = std::max(asked / scale(), 16);
        }
        views.push_back(view);
    }
    return views;
}

/// Sends the newest frame when there is one and the connection is ready for it. The images are made in the encoding
/// thread, and the message here.
void LiveSession::send_next() {
    const auto now = steady_clock::now();
    if (link_ == nullptr || encoding_ || waiting_ == nullptr || link_->busy()) {
        return;
    }
    if (!pace_.ready(now)) {
        if (pace_.held_by_rate(now)) {
            wait_for_rate();
        }
        return;
    }
    encoding_ = true;
    LiveContents contents;
    contents.point = point_;
    contents.scan = subscription_.scan;
    contents.scale = scale();
    contents.skipped = passed_ - 1;
    std::vector<ImageView> wanted = views();
    auto encode_and_send = [self = shared_from_this(), live = std::exchange(waiting_, nullptr),
                            wanted = std::move(wanted), step = subscription_.cloud_step,
                            contents = std::move(contents)]() mutable {
        std::vector<Bytes> parts;
        try {
            for (const ImageView& view : wanted) {
                if (auto image = encode(*live, view)) {
                    contents.images.push_back(std::move(image));
                }
            }
            contents.cloud = depth_grid(*live, step);
            parts = frame_message(*live, contents);
        } catch (const std::exception&) {
            // A frame that cannot be encoded is left out; the next one comes soon.
        }
        boost::asio::post(self->place_.network, [self, live, parts = std::move(parts), skipped = contents.skipped] {
            self->send(*live, parts, skipped);
        });
    };
    passed_ = 0;
    place_.encoding.add(peer_, std::move(encode_and_send));
}

void LiveSession::send(const LiveFrame& live, const std::vector<Bytes>& parts, std::uint64_t skipped) {
    encoding_ = false;
    if (link_ == nullptr) {
        return;
    }
    if (!parts.empty()) {
        pace_.sent(live.frame.publish_index, steady_clock::now());
        WebCounters& counters = place_.counters;
        for (const Bytes& part : parts) {
            facts_.sent_bytes += part->size();
            counters.bytes_sent += part->size();
        }
        ++facts_.frames;
        ++counters.frames_sent;
        facts_.skipped += skipped;
        counters.frames_skipped += skipped;
        link_->send_binary(parts);
    }
    send_next();
}

void LiveSession::wait_for_rate() {
    timer_.expires_at(pace_.next());
    timer_.async_wait([weak = weak_from_this()](const boost::system::error_code& error) {
        if (const auto self = weak.lock(); self && !error) {
            self->send_next();
        }
    });
}

}  // namespace disparityd::web
