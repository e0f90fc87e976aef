// SPDX-License-Identifier: Apache-2.0
#include "calibration/calibration_identity.h"

#include <array>
#include <cstdint>
#include <cstdio>

namespace disparityd::calibration {

std::string calibration_identity(std::string_view calibration_text) {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const char c : calibration_text) {
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
    }
    std::array<char, 17> text{};
    std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(hash));
    return text.data();
}

}  // namespace disparityd::calibration
