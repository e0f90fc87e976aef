// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"
#include "proto/scan.h"

namespace disparityd::test {

/// Returns the bytes of the product SCAN with one occupied sector, 5 degrees wide. `bearing_deg` is that of its middle,
/// left positive. The scan ends at 20 m.
std::vector<std::uint8_t> scan_with_obstacle(int bearing_deg, int distance_mm);

/// Returns a frame as the client library gives it.
disparity::Frame client_frame(const std::vector<std::uint8_t>& scan, std::chrono::nanoseconds age);

/// Returns a message as a daemon sends it; the bytes are its payload.
v1::Envelope frame_message(const std::vector<std::uint8_t>& scan, std::chrono::nanoseconds age);

}  // namespace disparityd::test
