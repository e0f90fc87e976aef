// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/sensor_message.h"

#include <utility>

namespace disparity {
namespace {

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

}  // namespace

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

}  // namespace disparity
