// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace disparityd::base {

/// Returns what --version prints: "disparityctl 0.1.0 (commit 0123456789ab)". A build of a source archive knows no
/// commit: "disparityctl 0.1.0".
std::string version_line(std::string_view program);

}  // namespace disparityd::base
