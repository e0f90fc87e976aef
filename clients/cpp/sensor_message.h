// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"

namespace disparity {

/// Converts a message. Pure function, no errors.
SensorBatch batch_of(const disparityd::v1::Sensors& message);

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

}  // namespace disparity
