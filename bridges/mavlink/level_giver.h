// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <deque>
#include <optional>
#include <string>

#include "clients/cpp/disparity_client.hpp"

namespace disparityd::mavlink {

/// Gives the daemon where up is. The daemon may be away, come and go. One thread uses it.
class LevelGiver {
public:
    using Clock = std::chrono::steady_clock;

    /// As ScanSource.
    LevelGiver(const std::string& where, disparity::ClientOptions options);
    virtual ~LevelGiver() = default;
    LevelGiver(const LevelGiver&) = delete;
    LevelGiver& operator=(const LevelGiver&) = delete;

    /// Keeps a level that has come, until give().
    void add(const disparity::Level& level, Clock::time_point arrived);

    /// Gives what was kept, with its age; waits for the answer at most a fifth of a second, and for a connection that
    /// is made anew up to a second. After a failure what comes is thrown away for a second. Throws nothing that a
    /// daemon does: problem() says it.
    void give();

    /// Returns one line: why the last give() failed, and what to do; empty when all is well.
    const std::string& problem() const { return problem_; }

protected:
    LevelGiver() = default;

    /// As SocketClient::give_level().
    virtual void give(const std::vector<disparity::Level>& levels);

private:
    struct Kept {
        disparity::Level level;
        Clock::time_point arrived;
    };

    std::optional<disparity::Client> client_;
    std::deque<Kept> kept_;
    std::string problem_;
    Clock::time_point next_try_{};
};

}  // namespace disparityd::mavlink
