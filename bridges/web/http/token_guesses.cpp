// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/token_guesses.h"

#include <algorithm>

namespace disparityd::web {

bool TokenGuesses::blocks(const std::string& sender, Time now) const {
    const auto found = forgotten_at_.find(sender);
    return found != forgotten_at_.end() && found->second > now + (most - 1) * pardon;
}

void TokenGuesses::count(const std::string& sender, Time now) {
    std::erase_if(forgotten_at_, [now](const auto& entry) { return entry.second <= now; });
    if (forgotten_at_.size() >= most_senders && !forgotten_at_.contains(sender)) {
        forgotten_at_.erase(std::min_element(forgotten_at_.begin(), forgotten_at_.end(),
                                             [](const auto& a, const auto& b) { return a.second < b.second; }));
    }
    Time& at = forgotten_at_.try_emplace(sender, now).first->second;
    at = std::max(at, now) + pardon;
}

std::string sender_of(const boost::asio::ip::address& address) {
    if (!address.is_v6() || address.to_v6().is_v4_mapped()) {
        return address.to_string();
    }
    auto bytes = address.to_v6().to_bytes();
    std::fill(bytes.begin() + 8, bytes.end(), 0);
    return boost::asio::ip::address_v6(bytes).to_string() + "/64";
}

}  // namespace disparityd::web
