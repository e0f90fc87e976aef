// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/token_guesses.h"

#include <algorithm>

namespace disparityd::web {

namespace {

/// Counts one more at a time that moves on. Returns whether it is too many: then it is not counted, so that it does not
/// take longer and longer until one is forgotten.
bool one_too_many(TokenGuesses::Time& forgotten_at, TokenGuesses::Time now, int most,
                  std::chrono::milliseconds pardon) {
    forgotten_at = std::max(forgotten_at, now);
    if (forgotten_at > now + (most - 1) * pardon) {
        return true;
    }
    forgotten_at += pardon;
    return false;
}

}  // namespace

bool TokenGuesses::count(const std::string& sender, Time now) {
    std::erase_if(forgotten_at_, [now](const auto& entry) { return entry.second <= now; });
    if (forgotten_at_.size() >= most_senders && !forgotten_at_.contains(sender)) {
        forgotten_at_.erase(std::min_element(forgotten_at_.begin(), forgotten_at_.end(),
                                             [](const auto& a, const auto& b) { return a.second < b.second; }));
    }
    Time& own = forgotten_at_.try_emplace(sender, now).first->second;
    const bool of_sender = one_too_many(own, now, most, pardon);
    return one_too_many(all_forgotten_at_, now, most_together, pardon_together) || of_sender;
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
