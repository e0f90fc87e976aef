// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clients/cpp/disparity_client.hpp"
#include "clients/json/message_json.h"

namespace disparityd::json {

/// Converts a scan to one object: the ground's plane, the limits, the sectors by bearing.
Json to_json(const disparity::Scan& scan);

}  // namespace disparityd::json
