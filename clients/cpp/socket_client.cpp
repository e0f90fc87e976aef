// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <deque>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "clients/cpp/disparity_client.hpp"
#include "clients/cpp/frame_message.h"
#include "clients/cpp/message_stream.h"
#include "clients/cpp/missed.h"
#include "clients/cpp/sensor_message.h"
#include "clients/cpp/token_file.h"
#include "proto/text.h"

namespace disparity {
namespace {

namespace proto = disparityd::proto;
namespace v1 = disparityd::v1;
using std::chrono::milliseconds;

/// So many frames are kept while a request waits for its answer.
constexpr std::size_t most_pending = 8;

/// A subscription is small: only a daemon that hangs takes this long to accept it.
constexpr milliseconds send_timeout{5000};

/// The daemon must answer the Hello of a new connection within this time, over any number of calls.
constexpr milliseconds hello_timeout{5000};

/// The daemon refuses longer ones.
constexpr double longest_trace_s = 10;

/// Is several times what the longest trace takes.
constexpr std::size_t most_trace_bytes = std::size_t{64} << 20;

/// Passes between two attempts to connect again.
constexpr milliseconds reconnect_interval{100};

/// Carries the message of a daemon that refuses.
class Refused : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace

class SocketClient::Impl {
public:
    Impl(const std::string& address, ConnectOptions options, const std::string& name, milliseconds timeout)
        : address_(address), options_(std::move(options)), name_(name) {
        const Deadline deadline = after(timeout);
        connect(deadline, deadline);
        if (!greeted(deadline)) {
            fail("no answer to hello in time");
        }
    }

    const std::string& why_gone() const { return why_gone_; }
    const std::string& welcome() const { return welcome_; }
    std::optional<unsigned> server_user() const { return stream_ ? stream_->server_user() : std::nullopt; }
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
        subscription_ = envelope;
        if (!lost_) {
            // Where it cannot be sent, the next read reports why, or sends it over another connection.
            static_cast<void>(stream_->send(envelope, after(send_timeout)));
        }
    }

    ReadResult read(Frame& frame, milliseconds timeout) {
        const Deadline deadline = after(timeout);
        if (!pending_.empty()) {
            frame = std::move(pending_.front());
            pending_.pop_front();
            frame.missed = missed_.seen(frame.publish_index);
            return ReadResult::frame;
        }
        if (lost_ && !come_back(deadline)) {
            return ReadResult::gone;
        }
        while (true) {
            const auto outcome = receive(deadline);
            if (outcome != MessageStream::Outcome::done) {
                return outcome == MessageStream::Outcome::timeout ? ReadResult::timeout : ReadResult::gone;
            }
            if (stream_->envelope().has_frame()) {
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
            if (lost_ && !come_back(deadline)) {
                return ReadResult::gone;
            }
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

    std::string trace(double seconds, milliseconds timeout) {
        v1::Envelope request;
        request.mutable_trace_request()->set_seconds(seconds);
        const auto recorded = std::chrono::ceil<milliseconds>(
            std::chrono::duration<double>(seconds > 0 ? std::min(seconds, longest_trace_s) : 0.0));
        const Deadline deadline = after(timeout + recorded);
        const v1::Trace* part = &ask(request, v1::Envelope::kTrace, "a trace request", timeout + recorded).trace();
        std::string parts = part->SerializeAsString();
        while (!part->last()) {
            if (parts.size() > most_trace_bytes) {
                fail("sent a trace that does not end");
            }
            part = &wait_for(v1::Envelope::kTrace, "a trace request", deadline).trace();
            parts += part->SerializeAsString();  // messages behind each other are one message
        }
        return parts;
    }

private:
    template <class Exception = std::runtime_error>
    [[noreturn]] void fail(const std::string& what) const {
        throw Exception("disparityd at " + address_ + ": " + what);
    }

    /// Opens another connection and sends Hello. The daemon must answer until `greeting`.
    void connect(Deadline deadline, Deadline greeting) {
        stream_ = std::make_unique<MessageStream>(address_, deadline, options_);
        greeting_ = greeting;
        v1::Envelope hello;
        hello.mutable_hello()->set_token(token());
        hello.mutable_hello()->set_protocol_version(proto::protocol_version);
        hello.mutable_hello()->set_client_name(name_);
        send(hello, greeting);
    }

    /// Returns the token for this connection; empty over a Unix socket, where the daemon needs none.
    std::string token() const {
        if (address_.starts_with("unix:")) {
            return {};
        }
        std::string token = options_.token.empty() ? read_token(options_.token_file) : options_.token;
        if (!token.empty() && !stream_->is_private()) {
            throw std::invalid_argument(address_ +
                                        ": a token would be sent unencrypted, allowed: over tls:HOST:PORT, or to this "
                                        "machine");
        }
        return token;
    }

    /// Returns why the connection has ended, where TLS has told it, for the end of a message.
    std::string told_by_tls() const {
        return !stream_ || stream_->why_closed().empty() ? "" : ": " + stream_->why_closed();
    }

    /// Waits for the daemon's answer to Hello. Returns false when it has not come by the deadline and may still come.
    bool greeted(Deadline deadline) {
        while (true) {
            const auto outcome = receive(std::min(deadline, greeting_));
            if (outcome == MessageStream::Outcome::timeout) {
                if (std::chrono::steady_clock::now() >= greeting_) {
                    fail("no answer to hello in time");
                }
                return false;
            }
            if (outcome == MessageStream::Outcome::closed) {
                fail("the connection has ended before hello was answered" + ended_by_);
            }
            if (stream_->envelope().has_welcome()) {
                break;
            }
            keep();
        }
        const v1::Welcome& welcome = stream_->envelope().welcome();
        if (welcome.protocol_version() != proto::protocol_version) {
            fail<Refused>("it speaks version " + std::to_string(welcome.protocol_version()) +
                          " of the protocol, this program version " + std::to_string(proto::protocol_version) +
                          ": use the client library that came with the daemon");
        }
        welcome_ = welcome.SerializeAsString();
        return true;
    }

    /// Connects again, sends Hello and subscribes as before. Returns false when no daemon has answered by the deadline;
    /// the next call continues. Throws when the daemon refuses until then.
    bool come_back(Deadline deadline) {
        std::exception_ptr refusal;
        while (true) {
            try {
                if (!stream_) {
                    connect(std::min(deadline, after(hello_timeout)), after(hello_timeout));
                }
                if (greeted(deadline)) {
                    lost_ = false;
                    if (subscription_) {
                        static_cast<void>(stream_->send(*subscription_, after(send_timeout)));
                    }
                    return true;
                }
                break;
            } catch (const std::runtime_error& error) {
                stream_.reset();
                lost_ = true;
                why_gone_ = error.what();
                refusal = dynamic_cast<const Refused*>(&error) != nullptr ? std::current_exception() : nullptr;
            } catch (const std::invalid_argument& error) {  // a file that was right before
                stream_.reset();
                lost_ = true;
                why_gone_ = error.what();
                refusal = std::make_exception_ptr(Refused(error.what()));
            }
            const Deadline next = std::chrono::steady_clock::now() + reconnect_interval;
            std::this_thread::sleep_until(std::min(deadline, next));
            if (next >= deadline) {
                break;
            }
        }
        if (refusal) {
            std::rethrow_exception(refusal);
        }
        return false;
    }

    void send(const v1::Envelope& envelope, Deadline deadline) {
        if (stream_->send(envelope, deadline) != MessageStream::Outcome::done) {
            report_last_words();
            fail("the connection has ended");
        }
    }

    /// Throws the Error that arrived before the connection ended, if any: it explains more than a broken connection.
    void report_last_words() {
        while (receive(after(milliseconds(0))) == MessageStream::Outcome::done) {
        }
    }

    MessageStream::Outcome receive(Deadline deadline) {
        MessageStream::Outcome outcome{};
        try {
            outcome = stream_->receive(deadline);
        } catch (const std::invalid_argument& error) {
            fail(std::string("broke the protocol: ") + error.what());
        }
        if (outcome == MessageStream::Outcome::done && stream_->envelope().has_error()) {
            fail<Refused>(proto::to_printable_utf8(stream_->envelope().error().message()));
        }
        if (outcome == MessageStream::Outcome::closed) {
            lost_ = true;
            ended_by_ = told_by_tls();
            stream_.reset();
            why_gone_ = "disparityd at " + address_ + ": the connection has ended" + ended_by_;
        }
        return outcome;
    }

    void unpack(Frame& frame) {
        try {
            take_over(frame, stream_->envelope().frame(), stream_->payload());
        } catch (const std::invalid_argument& error) {
            fail(std::string("sent a bad frame: ") + error.what());
        }
    }

    /// Keeps frames, samples and status that come during another call. Other messages are of a newer daemon and are
    /// ignored.
    void keep() {
        if (stream_->envelope().has_frame()) {
            if (pending_.size() == most_pending) {
                pending_.pop_front();
            }
            unpack(pending_.emplace_back());
        } else if (stream_->envelope().has_status()) {
            pushed_status_ = stream_->envelope().status().SerializeAsString();
        } else if (stream_->envelope().has_sensors()) {
            sensors_.put(batch_of(stream_->envelope().sensors()));
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
            if (stream_->envelope().body_case() == body) {
                return stream_->envelope();
            }
            keep();
        }
    }

    /// Whether a message waits that came before a request. An Error with which the daemon closed the connection, as
    /// after a long time without requests, is no answer: it only ends that connection.
    bool came_before() {
        try {
            return receive(after(milliseconds(0))) == MessageStream::Outcome::done;
        } catch (const Refused& refused) {
            if (!stream_->envelope().error().closing()) {
                throw;
            }
            lost_ = true;
            stream_.reset();
            why_gone_ = refused.what();
            return false;
        }
    }

    /// Sends a request and returns its answer. Messages that arrived before the request cannot be its answer.
    const v1::Envelope& ask(const v1::Envelope& request, v1::Envelope::BodyCase body, const std::string& question,
                            milliseconds timeout) {
        const Deadline deadline = after(timeout);
        while (!lost_ && came_before() && std::chrono::steady_clock::now() < deadline) {
            keep();
        }
        if (lost_ && !come_back(deadline)) {
            throw std::runtime_error(why_gone_);
        }
        send(request, deadline);
        return wait_for(body, question, deadline);
    }

    std::string address_;
    ConnectOptions options_;
    std::string name_;
    std::string ended_by_;                   ///< ": why", where TLS has told it
    std::unique_ptr<MessageStream> stream_;  ///< none between two connections
    bool lost_ = false;                      ///< the connection has ended; a new stream_ has no answer to Hello yet
    Deadline greeting_;
    std::optional<v1::Envelope> subscription_;
    std::string why_gone_;
    std::string welcome_;
    std::string pushed_status_;
    std::deque<Frame> pending_;
    SensorBacklog sensors_;
    MissedCounter missed_;
};

SocketClient::SocketClient(const std::string& address, const std::string& client_name, milliseconds timeout)
    : SocketClient(address, ConnectOptions(), client_name, timeout) {}
SocketClient::SocketClient(const std::string& address, const ConnectOptions& options, const std::string& client_name,
                           milliseconds timeout)
    : impl_(std::make_unique<Impl>(address, options, client_name, timeout)) {}
SocketClient::~SocketClient() = default;
SocketClient::SocketClient(SocketClient&&) noexcept = default;
SocketClient& SocketClient::operator=(SocketClient&&) noexcept = default;

const std::string& SocketClient::welcome() const {
    return impl_->welcome();
}
std::optional<unsigned> SocketClient::server_user() const {
    return impl_->server_user();
}
const std::string& SocketClient::why_gone() const {
    return impl_->why_gone();
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

std::string SocketClient::trace(double seconds, milliseconds timeout) {
    return impl_->trace(seconds, timeout);
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
