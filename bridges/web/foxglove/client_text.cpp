// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/client_text.h"

#include <limits>
#include <optional>

#include <nlohmann/json.hpp>

#include "base/message_text.h"

namespace disparityd::foxglove {
namespace {

using Parsed = nlohmann::json;

/// Returns the value of a key, or nullptr when the JSON is no object or does not have it.
const Parsed* member(const Parsed& json, const char* key) {
    const auto found = json.is_object() ? json.find(key) : json.end();
    return found == json.end() ? nullptr : &*found;
}

std::optional<std::uint32_t> id_in(const Parsed* json) {
    if (json == nullptr || !json->is_number_unsigned()) {
        return std::nullopt;
    }
    const auto number = json->get<std::uint64_t>();
    if (number > std::numeric_limits<std::uint32_t>::max()) {
        return std::nullopt;
    }
    return static_cast<std::uint32_t>(number);
}

constexpr const char* id_range = "expected a whole number from 0 to 4294967295";

ClientRequest read_subscribe(const Parsed& message) {
    const Parsed* list = member(message, "subscriptions");
    if (list == nullptr || !list->is_array()) {
        return Refusal{R"(subscribe: "subscriptions" is missing or no array)"};
    }
    SubscribeRequest request;
    for (const Parsed& element : *list) {
        const std::optional<std::uint32_t> id = id_in(member(element, "id"));
        const std::optional<std::uint32_t> channel = id_in(member(element, "channelId"));
        if (!id || !channel) {
            return Refusal{"subscribe: subscriptions[" + std::to_string(request.items.size()) + "]." +
                           (id ? "channelId" : "id") + ": " + id_range + "; nothing was subscribed"};
        }
        request.items.push_back({*id, *channel});
    }
    return request;
}

ClientRequest read_unsubscribe(const Parsed& message) {
    const Parsed* list = member(message, "subscriptionIds");
    if (list == nullptr || !list->is_array()) {
        return Refusal{R"(unsubscribe: "subscriptionIds" is missing or no array)"};
    }
    UnsubscribeRequest request;
    for (const Parsed& element : *list) {
        const std::optional<std::uint32_t> id = id_in(&element);
        if (!id) {
            return Refusal{"unsubscribe: subscriptionIds[" + std::to_string(request.ids.size()) + "]: " + id_range +
                           "; nothing was unsubscribed"};
        }
        request.ids.push_back(*id);
    }
    return request;
}

}  // namespace

ClientRequest read_client_text(std::string_view text) {
    if (text.size() > longest_text) {
        return Refusal{"a text of " + std::to_string(text.size()) + " bytes is too long: at most " +
                       std::to_string(longest_text) + " are read"};
    }
    const Parsed message = Parsed::parse(text, nullptr, false);
    if (message.is_discarded()) {
        return Refusal{"a text is not JSON: " + base::printable(text)};
    }
    const Parsed* op = member(message, "op");
    if (op == nullptr || !op->is_string()) {
        return Refusal{R"(a text is no JSON object with a string "op": )" + base::printable(text)};
    }
    const auto& name = op->get_ref<const std::string&>();
    if (name == "subscribe") {
        return read_subscribe(message);
    }
    if (name == "unsubscribe") {
        return read_unsubscribe(message);
    }
    return Refusal{"the operation \"" + base::printable(name) +
                   "\" is not supported: this server has no capabilities, only subscribe and unsubscribe"};
}

}  // namespace disparityd::foxglove
