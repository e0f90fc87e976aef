// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <utility>

namespace disparityd::bridges {

/// Says how things stand, without filling the journal however often it is told.
class Notes {
public:
    using Clock = std::chrono::steady_clock;
    using Write = std::function<void(const std::string& line)>;

    enum class Repeat {
        never,         ///< said again only after another line about the topic
        every_minute,  ///< what somebody has to mend
    };

    explicit Notes(Write write) : write_(std::move(write)) {}

    /// Takes the line that holds now about a topic, and writes it if it is new or to be repeated; at most one line a
    /// second for each topic. Topics are few: names in this program.
    void say(const std::string& topic, const std::string& line, Repeat repeat = Repeat::every_minute,
             Clock::time_point now = Clock::now());

private:
    struct Said {
        std::string line;
        Clock::time_point when;
    };

    Write write_;
    std::map<std::string, Said> said_;
};

}  // namespace disparityd::bridges
