// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tests/vm/camera/camera.h"

namespace simulated_camera {

inline constexpr const char* commands_help =
    "unplug | plug [MODEL SERIAL] | freeze [restart|reset] | thaw | err N | short N | drop N | stall N | status";

/// Carries out one line and gives back one: "ok", the status, or "error: ..." with what is allowed.
std::string carry_out(Camera& camera, const std::string& line);

/// The model of this name, or nullptr.
const Model* find_model(const std::string& name);

}  // namespace simulated_camera
