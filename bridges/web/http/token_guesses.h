// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>

#include <boost/asio/ip/address.hpp>

namespace disparityd::web {

/// Counts the wrong tokens of each sender. Who has sent too many is told to wait, and no token of it is looked at: so
/// guessing is slow, and others wait for nothing. The network's thread owns it.
class TokenGuesses {
public:
    using Time = std::chrono::steady_clock::time_point;

    static constexpr int most = 10;                    ///< wrong tokens at once
    static constexpr std::chrono::seconds pardon{6};   ///< after this time one of them is forgotten
    static constexpr std::size_t most_senders = 1024;  ///< then the one that would be forgotten first is

    /// Returns whether no token of this sender is looked at now.
    bool blocks(const std::string& sender, Time now) const;

    /// A token was wrong.
    void count(const std::string& sender, Time now);

private:
    /// Each wrong token moves the time on by `pardon`: it says when all will be forgotten.
    std::map<std::string, Time> forgotten_at_;
};

/// Returns the name of a sender: an address, or of IPv6 the network of 64 bits that one machine can have all to itself.
std::string sender_of(const boost::asio::ip::address& address);

}  // namespace disparityd::web
