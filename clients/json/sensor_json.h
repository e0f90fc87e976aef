// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "clients/cpp/disparity_client.hpp"
#include "clients/json/message_json.h"

namespace disparityd::json {

/// Converts a sample to one object. `skipped`: samples that this client was not given before it, beside those that the
/// daemon lost.
Json to_json(const disparity::SensorSample& sample, std::uint64_t skipped);

}  // namespace disparityd::json
