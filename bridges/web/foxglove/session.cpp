// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/session.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/little_endian.h"
#include "bridges/ros_messages/message_definitions.h"
#include "bridges/web/foxglove/status_schema.h"
#include "clients/json/message_json.h"
#include "proto/disparity.pb.h"

namespace disparityd::foxglove {
namespace {

using json::Json;

std::string text_of(const Json& json) {
    return json::to_text(json, -1);
}

std::uint32_t id_of(Channel channel) {
    return static_cast<std::uint32_t>(channel);
}

Json json_of(const ChannelFacts& facts) {
    Json json{{"id", id_of(facts.channel)}, {"topic", facts.topic}};
    const std::string_view message = ros::message_name(facts.channel);
    if (message.empty()) {
        json.update({{"encoding", "json"},
                     {"schemaName", "disparityd.Status"},
                     {"schema", status_schema()},
                     {"schemaEncoding", "jsonschema"}});
    } else {
        json.update({{"encoding", "cdr"},
                     {"schemaName", ros::schema_name(message)},
                     {"schema", ros::ros2msg(message)},
                     {"schemaEncoding", "ros2msg"}});
    }
    return json;
}

constexpr std::uint8_t message_data = 1;

Message message(std::uint32_t subscription, std::int64_t received_ns, Payload payload) {
    std::array<std::uint8_t, 13> head{message_data};
    base::put_little_endian(&head[1], subscription, 4);
    base::put_little_endian(&head[5], static_cast<std::uint64_t>(received_ns), 8);
    return {std::string(head.begin(), head.end()), std::move(payload)};
}

/// Returns the channels that exist with the first offer and not with the second.
std::vector<ChannelFacts> only_with(const Offer& one, const Offer& other) {
    std::vector<ChannelFacts> list;
    std::copy_if(
        all_channels().begin(), all_channels().end(), std::back_inserter(list),
        [&](const ChannelFacts& facts) { return needs_of(facts.channel, one) && !needs_of(facts.channel, other); });
    return list;
}

std::vector<ChannelFacts> all_with(const Offer& offer) {
    std::vector<ChannelFacts> list;
    std::copy_if(all_channels().begin(), all_channels().end(), std::back_inserter(list),
                 [&](const ChannelFacts& facts) { return needs_of(facts.channel, offer).has_value(); });
    return list;
}

/// Returns one text that names the first thing that was wrong, or none.
std::vector<std::string> complaint(const std::string& first, std::size_t count, Level level) {
    if (count == 0) {
        return {};
    }
    return {status_text(level, count == 1 ? first : first + "; " + std::to_string(count - 1) + " more were refused")};
}

}  // namespace

std::string server_info_text(const ServerFacts& facts) {
    return text_of({{"op", "serverInfo"},
                    {"name", facts.name},
                    {"capabilities", Json::array()},
                    {"supportedEncodings", Json::array()},
                    {"metadata", {{"version", facts.version}}},
                    {"sessionId", facts.session_id}});
}

std::string status_text(Level level, std::string_view message) {
    return text_of({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}});
}

std::string advertise_text(std::span<const ChannelFacts> channels) {
    Json list = Json::array();
    for (const ChannelFacts& facts : channels) {
        list.push_back(json_of(facts));
    }
    return text_of({{"op", "advertise"}, {"channels", list}});
}

std::string unadvertise_text(std::span<const Channel> channels) {
    Json ids = Json::array();
    for (const Channel channel : channels) {
        ids.push_back(id_of(channel));
    }
    return text_of({{"op", "unadvertise"}, {"channelIds", ids}});
}

FoxgloveSession::FoxgloveSession(ServerFacts facts, Offer offer) : facts_(std::move(facts)), offer_(std::move(offer)) {}

std::vector<std::string> FoxgloveSession::greeting() const {
    return {server_info_text(facts_), advertise_text(all_with(offer_))};
}

std::vector<std::string> FoxgloveSession::on_text(std::string_view text) {
    const ClientRequest request = read_client_text(text);
    if (const auto* asked = std::get_if<SubscribeRequest>(&request)) {
        return subscribe(*asked);
    }
    if (const auto* asked = std::get_if<UnsubscribeRequest>(&request)) {
        return unsubscribe(*asked);
    }
    return {status_text(Level::error, std::get<Refusal>(request).why)};
}

std::vector<std::string> FoxgloveSession::on_binary() const {
    return {status_text(Level::error, "a binary message was ignored: clients cannot publish here")};
}

std::string FoxgloveSession::why_not(const SubscribeItem& item) const {
    const std::string head = "subscribe: channel " + std::to_string(item.channel);
    const auto known = std::find_if(all_channels().begin(), all_channels().end(), [&](const ChannelFacts& facts) {
        return static_cast<std::uint32_t>(facts.channel) == item.channel;
    });
    if (known == all_channels().end() || !needs_of(known->channel, offer_)) {
        return head + " does not exist (now); take one of those that are advertised";
    }
    if (subscriptions_.contains(item.id)) {
        return head + ": the id " + std::to_string(item.id) + " is in use; unsubscribe it or take another one";
    }
    for (const auto& [id, channel] : subscriptions_) {
        if (static_cast<std::uint32_t>(channel) == item.channel) {
            return head + " is subscribed with id " + std::to_string(id) + "; a channel has one subscription";
        }
    }
    return {};
}

std::vector<std::string> FoxgloveSession::subscribe(const SubscribeRequest& request) {
    std::string first;
    std::size_t refused = 0;
    for (const SubscribeItem& item : request.items) {
        const std::string why = why_not(item);
        if (why.empty()) {
            subscriptions_.emplace(item.id, static_cast<Channel>(item.channel));
        } else if (refused++ == 0) {
            first = why;
        }
    }
    return complaint(first, refused, Level::error);
}

std::vector<std::string> FoxgloveSession::unsubscribe(const UnsubscribeRequest& request) {
    std::string first;
    std::size_t unknown = 0;
    for (const std::uint32_t id : request.ids) {
        if (subscriptions_.erase(id) == 0 && unknown++ == 0) {
            first = "unsubscribe: there is no subscription with id " + std::to_string(id);
        }
    }
    // A warning: the channel may have gone while the client's text was on its way.
    return complaint(first, unknown, Level::warning);
}

std::vector<std::string> FoxgloveSession::set_offer(Offer offer) {
    const std::vector<ChannelFacts> gone = only_with(offer_, offer);
    const std::vector<ChannelFacts> come = only_with(offer, offer_);
    offer_ = std::move(offer);
    std::vector<std::string> texts;
    if (!gone.empty()) {
        std::vector<Channel> ids;
        for (const ChannelFacts& facts : gone) {
            ids.push_back(facts.channel);
            std::erase_if(subscriptions_, [&](const auto& entry) { return entry.second == facts.channel; });
        }
        texts.push_back(unadvertise_text(ids));
    }
    if (!come.empty()) {
        texts.push_back(advertise_text(come));
    }
    return texts;
}

Wanted FoxgloveSession::wanted() const {
    Wanted all;
    for (const auto& [id, channel] : subscriptions_) {
        all.add(needs_of(channel, offer_).value_or(Wanted{}));
    }
    return all;
}

std::vector<Channel> FoxgloveSession::subscribed() const {
    std::vector<Channel> channels;
    for (const auto& [id, channel] : subscriptions_) {
        channels.push_back(channel);
    }
    return channels;
}

std::vector<Message> FoxgloveSession::on_frame(EncodedFrame& frame, std::int64_t received_ns) const {
    return on_payloads(frame.payloads(subscribed()), received_ns);
}

std::vector<Message> FoxgloveSession::on_payloads(const Payloads& payloads, std::int64_t received_ns) const {
    std::vector<Message> messages;
    for (const auto& [id, channel] : subscriptions_) {
        if (const auto found = payloads.find(channel); found != payloads.end()) {
            messages.push_back(message(id, received_ns, found->second));
        }
    }
    return messages;
}

std::vector<Message> FoxgloveSession::on_sensors(const disparity::SensorBatch& batch, std::int64_t received_ns) const {
    std::vector<Message> messages;  // the newest first
    for (auto sample = batch.samples.rbegin(); sample != batch.samples.rend(); ++sample) {
        for (auto entry = subscriptions_.rbegin(); entry != subscriptions_.rend(); ++entry) {
            if (messages.size() == most_sensor_messages) {
                break;
            }
            if (std::optional<std::string> bytes = ros::encode(entry->second, *sample, {})) {
                auto payload = std::make_shared<const std::string>(std::move(*bytes));
                messages.push_back(message(entry->first, received_ns, std::move(payload)));
            }
        }
    }
    std::reverse(messages.begin(), messages.end());
    return messages;
}

std::vector<Message> FoxgloveSession::on_status(const v1::Status& status, std::int64_t received_ns) const {
    std::vector<Message> messages;
    for (const auto& [id, channel] : subscriptions_) {
        if (channel == Channel::status) {
            std::string text = json::to_text(json::to_json(status), -1);
            messages.push_back(message(id, received_ns, std::make_shared<const std::string>(std::move(text))));
        }
    }
    return messages;
}

}  // namespace disparityd::foxglove
