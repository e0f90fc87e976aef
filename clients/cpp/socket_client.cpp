// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "clients/cpp/connection.h"
#include "clients/cpp/disparity_client.hpp"
#include "clients/cpp/frame_reader.h"
#include "clients/cpp/one_user.h"
#include "proto/disparity.pb.h"

namespace disparity {
namespace {

/// Keeps batches that came during other calls. It is bounded: the oldest batches are dropped and count as skipped.
class SensorBacklog {
public:
    void put(SensorBatch batch);

    /// Returns false when there is none.
    bool take(SensorBatch& batch);

private:
    static constexpr std::size_t most_samples = 8192;

    std::deque<SensorBatch> batches_;
    std::size_t samples_ = 0;
    std::uint64_t skipped_ = 0;
};

namespace v1 = disparityd::v1;

SensorVector vector_of(const v1::Vector& message) {
    return {message.x(), message.y(), message.z()};
}

SensorSample sample_of(const v1::SensorSample& message) {
    SensorSample sample;
    sample.monotonic_ns = message.monotonic_ns();
    sample.realtime_ns = message.realtime_ns();
    sample.camera_ns = message.camera_ns();
    sample.lost_before = message.lost_before();
    sample.frame_sync = message.frame_sync();
    sample.frame_syncs = message.frame_syncs();
    if (message.has_inertial()) {
        const v1::Inertial& inertial = message.inertial();
        sample.inertial = {vector_of(inertial.angular_velocity()), vector_of(inertial.acceleration()),
                           inertial.celsius()};
    }
    if (message.has_magnetic_field()) {
        sample.magnetic_field = vector_of(message.magnetic_field());
    }
    if (message.has_environment()) {
        const v1::Environment& environment = message.environment();
        sample.environment = {environment.celsius(), environment.hectopascal(), environment.humidity_percent()};
    }
    if (message.has_eye_temperatures()) {
        sample.eye_temperatures = {message.eye_temperatures().left_celsius(),
                                   message.eye_temperatures().right_celsius()};
    }
    return sample;
}

SensorBatch batch_of(const v1::Sensors& message) {
    SensorBatch batch;
    batch.skipped = message.skipped();
    batch.age_ns = message.age_ns();
    batch.samples.reserve(static_cast<std::size_t>(message.samples_size()));
    for (const v1::SensorSample& sample : message.samples()) {
        batch.samples.push_back(sample_of(sample));
    }
    return batch;
}

void SensorBacklog::put(SensorBatch batch) {
    samples_ += batch.samples.size();
    batches_.push_back(std::move(batch));
    while (samples_ > most_samples) {
        const SensorBatch& oldest = batches_.front();
        skipped_ += oldest.skipped + oldest.samples.size();
        samples_ -= oldest.samples.size();
        batches_.pop_front();
    }
}

bool SensorBacklog::take(SensorBatch& batch) {
    if (batches_.empty()) {
        return false;
    }
    batch = std::move(batches_.front());
    batches_.pop_front();
    samples_ -= batch.samples.size();
    batch.skipped += std::exchange(skipped_, 0);
    return true;
}

namespace v1 = disparityd::v1;
using std::chrono::milliseconds;

/// The daemon refuses longer ones.
constexpr double longest_trace_s = 10;

/// Is several times what the longest trace takes.
constexpr std::size_t most_trace_bytes = std::size_t{64} << 20;

/// Returns the subscription as a message.
v1::Envelope message_of(const Subscription& wanted) {
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
    return envelope;
}

}  // namespace

class SocketClient::Impl {
public:
    Impl(const std::string& address, ConnectOptions options, const std::string& name, milliseconds timeout)
        : connection_(address, std::move(options), name, timeout), frames_(connection_) {}

    const std::string& why_gone() const { return connection_.why_gone(); }
    const std::string& welcome() const { return connection_.welcome(); }
    bool unanswered() const { return connection_.unanswered(); }
    std::optional<unsigned> server_user() const { return connection_.server_user(); }

    std::string take_status() {
        const OneUser::Call call(user_);
        return std::exchange(pushed_status_, {});
    }

    void subscribe(const Subscription& wanted) {
        const OneUser::Call call(user_);
        frames_.start(wanted);
        connection_.subscribe(message_of(wanted));
    }

    ReadResult read(Frame& frame, milliseconds timeout) {
        const OneUser::Call call(user_);
        const Deadline deadline = after(timeout);
        if (std::exchange(end_untold_, false) || !connected(deadline)) {
            return ReadResult::gone;
        }
        const ReadResult result = frames_.read(frame, deadline, [this] { keep(); });
        end_untold_ = result != ReadResult::gone && connection_.lost();
        return result;
    }

    ReadResult read_sensors(SensorBatch& batch, milliseconds timeout) {
        const OneUser::Call call(user_);
        const Deadline deadline = after(timeout);
        while (!sensors_.take(batch)) {
            if (std::exchange(end_untold_, false) || !connected(deadline)) {
                return ReadResult::gone;
            }
            const auto outcome = connection_.listen(deadline, 0);
            if (outcome != Connection::Outcome::done) {
                return outcome == Connection::Outcome::timeout ? ReadResult::timeout : ReadResult::gone;
            }
            keep();
        }
        return ReadResult::frame;
    }

    std::string status(milliseconds timeout) {
        const OneUser::Call call(user_);
        v1::Envelope request;
        request.mutable_status_request();
        return ask(request, v1::Envelope::kStatus, "a status request", timeout).status().SerializeAsString();
    }

    std::string control_camera(const v1::Envelope& request, milliseconds timeout) {
        const OneUser::Call call(user_);
        return ask(request, v1::Envelope::kCameraControls, "a camera request", timeout)
            .camera_controls()
            .SerializeAsString();
    }

    std::string give_level(const v1::Envelope& request, milliseconds timeout) {
        const OneUser::Call call(user_);
        return ask(request, v1::Envelope::kLevelStatus, "a level", timeout).level_status().SerializeAsString();
    }

    std::string record(const v1::Envelope& request, milliseconds timeout) {
        const OneUser::Call call(user_);
        return ask(request, v1::Envelope::kRecordStatus, "a recording request", timeout)
            .record_status()
            .SerializeAsString();
    }

    std::string trace(double seconds, milliseconds timeout) {
        const OneUser::Call call(user_);
        v1::Envelope request;
        request.mutable_trace_request()->set_seconds(seconds);
        const auto recorded = std::chrono::ceil<milliseconds>(
            std::chrono::duration<double>(seconds > 0 ? std::min(seconds, longest_trace_s) : 0.0));
        const Deadline deadline = after(timeout + recorded);
        const v1::Trace* part = &ask(request, v1::Envelope::kTrace, "a trace request", timeout + recorded).trace();
        std::string parts = part->SerializeAsString();
        while (!part->last()) {
            if (parts.size() > most_trace_bytes) {
                connection_.fail("sent a trace that does not end");
            }
            part = &wait_for(v1::Envelope::kTrace, "a trace request", deadline).trace();
            parts += part->SerializeAsString();  // messages behind each other are one message
        }
        return parts;
    }

private:
    /// Connects again where the connection has ended. Returns false when no daemon has answered by the deadline.
    bool connected(Deadline deadline) {
        if (connection_.lost()) {
            if (!connection_.come_back(deadline)) {
                return false;
            }
            frames_.start_again();
            end_untold_ = false;
        }
        return true;
    }

    /// Keeps the newest frame, samples and the newest status that come during another call. Other messages are of a
    /// newer daemon and are ignored.
    void keep() {
        const v1::Envelope& message = connection_.envelope();
        if (message.has_frame()) {
            frames_.keep();
        } else if (message.has_status()) {
            pushed_status_ = message.status().SerializeAsString();
        } else if (message.has_sensors()) {
            sensors_.put(batch_of(message.sensors()));
        }
    }

    const v1::Envelope& wait_for(v1::Envelope::BodyCase body, const std::string& question, Deadline deadline) {
        while (true) {
            const auto outcome = connection_.receive(deadline);
            if (outcome == Connection::Outcome::timeout) {
                connection_.fail("no answer to " + question + " in time");
            }
            if (outcome == Connection::Outcome::closed) {
                connection_.fail("the connection has ended before " + question + " was answered");
            }
            if (connection_.envelope().body_case() == body) {
                return connection_.envelope();
            }
            keep();
        }
    }

    /// Whether a message waits that came before a request. An Error with which the daemon closed the connection, as
    /// after a long time without requests, is no answer: it only ends that connection.
    bool came_before() {
        try {
            return connection_.receive(after(milliseconds(0))) == Connection::Outcome::done;
        } catch (const Refused& refused) {
            if (!connection_.envelope().error().closing()) {
                throw;
            }
            connection_.end(refused.what());
            return false;
        }
    }

    /// Sends a request and returns its answer. Messages that arrived before the request cannot be its answer.
    const v1::Envelope& ask(const v1::Envelope& request, v1::Envelope::BodyCase body, const std::string& question,
                            milliseconds timeout) {
        const Deadline deadline = after(timeout);
        while (!connection_.lost() && came_before() && std::chrono::steady_clock::now() < deadline) {
            keep();
        }
        if (!connected(deadline)) {
            throw std::runtime_error(connection_.why_gone());
        }
        connection_.send(request, deadline);
        return wait_for(body, question, deadline);
    }

    OneUser user_{"SocketClient"};
    Connection connection_;
    FrameReader frames_;
    bool end_untold_ = false;  ///< the connection has ended behind a frame that was given: the next read says so
    std::string pushed_status_;
    SensorBacklog sensors_;
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
bool SocketClient::unanswered() const {
    return impl_->unanswered();
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

std::string SocketClient::give_level(const std::vector<Level>& levels, milliseconds timeout) {
    v1::Envelope request;
    request.mutable_give_level();
    for (const Level& level : levels) {
        v1::LevelSample& sample = *request.mutable_give_level()->add_samples();
        sample.set_ahead(level.ahead);
        sample.set_left(level.left);
        sample.set_up(level.up);
        sample.set_age_us(static_cast<std::uint32_t>(
            std::clamp<std::int64_t>(level.age.count(), 0, std::numeric_limits<std::uint32_t>::max())));
    }
    return impl_->give_level(request, timeout);
}

}  // namespace disparity
