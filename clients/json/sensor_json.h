// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "clients/cpp/disparity_client.hpp"
#include "clients/json/message_json.h"

namespace disparityd::json {

/// Converts a sample to one object. `missed`: samples that this client missed before it, beside those that the daemon
/// lost.
Json to_json(const disparity::SensorSample& sample, std::uint64_t missed);

}  // namespace disparityd::json
