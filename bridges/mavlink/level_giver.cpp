// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/level_giver.h"

#include <exception>
#include <utility>
#include <vector>

#include "bridges/program/waiting_client.h"

namespace disparityd::mavlink {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds pause_before_retry{1000};
constexpr milliseconds patience{200};
/// The daemon takes no more at once.
constexpr std::size_t most = 64;

}  // namespace

LevelGiver::LevelGiver(const std::string& where, disparity::ClientOptions options) {
    client_.emplace(where, disparity::Subscription(), bridges::waiting_for_the_daemon(std::move(options)));
}

void LevelGiver::add(const disparity::Level& level, Clock::time_point arrived) {
    kept_.push_back({level, arrived});
    if (kept_.size() > most) {
        kept_.pop_front();
    }
}

void LevelGiver::give(const std::vector<disparity::Level>& levels) {
    client_->socket().give_level(levels, patience);
}

void LevelGiver::give() {
    const std::deque<Kept> kept = std::exchange(kept_, {});
    const auto now = Clock::now();
    if (kept.empty() || now < next_try_) {
        return;
    }
    std::vector<disparity::Level> levels;
    for (const Kept& one : kept) {
        levels.push_back(one.level);
        levels.back().age = std::chrono::duration_cast<std::chrono::microseconds>(now - one.arrived);
    }
    try {
        give(levels);
        problem_.clear();
    } catch (const std::exception& error) {
        problem_ = error.what();
        next_try_ = Clock::now() + pause_before_retry;
    }
}

}  // namespace disparityd::mavlink
