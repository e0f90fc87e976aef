// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>

#include <boost/asio/ip/address.hpp>

namespace disparityd::web {

/// Counts wrong tokens, those of each sender and all together. Where there are too many, a wrong one is answered late
/// and costs its connection. A right one is never counted nor held up: whoever guesses behind the same proxy, or from
/// many addresses, locks nobody out. The network's thread owns it.
class TokenGuesses {
public:
    using Time = std::chrono::steady_clock::time_point;

    static constexpr int most = 10;                   ///< wrong tokens of a sender at once
    static constexpr std::chrono::seconds pardon{6};  ///< after this time one of them is forgotten
    static constexpr int most_together = 100;         ///< wrong tokens of all senders at once
    static constexpr std::chrono::milliseconds pardon_together{600};
    static constexpr std::size_t most_senders = 1024;  ///< then the one that would be forgotten first is

    /// A token of this sender was wrong. Returns whether it was one too many, of the sender or of all.
    bool count(const std::string& sender, Time now);

private:
    /// Each wrong token moves a time on by its pardon: it says when all will be forgotten.
    std::map<std::string, Time> forgotten_at_;
    Time all_forgotten_at_{};
};

/// Returns the name of a sender: an address, or of IPv6 the network of 64 bits that one machine can have all to itself.
std::string sender_of(const boost::asio::ip::address& address);

}  // namespace disparityd::web
