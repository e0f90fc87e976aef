// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"

namespace disparity {

/// Fills `frame` from a message whose plane sizes were checked against the payload. It reuses the buffers and does not
/// change `skipped`. Throws std::invalid_argument when a compressed plane is damaged.
void take_over(Frame& frame, const disparityd::v1::Frame& message, std::span<const std::uint8_t> payload);

}  // namespace disparity
