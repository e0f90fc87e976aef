// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "clients/cpp/disparity_client.hpp"
#include "clients/json/message_json.h"

namespace disparityd::json {

// The words for what a scan holds, in lines, JSON and CSV. `Enum`: that of proto/scan.h or that of the client library,
// which have the same numbers.

/// Returns "unknown" for every number that has no word, as docs/protocol.md asks for.
template <typename Enum>
const char* sector_word(Enum state) {
    switch (state) {
        case Enum::unknown: return "unknown";
        case Enum::free: return "free";
        case Enum::occupied: return "occupied";
        case Enum::masked: return "masked";
    }
    return "unknown";
}

/// Returns where the ground's plane comes from; "other" for a number of a later daemon that has no word here.
template <typename Enum>
const char* ground_word(Enum source) {
    switch (source) {
        case Enum::configured: return "configured";
        case Enum::fitted: return "fitted";
        case Enum::held: return "held";
        case Enum::gravity: return "gravity";
        case Enum::autopilot: return "autopilot";
    }
    return "other";
}

/// Returns the words of the doubts in a frame's flags, or in a sector's.
Json doubts_json(std::uint32_t flags);

/// Converts a scan to one object: the ground's plane, the limits, the sectors by bearing.
Json to_json(const disparity::Scan& scan);

}  // namespace disparityd::json
