// SPDX-License-Identifier: Apache-2.0
#pragma once

/// The words for what a scan holds, in lines, JSON and CSV. `Enum`: that of proto/scan.h or that of the client library,
/// which have the same numbers.
namespace disparityd::json {

/// Returns "unknown" for every number that has no word, as docs/protocol.md asks for.
template <typename Enum>
const char* sector_word(Enum state) {
    return state == Enum::occupied ? "occupied" : state == Enum::free ? "free" : "unknown";
}

/// Returns where the ground's plane comes from; "other" for a number of a later daemon that has no word here.
template <typename Enum>
const char* ground_word(Enum source) {
    switch (source) {
        case Enum::configured: return "configured";
        case Enum::fitted: return "fitted";
        case Enum::held: return "held";
        case Enum::gravity: return "gravity";
    }
    return "other";
}

}  // namespace disparityd::json
