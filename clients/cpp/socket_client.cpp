// SPDX-License-Identifier: Apache-2.0
#include <deque>
#include <stdexcept>
#include <utility>

#include "clients/cpp/disparity_client.hpp"
#include "clients/cpp/frame_message.h"
#include "clients/cpp/message_stream.h"
#include "clients/cpp/missed.h"
#include "clients/cpp/sensor_message.h"

namespace disparity {
namespace {

namespace proto = disparityd::proto;
namespace v1 = disparityd::v1;
using std::chrono::milliseconds;

/// Frames kept while a question waits for its answer.
constexpr std::size_t most_pending = 8;

/// How long a subscription may take to leave; it is small, so only a stuck daemon needs it.
constexpr milliseconds send_timeout{5000};

}  // namespace

class SocketClient::Impl {
public:
    Impl(const std::string& address, const std::string& name, milliseconds timeout)
        : address_(address), stream_(address, after(timeout)) {
        const Deadline deadline = after(timeout);
        v1::Envelope hello;
        hello.mutable_hello()->set_protocol_version(proto::protocol_version);
        hello.mutable_hello()->set_client_name(name);
        send(hello, deadline);
        const v1::Envelope& answer = wait_for(v1::Envelope::kWelcome, "hello", deadline);
        if (answer.welcome().protocol_version() != proto::protocol_version) {
            fail("it speaks version " + std::to_string(answer.welcome().protocol_version()) +
                 " of the protocol, this program version " + std::to_string(proto::protocol_version) +
                 ": use the client library that came with the daemon");
        }
        welcome_ = answer.welcome().SerializeAsString();
    }

    const std::string& welcome() const { return welcome_; }
    std::string take_status() { return std::exchange(pushed_status_, {}); }

    void subscribe(const Subscription& wanted) {
        v1::Envelope envelope;
        v1::Subscribe& message = *envelope.mutable_subscribe();
        for (const Product product : wanted.products) {
            message.add_products(static_cast<v1::Product>(product));
        }
        message.set_max_rate(wanted.max_rate);
        message.set_encoding(wanted.compressed ? v1::ZSTD : v1::RAW);
        message.set_status_interval_s(wanted.status_interval_s);
        message.set_sensors(wanted.sensors);
        if (wanted.region_width != 0) {
            message.mutable_region()->set_x(wanted.region_x);
            message.mutable_region()->set_y(wanted.region_y);
            message.mutable_region()->set_width(wanted.region_width);
            message.mutable_region()->set_height(wanted.region_height);
        }
        send(envelope, after(send_timeout));
    }

    ReadResult read(Frame& frame, milliseconds timeout) {
        const Deadline deadline = after(timeout);
        if (!pending_.empty()) {
            frame = std::move(pending_.front());
            pending_.pop_front();
            frame.missed = missed_.seen(frame.publish_index);
            return ReadResult::frame;
        }
        while (true) {
            const auto outcome = receive(deadline);
            if (outcome != MessageStream::Outcome::done) {
                return outcome == MessageStream::Outcome::timeout ? ReadResult::timeout : ReadResult::gone;
            }
            if (stream_.envelope().has_frame()) {
                unpack(frame);
                frame.missed = missed_.seen(frame.publish_index);
                return ReadResult::frame;
            }
            keep();
        }
    }

    ReadResult read_sensors(SensorBatch& batch, milliseconds timeout) {
        const Deadline deadline = after(timeout);
        while (!sensors_.take(batch)) {
            const auto outcome = receive(deadline);
            if (outcome != MessageStream::Outcome::done) {
                return outcome == MessageStream::Outcome::timeout ? ReadResult::timeout : ReadResult::gone;
            }
            keep();
        }
        return ReadResult::frame;
    }

    std::string status(milliseconds timeout) {
        v1::Envelope request;
        request.mutable_status_request();
        return ask(request, v1::Envelope::kStatus, "a status request", timeout).status().SerializeAsString();
    }

    std::string control_camera(const v1::Envelope& request, milliseconds timeout) {
        return ask(request, v1::Envelope::kCameraControls, "a camera request", timeout)
            .camera_controls()
            .SerializeAsString();
    }

    std::string record(const v1::Envelope& request, milliseconds timeout) {
        return ask(request, v1::Envelope::kRecordStatus, "a recording request", timeout)
            .record_status()
            .SerializeAsString();
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw std::runtime_error("disparityd at " + address_ + ": " + what);
    }

    void send(const v1::Envelope& envelope, Deadline deadline) {
        if (stream_.send(envelope, deadline) != MessageStream::Outcome::done) {
            report_last_words();
            fail("the connection has ended");
        }
    }

    /// A daemon that refused something says why before it closes; that explains more than a broken connection.
    void report_last_words() {
        while (receive(after(milliseconds(0))) == MessageStream::Outcome::done) {
        }
    }

    MessageStream::Outcome receive(Deadline deadline) {
        MessageStream::Outcome outcome{};
        try {
            outcome = stream_.receive(deadline);
        } catch (const std::invalid_argument& error) {
            fail(std::string("broke the protocol: ") + error.what());
        }
        if (outcome == MessageStream::Outcome::done && stream_.envelope().has_error()) {
            fail(stream_.envelope().error().message());
        }
        return outcome;
    }

    void unpack(Frame& frame) {
        try {
            take_over(frame, stream_.envelope().frame(), stream_.payload());
        } catch (const std::invalid_argument& error) {
            fail(std::string("sent a bad frame: ") + error.what());
        }
    }

    /// A message that is not what we wait for: frames, samples and status are for later, anything else is of a newer
    /// daemon.
    void keep() {
        if (stream_.envelope().has_frame()) {
            if (pending_.size() == most_pending) {
                pending_.pop_front();
            }
            unpack(pending_.emplace_back());
        } else if (stream_.envelope().has_status()) {
            pushed_status_ = stream_.envelope().status().SerializeAsString();
        } else if (stream_.envelope().has_sensors()) {
            sensors_.put(batch_of(stream_.envelope().sensors()));
        }
    }

    const v1::Envelope& wait_for(v1::Envelope::BodyCase body, const std::string& question, Deadline deadline) {
        while (true) {
            const auto outcome = receive(deadline);
            if (outcome == MessageStream::Outcome::timeout) {
                fail("no answer to " + question + " in time");
            }
            if (outcome == MessageStream::Outcome::closed) {
                fail("the connection has ended before " + question + " was answered");
            }
            if (stream_.envelope().body_case() == body) {
                return stream_.envelope();
            }
            keep();
        }
    }

    /// What has arrived before the question cannot be its answer.
    const v1::Envelope& ask(const v1::Envelope& request, v1::Envelope::BodyCase body, const std::string& question,
                            milliseconds timeout) {
        const Deadline deadline = after(timeout);
        while (receive(after(milliseconds(0))) == MessageStream::Outcome::done &&
               std::chrono::steady_clock::now() < deadline) {
            keep();
        }
        send(request, deadline);
        return wait_for(body, question, deadline);
    }

    std::string address_;
    MessageStream stream_;
    std::string welcome_;
    std::string pushed_status_;
    std::deque<Frame> pending_;
    SensorBacklog sensors_;
    MissedCounter missed_;
};

SocketClient::SocketClient(const std::string& address, const std::string& client_name, milliseconds timeout)
    : impl_(std::make_unique<Impl>(address, client_name, timeout)) {}
SocketClient::~SocketClient() = default;
SocketClient::SocketClient(SocketClient&&) noexcept = default;
SocketClient& SocketClient::operator=(SocketClient&&) noexcept = default;

const std::string& SocketClient::welcome() const {
    return impl_->welcome();
}
void SocketClient::subscribe(const Subscription& subscription) {
    impl_->subscribe(subscription);
}
ReadResult SocketClient::read(Frame& frame, milliseconds timeout) {
    return impl_->read(frame, timeout);
}
ReadResult SocketClient::read_sensors(SensorBatch& batch, milliseconds timeout) {
    return impl_->read_sensors(batch, timeout);
}
std::string SocketClient::status(milliseconds timeout) {
    return impl_->status(timeout);
}
std::string SocketClient::take_status() {
    return impl_->take_status();
}

std::string SocketClient::start_recording(const std::string& path, milliseconds timeout) {
    v1::Envelope request;
    request.mutable_record_start()->set_path(path);
    return impl_->record(request, timeout);
}

std::string SocketClient::stop_recording(milliseconds timeout) {
    v1::Envelope request;
    request.mutable_record_stop();
    return impl_->record(request, timeout);
}

std::string SocketClient::control_camera(const std::vector<std::pair<std::string, std::int64_t>>& settings,
                                         milliseconds timeout) {
    v1::Envelope request;
    request.mutable_camera_request();
    for (const auto& [name, value] : settings) {
        v1::CameraSetting& setting = *request.mutable_camera_request()->add_settings();
        setting.set_name(name);
        setting.set_value(value);
    }
    return impl_->control_camera(request, timeout);
}

}  // namespace disparity
