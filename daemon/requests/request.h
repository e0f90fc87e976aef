// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/socket/rate_limit.h"
#include "proto/disparity.pb.h"

namespace disparityd::daemon {

/// Who asks.
struct Requester {
    std::uint64_t client = 0;  ///< the connection's number
    bool owns_daemon = false;  ///< ClientPeer::owns_daemon()
};

/// What a client is told: messages, at least one, or why it is refused.
struct Answer {
    std::vector<v1::Envelope> messages;
    std::string refusal;  ///< empty: none
    /// Kept until the client has got all messages or is gone; null: nothing. For answers so long that few may wait.
    std::shared_ptr<const void> held = {};
};

/// Returns the answer that is one message, which `set` fills in.
template <typename Set>
Answer answer_of(Set set) {
    Answer answer;
    set(answer.messages.emplace_back());
    return answer;
}

inline Answer refusal_of(std::string why) {
    return {{}, std::move(why), {}};
}

/// Takes the answer to one request, at once or later, from any thread. Nothing else is read from the client before, so
/// every request is answered.
using Reply = std::function<void(Answer answer)>;

/// One kind of request that clients make over the socket. Its functions are called in the socket's thread and must not
/// block. All requests of a daemon are in one table; each has a file of its own in this folder.
struct Request {
    v1::Envelope::BodyCase message = v1::Envelope::BODY_NOT_SET;
    std::string_view name;  ///< of the message in disparity.proto
    std::string_view word;  ///< that a refusal begins with, for people: "record"
    /// Returns whether it changes something, which only clients with the right to control may; empty: it does not.
    std::function<bool(const v1::Envelope& message)> changes_something = {};
    /// How many all clients together may make; null: the limit of each client's messages suffices. What is refused
    /// does not count.
    std::shared_ptr<RateLimit> rate = {};
    std::function<void(const v1::Envelope& message, const Requester& requester, Reply reply)> handle;
    /// Returns whether something goes on for this client, which therefore need not ask for anything; may be empty.
    std::function<bool(std::uint64_t client)> goes_on_for = {};
    /// The client is gone; called again where it was gone before an answer came. May be empty.
    std::function<void(std::uint64_t client)> client_is_gone = {};
};

using Requests = std::vector<Request>;

}  // namespace disparityd::daemon
