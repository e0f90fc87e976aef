// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "capture/frame_source.h"
#include "tests/capture/played_source.h"

namespace disparityd::capture::test {

inline constexpr int width = 64;  ///< of an eye's images, px
inline constexpr int height = 48;
inline constexpr std::int64_t period = 50'000'000;  ///< of frames, ns

inline SourceOptions options_of(const std::string& uri) {
    SourceOptions options;
    options.uri = uri;
    options.pace = Pace::fastest;
    return options;
}

}  // namespace disparityd::capture::test
