// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/seed_argument.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "base/number_text.h"

namespace disparityd::eval {

std::optional<std::uint32_t> seed_argument(const std::string& option, const std::string& what,
                                           const std::vector<std::string>& data) {
    const std::string prefix = what + ':';
    const auto found =
        std::find_if(data.begin(), data.end(), [&](const std::string& one) { return one.starts_with(prefix); });
    if (found == data.end()) {
        return std::nullopt;
    }
    const auto seed = base::parse_number(std::string_view(*found).substr(prefix.size()));
    constexpr double most = 1000000;
    if (!seed || *seed < 0 || *seed > most || *seed != std::floor(*seed) || data.size() > 1) {
        throw std::invalid_argument(option + ": DATA: found '" + *found + "'" +
                                    (data.size() > 1 ? " beside others" : "") + ", allowed: " + prefix +
                                    "SEED alone, SEED 0 .. 1000000, such as " + prefix + '1');
    }
    return static_cast<std::uint32_t>(*seed);
}

}  // namespace disparityd::eval
