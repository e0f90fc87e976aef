// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

namespace disparityd::web {

/// Decides when a viewer that tells what it has read gets the next message. One may be under way, sent and not yet
/// answered; two where answers come within a tenth of a second, so that the way there and back costs no frames. So a
/// viewer that pauses finds at most two when it goes on, and a slow one always the newest. A peer that has never
/// answered, as the protocol wants it to, gets one every two seconds all the same.
class AnsweredPace {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// `name` begins the marks: it tells the answers of several paces over one connection apart.
    explicit AnsweredPace(char name) : name_(name) {}

    bool ready(Time now) const {
        return under_way_.size() < most() ||
               (!has_answered_ && now - under_way_.front().time >= std::chrono::seconds(2));
    }

    /// A message is sent now. Returns the mark to ask the answer with.
    std::string sent(Time now);

    /// An answer has come: that message and all before it have been read. Returns whether the mark is one of this
    /// pace's.
    bool answered(std::string_view mark, Time now);

private:
    struct Sent {
        std::string mark;
        Time time;
    };

    std::size_t most() const { return quick_ ? 2 : 1; }

    char name_;
    std::uint64_t next_ = 0;
    std::deque<Sent> under_way_;
    bool has_answered_ = false;
    bool quick_ = false;
};

}  // namespace disparityd::web
