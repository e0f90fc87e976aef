// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace disparityd::foxglove {

/// A longer text of a client is refused unread: a viewer that subscribes to everything needs 2 KiB.
inline constexpr std::size_t longest_text = 64 * 1024;

/// One element of "subscribe".
struct SubscribeItem {
    std::uint32_t id = 0;       ///< chosen by the client
    std::uint32_t channel = 0;  ///< of "advertise"
};

struct SubscribeRequest {
    std::vector<SubscribeItem> items;
};

struct UnsubscribeRequest {
    std::vector<std::uint32_t> ids;
};

/// A text that cannot be followed.
struct Refusal {
    std::string why;  ///< one line for people
};

using ClientRequest = std::variant<SubscribeRequest, UnsubscribeRequest, Refusal>;

/// Reads a client's text. Whatever it holds, nothing is thrown but for want of memory.
ClientRequest read_client_text(std::string_view text);

}  // namespace disparityd::foxglove
