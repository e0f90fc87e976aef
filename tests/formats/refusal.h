// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace disparityd::test {

/// Returns the line by which a call refuses; "accepted" where it does not.
template <class Call>
std::string refusal(Call&& call) {
    try {
        call();
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace disparityd::test
