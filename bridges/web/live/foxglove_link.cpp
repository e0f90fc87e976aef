// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/foxglove_link.h"

#include <chrono>
#include <exception>
#include <string>
#include <utility>

#include <boost/asio/post.hpp>

#include "base/version.h"

namespace disparityd::web {
namespace {

using std::chrono::steady_clock;

std::int64_t now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

/// The same for all connections of this process, another one after a restart.
const std::string& session_id() {
    static const std::string id = std::to_string(now_ns());
    return id;
}

foxglove::Offer offer_of(const DaemonState& state) {
    return state.status ? foxglove::offer_of(*state.status) : foxglove::Offer{};
}

}  // namespace

FoxgloveLink::FoxgloveLink(const Workplace& workplace, std::string peer)
    : place_(workplace),
      peer_(std::move(peer)),
      session_({"disparityd", base::version_line("disparity-web"), session_id()}, offer_of(workplace.hub.state())),
      status_(workplace.hub.state().status) {}

void FoxgloveLink::on_open(MessageLink& link) {
    link_ = &link;
    ++place_.counters.clients;
    send_texts(session_.greeting());
    place_.hub.add(weak_from_this());
}

void FoxgloveLink::on_closed() {
    link_ = nullptr;
    --place_.counters.clients;
    place_.hub.update_wants();
}

void FoxgloveLink::on_text(std::string_view text) {
    send_texts(session_.on_text(text));
    place_.hub.update_wants();
}

void FoxgloveLink::on_answer(std::string_view mark) {
    const auto now = steady_clock::now();
    if (!samples_.answered(mark, now) && frames_.answered(mark, now)) {
        send_next();
    }
}

void FoxgloveLink::on_binary() {
    send_texts(session_.on_binary());
}

Wants FoxgloveLink::wants() const {
    Wants wants;
    if (link_ != nullptr) {
        const foxglove::Wanted wanted = session_.wanted();
        wants.products.insert(wanted.products.begin(), wanted.products.end());
        wants.sensors = wanted.sensors;
        wants.status = true;
    }
    return wants;
}

void FoxgloveLink::on_frame(const std::shared_ptr<const LiveFrame>& frame) {
    if (link_ != nullptr && !session_.wanted().products.empty()) {
        waiting_ = frame;
        ++passed_;
        send_next();
    }
}

void FoxgloveLink::on_state(const DaemonState& state) {
    if (link_ == nullptr) {
        return;
    }
    if (!state.there) {
        send_gone(state.why);
        return;
    }
    send_texts(session_.set_offer(offer_of(state)));
    if (state.status) {
        status_ = state.status;
        send_messages(session_.on_status(*state.status, now_ns()));
    }
    place_.hub.update_wants();
}

/// Viewers keep their panels while the daemon is away, with the last numbers; the state says that they are old.
void FoxgloveLink::send_gone(const std::string& why) {
    if (status_ != nullptr) {
        v1::Status gone = *status_;
        gone.set_state("gone");
        gone.set_detail(why);
        gone.set_rate(0);
        send_messages(session_.on_status(gone, now_ns()));
    }
}

void FoxgloveLink::on_sensors(const disparity::SensorBatch& batch) {
    if (link_ == nullptr || link_->busy() || !samples_.ready(steady_clock::now())) {
        return;
    }
    const std::vector<foxglove::Message> messages = session_.on_sensors(batch, now_ns());
    if (!messages.empty()) {
        send_messages(messages);
        link_->ask_for_answer(samples_.sent(steady_clock::now()));
    }
}

void FoxgloveLink::send_texts(const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
        link_->send_text(text);
    }
}

void FoxgloveLink::send_messages(const std::vector<foxglove::Message>& messages) {
    for (const foxglove::Message& message : messages) {
        place_.counters.bytes_sent += message.head.size() + message.payload->size();
        link_->send_binary({std::make_shared<const std::string>(message.head), message.payload});
    }
}

/// Sends the newest frame when the messages before it have been read. They are made in the encoding thread.
void FoxgloveLink::send_next() {
    if (link_ == nullptr || encoding_ || waiting_ == nullptr || link_->busy() || !frames_.ready(steady_clock::now())) {
        return;
    }
    encoding_ = true;
    const std::uint64_t skipped = std::exchange(passed_, 0) - 1;
    place_.counters.frames_skipped += skipped;
    place_.encoding.add(peer_, [self = shared_from_this(), live = std::exchange(waiting_, nullptr),
                                channels = session_.subscribed(), received = now_ns()] {
        foxglove::Payloads payloads;
        try {
            if (!live->foxglove) {
                live->foxglove = std::make_unique<foxglove::EncodedFrame>(live->frame);
            }
            payloads = live->foxglove->payloads(channels);
        } catch (const std::exception&) {
            // A frame that cannot be encoded is left out; the next one comes soon.
        }
        boost::asio::post(self->place_.network, [self, payloads, received] { self->send_frame(payloads, received); });
    });
}

void FoxgloveLink::send_frame(const foxglove::Payloads& payloads, std::int64_t received_ns) {
    encoding_ = false;
    if (link_ != nullptr) {
        const std::vector<foxglove::Message> messages = session_.on_payloads(payloads, received_ns);
        if (!messages.empty()) {
            ++place_.counters.frames_sent;
            send_messages(messages);
            link_->ask_for_answer(frames_.sent(steady_clock::now()));
        }
        send_next();
    }
}

}  // namespace disparityd::web
