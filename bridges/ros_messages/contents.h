// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"

namespace disparityd::ros {

/// What messages can be about. Foxglove's protocol sends the numbers, and a viewer may keep what it knows of one: a
/// number always means the same.
enum class Content : std::uint32_t {
    left_image = 1,
    left_jpeg = 2,
    left_info = 3,
    right_info = 4,
    disparity = 5,
    depth = 6,
    depth_error = 7,
    confidence = 8,
    points = 9,
    scan = 10,
    transforms = 11,
    imu = 12,
    magnetic_field = 13,
    imu_temperature = 14,
    camera_temperature = 15,
    left_temperature = 16,
    right_temperature = 17,
    pressure = 18,
    humidity = 19,
    status = 20,
    depth_mm = 21,
    right_image = 22,
    left_grey_image = 23,
    right_grey_image = 24,
    diagnostics = 25,
    clock = 26,
    compressed_depth = 27,
    raw_left_image = 28,
    raw_right_image = 29,
    raw_left_info = 30,
    raw_right_info = 31
};

/// What the daemon has for its clients.
struct Offer {
    std::vector<disparity::Product> products = {};  ///< that can be subscribed to
    bool calibrated = false;                        ///< frames have a focal length and a baseline
    bool sensors = false;                           ///< there may be samples of the camera's sensors
    bool lenses = false;                            ///< the eyes are described as they capture

    bool operator==(const Offer&) const = default;
};

/// Returns what a daemon with this status offers. Samples of sensors may come from a camera that has some, and from
/// recordings; the status of neither a live camera without sensors nor a rendered source leaves hope for them.
Offer offer_of(const v1::Status& status);

/// What messages need from the daemon.
struct Wanted {
    std::vector<disparity::Product> products = {};  ///< each once, by number; empty: no frames
    bool sensors = false;                           ///< samples of the camera's sensors
    bool status = false;                            ///< the daemon's status, once a second or so

    bool operator==(const Wanted&) const = default;

    /// Adds what the other one needs.
    void add(const Wanted& other);
};

/// Returns what messages about this need, or nothing when there can be none with this offer.
std::optional<Wanted> needs_of(Content content, const Offer& offer);

/// Returns the products that would help when needs_of() is nothing, the best first; empty: a product would not.
std::span<const disparity::Product> products_for(Content content);

}  // namespace disparityd::ros
