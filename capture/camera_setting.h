// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace disparityd::capture {

/// The present state of a camera's control. Names are lower case with '-', such as "white-balance-temperature".
struct CameraControl {
    std::string name;
    std::int64_t value = 0;
    std::int64_t min = 0;
    std::int64_t max = 0;
    std::int64_t initial = 0;  ///< the value that the camera starts with
};

struct CameraSetting {
    std::string name;
    std::int64_t value = 0;
};

}  // namespace disparityd::capture
