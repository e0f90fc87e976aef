// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace disparityd::eval {

/// Returns SEED where the data of an option ("--scan") are `what`:SEED; nothing where they are others. Throws
/// std::invalid_argument with one line for a wrong SEED, and where anything stands beside it.
std::optional<std::uint32_t> seed_argument(const std::string& option, const std::string& what,
                                           const std::vector<std::string>& data);

}  // namespace disparityd::eval
