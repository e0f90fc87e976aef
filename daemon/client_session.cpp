// SPDX-License-Identifier: Apache-2.0
#include "daemon/client_session.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/read.hpp>
#include <fmt/format.h>

#include "capture/message_text.h"
#include "proto/framing.h"

namespace disparityd {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr std::chrono::seconds hello_timeout{5};
/// Answers that may wait for a client before nothing more is read from it.
constexpr std::size_t max_answers = 8;
constexpr std::size_t max_name = 64;  ///< bytes shown
constexpr std::string_view messages_of_clients =
    "hello, subscribe, status_request, record_start, record_stop, camera_request";

}  // namespace

ClientSession::ClientSession(Socket socket, std::string address, std::uint64_t id, SessionHost& host)
    : socket_(std::move(socket)),
      address_(std::move(address)),
      id_(id),
      host_(host),
      deadline_(socket_.get_executor()),
      status_timer_(socket_.get_executor()) {}

void ClientSession::start() {
    deadline_.expires_after(hello_timeout);
    deadline_.async_wait([self = shared_from_this()](error_code error) {
        if (!error && !self->greeted_) {
            self->send_error(
                fmt::format("no Hello within {} s: the first message must be Hello", hello_timeout.count()), true);
        }
    });
    read_length();
}

void ClientSession::refuse(const std::string& why) {
    send_error(why, true);
}

void ClientSession::stop() {
    closed_ = true;
    error_code ignored;
    socket_.close(ignored);
    deadline_.cancel();
    status_timer_.cancel();
}

v1::ClientStatus ClientSession::status() const {
    v1::ClientStatus status;
    status.set_name(name_);
    status.set_address(address_);
    status.set_frames_sent(frames_sent_);
    status.set_frames_skipped(frames_skipped_);
    status.set_bytes_sent(bytes_sent_);
    return status;
}

std::string ClientSession::label() const {
    return fmt::format("client {} ({}{}{})", id_, name_, name_.empty() ? "" : ", ", address_);
}

void ClientSession::read_length() {
    if (closed_ || closing_ || reading_ || answer_pending_ || answers_.size() >= max_answers) {
        return;
    }
    reading_ = true;
    asio::async_read(socket_, asio::buffer(length_), [self = shared_from_this()](error_code error, std::size_t) {
        self->reading_ = false;
        if (self->closed_ || self->closing_) {
            return;
        }
        if (error) {
            self->close(error == asio::error::eof ? "left" : "connection lost: " + error.message());
            return;
        }
        std::uint32_t length = 0;
        try {
            length = proto::decode_length(self->length_);
        } catch (const std::invalid_argument& refused) {
            self->send_error(refused.what(), true);
            return;
        }
        self->read_message(length);
    });
}

void ClientSession::read_message(std::uint32_t length) {
    reading_ = true;
    incoming_.clear();
    // The buffer grows with what arrives, not with what was announced.
    asio::async_read(socket_, asio::dynamic_buffer(incoming_, length), asio::transfer_exactly(length),
                     [self = shared_from_this()](error_code error, std::size_t) {
                         self->reading_ = false;
                         if (self->closed_ || self->closing_) {
                             return;
                         }
                         if (error) {
                             self->close("left in the middle of a message: " + error.message());
                             return;
                         }
                         self->message_arrived();
                     });
}

void ClientSession::message_arrived() {
    v1::Envelope message;
    try {
        proto::decode(incoming_, message);
        incoming_.clear();
        incoming_.shrink_to_fit();
        if (message.payload_bytes() != 0) {
            send_error(fmt::format("a message announces a payload of {} bytes, allowed: 0", message.payload_bytes()),
                       true);
        } else {
            handle(message);
        }
    } catch (const std::invalid_argument& refused) {
        send_error(refused.what(), true);
    }
    read_length();
}

void ClientSession::handle(const v1::Envelope& message) {
    if (!greeted_ && !message.has_hello()) {
        send_error("the first message must be Hello", true);
        return;
    }
    switch (message.body_case()) {
        case v1::Envelope::kHello: hello(message.hello()); break;
        case v1::Envelope::kSubscribe: subscribe(message.subscribe()); break;
        case v1::Envelope::kStatusRequest: {
            v1::Envelope answer;
            *answer.mutable_status() = host_.status();
            send(std::move(answer));
            break;
        }
        case v1::Envelope::kRecordStart:
            answer_pending_ = true;
            host_.start_recording(
                message.record_start().path(),
                [self = shared_from_this()](const v1::RecordStatus& status, const std::string& refusal) {
                    self->answer_recording(status, refusal);
                });
            break;
        case v1::Envelope::kRecordStop:
            answer_pending_ = true;
            host_.stop_recording(
                [self = shared_from_this()](const v1::RecordStatus& status, const std::string& refusal) {
                    self->answer_recording(status, refusal);
                });
            break;
        case v1::Envelope::kCameraRequest: control_camera(message.camera_request()); break;
        case v1::Envelope::BODY_NOT_SET:  // of a newer client, which can do without
            send_error(fmt::format("Envelope: no message that disparityd {} knows, allowed: {}", DISPARITYD_VERSION,
                                   messages_of_clients),
                       false);
            break;
        default:
            send_error(fmt::format("message {} of Envelope is not for clients to send, allowed: {}",
                                   static_cast<int>(message.body_case()), messages_of_clients),
                       true);
    }
}

void ClientSession::hello(const v1::Hello& hello) {
    if (greeted_) {
        send_error("Hello came twice", true);
        return;
    }
    if (hello.protocol_version() != proto::protocol_version) {
        send_error(fmt::format(
                       "the client speaks protocol version {}, this daemon speaks {}: use a client of the same release",
                       hello.protocol_version(), proto::protocol_version),
                   true);
        return;
    }
    greeted_ = true;
    name_ = capture::shown(hello.client_name(), max_name);
    deadline_.cancel();
    v1::Envelope answer;
    v1::Welcome& welcome = *answer.mutable_welcome();
    const StreamLayout& layout = host_.layout();
    welcome.set_protocol_version(proto::protocol_version);
    welcome.set_server_version(DISPARITYD_VERSION);
    *welcome.mutable_geometry() = to_message(layout.geometry);
    for (const v1::Product product : layout.products) {
        welcome.add_products(product);
    }
    welcome.set_shared_memory(layout.shared_memory);
    send(std::move(answer));
    host_.log().came_and_went.write(LogLevel::info, label() + ": connected");
}

void ClientSession::subscribe(const v1::Subscribe& subscribe) {
    Selection selection;
    const StreamLayout& layout = host_.layout();
    for (const int number : subscribe.products()) {
        const auto product = static_cast<v1::Product>(number);
        if (std::find(layout.products.begin(), layout.products.end(), product) == layout.products.end()) {
            std::string allowed;
            for (const v1::Product offered : layout.products) {
                allowed += (allowed.empty() ? "" : ", ") + v1::Product_Name(offered);
            }
            send_error(
                fmt::format("Subscribe: products: found {}, allowed: {} (more by configuration)", number, allowed),
                false);
            return;
        }
        if (std::find(selection.products.begin(), selection.products.end(), product) == selection.products.end()) {
            selection.products.push_back(product);
        }
    }
    selection.region = {subscribe.region().x(), subscribe.region().y(), subscribe.region().width(),
                        subscribe.region().height()};
    selection.encoding = subscribe.encoding();
    std::string wrong = region_problem(selection.region, layout.geometry.width, layout.geometry.height);
    if (!wrong.empty()) {
        wrong = "region: " + wrong;
    } else if (selection.encoding != v1::RAW && selection.encoding != v1::ZSTD) {
        wrong = fmt::format("encoding: found {}, allowed: 0 (raw) or 1 (zstd)", static_cast<int>(selection.encoding));
    } else if (!std::isfinite(subscribe.max_rate()) || subscribe.max_rate() < 0) {
        wrong = fmt::format("max_rate: found {}, allowed: 0 (every frame) or more", subscribe.max_rate());
    } else if (!std::isfinite(subscribe.status_interval_s()) || subscribe.status_interval_s() < 0) {
        wrong = fmt::format("status_interval_s: found {}, allowed: 0 (none) or more", subscribe.status_interval_s());
    }
    if (!wrong.empty()) {
        send_error("Subscribe: " + wrong, false);
        return;
    }
    selection_ = std::move(selection);
    outdated_ = compressing_;
    compressed_.reset();
    if (subscribe.sensors() && !wants_sensors_) {
        next_sample_ = host_.sensors().end();
    }
    wants_sensors_ = subscribe.sensors();
    max_rate_ = subscribe.max_rate();
    next_due_ = {};
    next_index_ = host_.frames().end();
    has_sent_ = false;
    host_.subscription_changed();
    send_status_every(subscribe.status_interval_s());
}

void ClientSession::send_status_every(double seconds) {
    status_timer_.cancel();
    if (seconds <= 0) {
        return;
    }
    const auto interval =
        std::chrono::milliseconds(static_cast<std::int64_t>(std::clamp(seconds, 0.1, 86400.0) * 1000));
    status_timer_.expires_after(interval);
    status_timer_.async_wait([self = shared_from_this(), seconds](error_code error) {
        if (error || self->closed_ || self->closing_) {
            return;
        }
        if (self->answers_.empty()) {  // a client that does not read gets no heap of them
            v1::Envelope message;
            *message.mutable_status() = self->host_.status();
            self->send(std::move(message));
        }
        self->send_status_every(seconds);
    });
}

void ClientSession::answer_recording(const v1::RecordStatus& status, const std::string& refusal) {
    v1::Envelope answer;
    *answer.mutable_record_status() = status;
    answer_later(std::move(answer), refusal);
}

void ClientSession::control_camera(const v1::CameraRequest& request) {
    constexpr int most_settings = 64;
    if (request.settings_size() > most_settings) {
        send_error(
            fmt::format("camera: found {} settings, allowed: at most {}", request.settings_size(), most_settings),
            false);
        return;
    }
    answer_pending_ = true;
    host_.control_camera(request,
                         [self = shared_from_this()](const v1::CameraControls& controls, const std::string& refusal) {
                             v1::Envelope answer;
                             *answer.mutable_camera_controls() = controls;
                             self->answer_later(std::move(answer), refusal);
                         });
}

void ClientSession::answer_later(v1::Envelope answer, const std::string& refusal) {
    answer_pending_ = false;
    if (!refusal.empty()) {
        send_error(refusal, false);
    } else {
        send(std::move(answer));
    }
    read_length();
}

void ClientSession::layout_changed() {
    const auto& offered = host_.layout().products;
    const std::size_t before = selection_.products.size();
    std::erase_if(selection_.products, [&offered](v1::Product product) {
        return std::find(offered.begin(), offered.end(), product) == offered.end();
    });
    if (selection_.products.size() != before) {
        host_.subscription_changed();
        send_error("a subscribed product is no longer served since the daemon was configured anew", false);
    }
}

void ClientSession::close(const std::string& why) {
    if (closed_) {
        return;
    }
    host_.log().came_and_went.write(
        LogLevel::info, fmt::format("{}: {}; {} frames sent, {} skipped", label(), why, frames_sent_, frames_skipped_));
    stop();
    host_.closed(id_);
}

}  // namespace disparityd
