// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/level_request.h"

#include <stdexcept>
#include <utility>

namespace disparityd::daemon {
namespace {

/// All clients together give it so often: the fastest autopilots tell 100 a second, and several fit in a message.
constexpr int burst = 100;
constexpr std::chrono::milliseconds interval{5};

Answer taken(const std::shared_ptr<Engine>& engine, const v1::GiveLevel& message, const Requester& requester) {
    if (!engine) {
        return refusal_of("level: the source is being prepared; give it again");
    }
    try {
        const v1::LevelStatus status = engine->take_level(message, requester.client);
        return answer_of([&](v1::Envelope& answer) { *answer.mutable_level_status() = status; });
    } catch (const std::invalid_argument& error) {
        return refusal_of(error.what());
    }
}

}  // namespace

Request level_request(std::function<std::shared_ptr<Engine>()> engine) {
    return {.message = v1::Envelope::kGiveLevel,
            .name = "give_level",
            .word = "level",
            .changes_something = [](const v1::Envelope&) { return true; },
            .rate = std::make_shared<RateLimit>(burst, interval),
            .handle = [engine = std::move(engine)](
                          const v1::Envelope& message, const Requester& requester,
                          const Reply& reply) { reply(taken(engine(), message.give_level(), requester)); }};
}

}  // namespace disparityd::daemon
