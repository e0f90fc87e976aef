// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/web/foxglove/channels.h"
#include "bridges/web/foxglove/client_text.h"
#include "bridges/web/foxglove/encoded_frame.h"
#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"

namespace disparityd::foxglove {

// The texts of the server. They are JSON; bytes from outside that are not UTF-8 are replaced.

/// What the server tells of itself.
struct ServerFacts {
    std::string name;             ///< "disparityd"
    std::string version;          ///< "1.2.3"
    std::string session_id = {};  ///< the same for all connections of one server, another one after its restart
};

enum class Level { info = 0, warning = 1, error = 2 };

std::string server_info_text(const ServerFacts& facts);
std::string status_text(Level level, std::string_view message);
std::string advertise_text(std::span<const ChannelFacts> channels);
std::string unadvertise_text(std::span<const Channel> channels);

/// Subprotocols of WebSocket that a viewer may ask for. They are the same protocol; the server takes the first one of
/// the viewer's that is here.
inline constexpr std::array<std::string_view, 2> subprotocols{"foxglove.sdk.v1", "foxglove.websocket.v1"};

/// A batch may hold thousands of samples after a pause, and a connection lets only so many messages wait.
inline constexpr std::size_t most_sensor_messages = 200;

/// A binary message of WebSocket: the head, then the payload.
struct Message {
    std::string head;  ///< 13 bytes: operation 1, u32 subscription, u64 time of receipt, ns since 1970
    Payload payload;   ///< never nullptr; shared with other sessions
};

/// One connection that speaks Foxglove's WebSocket protocol: what to answer, what to send. It has no socket, no thread
/// and no queue. The server sends texts in their order, and calls on_frame() with the newest frame when it can send
/// again. It throws nothing but for want of memory, whatever the client sends. One thread uses a session.
class FoxgloveSession {
public:
    FoxgloveSession(ServerFacts facts, Offer offer);

    /// Returns the texts to send first: serverInfo, advertise.
    std::vector<std::string> greeting() const;

    /// Returns the texts that answer a client's text: none, or one status message that names the first thing that was
    /// wrong. The right ones of several subscriptions are made all the same.
    std::vector<std::string> on_text(std::string_view text);

    /// Returns the answer to a binary message: clients cannot publish.
    std::vector<std::string> on_binary() const;

    /// Takes what the daemon offers now. Returns the texts that tell the client: unadvertise, advertise, or none.
    /// Subscriptions of channels that are gone end. While the daemon is away, leave the offer as it is: viewers then
    /// keep their panels.
    std::vector<std::string> set_offer(Offer offer);

    /// Returns what the subscriptions need. It changes only in on_text() and set_offer().
    Wanted wanted() const;

    /// Returns the channels that are subscribed, by the client's id. A server that encodes in another thread gives them
    /// to EncodedFrame::payloads() there.
    std::vector<Channel> subscribed() const;

    /// Each returns the messages for what is subscribed. `received_ns`: when the server had it, ns since 1970.
    std::vector<Message> on_frame(EncodedFrame& frame, std::int64_t received_ns) const;
    std::vector<Message> on_payloads(const Payloads& payloads, std::int64_t received_ns) const;
    /// Of samples at most the newest most_sensor_messages.
    std::vector<Message> on_sensors(const disparity::SensorBatch& batch, std::int64_t received_ns) const;
    std::vector<Message> on_status(const v1::Status& status, std::int64_t received_ns) const;

private:
    std::vector<std::string> subscribe(const SubscribeRequest& request);
    std::vector<std::string> unsubscribe(const UnsubscribeRequest& request);
    std::string why_not(const SubscribeItem& item) const;

    ServerFacts facts_;
    Offer offer_;
    std::map<std::uint32_t, Channel> subscriptions_;  ///< by the client's id; at most one for each channel
};

}  // namespace disparityd::foxglove
