// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::base {

/// What somebody may do. Each right contains those before it.
enum class Right : unsigned char {
    none,
    view,     ///< frames, status
    control,  ///< recordings, camera controls
};

}  // namespace disparityd::base
