// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace disparityd::bridges {

/// "NAME:NUMBER" as a user wrote it.
struct NameAndNumber {
    std::string name;
    unsigned number = 0;
};

/// Reads "NAME:NUMBER", divided at the last colon. Returns nothing where the name is empty or the rest is not a whole
/// number from 0 on.
std::optional<NameAndNumber> parse_name_and_number(std::string_view text);

/// Reads "HOST:PORT" and "[IPv6]:PORT", whose host is returned without its brackets. Returns nothing as above; which
/// hosts and which ports are allowed is the caller's to say.
std::optional<NameAndNumber> parse_host_and_port(std::string_view text);

}  // namespace disparityd::bridges
